//! All metrics. A metric that is listed here is in rows, JSON, `edof compare`, tables, reports and Python.

use crate::metrics::metric::Metric;
use crate::metrics::{ciede2000, ms_ssim, psnr, ssim};

/// All metrics, in the order in which rows hold them.
pub const METRICS: &[Metric] = &[
    psnr::ALL,
    psnr::CLIPPED,
    psnr::CHANNELS,
    psnr::LUMA,
    ssim::ALL,
    ssim::LUMA,
    ms_ssim::ALL,
    ciede2000::ALL,
];

/// Place of a metric in [`METRICS`].
#[must_use]
pub fn place(name: &str) -> Option<usize> {
    METRICS.iter().position(|metric| metric.name == name)
}
