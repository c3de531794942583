//! A master in Rust: transfers on any bus, bit by bit on its wires.

use crate::chip_models::wire::{Lines, Pulls, Wires};

/// Why a transfer did not come to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// A byte was not acknowledged.
    #[error("device {device:#04x} does not acknowledge byte {byte}; 0 is its address")]
    Refused {
        /// 7-bit address.
        device: u8,
        /// Number of the byte in the transfer, its address byte is 0.
        byte: usize,
    },
    /// The data line was low while the master left it high.
    #[error("another master took the bus from a transfer with device {device:#04x}")]
    Arbitration {
        /// 7-bit address.
        device: u8,
    },
    /// The data line is low although nobody talks.
    #[error("the data line is stuck low")]
    SdaLow,
    /// The clock line stays low.
    #[error("the clock line is stuck low")]
    SclLow,
}

/// Samples that a line is waited for.
const PATIENCE: usize = 100_000;

/// A master of a bus.
#[derive(Debug)]
pub struct Master<W> {
    bus: W,
    pulls: Pulls,
}

impl<W: Wires> Master<W> {
    /// The only master, both lines left alone.
    pub const fn new(bus: W) -> Self {
        Self { bus, pulls: Pulls { scl_low: false, sda_low: false } }
    }

    /// The bus.
    pub const fn bus(&mut self) -> &mut W {
        &mut self.bus
    }

    /// Writes bytes to a device.
    ///
    /// # Errors
    /// [`Error`]; the bus is left idle, if it can be.
    pub fn write(&mut self, device: u8, bytes: &[u8]) -> Result<(), Error> {
        let written = self.start().and_then(|()| self.send(device, false, bytes));
        self.end(written)
    }

    /// Writes bytes, then reads after a repeated start.
    ///
    /// # Errors
    /// As [`Master::write`].
    pub fn read(&mut self, device: u8, pointer: &[u8], count: usize) -> Result<Vec<u8>, Error> {
        let got = self.transfer(device, pointer, count);
        self.end(got)
    }

    /// Nine clocks and a stop, as a bus whose data line is stuck is freed. Returns whether it is.
    pub fn free(&mut self) -> bool {
        self.pulls.sda_low = false;
        for _ in 0..9 {
            self.pulls.scl_low = true;
            self.settle();
            self.pulls.scl_low = false;
            self.settle();
        }
        let _ = self.stop();
        self.settle().sda
    }

    fn transfer(&mut self, device: u8, pointer: &[u8], count: usize) -> Result<Vec<u8>, Error> {
        self.start()?;
        if !pointer.is_empty() {
            self.send(device, false, pointer)?;
            self.start()?;
        }
        self.send(device, true, &[])?;
        (0..count).map(|i| self.receive(device, i + 1 == count)).collect()
    }

    fn end<T>(&mut self, result: Result<T, Error>) -> Result<T, Error> {
        if matches!(result, Err(Error::Arbitration { .. })) {
            self.pulls = Pulls::default();
            self.settle();
        } else {
            let stopped = self.stop();
            if result.is_ok() {
                stopped?;
            }
        }
        result
    }

    /// A few samples, after which every chip has seen the lines.
    fn settle(&mut self) -> Lines {
        for _ in 0..3 {
            self.bus.step(self.pulls);
        }
        self.bus.step(self.pulls)
    }

    /// Lets the clock rise, which a chip may delay.
    fn rise(&mut self) -> Result<Lines, Error> {
        self.pulls.scl_low = false;
        for _ in 0..PATIENCE {
            let lines = self.settle();
            if lines.scl {
                return Ok(lines);
            }
        }
        Err(Error::SclLow)
    }

    /// Start, or a repeated one.
    fn start(&mut self) -> Result<(), Error> {
        self.pulls.sda_low = false;
        self.settle();
        if !self.rise()?.sda {
            return Err(Error::SdaLow);
        }
        self.pulls.sda_low = true;
        self.settle();
        self.pulls.scl_low = true;
        self.settle();
        Ok(())
    }

    fn stop(&mut self) -> Result<(), Error> {
        self.pulls.scl_low = true;
        self.settle();
        self.pulls.sda_low = true;
        self.settle();
        self.rise()?;
        self.pulls.sda_low = false;
        if self.settle().sda { Ok(()) } else { Err(Error::SdaLow) }
    }

    /// A bit; what was on the line while the clock was high.
    fn bit(&mut self, high: bool) -> Result<bool, Error> {
        self.pulls.sda_low = !high;
        self.settle();
        let sda = self.rise()?.sda;
        self.pulls.scl_low = true;
        self.settle();
        Ok(sda)
    }

    fn send(&mut self, device: u8, is_read: bool, bytes: &[u8]) -> Result<(), Error> {
        let address = device << 1 | u8::from(is_read);
        for (number, byte) in std::iter::once(&address).chain(bytes).enumerate() {
            for place in (0..8).rev() {
                let bit = byte >> place & 1 == 1;
                if self.bit(bit)? != bit {
                    return Err(Error::Arbitration { device });
                }
            }
            if self.bit(true)? {
                return Err(Error::Refused { device, byte: number });
            }
        }
        Ok(())
    }

    fn receive(&mut self, device: u8, is_last: bool) -> Result<u8, Error> {
        let mut byte = 0;
        for _ in 0..8 {
            byte = byte << 1 | u8::from(self.bit(true)?);
        }
        if self.bit(is_last)? != is_last {
            return Err(Error::Arbitration { device });
        }
        Ok(byte)
    }
}
