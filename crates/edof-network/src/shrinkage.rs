//! The non-linearity z = σ_θ(b) of a network: all that the rest of the workspace asks of one.
//!
//! A new variant has its arms in this file. It has code of its own where words are computed in another way: `edof_golden::fast`,
//! `edof_hdl::blocks::shrink` and `network.cl` of `edof_gpu`. The first two do not compile without it, and a test asks the third for it.

use crate::float::real::Real;
use edof_core::number::saturate;
use serde::{Deserialize, Serialize};

/// A non-linearity σ_θ. Each rises with b and commutes with positive scales: σ_{aθ}(a·b) = a·σ_θ(b).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shrinkage {
    /// sign(b)·max(|b| − θ, 0), θ ≥ 0: the paper's soft threshold.
    TwoSided,
    /// max(b − θ, 0), θ of any sign.
    OneSided,
    /// sign(b)·min(2·max(|b| − θ, 0), |b|), θ ≥ 0: firm thresholding (Gao and Bruce 1997) with the thresholds θ and 2θ. Large codes keep
    /// their size.
    Firm,
}

/// What the training of a network starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainingDefaults {
    /// Thresholds in units of a whitened code.
    pub threshold: f32,
    /// Largest move of a weight in one step.
    pub rate: f32,
    /// Whether λ moves until the non-zeros keep the default board's budget.
    pub has_budget: bool,
}

impl Shrinkage {
    /// Every non-linearity.
    pub const ALL: [Self; 3] = [Self::TwoSided, Self::OneSided, Self::Firm];

    /// Returns the name in weight files, designs and `--form`. With `_` for `-` it is the name of the function in OpenCL.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TwoSided => "two-sided",
            Self::OneSided => "one-sided",
            Self::Firm => "firm",
        }
    }

    /// Computes z in words of `bits` bits, and whether it saturated (docs/contract.md, 3.3).
    #[must_use]
    pub fn word(self, b: i16, theta: i16, bits: u32) -> (i16, bool) {
        let (b, theta) = (i64::from(b), i64::from(theta));
        let z = match self {
            Self::TwoSided => b.signum() * (b.abs() - theta).max(0),
            Self::OneSided => (b - theta).max(0),
            Self::Firm => b.signum() * (2 * (b.abs() - theta).max(0)).min(b.abs()),
        };
        saturate(z, bits)
    }

    /// Computes rows of z in floating point. Each row has one b for each θ.
    pub fn apply<T: Real>(self, b: &[T], theta: &[T], z: &mut [T]) {
        let (zero, two) = (T::zero(), T::one() + T::one());
        match self {
            Self::TwoSided => apply(b, theta, z, |b, t| (b - t).max(zero) + (b + t).min(zero)),
            Self::OneSided => apply(b, theta, z, |b, t| (b - t).max(zero)),
            Self::Firm => apply(b, theta, z, |b, t| {
                (two * (b - t).max(zero)).min(b.max(zero)) + (two * (b + t).min(zero)).max(b.min(zero))
            }),
        }
    }

    /// Computes one z in floating point.
    #[must_use]
    pub fn value<T: Real>(self, b: T, theta: T) -> T {
        let mut z = [b];
        self.apply(&[b], &[theta], &mut z);
        z[0]
    }

    /// Applies the adjoint of the derivative of [`Shrinkage::apply`] to rows of `gradient_z`: adds to the gradients of b and of θ.
    pub fn pull_back<T: Real>(
        self,
        z: &[T],
        theta: &[T],
        gradient_z: &[T],
        gradient_b: &mut [T],
        gradient_theta: &mut [T],
    ) {
        let rows = Rows { z, theta, gradient_z };
        match self {
            Self::TwoSided => rows.pull_back(gradient_b, gradient_theta, |z, _, g| [g, g.copysign(g * z)]),
            Self::OneSided => rows.pull_back(gradient_b, gradient_theta, |_, _, g| [g, g]),
            // From θ to 2θ the slope is 2; beyond, z is b.
            Self::Firm => {
                rows.pull_back(gradient_b, gradient_theta, |z, theta, g| match z.abs() < theta + theta {
                    true => [g + g, (g + g).copysign(g * z)],
                    false => [g, T::zero()],
                })
            }
        }
    }

    /// Returns the Lipschitz constant in b and θ: z moves by at most this times the sum of their moves.
    #[must_use]
    pub const fn gain(self) -> f64 {
        match self {
            Self::TwoSided | Self::OneSided => 1.0,
            Self::Firm => 2.0,
        }
    }

    /// Returns the least θ at which z is 0 for every b from `min` to `max`.
    #[must_use]
    pub const fn closing_threshold(self, min: f64, max: f64) -> f64 {
        match self {
            Self::TwoSided | Self::Firm => min.abs().max(max.abs()),
            Self::OneSided => max,
        }
    }

    /// Returns whether θ may be negative.
    #[must_use]
    pub const fn allows_negative(self) -> bool {
        match self {
            Self::TwoSided | Self::Firm => false,
            Self::OneSided => true,
        }
    }

    /// Returns the nearest threshold that the non-linearity allows.
    pub fn legal<T: PartialOrd + Default>(self, theta: T) -> T {
        if self.allows_negative() || theta > T::default() { theta } else { T::default() }
    }

    /// Returns what worked best in training (`docs/decisions/`). One-sided codes that start nearly silent never learn: from 0.5 a third of
    /// them died, at a cost of 0.2 dB. Codes of both signs need some threshold, or all is linear.
    #[must_use]
    pub const fn training(self) -> TrainingDefaults {
        match self {
            Self::TwoSided | Self::Firm => TrainingDefaults { threshold: 0.3, rate: 2e-3, has_budget: false },
            Self::OneSided => TrainingDefaults { threshold: 0.0, rate: 1.5e-3, has_budget: true },
        }
    }
}

impl std::fmt::Display for Shrinkage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// Calls a function for each b and its θ.
fn apply<T: Real>(b: &[T], theta: &[T], z: &mut [T], one: impl Fn(T, T) -> T) {
    for (b, z) in b.chunks_exact(theta.len()).zip(z.chunks_exact_mut(theta.len())) {
        for ((z, &b), &theta) in z.iter_mut().zip(b).zip(theta) {
            *z = one(b, theta);
        }
    }
}

/// Rows of z with their thresholds, and the gradient of z.
struct Rows<'a, T> {
    z: &'a [T],
    theta: &'a [T],
    gradient_z: &'a [T],
}

impl<T: Real> Rows<'_, T> {
    /// Adds to b's gradient, and subtracts from θ's, what `one(z, θ, gradient)` gives of them. A z of 0 passes nothing.
    fn pull_back(&self, gradient_b: &mut [T], gradient_theta: &mut [T], one: impl Fn(T, T, T) -> [T; 2]) {
        let codes = self.theta.len();
        let rows = self.z.chunks_exact(codes).zip(self.gradient_z.chunks_exact(codes));
        for ((z, gradient_z), gradient_b) in rows.zip(gradient_b.chunks_exact_mut(codes)) {
            let into = gradient_b.iter_mut().zip(gradient_theta.iter_mut());
            for (((&z, &theta), &g), (b, t)) in z.iter().zip(self.theta).zip(gradient_z).zip(into) {
                let [to_b, to_theta] = one(z, theta, if z == T::zero() { T::zero() } else { g });
                *b += to_b;
                *t -= to_theta;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Shrinkage::{Firm, OneSided, TwoSided};
    use proptest::prelude::*;

    #[test]
    fn names_are_those_of_weight_files() {
        for shrinkage in Shrinkage::ALL {
            assert_eq!(serde_json::to_value(shrinkage).unwrap(), shrinkage.name());
        }
    }

    #[test]
    fn two_sided_words_move_toward_zero_and_stop_there() {
        assert_eq!([5, 3, 0, -3, -5].map(|b| TwoSided.word(b, 3, 16).0), [2, 0, 0, 0, -2]);
        assert_eq!(TwoSided.word(i16::MIN, 0, 16), (i16::MIN, false));
    }

    #[test]
    fn one_sided_words_exceed_a_threshold_of_any_sign_and_saturate() {
        assert_eq!([5, 3, -5].map(|b| OneSided.word(b, 3, 16).0), [2, 0, 0]);
        assert_eq!([5, -3, -5].map(|b| OneSided.word(b, -4, 16).0), [9, 1, 0]);
        assert_eq!(OneSided.word(120, -20, 8), (127, true));
        assert_eq!(OneSided.word(i16::MAX, i16::MIN, 16), (i16::MAX, true));
    }

    #[test]
    fn firm_words_double_what_exceeds_theta_until_they_are_whole() {
        assert_eq!([2, 3, 4, 5, 6, 7, 100].map(|b| Firm.word(b, 3, 16).0), [0, 0, 2, 4, 6, 7, 100]);
        assert_eq!([-3, -4, -6, -7].map(|b| Firm.word(b, 3, 16).0), [0, -2, -6, -7]);
        assert_eq!(Firm.word(i16::MIN, 0, 16), (i16::MIN, false));
        assert_eq!(Firm.word(i16::MIN, i16::MAX, 16), (-2, false));
    }

    #[test]
    fn thresholds_that_are_not_allowed_become_zero() {
        for shrinkage in Shrinkage::ALL {
            let least = if shrinkage.allows_negative() { -3.0 } else { 0.0 };
            assert_eq!([-3.0, 0.0, 2.0].map(|t| shrinkage.legal(t)), [least, 0.0, 2.0]);
        }
    }

    proptest! {
        #[test]
        fn words_are_the_clamped_numbers(b in -2048i16..2048, theta in -2048i16..2048) {
            for shrinkage in Shrinkage::ALL {
                let theta = shrinkage.legal(theta);
                let exact = shrinkage.value(f64::from(b), f64::from(theta));
                let (word, saturated) = shrinkage.word(b, theta, 12);
                prop_assert_eq!((f64::from(word), saturated), (exact.clamp(-2048.0, 2047.0), exact > 2047.0));
            }
        }

        /// The properties that formats, error bounds and folded scales rely on.
        #[test]
        fn every_shrinkage_rises_scales_and_keeps_to_its_gain(
            b in -4.0f64..4.0, c in -4.0f64..4.0, theta in -2.0f64..2.0, eta in -2.0f64..2.0, scale in 0.01f64..100.0
        ) {
            for shrinkage in Shrinkage::ALL {
                let (theta, eta) = (shrinkage.legal(theta), shrinkage.legal(eta));
                let (z, other) = (shrinkage.value(b, theta), shrinkage.value(c, eta));
                prop_assert!((z - other).abs() <= shrinkage.gain() * ((b - c).abs() + (theta - eta).abs()) + 1e-12);
                prop_assert!((shrinkage.value(scale * b, scale * theta) - scale * z).abs() < 1e-12 * scale);
                prop_assert!((shrinkage.value(b.max(c), theta)) >= shrinkage.value(b.min(c), theta));
                let closing = shrinkage.closing_threshold(b.min(c), b.max(c));
                let closing = shrinkage.legal(closing);
                prop_assert_eq!([b, c].map(|b| shrinkage.value(b, closing)), [0.0; 2]);
            }
        }

        /// By central differences, away from the corners.
        #[test]
        fn pull_back_is_the_derivative(b in -4.0f64..4.0, theta in -2.0f64..2.0) {
            const STEP: f64 = 1e-5;
            for shrinkage in Shrinkage::ALL {
                let theta = shrinkage.legal(theta);
                let corners = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|corner: f64| corner * theta);
                if theta.abs() < 0.01 || corners.iter().any(|corner| (b - corner).abs() < 0.01) {
                    continue;
                }
                let slope = |plus: f64, minus: f64| (plus - minus) / (2.0 * STEP);
                let to_b = slope(shrinkage.value(b + STEP, theta), shrinkage.value(b - STEP, theta));
                let to_theta = slope(shrinkage.value(b, theta + STEP), shrinkage.value(b, theta - STEP));
                let (z, mut into_b, mut into_theta) = (shrinkage.value(b, theta), [0.5], [0.25]);
                shrinkage.pull_back(&[z], &[theta], &[-3.0], &mut into_b, &mut into_theta);
                prop_assert!((into_b[0] - 0.5 + 3.0 * to_b).abs() < 1e-6);
                prop_assert!((into_theta[0] - 0.25 + 3.0 * to_theta).abs() < 1e-6);
            }
        }
    }
}
