//! CRC-32 of frames, as the board makes it of the words that pass its boundaries.

/// The polynomial x^32 + x^22 + x^2 + x + 1, the highest power in the lowest bit and x^32 left out. It is primitive, so that a single wrong bit has a
/// CRC of its own in any frame; it has few terms, so that a circuit takes 32 bits a cycle with a third of what IEEE 802.3's takes.
pub const POLYNOMIAL: u32 = 0xe000_0200;

const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut crc, mut bits) = (byte as u32, 8);
        while bits > 0 {
            crc = (crc >> 1) ^ (POLYNOMIAL & (crc & 1).wrapping_neg());
            bits -= 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

/// CRC of 32 bits of words of 16 bits, the lowest bit of the first one first, begun with and combined at the end with all ones (docs/contract.md, 9).
///
/// ```
/// use edof_device::crc::of_words;
/// assert_eq!(of_words([0x3231, 0x3433, 0x3635, 0x3837]), 0x9628_d41f);
/// ```
pub fn of_words(words: impl IntoIterator<Item = u16>) -> u32 {
    let step = |crc: u32, byte: u8| crc >> 8 ^ TABLE[(crc as u8 ^ byte) as usize];
    !words.into_iter().fold(!0, |crc, word| word.to_le_bytes().into_iter().fold(crc, step))
}

/// Where a bit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Word, 0 first.
    pub word: usize,
    /// Bit of it, 0 lowest.
    pub bit: usize,
}

/// The one bit of a frame of N words that is wrong, from the CRCs of the right and the wrong frame combined by exclusive or. None where
/// no single bit explains it. It is unique as long as a frame has fewer than 2^32 − 1 bits.
///
/// ```
/// use edof_device::crc::{Place, of_words, single_bit};
/// let difference = of_words([1, 2, 3]) ^ of_words([1, 2 ^ 0x40, 3]);
/// assert_eq!(single_bit(difference, 3), Some(Place { word: 1, bit: 6 }));
/// ```
#[must_use]
pub fn single_bit(difference: u32, words: usize) -> Option<Place> {
    // The last bit's wrong value passes the register once, each bit before it once more.
    let mut syndrome = POLYNOMIAL;
    for from_end in 0..16 * words {
        if syndrome == difference {
            let at = 16 * words - 1 - from_end;
            return Some(Place { word: at / 16, bit: at % 16 });
        }
        syndrome = (syndrome >> 1) ^ (POLYNOMIAL & (syndrome & 1).wrapping_neg());
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crc_is_a_shift_register_fed_bit_by_bit() {
        let words = [0x1234, 0xfedc, 0, 0x8001];
        let bits = words.iter().flat_map(|word: &u16| (0..16).map(move |bit| u32::from(word >> bit) & 1));
        let step = |crc: u32, bit: u32| (crc >> 1) ^ if (crc ^ bit) & 1 == 1 { POLYNOMIAL } else { 0 };
        assert_eq!(of_words(words), !bits.fold(!0, step));
    }
}
