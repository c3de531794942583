//! The networks on any accelerator that speaks OpenCL. The library is looked for when a device is first asked for, so that the program is
//! built, and runs, without one.
//!
//! | what | module |
//! |---|---|
//! | devices: buffers, programs, launches | [`device`] |
//! | matrices in a device's memory, frames through them | `engine`, and its kernels `network.cl` |
//! | the fixed-point network, bit for bit that of [`edof_golden`] | [`fixed`] |
//! | the float network | [`float`] |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod device;
mod engine;
pub mod fixed;
pub mod float;

pub use device::{Device, GpuError};
pub use fixed::GpuGolden;
pub use float::GpuFloat;

use edof_core::ReconstructError;

impl GpuError {
    /// As an error of the method of this name.
    fn of(self, method: &str) -> ReconstructError {
        match self {
            Self::Geometry(error) => error.into(),
            error => ReconstructError::Method { method: method.to_owned(), reason: error.to_string() },
        }
    }
}
