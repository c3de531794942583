//! What a camera's file asks to be done with the picture that is made of its frame: corrections in the sensor's colours, and at the end its
//! crop and orientation.

use crate::dng::Opcodes;
use edof_image::ColourFrame;
use ndarray::{Axis, s};

/// How a camera was held, as Exif counts it: the picture's first row and column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Orientation {
    /// 1: top, left.
    #[default]
    Upright,
    /// 2: top, right.
    Mirrored,
    /// 3: bottom, right.
    UpsideDown,
    /// 4: bottom, left.
    MirroredUpsideDown,
    /// 5: left, top.
    Transposed,
    /// 6: right, top.
    Clockwise,
    /// 7: right, bottom.
    Transversed,
    /// 8: left, bottom.
    Counterclockwise,
}

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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Finish {
    /// Corrections of the picture in the sensor's colours, before its white balance.
    pub corrections: Option<Opcodes>,
    /// The part of the picture that is kept.
    pub crop: Option<Crop>,
    /// How the picture is turned.
    pub orientation: Orientation,
}

impl Orientation {
    /// Of Exif's number, 1 to 8.
    #[must_use]
    pub fn of(number: usize) -> Option<Self> {
        const ALL: [Orientation; 8] = [
            Orientation::Upright,
            Orientation::Mirrored,
            Orientation::UpsideDown,
            Orientation::MirroredUpsideDown,
            Orientation::Transposed,
            Orientation::Clockwise,
            Orientation::Transversed,
            Orientation::Counterclockwise,
        ];
        number.checked_sub(1).and_then(|index| ALL.get(index)).copied()
    }

    /// Whether rows become columns, and whether the result's rows and columns are reversed.
    const fn steps(self) -> (bool, bool, bool) {
        match self {
            Self::Upright => (false, false, false),
            Self::Mirrored => (false, false, true),
            Self::UpsideDown => (false, true, true),
            Self::MirroredUpsideDown => (false, true, false),
            Self::Transposed => (true, false, false),
            Self::Clockwise => (true, false, true),
            Self::Transversed => (true, true, true),
            Self::Counterclockwise => (true, true, false),
        }
    }
}

impl Finish {
    /// Whether the picture stays as it is.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        self == &Self::default()
    }

    /// Corrects a picture in the sensor's colours.
    pub fn correct(&self, picture: &mut ColourFrame) {
        if let Some(corrections) = &self.corrections {
            corrections.correct_picture(picture);
        }
    }

    /// Crops and turns a picture.
    #[must_use]
    pub fn frame(&self, picture: ColourFrame) -> ColourFrame {
        let (transposed, rows, columns) = self.orientation.steps();
        let mut planes = picture.planes.view();
        if let Some(Crop { top, left, height, width }) = self.crop {
            planes = planes.slice_move(s![.., top..top + height, left..left + width]);
        }
        if transposed {
            planes.swap_axes(1, 2);
        }
        if rows {
            planes.invert_axis(Axis(1));
        }
        if columns {
            planes.invert_axis(Axis(2));
        }
        ColourFrame { planes: planes.as_standard_layout().into_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;

    /// Rows and columns of a picture of 2 × 3 pixels, 0 1 2 above 3 4 5, once it is finished.
    fn finished(orientation: Orientation, crop: Option<Crop>) -> Vec<Vec<f32>> {
        let planes = Array3::from_shape_fn((3, 2, 3), |(_, r, c)| (3 * r + c) as f32);
        let finish = Finish { crop, orientation, ..Finish::default() };
        let picture = finish.frame(ColourFrame { planes });
        picture.planes.index_axis(Axis(0), 2).outer_iter().map(|row| row.to_vec()).collect()
    }

    #[test]
    fn every_orientation_is_that_of_exif() {
        // As Pillow's ImageOps.exif_transpose has them.
        let expected: [&[&[f32]]; 8] = [
            &[&[0., 1., 2.], &[3., 4., 5.]],
            &[&[2., 1., 0.], &[5., 4., 3.]],
            &[&[5., 4., 3.], &[2., 1., 0.]],
            &[&[3., 4., 5.], &[0., 1., 2.]],
            &[&[0., 3.], &[1., 4.], &[2., 5.]],
            &[&[3., 0.], &[4., 1.], &[5., 2.]],
            &[&[5., 2.], &[4., 1.], &[3., 0.]],
            &[&[2., 5.], &[1., 4.], &[0., 3.]],
        ];
        for (number, expected) in (1..).zip(expected) {
            assert_eq!(finished(Orientation::of(number).unwrap(), None), expected, "{number}");
        }
        assert_eq!([Orientation::of(0), Orientation::of(9)], [None, None]);
    }

    #[test]
    fn a_crop_comes_before_the_turn() {
        let crop = Crop { top: 0, left: 1, height: 2, width: 2 };
        assert_eq!(finished(Orientation::Clockwise, Some(crop)), [[4., 1.], [5., 2.]]);
    }
}
