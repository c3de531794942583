//! The video chips around the board, register by register, through the engines that set them up.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_device::i2c::Cause;
use edof_device::registers::map::{CHIP_ACCESS, CHIP_ANSWER};

/// Which I2C bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bus {
    /// The board's own: multiplexer and transmitter.
    Board,
    /// The video card's: multiplexer, expander and receiver.
    Card,
}

/// A register of a chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChipRegister {
    /// The chip's bus.
    pub bus: Bus,
    /// 7-bit address of the chip.
    pub device: u8,
    /// The register.
    pub register: u8,
}

/// Looks at an answer before it is given up: a set-up that waits serves the host every millisecond.
const MAX_LOOKS: usize = 2_000;
const READ: u32 = 1 << 23;
const CARD: u32 = 1 << 25;

impl<L: Line> Board<L> {
    /// Reads a register of a chip.
    ///
    /// # Errors
    /// The chip does not answer, or the line fails.
    pub fn read_chip(&mut self, place: ChipRegister) -> Result<u8, Error> {
        self.access(place, READ)
    }

    /// Writes a register of a chip.
    ///
    /// # Errors
    /// As [`Board::read_chip`].
    pub fn write_chip(&mut self, place: ChipRegister, value: u8) -> Result<(), Error> {
        self.access(place, value.into()).map(drop)
    }

    fn access(&mut self, place: ChipRegister, what: u32) -> Result<u8, Error> {
        let before = self.link.read(CHIP_ACCESS, 1)?[0];
        let sequence = (before >> 28).wrapping_add(1) & 15;
        let bus = if place.bus == Bus::Card { CARD } else { 0 };
        let chip = u32::from(place.device) << 16 | u32::from(place.register) << 8;
        self.link.set(CHIP_ACCESS, what | chip | bus | sequence << 28)?;
        for _ in 0..MAX_LOOKS {
            let answer = self.link.read(CHIP_ANSWER, 1)?[0];
            if answer >> 28 == sequence {
                let refused = |cause| Error::Chip { port: self.port(), device: place.device, cause };
                return Cause::of_number(answer >> 8 & 7)
                    .map_or(Ok(answer as u8), |cause| Err(refused(cause)));
            }
        }
        Err(Error::NoSetUp { port: self.port() })
    }
}
