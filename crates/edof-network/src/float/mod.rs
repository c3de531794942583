//! The float network: forward pass, hand-written gradient, whole frames. Training, quantization and studies call it; it contains neither optics nor a
//! training recipe.
//!
//! | what | module |
//! |---|---|
//! | a whole raw frame through the float network | [`reconstruct`] |
//! | forward pass and gradient of a batch of windows, in `f32` or `f64` ([`real`]) | [`pass`] |
//! | flat weight vector of an architecture | [`parameters`] |
//! | matrix products | [`matmul`] |
//! | rounding to fixed-point formats, for fine-tuning | [`mod@format`] |
//!
//! ```
//! use edof_network::float::pass::Pass;
//! # use edof_core::Window;
//! # use edof_network::network::{Form, Recurrence, Shrinkage};
//! let form = Form {
//!     window: Window::new(8)?, codes: 16, layers: 4, shrinkage: Shrinkage::TwoSided,
//!     recurrence: Recurrence::Direct, linear_path: false, tied: false, exposures: 1,
//! };
//! let weights = vec![0.01; edof_network::float::parameters::Layout::new(&form).len()];
//! let mut pass = Pass::new(form, 2);
//! let outputs = pass.forward(&weights, &[0.5; 2 * 64], 2);
//! assert_eq!(outputs.len(), 2 * 192);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod format;
pub mod matmul;
pub mod parameters;
pub mod pass;
pub mod real;
pub mod reconstruct;
