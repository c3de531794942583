//! Starting values: random analysis of whitened inputs, or ISTA's own matrices from a dictionary.

use crate::dataset::Batch;
use crate::structure::Structure;
use edof_core::colour::RGB_OUTPUTS;
use edof_network::float::parameters::Layout;
use edof_network::float::pass::Pass;
use edof_network::network::Form;
use edof_numerics::random::Random;
use edof_numerics::sparse::dictionary::{Effort, Learned, optimal_directions};
use edof_numerics::sparse::lasso::step_bound;
use edof_numerics::{Cholesky, least_squares};
use ndarray::{Array1, Array2, ArrayView2, Axis, concatenate, s};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Windows that starting values are computed from.
pub const SAMPLES: usize = 16_384;
/// Codes that take the mean of one CFA colour each and keep a threshold of 0: thresholding them costs 8 dB.
const DC_CODES: usize = 4;
/// Mean square that is added to every pixel's before windows are whitened.
const FLOOR: f64 = 1e-4;
/// μ of the dictionary that training may start from, and of the thresholds that go with it, in units of full scale.
const DICTIONARY_PENALTY: f32 = 0.02;
const FIRST_PENALTY: f32 = 0.002;
/// How long that dictionary is learned.
const DICTIONARY_EFFORT: Effort = Effort { rounds: 6, steps: 40 };

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
/// enough). The same batch and random stream give the same ones. Of a symmetric structure, codes of the second half are partners of the first.
#[must_use]
pub fn initial(
    form: &Form,
    (start, structure): (Start, Structure),
    batch: &Batch,
    random: &mut Random,
) -> Vec<f32> {
    let mut weights = match start {
        Start::Whitened => whitened(form, batch, random),
        Start::Dictionary => from_dictionary(form, batch, random),
    };
    if structure == Structure::Symmetric {
        let layout = Layout::new(form);
        structure.held(form, &layout, &weights).begin(&layout, &mut weights);
        fit_final_layer(form, &layout, batch, &mut weights);
    }
    weights
}

fn whitened(form: &Form, batch: &Batch, random: &mut Random) -> Vec<f32> {
    let layout = Layout::new(form);
    let (codes, inputs) = (form.codes, form.inputs());
    let mut weights = vec![0.0; layout.len()];
    let direct = DC_CODES.min(codes);
    // With C = L·Lᵀ, rows g·L⁻¹ of random g see whitened inputs; no eigenvectors are needed for random directions.
    let mut directions =
        Array2::from_shape_simple_fn((codes - direct, inputs), || f64::from(random.normal()));
    directions.outer_iter_mut().for_each(|mut g| g /= g.dot(&g).sqrt());
    let moments = covariance(rows(&batch.inputs, inputs));
    let seen = directions.dot(&Cholesky::of_moments(moments.view()).whitening());
    let analysis = concatenate![Axis(0), colour_means(form, direct), seen.mapv(|w| w as f32)];
    put(&mut weights, &layout.analysis, &analysis);
    for theta in &layout.thresholds {
        weights[theta.clone()][direct..].fill(form.shrinkage.training().threshold);
    }
    for s in &layout.recurrent {
        weights[s.clone()].iter_mut().for_each(|w| *w = 0.01 * random.normal() / (codes as f32).sqrt());
    }
    fit_final_layer(form, &layout, batch, &mut weights);
    weights
}

/// Rows that take the mean of one CFA colour of the window (of every exposure) each, `count` of the four.
fn colour_means(form: &Form, count: usize) -> Array2<f32> {
    let (inputs, side) = (form.inputs(), form.window.side());
    Array2::from_shape_fn((count, inputs), |(code, i)| {
        let site = i / side % 2 * 2 + i % side % 2;
        if site == code { 8.0 / inputs as f32 } else { 0.0 }
    })
}

/// D and R by least squares over what the rest of the network makes of the batch.
fn fit_final_layer(form: &Form, layout: &Layout, batch: &Batch, weights: &mut [f32]) {
    let (codes, inputs) = (form.codes, form.inputs());
    let windows = batch.windows();
    let mut pass = Pass::new(*form, windows);
    pass.forward(weights, &batch.inputs, windows);
    let z = rows(pass.z(form.middle_layers()), codes);
    let linear = rows(&batch.inputs, inputs);
    let linear = if form.linear_path { linear } else { linear.slice_move(s![.., ..0]) };
    let seen = concatenate![Axis(1), z, linear];
    let map = least_squares(seen.view(), rows(&batch.targets, RGB_OUTPUTS), 1e-4);
    put(weights, &layout.dictionary, map.slice(s![.., ..codes]));
    put(weights, &layout.linear_path, map.slice(s![.., codes..]));
}

fn from_dictionary(form: &Form, batch: &Batch, random: &mut Random) -> Vec<f32> {
    let layout = Layout::new(form);
    let (codes, inputs) = (form.codes, form.inputs());
    // Atom 0 is the mean, and free.
    let mut penalties = Array1::from_elem(codes, 1.0);
    penalties[0] = 0.0;
    let sharp = rows(&batch.targets, RGB_OUTPUTS);
    let Learned { dictionary, codes: z } = optimal_directions(
        sharp,
        first_atoms(sharp, codes, random),
        (&penalties * DICTIONARY_PENALTY).view(),
        DICTIONARY_EFFORT,
    );
    // The mean of all blurred dictionaries, seen through the mosaic: the map from codes to raw windows.
    let blurred = least_squares(z.view(), rows(&batch.inputs, inputs), 1e-3);
    let gram = blurred.t().dot(&blurred);
    let bound = step_bound(gram.view());
    let mut weights = vec![0.0; layout.len()];
    put(&mut weights, &layout.analysis, &(&blurred.t() / bound));
    for theta in &layout.thresholds {
        put(&mut weights, theta, &(&penalties * (FIRST_PENALTY / bound)));
    }
    for s in &layout.recurrent {
        put(&mut weights, s, &(Array2::eye(codes) - &gram / bound));
    }
    put(&mut weights, &layout.dictionary, &dictionary);
    weights
}

/// Atoms to learn from (192 × atoms): the mean, and random patches without theirs.
fn first_atoms(patches: ArrayView2<'_, f32>, atoms: usize, random: &mut Random) -> Array2<f32> {
    let mut dictionary = Array2::ones((patches.ncols(), atoms));
    for mut atom in dictionary.axis_iter_mut(Axis(1)).skip(1) {
        let patch = patches.row(random.below(patches.nrows()));
        let mean = patch.sum() / patch.len() as f32;
        atom.zip_mut_with(&patch, |a, value| *a = value - mean + 0.01 * random.normal());
    }
    dictionary
}

/// Covariance of rows of `values`, with [`FLOOR`] added to its diagonal.
fn covariance(values: ArrayView2<'_, f32>) -> Array2<f64> {
    let values = values.mapv(f64::from);
    let count = values.nrows() as f64;
    let centred = &values - &(values.sum_axis(Axis(0)) / count);
    centred.t().dot(&centred) / count + Array2::<f64>::eye(values.ncols()) * FLOOR
}

/// The matrix whose rows lie one after the other in `values`.
fn rows(values: &[f32], columns: usize) -> ArrayView2<'_, f32> {
    let shape = (values.len() / columns, columns);
    ArrayView2::from_shape(shape, values).unwrap_or_else(|e| unreachable!("rows of a batch are whole: {e}"))
}

/// Writes values in reading order.
fn put<'a>(weights: &mut [f32], at: &Range<usize>, values: impl IntoIterator<Item = &'a f32>) {
    weights[at.clone()].iter_mut().zip(values).for_each(|(w, v)| *w = *v);
}
