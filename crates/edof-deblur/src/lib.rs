//! What people use instead of the network. A raw frame goes in, a colour frame comes out.
//!
//! | method | module | what it does about blur |
//! |---|---|---|
//! | Malvar–He–Cutler demosaicing | [`malvar`] | nothing: the frame as a plain camera would show it |
//!
//! ```
//! use edof_deblur::Malvar;
//! use edof_spec::{CfaPhase, RawFrame, Reconstructor};
//! use ndarray::Array2;
//!
//! let grey = RawFrame::from_values(Array2::from_elem((8, 8), 0x8000), 16, CfaPhase::Grbg)?;
//! let picture = Malvar::default().reconstruct(&grey)?;
//! assert!(picture.frame.planes.iter().all(|&v| v == 0.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod malvar;

pub use malvar::Malvar;
