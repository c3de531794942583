//! Tone: whether the numbers of a photograph or picture are light itself or sRGB's encoding of it
//! (docs/decisions/0010-tone-and-noise.md).
//!
//! Light adds, so lens and sensor work on light. A photograph holds sRGB codes, and a picture is looked at as such: under [`Tone::Srgb`] a
//! photograph is decoded before the lens, and the sensor's words are encoded before the network, whose picture is codes again
//! (docs/decisions/0053-encoded-values.md); under [`Tone::Linear`], the paper's convention, a photograph's codes are taken for light and
//! nothing is converted.

use crate::colour::{srgb_decode, srgb_encode};
use crate::frame::{ColourFrame, RawFrame};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::LazyLock;

/// What the numbers of a photograph or picture mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tone {
    /// Light as it is: value = light.
    Linear,
    /// sRGB's curve (IEC 61966-2-1): value = encoded light.
    Srgb,
}

/// A word that names no tone.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("tone '{0}': must be linear or srgb")]
pub struct ToneError(String);

impl Tone {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Linear, Self::Srgb];

    /// Light itself: the values of a file that does not state any.
    #[must_use]
    pub const fn light() -> Self {
        Self::Linear
    }

    /// Whether values of this tone are light.
    #[must_use]
    pub fn is_light(&self) -> bool {
        *self == Self::light()
    }

    /// Value that stands for `light`; both are 0…1 from black to white.
    ///
    /// Beyond white the curve continues; below black it is odd, encode(−x) = −encode(x), so that an error above black and
    /// one below it weigh the same. It rises everywhere, and [`Tone::decode`] undoes it everywhere.
    ///
    /// ```
    /// use edof_core::Tone;
    /// assert!((Tone::Srgb.encode(0.18) - 0.4613).abs() < 1e-4);
    /// assert_eq!(Tone::Linear.encode(0.18), 0.18);
    /// ```
    #[must_use]
    pub fn encode(self, light: f32) -> f32 {
        match self {
            Self::Linear => light,
            Self::Srgb => odd(srgb_encode, light),
        }
    }

    /// Light that `value` stands for: the inverse of [`Tone::encode`].
    #[must_use]
    pub fn decode(self, value: f32) -> f32 {
        match self {
            Self::Linear => value,
            Self::Srgb => odd(srgb_decode, value),
        }
    }

    /// A frame of light, encoded.
    #[must_use]
    pub fn encoded(self, light: &ColourFrame) -> ColourFrame {
        match self {
            Self::Linear => light.clone(),
            Self::Srgb => ColourFrame { planes: light.planes.mapv(|v| self.encode(v)) },
        }
    }

    /// The light of an encoded frame.
    #[must_use]
    pub fn decoded(self, values: &ColourFrame) -> ColourFrame {
        self.into_decoded(values.clone())
    }

    /// The same in its own place.
    #[must_use]
    pub fn into_decoded(self, mut values: ColourFrame) -> ColourFrame {
        if self == Self::Srgb {
            // Most photographs hold no other values.
            let codes = std::array::from_fn::<_, 256, _>(|code| code as f32 / 255.0);
            let light = codes.map(|value| self.decode(value));
            values.planes.mapv_inplace(|value| {
                let code = ((value * 255.0 + 0.5) as usize).min(255);
                if codes[code].to_bits() == value.to_bits() { light[code] } else { self.decode(value) }
            });
        }
        values
    }

    /// The light of a picture that a network made, to within 10⁻⁷, in its own place: as [`Tone::into_decoded`], and ten times as fast for values
    /// that are no codes.
    pub fn lighten(self, values: &mut ColourFrame) {
        if self == Self::Srgb {
            let table = &LIGHT[..];
            values.planes.mapv_inplace(|value| {
                let place = value * STEPS as f32;
                let at = place as usize;
                if !(0.0..1.0).contains(&value) {
                    return self.decode(value);
                }
                table[at] + (place - at as f32) * (table[at + 1] - table[at])
            });
        }
    }

    /// What a picture of this light looks like, to within 10⁻⁶, in its own place: [`Tone::encode`] of each value, brought to 0…1 first. For screens.
    pub fn darken(self, light: &mut ColourFrame) {
        let table = &CODES[..];
        light.planes.mapv_inplace(|value| {
            let value = value.clamp(0.0, 1.0);
            if self.is_light() {
                return value;
            }
            let place = value * (CODES_STEPS as f32);
            let at = (place as usize).min(CODES_STEPS - 1);
            table[at] + (place - at as f32) * (table[at + 1] - table[at])
        });
    }

    /// The word that a camera gives which encodes its sensor's words; full scale is 2^16.
    #[must_use]
    pub fn encode_word(self, word: u16) -> u16 {
        match self {
            Self::Linear => word,
            Self::Srgb => ENCODED[usize::from(word)],
        }
    }

    /// The sensor's word that a camera encoded, to the nearest: the inverse of [`Tone::encode_word`] where the curve is flat enough.
    #[must_use]
    pub fn decode_word(self, word: u16) -> u16 {
        match self {
            Self::Linear => word,
            Self::Srgb => DECODED[usize::from(word)],
        }
    }
}

impl RawFrame {
    /// What a camera gives that encodes its sensor's words in a tone, in 16 bits: what a network of such values takes.
    #[must_use]
    pub fn encoded(&self, tone: Tone) -> Cow<'_, Self> {
        match tone {
            Tone::Linear => Cow::Borrowed(self),
            Tone::Srgb => Cow::Owned(self.mapped(|word| tone.encode_word(word))),
        }
    }

    /// The sensor's words of a frame that a camera encoded, to the nearest of 16 bits.
    #[must_use]
    pub fn decoded(&self, tone: Tone) -> Cow<'_, Self> {
        match tone {
            Tone::Linear => Cow::Borrowed(self),
            Tone::Srgb => Cow::Owned(self.mapped(|word| tone.decode_word(word))),
        }
    }
}

/// Steps of [`LIGHT`] between black and white.
const STEPS: usize = 4096;
/// sRGB's curve backwards, with a straight line between neighbours: within 5·10⁻⁸ of it.
static LIGHT: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=STEPS).map(|i| srgb_decode(i as f64 / STEPS as f64) as f32).collect());
/// Steps of [`CODES`]: sRGB's curve is steep near black.
const CODES_STEPS: usize = 65_536;
/// sRGB's curve, with a straight line between neighbours.
static CODES: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=CODES_STEPS).map(|i| srgb_encode(i as f64 / CODES_STEPS as f64) as f32).collect());
/// The encoded word of each word of a raw frame, full scale 2^16.
static ENCODED: LazyLock<Vec<u16>> = LazyLock::new(|| words(srgb_encode));
/// The word of each encoded word.
static DECODED: LazyLock<Vec<u16>> = LazyLock::new(|| words(srgb_decode));

fn words(curve: fn(f64) -> f64) -> Vec<u16> {
    let scale = 65_536.0;
    (0..=u16::MAX).map(|word| (curve(f64::from(word) / scale) * scale + 0.5).min(65_535.0) as u16).collect()
}

fn odd(curve: impl Fn(f64) -> f64, x: f32) -> f32 {
    let x = f64::from(x);
    curve(x.abs()).copysign(x) as f32
}

impl std::str::FromStr for Tone {
    type Err = ToneError;

    fn from_str(text: &str) -> Result<Self, ToneError> {
        Self::ALL.into_iter().find(|tone| tone.to_string() == text).ok_or_else(|| ToneError(text.to_owned()))
    }
}

impl std::fmt::Display for Tone {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Linear => "linear",
            Self::Srgb => "srgb",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;
    use proptest::prelude::*;

    #[test]
    fn tones_read_as_they_print_and_as_json_holds_them() {
        for tone in Tone::ALL {
            assert_eq!(tone.to_string().parse(), Ok(tone));
            assert_eq!(serde_json::to_string(&tone).unwrap(), format!("\"{tone}\""));
        }
        assert_eq!("gamma".parse::<Tone>().unwrap_err().to_string(), "tone 'gamma': must be linear or srgb");
    }

    #[test]
    fn every_8_and_16_bit_code_of_a_photograph_comes_back() {
        for max in [255, 65535] {
            for code in 0..=max {
                let value = code as f32 / max as f32;
                let back = Tone::Srgb.encode(Tone::Srgb.decode(value)) * max as f32;
                assert_eq!(back.round() as i32, code, "{code} of {max}");
            }
        }
    }

    #[test]
    fn light_on_a_screen_is_encoded_to_within_a_millionth() {
        let values: Vec<f32> =
            (-1000..1_001_000).map(|i| i as f32 * 1e-6).chain([f32::INFINITY, -9.0]).collect();
        for tone in Tone::ALL {
            let mut frame =
                ColourFrame { planes: Array3::from_shape_vec((1, 1, values.len()), values.clone()).unwrap() };
            tone.darken(&mut frame);
            for (code, light) in frame.planes.iter().zip(&values) {
                assert!((code - tone.encode(light.clamp(0.0, 1.0))).abs() < 1e-6, "{tone} {light}: {code}");
            }
        }
    }

    #[test]
    fn a_frame_is_decoded_value_by_value() {
        let values = [0.0, -0.0, 1.0, 128.0 / 255.0, 0.5, 1e9, -1e9, f32::MIN_POSITIVE, f32::INFINITY];
        let codes = (0..=65535).map(|code| code as f32 / 65535.0);
        let all: Vec<f32> = codes.chain(values).chain((0..=255).map(|code| code as f32 / 255.0)).collect();
        let frame = ColourFrame { planes: Array3::from_shape_vec((1, 1, all.len()), all.clone()).unwrap() };
        for tone in Tone::ALL {
            let decoded = tone.decoded(&frame).planes;
            assert!(decoded.iter().zip(&all).all(|(light, v)| light.to_bits() == tone.decode(*v).to_bits()));
        }
    }

    #[test]
    fn every_word_of_a_sensor_is_encoded_as_its_light_is() {
        for word in 0..=u16::MAX {
            let value = f64::from(Tone::Srgb.encode_word(word)) / 65_536.0;
            assert!(
                (value - srgb_encode(f64::from(word) / 65_536.0)).abs() <= 0.500_001 / 65_536.0 + 8e-6,
                "{word}"
            );
            assert_eq!(Tone::Linear.encode_word(word), word);
        }
        assert!((1..=u16::MAX).all(|word| Tone::Srgb.encode_word(word - 1) <= Tone::Srgb.encode_word(word)));
        assert_eq!([0, u16::MAX].map(|word| Tone::Srgb.encode_word(word)), [0, u16::MAX]);
        let back = |word: u16| Tone::Srgb.decode_word(Tone::Srgb.encode_word(word)).abs_diff(word);
        assert!((0..=u16::MAX).all(|word| back(word) <= 1) && (0..1000).all(|word| back(word) == 0));
    }

    #[test]
    fn a_picture_is_lightened_as_it_is_decoded() {
        let values: Vec<f32> = (-20_000..=120_000).map(|i| i as f32 * 1e-5).collect();
        let frame = ColourFrame { planes: Array3::from_shape_vec((1, 1, values.len()), values).unwrap() };
        for tone in Tone::ALL {
            let mut light = frame.clone();
            tone.lighten(&mut light);
            let exact = frame.planes.mapv(|v| tone.decode(v));
            assert!(light.planes.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1.3e-7), "{tone}");
        }
    }

    #[test]
    fn the_curve_goes_through_known_points() {
        // Middle grey, code 128 of 255, and both sides of the joint at 0.04045.
        for (light, value) in [(0.0, 0.0), (1.0, 1.0), (0.214_041, 0.5), (0.215_861, 128.0 / 255.0)] {
            assert!((Tone::Srgb.encode(light) - value).abs() < 1e-5, "{light}");
        }
        assert!((Tone::Srgb.decode(10.0 / 255.0) - 10.0 / 255.0 / 12.92).abs() < 1e-8);
    }

    proptest! {
        #[test]
        fn decoding_undoes_encoding_on_both_sides_of_black_and_white(light in -2.0f32..2.0) {
            for tone in Tone::ALL {
                prop_assert!((tone.decode(tone.encode(light)) - light).abs() < 1e-6);
                prop_assert_eq!(tone.encode(-light), -tone.encode(light));
            }
        }
    }
}
