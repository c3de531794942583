//! An I2C bus as wires: two lines that anyone may pull low, and what a chip makes of them.
//!
//! Source: NXP UM10204, I2C-bus specification (start, stop, acknowledge, repeated start, wired-and).

use crate::chip_models::faults::Faults;
pub use crate::chip_models::lines::{Lines, Pulls};

/// A bus with everything on it, as its master sees it.
pub trait Wires {
    /// One sample: what the master pulls low in, the levels of the lines out.
    fn step(&mut self, master: Pulls) -> Lines;
}

impl<W: Wires + ?Sized> Wires for &mut W {
    fn step(&mut self, master: Pulls) -> Lines {
        (**self).step(master)
    }
}

/// A chip that answers on an I2C bus, byte by byte.
pub trait Target {
    /// Whether the chip has power and is out of reset. A chip that is not lets go of the lines.
    fn is_alive(&self) -> bool {
        true
    }

    /// Whether the chip acknowledges this 7-bit address now.
    fn answers(&self, address: u8) -> bool;

    /// The chip was addressed; what follows are bytes of one transfer.
    fn addressed(&mut self, address: u8, is_read: bool);

    /// A byte of the master; returns whether the chip acknowledges it.
    fn write(&mut self, byte: u8) -> bool;

    /// The next byte for the master.
    fn read(&mut self) -> u8;

    /// A stop condition after a transfer with this chip.
    fn stopped(&mut self) {}
}

/// Where a chip is in a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Someone else is meant, or nobody.
    Idle,
    /// Bits of an address or of a byte to be written come in.
    Receive { is_address: bool, byte: u8, bits: u8 },
    /// The chip acknowledges; afterwards it reads or sends.
    Acknowledge { sends: bool },
    /// Bits go out, the topmost first; N are left after the one on the line.
    Send { byte: u8, left: u8 },
    /// The master says whether it wants another byte.
    Asked { more: bool },
}

/// A chip at a bus.
#[derive(Debug, Clone)]
pub struct Tap<T> {
    /// The chip.
    pub chip: T,
    before: Lines,
    phase: Phase,
    /// The transfer so far was with this chip.
    is_meant: bool,
    sda_low: bool,
}

impl<T: Target> Tap<T> {
    /// A chip at an idle bus.
    pub const fn new(chip: T) -> Self {
        Self { chip, before: Lines::IDLE, phase: Phase::Idle, is_meant: false, sda_low: false }
    }

    /// Whether the chip pulls the data line low.
    pub const fn sda_low(&self) -> bool {
        self.sda_low
    }

    /// Lets go of the lines and forgets the transfer.
    pub const fn let_go(&mut self) {
        (self.phase, self.is_meant, self.sda_low) = (Phase::Idle, false, false);
    }

    /// One sample of the lines.
    pub fn see(&mut self, lines: Lines, faults: &mut Faults) {
        if !self.chip.is_alive() {
            self.let_go();
            self.before = lines;
            return;
        }
        let before = std::mem::replace(&mut self.before, lines);
        match (before.scl, lines.scl) {
            (true, true) if before.sda && !lines.sda => self.start(),
            (true, true) if !before.sda && lines.sda => self.stop(),
            (false, true) => self.rise(lines.sda),
            (true, false) => self.fall(faults),
            _ => {}
        }
    }

    const fn start(&mut self) {
        self.phase = Phase::Receive { is_address: true, byte: 0, bits: 0 };
        self.sda_low = false;
    }

    fn stop(&mut self) {
        if self.is_meant {
            self.chip.stopped();
        }
        self.let_go();
    }

    fn rise(&mut self, sda: bool) {
        match &mut self.phase {
            Phase::Receive { byte, bits, .. } if *bits < 8 => {
                *byte = *byte << 1 | u8::from(sda);
                *bits += 1;
            }
            Phase::Asked { more } => *more = !sda,
            _ => {}
        }
    }

    fn fall(&mut self, faults: &mut Faults) {
        match self.phase {
            Phase::Receive { is_address, byte, bits: 8 } => self.received(is_address, byte, faults),
            Phase::Acknowledge { sends: true } | Phase::Asked { more: true } => self.send(),
            Phase::Acknowledge { sends: false } => {
                self.sda_low = false;
                self.phase = Phase::Receive { is_address: false, byte: 0, bits: 0 };
            }
            Phase::Send { left: 0, .. } => {
                self.sda_low = false;
                self.phase = Phase::Asked { more: false };
            }
            Phase::Send { byte, left } => self.put(byte << 1, left - 1),
            Phase::Asked { more: false } => self.phase = Phase::Idle,
            Phase::Idle | Phase::Receive { .. } => {}
        }
    }

    fn received(&mut self, is_address: bool, byte: u8, faults: &mut Faults) {
        let (address, is_read) = (byte >> 1, byte & 1 == 1);
        let acknowledges = if is_address {
            self.chip.answers(address) && faults.lets_answer(address)
        } else {
            self.chip.write(byte)
        };
        if is_address && acknowledges {
            self.is_meant = true;
            self.chip.addressed(address, is_read);
        }
        self.sda_low = acknowledges;
        let sends = is_address && is_read;
        self.phase = if acknowledges { Phase::Acknowledge { sends } } else { Phase::Idle };
    }

    fn send(&mut self) {
        let byte = self.chip.read();
        self.put(byte, 7);
    }

    const fn put(&mut self, byte: u8, left: u8) {
        self.sda_low = byte & 0x80 == 0;
        self.phase = Phase::Send { byte, left };
    }
}
