//! Numerics that optics, sparse coding, training and quantization share: Cholesky factors, normal equations and the largest eigenvalue in f64,
//! Fourier transforms ([`fft`]), reproducible random numbers ([`random`]), dictionaries and sparse codes ([`sparse`]).
//!
//! Linear algebra runs on the calling thread in one order, so results do not depend on how many threads there are. Matrices have some
//! hundred rows; a library for larger ones costs more to build than this ever takes to run (`docs/decisions/0001-workspace.md`).
//!
//! ```
//! use edof_numerics::Cholesky;
//! use ndarray::array;
//! let factor = Cholesky::new(array![[4.0, 2.0], [2.0, 10.0]].view())?;
//! assert_eq!(factor.lower(), array![[2.0, 0.0], [1.0, 3.0]]);
//! # Ok::<(), edof_numerics::NotPositive>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

mod cholesky;
pub mod fft;
mod functions;
mod least_squares;
pub mod random;
pub mod sparse;

pub use cholesky::{Cholesky, NotPositive};
pub use functions::{mean, sinc};
pub use least_squares::least_squares;

use ndarray::{Array1, ArrayView2};

/// Steps of the power iteration: the fewest, and the most where the vector is still turning.
const STEPS: std::ops::RangeInclusive<usize> = 200..=20_000;
/// Enough once the residual ‖A·v − λ·v‖ is this share of λ.
const RESIDUAL: f64 = 1e-3;

/// The largest eigenvalue of a symmetric matrix without negative ones, by power iteration, to within a thousandth; NaN if the matrix is
/// not finite.
///
/// What holds: the number is a Rayleigh quotient, so it is never above the largest eigenvalue; and where the iteration has ended by
/// its residual, an eigenvalue is no farther from it than a thousandth of it. That this is the largest one is not proved: a start that is
/// orthogonal to the largest one's vector, to the last bit, would not see it. Anybody who needs a bound from above adds a margin.
#[must_use]
pub fn largest_eigenvalue(symmetric: ArrayView2<'_, f64>) -> f64 {
    // Numbers that no symmetry of the matrix has.
    let mut vector = Array1::from_shape_fn(symmetric.nrows(), |i| 1.0 + ((i * 7919) % 1013) as f64 / 1013.0);
    let mut value = 0.0;
    for step in 1..=*STEPS.end() {
        vector /= vector.dot(&vector).sqrt().max(f64::MIN_POSITIVE);
        let next = symmetric.dot(&vector);
        value = vector.dot(&next);
        // ‖A·v − λ·v‖² = ‖A·v‖² − λ² for ‖v‖ = 1.
        let turning = next.dot(&next) - value * value > (RESIDUAL * value).powi(2);
        if step >= *STEPS.start() && !turning {
            break;
        }
        vector = next;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array2, Axis};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_eigenvalue_is_found_and_the_largest_where_no_other_is_near(
            axes in prop::collection::vec(-1.0f64..1.0, 25), values in prop::collection::vec(0.0f64..1.0, 5)
        ) {
            // Columns made orthonormal one after the other (Gram and Schmidt) are eigenvectors of Q·diag(values)·Qᵀ.
            let mut q = Array2::from_shape_vec((5, 5), axes).unwrap();
            for column in 0..5 {
                let (known, mut rest) = q.view_mut().split_at(Axis(1), column);
                let mut axis = rest.column_mut(0);
                for other in known.columns() {
                    let along = axis.dot(&other);
                    axis.scaled_add(-along, &other);
                }
                let norm = axis.dot(&axis).sqrt();
                prop_assume!(norm > 1e-2);
                axis /= norm;
            }
            let found = largest_eigenvalue((&q * &Array1::from(values.clone())).dot(&q.t()).view());
            let is_near = |value: f64| (value - found).abs() <= 1e-3 * value + 1e-9;
            let largest = values.iter().copied().fold(0.0, f64::max);
            prop_assert!(found <= largest + 1e-9 && values.iter().any(|value| is_near(*value)), "{found} of {values:?}");
            let has_rival = values.iter().filter(|value| **value > 0.9 * largest).count() > 1;
            prop_assert!(has_rival || is_near(largest), "{found} for {largest}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_no_largest_eigenvalue() {
        assert!(largest_eigenvalue(Array2::from_elem((3, 3), f64::NAN).view()).is_nan());
    }

    #[test]
    fn an_eigenvalue_that_the_start_hardly_sees_is_waited_for() {
        // The start has a hundredth of its length along the larger one's vector, which 200 steps of 1.02 bring out by half.
        let start = Array1::from_shape_fn(2, |i| 1.0 + ((i * 7919) % 1013) as f64 / 1013.0);
        let along = &start / start.dot(&start).sqrt();
        let (c, s) = (1e-2f64.cos(), 1e-2f64.sin());
        let small = ndarray::array![c * along[0] - s * along[1], s * along[0] + c * along[1]];
        let large = ndarray::array![-small[1], small[0]];
        let outer = |v: &Array1<f64>| Array2::from_shape_fn((2, 2), |(i, j)| v[i] * v[j]);
        let matrix = outer(&small) + outer(&large) * 1.02;
        let found = largest_eigenvalue(matrix.view());
        assert!((1.02 * 0.999..=1.02 + 1e-12).contains(&found), "{found}");
    }
}
