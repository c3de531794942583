//! Number formats of the board's words, in floating point.

use crate::float::real::Real;

/// A number format: multiples of `step` from −(`max` + 1)·`step` to `max`·`step`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Format {
    /// The smallest difference.
    pub step: f32,
    /// The largest word.
    pub max: f32,
}

impl Format {
    /// Rounds nothing.
    pub const EXACT: Self = Self { step: 0.0, max: 1.0 };

    /// Words of `bits` bits, `fraction` of them fraction bits.
    #[must_use]
    pub fn new(bits: u32, fraction: u32) -> Self {
        Self { step: (-(fraction as f32)).exp2(), max: ((1u32 << (bits - 1)) - 1) as f32 }
    }

    /// The nearest word, ties toward +∞, as the board rounds.
    #[must_use]
    pub fn round<T: Real>(self, value: T) -> T {
        let (step, max) = (T::of(self.step.into()), T::of(self.max.into()));
        (value / step + T::of(0.5)).floor().max(-max - T::one()).min(max) * step
    }

    /// Rounds all values.
    pub fn round_all<T: Real>(self, values: &mut [T]) {
        if self != Self::EXACT {
            values.iter_mut().for_each(|v| *v = self.round(*v));
        }
    }

    /// Sets to zero what would pass back through a rounded value at the end of its range: no gradient does.
    pub fn stop_clipped<T: Real>(self, gradient: &mut [T], rounded: &[T]) {
        if self == Self::EXACT {
            return;
        }
        let end = T::of((self.max * self.step).into());
        let clipped = gradient.iter_mut().zip(rounded).filter(|(_, value)| !(-end..end).contains(*value));
        clipped.for_each(|(g, _)| *g = T::zero());
    }
}
