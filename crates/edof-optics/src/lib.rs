//! From a scene to the raw frame that a sensor behind a coded lens would give.
//!
//! | step | where | gives |
//! |---|---|---|
//! | lens | [`Pupil`] | complex pupil for the terms of a camera, a defocus ψ, a wavelength |
//! | blur | [`psf`] | the PSF on the sensor's grid, and what cutting it cost |
//! | | [`bank`] | PSFs of the user in place of the computed ones |
//! | | [`blur()`], [`Blur`] | pictures blurred with it, and the adjoint |
//! | | `tiles`, `composite` | large ones tile by tile, and layers of them over each other |
//! | | [`cosine`] | the transform of even planes that both stand on |
//! | | [`gradient`] | derivatives of PSFs by the parameters of a mask and by focus |
//! | | [`psi_at`], [`distance_m`] | ψ for a distance and back |
//! | | [`otf`], [`through_focus`] | contrast over spatial frequency and through focus |
//! | scene | [`draw`] | charts and leaves rendered by code |
//! | | [`Scene`] | layers of colour and depth, blurred and composed with occlusion |
//! | | [`SceneFile`] | the files that list such layers |
//! | | [`depth_map`] | maps of distances, their holes filled |
//! | | [`layers`] | a photograph with a depth map as such a scene |
//! | sensor | [`Sensor`] | Bayer mosaic, noise, saturation, bit depth |
//! | all of it | [`capture`](mod@capture) | a scene captured, what each approximation costs and saves |
//!
//! Designing a mask for it:
//!
//! | step | where | gives |
//! |---|---|---|
//! | world | [`Statistics`] | how photographs vary, measured or as a model |
//! | judge | [`estimator`] | what a linear estimator reaches behind a camera, in closed form |
//! | search | [`design`] | mask and focus by differential evolution |
//! | limit | [`bound`] | what no lens passes, and the lens that a scene needs |
//!
//! ```
//! use edof_optics::capture::{Approximation, capture};
//! use edof_optics::draw::{Builtin, draw};
//! use edof_optics::Sensor;
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

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod bank;
mod blur;
pub mod bound;
pub mod capture;
mod composite;
pub mod cosine;
mod depth;
pub mod depth_map;
pub mod design;
#[cfg(test)]
mod direct;
pub mod draw;
pub mod estimator;
pub mod gradient;
pub mod layers;
mod mtf;
pub mod psf;
mod pupil;
mod scene;
mod scene_file;
mod sensor;
mod statistics;
mod tiles;

pub use blur::{Blur, Spectrum, blur, blur_adjoint, blur_frame};
pub use depth::{distance_m, geometric_blur_um, psi_at, psi_metres};
pub use mtf::{
    Footprint, Otf, cutoff_per_mm, green_cutoff_per_mm, has_one_response, otf, otfs, otfs_of_psf,
    sampled_otf, through_focus,
};
pub use pupil::Pupil;
pub use scene::{Layer, Scene, SceneError};
pub use scene_file::{LayerFile, SceneFile, SceneFileError, WrittenDepth};
pub use sensor::{Sensor, SensorError, expose, mosaic_with_noise};
pub use statistics::{Statistics, TooSmall};
