//! Peak signal-to-noise ratio.

use crate::metrics::comparable::{MetricError, compared};
use edof_core::ColourFrame;
use ndarray::{ArrayView2, Axis};

/// PSNR in dB for a peak of 1: −10 log₁₀ of the mean squared error over all colours and pixels inside the border.
/// Infinite for equal frames.
///
/// ```
/// use edof_core::ColourFrame;
/// let black = ColourFrame::zeros(20, 20);
/// let mut grey = black.clone();
/// grey.planes.fill(0.1);
/// assert!((edof_study::metrics::psnr(&black, &grey, 8)? - 20.0).abs() < 1e-5);
/// # Ok::<(), edof_study::metrics::MetricError>(())
/// ```
///
/// # Errors
/// [`MetricError`] for frames of different sizes, or frames without pixels inside the border.
pub fn psnr(truth: &ColourFrame, estimate: &ColourFrame, border: usize) -> Result<f64, MetricError> {
    let (truth, estimate) = compared(truth, estimate, border, 1)?;
    let error = |p| mean_square(truth.planes.index_axis(Axis(0), p), estimate.planes.index_axis(Axis(0), p));
    Ok(decibel((error(0) + error(1) + error(2)) / 3.0))
}

/// −10 log₁₀ of a mean squared error.
#[must_use]
pub fn decibel(mean_square: f64) -> f64 {
    -10.0 * mean_square.log10()
}

/// Returns the mean squared difference of two planes of equal size.
///
/// # Panics
/// If the sizes differ: a mistake of the caller, never of its input. [`psnr`] checks its frames.
#[must_use]
pub fn mean_square(a: ArrayView2<'_, f32>, b: ArrayView2<'_, f32>) -> f64 {
    assert_eq!(a.dim(), b.dim(), "planes of different sizes");
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    sum / a.len() as f64
}
