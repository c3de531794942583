//! Raw frames that the board makes itself (docs/contract.md, 1.3), word for word.

use edof_device::design::FrameSize;
use edof_device::pattern::{NOISE_SEED, Pattern, RAMP_COLUMN, RAMP_ROW, TILE_SIDE, WORD_MASK};
use edof_image::frame::FrameError;
use edof_image::{CfaPhase, RawFrame};
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

    const SIZE: FrameSize = FrameSize { width: 64, height: 48, stride: edof_image::Stride::PATCH };

    #[test]
    fn words_of_patterns_are_those_of_the_contract() {
        let word = |pattern, row, column| frame(pattern, SIZE).unwrap().pixels()[(row, column)];
        assert_eq!([word(Pattern::Ramp, 0, 0), word(Pattern::Ramp, 2, 3)], [0, 224]);
        assert_eq!([word(Pattern::Chart, 0, 16), word(Pattern::Chart, 17, 17)], [0x5554, 0x7774]);
        // Two steps of the register by another program: 0xe124b63a, 0x8b9a74ab.
        assert_eq!([word(Pattern::Noise, 0, 0), word(Pattern::Noise, 0, 1)], [0xe124, 0x8b98]);
    }
}
