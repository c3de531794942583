//! Rounding of weights so that what they are multiplied with hides the error.
//!
//! Windows are smooth and codes go together, so rounding errors of single weights need not be small, only their sum over the
//! inputs that occur. For a row w and inputs v with moments H = E[v vᵀ] = L Lᵀ the mean squared error is ‖Lᵀ(w − q)‖²; each word
//! q_j is chosen, last column first, as the nearest to what makes its component zero given the words chosen before (Babai's
//! nearest plane; the same as GPTQ, Frantar et al. 2023).

use crate::Calibration;
use edof_float::parameters::Layout;
use edof_network::network::Form;
use edof_numerics::Cholesky;
use ndarray::{Array1, Array2, concatenate, s};
use std::ops::Range;

/// Share of the mean square of an input that is added to every input's: rare inputs must not bend the weights of others.
const RIDGE: f64 = 1e-4;

/// How inputs go together: the factors L of their moments.
#[derive(Debug, Clone)]
pub struct Rounding {
    analysis: Cholesky,
    recurrent: Vec<Cholesky>,
    /// Of the last codes alone.
    last: Cholesky,
    outputs: Cholesky,
}

impl Rounding {
    /// The factors of what calibration saw, for codes scaled by `scales`.
    #[must_use]
    pub fn new(calibration: &Calibration, scales: &[f64], form: &Form) -> Self {
        let (codes, n) = (scales.len(), calibration.outputs.nrows());
        let scale = |i: usize| scales.get(i).copied().unwrap_or(1.0);
        let scaled = |moments: &Array2<f64>| {
            Array2::from_shape_fn(moments.dim(), |(i, j)| moments[(i, j)] * scale(i) * scale(j))
        };
        let recurrent = (0..form.recurrent_matrices())
            .map(|matrix| {
                let layers = calibration.sent.iter().enumerate();
                let uses = layers.filter(|(layer, _)| form.recurrent_index(*layer) == matrix);
                let sum = uses.fold(Array2::zeros((codes, codes)), |sum, (_, moments)| sum + moments);
                factor(scaled(&sum))
            })
            .collect();
        let outputs = factor(scaled(&calibration.outputs));
        Self {
            analysis: factor(calibration.outputs.slice(s![codes..n, codes..n]).to_owned()),
            recurrent,
            last: outputs.leading(codes),
            outputs,
        }
    }

    /// Each matrix of `layout` with the factor of what it multiplies. D and R come alone.
    pub fn factors<'a>(&'a self, layout: &Layout) -> Vec<(Range<usize>, &'a Cholesky)> {
        let outputs = [(&layout.dictionary, &self.last), (&layout.linear_path, &self.analysis)];
        std::iter::once((&layout.analysis, &self.analysis))
            .chain(layout.recurrent.iter().zip(&self.recurrent))
            .chain(outputs)
            .map(|(range, factor)| (range.clone(), factor))
            .collect()
    }

    /// A's words.
    #[must_use]
    pub fn analysis(&self, a: &Array2<f64>, fraction: u32, bits: u32) -> Array2<i16> {
        round(&self.analysis, a, &vec![fraction; a.ncols()], bits)
    }

    /// Words of the `matrix`-th S.
    #[must_use]
    pub fn recurrent(&self, matrix: usize, s: &Array2<f64>, fraction: u32, bits: u32) -> Array2<i16> {
        round(&self.recurrent[matrix], s, &vec![fraction; s.ncols()], bits)
    }

    /// Words of D and, where there is one, R: their errors are hidden together. Each comes with its fraction bits.
    #[must_use]
    pub fn outputs(
        &self,
        (d, d_fraction): (&Array2<f64>, u32),
        r: Option<(&Array2<f64>, u32)>,
        bits: u32,
    ) -> (Array2<i16>, Option<Array2<i16>>) {
        let codes = d.ncols();
        let Some((r, r_fraction)) = r else {
            return (round(&self.last, d, &vec![d_fraction; codes], bits), None);
        };
        let fractions = [vec![d_fraction; codes], vec![r_fraction; r.ncols()]].concat();
        let Ok(both) = concatenate(ndarray::Axis(1), &[d.view(), r.view()]) else {
            unreachable!("D and R have 128 rows each");
        };
        let words = round(&self.outputs, &both, &fractions, bits);
        (words.slice(s![.., ..codes]).to_owned(), Some(words.slice(s![.., codes..]).to_owned()))
    }
}

/// The factor of moments, lifted by [`RIDGE`].
fn factor(mut moments: Array2<f64>) -> Cholesky {
    let mean = moments.diag().mean().unwrap_or(0.0);
    let ridge = if mean > 0.0 { RIDGE * mean } else { 1.0 };
    moments.diag_mut().mapv_inplace(|v| v + ridge);
    Cholesky::of_moments(moments.view())
}

/// Words of each row of `matrix`, whose inputs have the moments of `factor`; `fractions` are the columns' fraction bits.
fn round(factor: &Cholesky, matrix: &Array2<f64>, fractions: &[u32], bits: u32) -> Array2<i16> {
    let max = f64::from((1u32 << (bits - 1)) - 1);
    let l = factor.lower();
    let mut words = Array2::zeros(matrix.dim());
    for (row, mut out) in matrix.outer_iter().zip(words.outer_iter_mut()) {
        // pull[j] = Σ over columns k > j of L_kj·(w_k − q_k).
        let mut pull = Array1::<f64>::zeros(row.len());
        for j in (0..row.len()).rev() {
            let unit = f64::from(fractions[j]).exp2();
            let wanted = row[j] + pull[j] / l[(j, j)];
            let word = (wanted * unit + 0.5).floor().clamp(-max - 1.0, max);
            out[j] = word as i16;
            let error = row[j] - word / unit;
            pull.slice_mut(s![..j]).scaled_add(error, &l.slice(s![j, ..j]));
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_image::draw::Draw;

    /// Smooth inputs: a level and a little noise.
    fn inputs(n: usize) -> Vec<Vec<f64>> {
        let mut draw = Draw::new(3);
        (0..2000)
            .map(|_| {
                let level = draw.whole(0, 1000) as f64 * 1e-3;
                (0..n).map(|_| level + draw.whole(-20, 20) as f64 * 1e-3).collect()
            })
            .collect()
    }

    #[test]
    fn errors_hide_in_smooth_inputs() {
        let n = 64;
        let inputs = inputs(n);
        let mut draw = Draw::new(5);
        let matrix = Array2::from_shape_fn((8, n), |_| draw.whole(-1000, 1000) as f64 * 1e-3);
        let mut moments = Array2::zeros((n, n));
        for v in &inputs {
            moments += &Array2::from_shape_fn((n, n), |(i, j)| v[i] * v[j]);
        }
        let words = round(&factor(moments), &matrix, &vec![6; n], 8);
        let nearest = matrix.mapv(|w| (w * 64.0).round() as i16);
        let error = |words: &Array2<i16>| {
            let off = &matrix - &words.mapv(|w| f64::from(w) / 64.0);
            inputs.iter().map(|v| off.dot(&ndarray::aview1(v)).mapv(|e| e * e).sum()).sum::<f64>()
        };
        assert!(error(&words) < 0.1 * error(&nearest), "{} {}", error(&words), error(&nearest));
    }

    #[test]
    fn inputs_that_go_their_own_ways_are_rounded_to_nearest() {
        let mut draw = Draw::new(5);
        let matrix = Array2::from_shape_fn((8, 16), |_| draw.whole(-1000, 1000) as f64 * 1e-3);
        let words = round(&factor(Array2::eye(16)), &matrix, &[6; 16], 8);
        assert_eq!(words, matrix.mapv(|w| (w * 64.0 + 0.5).floor() as i16));
    }
}
