//! What all crates share: frames and what their samples mean, cameras as data, files of results. Data and checks, no algorithms. It is the lowest
//! crate, which depends on no other crate of edof.
//!
//! | what | module |
//! |---|---|
//! | colour filter array, its four phases | [`cfa`] |
//! | raw frames, colour frames, 4:2:2 frames, mirrored borders | [`frame`] |
//! | windows, strides, positions of patches | [`geometry`] |
//! | averaging window of overlapping patches | [`overlap`] |
//! | raw pixel words on a video cable | [`cable`] |
//! | linear light and its sRGB encoding | [`tone`] |
//! | noise of a sensor | [`noise`] |
//! | fixed-point words and their rounding | [`number`] |
//! | BT.709 Y′CbCr and the 4:2:2 sites of a patch | [`colour`] |
//! | conversion of the board's words to 8-bit Y′CbCr codes | [`display`] |
//! | interface of every reconstruction method | [`reconstructor`] |
//! | random numbers for trials | [`draw`] |
//! | numbers and counts in errors | [`words`] |
//! | letters of 5×7 dots, for charts and captions | [`font`] |
//! | lens, mask and sensor as data; PSF banks, height maps | [`camera`] |
//! | result files: atomic, with digests and provenance | [`storage`] |
//!
//! ```
//! use edof_core::geometry::{Geometry, Stride, Window};
//! let g = Geometry::new(Window::new(12)?, Stride::new(8)?);
//! assert_eq!(g.patches(1080, 1920), (135, 240));
//! # Ok::<(), edof_core::geometry::GeometryError>(())
//! ```
//!
//! # Stability
//!
//! Stable: number formats, phases, window and patch positions (docs/contract.md). Signatures may change between minor versions until 1.0.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod cable;
pub mod camera;
pub mod cfa;
pub mod colour;
pub mod display;
pub mod draw;
pub mod font;
pub mod frame;
pub mod geometry;
pub mod noise;
pub mod number;
pub mod overlap;
pub mod reconstructor;
pub mod storage;
pub mod tone;
pub mod words;

pub use camera::Camera;
pub use cfa::{CfaPhase, Channel};
pub use display::DisplayMode;
pub use frame::{ColourFrame, Frame422, RawFrame};
pub use geometry::{Geometry, Stride, Window};
pub use noise::Noise;
pub use reconstructor::{ReconstructError, Reconstruction, Reconstructor};
pub use tone::Tone;
