//! Coordinates in which training is well conditioned: A and R act on whitened windows.
//!
//! Neighbouring pixels are nearly equal, so one small step of all of A's entries moves every code a lot along the mean and
//! hardly at all along what is fine. With E[y·yᵀ] = L·Lᵀ, training moves A′ = A·L and R′ = R·L instead; the network is unchanged.

use edof_network::float::matmul::{Destination, Mat, product};
use edof_network::float::parameters::Layout;
use edof_numerics::Cholesky;
use ndarray::Array2;
use rayon::prelude::*;
use std::ops::Range;

/// Rows of a matrix that one thread multiplies at a time.
const ROWS: usize = 48;

/// The change of coordinates of one run; decided by a batch of its windows.
#[derive(Debug, Clone)]
pub struct Precondition(Vec<Block>);

/// Matrices that multiply the same inputs.
#[derive(Debug, Clone)]
struct Block {
    matrices: Vec<Range<usize>>,
    inputs: usize,
    whiten: Vec<f32>,
    colour: Vec<f32>,
}

impl Precondition {
    /// Coordinates that whiten `inputs` (windows × pixels); directions weaker than `floor` (mean square) are not amplified further.
    #[must_use]
    pub fn new(layout: &Layout, inputs: &[f32], pixels: usize, floor: f64) -> Self {
        let factor = Cholesky::of_moments(second_moment(inputs, pixels, floor).view());
        Self(vec![Block::new(vec![layout.analysis.clone(), layout.linear_path.clone()], &factor)])
    }

    /// Coordinates in which each matrix acts on white inputs; beside it stands the factor of their moments.
    #[must_use]
    pub fn of<'a>(matrices: impl IntoIterator<Item = (Range<usize>, &'a Cholesky)>) -> Self {
        Self(matrices.into_iter().map(|(matrix, factor)| Block::new(vec![matrix], factor)).collect())
    }

    /// The network's weights for those in training coordinates.
    pub fn to_network(&self, trained: &[f32], network: &mut [f32]) {
        network.copy_from_slice(trained);
        self.0.iter().for_each(|block| block.multiply(trained, network, block.matrix(&block.whiten)));
    }

    /// Inverse of [`Precondition::to_network`].
    pub fn to_trained(&self, network: &[f32], trained: &mut [f32]) {
        trained.copy_from_slice(network);
        self.0.iter().for_each(|block| block.multiply(network, trained, block.matrix(&block.colour)));
    }

    /// Turns a gradient for the network's weights into one for the trained coordinates: the adjoint of
    /// [`Precondition::to_network`].
    pub fn pull_back(&self, gradient: &mut [f32], scratch: &mut [f32]) {
        scratch.copy_from_slice(gradient);
        self.0.iter().for_each(|block| block.multiply(scratch, gradient, block.matrix(&block.whiten).t()));
    }
}

impl Block {
    fn new(matrices: Vec<Range<usize>>, factor: &Cholesky) -> Self {
        let flat = |matrix: &Array2<f64>| matrix.iter().map(|v| *v as f32).collect::<Vec<_>>();
        let colour = factor.lower();
        Self { matrices, inputs: colour.nrows(), whiten: flat(&factor.whitening()), colour: flat(colour) }
    }

    fn matrix<'a>(&self, values: &'a [f32]) -> Mat<'a> {
        Mat::new(values, self.inputs, self.inputs)
    }

    fn multiply(&self, from: &[f32], to: &mut [f32], by: Mat<'_>) {
        for range in self.matrices.iter().filter(|r| !r.is_empty()) {
            let piece = ROWS * self.inputs;
            let pieces = to[range.clone()].par_chunks_mut(piece).zip(from[range.clone()].par_chunks(piece));
            pieces.for_each(|(to, from)| {
                let matrix = Mat::new(from, from.len() / self.inputs, self.inputs);
                product(to, Destination::Replace, matrix, by);
            });
        }
    }
}

/// Mean of y·yᵀ over rows of `values`, with `floor` added to its diagonal.
fn second_moment(values: &[f32], n: usize, floor: f64) -> Array2<f64> {
    let count = values.len() / n;
    let mut sums = Array2::<f64>::zeros((n, n));
    // f32 products of a few hundred rows lose nothing that matters; the sum over all rows is kept in f64.
    let mut part = vec![0.0f32; n * n];
    for rows in values.chunks(256 * n) {
        let rows = Mat::new(rows, rows.len() / n, n);
        product(&mut part, Destination::Replace, rows.t(), rows);
        sums.iter_mut().zip(&part).for_each(|(s, &p)| *s += f64::from(p));
    }
    sums /= count as f64;
    sums.diag_mut().mapv_inplace(|v| v + floor);
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Window;
    use edof_network::network::{Form, Recurrence, Shrinkage};
    use edof_numerics::random::Random;

    fn example() -> (Precondition, usize) {
        let form = Form {
            window: Window::new(8).unwrap(),
            codes: 5,
            layers: 3,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Direct,
            linear_path: true,
            tied: false,
            exposures: 1,
        };
        let layout = Layout::new(&form);
        let mut random = Random::new(3, 0, 0);
        let inputs: Vec<f32> =
            (0..64 * 500).map(|i| 0.5 + 0.1 * random.normal() + (i % 64) as f32 * 0.01).collect();
        (Precondition::new(&layout, &inputs, 64, 1e-5), layout.len())
    }

    fn noise(length: usize, seed: u64) -> Vec<f32> {
        let mut random = Random::new(seed, 0, 0);
        (0..length).map(|_| random.normal()).collect()
    }

    #[test]
    fn coordinates_there_and_back_are_the_same() {
        let (condition, length) = example();
        let network = noise(length, 1);
        let (mut trained, mut back) = (vec![0.0; length], vec![0.0; length]);
        condition.to_trained(&network, &mut trained);
        condition.to_network(&trained, &mut back);
        assert!(network.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-2));
        assert!(network.iter().zip(&trained).any(|(a, b)| (a - b).abs() > 0.1));
    }

    #[test]
    fn pulling_back_is_the_adjoint() {
        let (condition, length) = example();
        let (trained, gradient) = (noise(length, 1), noise(length, 2));
        let (mut network, mut pulled, mut scratch) = (vec![0.0; length], gradient.clone(), vec![0.0; length]);
        condition.to_network(&trained, &mut network);
        condition.pull_back(&mut pulled, &mut scratch);
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(x, y)| f64::from(x * y)).sum::<f64>();
        let (left, right) = (dot(&network, &gradient), dot(&trained, &pulled));
        assert!((left - right).abs() < 1e-3 * left.abs().max(1.0), "{left} {right}");
    }
}
