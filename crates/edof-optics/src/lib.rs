//! From a scene to the raw frame that a sensor behind a coded lens would give.
//!
//! | step | module | gives |
//! |---|---|---|
//! | lens | [`pupil`] | complex pupil for a mask, a defocus ψ, a wavelength |
//! | blur | [`psf`] | the PSF on the sensor's grid, and what cutting it cost |
//! | | [`bank`] | PSFs of the user in place of the computed ones |
//! | | [`blur`](mod@blur) | pictures blurred with it, and the adjoint |
//! | | `tiles`, `composite` | large ones tile by tile, and layers of them over each other |
//! | | [`cosine`] | the transform of even planes that both stand on |
//! | | [`gradient`] | derivatives of PSFs by radii, phases and focus |
//! | | [`depth`] | ψ for a distance and back |
//! | | [`mtf`] | contrast over spatial frequency and through focus |
//! | scene | [`draw`] | charts and leaves rendered by code |
//! | | [`scene`] | layers of colour and depth, blurred and composed with occlusion |
//! | | [`scene_file`] | the files that list such layers |
//! | | [`depth_map`] | maps of distances, their holes filled |
//! | | [`layers`] | a photograph with a depth map as such a scene |
//! | sensor | [`sensor`] | Bayer mosaic, noise, saturation, bit depth |
//! | all of it | [`capture`](mod@capture) | a scene captured, what each approximation costs and saves |
//!
//! Designing a mask for it:
//!
//! | step | module | gives |
//! |---|---|---|
//! | world | [`statistics`] | how photographs vary, measured or as a model |
//! | judge | [`estimator`] | what a linear estimator reaches behind a camera, in closed form |
//! | search | [`design`] | mask and focus by differential evolution |
//! | limit | [`bound`] | what no lens passes, and the lens that a scene needs |
//!
//! ```
//! use edof_optics::capture::{Approximation, capture};
//! use edof_optics::draw::{Builtin, draw};
//! use edof_optics::sensor::Sensor;
//!
//! let camera = edof_core::camera::Camera::resolve("ring-outer")?;
//! let scene = draw(Builtin::Chart, 64, 96, &[4.0], 1)?;
//! let shot = capture(&scene, &camera, &Sensor::default(), &Approximation::default())?;
//! assert_eq!((shot.raw.size(), shot.raw.depth()), ((64, 96), 12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Stability
//!
//! Stable: what a camera file means, and the words that a seed gives. Signatures may change between minor versions until 1.0; `examples/lens_to_raw.rs` is kept compiling.

pub mod bank;
pub mod blur;
pub mod bound;
pub mod capture;
mod composite;
pub mod cosine;
pub mod depth;
pub mod depth_map;
pub mod design;
#[cfg(test)]
mod direct;
pub mod draw;
pub mod estimator;
pub mod gradient;
pub mod layers;
pub mod mtf;
pub mod psf;
pub mod pupil;
pub mod scene;
pub mod scene_file;
pub mod sensor;
pub mod statistics;
mod tiles;
