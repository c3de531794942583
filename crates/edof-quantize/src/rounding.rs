//! Rounding of weights so that what they are multiplied with hides the error.
//!
//! Windows are smooth and codes go together, so rounding errors of single weights need not be small, only their sum over the
//! inputs that occur. For a row w and inputs v with moments H = E[v vᵀ] = L Lᵀ the mean squared error is ‖Lᵀ(w − q)‖²; each word
//! q_j is chosen, last column first, as the nearest to what makes its component zero given the words chosen before (Babai's
//! nearest plane; the same as GPTQ, Frantar et al. 2023).

use crate::Calibration;
use edof_network::float::parameters::Layout;
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
    use edof_core::draw::Draw;

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

    /// What is left of a row's error along each column of L, in half steps: rounding keeps it within −1…1.
    fn left_over(factor: &Cholesky, row: &[f64], words: &[i16], fractions: &[u32]) -> Vec<f64> {
        let unit = |k: usize| 0.5f64.powi(fractions[k] as i32);
        let l = factor.lower();
        let error = |k: usize| row[k] - f64::from(words[k]) * unit(k);
        let along = |j: usize| (j..row.len()).map(|k| l[(k, j)] * error(k)).sum::<f64>();
        (0..row.len()).map(|j| along(j) / (0.5 * l[(j, j)] * unit(j))).collect()
    }

    fn some_moments(n: usize, seed: u64) -> Array2<f64> {
        let mut draw = Draw::new(seed);
        let v = Array2::from_shape_fn((n, 2 * n), |_| draw.whole(-100, 200) as f64 * 0.01);
        v.dot(&v.t())
    }

    #[test]
    fn along_every_column_less_than_half_a_step_is_left() {
        let (n, fractions) = (6, [3, 5, 4, 6, 2, 5]);
        for seed in 0..20 {
            let mut draw = Draw::new(seed);
            let factor = factor(some_moments(n, seed));
            let matrix = Array2::from_shape_fn((4, n), |_| draw.whole(-1000, 1000) as f64 * 1e-3);
            let words = round(&factor, &matrix, &fractions, 16);
            for (row, words) in matrix.outer_iter().zip(words.outer_iter()) {
                let left = left_over(&factor, &row.to_vec(), &words.to_vec(), &fractions);
                assert!(left.iter().all(|e| e.abs() <= 1.0 + 1e-9), "seed {seed}: {left:?}");
            }
        }
    }

    #[test]
    fn words_are_held_to_their_width_and_ties_go_up() {
        let matrix = ndarray::array![[0.5, -0.5, 126.5, 127.5, -128.5, -129.5]];
        let words = round(&factor(Array2::eye(6)), &matrix, &[0; 6], 8);
        assert_eq!(words, ndarray::array![[1, 0, 127, 127, -128, -128]]);
        let wide = round(&factor(Array2::eye(2)), &ndarray::array![[40000.0, -40000.0]], &[0; 2], 16);
        assert_eq!(wide, ndarray::array![[32767, -32768]]);
    }

    #[test]
    fn an_error_is_passed_on_to_the_columns_before_by_its_factor() {
        // L = [[2, 0], [1, 1]]: 0.4 left of the last column pulls the first by 0.4/2.
        let factor = Cholesky::of_moments(ndarray::array![[4.0, 2.0], [2.0, 2.0]].view());
        let words = |first: f64| round(&factor, &ndarray::array![[first, 0.4]], &[0; 2], 8);
        assert_eq!(words(0.31), ndarray::array![[1, 0]]);
        assert_eq!(words(0.29), ndarray::array![[0, 0]]);
    }

    #[test]
    fn a_factor_is_that_of_the_moments_lifted_by_a_share_of_their_mean() {
        let moments = some_moments(5, 7);
        let lift = 1e-4 * moments.diag().sum() / 5.0;
        let l = factor(moments.clone()).lower().clone();
        assert_near(&l.dot(&l.t()), &(moments + lift * Array2::<f64>::eye(5)));
        assert_near(factor(Array2::zeros((3, 3))).lower(), &Array2::eye(3));
    }

    fn assert_near(found: &Array2<f64>, expected: &Array2<f64>) {
        assert_eq!(found.dim(), expected.dim());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs())));
    }

    fn lifted(moments: &Array2<f64>) -> Array2<f64> {
        let n = moments.nrows();
        moments + 1e-4 * moments.diag().sum() / n as f64 * Array2::<f64>::eye(n)
    }

    fn form(tied: bool) -> Form {
        Form {
            window: edof_core::Window::new(8).unwrap(),
            codes: 2,
            layers: 4,
            shrinkage: edof_network::network::Shrinkage::OneSided,
            recurrence: edof_network::network::Recurrence::Direct,
            linear_path: true,
            tied,
            exposures: 1,
        }
    }

    #[test]
    fn each_matrix_has_the_moments_of_what_it_multiplies_in_scaled_codes() {
        let mut seen = Calibration::new(&form(false));
        seen.sent = vec![some_moments(2, 1), some_moments(2, 2)];
        seen.outputs = some_moments(66, 3);
        let scales = [2.0, 3.0];
        let scaled = |m: &Array2<f64>| ndarray::array![[4.0, 6.0], [6.0, 9.0]] * m;
        let moments = |factor: &Cholesky| factor.lower().dot(&factor.lower().t());
        let apart = Rounding::new(&seen, &scales, &form(false));
        assert_eq!(apart.recurrent.len(), 2);
        for (factor, sent) in apart.recurrent.iter().zip(&seen.sent) {
            assert_near(&moments(factor), &lifted(&scaled(sent)));
        }
        let tied = Rounding::new(&seen, &scales, &form(true));
        assert_eq!(tied.recurrent.len(), 1);
        assert_near(&moments(&tied.recurrent[0]), &lifted(&scaled(&(&seen.sent[0] + &seen.sent[1]))));
        assert_near(&moments(&apart.analysis), &lifted(&seen.outputs.slice(s![2.., 2..]).to_owned()));
        let scale = |i: usize| if i < 2 { scales[i] } else { 1.0 };
        let all = Array2::from_shape_fn((66, 66), |(i, j)| seen.outputs[(i, j)] * scale(i) * scale(j));
        assert_near(&moments(&apart.outputs), &lifted(&all));
        assert_near(&moments(&apart.last), &lifted(&all).slice(s![..2, ..2]).to_owned());
    }

    #[test]
    fn every_matrix_of_a_layout_comes_with_a_factor_as_wide_as_it_is() {
        let form = form(false);
        let layout = Layout::giving(&form, 128);
        let rounding = Rounding::new(&Calibration::new(&form), &[1.0; 2], &form);
        let found = rounding.factors(&layout);
        let found: Vec<_> =
            found.iter().map(|(range, factor)| (range.clone(), factor.lower().nrows())).collect();
        let expected = [
            (layout.analysis, 64),
            (layout.recurrent[0].clone(), 2),
            (layout.recurrent[1].clone(), 2),
            (layout.dictionary, 2),
            (layout.linear_path, 64),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn the_last_layers_matrices_are_rounded_together_each_in_its_own_format() {
        let mut seen = Calibration::new(&form(false));
        seen.outputs = some_moments(66, 5);
        seen.sent = vec![some_moments(2, 1), some_moments(2, 2)];
        let rounding = Rounding::new(&seen, &[1.0, 2.0], &form(false));
        let mut draw = Draw::new(6);
        let mut matrix =
            |columns| Array2::from_shape_fn((128, columns), |_| draw.whole(-1000, 1000) as f64 * 1e-3);
        let (d, r, s) = (matrix(2), matrix(64), matrix(2));
        let (d_words, r_words) = rounding.outputs((&d, 5), Some((&r, 7)), 12);
        let r_words = r_words.unwrap();
        let fractions = [vec![5; 2], vec![7; 64]].concat();
        for row in 0..128 {
            let of = |a: &Array2<f64>, b: &Array2<f64>| [a.row(row).to_vec(), b.row(row).to_vec()].concat();
            let words = [d_words.row(row).to_vec(), r_words.row(row).to_vec()].concat();
            let left = left_over(&rounding.outputs, &of(&d, &r), &words, &fractions);
            assert!(left.iter().all(|e| e.abs() <= 1.0 + 1e-9));
        }
        assert_eq!(rounding.outputs((&d, 5), None, 12), (round(&rounding.last, &d, &[5; 2], 12), None));
        assert_eq!(rounding.analysis(&r, 6, 12), round(&rounding.analysis, &r, &[6; 64], 12));
        assert_eq!(rounding.recurrent(1, &s, 6, 12), round(&rounding.recurrent[1], &s, &[6; 2], 12));
    }
}
