//! Cameras as data: lens, mask and sensor, and the files that describe them. `edof-optics` computes with these descriptions; weight files name
//! the camera that a network was trained for, without any optics code.
//!
//! | what | module |
//! |---|---|
//! | lens, mask and sensor, presets and JSON files | [`camera`] |
//! | user-supplied PSFs in place of computed ones | [`psf_bank`] |
//! | a mask given by the height of its surface | [`height_map`] |
//!
//! ```
//! let camera = edof_camera::Camera::resolve("ring-2018")?;
//! assert_eq!(camera.name, "ring-2018");
//! # Ok::<(), edof_camera::camera::CameraError>(())
//! ```
//!
//! # Stability
//!
//! Stable: the fields of camera files and PSF banks; new ones are optional. Signatures may change between minor versions until 1.0.

pub mod camera;
pub mod height_map;
pub mod psf_bank;

pub use camera::Camera;
