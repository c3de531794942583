//! BT.709 Y′CbCr and the 4:2:2 layout of a patch.
//!
//! A colour patch is 192 numbers: 64 red, 64 green, 64 blue, each row by row. In 4:2:2 it is 128: 64 luma, 32 Cb, 32 Cr,
//! the chroma of each row at its four even columns (co-sited, as in the HDMI stream).

use crate::frame::{ColourFrame, Frame422};
use crate::geometry::{PATCH, PATCH_PIXELS};
use crate::number::{CHROMA_GAIN, OUTPUT_FRACTION, OutputWord, output_value};
use ndarray::{Array1, Array2, Axis, s};

/// Numbers in an RGB patch.
pub const RGB_OUTPUTS: usize = 3 * PATCH_PIXELS;
/// Numbers in a 4:2:2 patch.
pub const OUTPUTS_422: usize = 2 * PATCH_PIXELS;
/// BT.709 luma weights of red, green and blue.
pub const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Rows: luma, Cb, Cr (each −0.5…0.5); columns: red, green, blue.
#[must_use]
pub fn ycbcr_matrix() -> [[f64; 3]; 3] {
    let difference = |plane: usize| {
        let scale = 2.0 * (1.0 - LUMA[plane]);
        std::array::from_fn(|i| (f64::from(u8::from(i == plane)) - LUMA[i]) / scale)
    };
    [LUMA, difference(2), difference(0)]
}

/// Red, green and blue from luma, Cb and Cr: the inverse of [`ycbcr_matrix`].
#[must_use]
pub fn rgb_from_ycbcr(luma: f64, cb: f64, cr: f64) -> [f64; 3] {
    let red = luma + 2.0 * (1.0 - LUMA[0]) * cr;
    let blue = luma + 2.0 * (1.0 - LUMA[2]) * cb;
    [red, (luma - LUMA[0] * red - LUMA[2] * blue) / LUMA[1], blue]
}

/// The 128×192 map from an RGB patch to a 4:2:2 patch. Chroma is filtered [1 2 1]/4 along the row and taken at even columns;
/// before column 0 the patch is mirrored.
#[must_use]
pub fn patch_422_from_rgb() -> Array2<f64> {
    let [luma, cb, cr] = ycbcr_matrix();
    let mut map = Array2::zeros((OUTPUTS_422, RGB_OUTPUTS));
    for plane in 0..3 {
        for pixel in 0..PATCH_PIXELS {
            map[(pixel, plane * PATCH_PIXELS + pixel)] = luma[plane];
        }
        for (first_output, weights) in [(PATCH_PIXELS, cb), (PATCH_PIXELS * 3 / 2, cr)] {
            for row in 0..PATCH {
                for site in 0..PATCH / 2 {
                    let output = first_output + row * PATCH / 2 + site;
                    for (offset, tap) in [(-1isize, 0.25), (0, 0.5), (1, 0.25)] {
                        let column = (2 * site as isize + offset).unsigned_abs();
                        map[(output, plane * PATCH_PIXELS + row * PATCH + column)] += tap * weights[plane];
                    }
                }
            }
        }
    }
    map
}

/// Red, green and blue of a 4:2:2 frame: chroma between sites is the mean of its neighbours, at the last column its
/// neighbour.
#[must_use]
pub fn rgb_from_422(frame: &Frame422) -> ColourFrame {
    rgb_part_from_422(frame, (0, 0), frame.luma.dim())
}

/// The part of [`rgb_from_422`] that starts at the row and column of `first` and has the rows and columns of `size`. Each sample is written once.
///
/// # Panics
/// For a part that does not lie in the frame.
#[must_use]
pub fn rgb_part_from_422(frame: &Frame422, first: (usize, usize), size: (usize, usize)) -> ColourFrame {
    let last_site = frame.luma.ncols() / 2 - 1;
    let difference = |word: OutputWord| output_value(word) / CHROMA_GAIN;
    let mut part = ColourFrame::zeros(size.0, size.1);
    for (mut out, row) in part.planes.axis_iter_mut(Axis(1)).zip(first.0..) {
        let luma = frame.luma.slice(s![row, first.1..first.1 + size.1]);
        let chroma = frame.chroma.each_ref().map(|plane| plane.row(row));
        for ((mut rgb, luma), column) in out.lanes_mut(Axis(0)).into_iter().zip(luma).zip(first.1..) {
            let (site, next) = (column / 2, column.div_ceil(2).min(last_site));
            let [cb, cr] =
                [0, 1].map(|plane| 0.5 * (difference(chroma[plane][site]) + difference(chroma[plane][next])));
            for (out, value) in rgb.iter_mut().zip(rgb_from_ycbcr(output_value(*luma), cb, cr)) {
                *out = value as f32;
            }
        }
    }
    part
}

/// Returns the word nearest to a luma (1.0 = white), ties toward +∞, saturated.
#[must_use]
pub fn luma_word(luma: f64) -> OutputWord {
    // `fixed` would round ties of a float to even.
    OutputWord::from_bits((luma * f64::from(1 << OUTPUT_FRACTION) + 0.5).floor() as i16)
}

/// The chroma word for a colour difference of −0.5…0.5.
#[must_use]
pub fn chroma_word(difference: f64) -> OutputWord {
    luma_word(CHROMA_GAIN * difference)
}

/// sRGB's transfer curve: encoded light (0…1) for linear light (0…1).
#[must_use]
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Inverse of [`srgb_encode`].
#[must_use]
pub fn srgb_decode(code: f64) -> f64 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// A grey patch of the given level, for tests and examples.
#[must_use]
pub fn grey_patch(level: f64) -> Array1<f64> {
    Array1::from_elem(RGB_OUTPUTS, level)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_grey_patch_has_luma_and_no_chroma() {
        let out = patch_422_from_rgb().dot(&grey_patch(0.5));
        assert!(out.iter().take(64).all(|v| (v - 0.5).abs() < 1e-12));
        assert!(out.iter().skip(64).all(|v| v.abs() < 1e-12));
    }

    #[test]
    fn a_part_is_the_frames_to_the_last_bit() {
        let word = |scale: usize| {
            move |(row, column): (usize, usize)| OutputWord::from_bits((row * 977 + column * scale) as i16)
        };
        let frame = Frame422 {
            luma: Array2::from_shape_fn((6, 8), word(4111)),
            chroma: [2503, 7919].map(|scale| Array2::from_shape_fn((6, 4), word(scale))),
        };
        let whole = rgb_from_422(&frame);
        for (first, size) in [((0, 0), (6, 8)), ((1, 1), (5, 7)), ((0, 1), (4, 6)), ((5, 7), (1, 1))] {
            assert_eq!(rgb_part_from_422(&frame, first, size), whole.crop(first.0, first.1, size.0, size.1));
        }
    }

    #[test]
    fn an_even_colour_survives_a_422_frame_to_a_word() {
        let (y, cb, cr) = (0.4, 0.11, -0.07);
        let frame = Frame422 {
            luma: Array2::from_elem((8, 8), luma_word(y)),
            chroma: [cb, cr].map(|c| Array2::from_elem((8, 4), chroma_word(c))),
        };
        let rgb = rgb_from_422(&frame);
        for (plane, exact) in rgb_from_ycbcr(y, cb, cr).into_iter().enumerate() {
            assert!(
                (f64::from(rgb.planes[(plane, 3, 5)]) - exact).abs() < 2.0 / f64::from(1 << OUTPUT_FRACTION)
            );
        }
    }

    proptest! {
        #[test]
        fn colour_spaces_invert(rgb in prop::array::uniform3(0.0f64..1.0)) {
            let m = ycbcr_matrix().map(|row| row.iter().zip(rgb).map(|(a, b)| a * b).sum::<f64>());
            let back = rgb_from_ycbcr(m[0], m[1], m[2]);
            for (a, b) in back.into_iter().zip(rgb) { prop_assert!((a - b).abs() < 1e-12); }
        }

        #[test]
        fn srgb_inverts(v in 0.0f64..1.0) {
            prop_assert!((srgb_decode(srgb_encode(v)) - v).abs() < 1e-6);
        }
    }
}
