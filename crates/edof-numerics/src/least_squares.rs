//! The linear map that best explains samples.

use crate::Cholesky;
use ndarray::{Array2, ArrayView2, Axis};

/// Samples that are taken to f64 at once.
const CHUNK: usize = 1024;

/// The `outputs`×`inputs` matrix M that minimises Σ‖x − M·y‖² + ridge·‖M‖² over samples: rows of `y` (inputs) and `x`
/// (outputs). The ridge is a share of the mean square of an input.
///
/// # Panics
/// If the samples are not finite: a mistake of the caller.
#[must_use]
pub fn least_squares(y: ArrayView2<'_, f32>, x: ArrayView2<'_, f32>, ridge: f64) -> Array2<f32> {
    let inputs = y.ncols();
    let mut gram = Array2::<f64>::zeros((inputs, inputs));
    let mut cross = Array2::<f64>::zeros((inputs, x.ncols()));
    for (y, x) in y.axis_chunks_iter(Axis(0), CHUNK).zip(x.axis_chunks_iter(Axis(0), CHUNK)) {
        let (y, x) = (y.mapv(f64::from), x.mapv(f64::from));
        gram += &y.t().dot(&y);
        cross += &y.t().dot(&x);
    }
    let lift = ridge * gram.diag().mean().unwrap_or(0.0) + f64::MIN_POSITIVE;
    gram.diag_mut().mapv_inplace(|v| v + lift);
    Cholesky::of_moments(gram.view()).solve(cross.view()).t().mapv(|v| v as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_map_that_made_the_samples_is_found(
            y in prop::collection::vec(-1.0f32..1.0, 3 * 40), map in prop::collection::vec(-1.0f32..1.0, 6)
        ) {
            let y = Array2::from_shape_vec((40, 3), y).unwrap();
            let map = Array2::from_shape_vec((2, 3), map).unwrap();
            let found = least_squares(y.view(), y.dot(&map.t()).view(), 1e-9);
            prop_assert!(found.iter().zip(&map).all(|(a, b)| (a - b).abs() < 1e-3));
        }
    }

    #[test]
    fn a_ridge_makes_maps_smaller() {
        let y = Array2::from_shape_fn((50, 2), |(r, c)| (r * 7 % 5 + c * r % 3) as f32);
        let x = y.mapv(|v| 2.0 * v);
        let size = |ridge| least_squares(y.view(), x.view(), ridge).mapv(|v| v * v).sum();
        assert!(size(0.1) < size(1e-6) - 0.01);
    }
}
