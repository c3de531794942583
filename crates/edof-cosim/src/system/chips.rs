//! The video chips around a core: the Verilated engines that set them up and the block that counts sync codes, between the core's ports and the
//! models of the chips.

use crate::bench::{Actor, ClockId};
use crate::error::at;
use crate::verilator::{Library, Model, Options, Start};
use crate::{Error, Source, work};
use edof_board::chip_models::{Delays, Imageon, Kc705, LowHotPlug, Pulls, Screen, Wires};
use edof_board::simulated::chips::cable;
use edof_core::storage::atomic::WorkFolder;
use edof_device::board::{KC705, Setup};
use edof_device::design::FrameSize;
use edof_device::i2c::{Entry, image};
use edof_device::video::VideoTiming;
use edof_hdl::board::{ChipSetup, EmbeddedSyncs, Pace};
use edof_hdl::crossing::reset_sync::RESET_CYCLES;
use std::fs;

/// Cycles of the core in one of theirs: they are models of their own, and what they tell the core stands for long.
const CYCLES: u64 = 4;
/// So short bits and milliseconds that a set-up takes some hundred thousand cycles of the core.
const PACE: Pace = Pace { i2c_quarter: 4, millisecond: 20, ..Pace::of(&KC705) };
/// Registers of the map that the card's slots are, and that of the board's.
const SLOTS: [usize; 3] = [0, 1, 2];

/// An engine on its bus.
struct Engine {
    model: Model,
    /// Reset, restart, settings, access.
    given: [usize; 4],
    /// Lines, and what is pulled down.
    lines: [usize; 4],
    /// Done, failed, word, answer, slots.
    told: [usize; 7],
}

impl Engine {
    fn new(
        program: &[Entry],
        image: &'static str,
        is_card: bool,
        folder: &WorkFolder,
        seed: u64,
        options: &Options,
    ) -> Result<Self, Error> {
        let source = Source::circuit(&mut ChipSetup::new(&PACE, program, image, is_card))?;
        let library = Library::build(&source, options)?;
        let start = Start { seed, memory_dir: Some(folder.path().to_path_buf()) };
        let port = |name: &str| source.port(name);
        Ok(Self {
            given: [port("reset_i")?, port("restart_i")?, port("settings_i")?, port("access_i")?],
            lines: [port("scl_i")?, port("sda_i")?, port("scl_low_o")?, port("sda_low_o")?],
            told: [
                port("done_o")?,
                port("failed_o")?,
                port("word_o")?,
                port("answer_o")?,
                port("slots_0_o")?,
                port("slots_1_o")?,
                port("slots_2_o")?,
            ],
            model: library.start(&start)?,
        })
    }

    /// A cycle of its own: what the core gives it, and the bus.
    fn cycle(&mut self, given: [u64; 4], bus: &mut dyn Wires) -> Result<(), Error> {
        let model = &mut self.model;
        let [scl, sda, scl_low, sda_low] = self.lines;
        let pulls = Pulls { scl_low: model.peek(scl_low)? == 1, sda_low: model.peek(sda_low)? == 1 };
        let lines = bus.step(pulls);
        for (port, value) in self.given.iter().zip(given) {
            model.poke(*port, value)?;
        }
        model.poke(scl, lines.scl.into())?;
        model.poke(sda, lines.sda.into())?;
        model.tick()
    }

    /// Done, failed, word, answer, slots.
    fn told(&mut self) -> Result<[u64; 7], Error> {
        let mut told = [0; 7];
        for (value, port) in told.iter_mut().zip(self.told) {
            *value = self.model.peek(port)?;
        }
        Ok(told)
    }
}

/// Engines, chips, and the ends of their cables.
pub struct Chips {
    clock: ClockId,
    /// On the board's bus, and on the card's.
    engines: Vec<Engine>,
    /// The board's chips; their screen is plugged in.
    pub board: Kc705,
    /// The card's.
    pub card: Imageon,
    syncs: Model,
    /// Reset, data, whole codes, damaged ones.
    of_syncs: [usize; 4],
    /// Of the core: reset, restart, settings, access.
    given: [usize; 4],
    /// Of the core: done, failed, answer, both words, four registers of the chips, both counts.
    taken: Vec<usize>,
    /// Cycles of the domain's reset that are left.
    held: usize,
    cycle: u64,
    last: Vec<u64>,
    _images: WorkFolder,
}

impl Chips {
    /// Beside a core whose frames have this size.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or the core lacks a port.
    pub fn new(
        core: &Source,
        clock: ClockId,
        frame: FrameSize,
        seed: u64,
        options: &Options,
    ) -> Result<Self, Error> {
        let images = work::folder()?;
        let mode = VideoTiming::on_the_cable(frame);
        let program = |setup: &Setup| (setup.program)(mode, [0, 0]);
        for setup in KC705.setups() {
            let path = images.path().join(setup.image);
            path.parent().map_or(Ok(()), fs::create_dir_all).map_err(at(&path))?;
            fs::write(&path, image(&program(setup))).map_err(at(&path))?;
        }
        let engine = |(setup, is_card): (&Setup, bool)| {
            Engine::new(&program(setup), setup.image, is_card, &images, seed, options)
        };
        let engines = KC705.setups().zip([false, true]).map(engine);
        let syncs = Source::circuit(&mut EmbeddedSyncs::default())?;
        let of_syncs = ["reset_i", "data_i", "codes_o", "malformed_o"].map(|name| syncs.port(name));
        let mut board = Kc705::new(Delays::NONE, LowHotPlug::HoldsDefaults);
        board.set_reset(true);
        board.attach(Some(Screen::hdmi()));
        let mut card = Imageon::new(Delays::NONE);
        card.set_reset(true);
        card.shorten_free_run(cable(VideoTiming::of_frame(frame)));
        let port = |name: &str| core.port(name);
        let taken = [
            "i2c_done_i",
            "i2c_failed_i",
            "chip_answer_i",
            "i2c_0_i",
            "i2c_1_i",
            "chips_0_i",
            "chips_1_i",
            "chips_2_i",
            "chips_3_i",
            "input_codes_i",
            "input_malformed_i",
        ];
        Ok(Self {
            clock,
            engines: engines.collect::<Result<_, _>>()?,
            board,
            card,
            syncs: Library::build(&syncs, options)?.start(&Start { seed, ..Start::default() })?,
            of_syncs: all(of_syncs)?,
            given: [port("reset_i")?, port("i2c_restart_o")?, port("video_setup_o")?, port("chip_access_o")?],
            taken: taken.into_iter().map(port).collect::<Result<_, _>>()?,
            held: RESET_CYCLES + 2,
            cycle: 0,
            last: vec![],
            _images: images,
        })
    }

    /// One word of the receiver's through the block that finds sync codes.
    fn pixel(&mut self, reset: bool) -> Result<(), Error> {
        let Some(word) = self.card.pixel() else { return Ok(()) };
        self.syncs.poke(self.of_syncs[0], reset.into())?;
        self.syncs.poke(self.of_syncs[1], word.swap_bytes().into())?;
        self.syncs.tick()
    }
}

fn all<T: Copy + Default, const N: usize>(results: [Result<T, Error>; N]) -> Result<[T; N], Error> {
    let mut found = [T::default(); N];
    for (place, result) in found.iter_mut().zip(results) {
        *place = result?;
    }
    Ok(found)
}

impl Actor for Chips {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, core: &mut Model) -> Result<(), Error> {
        self.cycle += 1;
        if core.peek(self.given[0])? == 1 {
            self.held = RESET_CYCLES + 2;
        }
        if !self.cycle.is_multiple_of(CYCLES) {
            return Ok(());
        }
        let reset = self.held > 0;
        self.held = self.held.saturating_sub(1);
        let mut given = [reset.into(), 0, 0, 0];
        for (value, port) in given.iter_mut().zip(self.given).skip(1) {
            *value = core.peek(port)?;
        }
        self.engines[0].cycle(given, &mut self.board)?;
        self.engines[1].cycle(given, &mut self.card)?;
        self.pixel(reset)
    }

    fn after(&mut self, core: &mut Model) -> Result<(), Error> {
        if !self.cycle.is_multiple_of(CYCLES) {
            return Ok(());
        }
        let [board, card] = [self.engines[0].told()?, self.engines[1].told()?];
        let access = core.peek(self.given[3])?;
        let answer = if access >> 25 & 1 == 1 { card[3] } else { board[3] };
        let mut told = vec![board[0] & card[0], board[1] | card[1], answer, board[2], card[2]];
        told.extend(SLOTS.map(|slot| card[4 + slot]));
        told.push(board[4]);
        told.push(self.syncs.peek(self.of_syncs[2])?);
        told.push(self.syncs.peek(self.of_syncs[3])?);
        if told != self.last {
            for (port, value) in self.taken.iter().zip(&told) {
                core.poke(*port, *value)?;
            }
            self.last = told;
        }
        Ok(())
    }
}
