//! Under which light and noise training windows are seen.
//!
//! A window has one of two kinds of noise, by its tone: the paper's (Gaussian, σ uniform up to the largest) on codes taken as light,
//! a sensor's (photons and read-out, at a gain uniform in stops) on light. Photons are counted as a normal number of their
//! variance, which from a dozen on is what Poisson gives.

use edof_image::{Noise, Tone};
use edof_numerics::random::Random;
use serde::{Deserialize, Serialize};

/// Noise levels are divided into N classes; class 0 is no noise at all.
pub const NOISE_CLASSES: usize = 5;

/// Random values of each window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Largest σ of the Gaussian noise of linear windows, in units of full scale.
    pub noise: f32,
    /// Largest gain of the sensor behind sRGB windows, 1 or more.
    pub gain: f32,
    /// One window in N has no noise at all.
    pub noiseless: usize,
    /// Factor on all light of a window, least and most; what it lifts above full scale is clipped, as a sensor clips it.
    pub exposure: [f32; 2],
}

impl Conditions {
    /// Windows as the photographs are, one in eight without noise.
    #[must_use]
    pub const fn plain(noise: f32) -> Self {
        Self { noise, gain: 16.0, noiseless: 8, exposure: [1.0; 2] }
    }

    /// Noise at a `share` (0…1) of the range of gains.
    #[must_use]
    pub fn at(&self, tone: Tone, share: f32) -> Noise {
        match tone {
            Tone::Linear => Noise::gaussian((share * self.noise).into()),
            Tone::Srgb => Noise::sensor(from_stops(share * stops(self.gain)).into()),
        }
    }

    /// The share of [`Conditions::at`] at which networks are judged: σ = 0.01 of 0.015, and half the stops of gain.
    #[must_use]
    pub const fn judged(tone: Tone) -> f32 {
        match tone {
            Tone::Linear => 2.0 / 3.0,
            Tone::Srgb => 0.5,
        }
    }

    /// Class of the noise at a share.
    #[must_use]
    pub const fn class(share: f32) -> usize {
        let class = 1 + (share * (NOISE_CLASSES - 1) as f32) as usize;
        if class < NOISE_CLASSES { class } else { NOISE_CLASSES - 1 }
    }

    /// Noise of one window, and its class.
    pub(crate) fn draw(&self, random: &mut Random, tone: Tone) -> (usize, Noise) {
        let silent = tone == Tone::Linear && self.noise == 0.0;
        if silent || random.below(self.noiseless) == 0 {
            return (0, Noise::None);
        }
        let share = random.unit();
        (Self::class(share), self.at(tone, share))
    }
}

/// Stops of a gain, straight between powers of two; exact at these, and needing no logarithm.
fn stops(gain: f32) -> f32 {
    let whole = (0..64u8).take_while(|n| power_of_two(*n + 1) <= gain).count() as u8;
    f32::from(whole) + gain / power_of_two(whole) - 1.0
}

/// Inverse of [`stops`].
fn from_stops(stops: f32) -> f32 {
    let whole = stops as u8;
    power_of_two(whole) * (1.0 + stops - f32::from(whole))
}

fn power_of_two(exponent: u8) -> f32 {
    f32::from_bits((127 + u32::from(exponent)) << 23)
}

/// Adds noise to the light of a window and clips it to what a sensor gives, 0…1.
pub(crate) fn expose(noise: Noise, random: &mut Random, light: &mut [f32]) {
    // Variance is a straight line over light.
    let dark = noise.variance(0.0) as f32;
    let photons = (noise.variance(1.0) - noise.variance(0.0)) as f32;
    match noise {
        Noise::None => light.iter_mut().for_each(|v| *v = v.clamp(0.0, 1.0)),
        Noise::Gaussian { .. } => {
            let sigma = dark.sqrt();
            random.normals(light, |v, normal| *v = (*v + sigma * normal).clamp(0.0, 1.0));
        }
        Noise::Sensor(_) => random.normals(light, |v, normal| {
            *v = (*v + (dark + photons * *v).sqrt() * normal).clamp(0.0, 1.0);
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn stops_and_gain_invert_and_are_those_of_powers_of_two(gain in 1.0f32..1000.0, power in 0u8..9) {
            prop_assert!((from_stops(stops(gain)) / gain - 1.0).abs() < 1e-5);
            prop_assert!((stops(gain) - gain.log2()).abs() < 0.09);
            prop_assert_eq!(stops(power_of_two(power)), f32::from(power));
        }
    }

    #[test]
    fn exposed_light_has_the_variance_that_its_noise_states() {
        let conditions = Conditions::plain(0.015);
        for tone in Tone::ALL {
            for level in [0.2f32, 0.6] {
                let noise = conditions.at(tone, 0.9);
                let mut light = vec![level; 400_000];
                expose(noise, &mut Random::new(1, 0, 0), &mut light);
                let mean = light.iter().map(|v| f64::from(v - level)).sum::<f64>() / light.len() as f64;
                let square =
                    light.iter().map(|v| f64::from(v - level).powi(2)).sum::<f64>() / light.len() as f64;
                let expected = noise.variance(level.into());
                assert!(mean.abs() < 0.01 * expected.sqrt() && (square / expected - 1.0).abs() < 0.01);
            }
        }
    }

    #[test]
    fn noise_is_random_over_its_whole_range_and_now_and_then_not_at_all() {
        let conditions = Conditions::plain(0.015);
        for tone in Tone::ALL {
            let mut random = Random::new(1, 2, 3);
            let drawn: Vec<_> = (0..8000).map(|_| conditions.draw(&mut random, tone)).collect();
            let share = |class| drawn.iter().filter(|d| d.0 == class).count() as f64 / 8000.0;
            assert!((share(0) - 0.125).abs() < 0.02);
            (1..NOISE_CLASSES).for_each(|class| assert!((share(class) - 0.875 / 4.0).abs() < 0.02));
            let strongest = drawn.iter().map(|d| d.1.variance(0.5)).fold(0.0, f64::max);
            assert!((strongest / conditions.at(tone, 1.0).variance(0.5) - 1.0).abs() < 0.02);
            assert_eq!(Conditions::class(Conditions::judged(tone)), 3);
        }
    }
}
