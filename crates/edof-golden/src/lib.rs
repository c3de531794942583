//! The bit-exact fixed-point pipeline: raw frame in, the board's picture out. All integers; every word at every stage
//! boundary is the one that the hardware produces.
//!
//! | step | module | gives |
//! |---|---|---|
//! | windows | [`windows`] | input words of the mirrored window around each patch |
//! | network | [`scalar`] | the specification: one window through I, M…, F, with every boundary in a [`Trace`] |
//! | | [`fast`] | the same words and counts from SIMD kernels, batch by batch |
//! | counters | [`trace`] | saturations and non-zeros of each stage |
//! | overlap | [`overlap_add`] | the sum of overlapping patches: the 4:2:2 frame in words |
//! | frame | [`frame`] | a whole frame on all threads ([`Golden`]), and its slow reference |
//! | frames | [`stream`] | one after the other, in memory that is kept ([`Stream`]) |
//! | words | [`words`] | every boundary of a whole frame, for anybody who wants to check |
//! | cycles | [`cycle`] | the same words with the cycle of every transfer on the board |
//! | checks | [`checks`] | the CRCs that a board makes of every frame at its boundaries ([`FrameChecks`]) |
//! | tables | [`gamma`] | light to codes: loadable tables for luma and for each colour |
//! | display | [`display`] | the 8-bit Y′CbCr 4:2:2 codes on the wire, and what a sink shows of them |
//! | pins | [`video`] | the buses of the board's receiver and transmitter, cycle by cycle |
//! | study | [`reconstructor`] | [`GoldenReconstructor`], the method that experiments compare |
//!
//! ```
//! use edof_golden::{Display, Golden};
//! use edof_core::{CfaPhase, RawFrame};
//! # let network = edof_device::random::natural(8, 8, 7);
//! // `network` came out of edof_network::weight_file::load_fixed.
//! let raw = RawFrame::from_values(ndarray::Array2::from_elem((32, 48), 700), 12, CfaPhase::Rggb)?;
//! let out = Golden::new(network)?.frame(&raw)?;
//! assert_eq!(out.counts.patches, 4 * 6);
//! let (picture, counts) = out.picture(&Display::default());
//! assert_eq!(picture.yuyv().len(), 2 * 32 * 48);
//! assert_eq!(counts.out_of_gamut, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Stability
//!
//! Stable: every word and code (docs/contract.md) and the names of boundaries. Signatures may change between minor versions until 1.0; [`Golden`], [`Display`] and
//! `examples/raw_to_codes.rs` last, modules of the fast kernels do not.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod checks;
pub mod cycle;
pub mod display;
pub mod fast;
pub mod frame;
pub mod gamma;
pub mod overlap_add;
pub mod reconstructor;
pub mod scalar;
pub mod stream;
pub mod trace;
pub mod video;
pub mod windows;
pub mod words;

pub use checks::FrameChecks;
pub use display::{Display, DisplayCounts, Mix, Picture};
pub use frame::{Golden, GoldenFrame};
pub use gamma::{ColourTable, Curve, LumaTable};
pub use reconstructor::GoldenReconstructor;
pub use stream::Stream;
pub use trace::{Counts, LayerWords, StageCounts, Trace};
