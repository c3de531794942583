//! Raw frames that the board makes itself (docs/contract.md, 1.3), word for word.

use edof_core::frame::FrameError;
use edof_core::{CfaPhase, RawFrame};
use edof_device::design::FrameSize;
use edof_device::pattern::{NOISE_SEED, Pattern, RAMP_COLUMN, RAMP_ROW, TILE_SIDE, WORD_MASK};
use ndarray::Array2;

/// The frame of a pattern: red first, 16 bits.
///
/// # Errors
/// A size that no raw frame has.
pub fn frame(pattern: Pattern, size: FrameSize) -> Result<RawFrame, FrameError> {
    let shape = (size.height, size.width);
    let values = match pattern {
        Pattern::Ramp => Array2::from_shape_fn(shape, |(r, c)| ramp(r, c)),
        Pattern::Zeros => Array2::zeros(shape),
        Pattern::Ones => Array2::from_elem(shape, u16::MAX),
        Pattern::Alternating => {
            Array2::from_shape_fn(shape, |(_, c)| if c % 2 == 0 { 0x5555 } else { 0xaaaa })
        }
        Pattern::Chart => Array2::from_shape_fn(shape, |(r, c)| chart(r, c)),
        Pattern::Noise => {
            let mut register = NOISE_SEED;
            Array2::from_shape_simple_fn(shape, || {
                register = next(register);
                (register >> 16) as u16 & WORD_MASK
            })
        }
    };
    RawFrame::from_values(values, 16, CfaPhase::Rggb)
}

/// A tile again and again over a frame, as the board makes it of what the host wrote: red first, 16 bits.
///
/// # Errors
/// A size that no raw frame has.
pub fn tiled(tile: &Array2<u16>, size: FrameSize) -> Result<RawFrame, FrameError> {
    let values =
        Array2::from_shape_fn((size.height, size.width), |(r, c)| tile[(r % TILE_SIDE, c % TILE_SIDE)]);
    RawFrame::from_values(values, 16, CfaPhase::Rggb)
}

const fn ramp(row: usize, column: usize) -> u16 {
    (column as u16).wrapping_mul(RAMP_COLUMN).wrapping_add((row as u16).wrapping_mul(RAMP_ROW)) & WORD_MASK
}

const fn chart(row: usize, column: usize) -> u16 {
    let level = (5 * (column / 16) + 3 * (row / 16)) as u16 & 15;
    let level = if row % 2 == 1 && column % 2 == 1 { 15 - level } else { level };
    (level * 0x1111) & WORD_MASK
}

/// The next state of the shift register of 32 bits (xorshift 13, 17, 5), which comes round after 2^32 − 1 pixels.
const fn next(register: u32) -> u32 {
    let register = register ^ (register << 13);
    let register = register ^ (register >> 17);
    register ^ (register << 5)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: FrameSize = FrameSize { width: 64, height: 48, stride: edof_core::Stride::PATCH };

    /// Words of a pattern, row by row.
    fn words(pattern: Pattern) -> Vec<u16> {
        frame(pattern, SIZE).unwrap().pixels().iter().copied().collect()
    }

    #[test]
    fn plain_patterns_hold_the_same_words_in_every_row() {
        assert!(words(Pattern::Zeros).iter().all(|word| *word == 0));
        assert!(words(Pattern::Ones).iter().all(|word| *word == 0xffff));
        assert!(words(Pattern::Alternating).as_chunks().0.iter().all(|two| *two == [0x5555, 0xaaaa]));
    }

    #[test]
    fn a_ramp_rises_by_32_a_column_and_64_a_row() {
        let words = words(Pattern::Ramp);
        assert!(
            words.iter().enumerate().all(|(i, word)| usize::from(*word) == 32 * (i % 64) + 64 * (i / 64))
        );
        let wide = FrameSize { width: 2080, ..SIZE };
        // Column 2078 of row 1 is beyond 2^16.
        assert_eq!(frame(Pattern::Ramp, wide).unwrap().pixels()[(1, 2078)], 1024);
    }

    #[test]
    fn a_chart_has_squares_of_sixteen_pixels_whose_odd_sites_are_the_other_way_round() {
        let levels = [[0, 5, 10, 15], [3, 8, 13, 2], [6, 11, 0, 5]];
        for (i, word) in words(Pattern::Chart).into_iter().enumerate() {
            let (row, column) = (i / 64, i % 64);
            let level = levels[row / 16][column / 16];
            let is_odd = [row, column].iter().all(|at| at % 2 == 1);
            let level = if is_odd { 15 - level } else { level };
            assert_eq!(
                word,
                level * 0x1000 + level * 0x100 + level * 0x10 + level / 4 * 4,
                "{row}, {column}"
            );
        }
    }

    /// Numbers of another program.
    #[test]
    fn noise_is_that_of_the_contract_to_its_last_word() {
        let words = words(Pattern::Noise);
        assert_eq!(words[..4], [0xe124, 0x8b98, 0x64e0, 0x0014]);
        assert_eq!([words[64], words[64 * 48 - 1]], [0x538c, 0x1df0]);
        assert_eq!(words.into_iter().map(u32::from).sum::<u32>(), 0x603_0700);
    }

    #[test]
    fn a_tile_comes_again_every_64_rows_and_columns() {
        let tile = Array2::from_shape_fn((TILE_SIDE, TILE_SIDE), |(r, c)| (r * 1000 + c) as u16);
        let size = FrameSize { width: 130, height: 66, ..SIZE };
        let frame = tiled(&tile, size).unwrap();
        assert_eq!(frame.size(), (66, 130));
        let word = |row, column| frame.pixels()[(row, column)];
        assert_eq!([word(3, 2), word(3, 66), word(3, 129), word(65, 63)], [3002, 3002, 3001, 1063]);
    }

    #[test]
    fn words_of_patterns_are_those_of_the_contract() {
        let word = |pattern, row, column| frame(pattern, SIZE).unwrap().pixels()[(row, column)];
        assert_eq!([word(Pattern::Ramp, 0, 0), word(Pattern::Ramp, 2, 3)], [0, 224]);
        assert_eq!([word(Pattern::Chart, 0, 16), word(Pattern::Chart, 17, 17)], [0x5554, 0x7774]);
        // Two steps of the register by another program: 0xe124b63a, 0x8b9a74ab.
        assert_eq!([word(Pattern::Noise, 0, 0), word(Pattern::Noise, 0, 1)], [0xe124, 0x8b98]);
    }
}
