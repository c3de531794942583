//! Fixed-point words: the board's number formats and the one way they are rounded.
//!
//! All vectors and weights are `i16` with a count of fraction bits that their layer states; sums are `i48` (kept in `i64`).
//! The counts are data, chosen for each layer when a network is quantized and read from its file, so no type can carry them.

/// Fraction bits of a raw pixel once it is a network input (Q0.15).
pub const INPUT_FRACTION: u32 = 15;
/// Fraction bits of F's outputs: luma in units of 2^−14, chroma in units of 2^−14/[`CHROMA_GAIN`].
pub const OUTPUT_FRACTION: u32 = 14;
/// Chroma rows of F carry this factor, so that 7 fraction bits of an output word stand below one 8-bit chroma code
/// (224 chroma codes for the full range: 224·2^7 = 1.75·2^14).
pub const CHROMA_GAIN: f64 = 1.75;
/// Bits of a chroma output word below its 8-bit code.
pub const CHROMA_SHIFT: u32 = 7;
/// Width of the accumulator of a DSP48E1.
pub const ACCUMULATOR_BITS: u32 = 48;

/// The network's input for a raw pixel: `pixel >> 1` as Q0.15 (docs/contract.md).
///
/// ```
/// use edof_core::number::{INPUT_FRACTION, input_word};
/// assert_eq!(f64::from(input_word(0x8000)) / f64::from(1 << INPUT_FRACTION), 0.5);
/// ```
#[must_use]
#[inline]
pub const fn input_word(pixel: u16) -> i16 {
    (pixel >> 1) as i16
}

/// `(acc + 2^(shift−1)) >> shift`, ties toward +∞, saturated to `bits` bits. The rounding of every stage. The second value
/// is whether it saturated.
#[must_use]
pub const fn requantize(acc: i64, shift: u32, bits: u32) -> (i16, bool) {
    let rounded = if shift == 0 { acc } else { (acc + (1 << (shift - 1))) >> shift };
    saturate(rounded, bits)
}

/// Nearest value that `bits` bits (at most 16) can hold, and whether that is another one.
#[must_use]
pub const fn saturate(value: i64, bits: u32) -> (i16, bool) {
    let largest = (1i64 << (bits - 1)) - 1;
    if value > largest {
        (largest as i16, true)
    } else if value < -largest - 1 {
        ((-largest - 1) as i16, true)
    } else {
        (value as i16, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ties_round_toward_plus_infinity() {
        assert_eq!([6, 5, -5, -6, -7].map(|a| requantize(a, 2, 16).0), [2, 1, -1, -1, -2]);
    }

    #[test]
    fn a_shift_of_zero_has_no_rounding_term() {
        assert_eq!(requantize(-3, 0, 16), (-3, false));
    }

    proptest! {
        #[test]
        fn rounding_is_floor_of_the_half_shifted_quotient(acc in -(1i64 << 46)..(1i64 << 46), shift in 0u32..40) {
            let exact = (acc as f64 / (shift as f64).exp2() + 0.5).floor();
            prop_assert_eq!(f64::from(requantize(acc, shift, 16).0), exact.clamp(-32768.0, 32767.0));
        }
    }
}
