//! The mean of frames, and how much a pixel differs from frame to frame.

use super::MeasureError;
use crate::raw::Size;
use edof_core::{CfaPhase, RawFrame};
use ndarray::{Array2, Zip};

/// Sums of frames of one sensor.
#[derive(Debug, Clone)]
pub struct Frames {
    size: Size,
    phase: CfaPhase,
    depth: u32,
    pub(super) count: u32,
    sums: Array2<u64>,
    squares: Array2<u64>,
}

impl Frames {
    /// Begins with a frame.
    #[must_use]
    pub fn new(frame: &RawFrame) -> Self {
        let sums = frame.pixels().mapv(|word| u64::from(word >> (16 - frame.depth())));
        let squares = sums.mapv(|value| value * value);
        Self { size: Size::of(frame), phase: frame.phase(), depth: frame.depth(), count: 1, sums, squares }
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`MeasureError::OtherFrame`] for a frame of another size, phase or depth.
    pub fn add(&mut self, frame: &RawFrame) -> Result<(), MeasureError> {
        let found = (Size::of(frame), frame.phase(), frame.depth());
        self.check(found)?;
        self.count += 1;
        Zip::from(&mut self.sums).and(&mut self.squares).and(frame.pixels()).for_each(|sum, square, word| {
            let value = u64::from(word >> (16 - self.depth));
            *sum += value;
            *square += value * value;
        });
        Ok(())
    }

    /// Returns size, phase and bits of the frames.
    #[must_use]
    pub const fn sensor(&self) -> (Size, CfaPhase, u32) {
        (self.size, self.phase, self.depth)
    }

    /// Rejects what is of another size, phase or depth.
    pub(super) fn check(&self, found: (Size, CfaPhase, u32)) -> Result<(), MeasureError> {
        let expected = self.sensor();
        if found == expected { Ok(()) } else { Err(MeasureError::OtherFrame { found, expected }) }
    }

    /// Returns the mean sensor value of each pixel.
    pub(super) fn mean(&self) -> Array2<f32> {
        let count = f64::from(self.count);
        self.sums.mapv(|sum| (sum as f64 / count) as f32)
    }

    /// Returns the variance between frames, in sensor values, of the pixels that `counts` accepts; none for a single frame.
    pub(super) fn variance(&self, counts: impl Fn((usize, usize)) -> bool) -> Option<f64> {
        if self.count < 2 {
            return None;
        }
        let count = f64::from(self.count);
        let (mut pixels, mut sum) = (0u32, 0.0);
        Zip::indexed(&self.sums).and(&self.squares).for_each(|at, total, squares| {
            if counts(at) {
                pixels += 1;
                sum += (*squares as f64 - (*total as f64).powi(2) / count) / (count - 1.0);
            }
        });
        (pixels > 0).then(|| sum / f64::from(pixels))
    }
}
