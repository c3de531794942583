//! What every other crate of edof agrees on. Data and checks, no algorithms; it knows no other crate of ours.
//!
//! | what | module |
//! |---|---|
//! | colour filter array, its four phases | [`cfa`] |
//! | raw frames, colour frames, 4:2:2 frames, mirrored borders | [`frame`] |
//! | windows, strides, where patches lie | [`geometry`] |
//! | BT.709 Y′CbCr and the 4:2:2 sites of a patch | [`colour`] |
//! | how the board's words become 8-bit Y′CbCr codes | [`display`] |
//! | the averaging window of overlapping patches | [`overlap`] |
//! | lens, mask and sensor, and their files | [`camera`] |
//! | PSFs of one's own in place of a lens's | [`psf_bank`] |
//! | A mask by the height of its surface | [`height_map`] |
//! | arrays in files of other programs | [`arrays`] |
//! | light and its sRGB encoding | [`tone`] |
//! | a sensor's noise | [`noise`] |
//! | fixed-point words and their rounding | [`number`] |
//! | the float network | [`network`] |
//! | the integer network, its shifts and thresholds | [`fixed_network`] |
//! | the file both kinds of network live in | [`weight_file`] |
//! | video timing | [`video`] |
//! | the hardware for a form of network: stages, memories, cycles | [`design`] |
//! | the board's numbers: memory, clocks, host | [`board`] |
//! | how full its FIFOs get | [`fifos`] |
//! | what the host sees of the board | [`registers`] |
//! | how the video chips are set up | [`i2c`] |
//! | how a result came to be | [`provenance`], by content [`digest`] |
//! | what every reconstruction method implements | [`reconstructor`] |
//! | the generator of everything drawn for trials | [`draw`] |
//! | files that appear whole or not at all | [`atomic`] |
//!
//! ```
//! use edof_spec::geometry::{Geometry, Stride, Window};
//! let g = Geometry::new(Window::new(12)?, Stride::new(8)?);
//! assert_eq!(g.patches(1080, 1920), (135, 240));
//! # Ok::<(), edof_spec::geometry::GeometryError>(())
//! ```

pub mod arrays;
pub mod atomic;
pub mod board;
pub mod camera;
pub mod cfa;
pub mod colour;
pub mod design;
pub mod digest;
pub mod display;
pub mod draw;
pub mod fifos;
pub mod fixed_network;
pub mod frame;
pub mod geometry;
pub mod height_map;
pub mod i2c;
pub mod network;
pub mod noise;
pub mod number;
pub mod overlap;
pub mod provenance;
pub mod psf_bank;
pub mod reconstructor;
pub mod registers;
pub mod tone;
pub mod video;
pub mod weight_file;

pub use camera::Camera;
pub use cfa::{CfaPhase, Channel};
pub use design::Design;
pub use display::DisplayMode;
pub use fixed_network::FixedNetwork;
pub use frame::{ColourFrame, Frame422, RawFrame};
pub use geometry::{Geometry, Stride, Window};
pub use network::Network;
pub use noise::Noise;
pub use reconstructor::{ReconstructError, Reconstruction, Reconstructor};
pub use tone::Tone;
