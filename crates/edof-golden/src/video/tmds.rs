//! The code of a colour's channel on a DVI cable (DVI 1.0, section 3: the encoder).

/// The symbols of control bits C1 and C0, by their number; the first bit is the lowest.
pub const CONTROL: [u16; 4] = [0b11_0101_0100, 0b00_1010_1011, 0b01_0101_0100, 0b10_1010_1011];

/// An encoder of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Tmds {
    /// By how many ones have exceeded zeros since the last symbol of control.
    pub disparity: i32,
}

impl Tmds {
    /// Returns the symbol of control bits C1 and C0.
    pub const fn control(&mut self, bits: u8) -> u16 {
        self.disparity = 0;
        CONTROL[bits as usize & 3]
    }

    /// Returns the symbol of a byte: its transitions minimised (bit 8: by XOR), then inverted where that balances the channel (bit 9).
    pub const fn pixel(&mut self, byte: u8) -> u16 {
        let by_xor = match byte.count_ones() {
            4 => byte & 1 == 1,
            ones => ones < 4,
        };
        let mut minimal = byte & 1;
        let mut i = 1;
        while i < 8 {
            let bit = (byte >> i & 1) ^ (minimal >> (i - 1) & 1) ^ !by_xor as u8;
            minimal |= bit << i;
            i += 1;
        }
        let excess = 2 * minimal.count_ones() as i32 - 8;
        let inverts = match self.disparity == 0 || excess == 0 {
            true => !by_xor,
            false => (self.disparity > 0) == (excess > 0),
        };
        let byte = if inverts { !minimal } else { minimal };
        let symbol = byte as u16 | (by_xor as u16) << 8 | (inverts as u16) << 9;
        self.disparity += 2 * symbol.count_ones() as i32 - 10;
        symbol
    }
}
