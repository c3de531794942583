//! The frames on the line, those of LiteX's UARTBone: command, number of words, address of the first word (four bytes, the most
//! significant first), and for a write the words in the same order. Addresses here are of bytes.
//!
//! ```
//! use edof_board::protocol::{read, write};
//! assert_eq!(read(0x14, 1), [2, 1, 0, 0, 0, 5]);
//! assert_eq!(write(0x14, &[7]), [1, 1, 0, 0, 0, 5, 0, 0, 0, 7]);
//! ```

/// Writes words from an address on.
pub const WRITE: u8 = 1;
/// Reads words from an address on.
pub const READ: u8 = 2;
/// Writes all words to one address.
pub const WRITE_FIXED: u8 = 3;
/// Reads one address again and again.
pub const READ_FIXED: u8 = 4;
/// Words of a frame.
pub const MAX_WORDS: usize = 255;
/// Bytes before the words.
pub const HEADER: usize = 6;

/// A frame that writes words, [`MAX_WORDS`] at most, from a byte address on.
#[must_use]
pub fn write(address: u32, words: &[u32]) -> Vec<u8> {
    let words = &words[..words.len().min(MAX_WORDS)];
    let data = words.iter().flat_map(|word| word.to_be_bytes());
    header(WRITE, address, words.len()).chain(data).collect()
}

/// A frame that reads N words, [`MAX_WORDS`] at most, from a byte address on.
#[must_use]
pub fn read(address: u32, words: usize) -> Vec<u8> {
    header(READ, address, words).collect()
}

fn header(command: u8, address: u32, words: usize) -> impl Iterator<Item = u8> {
    [command, words.min(MAX_WORDS) as u8].into_iter().chain((address / 4).to_be_bytes())
}

/// The words that whole groups of four bytes make.
#[must_use]
pub fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|four| four.iter().fold(0, |word, byte| word << 8 | u32::from(*byte))).collect()
}
