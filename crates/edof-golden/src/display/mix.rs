//! A display step in the colours of a screen: white balance, then a colour matrix. The board has none; a program that shows a sensor's own
//! colours does.

use super::{DisplayCounts, Picture, colour, each_line};
use crate::fast::isa::{Isa, for_each_isa};
use crate::frame::GoldenFrame;
use crate::gamma::{COLOUR_ENTRIES, ColourTable, Curve, light};
use edof_core::Tone;
use edof_core::number::bits_of_mut;

/// Fraction bits of a matrix's coefficients.
const FRACTION: u32 = 14;

/// White balance and colour matrix between the network's words and the codes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mix {
    /// Balanced light of red, green and blue, full at the last entry, for each value.
    balanced: [Vec<i32>; 3],
    /// Rows are red, green and blue of the screen.
    rows: [[i32; 3]; 3],
    encoded: ColourTable,
}

impl Mix {
    /// Mixes colours of values: light times gains, no more than full, then the rows of the matrix.
    #[must_use]
    pub fn new(values: Tone, curve: Curve, gains: [f64; 3], rows: [[f64; 3]; 3]) -> Self {
        const LAST: f64 = (COLOUR_ENTRIES - 1) as f64;
        let balanced = |gain: f64| {
            let of = |entry: usize| (gain * light(values, entry as f64 / LAST)).min(1.0);
            (0..COLOUR_ENTRIES).map(|entry| (LAST * of(entry)).round() as i32).collect()
        };
        Self {
            balanced: gains.map(balanced),
            rows: rows.map(|row| row.map(|weight| (weight * f64::from(1 << FRACTION)).round() as i32)),
            encoded: ColourTable::new(curve),
        }
    }

    /// Makes the codes of a frame, as large as the raw frame, in the memory of another picture.
    pub fn picture_into(&self, frame: &GoldenFrame, picture: &mut Picture) -> DisplayCounts {
        let isa = Isa::best();
        each_line(&frame.frame, frame.offset, frame.size, picture, |words, codes, buffers| {
            colour(isa, words, codes, buffers, |light| {
                let [red, green, blue] = light.each_mut().map(|plane| bits_of_mut(plane));
                mixed(isa, self, red, green, blue);
                light.iter_mut().for_each(|plane| self.encoded.encode(plane));
            })
        })
    }
}

for_each_isa! {
    /// Puts a line's mixed colours in the place of its own.
    fn mixed(mix: &Mix, red: &mut [u16], green: &mut [u16], blue: &mut [u16]) -> () {
        let balanced = mix.balanced.each_ref().map(Vec::as_slice);
        for ((red, green), blue) in red.iter_mut().zip(green).zip(blue) {
            let light = [
                balanced[0][usize::from(*red)],
                balanced[1][usize::from(*green)],
                balanced[2][usize::from(*blue)],
            ];
            let [r, g, b] = mix.rows.map(|row| {
                let sum = i64::from(row[0]) * i64::from(light[0]) + i64::from(row[1]) * i64::from(light[1])
                    + i64::from(row[2]) * i64::from(light[2]);
                ((sum + (1 << (FRACTION - 1))) >> FRACTION).clamp(0, COLOUR_ENTRIES as i64 - 1) as u16
            });
            (*red, *green, *blue) = (r, g, b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Display;
    use edof_core::DisplayMode;
    use edof_core::number::OutputWord;

    const NONE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn frame() -> GoldenFrame {
        let network = edof_device::random::natural(12, 8, 3);
        let values = ndarray::Array2::from_shape_fn((32, 48), |(r, c)| ((r * 997 + c * 131) % 4096) as u16);
        let raw = edof_core::RawFrame::from_values(values, 12, edof_core::CfaPhase::Rggb).unwrap();
        crate::Golden::new(network).unwrap().frame(&raw).unwrap()
    }

    fn codes(make: impl Fn(&mut Picture) -> DisplayCounts) -> Picture {
        let mut picture = Picture::empty();
        make(&mut picture);
        picture
    }

    fn most(a: &Picture, b: &Picture) -> u8 {
        let planes =
            |picture: &Picture| [&picture.luma, &picture.chroma[0], &picture.chroma[1]].map(Clone::clone);
        let differences = |(a, b): (ndarray::Array2<u8>, ndarray::Array2<u8>)| {
            a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
        };
        planes(a).into_iter().zip(planes(b)).map(differences).max().unwrap()
    }

    #[test]
    fn no_matrix_and_no_gain_are_the_display() {
        let frame = frame();
        for (values, curve) in
            [(Tone::Linear, Curve::Srgb), (Tone::Linear, Curve::Linear), (Tone::Srgb, Curve::Srgb)]
        {
            let display = Display::of_values(values, DisplayMode::Colour, curve);
            let own = codes(|picture| frame.picture_into(&display, picture));
            let mixed =
                codes(|picture| Mix::new(values, curve, [1.0; 3], NONE).picture_into(&frame, picture));
            assert!(most(&own, &mixed) <= 1, "{values:?} {curve:?}: {}", most(&own, &mixed));
        }
    }

    #[test]
    fn gains_alone_are_those_of_the_tables() {
        let (frame, gains) = (frame(), [2.0, 1.0, 1.5]);
        let display = Display::balanced(Tone::Linear, Curve::Srgb, gains);
        let own = codes(|picture| frame.picture_into(&display, picture));
        let mixed =
            codes(|picture| Mix::new(Tone::Linear, Curve::Srgb, gains, NONE).picture_into(&frame, picture));
        assert!(most(&own, &mixed) <= 1);
    }

    #[test]
    fn a_matrix_that_exchanges_colours_exchanges_them() {
        let mut frame = frame();
        // A flat colour, more red than blue.
        frame.frame.luma.fill(OutputWord::lit("0.3"));
        frame.frame.chroma[0].fill(OutputWord::lit("-0.05"));
        frame.frame.chroma[1].fill(OutputWord::lit("0.08"));
        let shown = |rows| {
            let mix = Mix::new(Tone::Linear, Curve::Srgb, [1.0; 3], rows);
            let planes = codes(|picture| mix.picture_into(&frame, picture)).shown();
            [0, 1, 2].map(|plane| planes[(plane, 8, 8)])
        };
        let ([red, green, blue], exchanged) = (shown(NONE), shown([NONE[2], NONE[1], NONE[0]]));
        assert!(red > blue + 20, "{red} {blue}");
        let is_near = |(a, b): (u8, u8)| a.abs_diff(b) <= 2;
        assert!(exchanged.into_iter().zip([blue, green, red]).all(is_near), "{exchanged:?}");
    }
}
