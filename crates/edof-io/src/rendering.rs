//! From the sensor's own colours to those of a screen: white balance, then a colour matrix. It is done to the picture, not to the raw
//! frame, for a network is trained on the sensor's own light.

use edof_core::{ColourFrame, words};
use ndarray::Axis;
use serde::{Deserialize, Serialize};

/// Rows of a colour matrix add up to 1 as far as this, or white would not stay white.
const WHITE_STAYS_WHITE: f64 = 0.05;
/// No sensor needs a factor beyond.
const MAX: f64 = 100.0;

/// Factors of red, green and blue that make white of what the sensor sees of it. Only their proportions count: the smallest is taken
/// for 1, so that a colour whose pixels are full is full.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "[f64; 3]", try_from = "[f64; 3]")]
pub struct WhiteBalance([f64; 3]);

/// From balanced colours of the sensor to linear sRGB; rows are red, green and blue of the result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "[[f64; 3]; 3]", try_from = "[[f64; 3]; 3]")]
pub struct ColourMatrix([[f64; 3]; 3]);

/// What is done to a picture of the sensor's own colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rendering {
    /// First this.
    pub white_balance: Option<WhiteBalance>,
    /// Then this.
    pub matrix: Option<ColourMatrix>,
}

/// Numbers that are no rendering.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RenderingError {
    /// No white balance.
    #[error(
        "white balance '{0}': must be factors of red, green and blue, more than 0 and at most 100, as in 2.1,1,1.6"
    )]
    WhiteBalance(String),
    /// No matrix.
    #[error(
        "colour matrix '{0}': must be nine numbers of at most 100 either way with commas between, row by row"
    )]
    Matrix(String),
    /// A matrix that colours white.
    #[error(
        "colour matrix: row {row} adds up to {sum:.3}, expected 1 (within 0.05), so that white stays white"
    )]
    Row {
        /// Which, from 1 on.
        row: usize,
        /// What it adds up to.
        sum: f64,
    },
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|value| words::number(*value)).collect::<Vec<_>>().join(",")
}

impl TryFrom<[f64; 3]> for WhiteBalance {
    type Error = RenderingError;

    fn try_from(factors: [f64; 3]) -> Result<Self, RenderingError> {
        let possible = factors.iter().all(|factor| *factor > 0.0 && *factor <= MAX);
        if possible { Ok(Self(factors)) } else { Err(RenderingError::WhiteBalance(listed(&factors))) }
    }
}

impl From<WhiteBalance> for [f64; 3] {
    fn from(WhiteBalance(factors): WhiteBalance) -> Self {
        factors
    }
}

impl std::str::FromStr for WhiteBalance {
    type Err = RenderingError;

    fn from_str(text: &str) -> Result<Self, RenderingError> {
        let wrong = || RenderingError::WhiteBalance(text.to_owned());
        Self::try_from(numbers(text).ok_or_else(wrong)?).map_err(|_| wrong())
    }
}

impl TryFrom<[[f64; 3]; 3]> for ColourMatrix {
    type Error = RenderingError;

    fn try_from(rows: [[f64; 3]; 3]) -> Result<Self, RenderingError> {
        if !rows.iter().flatten().all(|v| v.abs() <= MAX) {
            return Err(RenderingError::Matrix(listed(rows.as_flattened())));
        }
        let sums = rows.iter().map(|row| row.iter().sum::<f64>()).zip(1..);
        match sums.into_iter().find(|(sum, _)| (sum - 1.0).abs() > WHITE_STAYS_WHITE) {
            Some((sum, row)) => Err(RenderingError::Row { row, sum }),
            None => Ok(Self(rows)),
        }
    }
}

impl From<ColourMatrix> for [[f64; 3]; 3] {
    fn from(ColourMatrix(rows): ColourMatrix) -> Self {
        rows
    }
}

impl std::str::FromStr for ColourMatrix {
    type Err = RenderingError;

    fn from_str(text: &str) -> Result<Self, RenderingError> {
        let all: [f64; 9] = numbers(text).ok_or_else(|| RenderingError::Matrix(text.to_owned()))?;
        Self::try_from(std::array::from_fn(|row| std::array::from_fn(|column| all[3 * row + column])))
    }
}

impl Rendering {
    /// A picture's light in the colours of a screen. Full stays full: what is brighter than full scale after the balance is cut, so that
    /// where all pixels are full it is white.
    pub fn apply(&self, light: &mut ColourFrame) {
        if let Some(WhiteBalance(factors)) = self.white_balance {
            let min = factors.into_iter().fold(f64::INFINITY, f64::min);
            for (mut plane, factor) in light.planes.axis_iter_mut(Axis(0)).zip(factors) {
                let factor = (factor / min) as f32;
                plane.mapv_inplace(|v| (v * factor).min(v.max(1.0)));
            }
        }
        if let Some(ColourMatrix(rows)) = self.matrix {
            let rows = rows.map(|row| row.map(|v| v as f32));
            for mut pixel in light.planes.lanes_mut(Axis(0)) {
                let colours = [pixel[0], pixel[1], pixel[2]];
                for (value, row) in pixel.iter_mut().zip(rows) {
                    *value = row.iter().zip(colours).map(|(weight, colour)| weight * colour).sum();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pixel(colours: [f32; 3]) -> ColourFrame {
        let mut frame = ColourFrame::zeros(1, 1);
        frame.planes.iter_mut().zip(colours).for_each(|(to, from)| *to = from);
        frame
    }

    fn rendered(colours: [f32; 3], white_balance: Option<&str>, matrix: Option<&str>) -> Vec<f32> {
        let white_balance = white_balance.map(|text| text.parse().unwrap());
        let matrix = matrix.map(|text| text.parse().unwrap());
        let mut frame = pixel(colours);
        Rendering { white_balance, matrix }.apply(&mut frame);
        frame.planes.into_raw_vec_and_offset().0
    }

    #[test]
    fn what_the_sensor_sees_of_white_becomes_white() {
        assert_eq!(rendered([0.25, 0.5, 0.25], Some("2,1,2"), None), [0.5, 0.5, 0.5]);
        assert_eq!(rendered([0.25, 0.5, 0.25], Some("1,0.5,1"), None), [0.5, 0.5, 0.5]);
        assert_eq!(rendered([1.0, 1.0, 1.0], Some("2,1,3"), None), [1.0, 1.0, 1.0]);
        assert_eq!(rendered([0.6, 0.8, 0.1], None, None), [0.6, 0.8, 0.1]);
    }

    #[test]
    fn the_matrix_works_on_balanced_colours() {
        let swap = "0,1,0, 1,0,0, 0,0,1";
        assert_eq!(rendered([0.125, 0.25, 0.5], Some("4,1,1"), Some(swap)), [0.25, 0.5, 0.5]);
    }

    #[test]
    fn numbers_that_are_no_rendering_are_rejected() {
        let balance = |text: &str| text.parse::<WhiteBalance>().unwrap_err().to_string();
        for text in ["", "2,1", "2,1,0", "2,1,-1", "nan,1,1", "inf,1,1", "1,1,1,1", "101,1,1", "warm"] {
            assert!(balance(text).starts_with(&format!("white balance '{text}': must be factors")), "{text}");
        }
        let matrix = |text: &str| text.parse::<ColourMatrix>().unwrap_err().to_string();
        assert!(matrix("1,0,0").starts_with("colour matrix '1,0,0': must be nine numbers"));
        assert!(matrix("1,0,0,0,1,0,0,0,nan").contains("must be nine numbers"));
        assert_eq!(
            matrix("1,0,0,0,1,0,0,0.5,1"),
            "colour matrix: row 3 adds up to 1.500, expected 1 (within 0.05), so that white stays white"
        );
        assert!(serde_json::from_str::<WhiteBalance>("[1, 0, 1]").is_err());
        assert!(serde_json::from_str::<ColourMatrix>("[[1, 0, 0], [0, 1, 0], [0, 0, 2]]").is_err());
    }

    proptest! {
        #[test]
        fn a_matrix_whose_rows_add_up_to_one_keeps_greys(grey in 0.0f32..1.0, a in -0.9f64..0.9, b in -0.9f64..0.9) {
            let text = format!("{},{a},{b},{a},{},{b},{b},{a},{}", 1.0 - a - b, 1.0 - a - b, 1.0 - a - b);
            for value in rendered([grey; 3], None, Some(&text)) {
                prop_assert!((value - grey).abs() < 1e-5);
            }
        }
    }
}
