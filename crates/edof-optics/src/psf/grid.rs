//! The grid on which a pupil is sampled, and the period of the field that belongs to it.

use edof_core::camera::Camera;
use edof_numerics::fft::is_smooth;

/// The pupil's samples, 1/`support` cycles per pixel apart.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Samples per radius of the aperture.
    pub radius: f64,
    /// Samples along a half axis, the one at zero among them; beyond them the pupil is 0.
    pub samples: usize,
    /// Points along a side of the field's period. With at least four times as many points as samples, no frequency of the field's
    /// squared magnitude coincides with another one.
    pub period: usize,
}

impl Grid {
    pub fn new(camera: &Camera, wavelength_nm: f64, support: usize) -> Self {
        let radius = support as f64 * camera.pixel_pitch_um / (2.0 * camera.wave_um(wavelength_nm));
        let samples = radius.ceil() as usize + 1;
        Self { radius, samples, period: fast(4 * samples) }
    }

    /// Frequencies from zero up to those at which the field's squared magnitude is 0.
    pub const fn band(self) -> usize {
        2 * self.samples
    }

    /// Radius of sample (r, c), and whether the pupil may differ from 0 there. The samples at the rim are means over one spacing.
    pub fn at(self, r: f64, c: f64) -> (f64, bool) {
        let distance = r.hypot(c);
        (distance / self.radius, distance <= self.radius + 0.5)
    }
}

/// The smallest length from `least` on that is a multiple of 16 and has no prime factor above 5: a half of it has fast transforms, too.
fn fast(least: usize) -> usize {
    let mut length = least.max(1).next_multiple_of(16);
    while !is_smooth(length) {
        length += 16;
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_are_fast_and_long_enough() {
        assert_eq!([1, 32, 33, 1653, 1929].map(fast), [16, 32, 48, 1728, 2000]);
        assert!((1..3000).all(|n| fast(n) >= n && is_smooth(fast(n) / 2)));
    }
}
