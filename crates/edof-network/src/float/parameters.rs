//! All weights of a network in one flat vector, and where in it each matrix lies. Gradients and Adam's moments have the
//! same layout.

use crate::network::{Form, Network, Origin};
use edof_core::colour::RGB_OUTPUTS;
use ndarray::{Array1, Array2};
use std::ops::Range;

/// Where each matrix of a form lies in the flat vector; all matrices row-major.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// A: codes × inputs.
    pub analysis: Range<usize>,
    /// θ_t.
    pub thresholds: Vec<Range<usize>>,
    /// S_t: codes × codes.
    pub recurrent: Vec<Range<usize>>,
    /// D: outputs × codes.
    pub dictionary: Range<usize>,
    /// R: outputs × inputs; empty where the form has none.
    pub linear_path: Range<usize>,
    /// Outputs of F: 192 in RGB, 128 in 4:2:2.
    pub outputs: usize,
}

impl Layout {
    /// The layout of a form that gives RGB.
    #[must_use]
    pub fn new(form: &Form) -> Self {
        Self::giving(form, RGB_OUTPUTS)
    }

    /// The layout of a form whose F has N outputs.
    #[must_use]
    pub fn giving(form: &Form, outputs: usize) -> Self {
        let mut end = 0;
        let mut take = |length: usize| {
            end += length;
            end - length..end
        };
        let (codes, inputs) = (form.codes, form.inputs());
        Self {
            analysis: take(codes * inputs),
            thresholds: (0..form.shrinkages()).map(|_| take(codes)).collect(),
            recurrent: (0..form.recurrent_matrices()).map(|_| take(codes * codes)).collect(),
            dictionary: take(outputs * codes),
            linear_path: take(if form.linear_path { outputs * inputs } else { 0 }),
            outputs,
        }
    }

    /// Length of the flat vector.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.linear_path.end
    }

    /// Never: every form has weights.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The weights of a network as one vector.
///
/// ```
/// # use edof_network::float::parameters::flatten;
/// # fn show(network: &edof_network::Network) {
/// let flat = flatten(network);
/// # }
/// ```
#[must_use]
pub fn flatten(network: &Network) -> Vec<f32> {
    let mut flat = Vec::with_capacity(Layout::new(&network.form).len());
    flat.extend(&network.analysis);
    network.thresholds.iter().for_each(|t| flat.extend(t));
    network.recurrent.iter().for_each(|s| flat.extend(s));
    flat.extend(&network.dictionary);
    network.linear_path.iter().for_each(|r| flat.extend(r));
    flat
}

/// The network that a flat vector of its form describes.
///
/// # Panics
/// If `flat` is shorter than the form's layout.
#[must_use]
pub fn unflatten(form: Form, flat: &[f32], origin: Origin) -> Network {
    let layout = Layout::new(&form);
    let (codes, inputs) = (form.codes, form.inputs());
    let matrix = |range: &Range<usize>, columns: usize| {
        Array2::from_shape_fn((range.len() / columns, columns), |(r, c)| flat[range.start + r * columns + c])
    };
    Network {
        form,
        analysis: matrix(&layout.analysis, inputs),
        thresholds: layout.thresholds.iter().map(|t| Array1::from(flat[t.clone()].to_vec())).collect(),
        recurrent: layout.recurrent.iter().map(|s| matrix(s, codes)).collect(),
        dictionary: matrix(&layout.dictionary, codes),
        linear_path: form.linear_path.then(|| matrix(&layout.linear_path, inputs)),
        origin,
    }
}
