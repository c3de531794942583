//! From sums to words: round, shift, saturate; shrinkage; difference. Each function of the vectors' is plain Rust that is compiled
//! once for every instruction set, and gives how many words saturated.
//!
//! Words of a stage whose shifts are [`narrow`](Finish::is_narrow) follow from its sums' high parts, in 32 bits; others from whole sums,
//! one by one, as the specification has it.

use super::isa::{Isa, for_each_isa};
use super::sums::{LOW_BITS, SUM_BITS, Sums};
use edof_core::number::requantize;
use edof_network::fixed_network::FinalShifts;
use edof_network::network::Shrinkage;

/// Bits of an output word.
const OUTPUT_BITS: u32 = 16;

/// How an I or M stage ends.
#[derive(Debug, Clone, Copy)]
pub struct Finish {
    /// Left shift of the base; none where the stage has no base.
    pub base_shift: Option<u32>,
    /// Right shift of the sum.
    pub shift: u32,
    /// Bits of a word.
    pub bits: u32,
    /// Bits of the accumulator in the worst case.
    pub accumulator_bits: u32,
}

impl Finish {
    /// Whether high parts are enough: no bit of a low part reaches the word, and no sum passes [`SUM_BITS`].
    #[must_use]
    pub fn is_narrow(&self) -> bool {
        let base = self.base_shift.is_none_or(|shift| shift >= LOW_BITS);
        base && drops_low(self.shift) && self.accumulator_bits <= SUM_BITS
    }

    /// `(base << base_shift) + sum` of sums from `from` on, rounded, shifted and saturated to its width.
    pub fn words(&self, isa: Isa, sums: &Sums, from: usize, base: Option<&[i16]>, out: &mut [i16]) -> u64 {
        if self.is_narrow() {
            return narrow_words(isa, *self, &sums.high[from..], base, out);
        }
        let base_of = |i: usize| base.map_or(0, |base| i64::from(base[i]) << self.base_shift.unwrap_or(0));
        let sums = sums.exact(from, out.len()).enumerate().map(|(i, sum)| base_of(i) + sum);
        exact_words(sums, self.shift, self.bits, out)
    }
}

/// How F ends.
#[derive(Debug, Clone, Copy)]
pub struct FinishOutputs {
    /// Shifts of both products and of their sum.
    pub shifts: FinalShifts,
    /// Bits of the accumulator in the worst case.
    pub accumulator_bits: u32,
}

impl FinishOutputs {
    /// As [`Finish::is_narrow`]; and low parts that are shifted left stay within 32 bits.
    #[must_use]
    pub fn is_narrow(&self) -> bool {
        let left = self.shifts.dictionary.max(self.shifts.linear_path);
        left + LOW_BITS < 30 && drops_low(self.shifts.result) && self.accumulator_bits <= SUM_BITS
    }

    /// `(D·z << dictionary) + (R·y << linear_path)`, rounded, shifted and saturated to 16 bits; sums from `from` on.
    pub fn words(&self, isa: Isa, sums: &Sums, linear: Option<&Sums>, from: usize, out: &mut [i16]) -> u64 {
        let shifts = self.shifts;
        if self.is_narrow() {
            return narrow_outputs(isa, shifts, parts(sums, from), linear.map(|sums| parts(sums, from)), out);
        }
        let products = sums.exact(from, out.len()).map(|sum| sum << shifts.dictionary);
        match linear {
            None => exact_words(products, shifts.result, OUTPUT_BITS, out),
            Some(linear) => {
                let linear = linear.exact(from, out.len()).map(|sum| sum << shifts.linear_path);
                exact_words(products.zip(linear).map(|(d, r)| d + r), shifts.result, OUTPUT_BITS, out)
            }
        }
    }
}

/// Whether a rounded shift depends on nothing of a sum's low part, and rounds by less than 2^30 of its high part.
const fn drops_low(shift: u32) -> bool {
    shift > LOW_BITS && shift < LOW_BITS + 31
}

/// The specification's words, one by one.
fn exact_words(sums: impl Iterator<Item = i64>, shift: u32, bits: u32, out: &mut [i16]) -> u64 {
    let mut saturated = 0;
    for (out, sum) in out.iter_mut().zip(sums) {
        let (word, clipped) = requantize(sum, shift, bits);
        *out = word;
        saturated += u64::from(clipped);
    }
    saturated
}

/// Both parts of the sums from one on.
fn parts(sums: &Sums, from: usize) -> Parts<'_> {
    Parts { high: &sums.high[from..], low: &sums.low[from..] }
}

/// Both parts of some sums.
#[derive(Clone, Copy)]
struct Parts<'a> {
    high: &'a [i32],
    low: &'a [i32],
}

for_each_isa! {
    /// [`Finish::words`] of high parts.
    fn narrow_words(finish: Finish, high: &[i32], base: Option<&[i16]>, out: &mut [i16]) -> u64 {
        let (round, shift) = rounding(finish.shift);
        let max = (1i32 << (finish.bits - 1)) - 1;
        let mut saturated = 0u32;
        let mut finish_one = |out: &mut i16, sum: i32| {
            let word = (sum + round) >> shift;
            let held = word.clamp(-max - 1, max);
            saturated += u32::from(held != word);
            *out = held as i16;
        };
        match (base, finish.base_shift) {
            (Some(base), Some(base_shift)) => out.iter_mut().zip(high).zip(base).for_each(|((out, sum), base)| {
                finish_one(out, (i32::from(*base) << (base_shift - LOW_BITS)) + sum);
            }),
            _ => out.iter_mut().zip(high).for_each(|(out, sum)| finish_one(out, *sum)),
        }
        saturated.into()
    }
}

for_each_isa! {
    /// [`FinishOutputs::words`] of sums in two parts.
    fn narrow_outputs(shifts: FinalShifts, sums: Parts<'_>, linear: Option<Parts<'_>>, out: &mut [i16]) -> u64 {
        let (round, shift) = rounding(shifts.result);
        let mut saturated = 0u32;
        let mut finish_one = |out: &mut i16, high: i32, low: i32| {
            let word = (high + (low >> LOW_BITS) + round) >> shift;
            let held = word.clamp(i16::MIN.into(), i16::MAX.into());
            saturated += u32::from(held != word);
            *out = held as i16;
        };
        let products = sums.high.iter().zip(sums.low).map(|(h, l)| (h << shifts.dictionary, l << shifts.dictionary));
        match linear {
            None => out.iter_mut().zip(products).for_each(|(out, (high, low))| finish_one(out, high, low)),
            Some(Parts { high, low }) => {
                let linear = high.iter().zip(low).map(|(h, l)| (h << shifts.linear_path, l << shifts.linear_path));
                let both = out.iter_mut().zip(products).zip(linear);
                both.for_each(|((out, d), r)| finish_one(out, d.0 + r.0, d.1 + r.1));
            }
        }
        saturated.into()
    }
}

/// Applies the shrinkage to pre-activations of `bits` bits, fewer than 2^16 of them; returns how many codes saturated.
pub fn shrink(isa: Isa, shrinkage: Shrinkage, bits: u32, theta: &[i16], b: &[i16], z: &mut [i16]) -> u64 {
    match shrinkage {
        Shrinkage::TwoSided => two_sided(isa, theta, b, z),
        Shrinkage::OneSided => one_sided(isa, bits, theta, b, z),
        Shrinkage::Firm => firm(isa, theta, b, z),
    }
}

for_each_isa! {
    /// Keeps what is outside of −θ…θ, which never saturates.
    fn two_sided(theta: &[i16], b: &[i16], z: &mut [i16]) -> u64 {
        for ((z, b), theta) in z.iter_mut().zip(b).zip(theta) {
            // −32768 has no opposite, but thresholds are 0 or more.
            *z = *b - (*b).min(*theta).max(-theta.max(&0));
        }
        0
    }
}

for_each_isa! {
    /// Keeps what exceeds θ.
    fn one_sided(bits: u32, theta: &[i16], b: &[i16], z: &mut [i16]) -> u64 {
        let max = ((1i32 << (bits - 1)) - 1) as i16;
        let mut saturated = 0i16;
        for ((z, b), theta) in z.iter_mut().zip(b).zip(theta) {
            // Where `max` + θ saturates, b cannot pass it, and b − θ cannot pass `max`.
            saturated = saturated.wrapping_add(i16::from(*b > max.saturating_add(*theta)));
            *z = b.saturating_sub(*theta).max(0).min(max);
        }
        u64::from(saturated as u16)
    }
}

for_each_isa! {
    /// Doubles what is outside of −θ…θ, up to the size of b, so that it never saturates.
    fn firm(theta: &[i16], b: &[i16], z: &mut [i16]) -> u64 {
        for ((z, b), theta) in z.iter_mut().zip(b).zip(theta) {
            let outside = *b - (*b).min(*theta).max(-theta.max(&0));
            *z = outside.saturating_add(outside).min((*b).max(0)).max((*b).min(0));
        }
        0
    }
}

for_each_isa! {
    /// `z − previous`, saturated to its width.
    pub fn difference(bits: u32, z: &[i16], previous: &[i16], out: &mut [i16]) -> u64 {
        let max = (1i32 << (bits - 1)) - 1;
        let mut saturated = 0u32;
        for ((out, z), previous) in out.iter_mut().zip(z).zip(previous) {
            let word = i32::from(*z) - i32::from(*previous);
            let held = word.clamp(-max - 1, max);
            saturated += u32::from(held != word);
            *out = held as i16;
        }
        saturated.into()
    }
}

/// What is added to a high part before shifting it right, and by how much.
const fn rounding(shift: u32) -> (i32, u32) {
    (1 << (shift - LOW_BITS - 1), shift - LOW_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fast::sums::split;
    use edof_core::draw::Draw;

    /// Sums of at most N bits, often at the ends of their range.
    fn sums(draw: &mut Draw, bits: u32) -> (Vec<i64>, Sums) {
        let max = (1i64 << (bits - 1)) - 1;
        let one = |_| [max, -max - 1, 0, 255, -256, draw.whole(-max - 1, max)][draw.whole(0, 5) as usize];
        let exact: Vec<i64> = (0..48).map(one).collect();
        let (high, low) = exact.iter().map(|sum| split(*sum)).unzip();
        (exact, Sums { high, low })
    }

    /// What the specification makes of sums, and how many words saturate.
    fn specified(sums: impl Iterator<Item = i64>, shift: u32, bits: u32) -> (Vec<i16>, u64) {
        let words: Vec<(i16, bool)> = sums.map(|sum| requantize(sum, shift, bits)).collect();
        let saturated = words.iter().filter(|(_, clipped)| *clipped).count() as u64;
        (words.into_iter().map(|(word, _)| word).collect(), saturated)
    }

    /// Bits of the accumulator for sums as far from zero as this, and for rounding.
    const fn bits_of(worst: i64, shift: u32) -> u32 {
        i64::BITS - (worst + ((1 << shift) >> 1) - 1).leading_zeros() + 1
    }

    #[test]
    fn words_of_every_shift_are_those_of_the_specification() {
        let draw = &mut Draw::new(3);
        let base: Vec<i16> = (0..48).map(|_| draw.extreme(16)).collect();
        for (shift, sum_bits) in (0..46).flat_map(|shift| [24, 38, 39, 40].map(|bits| (shift, bits))) {
            let (exact, sums) = sums(draw, sum_bits);
            for base_shift in
                [None, Some(0), Some(7), Some(8), Some(9), Some(22), Some(23), Some(24), Some(31)]
            {
                let of_base = base_shift.map_or(0, |shift| 1 << (15 + shift));
                let accumulator_bits = bits_of((1 << (sum_bits - 1)) + of_base, shift);
                let finish = Finish { base_shift, shift, bits: 12, accumulator_bits };
                let base_of = |i: usize| base_shift.map_or(0, |shift| i64::from(base[i]) << shift);
                for from in [0, 5] {
                    let of = (from..48).map(|i| base_of(i - from) + exact[i]);
                    let expected = specified(of, shift, 12);
                    for isa in Isa::available() {
                        let mut out = vec![0; 48 - from];
                        let base = base_shift.map(|_| &base[..48 - from]);
                        let saturated = finish.words(isa, &sums, from, base, &mut out);
                        assert_eq!((out, saturated), expected, "{isa:?} {finish:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn outputs_of_every_shift_are_those_of_the_specification() {
        let draw = &mut Draw::new(4);
        for (result, sum_bits) in (0..46).flat_map(|result| [10, 16, 32, 38].map(|bits| (result, bits))) {
            let ((exact, products), (exact_linear, linear)) = (sums(draw, sum_bits), sums(draw, sum_bits));
            for (dictionary, linear_path) in
                [(0, 0), (3, 0), (0, 8), (15, 20), (21, 1), (22, 21), (24, 23), (2, 24)]
            {
                let shifts = FinalShifts { dictionary, linear_path, result };
                for (has_linear, from) in [(false, 0), (true, 0), (true, 16)] {
                    let of_linear = if has_linear { 1 << (sum_bits - 1 + linear_path) } else { 0 };
                    let accumulator_bits = bits_of((1 << (sum_bits - 1 + dictionary)) + of_linear, result);
                    let linear_of = |i: usize| if has_linear { exact_linear[i] << linear_path } else { 0 };
                    let of = (from..from + 32).map(|i| (exact[i] << dictionary) + linear_of(i));
                    let expected = specified(of, result, 16);
                    let finish = FinishOutputs { shifts, accumulator_bits };
                    for isa in Isa::available() {
                        let mut out = vec![0; 32];
                        let saturated =
                            finish.words(isa, &products, has_linear.then_some(&linear), from, &mut out);
                        assert_eq!((out, saturated), expected, "{isa:?} {finish:?}");
                    }
                }
            }
        }
    }
}
