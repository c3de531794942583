//! Fixed-point words: the board's number formats and the one way they are rounded.
//!
//! A format that all networks share is a type of the crate `fixed`. Weights, pre-activations and codes are `i16` with a count of
//! fraction bits that their layer states: the counts are data, chosen when a network is quantized and read from its file
//! (`docs/decisions/0055-formats-as-types.md`). Sums are `i48`, kept in `i64`.

use bytemuck::TransparentWrapper;
pub use fixed::traits::Fixed;
use fixed::types::{I1F15, I2F14, I18F14, I24F8, I32F0, U0F16, U2F14};

/// A raw pixel: light of 0 to 1 − 2^−16.
pub type RawWord = U0F16;
/// A network's input.
pub type InputWord = I1F15;
/// An output of F, and a sample of a 4:2:2 frame: luma, or a colour difference times [`CHROMA_GAIN`].
pub type OutputWord = I2F14;
/// A sum of output words: overlapping patches, doubled chroma, light of one colour.
pub type OutputSum = I18F14;
/// Light of 0 to 1, as the address of a colour's table.
pub type TableIndex = U2F14;

/// Fraction bits of a raw pixel once it is a network input.
pub const INPUT_FRACTION: u32 = InputWord::FRAC_NBITS;
/// Fraction bits of F's outputs.
pub const OUTPUT_FRACTION: u32 = OutputWord::FRAC_NBITS;
/// Chroma rows of F carry this factor, so that 7 fraction bits of an output word stand below one 8-bit chroma code
/// (224 chroma codes for the full range: 224·2^7 = 1.75·2^14).
pub const CHROMA_GAIN: f64 = 1.75;
/// The bits of a doubled chroma word in units of an 8-bit chroma code: 7 fraction bits, and one for the doubling.
pub type ChromaCodes = I24F8;
/// Width of the accumulator of a DSP48E1.
pub const ACCUMULATOR_BITS: u32 = 48;

/// Returns the network's input for a raw pixel: its last bit is dropped (docs/contract.md, 2).
///
/// ```
/// use edof_core::number::{InputWord, input_word};
/// assert_eq!(input_word(0x8001), InputWord::lit("0.5"));
/// ```
#[must_use]
#[inline]
pub fn input_word(pixel: u16) -> InputWord {
    InputWord::from_num(RawWord::from_bits(pixel))
}

/// Returns the value of an input word. `to_num` of `fixed` gives the same, and takes many times as long.
#[must_use]
#[inline]
pub fn input_value(word: InputWord) -> f32 {
    f32::from(word.to_bits()) / (1 << INPUT_FRACTION) as f32
}

/// Returns the value of an output word, as [`input_value`] does.
#[must_use]
#[inline]
pub fn output_value(word: OutputWord) -> f64 {
    f64::from(word.to_bits()) / f64::from(1 << OUTPUT_FRACTION)
}

/// Rounds to a format of fewer fraction bits: nearest, ties toward +∞, saturated (`requantize` of docs/contract.md).
///
/// The conversions of `fixed` from one format to another round down; those from floating point round ties to even.
#[must_use]
#[inline]
pub fn nearest<S: Fixed, D: Fixed>(value: S) -> D {
    D::saturating_from_num(value + (S::DELTA << (S::FRAC_NBITS - D::FRAC_NBITS - 1)))
}

/// Rounds to a whole number: nearest, ties toward +∞.
#[must_use]
#[inline]
pub fn nearest_whole<S: Fixed>(value: S) -> i32 {
    nearest::<S, I32F0>(value).to_bits()
}

/// Returns the words as integers, for what counts their fraction bits itself.
#[must_use]
#[inline]
pub fn bits_of<T, W: TransparentWrapper<T>>(words: &[W]) -> &[T] {
    W::peel_slice(words)
}

/// Returns the words as integers that can be written.
#[inline]
pub fn bits_of_mut<T, W: TransparentWrapper<T>>(words: &mut [W]) -> &mut [T] {
    W::peel_slice_mut(words)
}

/// Returns integers as words of a format.
#[must_use]
#[inline]
pub fn words_of<T, W: TransparentWrapper<T>>(bits: &[T]) -> &[W] {
    W::wrap_slice(bits)
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
    use fixed::FixedI32;
    use fixed::types::extra::U18;
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
        /// Every format of the board holds the words that shifts gave before the formats were types.
        #[test]
        fn formats_keep_the_words_of_the_shifts(pixel: u16, sum: i32) {
            prop_assert_eq!(input_word(pixel).to_bits(), (pixel >> 1) as i16);
            let (rounded, _) = requantize(i64::from(sum), 4, 16);
            prop_assert_eq!(nearest::<FixedI32<U18>, OutputWord>(FixedI32::from_bits(sum)).to_bits(), rounded);
            let word = OutputWord::saturating_from_num(OutputSum::from_bits(sum));
            prop_assert_eq!(word.to_bits(), saturate(i64::from(sum), 16).0);
            prop_assert_eq!(output_value(word), f64::from(word));
            prop_assert_eq!(input_value(input_word(pixel)), input_word(pixel).to_num::<f32>());
        }

        #[test]
        fn rounding_is_floor_of_the_half_shifted_quotient(acc in -(1i64 << 46)..(1i64 << 46), shift in 0u32..40) {
            let exact = (acc as f64 / (shift as f64).exp2() + 0.5).floor();
            prop_assert_eq!(f64::from(requantize(acc, shift, 16).0), exact.clamp(-32768.0, 32767.0));
        }
    }
}
