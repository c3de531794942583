//! How well the noise that a network was trained for suits the noise of a frame: of several networks the one with the least [`Fit`] is
//! the one to use.
//!
//! ```
//! use edof_core::{Noise, Tone};
//! use edof_network::fit::Fit;
//! use edof_network::network::Condition;
//! let range = |least, most| Condition {
//!     tone: Tone::Linear,
//!     noise: Noise::gaussian(most),
//!     least_noise: Noise::gaussian(least),
//! };
//! let fit = |least, most| range(least, most).fit(Noise::gaussian(0.01));
//! assert!(fit(0.005, 0.014) < fit(0.0, 0.015), "both hold the noise, the narrower range is better");
//! assert!(fit(0.0, 0.015) < fit(0.014, 0.03), "this one does not hold it");
//! ```

use crate::network::{Condition, Origin};
use edof_core::Noise;
use edof_core::tone::Tone;
use edof_core::words::number;

/// How a range of noise suits a noise; the better one is the lesser.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub enum Fit {
    /// The range contains the noise. Its width is the logarithm of the ratio of its variances.
    Inside {
        /// Width of the range.
        width: f64,
    },
    /// The noise is outside of the range.
    Outside {
        /// Logarithm of the ratio of variances, from the noise to the nearer end of the range.
        distance: f64,
    },
}

/// Light at which noise of different kinds is compared; full scale is 1.
const COMPARED_AT: f64 = 0.25;
/// Variance of rounding to 16 bits. Less noise than that counts as that, so that the logarithm of no noise is a number.
const ROUNDING: f64 = 1.0 / (12.0 * 65536.0 * 65536.0);
/// Ends of ranges were single precision: a variance may be off by this share of itself.
const EXACTNESS: f64 = 1e-6;

impl Fit {
    /// Whether the range contains the noise.
    #[must_use]
    pub const fn is_inside(self) -> bool {
        matches!(self, Self::Inside { .. })
    }
}

/// Logarithm of a noise's variance.
fn level(noise: Noise) -> f64 {
    noise.variance(COMPARED_AT).max(ROUNDING).ln()
}

impl Condition {
    /// How the range of noise suits a noise. Noise of different kinds is compared at a quarter of full scale.
    #[must_use]
    pub fn fit(&self, noise: Noise) -> Fit {
        let [least, noise, most] = [self.least_noise, noise, self.noise].map(level);
        match (least - noise).max(noise - most) {
            distance if distance > EXACTNESS => Fit::Outside { distance },
            _ => Fit::Inside { width: self.width() },
        }
    }

    /// Logarithm of the ratio of the range's variances.
    #[must_use]
    pub fn width(&self) -> f64 {
        level(self.noise) - level(self.least_noise)
    }

    /// The range of noise in words, as in `from 0.005 up to 0.014`.
    #[must_use]
    pub fn noise_in_words(&self) -> String {
        // σ was single precision, which has digits that nobody gave.
        let [least, most] = [self.least_noise, self.noise].map(|noise| match noise {
            Noise::Gaussian { sigma } => number(sigma),
            other => other.to_string(),
        });
        let from = if self.least_noise == Noise::None { String::new() } else { format!("from {least} ") };
        format!("{from}up to {most}")
    }
}

impl Origin {
    /// How the best of its ranges of noise for a tone suits a noise; none where it was not trained for the tone.
    #[must_use]
    pub fn fit(&self, tone: Tone, noise: Noise) -> Option<Fit> {
        best(self.conditions.iter().filter(|condition| condition.tone == tone), noise)
    }

    /// How the best of its ranges of noise for any tone suits a noise.
    #[must_use]
    pub fn fit_of_any_tone(&self, noise: Noise) -> Option<Fit> {
        best(self.conditions.iter(), noise)
    }
}

fn best<'a>(conditions: impl Iterator<Item = &'a Condition>, noise: Noise) -> Option<Fit> {
    conditions.map(|condition| condition.fit(noise)).reduce(|a, b| if b < a { b } else { a })
}

/// Of networks with their fits, the best one; the first where several are equally good.
pub fn best_fit<T>(networks: impl IntoIterator<Item = (T, Fit)>) -> Option<(T, Fit)> {
    networks.into_iter().reduce(|best, other| if other.1 < best.1 { other } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A range of σ as a weight file contains it.
    fn range(least: f32, most: f32) -> Condition {
        let [least_noise, noise] = [least, most].map(|sigma| Noise::gaussian(sigma.into()));
        Condition { tone: Tone::Linear, noise, least_noise }
    }

    fn fit(range: &Condition, sigma: f64) -> Fit {
        range.fit(Noise::gaussian(sigma))
    }

    #[test]
    fn the_narrowest_range_that_holds_the_noise_is_chosen_else_the_nearest() {
        let classes = [
            ("all", range(0.0, 0.015)),
            ("low", range(0.0, 0.005)),
            ("mid", range(0.005, 0.014)),
            ("high", range(0.014, 0.03)),
        ];
        let expected = [
            (0.0, "low"),
            (0.003, "low"),
            (0.0051, "mid"),
            (0.01, "mid"),
            (0.0145, "high"),
            (0.02, "high"),
            (0.03, "high"),
            (0.3, "high"),
        ];
        for (sigma, name) in expected {
            let chosen = best_fit(classes.iter().map(|(name, range)| (name, fit(range, sigma)))).unwrap();
            assert_eq!((*chosen.0, chosen.1.is_inside()), (name, sigma < 0.2), "{sigma}");
        }
        // Without classes all takes what it can, and a range above the noise is used where there is no other.
        assert!(fit(&classes[0].1, 0.01).is_inside() && !fit(&classes[3].1, 0.0).is_inside());
        assert!(fit(&classes[2].1, 0.0) < fit(&classes[3].1, 0.0), "the nearer of two that are too high");
    }

    #[test]
    fn a_noise_is_as_far_from_a_range_as_its_variance_from_the_nearer_end() {
        let class = range(0.01, 0.02);
        assert!([0.01, 0.015, 0.02].iter().all(|sigma| fit(&class, *sigma).is_inside()));
        for sigma in [0.04, 0.005] {
            let Fit::Outside { distance } = fit(&class, sigma) else { panic!("{sigma} is inside") };
            assert!((distance - 4f64.ln()).abs() < 1e-6, "{distance}");
        }
    }

    #[test]
    fn a_network_of_two_tones_has_a_fit_for_each_and_of_another_tone_none() {
        let mut origin = Origin::untrained("n", edof_core::camera::Camera::resolve("clear").unwrap());
        assert_eq!(origin.fit(Tone::Srgb, Noise::None), None);
        let light =
            Condition { tone: Tone::Srgb, noise: Noise::sensor(16.0), least_noise: Noise::sensor(4.0) };
        origin.conditions = vec![range(0.0, 0.005), light];
        assert!(origin.fit(Tone::Linear, Noise::None).is_some_and(Fit::is_inside));
        assert!(!origin.fit(Tone::Srgb, Noise::None).is_some_and(Fit::is_inside));
        assert!(origin.fit_of_any_tone(Noise::sensor(8.0)).is_some_and(Fit::is_inside));
        assert_eq!(light.noise_in_words(), "from sensor:gain=4 up to sensor:gain=16");
        assert_eq!(range(0.0, 0.015).noise_in_words(), "up to 0.015");
    }
}
