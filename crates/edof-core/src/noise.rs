//! Noise of a sensor, as data and as the text that options and files hold it in (docs/decisions/0010-tone-and-noise.md).
//!
//! | text | noise |
//! |---|---|
//! | `none`, `0` | none |
//! | `0.01` | Gaussian, σ in units of full scale: the paper's |
//! | `sensor` | photons and read-out of the reference sensor at base gain |
//! | `sensor:gain=8` | the same at eight times the gain |
//! | `sensor:full-well=6000:read-noise=1.8:gain=2` | another sensor |

use crate::words::number;
use serde::{Deserialize, Serialize};

/// Noise that a sensor adds to the light before it saturates; full scale is 1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(into = "String", try_from = "TextOrNumber")]
pub enum Noise {
    /// None.
    #[default]
    None,
    /// The same Gaussian noise at every light.
    Gaussian {
        /// Standard deviation in units of full scale.
        sigma: f64,
    },
    /// Photon noise and read noise.
    Sensor(SensorNoise),
}

/// A sensor's electrons. A light of v (full scale 1) frees v·full well/gain of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorNoise {
    /// Electrons that a pixel holds.
    pub full_well_e: f64,
    /// Standard deviation of the read-out in electrons.
    pub read_noise_e: f64,
    /// Full scale is reached at this part of the full well: 1 at base sensitivity, 8 three stops above.
    pub gain: f64,
}

impl Default for SensorNoise {
    /// The reference sensor: a pixel of the 3 µm class at base gain.
    fn default() -> Self {
        Self { full_well_e: 10_000.0, read_noise_e: 2.5, gain: 1.0 }
    }
}

/// Noise that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum NoiseError {
    /// A text of another form.
    #[error(
        "noise '{0}': must be none, a standard deviation such as 0.01, or sensor with any of :full-well=ELECTRONS, \
         :read-noise=ELECTRONS and :gain=FACTOR"
    )]
    Text(String),
    /// A number out of range.
    #[error("noise: {field} is {}, expected {expected}", number(*value))]
    Value { field: &'static str, value: f64, expected: &'static str },
}

/// Most electrons that a full well or a read-out may have: far beyond any pixel.
const MAX_ELECTRONS: f64 = 1e9;

impl Noise {
    /// Gaussian noise of that σ; none for 0.
    #[must_use]
    pub fn gaussian(sigma: f64) -> Self {
        if sigma == 0.0 { Self::None } else { Self::Gaussian { sigma } }
    }

    /// Noise of the reference sensor at a gain.
    #[must_use]
    pub fn sensor(gain: f64) -> Self {
        Self::Sensor(SensorNoise { gain, ..SensorNoise::default() })
    }

    /// Noise of the reference sensor at a gain above 0. A gain below 1, of a sensor with more electrons, counts as 1.
    #[must_use]
    pub fn of_gain(gain: f64) -> Self {
        Self::sensor(gain.max(1.0))
    }

    /// Variance at a light of `signal` (full scale 1), in units of full scale squared. Darkness below 0 counts as 0.
    ///
    /// ```
    /// use edof_core::Noise;
    /// assert!((Noise::sensor(1.0).variance(1.0).sqrt() - 0.010003).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn variance(self, signal: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Gaussian { sigma } => sigma * sigma,
            Self::Sensor(sensor) => {
                let electron = 1.0 / sensor.full_scale_e();
                signal.max(0.0) * electron + (sensor.read_noise_e * electron).powi(2)
            }
        }
    }

    /// Returns the noise of each of `exposures` frames that share the exposure time in equal parts: a share of the electrons, the read noise of a
    /// whole frame, and a gain that makes white full scale. Gaussian noise has none, because it states no electrons.
    ///
    /// ```
    /// use edof_core::Noise;
    /// assert_eq!(Noise::sensor(1.0).of_share(2), Some(Noise::sensor(2.0)));
    /// ```
    #[must_use]
    pub fn of_share(self, exposures: usize) -> Option<Self> {
        match self {
            Self::Sensor(sensor) => {
                Some(Self::Sensor(SensorNoise { gain: sensor.gain * exposures as f64, ..sensor }))
            }
            Self::Gaussian { .. } if exposures > 1 => None,
            same => Some(same),
        }
    }

    /// # Errors
    /// [`NoiseError::Value`] for the first number out of range.
    pub fn check(self) -> Result<(), NoiseError> {
        match self {
            Self::None => Ok(()),
            Self::Gaussian { sigma } => {
                within("the standard deviation", sigma, 0.0..=1.0, "0 to 1, where full scale is 1")
            }
            Self::Sensor(SensorNoise { full_well_e, read_noise_e, gain }) => {
                within("full well", full_well_e, 1.0..=MAX_ELECTRONS, "1 to 1e9 electrons")?;
                within("read noise", read_noise_e, 0.0..=MAX_ELECTRONS, "0 to 1e9 electrons")?;
                within(
                    "gain",
                    gain,
                    1.0..=full_well_e,
                    "1 or more, and full scale to be an electron at least",
                )
            }
        }
    }
}

impl SensorNoise {
    /// Electrons at full scale.
    #[must_use]
    pub fn full_scale_e(self) -> f64 {
        self.full_well_e / self.gain
    }

    /// Gain at which the reference sensor has as many electrons for white.
    #[must_use]
    pub fn reference_gain(self) -> f64 {
        Self::default().full_well_e / self.full_scale_e()
    }
}

fn within(
    field: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    expected: &'static str,
) -> Result<(), NoiseError> {
    if range.contains(&value) { Ok(()) } else { Err(NoiseError::Value { field, value, expected }) }
}

impl std::str::FromStr for Noise {
    type Err = NoiseError;

    fn from_str(text: &str) -> Result<Self, NoiseError> {
        let noise = parse(text).ok_or_else(|| NoiseError::Text(text.to_owned()))?;
        noise.check()?;
        Ok(noise)
    }
}

fn parse(text: &str) -> Option<Noise> {
    if text == "none" {
        return Some(Noise::None);
    }
    let mut parts = text.split(':');
    if parts.next() != Some("sensor") {
        return text.parse().ok().map(Noise::gaussian);
    }
    let mut sensor = SensorNoise::default();
    let mut seen = vec![];
    for (key, value) in parts.map(|part| part.split_once('=').unwrap_or((part, ""))) {
        let field = match key {
            "full-well" => &mut sensor.full_well_e,
            "read-noise" => &mut sensor.read_noise_e,
            "gain" => &mut sensor.gain,
            _ => return None,
        };
        if seen.contains(&key) {
            return None;
        }
        seen.push(key);
        *field = value.parse().ok()?;
    }
    Some(Noise::Sensor(sensor))
}

impl std::fmt::Display for Noise {
    /// The shortest text that [`Noise::from_str`](std::str::FromStr) reads back.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = match self {
            Self::None => "none".to_owned(),
            Self::Gaussian { sigma } => sigma.to_string(),
            Self::Sensor(sensor) => {
                let reference = SensorNoise::default();
                let fields = [
                    ("full-well", sensor.full_well_e, reference.full_well_e),
                    ("read-noise", sensor.read_noise_e, reference.read_noise_e),
                    ("gain", sensor.gain, reference.gain),
                ];
                let own = fields.iter().filter(|(_, value, usual)| value != usual);
                own.fold("sensor".to_owned(), |text, (key, value, _)| format!("{text}:{key}={value}"))
            }
        };
        f.pad(&text)
    }
}

impl From<Noise> for String {
    fn from(noise: Noise) -> Self {
        noise.to_string()
    }
}

/// What a file may hold: the text, or a plain number for Gaussian noise.
#[derive(Deserialize)]
#[serde(untagged, expecting = "noise is a text as --noise takes it, or what edof capture writes")]
enum TextOrNumber {
    Number(f64),
    Text(String),
}

impl TryFrom<TextOrNumber> for Noise {
    type Error = NoiseError;

    fn try_from(given: TextOrNumber) -> Result<Self, NoiseError> {
        match given {
            TextOrNumber::Text(text) => text.parse(),
            TextOrNumber::Number(sigma) => {
                let noise = Self::gaussian(sigma);
                noise.check()?;
                Ok(noise)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn noises_read_as_they_print() {
        let texts =
            ["none", "0.01", "sensor", "sensor:gain=8", "sensor:full-well=6000:read-noise=1.8:gain=2"];
        for text in texts {
            let noise: Noise = text.parse().unwrap();
            assert_eq!(noise.to_string(), text);
            assert_eq!(serde_json::to_string(&noise).unwrap(), format!("\"{text}\""));
            assert_eq!(serde_json::from_str::<Noise>(&format!("\"{text}\"")).unwrap(), noise);
        }
    }

    #[test]
    fn a_plain_number_in_a_file_is_gaussian_noise() {
        let read = |text| serde_json::from_str::<Noise>(text).map_err(|e| e.to_string());
        assert_eq!(read("0.015"), Ok(Noise::Gaussian { sigma: 0.015 }));
        assert_eq!(read("0"), Ok(Noise::None));
        assert!(read("-1").unwrap_err().contains("expected 0 to 1"));
    }

    #[test]
    fn the_order_of_a_sensors_parts_does_not_matter() {
        let noise = |text: &str| text.parse::<Noise>().unwrap();
        assert_eq!(noise("sensor:gain=2:full-well=9000"), noise("sensor:full-well=9000:gain=2"));
    }

    #[test]
    fn texts_of_another_form_are_rejected() {
        for text in
            ["", "loud", "sensors", "sensor:iso=100", "sensor:gain", "sensor:gain=x", "sensor:gain=2:gain=4"]
        {
            let error = text.parse::<Noise>().unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("noise '{text}': must be none, a standard deviation")),
                "{error}"
            );
        }
    }

    #[test]
    fn numbers_out_of_range_are_rejected() {
        let refused = |text: &str| text.parse::<Noise>().unwrap_err().to_string();
        assert_eq!(
            refused("-0.1"),
            "noise: the standard deviation is -0.1, expected 0 to 1, where full scale is 1"
        );
        assert_eq!(refused("sensor:full-well=0"), "noise: full well is 0, expected 1 to 1e9 electrons");
        assert_eq!(refused("sensor:read-noise=-2"), "noise: read noise is -2, expected 0 to 1e9 electrons");
        for text in [
            "nan",
            "inf",
            "sensor:gain=0.5",
            "sensor:gain=20000",
            "sensor:full-well=1e300",
            "sensor:gain=nan",
        ] {
            assert!(refused(text).contains(", expected "), "{text}");
        }
    }

    proptest! {
        #[test]
        fn a_sensors_variance_is_photons_and_read_out(
            v in 0.0f64..1.0, full_well_e in 100.0f64..1e5, read_noise_e in 0.0f64..50.0, gain in 1.0f64..64.0
        ) {
            let noise = Noise::Sensor(SensorNoise { full_well_e, read_noise_e, gain });
            prop_assert!(noise.check().is_ok());
            let electrons = v * full_well_e / gain;
            let expected = (electrons + read_noise_e.powi(2)) / (full_well_e / gain).powi(2);
            prop_assert!((noise.variance(v) - expected).abs() <= 1e-12 * expected);
            prop_assert_eq!(noise.to_string().parse::<Noise>().unwrap(), noise);
        }

        #[test]
        fn exposures_that_share_the_time_have_the_photons_of_one_and_are_each_read(
            v in 0.0f64..1.0, full_well_e in 100.0f64..1e5, read_noise_e in 0.0f64..50.0, gain in 1.0f64..16.0, exposures in 1usize..5
        ) {
            let whole = SensorNoise { full_well_e, read_noise_e, gain };
            let share = Noise::Sensor(whole).of_share(exposures).unwrap();
            let mean = share.variance(v) / exposures as f64;
            let electrons = whole.full_scale_e();
            let expected = (v * electrons + exposures as f64 * read_noise_e.powi(2)) / electrons.powi(2);
            prop_assert!((mean - expected).abs() <= 1e-12 * expected);
            prop_assert_eq!(Noise::None.of_share(exposures), Some(Noise::None));
            let gaussian = Noise::gaussian(v);
            prop_assert_eq!(gaussian.of_share(exposures), (exposures == 1 || v == 0.0).then_some(gaussian));
        }
    }
}
