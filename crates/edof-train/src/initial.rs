//! Starting values: random analysis of whitened inputs, or ISTA's own matrices from a dictionary.

use crate::dataset::Batch;
use crate::linear_algebra::{cholesky, least_squares, solve_upper};
use crate::parameters::Layout;
use crate::pass::Pass;
use crate::random::Random;
use edof_spec::colour::RGB_OUTPUTS;
use edof_spec::network::{Form, Shrinkage};
use serde::{Deserialize, Serialize};

/// Windows that starting values are computed from.
pub const SAMPLES: usize = 16_384;
/// Codes that take the mean of one CFA colour each and keep a threshold of 0: thresholding them costs 8 dB.
const DC_CODES: usize = 4;

/// Where training starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// A = random directions of whitened inputs, S = 0, D and R by least squares.
    Whitened,
    /// The paper's: A = (1/L)Bᵀ, S = I − (1/L)BᵀB, θ = μ/L with B the dictionary seen through the camera (blurred over all ψ
    /// and mosaiced), D the sharp dictionary.
    Dictionary,
}

/// Starting weights in the flat layout of a form, from windows like those that it will be trained on ([`SAMPLES`] are
/// enough). The same batch and random stream give the same ones.
#[must_use]
pub fn initial(form: &Form, start: Start, batch: &Batch, random: &mut Random) -> Vec<f32> {
    match start {
        Start::Whitened => whitened(form, batch, random),
        Start::Dictionary => from_dictionary(form, batch, random),
    }
}

fn whitened(form: &Form, batch: &Batch, random: &mut Random) -> Vec<f32> {
    let layout = Layout::new(form);
    let (codes, pixels, side) = (form.codes, form.window.pixels(), form.window.side());
    let mut weights = vec![0.0; layout.len()];
    // With C = L·Lᵀ, rows g·L⁻¹ of random g see whitened inputs; no eigenvectors are needed for random directions.
    let factor = cholesky(&covariance(&batch.inputs, pixels, 1e-4), pixels);
    let direct = DC_CODES.min(codes);
    for (code, row) in weights[layout.analysis.clone()].chunks_exact_mut(pixels).enumerate() {
        if code < direct {
            let (r, c) = (code / 2, code % 2);
            let sees = |i: usize| (i / side % 2, i % side % 2) == (r, c);
            row.iter_mut()
                .enumerate()
                .for_each(|(i, w)| *w = if sees(i) { 8.0 / pixels as f32 } else { 0.0 });
            continue;
        }
        let mut direction: Vec<f64> = (0..pixels).map(|_| f64::from(random.normal())).collect();
        let norm = direction.iter().map(|v| v * v).sum::<f64>().sqrt();
        solve_upper(&factor, pixels, &mut direction);
        row.iter_mut().zip(&direction).for_each(|(w, v)| *w = (v / norm) as f32);
    }
    for theta in &layout.thresholds {
        weights[theta.clone()][direct..].fill(first_threshold(form.shrinkage));
    }
    for s in &layout.recurrent {
        weights[s.clone()].iter_mut().for_each(|w| *w = 0.01 * random.normal() / (codes as f32).sqrt());
    }
    fit_final_layer(form, &layout, batch, &mut weights);
    weights
}

/// Thresholds that training starts from, in units of a whitened code. One-sided codes that start nearly silent never
/// learn: from 0.5 a third of them died, at a cost of 0.2 dB. Two-sided ones need some threshold, or all is linear.
const fn first_threshold(shrinkage: Shrinkage) -> f32 {
    match shrinkage {
        Shrinkage::OneSided => 0.0,
        Shrinkage::TwoSided => 0.3,
    }
}

/// D and R by least squares over what the rest of the network makes of the batch.
fn fit_final_layer(form: &Form, layout: &Layout, batch: &Batch, weights: &mut [f32]) {
    let (codes, pixels) = (form.codes, form.window.pixels());
    let windows = batch.windows();
    let mut pass = Pass::new(*form, windows);
    pass.forward(weights, &batch.inputs, windows);
    let z = pass.z(form.middle_layers());
    let linear = if form.linear_path { pixels } else { 0 };
    let mut seen = Vec::with_capacity(windows * (codes + linear));
    for (z, y) in z.chunks_exact(codes).zip(batch.inputs.chunks_exact(pixels)) {
        seen.extend_from_slice(z);
        seen.extend_from_slice(&y[..linear]);
    }
    let map = least_squares(&seen, codes + linear, &batch.targets, RGB_OUTPUTS, 1e-4);
    for (output, row) in map.chunks_exact(codes + linear).enumerate() {
        weights[layout.dictionary.clone()][output * codes..][..codes].copy_from_slice(&row[..codes]);
        if form.linear_path {
            weights[layout.linear_path.clone()][output * pixels..][..pixels].copy_from_slice(&row[codes..]);
        }
    }
}

fn from_dictionary(form: &Form, batch: &Batch, random: &mut Random) -> Vec<f32> {
    let layout = Layout::new(form);
    let (codes, pixels) = (form.codes, form.window.pixels());
    let (dictionary, z) = learn_dictionary(&batch.targets, codes, random);
    // The mean of all blurred dictionaries, seen through the mosaic: the map from codes to raw windows.
    let blurred = least_squares(&z, codes, &batch.inputs, pixels, 1e-3);
    let gram = |i: usize, j: usize| {
        (0..pixels).map(|p| blurred[p * codes + i] * blurred[p * codes + j]).sum::<f32>()
    };
    let gram: Vec<f32> = (0..codes * codes).map(|at| gram(at / codes, at % codes)).collect();
    let bound = largest_eigenvalue(&gram, codes) * 1.01;
    let mut weights = vec![0.0; layout.len()];
    for (at, w) in weights[layout.analysis.clone()].iter_mut().enumerate() {
        *w = blurred[at % pixels * codes + at / pixels] / bound;
    }
    for theta in &layout.thresholds {
        weights[theta.clone()]
            .iter_mut()
            .enumerate()
            .for_each(|(i, t)| *t = if i == 0 { 0.0 } else { 0.002 / bound });
    }
    for s in &layout.recurrent {
        for (at, w) in weights[s.clone()].iter_mut().enumerate() {
            *w = f32::from(u8::from(at / codes == at % codes)) - gram[at] / bound;
        }
    }
    weights[layout.dictionary.clone()].copy_from_slice(&dictionary);
    if form.linear_path {
        weights[layout.linear_path.clone()].fill(0.0);
    }
    weights
}

/// A dictionary (192 × codes) for sharp patches and its codes (patches × codes) by the method of optimal directions: sparse
/// codes by ISTA, then the dictionary by least squares, in turn. Atom 0 is the mean.
fn learn_dictionary(patches: &[f32], codes: usize, random: &mut Random) -> (Vec<f32>, Vec<f32>) {
    let count = patches.len() / RGB_OUTPUTS;
    let mut dictionary = vec![0.0; RGB_OUTPUTS * codes];
    for code in 0..codes {
        let patch = &patches[random.below(count) * RGB_OUTPUTS..][..RGB_OUTPUTS];
        let mean = patch.iter().sum::<f32>() / RGB_OUTPUTS as f32;
        for (row, &value) in patch.iter().enumerate() {
            dictionary[row * codes + code] =
                if code == 0 { 1.0 } else { value - mean + 0.01 * random.normal() };
        }
    }
    let mut z = Vec::new();
    for _ in 0..6 {
        normalise_atoms(&mut dictionary, codes);
        z = sparse_codes(patches, &dictionary, codes, 0.02, 40);
        dictionary = least_squares(&z, codes, patches, RGB_OUTPUTS, 1e-4);
    }
    (dictionary, z)
}

fn normalise_atoms(dictionary: &mut [f32], codes: usize) {
    for code in 0..codes {
        let norm =
            (0..RGB_OUTPUTS).map(|r| dictionary[r * codes + code].powi(2)).sum::<f32>().sqrt().max(1e-6);
        (0..RGB_OUTPUTS).for_each(|r| dictionary[r * codes + code] /= norm);
    }
}

/// ISTA on ½‖x − Dz‖² + μ‖z‖₁ (atom 0 unpenalised), all patches at once.
fn sparse_codes(patches: &[f32], dictionary: &[f32], codes: usize, mu: f32, steps: usize) -> Vec<f32> {
    use crate::matmul::{Destination, Mat, product};
    let count = patches.len() / RGB_OUTPUTS;
    let d = Mat::new(dictionary, RGB_OUTPUTS, codes);
    let mut gram = vec![0.0; codes * codes];
    product(&mut gram, Destination::Replace, d.t(), d);
    let mut start = vec![0.0; count * codes];
    product(&mut start, Destination::Replace, Mat::new(patches, count, RGB_OUTPUTS), d);
    let step = 1.0 / (largest_eigenvalue(&gram, codes) * 1.01);
    let (mut z, mut toward) = (vec![0.0f32; count * codes], vec![0.0; count * codes]);
    for _ in 0..steps {
        product(&mut toward, Destination::Replace, Mat::new(&z, count, codes), Mat::new(&gram, codes, codes));
        for (i, ((z, &g), &b)) in z.iter_mut().zip(&toward).zip(&start).enumerate() {
            let moved = *z + step * (b - g);
            let theta = if i % codes == 0 { 0.0 } else { step * mu };
            *z = (moved - theta).max(0.0) + (moved + theta).min(0.0);
        }
    }
    z
}

fn largest_eigenvalue(matrix: &[f32], n: usize) -> f32 {
    let mut vector = vec![1.0f32; n];
    let mut value = 0.0;
    for _ in 0..100 {
        let next: Vec<f32> =
            matrix.chunks_exact(n).map(|row| row.iter().zip(&vector).map(|(a, b)| a * b).sum()).collect();
        value = next.iter().map(|v| v * v).sum::<f32>().sqrt();
        vector = next.into_iter().map(|v| v / value.max(1e-20)).collect();
    }
    value
}

/// Row-major covariance of rows of `values`, with `floor` added to its diagonal.
fn covariance(values: &[f32], n: usize, floor: f64) -> Vec<f64> {
    let count = values.len() / n;
    let mut mean = vec![0.0f64; n];
    values.chunks_exact(n).for_each(|row| mean.iter_mut().zip(row).for_each(|(m, &v)| *m += f64::from(v)));
    mean.iter_mut().for_each(|m| *m /= count as f64);
    let mut matrix = vec![0.0; n * n];
    let mut centred = vec![0.0; n];
    for row in values.chunks_exact(n) {
        centred.iter_mut().zip(row).zip(&mean).for_each(|((c, &v), m)| *c = f64::from(v) - m);
        for (line, &a) in matrix.chunks_exact_mut(n).zip(&centred) {
            line.iter_mut().zip(&centred).for_each(|(m, b)| *m += a * b);
        }
    }
    matrix.iter_mut().for_each(|m| *m /= count as f64);
    (0..n).for_each(|i| matrix[i * n + i] += floor);
    matrix
}
