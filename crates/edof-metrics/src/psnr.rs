//! Peak signal-to-noise ratio.

use edof_image::ColourFrame;
use ndarray::{ArrayView2, Axis};

/// PSNR in dB for a peak of 1: −10 log₁₀ of the mean squared error over all colours and pixels inside the border.
/// Infinite for equal frames.
///
/// ```
/// use edof_image::ColourFrame;
/// let black = ColourFrame::zeros(20, 20);
/// let mut grey = black.clone();
/// grey.planes.fill(0.1);
/// assert!((edof_metrics::psnr(&black, &grey, 8) - 20.0).abs() < 1e-5);
/// ```
///
/// # Panics
/// If the frames' sizes differ or the border leaves nothing; [`Quality::of`](crate::Quality::of) rejects such frames instead.
#[must_use]
pub fn psnr(truth: &ColourFrame, estimate: &ColourFrame, border: usize) -> f64 {
    let (truth, estimate) = (cropped(truth, border), cropped(estimate, border));
    let error = |p| mean_square(truth.planes.index_axis(Axis(0), p), estimate.planes.index_axis(Axis(0), p));
    decibel((error(0) + error(1) + error(2)) / 3.0)
}

/// −10 log₁₀ of a mean squared error.
#[must_use]
pub fn decibel(mean_square: f64) -> f64 {
    -10.0 * mean_square.log10()
}

/// Mean squared difference of two planes.
#[must_use]
pub fn mean_square(a: ArrayView2<'_, f32>, b: ArrayView2<'_, f32>) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    sum / a.len() as f64
}

/// Without a border.
pub(crate) fn cropped(frame: &ColourFrame, border: usize) -> ColourFrame {
    let (height, width) = frame.size();
    frame.crop(border, border, height - 2 * border, width - 2 * border)
}
