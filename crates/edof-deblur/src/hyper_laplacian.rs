//! Deconvolution with a known kernel under the prior that differences of neighbours are few and large: D. Krishnan, R. Fergus, "Fast
//! image deconvolution using hyper-Laplacian priors", NIPS 2009.
//!
//! min over x of λ/2·‖k∗x − y‖² + Σ|∇x|^α. A second picture w of differences is split off: with β/2·‖∇x − w‖² between them x has a
//! closed form in frequencies, and w one number at a time; β grows until they agree.

use crate::border::Continued;
use crate::fourier::{Fourier, Sample, correlation};
use crate::known::{differences, gradient_power};
use ndarray::{Array2, ArrayView2, Zip};

/// The first β, by what it grows, and its last value (section 2.1).
const FIRST_BETA: f32 = 1.0;
const GROWTH: f32 = 2.828_427;
const LAST_BETA: f32 = 256.0;
/// Differences up to this are looked up; of a picture of 0…1 there are none beyond 1, and few beyond after deconvolution.
const LARGEST: f32 = 2.0;
const ENTRIES: usize = 8192;

/// Weights of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// λ: how much the picture counts.
    pub lambda: f32,
    /// α of the prior, above 0 and at most 1: 1 is total variation, photographs have 0.5 to 0.8.
    pub alpha: f32,
}

/// Those of blind deconvolution's last step (Krishnan, Tay, Fergus 2011, section 3.3).
impl Default for Prior {
    fn default() -> Self {
        Self { lambda: 3000.0, alpha: 0.8 }
    }
}

/// Deconvolves a plane of 0…1 with a known kernel.
#[must_use]
pub fn hyper_laplacian(plane: ArrayView2<'_, f32>, kernel: ArrayView2<'_, f32>, prior: Prior) -> Array2<f32> {
    let continued = Continued::new(plane, kernel);
    let plan = Fourier::new(continued.plane.dim());
    let transfer = plan.kernel(kernel);
    let gradient = gradient_power(&plan);
    let [along_rows, along_columns] = differences(&plan);
    let data = correlation(&plan.forward_real(continued.plane.view()), &transfer);
    let mut picture = plan.forward_real(continued.plane.view());
    let mut beta = FIRST_BETA;
    while beta < LAST_BETA {
        let table = Table::new(beta, prior.alpha);
        // Differences are real: those along rows ride as real parts, those along columns as imaginary ones.
        let i = Sample::new(0.0, 1.0);
        let both =
            Zip::from(&picture).and(&along_rows).and(&along_columns).map_collect(|x, r, c| x * (r + i * c));
        let few = plan.inverse(&both).mapv(|v| Sample::new(table.nearest(v.re), table.nearest(v.im)));
        let weight = prior.lambda / beta;
        // ∇ᵀw of both directions from one transform: with F = F₁ + iF₂ of real w₁ and w₂, and each half found by symmetry.
        let [rows, columns] = halves(&plan.forward(&few));
        let spread = &correlation(&rows, &along_rows) + &correlation(&columns, &along_columns);
        Zip::from(&mut picture).and(&spread).and(&data).and(&transfer).and(&gradient).for_each(
            |x, w, y, k, &g| {
                *x = (w + y * weight) / (g + weight * k.norm_sqr()).max(f32::MIN_POSITIVE);
            },
        );
        beta *= GROWTH;
    }
    continued.cut(&plan.inverse_real(&picture))
}

/// Transforms of the real and of the imaginary part of a plane, from the transform of the whole.
fn halves(whole: &Array2<Sample>) -> [Array2<Sample>; 2] {
    let (rows, columns) = whole.dim();
    let mirrored = |r: usize, c: usize| whole[((rows - r) % rows, (columns - c) % columns)].conj();
    let real = Array2::from_shape_fn((rows, columns), |(r, c)| (whole[(r, c)] + mirrored(r, c)) * 0.5);
    let half_turn = Sample::new(0.0, -0.5);
    let imaginary =
        Array2::from_shape_fn((rows, columns), |(r, c)| (whole[(r, c)] - mirrored(r, c)) * half_turn);
    [real, imaginary]
}

/// w of least |w|^α + β/2·(w − v)² for each v, looked up.
struct Table(Vec<f32>);

impl Table {
    fn new(beta: f32, alpha: f32) -> Self {
        let at = |i: usize| f64::from(LARGEST) * i as f64 / (ENTRIES - 1) as f64;
        Self((0..ENTRIES).map(|i| minimiser(at(i), f64::from(beta), f64::from(alpha)) as f32).collect())
    }

    fn nearest(&self, v: f32) -> f32 {
        let size = v.abs().min(LARGEST);
        let place = size / LARGEST * (ENTRIES - 1) as f32;
        let low = (place as usize).min(ENTRIES - 2);
        let (a, b) = (self.0[low], self.0[low + 1]);
        // Between an entry of 0 and its neighbour lies a jump, not a slope.
        let value = if a == 0.0 {
            if place - low as f32 > 0.5 { b } else { a }
        } else {
            a + (place - low as f32) * (b - a)
        };
        (value + (v.abs() - size)).copysign(v)
    }
}

/// For v ≥ 0: the cost rises from w = 0, and may fall again to a second minimum below v, which Newton's steps from v find.
fn minimiser(v: f64, beta: f64, alpha: f64) -> f64 {
    let mut w = v;
    for _ in 0..40 {
        if w <= 0.0 {
            return 0.0;
        }
        let slope = alpha * w.powf(alpha - 1.0) + beta * (w - v);
        let bend = alpha * (alpha - 1.0) * w.powf(alpha - 2.0) + beta;
        if bend <= 0.0 {
            return 0.0;
        }
        w -= slope / bend;
    }
    let cost = |w: f64| w.powf(alpha) + 0.5 * beta * (w - v).powi(2);
    if w > 0.0 && cost(w) < 0.5 * beta * v * v { w } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::known::wiener;
    use crate::test_pictures::{blurred, cards, db, disc, with_noise};

    #[test]
    fn the_table_holds_the_least_cost_there_is() {
        for (beta, alpha) in [(1.0, 0.8), (8.0, 0.5), (90.0, 2.0 / 3.0), (30.0, 1.0)] {
            for v in [0.0, 0.01, 0.2, 0.7, 1.6] {
                let cost = |w: f64| w.abs().powf(alpha) + 0.5 * beta * (w - v).powi(2);
                let searched =
                    (0..=20_000).map(|i| cost(v * f64::from(i) / 20_000.0)).fold(f64::INFINITY, f64::min);
                let found = minimiser(v, beta, alpha);
                assert!(cost(found) <= searched + 1e-6, "v {v}, beta {beta}, alpha {alpha}: {found}");
                let looked_up = f64::from(Table::new(beta as f32, alpha as f32).nearest(-v as f32));
                assert!(
                    cost(-looked_up) <= searched + 2e-3,
                    "v {v}, beta {beta}, alpha {alpha}: {looked_up}"
                );
            }
        }
    }

    #[test]
    fn a_picture_of_few_edges_gains_more_than_by_a_linear_filter() {
        let (sharp, kernel) = (cards(), disc(2.5));
        let seen = with_noise(&blurred(&sharp, &kernel), 0.01);
        let linear = [1e-3, 3e-3, 1e-2, 3e-2].map(|mu| db(&sharp, &wiener(seen.view(), kernel.view(), mu)));
        let linear = linear.into_iter().fold(0.0, f64::max);
        let sparse = hyper_laplacian(seen.view(), kernel.view(), Prior { lambda: 2000.0, alpha: 0.8 });
        let sparse = db(&sharp, &sparse);
        assert!(sparse > db(&sharp, &seen) + 4.0 && sparse > linear + 0.5, "{sparse}, linear {linear}");
    }

    #[test]
    fn a_sharp_picture_stays_one() {
        let sharp = cards();
        let out = hyper_laplacian(sharp.view(), ndarray::array![[1.0]].view(), Prior::default());
        assert!(db(&sharp, &out) > 40.0, "{}", db(&sharp, &out));
    }
}
