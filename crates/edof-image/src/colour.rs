//! BT.709 Y′CbCr and the 4:2:2 layout of a patch.
//!
//! A colour patch is 192 numbers: 64 red, 64 green, 64 blue, each row by row. In 4:2:2 it is 128: 64 luma, 32 Cb, 32 Cr,
//! the chroma of each row at its four even columns (co-sited, as in the HDMI stream).

use crate::frame::{ColourFrame, Frame422};
use crate::geometry::{PATCH, PATCH_PIXELS};
use crate::number::{CHROMA_GAIN, OUTPUT_FRACTION, saturate};
use ndarray::{Array1, Array2, Array3};

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
    let (height, width) = frame.luma.dim();
    let mut planes = Array3::zeros((3, height, width));
    let chroma = |plane: usize, row: usize, site: usize| {
        f64::from(frame.chroma[plane][(row, site)]) / (CHROMA_GAIN * f64::from(1 << OUTPUT_FRACTION))
    };
    for row in 0..height {
        for column in 0..width {
            let site = column / 2;
            let next = if column % 2 == 0 { site } else { (site + 1).min(width / 2 - 1) };
            let [cb, cr] = [0, 1].map(|p| 0.5 * (chroma(p, row, site) + chroma(p, row, next)));
            let luma = f64::from(frame.luma[(row, column)]) / f64::from(1 << OUTPUT_FRACTION);
            for (plane, value) in rgb_from_ycbcr(luma, cb, cr).into_iter().enumerate() {
                planes[(plane, row, column)] = value as f32;
            }
        }
    }
    ColourFrame { planes }
}

/// The luma word for a luma of `luma` (1.0 = white).
#[must_use]
pub fn luma_word(luma: f64) -> i16 {
    saturate((luma * f64::from(1 << OUTPUT_FRACTION) + 0.5).floor() as i64, 16).0
}

/// The chroma word for a colour difference of −0.5…0.5.
#[must_use]
pub fn chroma_word(difference: f64) -> i16 {
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
