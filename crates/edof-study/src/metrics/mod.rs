//! What a reconstruction is worth, and what it costs.
//!
//! | what | module |
//! |---|---|
//! | all metrics of a picture, with the conventions of every number of this project | [`quality`] |
//! | the list of metrics, and what a metric is | [`registry`], [`metric`] |
//! | frames that can be compared | [`comparable`] |
//! | PSNR alone | [`psnr`](mod@psnr) |
//! | SSIM alone | [`ssim`](mod@ssim) |
//! | SSIM over several scales | `ms_ssim` |
//! | differences of colour as people see them | `ciede2000` |
//! | MTF and MTF50 of a slanted edge | [`mtf50`] |
//! | differences of two methods with their standard errors | [`paired`] |
//! | numbers of rows that JSON has no form for: infinite PSNR | [`number`] |
//! | least, median and most of a method's runs | [`timing`] |
//! | CPU time of the process, independent of other work on the machine | [`cpu_time`] |
//! | memory that the process holds, and the most that a run held | [`memory`] |
//!
//! ```
//! use edof_core::{ColourFrame, Tone};
//! use edof_study::metrics::Quality;
//!
//! let truth = ColourFrame::zeros(32, 32);
//! let mut estimate = truth.clone();
//! estimate.planes += 0.01;
//! let quality = Quality::of(&truth, &estimate, 2, Tone::Linear)?;
//! assert!((quality.psnr_db() - 40.0).abs() < 1e-4);
//! # Ok::<(), edof_study::metrics::MetricError>(())
//! ```

mod ciede2000;
pub mod comparable;
pub mod cpu_time;
pub mod memory;
pub mod metric;
mod ms_ssim;
pub mod mtf50;
pub mod number;
pub mod paired;
pub mod psnr;
pub mod quality;
pub mod registry;
pub mod ssim;
pub mod timing;

pub use comparable::{MetricError, luma, shown};
pub use metric::{Better, Metric, Score};
pub use psnr::{decibel, mean_square, psnr};
pub use quality::{BORDER, Quality};
pub use registry::METRICS;
pub use ssim::ssim;
