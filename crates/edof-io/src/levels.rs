//! From sensor values to light: the value of no light is taken off, and that of full light becomes full scale.

use edof_core::RawFrame;
use edof_core::frame::FrameError;
use edof_core::words::number;
use serde::{Deserialize, Serialize};

/// Sensor values of no light, for the 2×2 pixels from the first on, row by row; written as one number where they are equal.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(into = "OneOrFour", try_from = "OneOrFour")]
pub struct Black([f64; 4]);

/// What darkness and full light are in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Levels {
    /// Sensor values of no light.
    pub black: Black,
    /// Sensor value of full light; where absent, one more than the largest, as [`RawFrame`] has it.
    pub white: Option<f64>,
}

/// Levels that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum LevelsError {
    /// A text of another form.
    #[error(
        "black level '{0}': must be one sensor value such as 64, or four with commas between, each 0 to 65535"
    )]
    Text(String),
    /// An invalid value of full light.
    #[error("white level {}: must be more than 0 and at most {max}, for a sensor of {depth} bits", number(*white))]
    White { white: f64, max: u32, depth: u32 },
    /// Darkness brighter than light.
    #[error("black level {}: must be less than the white level, {}", number(*black), number(*white))]
    Black { black: f64, white: f64 },
    /// What came out is no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

impl Black {
    /// # Errors
    /// [`LevelsError::Text`] for a number that no sensor value is.
    pub fn new(values: [f64; 4]) -> Result<Self, LevelsError> {
        let possible = values.iter().all(|v| (0.0..=65535.0).contains(v));
        if possible { Ok(Self(values)) } else { Err(LevelsError::Text(Self(values).to_string())) }
    }

    /// Of the four pixels of a cell.
    #[must_use]
    pub const fn values(self) -> [f64; 4] {
        self.0
    }
}

impl From<u16> for Black {
    fn from(level: u16) -> Self {
        Self([f64::from(level); 4])
    }
}

impl std::str::FromStr for Black {
    type Err = LevelsError;

    fn from_str(text: &str) -> Result<Self, LevelsError> {
        let wrong = || LevelsError::Text(text.to_owned());
        let numbers = text.split(',').map(|word| word.trim().parse::<f64>().map_err(|_| wrong()));
        let values = match numbers.collect::<Result<Vec<_>, _>>()?[..] {
            [all] => [all; 4],
            [a, b, c, d] => [a, b, c, d],
            _ => return Err(wrong()),
        };
        Self::new(values).map_err(|_| wrong())
    }
}

impl std::fmt::Display for Black {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [a, b, c, d] = self.0;
        if [b, c, d] == [a; 3] { write!(f, "{a}") } else { write!(f, "{a},{b},{c},{d}") }
    }
}

/// As files hold it.
#[derive(Serialize, Deserialize)]
#[serde(untagged, expecting = "a black level is one number, or four")]
enum OneOrFour {
    One(f64),
    Four([f64; 4]),
}

impl From<Black> for OneOrFour {
    fn from(Black(values): Black) -> Self {
        if values == [values[0]; 4] { Self::One(values[0]) } else { Self::Four(values) }
    }
}

impl TryFrom<OneOrFour> for Black {
    type Error = LevelsError;

    fn try_from(given: OneOrFour) -> Result<Self, LevelsError> {
        Self::new(match given {
            OneOrFour::One(value) => [value; 4],
            OneOrFour::Four(values) => values,
        })
    }
}

impl Levels {
    /// The frame as light from 0 to full scale, of 16 bits: (value − black)/(white − black), what lies outside cut off. A frame whose
    /// darkness is 0 already and whose light ends with its bits stays as it is.
    ///
    /// ```
    /// use edof_io::levels::{Black, Levels};
    /// use edof_core::{CfaPhase, RawFrame};
    /// let frame = RawFrame::from_values(ndarray::array![[64, 64], [2080, 4095]], 12, CfaPhase::Rggb)?;
    /// let light = Levels { black: Black::from(64), white: None }.light(&frame)?;
    /// assert_eq!(light.pixels(), ndarray::array![[0, 0], [32768, 65520]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LevelsError`] for levels that the frame's values cannot have.
    pub fn light(&self, frame: &RawFrame) -> Result<RawFrame, LevelsError> {
        let (depth, full) = (frame.depth(), 1u32 << frame.depth());
        let white = self.white.unwrap_or(f64::from(full));
        if !(white > 0.0 && white <= f64::from(full)) {
            return Err(LevelsError::White { white, max: full, depth });
        }
        if let Some(&black) = self.black.0.iter().find(|black| **black >= white) {
            return Err(LevelsError::Black { black, white });
        }
        if self.black == Black::default() && white == f64::from(full) {
            return Ok(frame.clone());
        }
        let mut light = frame.values();
        for ((r, c), value) in light.indexed_iter_mut() {
            let black = self.black.0[2 * (r % 2) + c % 2];
            let share = (f64::from(*value) - black) / (white - black);
            *value = (65536.0 * share).round().clamp(0.0, 65535.0) as u16;
        }
        Ok(RawFrame::from_values(light, 16, frame.phase())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::CfaPhase;
    use ndarray::Array2;
    use proptest::prelude::*;

    fn frame(depth: u32) -> RawFrame {
        let max = (1usize << depth) - 1;
        let values = Array2::from_shape_fn((6, 8), |(r, c)| ((r * 8 + c) * max / 47) as u16);
        RawFrame::from_values(values, depth, CfaPhase::Gbrg).unwrap()
    }

    #[test]
    fn a_frame_that_is_light_already_stays_as_it_is() {
        for depth in 8..=16 {
            let plain = Levels { black: Black::default(), white: Some(f64::from(1u32 << depth)) };
            assert_eq!(plain.light(&frame(depth)).unwrap(), frame(depth));
            assert_eq!(Levels::default().light(&frame(depth)).unwrap(), frame(depth));
        }
    }

    #[test]
    fn each_pixel_of_a_cell_has_its_own_darkness() {
        let dark = Array2::from_shape_fn((4, 6), |(r, c)| [60, 61, 62, 63][2 * (r % 2) + c % 2]);
        let dark = RawFrame::from_values(dark, 10, CfaPhase::Rggb).unwrap();
        let light =
            Levels { black: "60,61,62,63".parse().unwrap(), white: Some(1000.0) }.light(&dark).unwrap();
        assert!(light.pixels().iter().all(|v| *v == 0));
        assert_eq!((light.depth(), light.phase()), (16, CfaPhase::Rggb));
    }

    #[test]
    fn black_levels_read_as_they_print_and_as_files_hold_them() {
        for text in ["64", "63.5", "60,61,62,63"] {
            let black: Black = text.parse().unwrap();
            assert_eq!(black.to_string(), text);
            let json = serde_json::to_string(&black).unwrap();
            assert_eq!(serde_json::from_str::<Black>(&json).unwrap(), black);
        }
        assert_eq!(serde_json::to_string(&Black::from(64)).unwrap(), "64.0");
        for text in ["", "-1", "nan", "1,2", "1,2,3,4,5", "dark", "65536", "1,2,3,-4"] {
            let error = text.parse::<Black>().unwrap_err().to_string();
            assert!(error.starts_with(&format!("black level '{text}': must be one sensor value")), "{error}");
        }
    }

    #[test]
    fn levels_that_cannot_be_are_rejected() {
        let refused = |black: u16, white: Option<f64>| {
            Levels { black: black.into(), white }.light(&frame(12)).unwrap_err().to_string()
        };
        assert_eq!(refused(4096, None), "black level 4096: must be less than the white level, 4096");
        assert_eq!(refused(70, Some(70.0)), "black level 70: must be less than the white level, 70");
        for white in [0.0, -1.0, 4097.0, f64::NAN] {
            assert!(refused(0, Some(white)).contains("at most 4096, for a sensor of 12 bits"), "{white}");
        }
    }

    proptest! {
        #[test]
        fn light_keeps_its_order_and_its_ends(black in 0u16..900, more in 1u16..3000, depth in 12u32..=16) {
            let frame = frame(depth);
            let white = f64::from(black + more);
            let light = Levels { black: black.into(), white: Some(white) }.light(&frame).unwrap();
            for (value, light) in frame.values().iter().zip(light.pixels()) {
                let share = (f64::from(*value) - f64::from(black)) / f64::from(more);
                prop_assert!((f64::from(*light) / 65536.0 - share.clamp(0.0, 65535.0 / 65536.0)).abs() <= 0.5 / 65536.0 + 1e-12);
            }
        }
    }
}
