//! Sparse codes of signals in a dictionary.

use edof_numerics::largest_eigenvalue;
use ndarray::{Array2, ArrayView1, ArrayView2, Zip};

/// How much larger than the largest eigenvalue of DᵀD the bound L is taken, so that f32 sums cannot make a step too long.
const MARGIN: f64 = 1.01;

/// An upper bound L on the eigenvalues of a symmetric matrix, with a margin for rounding: 1/L is a step that cannot diverge.
#[must_use]
pub fn step_bound(gram: ArrayView2<'_, f32>) -> f32 {
    (largest_eigenvalue(gram.mapv(f64::from).view()) * MARGIN) as f32
}

/// Iterative shrinkage-thresholding (ISTA; Daubechies, Defrise, De Mol 2004): for each row x of `signals` the z that minimises
/// ½‖x − D·z‖² + Σ_i μ_i·|z_i|, after `steps` steps from 0. `penalties` holds μ, one an atom; an atom of penalty 0 is free.
#[must_use]
pub fn ista(
    signals: ArrayView2<'_, f32>,
    dictionary: ArrayView2<'_, f32>,
    penalties: ArrayView1<'_, f32>,
    steps: usize,
) -> Array2<f32> {
    let gram = dictionary.t().dot(&dictionary);
    let correlations = signals.dot(&dictionary);
    let step = 1.0 / step_bound(gram.view());
    let thresholds = penalties.mapv(|mu| step * mu);
    let mut z = Array2::zeros(correlations.dim());
    for _ in 0..steps {
        let toward = z.dot(&gram);
        Zip::from(&mut z)
            .and(&toward)
            .and(&correlations)
            .and_broadcast(&thresholds)
            .for_each(|z, &g, &b, &theta| *z = shrink(*z + step * (b - g), theta));
    }
    z
}

fn shrink(value: f32, theta: f32) -> f32 {
    (value - theta).max(0.0) + (value + theta).min(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;
    use proptest::prelude::*;

    proptest! {
        /// Karush, Kuhn, Tucker: with r = Dᵀ(x − D·z), every r_i is within ±μ_i, and it is μ_i·sign(z_i) where z_i is not 0.
        #[test]
        fn codes_meet_the_conditions_of_the_minimum(
            atoms in prop::collection::vec(-1.0f32..1.0, 8 * 5),
            signals in prop::collection::vec(-1.0f32..1.0, 3 * 8),
            penalties in prop::collection::vec(0.05f32..0.5, 5),
        ) {
            let dictionary = Array2::from_shape_vec((8, 5), atoms).unwrap() + &Array2::from_shape_fn((8, 5), |(r, c)| if r == c { 1.0 } else { 0.0 });
            let signals = Array2::from_shape_vec((3, 8), signals).unwrap();
            let mut penalties = Array1::from(penalties);
            penalties[0] = 0.0;
            let z = ista(signals.view(), dictionary.view(), penalties.view(), 20_000);
            let rest = (&signals - &z.dot(&dictionary.t())).dot(&dictionary);
            for ((_, atom), (z, r)) in z.indexed_iter().map(|((row, atom), z)| ((row, atom), (*z, rest[(row, atom)]))) {
                let mu = penalties[atom];
                prop_assert!(r.abs() <= mu + 1e-3, "atom {atom}: {r} beyond {mu}");
                prop_assert!(z == 0.0 || (r - mu * z.signum()).abs() < 1e-3, "atom {atom}: z {z}, {r} for {mu}");
            }
        }
    }

    #[test]
    fn a_larger_penalty_leaves_fewer_codes() {
        let dictionary = Array2::from_shape_fn((6, 6), |(r, c)| if r == c { 1.0 } else { 0.1 });
        let signals = Array2::from_shape_fn((4, 6), |(r, c)| (r * 5 + c * 3) as f32 % 7.0 / 7.0);
        let used = |mu: f32| {
            let z = ista(signals.view(), dictionary.view(), Array1::from_elem(6, mu).view(), 500);
            z.iter().filter(|z| **z != 0.0).count()
        };
        assert!(used(0.3) < used(0.01));
    }
}
