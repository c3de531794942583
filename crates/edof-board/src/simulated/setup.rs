//! The set-up of a bus's chips as the circuit does it (`edof_hdl::board::ChipSetup`), transfer by transfer.

use edof_device::i2c::{Action, Cause, Entry, SLOTS};
use std::time::Duration;

/// Chips on a bus.
pub trait ChipBus {
    /// Writes the bytes to a device.
    ///
    /// # Errors
    /// Why it did not come to its end.
    fn write(&mut self, device: u8, bytes: &[u8]) -> Result<(), Cause>;

    /// Writes the bytes, if there are any, then reads one after a repeated start.
    ///
    /// # Errors
    /// As [`ChipBus::write`].
    fn read(&mut self, device: u8, pointer: &[u8]) -> Result<u8, Cause>;
}

/// Attempts for a transfer, after which the set-up has failed.
const ATTEMPTS: u32 = 8;
/// Between two attempts, between two reads of a poll, and from a failure to the next set-up.
const PAUSE: Duration = Duration::from_millis(1);
const POLL: Duration = Duration::from_millis(10);
const REST: Duration = Duration::from_secs(1);
/// Of a transfer on the bus, about.
const TRANSFER: Duration = Duration::from_micros(300);

/// A program that runs on a bus.
#[derive(Debug)]
pub struct Setup<B> {
    /// The chips.
    pub bus: B,
    program: Vec<Entry>,
    is_card: bool,
    entry: usize,
    accumulator: u8,
    index: u8,
    tries: u8,
    attempt: u32,
    slots: [u8; SLOTS as usize],
    device: u8,
    /// All is set up.
    pub is_done: bool,
    /// Entry, device and cause as in the register, of a set-up that failed.
    failure: Option<u32>,
    retries: u32,
    sequence: u32,
    answer: u32,
}

impl<B: ChipBus> Setup<B> {
    /// At the program's begin; `is_card` is the value of the bit of `chip_access` that names this bus.
    pub const fn new(bus: B, program: Vec<Entry>, is_card: bool) -> Self {
        Self {
            bus,
            program,
            is_card,
            entry: 0,
            accumulator: 0,
            index: 0,
            tries: 0,
            attempt: 0,
            slots: [0; SLOTS as usize],
            device: 0,
            is_done: false,
            failure: None,
            retries: 0,
            sequence: 0,
            answer: 0,
        }
    }

    /// Begins anew, as a rise of `i2c_restart` has it.
    pub fn restart(&mut self) {
        (self.entry, self.attempt, self.tries, self.is_done) = (0, 0, 0, false);
        self.slots = [0; SLOTS as usize];
    }

    /// What the circuit's reset does.
    pub fn reset(&mut self) {
        self.restart();
        (self.failure, self.retries, self.sequence, self.answer, self.device) = (None, 0, 0, 0, 0);
    }

    /// Whether the last set-up failed.
    pub const fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// The register `i2c_board` or `i2c_card`.
    pub fn word(&self) -> u32 {
        let now = self.entry as u32 | u32::from(self.device) << 10;
        let place = self.failure.map_or(now, |failure| failure | 1 << 21);
        place | u32::from(self.is_done) << 20 | (self.retries & 0x3ff) << 22
    }

    /// Four slots from a first one on.
    pub fn slots(&self, first: usize) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|i| self.slots[first + i]))
    }

    /// The register `chip_answer`.
    pub const fn answer(&self) -> u32 {
        self.answer
    }

    /// Carries out what the host wants, if it is new; how long that took.
    pub fn serve(&mut self, access: u32) -> Option<Duration> {
        let sequence = access >> 28;
        if sequence == self.sequence {
            return None;
        }
        self.sequence = sequence;
        let [value, register, ..] = access.to_le_bytes();
        let (device, bit) = ((access >> 16 & 0x7f) as u8, |bit: u32| access >> bit & 1 == 1);
        if bit(25) != self.is_card {
            return None;
        }
        let pointer: &[u8] = if bit(24) { &[] } else { &[register] };
        let result = if bit(23) {
            self.bus.read(device, pointer)
        } else {
            self.bus.write(device, &[pointer, &[value]].concat()).map(|()| 0)
        };
        let (value, cause) = result.map_or_else(|cause| (0, cause as u32), |value| (value, 0));
        self.answer = u32::from(value) | cause << 8 | sequence << 28;
        Some(TRANSFER)
    }

    /// Does one step; how long it takes. `settings` is the register `video_setup`.
    pub fn step(&mut self, settings: u32) -> Duration {
        let action = self.program.get(self.entry).map_or(Action::End, |entry| entry.action);
        match action.device() {
            Some(device) => self.transfer(device, action, settings),
            None => self.execute(action, settings),
        }
    }

    fn slot(&self, slot: u8, settings: u32) -> u8 {
        let slot = usize::from(slot & 15);
        self.slots.get(slot).copied().unwrap_or_else(|| settings.to_le_bytes()[slot & 3])
    }

    fn store(&mut self, value: u8, slot: u8) {
        if let Some(held) = self.slots.get_mut(usize::from(slot & 15)) {
            *held = value;
        }
    }

    fn transfer(&mut self, device: u8, action: Action, settings: u32) -> Duration {
        self.device = device;
        let result = match action {
            Action::Byte { value, .. } => self.bus.write(device, &[value]).map(|()| None),
            Action::Write { register, value, .. } => {
                self.bus.write(device, &[register, value]).map(|()| None)
            }
            Action::Copy { register, slot, .. } => {
                let value = self.slot(slot, settings);
                self.bus.write(device, &[register, value]).map(|()| None)
            }
            Action::Read { register, .. } => self.bus.read(device, &[register]).map(Some),
            _ => {
                // What nobody answers is 0.
                let value = self.bus.read(device, &[self.index]).unwrap_or(0);
                self.index = self.index.wrapping_add(1);
                Ok(Some(value))
            }
        };
        match result {
            Ok(value) => {
                self.accumulator = value.unwrap_or(self.accumulator);
                if let Action::Read { slot, .. } = action {
                    self.store(self.accumulator, slot);
                }
                (self.attempt, self.entry) = (0, self.entry + 1);
                TRANSFER
            }
            Err(cause) if self.attempt + 1 == ATTEMPTS => self.fail(cause),
            Err(_) => {
                self.attempt += 1;
                self.retries += 1;
                TRANSFER + PAUSE
            }
        }
    }

    fn execute(&mut self, action: Action, settings: u32) -> Duration {
        let is = |mask: u8, value: u8| self.accumulator & mask == value;
        let mut next = self.entry + 1;
        let mut takes = Duration::ZERO;
        match action {
            Action::Wait(milliseconds) => takes = Duration::from_millis(milliseconds.into()),
            Action::Until { tries, mask, value } => {
                if is(mask, value) {
                    self.tries = 0;
                } else if self.tries == tries {
                    return self.fail(Cause::OtherValue);
                } else {
                    self.tries += 1;
                    (next, takes) = (self.entry - 1, POLL);
                }
            }
            Action::If { mask, value } => next += usize::from(!is(mask, value)),
            Action::More => next += usize::from(self.index == 0),
            Action::Goto(target) => next = target.into(),
            Action::Load(slot) => self.accumulator = self.slot(slot, settings),
            Action::Store { value, slot } => self.store(value, slot),
            Action::Index(index) => self.index = index,
            Action::Done => (self.is_done, self.failure) = (true, None),
            _ => (next, takes) = (self.entry, REST),
        }
        self.entry = next;
        takes
    }

    fn fail(&mut self, cause: Cause) -> Duration {
        self.failure = Some(self.entry as u32 | u32::from(self.device) << 10 | (cause as u32) << 17);
        self.restart();
        REST
    }
}
