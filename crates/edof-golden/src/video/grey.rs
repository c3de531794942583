//! Raw frames in grey, as a PC's graphics card can send them (docs/contract.md, 1.4): two luma codes of seven bits per raw pixel word, two
//! frames of video per raw frame. Chroma carries nothing.
//!
//! A mark in each word says to which half of which frame it belongs, so that parts of two raw frames are never joined.

use edof_core::cable::CODES;
use edof_core::{CfaPhase, RawFrame};
use edof_device::crc::of_words;
use ndarray::Array2;

/// Bits of a word that are carried, from the top.
pub const CARRIED_BITS: u32 = 13;
/// Marks of a line before they repeat: bits of a tag.
pub const MARKS: usize = 16;
/// Bit of a tag: the lower half of its frame.
pub const LOWER: u16 = 1;

/// Luma codes of a raw pixel word and its mark.
///
/// ```
/// use edof_golden::video::grey::{codes, word};
/// assert_eq!(codes(0x9e37, true), [143, 77]);
/// assert_eq!(word([143, 77]), Some((0x9e30, true)));
/// assert_eq!(word([143, 192]), None);
/// ```
#[must_use]
pub const fn codes(word: u16, mark: bool) -> [u8; 2] {
    let offset = *CODES.start();
    [(word >> 9) as u8 + offset, (word >> 2 & 0x7e) as u8 + mark as u8 + offset]
}

/// The raw pixel word of two luma codes, its three lowest bits 0, and its mark; none where a code carries nothing.
#[must_use]
pub fn word(codes: [u8; 2]) -> Option<(u16, bool)> {
    let [upper, lower] = codes.map(|code| CODES.contains(&code).then(|| u16::from(code - CODES.start())));
    Some((upper? << 9 | (lower? & 0x7e) << 2, lower? & 1 == 1))
}

/// A frame as it comes out of [`halves`]: the bits that are not carried are 0. A frame of at most 13 bits is not changed.
#[must_use]
pub fn carried(frame: &RawFrame) -> RawFrame {
    frame.with_mask(u16::MAX << (16 - CARRIED_BITS))
}

/// The tag of a frame's upper half: 15 bits of the CRC of the words that are carried, above [`LOWER`].
#[must_use]
pub fn tag(frame: &RawFrame) -> u16 {
    (of_words(carried(frame).pixels().iter().copied()) as u16) << 1
}

/// Luma codes of the two frames of video of a raw frame: the upper half, the lower half.
#[must_use]
pub fn halves(frame: &RawFrame) -> [Array2<u8>; 2] {
    let (size, tag) = (frame.size(), tag(frame));
    let words: Vec<u16> = frame.pixels().iter().copied().collect();
    let half = |words: &[u16], tag: u16| {
        let mark = |place: usize| tag >> (place % (size.1 / 2) % MARKS) & 1 == 1;
        let codes = words.iter().enumerate().flat_map(|(place, word)| codes(*word, mark(place)));
        let codes: Vec<u8> = codes.collect();
        Array2::from_shape_fn(size, |(row, column)| codes[row * size.1 + column])
    };
    let (upper, lower) = words.split_at(words.len() / 2);
    [half(upper, tag), half(lower, tag | LOWER)]
}

/// The raw frame of two frames of video, red first and of 16 bits; none where a code or a mark is not that of one frame.
#[must_use]
pub fn joined([upper, lower]: [&Array2<u8>; 2]) -> Option<RawFrame> {
    let (tag, mut words) = read(upper)?;
    let (other, more) = read(lower)?;
    words.extend(more);
    let words = Array2::from_shape_vec(upper.dim(), words).ok()?;
    let is_one = tag & LOWER == 0 && other == tag | LOWER && upper.dim() == lower.dim();
    is_one.then(|| RawFrame::from_values(words, 16, CfaPhase::Rggb).ok())?
}

/// The tag of a half, as far as a line has marks, and its words.
fn read(half: &Array2<u8>) -> Option<(u16, Vec<u16>)> {
    let (mut tag, mut words) = (None, vec![]);
    for line in half.rows() {
        let mut of_line = 0;
        for (place, pair) in line.to_vec().chunks_exact(2).enumerate() {
            let (word, mark) = word([pair[0], pair[1]])?;
            let bit = u16::from(mark) << (place % MARKS);
            if place >= MARKS && bit != of_line & 1 << (place % MARKS) {
                return None;
            }
            of_line |= bit;
            words.push(word);
        }
        if *tag.get_or_insert(of_line) != of_line {
            return None;
        }
    }
    Some((tag?, words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::draw::Draw;

    fn frame(seed: u64, (height, width): (usize, usize)) -> RawFrame {
        let mut draw = Draw::new(seed);
        let words = Array2::from_shape_simple_fn((height, width), || draw.bits() as u16);
        RawFrame::from_values(words, 16, CfaPhase::Rggb).unwrap()
    }

    #[test]
    fn every_word_comes_back_without_its_three_lowest_bits() {
        for value in 0..=u16::MAX {
            for mark in [false, true] {
                let sent = codes(value, mark);
                assert!(sent.iter().all(|code| CODES.contains(code)), "{value}: {sent:?}");
                assert_eq!(word(sent), Some((value / 8 * 8, mark)));
            }
        }
    }

    /// The places and marks of docs/contract.md, 1.4, written out for a frame of 4 × 36 words.
    #[test]
    fn words_lie_where_the_contract_says() {
        let frame = frame(1, (4, 36));
        let tag = tag(&frame);
        assert_eq!(tag & LOWER, 0);
        for (half, codes) in halves(&frame).iter().enumerate() {
            assert_eq!(codes.dim(), (4, 36));
            for ((r, c), word) in frame.pixels().indexed_iter().filter(|((r, _), _)| r / 2 == half) {
                let (line, place) = (2 * (r % 2) + c / 18, c % 18);
                let mark = (tag | half as u16) >> (place % 16) & 1;
                assert_eq!(u16::from(codes[(line, 2 * place)]), (word >> 9) + 64);
                assert_eq!(u16::from(codes[(line, 2 * place + 1)]), (word >> 3 & 63) * 2 + mark + 64);
            }
        }
    }

    #[test]
    fn a_frame_comes_back_of_its_own_halves_alone() {
        for size in [(4, 36), (12, 18), (2, 48)] {
            let [a, b] = [1, 2].map(|seed| frame(seed, size));
            let ([a0, a1], [b0, b1]) = (halves(&a), halves(&b));
            assert_eq!(joined([&a0, &a1]), Some(carried(&a)));
            for wrong in [[&a0, &b1], [&b0, &a1], [&a1, &a0], [&a0, &a0], [&a1, &a1]] {
                assert_eq!(joined(wrong), None, "{size:?}");
            }
            // A picture that changed while it was sent: from some line on it is another one's.
            for line in 1..size.0 {
                let torn =
                    Array2::from_shape_fn(size, |(r, c)| if r < line { a1[(r, c)] } else { b1[(r, c)] });
                assert_eq!(joined([&a0, &torn]), None, "{size:?}, line {line}");
            }
        }
    }
}
