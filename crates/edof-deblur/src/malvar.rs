//! Gradient-corrected linear demosaicing: H. S. Malvar, L. He, R. Cutler, "High-quality linear interpolation for
//! demosaicing of Bayer-patterned color images", ICASSP 2004, figure 2.
//!
//! A missing colour is the mean of its neighbours, corrected by the Laplacian of the colour that was measured at the pixel;
//! both together are one 5×5 filter. Borders are mirrored about the edge pixel, which keeps the Bayer phase.

use edof_core::geometry::{GeometryError, mirror};
use edof_core::{CfaPhase, Channel, ColourFrame, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use ndarray::Array2;
use std::time::Instant;

/// Taps of a 5×5 filter, row by row.
pub type Taps = [[f32; 5]; 5];

/// Side that a mirrored border of two pixels needs at least.
const MIN_SIDE: usize = 4;
/// Pixels that a filter reaches beyond its centre.
const REACH: usize = 2;

/// Green at a red or blue pixel.
pub const GREEN_AT_COLOUR: Taps = eighths([
    [0.0, 0.0, -1.0, 0.0, 0.0],
    [0.0, 0.0, 2.0, 0.0, 0.0],
    [-1.0, 2.0, 4.0, 2.0, -1.0],
    [0.0, 0.0, 2.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0, 0.0],
]);

/// Red (blue) at a green pixel whose neighbours in the row are red (blue).
pub const COLOUR_AT_GREEN_IN_ITS_ROW: Taps = eighths([
    [0.0, 0.0, 0.5, 0.0, 0.0],
    [0.0, -1.0, 0.0, -1.0, 0.0],
    [-1.0, 4.0, 5.0, 4.0, -1.0],
    [0.0, -1.0, 0.0, -1.0, 0.0],
    [0.0, 0.0, 0.5, 0.0, 0.0],
]);

/// Red (blue) at a green pixel whose neighbours in the column are red (blue).
pub const COLOUR_AT_GREEN_IN_ITS_COLUMN: Taps = transpose(COLOUR_AT_GREEN_IN_ITS_ROW);

/// Red at a blue pixel, blue at a red one.
pub const COLOUR_AT_OTHER_COLOUR: Taps = eighths([
    [0.0, 0.0, -1.5, 0.0, 0.0],
    [0.0, 2.0, 0.0, 2.0, 0.0],
    [-1.5, 0.0, 6.0, 0.0, -1.5],
    [0.0, 2.0, 0.0, 2.0, 0.0],
    [0.0, 0.0, -1.5, 0.0, 0.0],
]);

/// The method as it enters studies.
#[derive(Debug, Clone)]
pub struct Malvar {
    name: String,
}

impl Default for Malvar {
    fn default() -> Self {
        Self::named("demosaic-malvar")
    }
}

impl Malvar {
    /// The same method under another name, where a study runs it on several cameras.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into() }
    }
}

impl Reconstructor for Malvar {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let (height, width) = raw.size();
        if height < MIN_SIDE || width < MIN_SIDE {
            let window = 2 * REACH + 1;
            return Err(GeometryError::SmallFrame { height, width, min: MIN_SIDE, window }.into());
        }
        let start = Instant::now();
        let frame = demosaic(raw);
        let seconds = start.elapsed().as_secs_f64();
        Ok(Reconstruction { frame, seconds, multiplications: None, counters: None, iterations: None })
    }
}

/// All three colours at every pixel; a colour that was measured stays as it is. Values may overshoot 0…1 at edges.
fn demosaic(raw: &RawFrame) -> ColourFrame {
    let (height, width) = raw.size();
    let light = mirrored_light(raw);
    let mut frame = ColourFrame::zeros(height, width);
    for row in 0..height {
        for column in 0..width {
            for channel in Channel::ALL {
                frame.planes[(channel.plane(), row, column)] = match taps(raw.phase(), row, column, channel) {
                    Some(taps) => filter(&light, row, column, taps),
                    None => light[(row + REACH, column + REACH)],
                };
            }
        }
    }
    frame
}

/// The filter that finds `wanted` at a pixel; none where the pixel itself measured it.
fn taps(phase: CfaPhase, row: usize, column: usize, wanted: Channel) -> Option<&'static Taps> {
    let here = phase.channel(row, column);
    if here == wanted {
        None
    } else if wanted == Channel::Green {
        Some(&GREEN_AT_COLOUR)
    } else if here != Channel::Green {
        Some(&COLOUR_AT_OTHER_COLOUR)
    } else if phase.channel(row, column + 1) == wanted {
        Some(&COLOUR_AT_GREEN_IN_ITS_ROW)
    } else {
        Some(&COLOUR_AT_GREEN_IN_ITS_COLUMN)
    }
}

/// The raw frame in linear light with a border of [`REACH`] mirrored pixels.
fn mirrored_light(raw: &RawFrame) -> Array2<f32> {
    let (height, width) = raw.size();
    let inside = |padded: usize, length| mirror(padded as isize - REACH as isize, length);
    Array2::from_shape_fn((height + 2 * REACH, width + 2 * REACH), |(r, c)| {
        f32::from(raw.pixels()[(inside(r, height), inside(c, width))]) / 65536.0
    })
}

/// Correlation of the padded frame with `taps` at a pixel of the unpadded one.
fn filter(padded: &Array2<f32>, row: usize, column: usize, taps: &Taps) -> f32 {
    let mut sum = 0.0;
    for (r, line) in taps.iter().enumerate() {
        let values = &padded.row(row + r).to_slice().unwrap_or_default()[column..][..line.len()];
        line.iter().zip(values).for_each(|(tap, value)| sum += tap * value);
    }
    sum
}

const fn eighths(mut taps: Taps) -> Taps {
    let mut i = 0;
    while i < 25 {
        taps[i / 5][i % 5] /= 8.0;
        i += 1;
    }
    taps
}

const fn transpose(taps: Taps) -> Taps {
    let mut out = taps;
    let mut i = 0;
    while i < 25 {
        out[i % 5][i / 5] = taps[i / 5][i % 5];
        i += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Axis;

    /// Raw frame that sees plane `p` of a colour field through the filters.
    fn mosaic(
        size: (usize, usize),
        phase: CfaPhase,
        field: impl Fn(Channel, usize, usize) -> u16,
    ) -> RawFrame {
        let codes = Array2::from_shape_fn(size, |(r, c)| field(phase.channel(r, c), r, c));
        RawFrame::from_values(codes, 16, phase).unwrap()
    }

    fn demosaiced(raw: &RawFrame) -> ColourFrame {
        Malvar::default().reconstruct(raw).unwrap().frame
    }

    #[test]
    fn an_even_grey_is_kept_up_to_the_border() {
        for phase in CfaPhase::ALL {
            let out = demosaiced(&mosaic((8, 10), phase, |_, _, _| 20000));
            assert!(out.planes.iter().all(|&v| (v - 20000.0 / 65536.0).abs() < 1e-6), "{phase}");
        }
    }

    #[test]
    fn a_linear_gradient_of_each_colour_is_exact_inside() {
        let field = |channel: Channel, r: usize, c: usize| match channel {
            Channel::Red => 9000 + 700 * r + 300 * c,
            Channel::Green => 30000 - 500 * r + 200 * c,
            Channel::Blue => 20000 + 100 * r - 400 * c,
        } as u16;
        for phase in CfaPhase::ALL {
            let out = demosaiced(&mosaic((12, 14), phase, field));
            for channel in Channel::ALL {
                for (r, c) in (2..10).flat_map(|r| (2..12).map(move |c| (r, c))) {
                    let exact = f32::from(field(channel, r, c)) / 65536.0;
                    assert!((out.planes[(channel.plane(), r, c)] - exact).abs() < 1e-6, "{phase} {r},{c}");
                }
            }
        }
    }

    #[test]
    fn every_filter_passes_an_even_grey() {
        let all = [
            GREEN_AT_COLOUR,
            COLOUR_AT_GREEN_IN_ITS_ROW,
            COLOUR_AT_GREEN_IN_ITS_COLUMN,
            COLOUR_AT_OTHER_COLOUR,
        ];
        for taps in all {
            assert_eq!(taps.iter().flatten().sum::<f32>(), 1.0);
        }
    }

    #[test]
    fn a_red_point_spreads_by_the_published_taps() {
        // A single lit red pixel at (4, 4) of an RGGB frame shows each filter's taps, turned by half a turn.
        let raw = mosaic((10, 10), CfaPhase::Rggb, |_, r, c| if (r, c) == (4, 4) { 0x8000 } else { 0 });
        let out = demosaiced(&raw).planes.mapv(|v| v * 16.0);
        let [red, green, blue] = [0, 1, 2].map(|p| out.index_axis(Axis(0), p));
        assert_eq!(red[(4, 4)], 8.0);
        assert_eq!((red[(4, 5)], red[(5, 4)], red[(5, 5)]), (4.0, 4.0, 2.0));
        assert_eq!((green[(4, 4)], green[(4, 6)], green[(2, 4)]), (4.0, -1.0, -1.0));
        assert_eq!((blue[(4, 4)], blue[(4, 6)], blue[(6, 4)]), (6.0, -1.5, -1.5));
        assert_eq!(red.sum(), 8.0 + 4.0 * 4.0 + 4.0 * 2.0);
    }

    #[test]
    fn a_green_point_spreads_by_the_published_taps() {
        // Green pixel (4, 5): reds lie in its row, blues in its column.
        let raw = mosaic((10, 12), CfaPhase::Rggb, |_, r, c| if (r, c) == (4, 5) { 0x8000 } else { 0 });
        let out = demosaiced(&raw).planes.mapv(|v| v * 16.0);
        let [red, green, blue] = [0, 1, 2].map(|p| out.index_axis(Axis(0), p));
        assert_eq!((red[(4, 5)], red[(4, 3)], red[(2, 5)], red[(3, 4)]), (5.0, -1.0, 0.5, -1.0));
        assert_eq!((blue[(4, 5)], blue[(4, 3)], blue[(2, 5)], blue[(3, 4)]), (5.0, 0.5, -1.0, -1.0));
        assert_eq!((green[(4, 5)], green[(4, 4)], green[(3, 5)]), (8.0, 2.0, 2.0));
    }

    #[test]
    fn each_phase_equals_flipped_rggb() {
        let field = |r: usize, c: usize| ((r * 7919 + c * 104_729 + r * c * 31) % 65536) as u16;
        let (height, width) = (10, 12);
        for phase in CfaPhase::ALL {
            // Red moves to the corner when the axes on which it is one off are reversed (even sides).
            let (dr, dc) = phase.red_site();
            let flip = |r: usize, c: usize| {
                (if dr == 1 { height - 1 - r } else { r }, if dc == 1 { width - 1 - c } else { c })
            };
            let direct = demosaiced(&mosaic((height, width), phase, |_, r, c| field(r, c)));
            let mut turned = demosaiced(&mosaic((height, width), CfaPhase::Rggb, |_, r, c| {
                let (r, c) = flip(r, c);
                field(r, c)
            }));
            if dr == 1 {
                turned.planes.invert_axis(Axis(1));
            }
            if dc == 1 {
                turned.planes.invert_axis(Axis(2));
            }
            let worst = (&direct.planes - &turned.planes).iter().fold(0.0f32, |m, v| m.max(v.abs()));
            assert!(worst < 1e-6, "{phase}: {worst}");
        }
    }

    #[test]
    fn a_measured_colour_stays_as_it_is() {
        let raw = mosaic((8, 8), CfaPhase::Gbrg, |_, r, c| (r * 8000 + c * 123) as u16);
        let out = demosaiced(&raw);
        for ((r, c), &word) in raw.pixels().indexed_iter() {
            let plane = CfaPhase::Gbrg.channel(r, c).plane();
            assert_eq!(out.planes[(plane, r, c)], f32::from(word) / 65536.0);
        }
    }

    #[test]
    fn a_frame_smaller_than_the_filter_is_rejected() {
        let raw = mosaic((2, 8), CfaPhase::Rggb, |_, _, _| 0);
        let error = Malvar::default().reconstruct(&raw).unwrap_err().to_string();
        assert_eq!(error, "frame 8x2: both sides must be at least 4 pixels for a window of 5");
    }
}
