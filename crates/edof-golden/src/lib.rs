//! The bit-exact fixed-point pipeline: raw frame in, the board's picture out. All integers; every word at every stage
//! boundary is the one that the hardware produces.
//!
//! | step | module | gives |
//! |---|---|---|
//! | windows | [`windows`] | input words of the mirrored window around each patch |
//! | network | [`scalar`] | the specification: one window through I, M…, F, with every boundary in a [`Trace`] |
//! | | [`fast`] | the same words and counts from SIMD kernels, batch by batch |
//! | counters | [`trace`] | saturations and non-zeros of each stage |
//! | overlap | [`overlap_add`] | the sum of overlapping patches, rounded to the 4:2:2 frame |
//! | frame | [`frame`] | a whole frame on all threads ([`Golden`]), and its slow twin |
//! | cycles | [`cycle`] | the same words with the cycle of every transfer on the board |
//! | gamma | [`gamma`] | 8-bit luma through a loadable table: the picture on the wire |
//! | study | [`reconstructor`] | [`GoldenReconstructor`], the method that experiments compare |
//! | trials | [`sample`] | drawn networks and windows for tests, examples and benchmarks |
//!
//! ```
//! use edof_golden::{Gamma, Golden, display};
//! use edof_spec::{CfaPhase, RawFrame};
//! # let network = edof_golden::sample::natural(8, 8, 7);
//! // `network` came out of edof_spec::weight_file::load_fixed.
//! let raw = RawFrame::from_values(ndarray::Array2::from_elem((32, 48), 700), 12, CfaPhase::Rggb)?;
//! let out = Golden::new(network)?.frame(&raw)?;
//! assert_eq!(out.counts.patches, 4 * 6);
//! let picture = display(&out.frame, &Gamma::srgb());
//! assert_eq!(picture.luma.dim(), (32, 48));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cycle;
pub mod fast;
pub mod frame;
pub mod gamma;
pub mod overlap_add;
pub mod reconstructor;
pub mod sample;
pub mod scalar;

pub mod trace;
pub mod windows;

pub use frame::{Golden, GoldenFrame};
pub use gamma::{Gamma, Picture, display};
pub use reconstructor::GoldenReconstructor;
pub use trace::{Codes, Counts, StageCounts, Trace};
