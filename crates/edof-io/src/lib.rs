//! Photographs and raw Bayer frames in files.
//!
//! | what | module |
//! |---|---|
//! | photographs: PNG, JPEG, WebP, TIFF, BMP, PPM, 8 or 16 bits, one or a folder of them | [`photo`] |
//! | the test or training photographs of a folder | [`photos`] |
//! | raw frames: PNG, TIFF, PGM, and headerless files | [`raw`], whose pixels may be packed [`packing`]; names of cameras for them [`pixel_format`] |
//! | what a raw frame knows of itself: phase, sensor, camera, depth | [`record`] |
//! | what its values are of light: black and white level | [`levels`] |
//! | from its colours to those of a screen: white balance, colour matrix | [`rendering`] |
//! | whether it was read as it was taken | [`read_warnings`] |
//! | DNG: a camera's raw frame as light, with its colours, and what is to be done with its picture | [`dng`] |
//! | the sensor as it is: offsets, shading and defects, measured and corrected | [`sensor`] |
//! | other cameras' raw files, with the feature `camera-raw` | [`camera_raw`] |
//! | how a camera was held | [`orientation`] |
//! | picture files, before either meaning is given to them | [`picture`], its pixels [`samples`] |
//! | what a picture file states of its transfer curve | [`transfer`] |
//! | PGM and PPM with any maximum value | [`pnm`] |
//! | streams of pictures in Y′CbCr | [`y4m`] |
//!
//! Everything is written through [`edof_core::storage::atomic`]: a file appears whole or not at all.
//!
//! ```
//! use edof_io::{photo, raw};
//! use edof_core::{CfaPhase, ColourFrame, RawFrame};
//! let folder = tempfile::tempdir()?;
//! let at = |name| folder.path().join(name);
//!
//! photo::save(&at("grey.png"), &ColourFrame::zeros(4, 6), 16)?;
//! assert_eq!(photo::load(&at("grey.png"))?.size(), (4, 6));
//!
//! let frame = RawFrame::from_values(ndarray::Array2::from_elem((4, 6), 1000), 12, CfaPhase::Rggb)?;
//! raw::save(&at("frame.pgm"), &frame)?;
//! assert_eq!(raw::load(&at("frame.pgm"), &raw::RawOptions::default())?, frame);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod camera_raw;
pub mod dng;
pub mod gamut;
pub mod levels;
pub mod orientation;
pub mod packing;
pub mod photo;
pub mod photos;
pub mod picture;
pub mod pixel_format;
mod png_chunks;
pub mod pnm;
mod profile;
pub mod raw;
pub mod read_warnings;
pub mod record;
pub mod rendering;
pub mod samples;
pub mod sensor;
mod tiff;
pub mod transfer;
pub mod y4m;
