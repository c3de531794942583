//! How a camera was held, as Exif counts it, and pictures turned accordingly.

pub use image::metadata::Orientation;
use ndarray::{Array3, Axis};

/// Turns planes (plane × rows × columns) as their camera was held.
#[must_use]
pub fn turned<T: Clone>(planes: Array3<T>, orientation: Orientation) -> Array3<T> {
    let (is_transposed, flips_rows, flips_columns) = match orientation {
        Orientation::NoTransforms => return planes,
        Orientation::FlipHorizontal => (false, false, true),
        Orientation::Rotate180 => (false, true, true),
        Orientation::FlipVertical => (false, true, false),
        Orientation::Rotate90FlipH => (true, false, false),
        Orientation::Rotate90 => (true, false, true),
        Orientation::Rotate270FlipH => (true, true, true),
        Orientation::Rotate270 => (true, true, false),
    };
    let mut view = planes.view();
    if is_transposed {
        view.swap_axes(1, 2);
    }
    for (axis, is_flipped) in [(1, flips_rows), (2, flips_columns)] {
        if is_flipped {
            view.invert_axis(Axis(axis));
        }
    }
    view.as_standard_layout().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a picture of 2 × 3 pixels, 0 1 2 above 3 4 5, once it is turned.
    fn rows(orientation: Orientation) -> Vec<Vec<u8>> {
        let planes = Array3::from_shape_fn((1, 2, 3), |(_, r, c)| (3 * r + c) as u8);
        turned(planes, orientation).index_axis(Axis(0), 0).outer_iter().map(|row| row.to_vec()).collect()
    }

    #[test]
    fn every_orientation_is_that_of_exif() {
        // As Pillow's ImageOps.exif_transpose has them.
        let expected: [&[&[u8]]; 8] = [
            &[&[0, 1, 2], &[3, 4, 5]],
            &[&[2, 1, 0], &[5, 4, 3]],
            &[&[5, 4, 3], &[2, 1, 0]],
            &[&[3, 4, 5], &[0, 1, 2]],
            &[&[0, 3], &[1, 4], &[2, 5]],
            &[&[3, 0], &[4, 1], &[5, 2]],
            &[&[5, 2], &[4, 1], &[3, 0]],
            &[&[2, 5], &[1, 4], &[0, 3]],
        ];
        for (number, expected) in (1..).zip(expected) {
            assert_eq!(rows(Orientation::from_exif(number).unwrap()), expected, "{number}");
        }
    }
}
