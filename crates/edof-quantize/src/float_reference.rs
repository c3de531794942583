//! The fixed network's function in floating point: the same matrices and thresholds as real numbers, the same ends of every range, and
//! nothing rounded but by the arithmetic itself.
//!
//! Values are clamped to their formats' ranges where the integers saturate. Without clamped values this is the float network itself.

use crate::fold::Folded;
use edof_core::colour::OUTPUTS_422;
use edof_core::number::{InputWord, OUTPUT_FRACTION, input_value};
use edof_network::FixedNetwork;
use edof_network::float::matmul::{Destination, Mat, product};
use edof_network::float::real::Real;
use edof_network::network::{Form, Recurrence};

/// Bits of an output word.
const OUTPUT_BITS: u32 = 16;

/// What a format can hold, in values: [least, most].
pub(crate) fn ends(bits: u32, fraction: u32) -> [f64; 2] {
    let (full, unit) = (f64::from(1u32 << (bits - 1)), (-f64::from(fraction)).exp2());
    [-full * unit, (full - 1.0) * unit]
}

/// Ends of every b_t and z_t, t = 1…T−1, then of the outputs.
pub(crate) fn all_ends(fixed: &FixedNetwork) -> Vec<[f64; 2]> {
    let codes = fixed.code_fractions.iter().map(|fraction| ends(fixed.code_bits, *fraction));
    codes.chain([ends(OUTPUT_BITS, OUTPUT_FRACTION)]).collect()
}

/// A network ready to run windows in precision `T`.
#[derive(Debug, Clone)]
pub struct FloatReference<T> {
    form: Form,
    analysis: Vec<T>,
    thresholds: Vec<Vec<T>>,
    recurrent: Vec<Vec<T>>,
    dictionary: Vec<T>,
    linear_path: Option<Vec<T>>,
    ends: Vec<[T; 2]>,
}

/// What windows became: row-major, one window a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Values<T> {
    /// b_t, t = 1…T−1, windows × codes each; then the outputs, windows × 128.
    pub stages: Vec<Vec<T>>,
    /// Number of b, z, differences and outputs that were clamped to their range.
    pub clipped: u64,
}

impl<T: Real> FloatReference<T> {
    /// The network whose real weights are `reference`, with the ranges of `fixed`.
    #[must_use]
    pub fn new(fixed: &FixedNetwork, reference: &Folded) -> Self {
        let numbers = |values: &mut dyn Iterator<Item = &f64>| values.map(|v| T::of(*v)).collect::<Vec<T>>();
        Self {
            form: fixed.form,
            analysis: numbers(&mut reference.analysis.iter()),
            thresholds: reference.thresholds.iter().map(|theta| numbers(&mut theta.iter())).collect(),
            recurrent: reference.recurrent.iter().map(|s| numbers(&mut s.iter())).collect(),
            dictionary: numbers(&mut reference.dictionary.iter()),
            linear_path: reference.linear_path.as_ref().map(|r| numbers(&mut r.iter())),
            ends: all_ends(fixed).into_iter().map(|pair| pair.map(T::of)).collect(),
        }
    }

    /// Runs windows of input words (0 or more, `window.pixels()` of them each).
    #[must_use]
    pub fn run(&self, windows: &[InputWord]) -> Values<T> {
        let (codes, pixels) = (self.form.codes, self.form.window.pixels());
        let count = windows.len() / pixels;
        let y: Vec<T> = windows.iter().map(|word| T::of(input_value(*word).into())).collect();
        let y = Mat::new(&y, count, pixels);
        let times = |left: &[T], width: usize, matrix: &[T], rows: usize, onto: Option<&[T]>| {
            let mut out = onto.map_or_else(|| vec![T::zero(); count * rows], <[T]>::to_vec);
            let (left, matrix) = (Mat::new(left, count, width), Mat::new(matrix, rows, width));
            product(&mut out, Destination::Accumulate, left, matrix.t());
            out
        };
        let mut clipped = 0;
        let mut first = vec![T::zero(); count * codes];
        product(&mut first, Destination::Replace, y, Mat::new(&self.analysis, codes, pixels).t());
        clipped += self.hold(0, &mut first);
        let mut stages = vec![first];
        let mut before: Option<Vec<T>> = None;
        for t in 0..self.form.shrinkages() {
            let mut z = self.shrunk(t, &stages[t]);
            clipped += self.hold(t, &mut z);
            if t < self.form.middle_layers() {
                let s = &self.recurrent[self.form.recurrent_index(t)];
                let mut next = match self.form.recurrence {
                    Recurrence::Direct => times(&z, codes, s, codes, Some(&stages[0])),
                    Recurrence::Difference => {
                        let mut change = z.clone();
                        if let Some(before) = &before {
                            change.iter_mut().zip(before).for_each(|(v, z)| *v -= *z);
                        }
                        clipped += self.hold(t, &mut change);
                        times(&change, codes, s, codes, Some(&stages[t]))
                    }
                };
                clipped += self.hold(t + 1, &mut next);
                stages.push(next);
            } else {
                let mut out = times(&z, codes, &self.dictionary, OUTPUTS_422, None);
                if let Some(r) = &self.linear_path {
                    product(&mut out, Destination::Accumulate, y, Mat::new(r, OUTPUTS_422, pixels).t());
                }
                clipped += self.hold(t + 1, &mut out);
                stages.push(out);
            }
            before = Some(z);
        }
        Values { stages, clipped }
    }

    fn shrunk(&self, t: usize, b: &[T]) -> Vec<T> {
        let mut z = b.to_vec();
        self.form.shrinkage.apply(b, &self.thresholds[t], &mut z);
        z
    }

    /// Holds values to the ends of stage `t`'s range; how many were beyond.
    fn hold(&self, t: usize, values: &mut [T]) -> u64 {
        let [min, max] = self.ends[t];
        let mut clipped = 0;
        for value in values {
            let held = value.max(min).min(max);
            clipped += u64::from(held != *value);
            *value = held;
        }
        clipped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::draw::Draw;
    use edof_core::number::bits_of;
    use edof_core::{Stride, Window};
    use edof_golden::scalar;
    use edof_network::network::Shrinkage;

    /// Where no shift rounds, integers and real numbers are the same, saturations and all.
    #[test]
    fn without_rounding_the_twin_equals_the_integers() {
        for (seed, flags) in (0..16u64).map(|seed| (seed, [seed & 2, seed & 4, seed & 8].map(|f| f != 0))) {
            let form = Form {
                window: Window::new(8).unwrap(),
                codes: 6,
                layers: 2 + (seed % 4) as usize,
                shrinkage: Shrinkage::ALL[seed as usize % Shrinkage::ALL.len()],
                recurrence: if flags[0] { Recurrence::Difference } else { Recurrence::Direct },
                linear_path: flags[1],
                tied: flags[2],
                exposures: 1,
            };
            let fixed = edof_device::random::extreme(form, 12, Stride::PATCH, true, seed);
            let twin = FloatReference::<f64>::new(&fixed, &Folded::of(&fixed));
            let y = edof_device::random::extreme_window(&mut Draw::new(seed), 64);
            let (trace, values) = (scalar::run(&fixed, &y), twin.run(&y));
            let words = trace.layers.iter().map(|layer| &layer.b[..]).chain([bits_of(&trace.output)]);
            let fractions = fixed.code_fractions.iter().chain([&OUTPUT_FRACTION]);
            for ((words, fraction), values) in words.zip(fractions).zip(&values.stages) {
                let unit = (-f64::from(*fraction)).exp2();
                let same = words.iter().zip(values).all(|(word, value)| f64::from(*word) * unit == *value);
                let shifts = [fixed.analysis_shift(), fixed.final_shifts().result];
                assert!(same || shifts != [0, 0], "seed {seed}: {words:?} {values:?}");
            }
            let saturated: u64 = trace.stages.iter().map(edof_golden::StageCounts::saturations).sum();
            assert_eq!(values.clipped > 0, saturated > 0, "seed {seed}");
        }
    }

    #[test]
    fn a_format_ends_at_its_least_and_largest_word() {
        assert_eq!(ends(8, 0), [-128.0, 127.0]);
        assert_eq!(ends(8, 3), [-16.0, 15.875]);
        assert_eq!(ends(16, 14), [-2.0, 2.0 - 1.0 / 16384.0]);
        let fixed = edof_device::random::natural(8, 8, 1);
        let code = ends(16, 14);
        assert_eq!(all_ends(&fixed), [[-1.0, 1.0 - 1.0 / 32768.0], code, code, code]);
    }

    /// Even inputs make I's one shift exact, and all others are none.
    #[test]
    fn every_word_and_every_saturation_is_that_of_the_integers_where_nothing_is_rounded() {
        for seed in 0..64u64 {
            let flags = [2, 4, 8].map(|bit| seed & bit != 0);
            let form = Form {
                window: Window::new(8).unwrap(),
                codes: 6,
                layers: 2 + (seed / 3 % 4) as usize,
                shrinkage: Shrinkage::ALL[seed as usize % Shrinkage::ALL.len()],
                recurrence: if flags[0] { Recurrence::Difference } else { Recurrence::Direct },
                linear_path: flags[1],
                tied: flags[2],
                exposures: 1,
            };
            let mut fixed = edof_device::random::extreme(form, 12, Stride::PATCH, true, seed);
            if seed >= 32 {
                // Weights of −1, 0 and 1 saturate less.
                let matrices = fixed.recurrent.iter_mut().chain([&mut fixed.analysis, &mut fixed.dictionary]);
                matrices.for_each(|m| m.weights.mapv_inplace(i16::signum));
            }
            fixed.linear_path.iter_mut().for_each(|r| r.fraction = 0);
            let reference = FloatReference::<f64>::new(&fixed, &Folded::of(&fixed));
            let divisor = if seed >= 32 { 64 } else { 1 };
            let mut draw = Draw::new(seed);
            let mut window = || {
                let words = edof_device::random::extreme_window(&mut draw, 64);
                words.iter().map(|w| InputWord::from_bits((w.to_bits() / divisor) & !1)).collect::<Vec<_>>()
            };
            let windows = [window(), window()];
            let both = reference.run(&windows.concat());
            let mut clipped = 0;
            for (i, y) in windows.iter().enumerate() {
                let trace = scalar::run(&fixed, y);
                let words = trace.layers.iter().map(|layer| &layer.b[..]).chain([bits_of(&trace.output)]);
                assert_eq!(both.stages.len(), form.layers);
                for (t, (words, values)) in words.zip(&both.stages).enumerate() {
                    let expected: Vec<f64> = words.iter().map(|w| f64::from(*w) / 16384.0).collect();
                    let own = &values[i * words.len()..][..words.len()];
                    assert_eq!(own, expected, "seed {seed}, stage {t}");
                }
                clipped += trace.stages.iter().map(edof_golden::StageCounts::saturations).sum::<u64>();
            }
            assert_eq!(both.clipped, clipped, "seed {seed}");
        }
    }
}
