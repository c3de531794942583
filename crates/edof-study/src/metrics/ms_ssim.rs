//! Multi-scale structural similarity.

use crate::metrics::comparable::Pair;
use crate::metrics::metric::{Better, Metric, Place, Score};
use crate::metrics::ssim;
use ndarray::Array2;

/// Exponents of the scales, finest first (Wang, Simoncelli, Bovik 2003, section 3.2).
const WEIGHTS: [f64; 5] = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333];

/// MS-SSIM, mean of the three colours: contrast and structure at every scale, luminance at the coarsest, with SSIM's window.
pub(super) const ALL: Metric = Metric {
    name: "ms_ssim",
    title: "MS-SSIM",
    unit: "",
    better: Better::Higher,
    // The coarsest scale holds a window, as in the authors' program.
    min_side: ssim::ALL.min_side << (WEIGHTS.len() - 1),
    decimals: 4,
    place: Place::Further,
    measure: |pair| Score::One((of(pair, 0) + of(pair, 1) + of(pair, 2)) / 3.0),
};

fn of(pair: &Pair, colour: usize) -> f64 {
    let [mut a, mut b] = pair.planes(colour).map(|plane| plane.mapv(f64::from));
    let mut product = 1.0;
    for (scale, weight) in WEIGHTS.iter().enumerate() {
        let is_coarsest = scale + 1 == WEIGHTS.len();
        let terms = ssim::terms(&a, &b);
        // Structure may be opposite, and a negative number has no such power: it counts as none.
        let term: f64 = if is_coarsest { terms.ssim } else { terms.contrast_structure };
        product *= term.max(0.0).powf(*weight);
        if !is_coarsest {
            [a, b] = [halved(&a), halved(&b)];
        }
    }
    product
}

/// Means of 2×2 pixels; the last row and column of an odd side are repeated.
fn halved(plane: &Array2<f64>) -> Array2<f64> {
    let (height, width) = plane.dim();
    Array2::from_shape_fn((height.div_ceil(2), width.div_ceil(2)), |(row, column)| {
        let (rows, columns) =
            ([2 * row, (2 * row + 1).min(height - 1)], [2 * column, (2 * column + 1).min(width - 1)]);
        rows.iter().flat_map(|&r| columns.map(|c| plane[(r, c)])).sum::<f64>() / 4.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::{ColourFrame, Tone};

    fn measured(estimate: impl Fn(f32, usize, usize) -> f32) -> f64 {
        let mut truth = ColourFrame::zeros(177, 190);
        truth.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
            *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos();
        });
        let mut other = truth.clone();
        other.planes.indexed_iter_mut().for_each(|((_, r, c), v)| *v = estimate(*v, r, c));
        (ALL.measure)(&Pair { truth, estimate: other, tone: Tone::Linear }).one().unwrap()
    }

    #[test]
    fn equal_pictures_have_one_and_opposite_ones_nothing() {
        assert!((measured(|v, _, _| v) - 1.0).abs() < 1e-12);
        assert_eq!(measured(|v, _, _| 1.0 - v), 0.0);
    }

    #[test]
    fn an_error_of_the_finest_scale_costs_less_than_the_same_error_over_eight_pixels() {
        let checker = |side: usize| {
            measured(move |v, r, c| v + if (r / side + c / side).is_multiple_of(2) { 0.1 } else { -0.1 })
        };
        assert!(checker(1) > checker(8) + 0.05, "{} {}", checker(1), checker(8));
    }

    #[test]
    fn halving_repeats_the_last_row_and_column_of_an_odd_side() {
        let plane = ndarray::arr2(&[[1.0, 3.0, 5.0], [5.0, 7.0, 9.0], [2.0, 4.0, 6.0]]);
        assert_eq!(halved(&plane), ndarray::arr2(&[[4.0, 7.0], [3.0, 6.0]]));
    }
}
