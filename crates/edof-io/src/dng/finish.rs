//! What a camera's file asks to be done with the picture that is made of its frame: corrections in the sensor's colours, and at the end its
//! crop and orientation.

use super::opcodes::Opcodes;
use crate::orientation::{Orientation, turned};
use edof_core::ColourFrame;

/// A part of a frame: first row, first column, rows, columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// First row.
    pub top: usize,
    /// First column.
    pub left: usize,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
}

/// All of it. The default changes nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Finish {
    /// Corrections of the picture in the sensor's colours, before its white balance.
    pub corrections: Option<Opcodes>,
    /// The part of the picture that is kept.
    pub crop: Option<Crop>,
    /// How the picture is turned.
    pub orientation: Orientation,
}

impl Default for Finish {
    fn default() -> Self {
        Self { corrections: None, crop: None, orientation: Orientation::NoTransforms }
    }
}

impl Finish {
    /// Corrects a picture in the sensor's colours.
    pub fn correct(&self, picture: &mut ColourFrame) {
        if let Some(corrections) = &self.corrections {
            corrections.correct_picture(picture);
        }
    }

    /// Crops and turns a picture.
    #[must_use]
    pub fn frame(&self, picture: ColourFrame) -> ColourFrame {
        let picture = match self.crop {
            Some(Crop { top, left, height, width }) => picture.crop(top, left, height, width),
            None => picture,
        };
        ColourFrame { planes: turned(picture.planes, self.orientation) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;

    #[test]
    fn a_crop_comes_before_the_turn() {
        let planes = Array3::from_shape_fn((3, 2, 3), |(_, r, c)| (3 * r + c) as f32);
        let crop = Some(Crop { top: 0, left: 1, height: 2, width: 2 });
        let finish = Finish { crop, orientation: Orientation::Rotate90, ..Finish::default() };
        let picture = finish.frame(ColourFrame { planes });
        assert_eq!(picture.planes.index_axis(ndarray::Axis(0), 2), ndarray::array![[4., 1.], [5., 2.]]);
    }
}
