//! The little dense linear algebra that optics, sparse coding, training and quantization share, in f64: Cholesky factors, normal
//! equations, the largest eigenvalue.
//!
//! Everything runs on the calling thread in one order, so results do not depend on how many threads there are. Matrices have some
//! hundred rows; a library for larger ones costs more to build than this ever takes to run (`docs/decisions/0001-workspace.md`).
//!
//! ```
//! use edof_numerics::Cholesky;
//! use ndarray::array;
//! let factor = Cholesky::new(array![[4.0, 2.0], [2.0, 10.0]].view())?;
//! assert_eq!(factor.lower(), array![[2.0, 0.0], [1.0, 3.0]]);
//! # Ok::<(), edof_numerics::NotPositive>(())
//! ```

mod cholesky;
mod least_squares;

pub use cholesky::{Cholesky, NotPositive};
pub use least_squares::least_squares;

use ndarray::{Array1, ArrayView2};

/// Steps of the power iteration: enough for a per cent unless the two largest eigenvalues are closer than that.
const STEPS: usize = 200;

/// The largest eigenvalue of a symmetric matrix without negative ones, from below, by power iteration; NaN if the matrix is not
/// finite.
#[must_use]
pub fn largest_eigenvalue(symmetric: ArrayView2<'_, f64>) -> f64 {
    // Numbers that no symmetry of the matrix has.
    let mut vector = Array1::from_shape_fn(symmetric.nrows(), |i| 1.0 + ((i * 7919) % 1013) as f64 / 1013.0);
    let mut value = 0.0;
    for _ in 0..STEPS {
        vector /= vector.dot(&vector).sqrt().max(f64::MIN_POSITIVE);
        let next = symmetric.dot(&vector);
        value = vector.dot(&next);
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
        fn the_largest_of_known_eigenvalues_is_found(
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
            let largest = values.iter().copied().fold(0.0, f64::max);
            let found = largest_eigenvalue((&q * &Array1::from(values)).dot(&q.t()).view());
            prop_assert!(found <= largest + 1e-9 && found >= 0.98 * largest - 1e-9, "{found} for {largest}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_no_largest_eigenvalue() {
        assert!(largest_eigenvalue(Array2::from_elem((3, 3), f64::NAN).view()).is_nan());
    }
}
