//! Fourier transforms of `f32` and `f64`, compiled once.
//!
//! `rustfft` is generic: every crate, test program and build that plans a transform compiles all of its algorithms for all
//! instruction sets again, for minutes. Here they are compiled; all others call through `dyn Fft`.
//!
//! ```
//! use edof_numerics::fft::{Complex, Real};
//!
//! let mut samples = [1.0, 0.0, 0.0, 0.0].map(|re| Complex::new(re, 0.0_f64));
//! f64::forward(4).process(&mut samples);
//! assert!(samples.iter().all(|s| *s == Complex::new(1.0, 0.0)));
//! ```

pub use rustfft::Fft;
pub use rustfft::num_complex::{Complex, Complex64};
use rustfft::{FftNum, FftPlanner};
use std::sync::Arc;

/// Whether no prime but 2, 3 and 5 divides `n`: transforms of that length are fast.
#[must_use]
pub fn is_smooth(n: usize) -> bool {
    n == 1 || [2, 3, 5].into_iter().any(|p| n.is_multiple_of(p) && is_smooth(n / p))
}

/// A number that transforms are planned for.
pub trait Real: FftNum {
    /// The forward transform of `n` samples, not normalized: X\[k\] = Σ x\[i\]·exp(−2πi·ik/n).
    fn forward(n: usize) -> Arc<dyn Fft<Self>>;
    /// The way back, not normalized either: after both every sample is n times what it was.
    fn inverse(n: usize) -> Arc<dyn Fft<Self>>;
}

impl Real for f32 {
    fn forward(n: usize) -> Arc<dyn Fft<Self>> {
        FftPlanner::new().plan_fft_forward(n)
    }

    fn inverse(n: usize) -> Arc<dyn Fft<Self>> {
        FftPlanner::new().plan_fft_inverse(n)
    }
}

impl Real for f64 {
    fn forward(n: usize) -> Arc<dyn Fft<Self>> {
        FftPlanner::new().plan_fft_forward(n)
    }

    fn inverse(n: usize) -> Arc<dyn Fft<Self>> {
        FftPlanner::new().plan_fft_inverse(n)
    }
}
