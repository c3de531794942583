//! The float network: forward, gradient, training.
//!
//! | step | module | gives |
//! |---|---|---|
//! | photos | [`dataset`] | blurred photographs in several looks ([`augment`]), and random windows with their sharp patches |
//! | | [`noise`] | light and noise of each window, from [`random`] numbers |
//! | | [`holdout`] | the part of each photograph that training keeps away from |
//! | start | [`initial`] | a first network: random analysis, or ISTA's matrices from a dictionary |
//! | coordinates | [`precondition`] | whitened windows, so that training is well conditioned |
//! | batch | [`pass`] | forward and the hand-written gradient, on [`matmul`], [`parameters`], [`encoding`] and, where words are to be rounded, [`mod@format`]; in either precision ([`real`]) |
//! | weights | [`weighting`], [`budget`] | what a window's error counts, and what a non-zero costs |
//! | step | [`adam`] | new weights |
//! | run | [`recipe`], [`train`] | schedule, [`validation`], checkpoints ([`checkpoint`]), resume |
//! | use | [`reconstruct`] | a whole frame through the float network |
//!
//! ```
//! use edof_train::pass::Pass;
//! # use edof_spec::{Window, network::{Form, Shrinkage, Recurrence}};
//! let form = Form {
//!     window: Window::new(8)?, codes: 16, layers: 4, shrinkage: Shrinkage::TwoSided,
//!     recurrence: Recurrence::Direct, linear_path: false, tied: false,
//! };
//! let weights = vec![0.01; edof_train::parameters::Layout::new(&form).len()];
//! let mut pass = Pass::new(form, 2);
//! let outputs = pass.forward(&weights, &[0.5; 2 * 64], 2);
//! assert_eq!(outputs.len(), 2 * 192);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod adam;
pub mod augment;
pub mod budget;
pub mod checkpoint;
pub mod dataset;
pub mod encoding;
pub mod format;
pub mod holdout;
pub mod initial;
pub mod matmul;
pub mod noise;
pub mod parameters;
pub mod pass;
pub mod precondition;
pub mod random;
pub mod real;
pub mod recipe;
pub mod reconstruct;
pub mod train;
pub mod validation;
pub mod weighting;
