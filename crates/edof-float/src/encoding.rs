//! sRGB's curve and its slope, fast enough for every output of every window: the same function as [`edof_image::Tone::encode`] to
//! within 4·10⁻⁶, by two square roots and a polynomial.

use crate::real::Real;

/// Up to here the curve is a straight line through black.
const STRAIGHT: f64 = 0.003_130_8;
/// The slope of that line.
const SLOPE: f64 = 12.92;
/// From here on the curve is replaced by its tangent: no picture has such light, but a network that has hardly begun may.
const TANGENT: f64 = 2.0;
/// x^(5/12) as a polynomial in t = x^(1/4), from t^0 on; within 3.3·10⁻⁶ between [`STRAIGHT`] and [`TANGENT`].
const POWER: [f64; 7] = [
    -0.005_022_953_232_240_74,
    0.141_256_820_837_331_76,
    1.250_685_155_146_477_5,
    -0.698_925_689_467_993_2,
    0.477_250_937_292_668_5,
    -0.203_250_054_100_704_18,
    0.038_009_007_130_099_86,
];

/// sRGB value of `light`, and the curve's slope there. Odd: what is below black is encoded like its opposite.
#[inline]
pub fn encode_with_slope<T: Real>(light: T) -> (T, T) {
    let size = light.abs();
    let within = size.min(T::of(TANGENT)).max(T::of(STRAIGHT));
    let t = within.sqrt().sqrt();
    let (mut power, mut slope) = (T::of(POWER[6]), T::zero());
    for coefficient in POWER[..6].iter().rev() {
        slope = slope * t + power;
        power = power * t + T::of(*coefficient);
    }
    let slope = slope * T::of(1.055 / 4.0) / (t * t * t);
    let curved = power * T::of(1.055) - T::of(0.055) + slope * (size - within).max(T::zero());
    let straight = size <= T::of(STRAIGHT);
    let value = if straight { size * T::of(SLOPE) } else { curved };
    (value.copysign(light), if straight { T::of(SLOPE) } else { slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_image::Tone;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_tones_curve_and_slope(light in -2.0f32..2.0) {
            let (value, slope) = encode_with_slope(light);
            prop_assert!((value - Tone::Srgb.encode(light)).abs() < 5e-6);
            prop_assert!((slope / Tone::Srgb.slope(light) - 1.0).abs() < 1e-3);
        }

        #[test]
        fn the_slope_is_the_derivative_of_the_value(light in -3.0f64..3.0) {
            prop_assume!([STRAIGHT, TANGENT, 0.0].iter().all(|joint| (light.abs() - joint).abs() > 1e-5));
            let step = 1e-6;
            let measured = (encode_with_slope(light + step).0 - encode_with_slope(light - step).0) / (2.0 * step);
            prop_assert!((measured / encode_with_slope(light).1 - 1.0).abs() < 1e-6);
        }
    }
}
