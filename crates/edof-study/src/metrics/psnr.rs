//! Peak signal-to-noise ratio.

use crate::metrics::comparable::{MetricError, Pair, compared};
use crate::metrics::metric::{Better, Metric, Place, Score};
use edof_core::{ColourFrame, Tone};
use ndarray::ArrayView2;

/// PSNR over all three colours.
pub(super) const ALL: Metric = Metric {
    name: "psnr_db",
    title: "PSNR",
    unit: "dB",
    better: Better::Higher,
    min_side: 1,
    decimals: 2,
    place: Place::Rows,
    measure: |pair| Score::One(over_colours(pair)),
};
/// PSNR after the estimate was clipped to 0…1, as any display does.
pub(super) const CLIPPED: Metric = Metric {
    name: "psnr_clipped_db",
    title: "PSNR, clipped",
    measure: |pair| Score::One(decibel(mean([0, 1, 2].map(|p| clipped_error(pair, p))))),
    ..ALL
};
/// PSNR of red, green and blue.
pub(super) const CHANNELS: Metric = Metric {
    name: "channel_psnr_db",
    title: "PSNR of red, green, blue",
    measure: |pair| Score::Colours([0, 1, 2].map(|p| decibel(error(pair, p)))),
    ..ALL
};
/// PSNR of BT.709 luma.
pub(super) const LUMA: Metric = Metric {
    name: "luma_psnr_db",
    title: "PSNR of luma",
    measure: |pair| {
        let [truth, estimate] = pair.luma();
        Score::One(decibel(mean_square(truth.view(), estimate.view())))
    },
    ..ALL
};

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
    Ok(over_colours(&compared(truth, estimate, border, 1, Tone::light())?))
}

fn over_colours(pair: &Pair) -> f64 {
    decibel(mean([0, 1, 2].map(|p| error(pair, p))))
}

fn error(pair: &Pair, colour: usize) -> f64 {
    let [truth, estimate] = pair.planes(colour);
    mean_square(truth, estimate)
}

fn clipped_error(pair: &Pair, colour: usize) -> f64 {
    let [truth, estimate] = pair.planes(colour);
    mean_square(truth, estimate.mapv(|v| v.clamp(0.0, 1.0)).view())
}

fn mean(errors: [f64; 3]) -> f64 {
    errors.iter().sum::<f64>() / 3.0
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
