//! Raw pixel words on a video cable (docs/contract.md, 1.1): the upper 14 bits of a word, seven on luma and seven on chroma, both 64…191.
//!
//! Between are codes that no link clips, reserves or takes for a sync. The two lowest bits of a word stay behind.

use crate::RawFrame;
use std::ops::RangeInclusive;

/// Codes that carry a raw pixel word.
pub const CODES: RangeInclusive<u8> = 64..=191;
/// Bits of a word that are carried, from the top.
pub const CARRIED_BITS: u32 = 14;

/// The luma and chroma code of a raw pixel word.
///
/// ```
/// use edof_core::cable::{codes, word};
/// assert_eq!(codes(0xfffc), [191, 191]);
/// assert_eq!(word(codes(0x1237)), Some(0x1234));
/// assert_eq!(word([63, 100]), None);
/// ```
#[must_use]
pub const fn codes(word: u16) -> [u8; 2] {
    let offset = *CODES.start();
    [(word >> 9) as u8 + offset, (word >> 2 & 0x7f) as u8 + offset]
}

/// The raw pixel word of a luma and a chroma code, its two lowest bits 0; none where one of them carries nothing.
#[must_use]
pub fn word(codes: [u8; 2]) -> Option<u16> {
    let [luma, chroma] = codes.map(|code| CODES.contains(&code).then(|| u16::from(code - CODES.start())));
    Some(luma? << 9 | chroma? << 2)
}

/// A frame as it comes out of a cable: the bits that are not carried are 0. A frame of at most 14 bits is not changed.
#[must_use]
pub fn carried(frame: &RawFrame) -> RawFrame {
    frame.with_mask(u16::MAX << (16 - CARRIED_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CfaPhase;
    use ndarray::Array2;

    #[test]
    fn every_word_comes_back_without_its_two_lowest_bits() {
        for value in 0..=u16::MAX {
            let sent = codes(value);
            assert!(sent.iter().all(|code| (64..=191).contains(code)), "{value}: {sent:?}");
            assert_eq!(word(sent), Some(value / 4 * 4));
        }
    }

    #[test]
    fn a_code_outside_of_the_range_carries_nothing() {
        for code in 0..=u8::MAX {
            let is_carried = (64..=191).contains(&code);
            assert_eq!(
                [word([code, 64]), word([191, code])].map(|word| word.is_some()),
                [is_carried; 2],
                "{code}"
            );
        }
    }

    #[test]
    fn frames_of_fourteen_bits_or_fewer_are_carried_whole() {
        let frame = |depth: u32| {
            let values = Array2::from_shape_fn((4, 6), |(r, c)| ((1 << depth) - 1 - 6 * r - c) as u16);
            RawFrame::from_values(values, depth, CfaPhase::Grbg).unwrap()
        };
        for depth in 8..=14 {
            assert_eq!(carried(&frame(depth)), frame(depth));
        }
        for depth in [15, 16] {
            let lost = &frame(depth).pixels().mapv(|word| word % 4);
            assert_eq!(carried(&frame(depth)).pixels() + lost, frame(depth).pixels());
            assert!(lost.iter().any(|lost| *lost > 0));
        }
    }
}
