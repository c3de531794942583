//! I2C switches: PCA9548A (eight channels) and PCA9546A (four).
//!
//! Source: NXP PCA9548A Rev. 5.1 and PCA9546A Rev. 6, §6.2: one control byte, the last byte of a write counts, a channel opens after the
//! stop condition, reset and power-up close all channels.

use crate::chip_models::wire::Target;

/// A switch; its control register has a bit per channel.
#[derive(Debug, Clone)]
pub struct Switch {
    address: u8,
    mask: u8,
    is_reset: bool,
    control: u8,
    /// Channels that are connected: the control register as it was at the last stop.
    open: u8,
}

impl Switch {
    /// PCA9548A with all address pins high or low as on the KC705: 0x74 (UG810 page 53).
    pub const PCA9548A: Self = Self::new(0x74, 0xff);
    /// PCA9546A with all address pins low, as on the FMC-IMAGEON: 0x70 (zynq-zed-imageon.dts).
    pub const PCA9546A: Self = Self::new(0x70, 0x0f);

    const fn new(address: u8, mask: u8) -> Self {
        Self { address, mask, is_reset: true, control: 0, open: 0 }
    }

    /// The level of the reset pin, which is active low.
    pub const fn set_reset(&mut self, high: bool) {
        self.is_reset = !high;
        if !high {
            (self.control, self.open) = (0, 0);
        }
    }

    /// Whether a channel is connected.
    #[must_use]
    pub const fn is_open(&self, channel: u8) -> bool {
        self.open >> channel & 1 == 1
    }
}

impl Target for Switch {
    fn is_alive(&self) -> bool {
        !self.is_reset
    }

    fn answers(&self, address: u8) -> bool {
        address == self.address
    }

    fn addressed(&mut self, _: u8, _: bool) {}

    fn write(&mut self, byte: u8) -> bool {
        self.control = byte & self.mask;
        true
    }

    fn read(&mut self) -> u8 {
        self.control
    }

    fn stopped(&mut self) {
        self.open = self.control;
    }
}
