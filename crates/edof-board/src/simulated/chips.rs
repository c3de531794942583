//! The video chips of a simulated board (`edof_board::chip_models`), set up and polled as the circuit does it; a source and a screen at their cables.

use super::Time;
use super::setup::{ChipBus, Setup};
use crate::chip_models::adv7611::State;
use crate::chip_models::hdmi::{Axis, Timing};
use crate::chip_models::master::Error;
use crate::chip_models::source::Picture;
use crate::chip_models::{Delays, Imageon, Kc705, LowHotPlug, Master, Screen, Source, Wires};
use edof_device::design::FrameSize;
use edof_device::i2c::{self, Cause};
use edof_device::video::{self, VideoTiming};
use edof_golden::video::SyncCodes;

/// A bus of chips, bit by bit.
#[derive(Debug)]
pub struct Wired<W>(Master<W>);

impl<W: Wires> Wired<W> {
    fn told<T>(&mut self, result: Result<T, Error>) -> Result<T, Cause> {
        result.map_err(|error| match error {
            Error::Refused { .. } => Cause::Refused,
            Error::Arbitration { .. } => Cause::Arbitration,
            Error::SclLow => Cause::ClockLow,
            Error::SdaLow => {
                self.0.free();
                Cause::DataLow
            }
        })
    }
}

impl<W: Wires> ChipBus for Wired<W> {
    fn write(&mut self, device: u8, bytes: &[u8]) -> Result<(), Cause> {
        let result = self.0.write(device, bytes);
        self.told(result)
    }

    fn read(&mut self, device: u8, pointer: &[u8]) -> Result<u8, Cause> {
        let result = self.0.read(device, pointer, 1).map(|bytes| bytes[0]);
        self.told(result)
    }
}

/// Registers of the map that the chips fill.
const REGISTERS: [&str; 10] = [
    "i2c_board",
    "i2c_card",
    "receiver",
    "receiver_size",
    "receiver_format",
    "transmitter",
    "chip_answer",
    "input_codes",
    "input_malformed",
    "input_cycles",
];
/// What happened longer ago is not gone through: all is polled many times in it.
const REMEMBERED: Time = 3_000_000_000;
/// From one look at the pixels to the next.
const BETWEEN: Time = 100_000_000;
/// Lines that are looked at for sync codes where many have passed.
const LINES: u64 = 4;

/// The chips of both buses.
#[derive(Debug)]
pub struct Chips {
    board: Setup<Wired<Kc705>>,
    card: Setup<Wired<Imageon>>,
    /// When each bus is ready for its next step.
    due: [Time; 2],
    now: Time,
    timing: VideoTiming,
    codes: SyncCodes,
    /// Lines of which sync codes were counted.
    lines: u64,
    /// Cycles of the receiver's clock, in millionths.
    cycles: u128,
    access: u32,
    source: Source,
    has_source: bool,
}

impl Chips {
    /// Chips after power-up, with a source of the frames' size and a screen.
    #[must_use]
    pub fn new(frame: FrameSize) -> Self {
        let timing = VideoTiming::of_frame(frame);
        let grey = vec![[128, 128]; timing.line.active * timing.frame.active];
        let source = source(frame, vec![grey]);
        let mut board = Kc705::new(Delays::NONE, LowHotPlug::HoldsDefaults);
        board.set_reset(true);
        board.attach(Some(Screen::hdmi()));
        let mut card = Imageon::new(Delays::NONE);
        card.set_reset(true);
        card.shorten_free_run(cable(timing));
        card.plug(Some(source.clone()));
        let [of_board, of_card] = i2c::programs(VideoTiming::on_the_cable(frame));
        Self {
            board: Setup::new(Wired(Master::new(board)), of_board, false),
            card: Setup::new(Wired(Master::new(card)), of_card, true),
            due: [0; 2],
            now: 0,
            timing,
            codes: SyncCodes::default(),
            lines: 0,
            cycles: 0,
            access: 0,
            source,
            has_source: true,
        }
    }

    /// Whether a register of that name is filled by the chips.
    #[must_use]
    pub fn has(name: &str) -> bool {
        REGISTERS.contains(&name)
    }

    /// The board's chips.
    pub const fn board(&mut self) -> &mut Kc705 {
        self.board.bus.0.bus()
    }

    /// The card's chips.
    pub const fn card(&mut self) -> &mut Imageon {
        self.card.bus.0.bus()
    }

    /// Puts the source's cable in, or pulls it out.
    pub fn plug(&mut self, is_in: bool) {
        let source = is_in.then(|| self.source.clone());
        self.card().plug(source);
        self.has_source = is_in;
    }

    /// Whether the source's cable is in.
    #[must_use]
    pub const fn has_source(&self) -> bool {
        self.has_source
    }

    /// Whether all are set up, and whether a set-up failed.
    #[must_use]
    pub const fn state(&self) -> [bool; 2] {
        [self.board.is_done && self.card.is_done, self.board.has_failed() || self.card.has_failed()]
    }

    /// The board's reset: the engines begin anew, the chips do not notice.
    pub fn reset(&mut self, now: u64) {
        self.board.reset();
        self.card.reset();
        self.codes = SyncCodes::default();
        self.access = 0;
        self.restart_at(now);
    }

    /// Both set-ups begin anew.
    pub fn restart(&mut self, now: u64) {
        self.board.restart();
        self.card.restart();
        self.restart_at(now);
    }

    fn restart_at(&mut self, now: u64) {
        self.due = [now; 2];
        self.now = now;
        self.lines = self.lines_by_now();
    }

    /// Lets time pass; `settings` and `access` are the host's registers since the last call.
    pub fn pass_to(&mut self, now: u64, settings: u32, access: u32) {
        let forgotten = self.now.max(now.saturating_sub(REMEMBERED));
        self.count_cycles(forgotten - self.now);
        self.now = forgotten;
        for due in &mut self.due {
            *due = (*due).max(self.now);
        }
        while self.now < now {
            let next = now.min(self.now + BETWEEN);
            self.count_cycles(next - self.now);
            self.now = next;
            while self.due[0] <= self.now {
                self.due[0] += self.board.step(settings).as_nanos() as Time;
            }
            while self.due[1] <= self.now {
                self.due[1] += self.card.step(settings).as_nanos() as Time;
            }
            self.count_codes();
        }
        self.access = access;
        self.board.serve(access);
        self.card.serve(access);
    }

    fn count_cycles(&mut self, passed: Time) {
        self.cycles += u128::from(passed) * u128::from(self.card().clock_khz());
    }

    /// Lines that began since power-up.
    fn lines_by_now(&self) -> u64 {
        let lines = self.timing.frames_per_second() * self.timing.frame.total() as f64;
        (self.now as f64 * 1e-9 * lines) as u64
    }

    /// Codes of the lines that passed: those of a few, as often as there were lines. A receiver that has not locked yet sees a frame.
    fn count_codes(&mut self) {
        let passed = self.lines_by_now().saturating_sub(self.lines);
        if passed < LINES {
            return;
        }
        let card = self.card.bus.0.bus();
        let locks = card.clock_runs() && card.receiver().state() == State::NotLocked;
        let looked_at = if locks { self.timing.frame.total() as u64 } else { LINES };
        self.lines += passed;
        let before = [self.codes.codes, self.codes.malformed];
        for _ in 0..looked_at as usize * self.timing.line.total() {
            let Some(word) = card.pixel() else { return };
            self.codes.push(word);
        }
        let grown = |now: u32, before: u32| {
            let more = u64::from(now.wrapping_sub(before)) * passed;
            before.wrapping_add(more.div_ceil(looked_at) as u32)
        };
        self.codes.codes = grown(self.codes.codes, before[0]);
        self.codes.malformed = grown(self.codes.malformed, before[1]);
    }

    /// A register of the map.
    #[must_use]
    pub fn register(&self, name: &str) -> u32 {
        match name {
            "i2c_board" => self.board.word(),
            "i2c_card" => self.card.word(),
            "receiver" => self.card.slots(0),
            "receiver_size" => self.card.slots(4),
            "receiver_format" => self.card.slots(8),
            "transmitter" => self.board.slots(0),
            "chip_answer" if self.access >> 25 & 1 == 0 => self.board.answer(),
            "chip_answer" => self.card.answer(),
            "input_codes" => self.codes.codes,
            "input_malformed" => self.codes.malformed,
            "input_cycles" => (self.cycles / 1_000_000) as u32,
            _ => 0,
        }
    }
}

/// A timing as the models of the chips have it.
#[must_use]
pub fn cable(timing: VideoTiming) -> Timing {
    let axis =
        |axis: video::Axis| Axis { active: axis.active, front: axis.front, sync: axis.sync, back: axis.back };
    Timing { line: axis(timing.line), frame: axis(timing.frame), khz: timing.pixel_khz as u32 }
}

/// A source that sends pictures of a size: in the size's mode, or in simulation in place of [`VideoTiming::on_the_cable`].
#[must_use]
pub fn source(frame: FrameSize, pictures: Vec<Picture>) -> Source {
    let mode = cable(VideoTiming::on_the_cable(frame));
    let mut source = Source::new(cable(VideoTiming::of_frame(frame)).in_place_of(mode), pictures);
    source.mode = mode;
    source
}
