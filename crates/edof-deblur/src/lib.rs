//! What people use instead of the network: from a raw frame to colours, and from a blurred plane to a sharp one.
//!
//! | step | module | what it knows of the blur |
//! |---|---|---|
//! | demosaic | [`malvar`] | nothing: the frame as a plain camera would show it, linear filters (Malvar, He, Cutler) |
//! | | [`directional`] | nothing: along edges instead of across them (Menon, Andriani, Calvagno) |
//! | deconvolve | [`known`] | the kernel: Wiener; Richardson and Lucy |
//! | | [`hyper_laplacian`](mod@hyper_laplacian) | the kernel, under a prior of few and large differences (Krishnan, Fergus) |
//! | | [`blind`] | nothing: kernel and picture together (Krishnan, Tay, Fergus) |
//!
//! Demosaicing is a [`Reconstructor`](edof_core::Reconstructor), by name a [`Demosaicing`]; deconvolution takes one colour plane of linear light (rows × columns)
//! and a kernel of odd sides and sum 1, and gives a plane of the same size. All run on the calling thread.
//!
//! ```
//! use edof_deblur::Malvar;
//! use edof_core::{CfaPhase, RawFrame, Reconstructor};
//! use ndarray::Array2;
//!
//! let grey = RawFrame::from_values(Array2::from_elem((8, 8), 0x8000), 16, CfaPhase::Grbg)?;
//! let picture = Malvar::default().reconstruct(&grey)?;
//! assert!(picture.frame.planes.iter().all(|&v| v == 0.5));
//! let sharp = edof_deblur::known::wiener(picture.frame.planes.index_axis(ndarray::Axis(0), 1), Array2::ones((1, 1)).view(), 0.01);
//! assert!(sharp.iter().all(|&v| (v - 0.5).abs() < 1e-5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod blind;
mod border;
mod demosaicing;
pub mod directional;
mod fourier;
pub mod hyper_laplacian;
pub mod known;
pub mod malvar;
mod resize;
#[cfg(test)]
mod test_pictures;

pub use demosaicing::{Demosaicing, UnknownDemosaicing};
pub use directional::Directional;
pub use malvar::Malvar;
