//! Structural similarity.

use crate::metrics::comparable::{MetricError, check};
use crate::metrics::metric::{Better, Metric, Place, Score};
use ndarray::{Array2, ArrayView2, s};

/// SSIM, mean of the three colours.
pub(super) const ALL: Metric = Metric {
    name: "ssim",
    title: "SSIM",
    unit: "",
    better: Better::Higher,
    min_side: SIDE,
    decimals: 3,
    place: Place::Tables,
    measure: |pair| {
        let of = |colour: usize| {
            let [truth, estimate] = pair.planes(colour);
            mean_ssim(truth, estimate)
        };
        Score::One((of(0) + of(1) + of(2)) / 3.0)
    },
};
/// SSIM of BT.709 luma.
pub(super) const LUMA: Metric = Metric {
    name: "luma_ssim",
    title: "SSIM of luma",
    place: Place::Rows,
    measure: |pair| {
        let [truth, estimate] = pair.luma();
        Score::One(mean_ssim(truth.view(), estimate.view()))
    },
    ..ALL
};

/// Standard deviation of the Gaussian window, in pixels.
const SIGMA: f64 = 1.5;
/// Half of the window without its centre: 11×11 pixels in all.
const REACH: usize = 5;
/// Side of the window in pixels.
pub(crate) const SIDE: usize = 2 * REACH + 1;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Mean structural similarity of two planes with range 1 (Wang, Bovik, Sheikh, Simoncelli 2004): Gaussian window of 11×11
/// pixels with σ = 1.5, K₁ = 0.01, K₂ = 0.03, population moments, averaged where the window fits whole; no downsampling.
///
/// # Errors
/// [`MetricError`] for planes of different sizes, or smaller than the window.
pub fn ssim(a: ArrayView2<'_, f32>, b: ArrayView2<'_, f32>) -> Result<f64, MetricError> {
    check(a.dim(), b.dim(), 0, SIDE)?;
    Ok(mean_ssim(a, b))
}

/// Measures SSIM of planes that were checked.
fn mean_ssim(a: ArrayView2<'_, f32>, b: ArrayView2<'_, f32>) -> f64 {
    terms(&a.mapv(f64::from), &b.mapv(f64::from)).ssim
}

/// Means over all windows of two planes.
pub(super) struct Terms {
    /// Luminance, contrast and structure together: SSIM.
    pub ssim: f64,
    /// Contrast and structure alone.
    pub contrast_structure: f64,
}

/// Measures two planes of one size that hold a window.
pub(super) fn terms(a: &Array2<f64>, b: &Array2<f64>) -> Terms {
    let mean_a = gaussian_mean(a);
    let mean_b = gaussian_mean(b);
    let square_a = gaussian_mean(&(a * a));
    let square_b = gaussian_mean(&(b * b));
    let product = gaussian_mean(&(a * b));
    let (mut ssim, mut contrast_structure) = (0.0, 0.0);
    ndarray::Zip::from(&mean_a).and(&mean_b).and(&square_a).and(&square_b).and(&product).for_each(
        |&ma, &mb, &saa, &sbb, &sab| {
            let (variance_a, variance_b, covariance) = (saa - ma * ma, sbb - mb * mb, sab - ma * mb);
            let (above, below) = (2.0 * covariance + C2, variance_a + variance_b + C2);
            ssim += (2.0 * ma * mb + C1) * above / ((ma * ma + mb * mb + C1) * below);
            contrast_structure += above / below;
        },
    );
    let count = mean_a.len() as f64;
    Terms { ssim: ssim / count, contrast_structure: contrast_structure / count }
}

/// Weighted mean under SSIM's window, wherever it fits whole.
fn gaussian_mean(plane: &Array2<f64>) -> Array2<f64> {
    let taps = gaussian_taps();
    let (height, width) = plane.dim();
    let (out_height, out_width) = (height - 2 * REACH, width - 2 * REACH);
    let mut along_rows = Array2::zeros((height, out_width));
    for (offset, &tap) in taps.iter().enumerate() {
        along_rows.scaled_add(tap, &plane.slice(s![.., offset..offset + out_width]));
    }
    let mut out = Array2::zeros((out_height, out_width));
    for (offset, &tap) in taps.iter().enumerate() {
        out.scaled_add(tap, &along_rows.slice(s![offset..offset + out_height, ..]));
    }
    out
}

fn gaussian_taps() -> [f64; SIDE] {
    let taps: [f64; SIDE] = std::array::from_fn(|i| {
        let distance = i as f64 - REACH as f64;
        (-0.5 * (distance / SIGMA).powi(2)).exp()
    });
    let sum: f64 = taps.iter().sum();
    taps.map(|t| t / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ssim_of_two_even_greys_is_its_luminance_term() {
        let plane = |level: f32| Array2::from_elem((20, 20), level);
        let (a, b) = (f64::from(0.25f32), 0.75);
        let expected = (2.0 * a * b + C1) / (a * a + b * b + C1);
        assert!((ssim(plane(0.25).view(), plane(0.75).view()).unwrap() - expected).abs() < 1e-9);
    }

    #[test]
    fn ssim_of_one_window_follows_the_formula() {
        // One 11×11 window, moments taken directly under the two-dimensional Gaussian.
        let a = Array2::from_shape_fn((11, 11), |(r, c)| ((r * 13 + c * 7) % 11) as f32 / 11.0);
        let b = Array2::from_shape_fn((11, 11), |(r, c)| ((r * 5 + c * 3) % 11) as f32 / 11.0);
        let weight = |r: usize, c: usize| {
            let (y, x) = (r as f64 - 5.0, c as f64 - 5.0);
            (-(x * x + y * y) / (2.0 * 1.5 * 1.5)).exp()
        };
        let total: f64 = (0..121).map(|i| weight(i / 11, i % 11)).sum();
        let mean = |f: &dyn Fn(usize, usize) -> f64| {
            (0..121).map(|i| weight(i / 11, i % 11) * f(i / 11, i % 11)).sum::<f64>() / total
        };
        let at = |m: &Array2<f32>, r, c| f64::from(m[(r, c)]);
        let (ma, mb) = (mean(&|r, c| at(&a, r, c)), mean(&|r, c| at(&b, r, c)));
        let va = mean(&|r, c| (at(&a, r, c) - ma).powi(2));
        let vb = mean(&|r, c| (at(&b, r, c) - mb).powi(2));
        let cov = mean(&|r, c| (at(&a, r, c) - ma) * (at(&b, r, c) - mb));
        let expected =
            (2.0 * ma * mb + 1e-4) * (2.0 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
        assert!((ssim(a.view(), b.view()).unwrap() - expected).abs() < 1e-9);
    }
}
