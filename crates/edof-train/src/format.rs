//! Number formats of the board's words, in floating point.

/// A number format: multiples of `step` from −(`most` + 1)·`step` to `most`·`step`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Format {
    /// The smallest difference.
    pub step: f32,
    /// The largest word.
    pub most: f32,
}

impl Format {
    /// Rounds nothing.
    pub const EXACT: Self = Self { step: 0.0, most: 1.0 };

    /// Words of `bits` bits, `fraction` of them fraction bits.
    #[must_use]
    pub fn new(bits: u32, fraction: u32) -> Self {
        Self { step: (-(fraction as f32)).exp2(), most: ((1u32 << (bits - 1)) - 1) as f32 }
    }

    /// The nearest word, ties toward +∞, as the board rounds.
    #[must_use]
    pub fn round(self, value: f32) -> f32 {
        (value / self.step + 0.5).floor().clamp(-self.most - 1.0, self.most) * self.step
    }

    /// Rounds all values.
    pub fn round_all(self, values: &mut [f32]) {
        if self != Self::EXACT {
            values.iter_mut().for_each(|v| *v = self.round(*v));
        }
    }

    /// Sets to zero what would pass back through a rounded value at the end of its range: no gradient does.
    pub fn stop_clipped(self, gradient: &mut [f32], rounded: &[f32]) {
        if self == Self::EXACT {
            return;
        }
        let within = -self.most * self.step..self.most * self.step;
        let clipped = gradient.iter_mut().zip(rounded).filter(|(_, value)| !within.contains(*value));
        clipped.for_each(|(g, _)| *g = 0.0);
    }
}
