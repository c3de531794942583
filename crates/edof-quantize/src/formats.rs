//! Fraction bits and integers.
//!
//! Every code and matrix gets as many fraction bits as its largest value allows. Then bits are taken away where a shift would
//! be illegal or an accumulator could pass 48 bits; what cannot be fixed so is rejected. F's sums and the shift that aligns its products also keep to
//! the bits of the committed designs where that costs bits of the finer product alone.

use crate::fold::Folded;
use crate::rounding::Rounding;
use crate::{Calibration, QuantizeError, QuantizeOptions};
use edof_core::number::{ACCUMULATOR_BITS, INPUT_FRACTION};
use edof_network::fixed_network::{FixedMatrix, FixedNetworkError};
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_network::{FixedNetwork, Network};
use ndarray::{Array1, Array2};
use std::collections::BTreeSet;

/// More fraction bits than these help nobody: they only make accumulators wide.
const MAX_FRACTION: u32 = 24;

/// `accumulator_bits` of the committed designs `kc705` and `paper`; a test of `edof::presets` has every network fit one.
const DESIGN_SUM_BITS: u32 = 40;

/// Bits by which the narrowest multiplier of a board (18 bits, of the ECP5) takes a value shifted.
const MAX_ALIGNMENT: u32 = 2;

/// Bits that the weights of the finer product may lose for it, of at least [`FINE_BITS`]: more would cost quality, and wider multipliers need none.
const SPARED_BITS: u32 = 2;
const FINE_BITS: u32 = 14;

/// Largest |code| of each layer after scaling, without headroom.
#[must_use]
pub fn used(calibration: &Calibration, scales: &[f64]) -> Vec<f64> {
    let scaled = |layer: &[f32]| layer.iter().zip(scales).map(|(v, c)| f64::from(*v) * c).fold(0.0, f64::max);
    calibration.codes.iter().zip(&calibration.changes).map(|(b, d)| scaled(b).max(scaled(d))).collect()
}

/// Chooses all formats and rounds.
///
/// # Errors
/// [`QuantizeError::Large`] or [`QuantizeError::Fixed`].
pub fn integers(
    folded: &Folded,
    used: &[f64],
    rounding: &Rounding,
    network: &Network,
    options: &QuantizeOptions,
    float_hash: &str,
) -> Result<FixedNetwork, QuantizeError> {
    let bits = options.bits;
    let mut fractions = Fractions::finest(folded, used, options, network)?;
    // A's are never taken back: its sums are the smallest.
    let analysis = rounding.analysis(&folded.analysis, fractions.analysis, bits);
    loop {
        let mut fixed = fractions.words(folded, analysis.clone(), rounding, network, options);
        float_hash.clone_into(&mut fixed.float_hash);
        match fixed.check() {
            Ok(()) if is_wide(&fixed) && fractions.coarsen_finer_product() => {}
            Ok(()) => return Ok(fixed),
            Err(source) => {
                fractions.mend(&fixed, source).map_err(|source| QuantizeError::Fixed { bits, source })?;
            }
        }
    }
}

/// Fraction bits of everything that has some.
struct Fractions {
    codes: Vec<u32>,
    analysis: u32,
    recurrent: Vec<u32>,
    dictionary: u32,
    linear: Option<u32>,
}

impl Fractions {
    /// As many as the largest values allow.
    fn finest(
        folded: &Folded,
        used: &[f64],
        options: &QuantizeOptions,
        network: &Network,
    ) -> Result<Self, QuantizeError> {
        let bits = options.bits;
        let recurrent = folded.recurrent.iter().map(|s| weight_fraction("recurrent", s, bits));
        let linear = folded.linear_path.as_ref().map(|r| weight_fraction("linear_path", r, bits));
        let mut all = Self {
            codes: code_fractions(folded, used, options, network.form.recurrence),
            analysis: weight_fraction("analysis", &folded.analysis, bits)?,
            recurrent: recurrent.collect::<Result<_, _>>()?,
            dictionary: weight_fraction("dictionary", &folded.dictionary, bits)?,
            linear: linear.transpose()?,
        };
        make_shifts_legal(&mut all.codes, all.analysis, &all.recurrent, network.form);
        Ok(all)
    }

    /// Everything rounded to them, A's words being given.
    fn words(
        &self,
        folded: &Folded,
        analysis: Array2<i16>,
        rounding: &Rounding,
        network: &Network,
        options: &QuantizeOptions,
    ) -> FixedNetwork {
        let bits = options.bits;
        let recurrent = folded.recurrent.iter().zip(&self.recurrent).enumerate();
        let (d, r) = rounding.outputs(
            (&folded.dictionary, self.dictionary),
            folded.linear_path.as_ref().zip(self.linear),
            bits,
        );
        FixedNetwork {
            form: network.form,
            code_bits: bits,
            stride: options.stride,
            overlap: options.overlap,
            analysis: FixedMatrix { weights: analysis, fraction: self.analysis },
            thresholds: all_thresholds(folded, &self.codes, bits, network.form.shrinkage),
            recurrent: recurrent
                .map(|(i, (s, &fraction))| FixedMatrix {
                    weights: rounding.recurrent(i, s, fraction, bits),
                    fraction,
                })
                .collect(),
            dictionary: FixedMatrix { weights: d, fraction: self.dictionary },
            linear_path: r.zip(self.linear).map(|(weights, fraction)| FixedMatrix { weights, fraction }),
            code_fractions: self.codes.clone(),
            origin: network.origin.clone(),
            float_hash: String::new(),
            quantized: None,
        }
    }

    /// Takes a bit from the finer of F's products, which forces the other to be shifted up; whether one is finer.
    fn coarsen_finer_product(&mut self) -> bool {
        let of_codes = self.dictionary + self.codes.last().copied().unwrap_or(0);
        match &mut self.linear {
            Some(r) if *r + INPUT_FRACTION > of_codes && *r > 0 => *r -= 1,
            Some(r) if *r + INPUT_FRACTION < of_codes && self.dictionary > 0 => self.dictionary -= 1,
            _ => return false,
        }
        true
    }

    /// Takes bits from what overflowed.
    ///
    /// # Errors
    /// The error itself, where that would not help.
    fn mend(&mut self, fixed: &FixedNetwork, error: FixedNetworkError) -> Result<(), FixedNetworkError> {
        let form = fixed.form;
        match error {
            FixedNetworkError::Overflow { what: "M", .. } => {
                let bits = fixed.accumulator_bits();
                let wide = (0..form.middle_layers()).filter(|layer| bits[layer + 1] > ACCUMULATOR_BITS);
                let wide: BTreeSet<usize> = wide.map(|layer| form.recurrent_index(layer)).collect();
                if wide.iter().all(|&s| self.recurrent[s] == 0) {
                    return Err(error);
                }
                wide.iter().for_each(|&s| self.recurrent[s] = self.recurrent[s].saturating_sub(1));
                make_shifts_legal(&mut self.codes, self.analysis, &self.recurrent, form);
                Ok(())
            }
            FixedNetworkError::Overflow { what: "F", .. } => {
                if !self.coarsen_finer_product() {
                    self.dictionary = self.dictionary.checked_sub(1).ok_or(error)?;
                }
                Ok(())
            }
            _ => Err(error),
        }
    }
}

/// Bits of the sums of F.
/// Whether F's sums or the shift that aligns its two products are wider than the boards take.
fn is_wide(fixed: &FixedNetwork) -> bool {
    let shifts = fixed.final_shifts();
    let sum = fixed.accumulator_bits().last().copied().unwrap_or(0);
    let alignment = shifts.dictionary.max(shifts.linear_path);
    let is_near = (MAX_ALIGNMENT + 1..=MAX_ALIGNMENT + SPARED_BITS).contains(&alignment);
    sum > DESIGN_SUM_BITS || fixed.code_bits >= FINE_BITS && is_near
}

/// The same formats for other weights of the same network, rounded as [`integers`] rounds them. The first `settled` of A and
/// all S keep their words. The caller checks the sums.
#[must_use]
pub fn rounded_to(folded: &Folded, like: &FixedNetwork, rounding: &Rounding, settled: usize) -> FixedNetwork {
    let bits = like.code_bits;
    let analysis = if settled > 0 {
        like.analysis.weights.clone()
    } else {
        rounding.analysis(&folded.analysis, like.analysis.fraction, bits)
    };
    let recurrent = |(i, (s, like)): (usize, (&Array2<f64>, &FixedMatrix))| {
        let settled = i + 1 < settled;
        let weights =
            if settled { like.weights.clone() } else { rounding.recurrent(i, s, like.fraction, bits) };
        FixedMatrix { weights, fraction: like.fraction }
    };
    let linear = folded.linear_path.as_ref().zip(like.linear_path.as_ref());
    let (dictionary, linear_path) = rounding.outputs(
        (&folded.dictionary, like.dictionary.fraction),
        linear.map(|(r, like)| (r, like.fraction)),
        bits,
    );
    let again = |weights, like: &FixedMatrix| FixedMatrix { weights, fraction: like.fraction };
    FixedNetwork {
        analysis: again(analysis, &like.analysis),
        thresholds: all_thresholds(folded, &like.code_fractions, bits, like.form.shrinkage),
        recurrent: folded.recurrent.iter().zip(&like.recurrent).enumerate().map(recurrent).collect(),
        dictionary: again(dictionary, &like.dictionary),
        linear_path: linear_path.zip(like.linear_path.as_ref()).map(|(r, like)| again(r, like)),
        ..like.clone()
    }
}

/// The most fraction bits at which every layer's codes, with headroom, and its thresholds keep within their width.
fn code_fractions(
    folded: &Folded,
    used: &[f64],
    options: &QuantizeOptions,
    recurrence: Recurrence,
) -> Vec<u32> {
    let max = max_word(options.bits);
    let fits = |value: f64| {
        let finest = (max / value.max(1e-9)).log2().floor();
        finest.clamp(0.0, f64::from(MAX_FRACTION)) as u32
    };
    // A threshold of the last share of a bit beyond the range is no reason to lose one.
    let theta = |t: usize| folded.thresholds[t].iter().fold(0.0, |a: f64, v| a.max(-v));
    let each: Vec<u32> = used
        .iter()
        .enumerate()
        .map(|(t, u)| fits((u * options.headroom).max(theta(t)) * (1.0 - 1e-12)))
        .collect();
    match recurrence {
        Recurrence::Direct => each,
        Recurrence::Difference => vec![each.iter().copied().min().unwrap_or(0); each.len()],
    }
}

/// Takes fraction bits from codes whose shifts would be negative. The difference form's never are: its codes share a format.
fn make_shifts_legal(fractions: &mut [u32], analysis: u32, recurrent: &[u32], form: Form) {
    fractions[0] = fractions[0].min(INPUT_FRACTION + analysis);
    if form.recurrence == Recurrence::Difference {
        let first = fractions[0];
        return fractions.iter_mut().for_each(|f| *f = (*f).min(first));
    }
    loop {
        let before = fractions.to_vec();
        for layer in 0..form.middle_layers() {
            let sum = fractions[layer] + recurrent[form.recurrent_index(layer)];
            fractions[0] = fractions[0].min(sum);
            fractions[layer + 1] = fractions[layer + 1].min(sum);
        }
        if before == fractions {
            return;
        }
    }
}

/// The most fraction bits at which the matrix keeps within its width.
fn weight_fraction(what: &'static str, matrix: &Array2<f64>, bits: u32) -> Result<u32, QuantizeError> {
    let value = matrix.iter().fold(0.0, |a: f64, w| a.max(w.abs()));
    let fits = |fraction: &u32| (value * f64::from(*fraction).exp2()).round() <= max_word(bits);
    (0..=MAX_FRACTION).rev().find(fits).ok_or(QuantizeError::Large { what, value, bits })
}

fn all_thresholds(folded: &Folded, fractions: &[u32], bits: u32, shrinkage: Shrinkage) -> Vec<Array1<i16>> {
    let each = folded.thresholds.iter().zip(fractions);
    each.map(|(theta, &fraction)| thresholds(theta, fraction, bits, shrinkage)).collect()
}

fn thresholds(theta: &Array1<f64>, fraction: u32, bits: u32, shrinkage: Shrinkage) -> Array1<i16> {
    // A threshold above every code closes its coefficient; the largest code does the same.
    theta.mapv(|t| shrinkage.legal(word(t, fraction, bits)))
}

fn word(value: f64, fraction: u32, bits: u32) -> i16 {
    (value * f64::from(fraction).exp2() + 0.5).floor().clamp(-max_word(bits) - 1.0, max_word(bits)) as i16
}

fn max_word(bits: u32) -> f64 {
    f64::from((1u32 << (bits - 1)) - 1)
}

#[cfg(test)]
mod tests;
