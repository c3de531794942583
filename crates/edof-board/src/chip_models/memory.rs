//! Chips that are nothing but bytes to us: EEPROMs, clock synthesisers, thermometers.

use crate::chip_models::wire::Target;

/// Bytes behind a pointer that a write sets and that moves on.
#[derive(Debug, Clone)]
pub struct Bytes {
    address: u8,
    /// Bits of the pointer that count.
    mask: u8,
    is_written: bool,
    pointer: u8,
    has_pointer: bool,
    bytes: [u8; 256],
}

impl Bytes {
    /// An EEPROM whose write-protect pin is set.
    #[must_use]
    pub const fn eeprom(address: u8, bytes: [u8; 256]) -> Self {
        Self { address, mask: 0xff, is_written: false, pointer: 0, has_pointer: false, bytes }
    }

    /// A chip with registers that take any value.
    #[must_use]
    pub const fn registers(address: u8) -> Self {
        Self { is_written: true, ..Self::eeprom(address, [0; 256]) }
    }

    /// The FMC-IMAGEON's CDCE913 at 0x65, whose pointer's top bit says "one byte" (TI SCAS849, generic programming).
    #[must_use]
    pub const fn cdce913() -> Self {
        Self { mask: 0x7f, ..Self::registers(0x65) }
    }

    /// A byte.
    #[must_use]
    pub const fn byte(&self, place: u8) -> u8 {
        self.bytes[place as usize]
    }
}

impl Target for Bytes {
    fn answers(&self, address: u8) -> bool {
        address == self.address
    }

    fn addressed(&mut self, _: u8, _: bool) {
        self.has_pointer = false;
    }

    fn write(&mut self, byte: u8) -> bool {
        if !self.has_pointer {
            (self.pointer, self.has_pointer) = (byte & self.mask, true);
        } else if self.is_written {
            self.bytes[usize::from(self.pointer)] = byte;
            self.pointer = self.pointer.wrapping_add(1) & self.mask;
        }
        true
    }

    fn read(&mut self) -> u8 {
        let byte = self.bytes[usize::from(self.pointer)];
        self.pointer = self.pointer.wrapping_add(1) & self.mask;
        byte
    }
}
