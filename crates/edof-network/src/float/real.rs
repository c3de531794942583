//! The two precisions that a pass can run in: f32 to train with, f64 to check f32 against.

use num_traits::Float;
use std::fmt::Debug;
use std::ops::{AddAssign, MulAssign, SubAssign};

/// f32 or f64.
pub trait Real: Float + AddAssign + SubAssign + MulAssign + Debug + Send + Sync + 'static {
    /// The nearest number of this precision.
    fn of(value: f64) -> Self;

    /// The same number, or the nearest one, in double precision.
    fn wide(self) -> f64;
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn wide(self) -> f64 {
        self
    }
}
