//! A mask of any shape, by the height of its surface: a grey picture beside the camera file.
//!
//! A camera file names it by `"height_map": { "file": "mask.png", "white_um": 1.2, "cauchy": [1.458, 0.0035] }`. The picture is square
//! and its sides touch the aperture; seen as the raw frame is: what is higher on the right sends light to the right.

use super::glass::{etched_rad, is_glass};
use super::phase::{Function, MAX_HEIGHT_UM, PhaseTerm, Symmetry, Wrong};
use crate::storage::digest::sha256;
use crate::words::{number, numbers};
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// Fewest and most pixels along a side of the picture.
const SIDES: std::ops::RangeInclusive<usize> = 2..=4096;

/// The surface of a mask: where its picture lies, and what it is once it was read. Two are the same if their surfaces are.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeightMap {
    /// The picture, seen from the folder of the camera file.
    pub file: String,
    /// Height in micrometres of white; black is 0.
    pub white_um: f64,
    /// n(λ) = `cauchy[0]` + `cauchy[1]`/λ² with λ in micrometres.
    pub cauchy: [f64; 2],
    /// SHA-256 of the picture's values, as hexadecimal digits; a file of other content is rejected. Where a camera file leaves it out,
    /// reading the picture fills it in.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
    /// Heights of 0…1, the first row on top; none until they were read.
    #[serde(skip)]
    pub heights: Option<Arc<Array2<f32>>>,
}

impl PartialEq for HeightMap {
    fn eq(&self, other: &Self) -> bool {
        (&self.sha256, self.white_um, self.cauchy) == (&other.sha256, other.white_um, other.cauchy)
    }
}

/// A picture that is not a surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum HeightMapError {
    /// Another shape.
    #[error("{path}: {width}x{height}, expected a square height map of 2 to 4096 pixels a side", path = path.display())]
    Size { path: PathBuf, width: usize, height: usize },
    /// Not the one that the camera means.
    #[error("{path}: its heights have the SHA-256 {found}, camera {camera} states {stated}", path = path.display())]
    Changed { path: PathBuf, camera: String, found: String, stated: String },
}

impl HeightMap {
    /// Takes the picture that was read from `path`, values 0…1, for the camera of that name.
    ///
    /// # Errors
    /// [`HeightMapError`].
    pub fn take(&mut self, heights: Array2<f32>, path: PathBuf, camera: &str) -> Result<(), HeightMapError> {
        let (height, width) = heights.dim();
        if height != width || !SIDES.contains(&height) {
            return Err(HeightMapError::Size { path, width, height });
        }
        let found = sha256(&heights.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
        if !self.sha256.is_empty() && self.sha256 != found {
            let (camera, stated) = (camera.to_owned(), self.sha256.clone());
            return Err(HeightMapError::Changed { path, camera, found, stated });
        }
        (self.sha256, self.heights) = (found, Some(Arc::new(heights)));
        Ok(())
    }

    /// Returns the height as a share of white's, at a place of the aperture, −1…1 to the right and upward; linear between the middles of
    /// pixels. 0 as long as the picture was not read.
    fn at(&self, right: f64, up: f64) -> f64 {
        let Some(heights) = &self.heights else { return 0.0 };
        let last = heights.nrows() - 1;
        // Of a coordinate −1…1 the pixel before it, and how far it is to the next.
        let place = |v: f64| {
            let at = ((v + 1.0) * 0.5 * heights.nrows() as f64 - 0.5).clamp(0.0, last as f64);
            let before = (at as usize).min(last - 1);
            (before, at - before as f64)
        };
        let ((row, down), (column, across)) = (place(-up), place(right));
        let along = |row: usize| {
            let [a, b] = [0, 1].map(|i| f64::from(heights[(row, column + i)]));
            a + (b - a) * across
        };
        along(row) + (along(row + 1) - along(row)) * down
    }
}

impl PhaseTerm for HeightMap {
    fn what(&self) -> &'static str {
        "a height map"
    }

    fn weaker(&self) -> Option<&'static str> {
        Some("a smoother height map")
    }

    fn check(&self) -> Result<(), Wrong> {
        let Self { file, white_um, cauchy, .. } = self;
        if file.is_empty() {
            let expected = "the name of a file, as seen from the camera file";
            return Err(Wrong { field: "height_map.file", value: "empty".to_owned(), expected });
        }
        if (1e-4..=MAX_HEIGHT_UM).contains(white_um) && is_glass(*cauchy) {
            return Ok(());
        }
        Err(Wrong {
            field: "height_map",
            value: format!("{} um of {}", number(*white_um), numbers(cauchy)),
            expected: "more than 0: 0.0001 to 100 um, in glass of [0.1 to 10, -10 to 10]",
        })
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::None
    }

    fn phase_at(&self, nm: f64) -> Function<'_, f64> {
        let white_rad = etched_rad(self.white_um, self.cauchy, nm);
        Box::new(move |at| self.at(at.x, at.y) * white_rad)
    }

    fn slope_at(&self, _: f64) -> Function<'_, [f64; 2]> {
        Box::new(|_| [0.0; 2])
    }

    /// None: differences of a picture's pixels are steps of its grey values rather than slopes.
    fn largest_slope(&self, _: f64) -> Option<f64> {
        None
    }

    fn scale(&mut self, factor: f64) {
        self.white_um *= factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::mask::phase::Place;

    fn read(heights: Array2<f32>) -> Result<HeightMap, String> {
        let cauchy = [1.5, 0.0];
        let mut map =
            HeightMap { file: "m.png".into(), white_um: 0.5, cauchy, sha256: String::new(), heights: None };
        map.take(heights, "m.png".into(), "mine").map_err(|e| e.to_string())?;
        Ok(map)
    }

    #[test]
    fn heights_are_linear_between_pixels_and_end_where_the_aperture_does() {
        let map = read(Array2::from_shape_fn((4, 4), |(r, c)| (0.05 * r as f32) + 0.2 * c as f32)).unwrap();
        for (right, up, expected) in [
            (-0.75, 0.75, 0.0),
            (0.75, 0.75, 0.6),
            (-0.75, -0.75, 0.15),
            (0.0, 0.0, 0.375),
            (0.5, 0.75, 0.5),
            (1.0, 1.0, 0.6),
        ] {
            assert!((map.at(right, up) - expected).abs() < 1e-6, "{right} {up}: {}", map.at(right, up));
        }
        // 0.5 um of glass of index 1.5 are half a wave of 500 nm.
        let share = map.at(0.0, 0.0);
        let rad = map.phase_at(500.0)(Place::new(0.0, 0.0));
        assert!((rad - share * std::f64::consts::PI).abs() < 1e-9);
    }

    #[test]
    fn a_picture_of_another_shape_or_content_is_rejected() {
        assert_eq!(
            read(Array2::zeros((4, 6))).unwrap_err(),
            "m.png: 6x4, expected a square height map of 2 to 4096 pixels a side"
        );
        assert!(read(Array2::zeros((1, 1))).is_err());
        let mut map = read(Array2::zeros((2, 2))).unwrap();
        assert_eq!(map.clone(), map);
        let error = map.take(Array2::ones((2, 2)), "m.png".into(), "mine").unwrap_err().to_string();
        assert!(
            error.starts_with("m.png: its heights have the SHA-256 ") && error.contains("camera mine states"),
            "{error}"
        );
        assert_ne!(read(Array2::ones((2, 2))).unwrap(), map);
    }
}
