//! The integer network: what the board computes, word for word (docs/contract.md).
//!
//! ```text
//! I   acc = Σ A·y                                b₁  = requantize(acc, shift_I)
//! M   acc = (base << base_shift_t) + Σ S_t·v     b_{t+1} = requantize(acc, shift_t)
//!         direct:     base = b₁,  v = z_t
//!         difference: base = b_t, v = saturate(z_t − z_{t−1}), z_0 = 0
//! F   acc = (Σ D·z_{T−1} << shift_D) + (Σ R·y << shift_R)      out = requantize(acc, shift_F)
//! ```
//! All pre-activations b_t and sparse codes z_t have `code_bits` bits and their own fraction bits; outputs have 16 bits and
//! [`OUTPUT_FRACTION`]. All shifts follow from the fraction bits and are computed here only.

use crate::network::{
    Condition, Form, NetworkError, Origin, Recurrence, Shrinkage, check_count, check_shape,
};
use edof_core::colour::OUTPUTS_422;
use edof_core::geometry::Stride;
use edof_core::number::{ACCUMULATOR_BITS, INPUT_FRACTION, OUTPUT_FRACTION};
use edof_core::overlap::Overlap;
use edof_core::storage::provenance::Provenance;
use ndarray::{Array1, Array2};
use serde::{Deserialize, Serialize};

/// Bits of a word of weights or codes.
pub const WORD_BITS: u32 = i16::BITS;
/// Most fraction bits of a weight or code: more than any accumulator could shift away.
pub const MAX_FRACTION: u32 = 48;

/// Integer weights and their count of fraction bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FixedMatrix {
    /// Outputs × inputs.
    pub weights: Array2<i16>,
    /// Fraction bits of each weight.
    pub fraction: u32,
}

/// A quantized network, with the 4:2:2 conversion and the averaging window folded into F.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedNetwork {
    /// Form of the fixed network.
    pub form: Form,
    /// Bits of every weight, pre-activation and sparse code, 8…16.
    pub code_bits: u32,
    /// Stride that F's averaging window is made for.
    pub stride: Stride,
    /// Averaging window folded into F.
    pub overlap: Overlap,
    /// A: codes × window pixels.
    pub analysis: FixedMatrix,
    /// θ_t in the format of b_t.
    pub thresholds: Vec<Array1<i16>>,
    /// S_t: codes × codes each.
    pub recurrent: Vec<FixedMatrix>,
    /// D: 128 × codes.
    pub dictionary: FixedMatrix,
    /// R: 128 × window pixels.
    pub linear_path: Option<FixedMatrix>,
    /// Fraction bits of b_t and z_t, t = 1…T−1.
    pub code_fractions: Vec<u32>,
    /// How the float network was made.
    pub origin: Origin,
    /// Hash that the float network's weight file states, as hexadecimal digits.
    pub float_hash: String,
    /// How its formats were chosen; none for random networks.
    pub quantized: Option<Quantized>,
}

/// How the formats of a fixed network were chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantized {
    /// Codes hold N times what calibration saw.
    pub headroom: f64,
    /// What calibration saw.
    pub calibration: CalibratedOn,
    /// Steps of fine-tuning with the rounded words.
    pub finetune_steps: u64,
    /// The program, command and inputs (the float weights, every picture by content) that made the integers.
    pub provenance: Provenance,
}

/// The raw windows that ranges were measured on: those of every picture at every ψ and condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibratedOn {
    /// Pixels from one window to the next; windows of larger strides are among these.
    pub stride: Stride,
    /// Windows seen.
    pub windows: u64,
    /// Defocus.
    pub psis: Vec<f64>,
    /// Tones and noises.
    pub conditions: Vec<Condition>,
    /// Bits of the sensor.
    pub depth: u32,
}

/// Shifts of an M layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct MiddleShifts {
    /// Left shift of the base (b₁ or b_t) into the accumulator.
    pub base: u32,
    /// Right shift of the accumulator to b_{t+1}.
    pub result: u32,
}

/// Shifts of the F layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FinalShifts {
    /// Left shift of D's products.
    pub dictionary: u32,
    /// Left shift of R's products.
    pub linear_path: u32,
    /// Right shift of the accumulator to the output.
    pub result: u32,
}

/// Integers that are no network the board can run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum FixedNetworkError {
    /// Matrices that do not fit the form.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// Bits of weights and sparse codes out of range.
    #[error("code_bits {0}: must be 8 to 16")]
    CodeBits(u32),
    /// A word is wider than the stated bits.
    #[error("{what}: holds {value}, which {bits} bits cannot hold")]
    TooWide { what: &'static str, value: i16, bits: u32 },
    /// Fraction bits that no format of this program has.
    #[error("{what}: {fraction} fraction bits, must be 0 to {MAX_FRACTION}")]
    Fraction { what: &'static str, fraction: u32 },
    /// Fraction bits that would need a negative shift.
    #[error("{what}: fraction bits need a shift of {shift}, it must be 0 to 47")]
    Shift { what: &'static str, shift: i64 },
    /// Some input could overflow the 48-bit accumulator.
    #[error("{what}: accumulators may need {bits} bits, {ACCUMULATOR_BITS} are there")]
    Overflow { what: &'static str, bits: u32 },
    /// The difference form keeps one format for all sparse codes.
    #[error("code_fractions: differ from layer to layer, the difference form needs them equal")]
    UnequalFractions,
    /// A negative threshold of a shrinkage that has none.
    #[error("thresholds: holds {value}, {shrinkage} shrinkage needs thresholds of 0 or more")]
    NegativeThreshold { shrinkage: Shrinkage, value: i16 },
}

impl FixedNetwork {
    /// Right shift from I's accumulator to b₁.
    #[must_use]
    pub fn analysis_shift(&self) -> u32 {
        INPUT_FRACTION + self.analysis.fraction - self.code_fractions[0]
    }

    /// Shifts of M layer `layer` (0 first).
    #[must_use]
    pub fn middle_shifts(&self, layer: usize) -> MiddleShifts {
        let sum = self.code_fractions[layer] + self.recurrent_matrix(layer).fraction;
        let base = match self.form.recurrence {
            Recurrence::Direct => self.code_fractions[0],
            Recurrence::Difference => self.code_fractions[layer],
        };
        MiddleShifts { base: sum - base, result: sum - self.code_fractions[layer + 1] }
    }

    /// Shifts of the F layer.
    #[must_use]
    pub fn final_shifts(&self) -> FinalShifts {
        let dictionary = self.code_fractions[self.code_fractions.len() - 1] + self.dictionary.fraction;
        let linear = self.linear_path.as_ref().map_or(dictionary, |r| INPUT_FRACTION + r.fraction);
        // Few bits can leave products coarser than an output: these are shifted up, never down by less than nothing.
        let sum = dictionary.max(linear).max(OUTPUT_FRACTION);
        FinalShifts { dictionary: sum - dictionary, linear_path: sum - linear, result: sum - OUTPUT_FRACTION }
    }

    /// S of M layer `layer` (0 first).
    #[must_use]
    pub fn recurrent_matrix(&self, layer: usize) -> &FixedMatrix {
        &self.recurrent[self.form.recurrent_index(layer)]
    }

    /// Bits that the accumulators of each layer need for the worst input there is (any raw window, any sparse codes), sign included:
    /// I, then every M, then F. The bound includes rounding and every partial sum.
    #[must_use]
    pub fn accumulator_bits(&self) -> Vec<u32> {
        let code = 1i128 << (self.code_bits - 1);
        let input = i128::from(i16::MAX);
        let half = |shift: u32| if shift == 0 { 0 } else { 1i128 << (shift - 1) };
        let mut bits = vec![signed_bits(
            products(&self.analysis, input).max().unwrap_or(0) + half(self.analysis_shift()),
        )];
        for layer in 0..self.form.middle_layers() {
            let shifts = self.middle_shifts(layer);
            let sum = products(self.recurrent_matrix(layer), code).max().unwrap_or(0);
            bits.push(signed_bits(sum + (code << shifts.base) + half(shifts.result)));
        }
        let shifts = self.final_shifts();
        let dictionary: Vec<i128> =
            products(&self.dictionary, code).map(|p| p << shifts.dictionary).collect();
        let linear: Vec<i128> = match &self.linear_path {
            Some(r) => products(r, input).map(|p| p << shifts.linear_path).collect(),
            None => vec![0; dictionary.len()],
        };
        let largest = dictionary.iter().zip(&linear).map(|(d, r)| d + r).max().unwrap_or(0);
        bits.push(signed_bits(largest + half(shifts.result)));
        bits
    }

    /// # Errors
    /// [`FixedNetworkError`] for the first thing that the board could not run exactly.
    pub fn check(&self) -> Result<(), FixedNetworkError> {
        let form = &self.form;
        form.check()?;
        form.check_single()?;
        if !(8..=16).contains(&self.code_bits) {
            return Err(FixedNetworkError::CodeBits(self.code_bits));
        }
        self.check_shapes()?;
        self.check_fractions()?;
        self.check_widths()?;
        if form.recurrence == Recurrence::Difference
            && self.code_fractions.windows(2).any(|pair| pair[0] != pair[1])
        {
            return Err(FixedNetworkError::UnequalFractions);
        }
        self.check_shifts()?;
        for (bits, what) in self.accumulator_bits().into_iter().zip(layer_names(form.layers)) {
            if bits > ACCUMULATOR_BITS {
                return Err(FixedNetworkError::Overflow { what, bits });
            }
        }
        Ok(())
    }

    fn check_shapes(&self) -> Result<(), NetworkError> {
        let form = &self.form;
        let (codes, pixels) = (form.codes, form.window.pixels());
        check_count("thresholds", self.thresholds.len(), form.shrinkages())?;
        check_count("code_fractions", self.code_fractions.len(), form.shrinkages())?;
        check_count("recurrent", self.recurrent.len(), form.recurrent_matrices())?;
        check_count("linear_path", self.linear_path.iter().count(), usize::from(form.linear_path))?;
        check_shape("analysis", self.analysis.weights.dim(), (codes, pixels))?;
        for theta in &self.thresholds {
            check_shape("thresholds", (theta.len(), 1), (codes, 1))?;
        }
        for s in &self.recurrent {
            check_shape("recurrent", s.weights.dim(), (codes, codes))?;
        }
        check_shape("dictionary", self.dictionary.weights.dim(), (OUTPUTS_422, codes))?;
        self.linear_path
            .as_ref()
            .map_or(Ok(()), |r| check_shape("linear_path", r.weights.dim(), (OUTPUTS_422, pixels)))
    }

    /// Sums of fraction bits, and so shifts, are in range of their type only once this holds.
    fn check_fractions(&self) -> Result<(), FixedNetworkError> {
        let legal = |what, fraction: u32| match fraction {
            0..=MAX_FRACTION => Ok(()),
            _ => Err(FixedNetworkError::Fraction { what, fraction }),
        };
        legal("analysis", self.analysis.fraction)?;
        self.recurrent.iter().try_for_each(|s| legal("recurrent", s.fraction))?;
        legal("dictionary", self.dictionary.fraction)?;
        self.linear_path.iter().try_for_each(|r| legal("linear_path", r.fraction))?;
        self.code_fractions.iter().try_for_each(|f| legal("code_fractions", *f))
    }

    fn check_widths(&self) -> Result<(), FixedNetworkError> {
        let bits = self.code_bits;
        let fits =
            |what, values: &mut dyn Iterator<Item = &i16>| match Iterator::find(&mut &mut *values, |v| {
                (i32::from(**v) >> (bits - 1)) != (i32::from(**v) >> 31)
            }) {
                Some(&value) => Err(FixedNetworkError::TooWide { what, value, bits }),
                None => Ok(()),
            };
        fits("analysis", &mut self.analysis.weights.iter())?;
        fits("recurrent", &mut self.recurrent.iter().flat_map(|s| s.weights.iter()))?;
        fits("dictionary", &mut self.dictionary.weights.iter())?;
        fits("linear_path", &mut self.linear_path.iter().flat_map(|r| r.weights.iter()))?;
        fits("thresholds", &mut self.thresholds.iter().flatten())?;
        let shrinkage = self.form.shrinkage;
        match self.thresholds.iter().flatten().find(|v| **v < 0 && !shrinkage.allows_negative()) {
            Some(&value) => Err(FixedNetworkError::NegativeThreshold { shrinkage, value }),
            None => Ok(()),
        }
    }

    fn check_shifts(&self) -> Result<(), FixedNetworkError> {
        let legal = |what, shift: i64| {
            if (0..48).contains(&shift) { Ok(()) } else { Err(FixedNetworkError::Shift { what, shift }) }
        };
        let code = |t: usize| i64::from(self.code_fractions[t]);
        legal("I", i64::from(INPUT_FRACTION + self.analysis.fraction) - code(0))?;
        for layer in 0..self.form.middle_layers() {
            let sum = code(layer) + i64::from(self.recurrent_matrix(layer).fraction);
            let base = if self.form.recurrence == Recurrence::Direct { code(0) } else { code(layer) };
            legal("M base", sum - base)?;
            legal("M", sum - code(layer + 1))?;
        }
        let last = code(self.code_fractions.len() - 1) + i64::from(self.dictionary.fraction);
        let linear = self.linear_path.as_ref().map_or(last, |r| i64::from(INPUT_FRACTION + r.fraction));
        let sum = last.max(linear).max(i64::from(OUTPUT_FRACTION));
        legal("F", sum - i64::from(OUTPUT_FRACTION))?;
        legal("F alignment", sum - last.min(linear))
    }
}

/// Names of a network's layers in order: I, M…, F.
pub fn layer_names(layers: usize) -> impl Iterator<Item = &'static str> {
    std::iter::once("I").chain(std::iter::repeat_n("M", layers - 2)).chain(std::iter::once("F"))
}

/// Largest |Σ w·v| of each row for inputs of at most `largest`.
fn products(matrix: &FixedMatrix, largest: i128) -> impl Iterator<Item = i128> + '_ {
    let row_sum =
        |row: ndarray::ArrayView1<'_, i16>| row.iter().map(|w| i128::from(w.unsigned_abs())).sum::<i128>();
    matrix.weights.outer_iter().map(move |row| row_sum(row) * largest)
}

const fn signed_bits(largest: i128) -> u32 {
    128 - largest.leading_zeros() + 1
}
