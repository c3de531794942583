//! Other looks of the same photograph: more or less saturated, turned in hue, reduced. They are made before the blur, because the
//! blur differs by colour.

use edof_core::ColourFrame;
use edof_numerics::random::Random;
use ndarray::Array3;
use serde::{Deserialize, Serialize};

/// Range of the random looks. The first picture of a photograph is always the photograph itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Augmentation {
    /// Pictures of each photograph, itself among them; at least 1.
    pub variants: usize,
    /// Saturation, least and most; 1 changes nothing, 0 leaves grey.
    pub saturation: [f32; 2],
    /// Hue is turned by up to N degrees either way.
    pub hue: f32,
    /// The smallest copy, as a share of the photograph's sides; 1 reduces nothing.
    pub scale: f32,
}

impl Augmentation {
    /// The photographs as they are.
    pub const NONE: Self = Self { variants: 1, saturation: [1.0; 2], hue: 0.0, scale: 1.0 };

    /// The look of picture `variant` of a photograph; the same in every run, whatever its seed.
    #[must_use]
    pub fn look(&self, photo: usize, variant: usize) -> Look {
        if variant == 0 {
            return Look { saturation: 1.0, hue: 0.0, scale: 1.0 };
        }
        let mut random = Random::new(0x100C, photo as u64, variant as u64);
        Look {
            saturation: random.between(self.saturation),
            hue: random.between([-self.hue, self.hue]),
            scale: random.between([self.scale, 1.0]),
        }
    }
}

/// What one picture of a photograph looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Distance from grey, as a multiple of the photograph's.
    pub saturation: f32,
    /// Degrees that hue is turned by.
    pub hue: f32,
    /// Sides, as a share of the photograph's.
    pub scale: f32,
}

impl Look {
    /// The photograph with this look; light in, light out, sides even, 0…1.
    #[must_use]
    pub fn of(&self, photo: &ColourFrame) -> ColourFrame {
        let mut frame = if self.scale < 1.0 { reduce(photo, self.scale) } else { photo.clone() };
        if self.saturation == 1.0 && self.hue == 0.0 {
            return frame;
        }
        let mix = self.mix();
        let (_, height, width) = frame.planes.dim();
        for row in 0..height {
            for column in 0..width {
                let rgb = [0, 1, 2].map(|c| frame.planes[(c, row, column)]);
                for (plane, weights) in mix.iter().enumerate() {
                    let value: f32 = weights.iter().zip(rgb).map(|(w, v)| w * v).sum();
                    frame.planes[(plane, row, column)] = value.clamp(0.0, 1.0);
                }
            }
        }
        frame
    }

    /// Turns colours about the grey axis and stretches their distance from it; grey stays as it is.
    fn mix(&self) -> [[f32; 3]; 3] {
        let angle = f64::from(self.hue).to_radians();
        let (along, across) = (angle.cos(), angle.sin() / 3f64.sqrt());
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                let third = 1.0 / 3.0;
                let kept = if r == c { 1.0 - third } else { -third };
                let turned = match (c + 3 - r) % 3 {
                    0 => 0.0,
                    1 => -across,
                    _ => across,
                };
                (third + f64::from(self.saturation) * (along * kept + turned)) as f32
            })
        })
    }
}

/// A copy whose sides are about `scale` of the photograph's: each pixel is the mean of the area that it covers.
fn reduce(photo: &ColourFrame, scale: f32) -> ColourFrame {
    let (height, width) = photo.size();
    let shorter = |side: usize| ((side as f32 * scale) as usize).max(2) & !1;
    let (rows, columns) = (coverage(height, shorter(height)), coverage(width, shorter(width)));
    let mean = |weights: &(usize, Vec<f32>), at: &dyn Fn(usize) -> f32| {
        weights.1.iter().enumerate().map(|(i, w)| w * at(weights.0 + i)).sum::<f32>()
    };
    let narrow = Array3::from_shape_fn((3, height, columns.len()), |(plane, r, c)| {
        mean(&columns[c], &|column| photo.planes[(plane, r, column)])
    });
    let planes = Array3::from_shape_fn((3, rows.len(), columns.len()), |(plane, r, c)| {
        mean(&rows[r], &|row| narrow[(plane, row, c)])
    });
    ColourFrame { planes }
}

/// For each of `few` equal parts of a line of `many` pixels: the first pixel that it covers, and the shares of it that are covered
/// pixel by pixel.
fn coverage(many: usize, few: usize) -> Vec<(usize, Vec<f32>)> {
    // In units of 1/few of a pixel a part is `many` long and begins at a multiple of it: nothing is rounded.
    (0..few)
        .map(|i| {
            let (from, to) = (i * many, (i + 1) * many);
            let pixels = from / few..to.div_ceil(few);
            let share =
                |pixel: usize| (to.min((pixel + 1) * few) - from.max(pixel * few)) as f32 / many as f32;
            (pixels.start, pixels.map(share).collect())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn photo(height: usize, width: usize) -> ColourFrame {
        ColourFrame {
            planes: Array3::from_shape_fn((3, height, width), |(p, r, c)| {
                0.3 + 0.1 * ((p * 7 + r * 3 + c * 5) % 5) as f32
            }),
        }
    }

    proptest! {
        #[test]
        fn turning_hue_keeps_grey_and_the_distance_from_it(hue in -180f32..180.0, saturation in 0.0f32..2.0, rgb in prop::array::uniform3(0.0f32..1.0)) {
            let mix = Look { saturation, hue, scale: 1.0 }.mix();
            let out = mix.map(|w| w.iter().zip(rgb).map(|(w, v)| w * v).sum::<f32>());
            let mean = |v: [f32; 3]| v.iter().sum::<f32>() / 3.0;
            let distance = |v: [f32; 3]| v.iter().map(|x| (x - mean(v)).powi(2)).sum::<f32>().sqrt();
            prop_assert!((mean(out) - mean(rgb)).abs() < 1e-5);
            prop_assert!((distance(out) - saturation * distance(rgb)).abs() < 1e-4);
        }

        #[test]
        fn reducing_keeps_the_mean_light_and_gives_even_sides(height in 20usize..60, width in 20usize..60, scale in 0.3f32..1.0) {
            let (whole, small) = (photo(height, width), reduce(&photo(height, width), scale));
            let mean = |f: &ColourFrame| f.planes.mean().unwrap();
            prop_assert!((mean(&whole) - mean(&small)).abs() < 1e-4);
            let (h, w) = small.size();
            prop_assert!(h % 2 == 0 && w % 2 == 0 && h <= height && (h as f32) > height as f32 * scale - 2.1);
        }
    }

    #[test]
    fn a_third_of_a_turn_moves_red_to_another_colour_and_all_of_one_brings_it_back() {
        let turned = |hue| Look { saturation: 1.0, hue, scale: 1.0 }.mix().map(|w| w[0]);
        let [third, whole] = [turned(120.0), turned(360.0)];
        assert!(third[0].abs() < 1e-6 && (third[1] - 1.0).abs() < 1e-6 && third[2].abs() < 1e-6, "{third:?}");
        assert!((whole[0] - 1.0).abs() < 1e-6 && whole[1].abs() < 1e-6);
    }

    #[test]
    fn the_first_picture_is_the_photograph_and_the_others_differ_from_each_other() {
        let all = Augmentation { variants: 3, saturation: [0.5, 1.5], hue: 30.0, scale: 0.5 };
        let photo = photo(24, 32);
        assert_eq!(all.look(5, 0).of(&photo), photo);
        assert_ne!(all.look(5, 1), all.look(5, 2));
        assert_ne!(all.look(5, 1), all.look(6, 1));
        assert_eq!(Augmentation::NONE.look(5, 1).of(&photo), photo);
    }
}
