//! sRGB's curve, fast enough for every value of every window: the same function as [`edof_core::Tone::encode`] to within 5·10⁻⁶, by two
//! square roots and a polynomial.

/// Up to here the curve is a straight line through black.
const STRAIGHT: f32 = 0.003_130_8;
/// The slope of that line.
const SLOPE: f32 = 12.92;
/// x^(5/12) as a polynomial in t = x^(1/4), from t^0 on; within 3.3·10⁻⁶ between [`STRAIGHT`] and 2.
const POWER: [f32; 7] =
    [-0.005_022_953, 0.141_256_82, 1.250_685_2, -0.698_925_7, 0.477_250_94, -0.203_250_05, 0.038_009_007];

/// sRGB value of light of 0…1.
#[inline]
pub(crate) fn encode(light: f32) -> f32 {
    let t = light.max(STRAIGHT).sqrt().sqrt();
    let power = POWER.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient);
    if light <= STRAIGHT { light * SLOPE } else { power * 1.055 - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Tone;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_tones_curve(light in 0.0f32..=1.0, dark in 0.0f32..0.01) {
            for light in [light, dark, 0.0, STRAIGHT, 1.0] {
                prop_assert!((encode(light) - Tone::Srgb.encode(light)).abs() < 5e-6, "{light}");
            }
        }
    }
}
