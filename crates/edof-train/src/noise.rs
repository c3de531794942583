//! Under which light and noise training windows are seen.
//!
//! A window has one of two kinds of noise, by its tone: the paper's (Gaussian, σ uniform up to the largest) on codes taken as light,
//! a sensor's (photons and read-out, at a gain uniform in stops) on light. Photons are counted as a normal number of their
//! variance, which from a dozen on is what Poisson gives.

use edof_core::{Noise, Tone};
use edof_numerics::random::Random;
use serde::{Deserialize, Serialize};

/// Noise levels are divided into N classes; class 0 is no noise at all.
pub const NOISE_CLASSES: usize = 5;

/// Random values of each window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Least and largest σ of the Gaussian noise of linear windows, in units of full scale.
    pub noise: [f32; 2],
    /// Least and largest gain of the sensor behind sRGB windows, 1 or more.
    pub gain: [f32; 2],
    /// One window in N has no noise at all, where the range begins with the least noise that there is.
    pub noiseless: usize,
    /// One window in N shows a single random colour: of photographs no window is saturated all over. 0 for none.
    #[serde(default)]
    pub flat: usize,
    /// Factor on all light of a window, least and most; what it lifts above full scale is clipped, as a sensor clips it.
    pub exposure: [f32; 2],
}

impl Conditions {
    /// Windows as the photographs are, one in eight without noise.
    #[must_use]
    pub const fn plain(noise: f32) -> Self {
        Self { noise: [0.0, noise], gain: [1.0, 16.0], noiseless: 8, flat: 0, exposure: [1.0; 2] }
    }

    /// Noise at a `share` (0…1) of the range of σ, or of the stops of gain.
    #[must_use]
    pub fn at(&self, tone: Tone, share: f32) -> Noise {
        let between = |[low, high]: [f32; 2]| low + share * (high - low);
        match tone {
            Tone::Linear => Noise::gaussian(between(self.noise).into()),
            Tone::Srgb => Noise::sensor(from_stops(between(self.gain.map(stops))).into()),
        }
    }

    /// The share of [`Conditions::at`] near which a batch's non-zeros are counted.
    #[must_use]
    pub const fn judged(tone: Tone) -> f32 {
        match tone {
            Tone::Linear => 2.0 / 3.0,
            Tone::Srgb => 0.5,
        }
    }

    /// Whether the range begins with the least noise that there is, so that windows without any belong to it.
    #[must_use]
    pub fn begins_with_none(&self, tone: Tone) -> bool {
        match tone {
            Tone::Linear => self.noise[0] == 0.0,
            Tone::Srgb => self.gain[0] == 1.0,
        }
    }

    /// The noise of the comparisons in docs/results that is within the range: none, σ 0.01 and 0.02 of linear windows; none, gain 1
    /// and gain 8 of a sensor. Networks are validated with it. Where the range holds no such noise, its middle.
    #[must_use]
    pub fn validated(&self, tone: Tone) -> Vec<Noise> {
        let none = self.begins_with_none(tone).then_some(Noise::None);
        let ([low, high], compared, noise): (_, _, fn(f32) -> Noise) = match tone {
            Tone::Linear => (self.noise, [0.01, 0.02], |sigma| Noise::gaussian(decimal(sigma))),
            Tone::Srgb => (self.gain, [1.0, 8.0], |gain| Noise::sensor(gain.into())),
        };
        let noisy: Vec<Noise> =
            compared.into_iter().filter(|level| (low..=high).contains(level)).map(noise).collect();
        let middle = (noisy.is_empty() && (high > low || none.is_none())).then(|| self.at(tone, 0.5));
        none.into_iter().chain(noisy).chain(middle).collect()
    }

    /// Class of the noise at a share.
    #[must_use]
    pub const fn class(share: f32) -> usize {
        let class = 1 + (share * (NOISE_CLASSES - 1) as f32) as usize;
        if class < NOISE_CLASSES { class } else { NOISE_CLASSES - 1 }
    }

    /// The light of a window of a single colour, where the window is one: a quarter of its channels are black, a quarter full.
    pub(crate) fn draw_colour(&self, random: &mut Random, tone: Tone) -> Option<[f32; 3]> {
        if self.flat == 0 || random.below(self.flat) != 0 {
            return None;
        }
        Some([(); 3].map(|()| tone.decode((2.0 * random.unit() - 0.5).clamp(0.0, 1.0))))
    }

    /// Noise of one window, and its class.
    pub(crate) fn draw(&self, random: &mut Random, tone: Tone) -> (usize, Noise) {
        let silent = tone == Tone::Linear && self.noise == [0.0; 2];
        if silent || (self.begins_with_none(tone) && random.below(self.noiseless) == 0) {
            return (0, Noise::None);
        }
        let share = random.unit();
        (Self::class(share), self.at(tone, share))
    }
}

/// The number that a σ in single precision is written as.
fn decimal(sigma: f32) -> f64 {
    (f64::from(sigma) * 1e6).round() / 1e6
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
        fn stops_and_gain_invert_and_are_those_of_powers_of_two(gain in 1.0f32..4096.0, power in 0u8..13) {
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

    #[test]
    fn a_range_that_begins_above_the_least_noise_has_no_window_without_noise() {
        let conditions = Conditions { noise: [0.01, 0.03], gain: [4.0, 16.0], ..Conditions::plain(0.0) };
        for (tone, least) in [(Tone::Linear, 0.01f64.powi(2)), (Tone::Srgb, Noise::sensor(4.0).variance(0.0))]
        {
            let mut random = Random::new(1, 2, 3);
            let drawn: Vec<_> = (0..1000).map(|_| conditions.draw(&mut random, tone)).collect();
            assert!(drawn.iter().all(|(class, noise)| *class > 0 && noise.variance(0.0) >= 0.999 * least));
        }
    }

    #[test]
    fn networks_are_validated_with_the_noise_of_the_comparisons_that_their_range_holds() {
        let of = |noise, gain| Conditions { noise, gain, ..Conditions::plain(0.0) };
        let linear = |low, high| of([low, high], [1.0; 2]).validated(Tone::Linear);
        let light = |low, high| of([0.0; 2], [low, high]).validated(Tone::Srgb);
        let sigma = Noise::gaussian;
        assert_eq!(linear(0.0, 0.03), [Noise::None, sigma(0.01), sigma(0.02)]);
        assert_eq!(linear(0.0, 0.015), [Noise::None, sigma(0.01)]);
        assert_eq!(linear(0.0, 0.004).len(), 2);
        assert_eq!(linear(0.0, 0.0), [Noise::None]);
        assert_eq!(linear(0.015, 0.03), [sigma(0.02)]);
        assert_eq!(linear(0.012, 0.014).len(), 1);
        assert_eq!(light(1.0, 16.0), [Noise::None, Noise::sensor(1.0), Noise::sensor(8.0)]);
        assert_eq!(light(4.0, 16.0), [Noise::sensor(8.0)]);
    }
}
