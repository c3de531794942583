//! The host's way to the board: registers behind AXI4-Lite, and a serial line in UARTBone's frames before them.

use crate::common::committed;
use crate::support;
use edof_core::draw::Draw;
use edof_cosim::bench::axi_lite::{Access, Answer};
use edof_cosim::bench::{Actor, Bench, ClockId, Host, Serial, Throttle};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_device::Design;
use edof_device::design::memory::{self, Set};
use edof_device::registers::map::{
    self, CONTROL, DISPLAY_TABLES, PROTECTION, REGISTERS, STAGE_COUNTERS, STAGE_READS, WEIGHTS, checked,
    register,
};
use edof_device::registers::{self, Window};
use edof_hdl::board::{BoardRegisters, Identity, UartBus};
use edof_hdl::ports::AxiLiteMaster;
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;
use std::collections::BTreeMap;

const IDENTITY: Identity =
    Identity { design_hash: 0x1234_5678, weights_hash: 0x9abc_def0, frame: (1920, 1080) };

fn bench(source: &Source, seed: u64) -> (Bench, ClockId) {
    let library = Library::build(source, &support::options()).unwrap();
    let mut bench = Bench::new(library.start(&Start { seed, ..Start::default() }).unwrap(), seed);
    let clock = bench.clock("clock_i", 5_000).unwrap();
    (bench, clock)
}

/// What a window was given; takes words when it likes.
struct Words {
    clock: ClockId,
    ports: [usize; 4],
    pace: Throttle,
    taken: Vec<(u32, u32)>,
}

impl Words {
    fn new(source: &Source, name: &str, clock: ClockId, seed: u64) -> Self {
        let ports = ["valid_o", "ready_i", "address_o", "data_o"]
            .map(|end| source.port(&format!("{name}_{end}")).unwrap());
        Self { clock, ports, pace: Throttle::drawn(seed), taken: vec![] }
    }
}

impl Actor for Words {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        if model.peek(self.ports[0])? == 1 && model.peek(self.ports[1])? == 1 {
            let word = (model.peek(self.ports[2])? as u32, model.peek(self.ports[3])? as u32);
            self.taken.push(word);
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let goes = self.pace.goes();
        model.poke(self.ports[1], goes.into())
    }
}

/// What the registers must answer: the transaction model.
struct Registers {
    design: Design,
    controls: BTreeMap<u32, u32>,
    statuses: BTreeMap<u32, u32>,
    windows: [Vec<(u32, u32)>; 2],
    refused: u32,
}

impl Registers {
    fn new() -> Self {
        let start = |register: &registers::Register| match register.name {
            "weights_hash" => IDENTITY.weights_hash,
            _ => register.reset,
        };
        let controls = REGISTERS.iter().filter(|register| register.access == registers::Access::Control);
        Self {
            controls: controls.map(|register| (register.address, start(register))).collect(),
            design: committed("tiny"),
            statuses: BTreeMap::new(),
            windows: Default::default(),
            refused: 0,
        }
    }

    fn answer(&mut self, access: Access) -> Answer {
        let (word, is_good) = match access {
            Access::Write(address, word) => (0, self.write(address, word)),
            Access::Read(address) => self.read(address).map_or((0, false), |word| (word, true)),
        };
        Answer { access, word, is_good }
    }

    fn write(&mut self, address: u32, word: u32) -> bool {
        let at = |window: &Window| {
            (address >= window.address && address < window.address + window.bytes)
                .then(|| (address - window.address) / 4)
        };
        if !address.is_multiple_of(4) {
            return false;
        }
        if self.keeps_out(address, word, at(&WEIGHTS), at(&DISPLAY_TABLES).is_some()) {
            self.refused += 1;
            return false;
        }
        if let Some(index) = at(&DISPLAY_TABLES) {
            self.windows[0].push((index, word & 0xfff));
        } else if let Some(index) = at(&WEIGHTS) {
            self.windows[1].push((index, word));
        } else if let Some(held) = self.controls.get_mut(&address) {
            let mask = REGISTERS.iter().find(|register| register.address == address).unwrap().mask();
            *held = word & mask;
        } else {
            return false;
        }
        true
    }

    /// Whether a word is one that `protection` keeps out.
    fn keeps_out(&self, address: u32, word: u32, weights: Option<u32>, is_table: bool) -> bool {
        let (control, protection) = (self.controls[&CONTROL], self.controls[&PROTECTION]);
        let set = if control & map::WEIGHT_SET == 0 { Set::First } else { Set::Second };
        let both = protection & map::PROTECT_OTHER != 0;
        let own = weights.and_then(|index| memory::set_of(&self.design, index));
        let of_bank = own.is_some_and(|own| both || own == set) || (is_table && control & map::RUN != 0);
        let wants_check =
            address == PROTECTION || (address == CONTROL && protection & map::PROTECT_CONTROL != 0);
        (of_bank && protection & map::PROTECT_BANK != 0) || (wants_check && !map::is_checked(word))
    }

    /// What a reset that is not the first one does.
    fn reset(&mut self) {
        let kept = [(map::WEIGHTS_HASH, u32::MAX), (CONTROL, map::WEIGHT_SET)];
        let kept = kept.map(|(address, mask)| (address, self.controls[&address] & mask));
        *self = Self { windows: std::mem::take(&mut self.windows), ..Self::new() };
        for (address, word) in kept {
            let held = self.controls.entry(address).or_default();
            *held = if address == CONTROL { *held | word } else { word };
        }
    }

    fn read(&self, address: u32) -> Option<u32> {
        // What was read back lies above the counters of all stages.
        for (window, first) in [(&STAGE_COUNTERS, 0), (&STAGE_READS, 64)] {
            let inside = (window.address..window.address + window.bytes).contains(&address);
            if inside && address.is_multiple_of(4) {
                return Some(stage_counter(first + (address - window.address) / 4));
            }
        }
        let found = REGISTERS.iter().find(|register| register.address == address)?;
        Some(match found.name {
            "design_hash" => IDENTITY.design_hash,
            "frame_size" => 1920 | 1080 << 16,
            _ if found.access == registers::Access::Constant => found.reset,
            "writes_refused" => self.refused,
            _ if found.access == registers::Access::Control => self.controls[&address],
            _ => self.statuses[&address] & found.mask(),
        })
    }
}

fn stage_counter(index: u32) -> u32 {
    index.wrapping_mul(0x0123_4567)
}

/// Answers the registers' question for a stage's counter.
struct Stages {
    clock: ClockId,
    ports: [usize; 2],
    /// Cycles until the answer arrives, random for each access; the port that signals the answer.
    ready: (usize, bool, Draw),
}

impl Actor for Stages {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let index = model.peek(self.ports[0])? as u32;
        let (port, is_ready, draw) = &mut self.ready;
        // Before its answer has come a stage shows anything.
        *is_ready = draw.whole(0, 3) == 0;
        let shown = if *is_ready { stage_counter(index) } else { draw.bits() as u32 };
        model.poke(*port, u64::from(*is_ready))?;
        model.poke(self.ports[1], shown.into())
    }
}

/// A word of random bits, or one that carries its complement.
fn word(draw: &mut Draw) -> u32 {
    let bits = draw.bits() as u32;
    if draw.whole(0, 1) == 0 { bits } else { checked(bits) }
}

/// An address where something is, or nearly.
fn address(draw: &mut Draw) -> u32 {
    let windows = [STAGE_COUNTERS, DISPLAY_TABLES, WEIGHTS, STAGE_READS];
    match draw.whole(0, 11) {
        0..=4 => REGISTERS[draw.whole(0, REGISTERS.len() as i64 - 1) as usize].address,
        5 => 4 * draw.whole(0, 0x80) as u32,
        6 => draw.bits() as u32,
        7 => REGISTERS[draw.whole(0, 9) as usize].address + draw.whole(0, 3) as u32,
        8 => [CONTROL, PROTECTION][draw.whole(0, 1) as usize],
        // Of a stage, or nearly: shifts, thresholds, weights of either set.
        9 => {
            let (stage, space, row) = (draw.whole(0, 5), draw.whole(0, 3), draw.whole(0, 260));
            let row = if draw.whole(0, 2) == 0 { draw.whole(0, 4) } else { row };
            WEIGHTS.word((stage << 21 | space << 19 | row << 1) as u32)
        }
        _ => {
            let window = &windows[draw.whole(0, 3) as usize];
            window.word(draw.whole(0, i64::from(window.bytes / 4) - 1) as u32)
        }
    }
}

#[test]
fn registers_answer_as_their_map_says() {
    let source = Source::circuit(&mut BoardRegisters::new(&committed("tiny"), &IDENTITY)).unwrap();
    for seed in 0..3 {
        let (mut bench, clock) = bench(&source, seed);
        let draw = &mut Draw::new(seed);
        let mut model = Registers::new();
        let mut host = Host::new(&source, "bus", clock, "reset_i", Throttle::drawn(seed)).unwrap();
        let mut tables = Words::new(&source, "table", clock, seed);
        let mut weights = Words::new(&source, "weight", clock, seed + 1);
        let ports = ["stage_address_o", "stage_counter_i"].map(|port| source.port(port).unwrap());
        let ready = (source.port("stage_ready_i").unwrap(), false, Draw::new(seed + 2));
        let mut stages = Stages { clock, ports, ready };
        bench.set("reset_i", 1).unwrap();
        bench.steps(5, &mut [&mut host, &mut tables, &mut weights, &mut stages]).unwrap();
        bench.set("reset_i", 0).unwrap();
        // Each status port by the name of its register.
        let of_others = |register: &&registers::Register| {
            register.access == registers::Access::Status && register.name != "writes_refused"
        };
        for register in REGISTERS.iter().filter(of_others) {
            let word = draw.bits() as u32;
            bench.set(&format!("{}_i", register.name), word.into()).unwrap();
            model.statuses.insert(register.address, word);
        }
        let access = |draw: &mut Draw| match draw.whole(0, 1) {
            0 => Access::Read(address(draw)),
            _ => Access::Write(address(draw), word(draw)),
        };
        let every = REGISTERS.iter().map(|register| Access::Read(register.address));
        let wanted: Vec<Access> = every.chain((0..1_500).map(|_| access(draw))).collect();
        let expected: Vec<Answer> = wanted.iter().map(|access| model.answer(*access)).collect();
        host.wanted = wanted.into();
        for _ in 0..400_000 {
            if host.wanted.is_empty() {
                break;
            }
            bench.step(&mut [&mut host, &mut tables, &mut weights, &mut stages]).unwrap();
        }
        for (found, expected) in host.answers.iter().zip(&expected) {
            assert_eq!(found, expected);
        }
        assert_eq!(host.answers.len(), expected.len());
        assert_eq!([&tables.taken, &weights.taken], model.windows.each_ref());
        for (name, port) in
            [("control", "control_o"), ("weights_hash", "weights_hash_o"), ("scratch", "scratch_o")]
        {
            let held = model.controls[&register(name).unwrap().address];
            assert_eq!(bench.get(port).unwrap(), u64::from(held), "{name}");
        }
        assert!(model.refused > 20, "{} words were kept out", model.refused);
        // A later reset leaves the bank in use; all else begins anew.
        bench.set("preserve_i", 1).unwrap();
        bench.set("reset_i", 1).unwrap();
        bench.steps(5, &mut [&mut host, &mut tables, &mut weights, &mut stages]).unwrap();
        bench.set("reset_i", 0).unwrap();
        model.reset();
        host.answers.clear();
        let controls: Vec<u32> = model.controls.keys().copied().collect();
        host.wanted = controls.iter().map(|address| Access::Read(*address)).collect();
        bench.steps(1_000, &mut [&mut host, &mut tables, &mut weights, &mut stages]).unwrap();
        let found: Vec<u32> = host.answers.iter().map(|answer| answer.word).collect();
        let expected: Vec<u32> = controls.iter().map(|address| model.controls[address]).collect();
        assert_eq!(found, expected);
    }
}

/// The serial line before the registers; tables and weights are taken when the test likes.
#[derive(Circuit)]
struct Line {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub receive: Signal<In, Bit>,
    pub transmit: Signal<Out, Bit>,
    pub broken: Signal<Out, Bits<32>>,
    pub weight_valid: Signal<Out, Bit>,
    pub weight_ready: Signal<In, Bit>,
    pub weight_address: Signal<Out, Bits<25>>,
    pub weight_data: Signal<Out, Bits<32>>,
    uart: UartBus,
    registers: BoardRegisters,
}

impl Logic for Line {
    #[hdl_gen]
    fn update(&mut self) {
        self.uart.clock.next = self.clock.val();
        self.uart.reset.next = self.reset.val();
        self.uart.receive.next = self.receive.val();
        self.transmit.next = self.uart.transmit.val();
        self.broken.next = self.uart.broken.val();
        self.registers.clock.next = self.clock.val();
        self.registers.reset.next = self.reset.val();
        AxiLiteMaster::join(&mut self.uart.bus, &mut self.registers.bus);
        self.weight_valid.next = self.registers.weight_valid.val();
        self.registers.weight_ready.next = self.weight_ready.val();
        self.weight_address.next = self.registers.weight_address.val();
        self.weight_data.next = self.registers.weight_data.val();
        self.registers.preserve.next = false;
        self.registers.table_ready.next = true;
        self.registers.stage_counter.next = 0.into();
        self.registers.stage_ready.next = true;
        self.registers.unreached.next = false;
        self.registers.calculator_lost.next = false;
        self.registers.status.next = 0.into();
        self.registers.i2c_board.next = 0.into();
        self.registers.i2c_card.next = 0.into();
        self.registers.receiver.next = 0.into();
        self.registers.receiver_size.next = 0.into();
        self.registers.receiver_format.next = 0.into();
        self.registers.transmitter.next = 0.into();
        self.registers.input_codes.next = 0.into();
        self.registers.input_malformed.next = 0.into();
        self.registers.chip_answer.next = 0.into();
        self.registers.input_size.next = 0.into();
        self.registers.input_frames.next = 0.into();
        self.registers.input_broken.next = 0.into();
        self.registers.input_wrong.next = 0.into();
        self.registers.input_overruns.next = 0.into();
        self.registers.input_write_errors.next = 0.into();
        self.registers.raw_frames.next = 0.into();
        self.registers.raw_late.next = 0.into();
        self.registers.raw_read_errors.next = 0.into();
        self.registers.busy_cycles.next = 0.into();
        self.registers.patches.next = 0.into();
        self.registers.saturated_sums.next = 0.into();
        self.registers.clamped_chroma.next = 0.into();
        self.registers.out_of_gamut.next = 0.into();
        self.registers.picture_frames.next = 0.into();
        self.registers.picture_broken.next = 0.into();
        self.registers.picture_write_errors.next = 0.into();
        self.registers.output_frames.next = 0.into();
        self.registers.output_late.next = 0.into();
        self.registers.output_read_errors.next = 0.into();
        self.registers.output_underruns.next = 0.into();
        self.registers.uart_broken.next = 0.into();
        self.registers.input_range.next = 0.into();
        self.registers.core_cycles.next = 0.into();
        self.registers.input_cycles.next = 0.into();
        self.registers.screen_cycles.next = 0.into();
        self.registers.window_pixel.next = 0.into();
        self.registers.check_raw.next = 0.into();
        self.registers.check_windows.next = 0.into();
        self.registers.check_codes.next = 0.into();
        self.registers.check_sent.next = 0.into();
        self.registers.check_frames.next = 0.into();
        self.registers.frame_blocks.next = 0.into();
        self.registers.frame_check.next = 0.into();
    }
}

/// A word of the second set of the first stage of `tiny`.
const BANK_B: u32 = 128;
/// Cycles of a bit, and of a pause after which a frame is given up.
const BIT: u16 = 16;
const TIME_OUT: u32 = 2_000;

/// A terminal on the line.
struct Terminal {
    clock: ClockId,
    ports: [usize; 2],
    serial: Serial,
}

impl Actor for Terminal {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        self.serial.see(model.peek(self.ports[1])? == 1);
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let level = self.serial.level();
        model.poke(self.ports[0], level.into())
    }
}

/// A frame: command, words, word address, data.
fn frame(command: u8, address: u32, words: &[u32], count: u8) -> Vec<(u32, u8)> {
    let data = words.iter().flat_map(|word| word.to_be_bytes());
    let bytes = [command, count].into_iter().chain((address / 4).to_be_bytes()).chain(data);
    bytes.map(|byte| (0, byte)).collect()
}

struct Rig {
    bench: Bench,
    terminal: Terminal,
    weights: Words,
}

impl Rig {
    fn new(seed: u64) -> Self {
        let (uart, registers) =
            (UartBus::new(BIT, TIME_OUT), BoardRegisters::new(&committed("tiny"), &IDENTITY));
        let source = Source::circuit(&mut Line::from_parts(LineParts { uart, registers })).unwrap();
        let (mut bench, clock) = bench(&source, seed);
        let ports = ["receive_i", "transmit_o"].map(|port| source.port(port).unwrap());
        let terminal = Terminal { clock, ports, serial: Serial::new(BIT) };
        let weights = Words { pace: Throttle::steady(), ..Words::new(&source, "weight", clock, seed) };
        bench.set("reset_i", 1).unwrap();
        bench.set("receive_i", 1).unwrap();
        let mut rig = Self { bench, terminal, weights };
        rig.steps(20);
        rig.bench.set("reset_i", 0).unwrap();
        rig.terminal.serial.forget();
        rig
    }

    fn steps(&mut self, cycles: usize) {
        self.bench.steps(cycles, &mut [&mut self.terminal, &mut self.weights]).unwrap();
    }

    /// Sends, waits until all is sent and some while after, and gives what came.
    fn exchange(&mut self, bytes: Vec<(u32, u8)>) -> Vec<u8> {
        self.terminal.serial.send(bytes);
        while !self.terminal.serial.is_done() {
            self.steps(100);
        }
        self.steps(60 * usize::from(BIT) * 10);
        assert_eq!(self.terminal.serial.misshapen, 0, "a start or stop bit is wrong");
        std::mem::take(&mut self.terminal.serial.came).into()
    }

    fn read(&mut self, name: &str) -> u32 {
        let came = self.exchange(frame(2, register(name).unwrap().address, &[], 1));
        u32::from_be_bytes(came.try_into().unwrap())
    }

    fn broken(&mut self) -> u64 {
        self.bench.get("broken_o").unwrap()
    }
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_be_bytes([word[0], word[1], word[2], word[3]])).collect()
}

#[test]
fn frames_write_and_read_words_with_growing_and_with_fixed_addresses() {
    let mut rig = Rig::new(1);
    let came = rig.exchange(frame(2, 0, &[], 4));
    assert_eq!(
        words(&came),
        [registers::map::ID, registers::map::VERSION, IDENTITY.design_hash, 1920 | 1080 << 16]
    );
    let scratch = register("scratch").unwrap().address;
    assert_eq!(rig.exchange(frame(1, scratch, &[0xdead_beef], 1)), [0u8; 0]);
    assert_eq!(words(&rig.exchange(frame(4, scratch, &[], 3))), [0xdead_beef; 3]);
    rig.exchange(frame(3, scratch, &[1, 2, 3], 3));
    assert_eq!(rig.read("scratch"), 3);
    rig.exchange(frame(1, WEIGHTS.word(BANK_B + 100), &[7, 8, 9], 3));
    assert_eq!(
        rig.weights.taken,
        [100, 101, 102].map(|at| BANK_B + at).into_iter().zip([7, 8, 9]).collect::<Vec<_>>()
    );
    // Words for the bank in use are kept out, and counted.
    rig.exchange(frame(1, WEIGHTS.word(100), &[7, 8, 9], 3));
    assert_eq!((rig.weights.taken.len(), rig.read("writes_refused")), (3, 3));
    // What cannot be read reads 0; a frame of no words does nothing.
    assert_eq!(words(&rig.exchange(frame(2, WEIGHTS.address, &[], 1))), [0]);
    assert_eq!(rig.exchange(frame(2, 0, &[], 0)), [0u8; 0]);
    assert_eq!((rig.read("id"), rig.broken()), (registers::map::ID, 0));
}

#[test]
fn random_frames_are_answered_as_the_registers_would() {
    exchanged_as_the_registers_would(2, 40, false);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn thousands_of_frames_whole_cut_or_of_no_command_are_answered_as_the_registers_would() {
    (100..120).for_each(|seed| exchanged_as_the_registers_would(seed, 500, true));
}

/// Damages a frame, or not: the words of it that are whole, and the broken frames that the circuit must count.
fn damaged(draw: &mut Draw, bytes: &mut Vec<(u32, u8)>, count: u32) -> (u32, u64) {
    match draw.whole(0, 3) {
        0 => {
            let strange =
                (0..draw.whole(1, 12)).map(|_| (0, [0, 5, 6, 0x7f, 0x80, 0xff][draw.whole(0, 5) as usize]));
            *bytes = strange.collect();
            (0, bytes.len() as u64)
        }
        1 => {
            bytes.truncate(draw.whole(1, bytes.len() as i64 - 1) as usize);
            ((bytes.len() as u32).saturating_sub(6) / 4, 1)
        }
        _ => (count, 0),
    }
}

/// Frames of a random command, address and length, some of them damaged, against a model of the registers.
fn exchanged_as_the_registers_would(seed: u64, frames: usize, damages: bool) {
    let mut rig = Rig::new(seed);
    let (draw, mut model) = (&mut Draw::new(seed), Registers::new());
    let scratch = register("scratch").unwrap().address;
    let mut broken = 0;
    for number in 0..frames {
        let (command, count) = (draw.whole(1, 4) as u8, draw.whole(1, 5) as u32);
        let start = if command % 2 == 1 && draw.whole(0, 1) == 0 {
            WEIGHTS.word(BANK_B * draw.whole(0, 1) as u32 + draw.whole(0, 100) as u32)
        } else {
            scratch
        };
        let data: Vec<u32> = (0..count).filter(|_| command % 2 == 1).map(|_| draw.bits() as u32).collect();
        // Status registers are all 0 here.
        model.statuses = REGISTERS.iter().map(|register| (register.address, 0)).collect();
        let mut bytes = frame(command, start, &data, count as u8);
        bytes.iter_mut().for_each(|(pause, _)| *pause = draw.whole(0, 20) as u32);
        let (count, times) = if damages { damaged(draw, &mut bytes, count) } else { (count, 0) };
        broken += times;
        let address = |i: u32| if command > 2 { start } else { start + 4 * i };
        let expected: Vec<u32> = match command % 2 {
            1 => {
                (0..count).for_each(|i| _ = model.write(address(i), data[i as usize]));
                vec![]
            }
            _ => (0..count).map(|i| model.read(address(i)).unwrap_or(0)).collect(),
        };
        assert_eq!(words(&rig.exchange(bytes)), expected, "seed {seed}, frame {number}");
        assert_eq!(rig.broken(), broken, "seed {seed}, frame {number}");
    }
    assert_eq!(rig.weights.taken, model.windows[1]);
}

#[test]
fn a_broken_frame_is_given_up_after_the_time_out_and_counted() {
    let mut rig = Rig::new(3);
    let scratch = register("scratch").unwrap().address;
    for cut in 1..10 {
        let mut bytes = frame(1, scratch, &[5], 1);
        bytes.truncate(cut);
        assert_eq!(rig.exchange(bytes), [0u8; 0]);
        assert_eq!((rig.broken(), rig.read("scratch")), (cut as u64, 0), "cut after {cut} bytes");
    }
    assert_eq!(rig.exchange(vec![(0, 0), (0, 5), (0, 0xff)]), [0u8; 0]);
    assert_eq!((rig.broken(), rig.read("id")), (9 + 3, registers::map::ID));
}

#[test]
fn a_frame_that_overtakes_its_words_is_passed_over() {
    let mut rig = Rig::new(4);
    rig.weights.pace = Throttle::percent(0, 1);
    rig.terminal.serial.send(frame(1, WEIGHTS.word(BANK_B), &[1, 2, 3], 3));
    rig.steps(18 * 10 * usize::from(BIT));
    rig.weights.pace = Throttle::steady();
    rig.steps(4 * TIME_OUT as usize);
    assert_eq!((rig.weights.taken.clone(), rig.broken()), (vec![(BANK_B, 1)], 1));
    assert_eq!(rig.read("id"), registers::map::ID);
}
