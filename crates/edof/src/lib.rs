//! The way in for programs that use `edof`: from a lens with a phase mask to a sharp picture, and to a board that computes it.
//!
//! | step | module |
//! |---|---|
//! | cameras, networks and designs by name | [`presets`] |
//! | what the commands of the program do, from files to files | [`job`] |
//! | frames, windows, tone; cameras as data; result files | [`core`] |
//! | lens and scene to raw frame | [`optics`] |
//! | files of photographs and of raw frames | [`io`] |
//! | float and integer networks | [`network`] |
//! | training and quantization | [`train`], [`quantize`] |
//! | raw frame to picture, in integers | [`golden`] |
//! | the hardware as data, circuits, the link to a board | [`device`], `hdl`, `board` (feature `hardware`, on by default) |
//!
//! From a lens to a raw frame, and from the raw frame to a picture:
//!
//! ```
//! use edof::core::{Noise, Tone};
//! use edof::golden::Golden;
//! use edof::optics::capture::{Approximation, capture};
//! use edof::optics::draw::{Builtin, draw, four_depths};
//! use edof::optics::Sensor;
//! use edof::presets::{lens, weights};
//!
//! let camera = lens::resolve("ring-outer", None)?.camera;
//! let scene = draw(Builtin::Chart, 96, 144, &four_depths(camera.psi_range), 0)?;
//! let sensor = Sensor { noise: Noise::sensor(1.0), ..Sensor::default() };
//! let shot = capture(&scene, &camera, &sensor, &Approximation::default())?;
//!
//! let network = weights::fixed(weights::default_for(Tone::Srgb))?;
//! let (_, picture) = Golden::new(network)?.frame_of_light(&shot.raw)?;
//! assert_eq!(picture.planes.dim(), scene.sharp().planes.dim());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! From a network to a board, here a simulated one: the example of [`board`]. From a design to Verilog: [`hdl::project`].
//!
//! # Stability
//!
//! Signatures may change between minor versions until 1.0.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod job;
pub mod presets;

#[cfg(feature = "hardware")]
pub use edof_board as board;
pub use edof_core as core;
pub use edof_deblur as deblur;
pub use edof_device as device;
pub use edof_golden as golden;
#[cfg(feature = "hardware")]
pub use edof_hdl as hdl;
pub use edof_io as io;
pub use edof_network as network;
pub use edof_optics as optics;
pub use edof_quantize as quantize;
pub use edof_train as train;
