//! Frames that can be compared: equally large, and large enough.

use edof_core::ColourFrame;

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
) -> Result<(ColourFrame, ColourFrame), MetricError> {
    check(truth.size(), estimate.size(), border, least)?;
    let (height, width) = truth.size();
    let inside = |frame: &ColourFrame| frame.crop(border, border, height - 2 * border, width - 2 * border);
    Ok((inside(truth), inside(estimate)))
}
