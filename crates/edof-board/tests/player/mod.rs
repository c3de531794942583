//! A set-up step by step on wires, with pixels passing meanwhile.

use edof_board::chip_models::hdmi::{Axis, Timing};
use edof_board::chip_models::master::{Error, Master};
use edof_board::chip_models::screen::Shown;
use edof_board::chip_models::source::Picture;
use edof_board::chip_models::{Bus, Delays, Imageon, Kc705, Lines, LowHotPlug, Pulls, Wires};
use edof_device::i2c::{Action, SLOTS};
use edof_device::registers::map::VIDEO_SETUP_RESET;

/// A frame of a few pixels.
pub const SMALL: Timing = Timing {
    line: Axis { active: 16, front: 4, sync: 6, back: 6 },
    frame: Axis { active: 8, front: 2, sync: 2, back: 4 },
    khz: 148_500,
};

/// Samples of the bus in a millisecond: few, since the waits of a set-up are long.
const STEPS_PER_MS: u64 = 20;

/// Chips whose time passes.
pub trait Stage: Wires {
    /// A frame's pixels pass.
    fn frame(&mut self);
}

/// The card between a source and the FPGA's pins.
pub struct Card {
    pub card: Imageon,
}

impl Card {
    pub fn new() -> Self {
        let mut card = Imageon::new(Delays::of(STEPS_PER_MS));
        card.shorten_free_run(SMALL);
        card.set_reset(true);
        Self { card }
    }

    fn words(&mut self) -> Vec<u16> {
        (0..SMALL.line.total() * SMALL.frame.total()).map(|_| self.card.pixel().unwrap_or(0)).collect()
    }

    /// Luma and chroma of a picture at the pins.
    pub fn picture(&mut self) -> Picture {
        let words = self.words();
        let lines = words.chunks(SMALL.line.total()).take(SMALL.frame.active);
        lines.flat_map(|line| line[..SMALL.line.active].iter().map(|word| word.to_be_bytes())).collect()
    }
}

impl Wires for Card {
    fn step(&mut self, master: Pulls) -> Lines {
        self.card.step(master)
    }
}

impl Stage for Card {
    fn frame(&mut self) {
        self.words();
    }
}

/// The board between the FPGA's pins and a screen.
pub struct Board {
    pub board: Kc705,
}

impl Board {
    pub fn new(low: LowHotPlug) -> Self {
        let mut board = Kc705::new(Delays::of(STEPS_PER_MS), low);
        board.set_reset(true);
        Self { board }
    }

    /// What the screen shows of frames that come from now on.
    pub fn shown(&mut self) -> Option<Shown> {
        self.board.screen_mut()?.shown.clear();
        (0..3).for_each(|_| self.frame());
        self.board.screen()?.shown.last().cloned()
    }
}

impl Wires for Board {
    fn step(&mut self, master: Pulls) -> Lines {
        self.board.step(master)
    }
}

/// Words {chroma, luma} at the pins, of colours that any screen can show.
pub fn words() -> Vec<u16> {
    (0..128).map(|i| (100 + i % 50) << 8 | (60 + i)).collect()
}

impl Stage for Board {
    fn frame(&mut self) {
        let (line, frame) = (SMALL.line, SMALL.frame);
        let words = words();
        for (row, column) in
            (0..frame.total()).flat_map(|row| (0..line.total()).map(move |column| (row, column)))
        {
            let de = row < frame.active && column < line.active;
            let vs = row == frame.active + frame.front;
            let data = if de { words[row * line.active + column] } else { 0 };
            self.board.pixel(Bus { hs: false, vs, de, data });
        }
    }
}

/// Why a set-up failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// A transfer.
    Bus(Error),
    /// A register did not come to its value in time; what it had.
    Other(u8),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Bus(error)
    }
}

/// A program that is played on wires.
pub struct Player<W> {
    pub wires: W,
    program: Vec<Action>,
    at: usize,
    accumulator: u8,
    index: u8,
    tries: u8,
    pub slots: [u8; SLOTS as usize],
    pub settings: u32,
    pub is_done: bool,
    /// Device and error of the last set-up, if it failed.
    pub failure: Option<(u8, Failure)>,
    /// Milliseconds that passed.
    passed: u64,
}

impl<W: Stage> Player<W> {
    pub fn new(wires: W, program: Vec<Action>) -> Self {
        Self {
            wires,
            program,
            at: 0,
            accumulator: 0,
            index: 0,
            tries: 0,
            slots: [0; SLOTS as usize],
            settings: VIDEO_SETUP_RESET,
            is_done: false,
            failure: None,
            passed: 0,
        }
    }

    /// Plays for N tenths of a second.
    pub fn play(&mut self, tenths: u64) {
        let until = self.passed + 100 * tenths;
        for _ in 0..20_000 {
            if self.passed >= until {
                return;
            }
            self.step();
        }
        // Nothing waits any more: a program that ended.
        (self.passed..until).for_each(|_| self.wait(1));
    }

    fn wait(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds * STEPS_PER_MS {
            self.wires.step(Pulls::default());
        }
        for _ in 0..(milliseconds / 10).clamp(1, 3) {
            self.wires.frame();
        }
        self.passed += milliseconds;
    }

    /// Eight attempts, then the set-up has failed and begins anew after a second.
    fn transfer(
        &mut self,
        device: u8,
        mut once: impl FnMut(&mut Master<&mut W>) -> Result<u8, Error>,
    ) -> Option<u8> {
        let mut last = Ok(0);
        for _ in 0..8 {
            last = once(&mut Master::new(&mut self.wires));
            match last {
                Ok(byte) => return Some(byte),
                Err(_) => self.wait(1),
            }
        }
        self.fail(device, last.unwrap_err().into());
        None
    }

    fn fail(&mut self, device: u8, error: Failure) {
        self.failure = Some((device, error));
        (self.at, self.tries, self.is_done) = (0, 0, false);
        self.slots = [0; SLOTS as usize];
        self.wait(1_000);
    }

    fn slot(&self, slot: u8) -> u8 {
        let slot = usize::from(slot & 15);
        self.slots.get(slot).copied().unwrap_or_else(|| self.settings.to_le_bytes()[slot & 3])
    }

    fn store(&mut self, slot: u8, value: u8) {
        if let Some(held) = self.slots.get_mut(usize::from(slot & 15)) {
            *held = value;
        }
    }

    fn step(&mut self) {
        let action = self.program.get(self.at).copied().unwrap_or(Action::End);
        let next = match action {
            Action::Byte { device, value } => self.write(device, &[value]),
            Action::Write { device, register, value } => self.write(device, &[register, value]),
            Action::Copy { device, register, slot } => self.write(device, &[register, self.slot(slot)]),
            Action::Read { device, register, slot } => self.read(device, register, slot),
            Action::ReadNext { device } => {
                let read = Master::new(&mut self.wires).read(device, &[self.index], 1);
                self.accumulator = read.map_or(0, |bytes| bytes[0]);
                self.index = self.index.wrapping_add(1);
                Some(self.at + 1)
            }
            Action::Until { tries, mask, value } => self.until(tries, mask, value),
            Action::If { mask, value } => {
                Some(self.at + if self.accumulator & mask == value { 1 } else { 2 })
            }
            Action::More => Some(self.at + if self.index == 0 { 2 } else { 1 }),
            Action::Goto(target) => Some(usize::from(target)),
            Action::End => Some(self.at),
            action => {
                self.execute(action);
                Some(self.at + 1)
            }
        };
        self.at = next.unwrap_or(0);
    }

    fn execute(&mut self, action: Action) {
        match action {
            Action::Wait(milliseconds) => self.wait(milliseconds.into()),
            Action::Load(slot) => self.accumulator = self.slot(slot),
            Action::Store { value, slot } => self.store(slot, value),
            Action::Index(index) => self.index = index,
            Action::Done => (self.is_done, self.failure) = (true, None),
            _ => {}
        }
    }

    fn write(&mut self, device: u8, bytes: &[u8]) -> Option<usize> {
        let next = self.at + 1;
        self.transfer(device, |master| master.write(device, bytes).map(|()| 0)).map(|_| next)
    }

    fn read(&mut self, device: u8, register: u8, slot: u8) -> Option<usize> {
        let next = self.at + 1;
        let byte = self.transfer(device, |master| Ok(master.read(device, &[register], 1)?[0]))?;
        self.accumulator = byte;
        self.store(slot, byte);
        Some(next)
    }

    /// On, or the step before once more.
    fn until(&mut self, tries: u8, mask: u8, value: u8) -> Option<usize> {
        if self.accumulator & mask == value {
            self.tries = 0;
            return Some(self.at + 1);
        }
        if self.tries == tries {
            let device = self.program[self.at - 1].device().unwrap_or(0);
            self.fail(device, Failure::Other(self.accumulator));
            return None;
        }
        self.tries += 1;
        self.wait(10);
        Some(self.at - 1)
    }
}
