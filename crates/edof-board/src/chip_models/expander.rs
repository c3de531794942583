//! PCA9534: eight pins behind I2C.
//!
//! Source: NXP PCA9534 §6.2 and 6.3: command byte 0 input, 1 output (FF), 2 polarity (00), 3 configuration (FF: inputs); the command stays for
//! every further byte of the transfer. It has no reset pin.

use crate::chip_models::wire::Target;

/// A PCA9534 at 0x20.
#[derive(Debug, Clone)]
pub struct Pca9534 {
    command: u8,
    has_command: bool,
    output: u8,
    polarity: u8,
    configuration: u8,
    /// Levels that others drive onto pins that are inputs.
    pub inputs: u8,
}

/// All address pins low, as on the FMC-IMAGEON (Avnet, `fmc_imageon.c`).
const ADDRESS: u8 = 0x20;

impl Default for Pca9534 {
    fn default() -> Self {
        Self { command: 0, has_command: false, output: 0xff, polarity: 0, configuration: 0xff, inputs: 0 }
    }
}

impl Pca9534 {
    /// The level that a pin drives; none while it is an input.
    #[must_use]
    pub const fn drives(&self, pin: u8) -> Option<bool> {
        if self.configuration >> pin & 1 == 1 { None } else { Some(self.output >> pin & 1 == 1) }
    }

    /// Levels on the pins: what is driven, and what comes from outside on inputs.
    #[must_use]
    pub const fn levels(&self) -> u8 {
        (self.output & !self.configuration) | (self.inputs & self.configuration)
    }
}

impl Target for Pca9534 {
    fn answers(&self, address: u8) -> bool {
        address == ADDRESS
    }

    fn addressed(&mut self, _: u8, _: bool) {
        self.has_command = false;
    }

    fn write(&mut self, byte: u8) -> bool {
        if !self.has_command {
            (self.command, self.has_command) = (byte & 3, true);
            return true;
        }
        match self.command {
            1 => self.output = byte,
            2 => self.polarity = byte,
            3 => self.configuration = byte,
            _ => {}
        }
        true
    }

    fn read(&mut self) -> u8 {
        match self.command {
            0 => self.levels() ^ self.polarity,
            1 => self.output,
            2 => self.polarity,
            _ => self.configuration,
        }
    }
}
