//! A camera's bus as that of a receiver.

use super::Pins;
use edof_core::cable;

/// Cycles of a pause in the middle of which a horizontal sync comes.
const PAUSE: u32 = 4096;

/// A camera's bus since reset.
#[derive(Debug, Clone)]
pub struct CameraIn {
    black: u8,
    pause: u32,
    pins: Pins,
}

impl CameraIn {
    /// Of a camera whose black is such a byte.
    #[must_use]
    pub fn new(black: u8) -> Self {
        Self { black, pause: 0, pins: Pins::default() }
    }

    /// What the receiver's bus has.
    #[must_use]
    pub const fn pins(&self) -> Pins {
        self.pins
    }

    /// One cycle: vertical sync, line reference and byte in it.
    pub fn step(&mut self, vs: bool, href: bool, byte: u8) {
        self.pause = if href { 0 } else { (self.pause + 1) % PAUSE };
        let word = u16::from(byte.saturating_sub(self.black)) << 8;
        let data = u16::from_le_bytes(cable::codes(word));
        self.pins = Pins { hs: href || self.pause >= PAUSE / 2, vs, de: href, data };
    }
}
