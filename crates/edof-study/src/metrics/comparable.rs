//! Frames that can be compared: equally large, and large enough.

use edof_core::colour::LUMA;
use edof_core::{ColourFrame, Tone};
use ndarray::{Array2, ArrayView2, Axis, Zip};

/// A picture beside the ground truth, equally large, their borders cropped.
#[derive(Debug)]
pub struct Pair {
    /// Ground truth.
    pub truth: ColourFrame,
    /// Picture that is judged.
    pub estimate: ColourFrame,
    /// Encoding of both. Metrics that need light decode by it.
    pub tone: Tone,
}

impl Pair {
    /// Returns one colour plane of both frames, the ground truth first.
    #[must_use]
    pub fn planes(&self, colour: usize) -> [ArrayView2<'_, f32>; 2] {
        [&self.truth, &self.estimate].map(|frame| frame.planes.index_axis(Axis(0), colour))
    }

    /// Returns the luma of both frames, the ground truth first.
    #[must_use]
    pub fn luma(&self) -> [Array2<f32>; 2] {
        [&self.truth, &self.estimate].map(luma)
    }
}

/// Returns the BT.709 luma of a frame's values.
#[must_use]
pub fn luma(frame: &ColourFrame) -> Array2<f32> {
    let plane = |p| frame.planes.index_axis(Axis(0), p);
    Zip::from(plane(0)).and(plane(1)).and(plane(2)).map_collect(|&r, &g, &b| {
        let sum: f64 = LUMA.iter().zip([r, g, b]).map(|(w, v)| w * f64::from(v)).sum();
        sum as f32
    })
}

/// Returns the displayed picture of a frame of linear light: sRGB's encoding, clamped to the 0…1 of its codes. Under the
/// paper's convention light and picture are the same numbers, and stay as they are.
#[must_use]
pub fn shown(light: &ColourFrame, tone: Tone) -> ColourFrame {
    match tone {
        Tone::Linear => light.clone(),
        Tone::Srgb => ColourFrame { planes: light.planes.mapv(|v| tone.encode(v.clamp(0.0, 1.0))) },
    }
}

/// Frames that cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum MetricError {
    /// Different sizes.
    #[error("frames of {}x{} and {}x{} pixels: must be equally large", .0.1, .0.0, .1.1, .1.0)]
    Sizes((usize, usize), (usize, usize)),
    /// Nothing (or less than SSIM's window) is left inside the border.
    #[error(
        "frame of {width}x{height} pixels: must be at least {min}x{min} to crop {border} pixels and compare"
    )]
    Small { height: usize, width: usize, min: usize, border: usize },
}

/// Checks sizes (height, width): equal, and with `least` pixels a side at least inside a border.
pub(crate) fn check(
    truth: (usize, usize),
    estimate: (usize, usize),
    border: usize,
    least: usize,
) -> Result<(), MetricError> {
    if truth != estimate {
        return Err(MetricError::Sizes(truth, estimate));
    }
    let ((height, width), min) = (truth, border.saturating_mul(2).saturating_add(least));
    if height < min || width < min {
        return Err(MetricError::Small { height, width, min, border });
    }
    Ok(())
}

/// Two frames without their border, if [`check`] accepts them.
pub(crate) fn compared(
    truth: &ColourFrame,
    estimate: &ColourFrame,
    border: usize,
    least: usize,
    tone: Tone,
) -> Result<Pair, MetricError> {
    check(truth.size(), estimate.size(), border, least)?;
    let (height, width) = truth.size();
    let inside = |frame: &ColourFrame| frame.crop(border, border, height - 2 * border, width - 2 * border);
    Ok(Pair { truth: inside(truth), estimate: inside(estimate), tone })
}
