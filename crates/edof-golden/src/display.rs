//! The display step (docs/contract.md, "Display"): overlap-added words to the 8-bit Y′CbCr 4:2:2 codes on the wire, in integers; and
//! what a sink shows of them.
//!
//! Both modes start from chroma at every pixel of the raw frame's size (between its sites the mean of its neighbours, kept
//! doubled so that nothing is lost), so that all CFA phases leave in the raw frame's size with chroma sited at even columns.

use crate::gamma::{ColourTable, Curve, LumaTable};
use edof_spec::display::{
    BLACK, CHROMA_ZERO, CODES, COLOUR_ADDRESS_BITS, DisplayMode, SINK_CHROMA, SINK_LUMA, SINK_SHIFT,
    TO_CHROMA, TO_CHROMA_SHIFT, TO_LUMA, TO_LUMA_SHIFT, TO_RGB, TO_RGB_SHIFT,
};
use edof_spec::number::CHROMA_SHIFT;
use edof_spec::{ColourFrame, Frame422};
use ndarray::{Array2, Array3, ArrayView1, ArrayViewMut1};
use rayon::prelude::*;

/// The display step with its tables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Display {
    /// Which way words become codes.
    pub mode: DisplayMode,
    /// Luma codes in [`DisplayMode::Luma`].
    pub luma: LumaTable,
    /// Encoded red, green and blue in [`DisplayMode::Colour`].
    pub colours: [ColourTable; 3],
}

impl Default for Display {
    /// Colour, encoded as sRGB.
    fn default() -> Self {
        Self::new(DisplayMode::default(), Curve::default())
    }
}

/// The picture on the wire: 8-bit Y′CbCr 4:2:2, studio range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Luma codes, rows × columns.
    pub luma: Array2<u8>,
    /// Cb and Cr codes, sited at even columns; rows × columns/2 each.
    pub chroma: [Array2<u8>; 2],
}

/// What the display step could not show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DisplayCounts {
    /// Chroma codes that were clamped to 1…254 ([`DisplayMode::Luma`]).
    pub clamped_chroma: u64,
    /// Pixels with less than none or more than full light of a colour ([`DisplayMode::Colour`]).
    pub out_of_gamut: u64,
}

impl std::ops::Add for DisplayCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            clamped_chroma: self.clamped_chroma + other.clamped_chroma,
            out_of_gamut: self.out_of_gamut + other.out_of_gamut,
        }
    }
}

impl Display {
    /// All tables made from one curve.
    #[must_use]
    pub fn new(mode: DisplayMode, curve: Curve) -> Self {
        let colour = ColourTable::new(curve);
        Self { mode, luma: LumaTable::new(curve), colours: [colour.clone(), colour.clone(), colour] }
    }

    /// The codes of the `height`×`width` part of a frame that starts at `top`, `left`: `width` even.
    #[must_use]
    pub fn picture(
        &self,
        frame: &Frame422,
        (top, left): (usize, usize),
        (height, width): (usize, usize),
    ) -> (Picture, DisplayCounts) {
        let mut luma = Array2::zeros((height, width));
        let mut chroma = [Array2::zeros((height, width / 2)), Array2::zeros((height, width / 2))];
        let [cb, cr] = &mut chroma;
        let codes = luma.outer_iter_mut().zip(cb.outer_iter_mut()).zip(cr.outer_iter_mut());
        let lines: Vec<_> = codes.map(|((luma, cb), cr)| Codes { luma, chroma: [cb, cr] }).collect();
        let counts = lines
            .into_par_iter()
            .enumerate()
            .map(|(row, codes)| {
                let words = Line::new(frame, top + row, left);
                match self.mode {
                    DisplayMode::Luma => self.luma_only(&words, codes),
                    DisplayMode::Colour => self.colour(&words, codes),
                }
            })
            .reduce(DisplayCounts::default, std::ops::Add::add);
        (Picture { luma, chroma }, counts)
    }

    /// The paper's way: a table for luma, chroma rounds.
    fn luma_only(&self, words: &Line<'_>, mut codes: Codes<'_>) -> DisplayCounts {
        let mut counts = DisplayCounts::default();
        for (x, code) in codes.luma.indexed_iter_mut() {
            *code = self.luma.code(words.luma(x));
        }
        for pair in 0..codes.chroma[0].len() {
            for (which, doubled) in words.doubled_chroma(2 * pair).into_iter().enumerate() {
                let code = CHROMA_ZERO + rounded(doubled, CHROMA_SHIFT + 1);
                let sent = wire(code);
                counts.clamped_chroma += u64::from(i32::from(sent) != code);
                codes.chroma[which][pair] = sent;
            }
        }
        counts
    }

    /// To light of each colour, through its table, and back.
    fn colour(&self, words: &Line<'_>, mut codes: Codes<'_>) -> DisplayCounts {
        let mut counts = DisplayCounts::default();
        let mut encoded = vec![[0; 3]; codes.luma.len()];
        for (x, encoded) in encoded.iter_mut().enumerate() {
            let light = light(words.luma(x), words.doubled_chroma(x));
            counts.out_of_gamut +=
                u64::from(light.iter().any(|l| !(0..=1 << COLOUR_ADDRESS_BITS).contains(l)));
            *encoded = std::array::from_fn(|plane| self.colours[plane].encoded(light[plane]));
            codes.luma[x] = wire(i32::from(BLACK) + rounded(sum(TO_LUMA, *encoded), TO_LUMA_SHIFT));
        }
        for pair in 0..codes.chroma[0].len() {
            let x = 2 * pair;
            // Before the first column the line is mirrored about it.
            let before = if x == 0 { 1 } else { x - 1 };
            let filtered = std::array::from_fn(|plane| {
                encoded[before][plane] + 2 * encoded[x][plane] + encoded[x + 1][plane]
            });
            for (which, row) in TO_CHROMA.into_iter().enumerate() {
                codes.chroma[which][pair] = wire(CHROMA_ZERO + rounded(sum(row, filtered), TO_CHROMA_SHIFT));
            }
        }
        counts
    }
}

/// Red, green and blue light of a pixel, with as many fraction bits as its luma word.
fn light(luma: i16, doubled_chroma: [i32; 2]) -> [i32; 3] {
    TO_RGB.map(|[cb, cr]| {
        let chroma =
            i64::from(cb) * i64::from(doubled_chroma[0]) + i64::from(cr) * i64::from(doubled_chroma[1]);
        let sum = (i64::from(luma) << TO_RGB_SHIFT) + chroma;
        ((sum + (1 << (TO_RGB_SHIFT - 1))) >> TO_RGB_SHIFT) as i32
    })
}

/// Σ coefficient·value: below 2³¹ for all encoded values.
fn sum(coefficients: [i32; 3], values: [i32; 3]) -> i32 {
    coefficients.iter().zip(values).map(|(c, v)| c * v).sum()
}

/// (value + 2^(shift−1)) >> shift: ties toward +∞.
const fn rounded(value: i32, shift: u32) -> i32 {
    (value + (1 << (shift - 1))) >> shift
}

/// Nearest code that is no sync.
fn wire(code: i32) -> u8 {
    code.clamp(CODES[0].into(), CODES[1].into()) as u8
}

/// A line of words, seen from the raw frame's first column.
struct Line<'a> {
    luma: ArrayView1<'a, i16>,
    chroma: [ArrayView1<'a, i16>; 2],
    left: usize,
}

impl<'a> Line<'a> {
    fn new(frame: &'a Frame422, row: usize, left: usize) -> Self {
        Self { luma: frame.luma.row(row), chroma: frame.chroma.each_ref().map(|c| c.row(row)), left }
    }

    fn luma(&self, x: usize) -> i16 {
        self.luma[self.left + x]
    }

    /// Twice Cb and Cr at a pixel: twice the word at a site, the sum of both neighbours between sites; after the last site twice
    /// its word.
    fn doubled_chroma(&self, x: usize) -> [i32; 2] {
        let site = (self.left + x) / 2;
        self.chroma.map(|words| doubled(self.left + x, site, words.len(), |site| i32::from(words[site])))
    }
}

fn doubled(column: usize, site: usize, sites: usize, word: impl Fn(usize) -> i32) -> i32 {
    let next = if column.is_multiple_of(2) { site } else { (site + 1).min(sites - 1) };
    word(site) + word(next)
}

/// A line of codes to be filled.
struct Codes<'a> {
    luma: ArrayViewMut1<'a, u8>,
    chroma: [ArrayViewMut1<'a, u8>; 2],
}

impl Picture {
    /// The codes in the order of YUYV (YUY2) files: of each pair of pixels Y of the left one, Cb, Y of the right one, Cr; row by row.
    #[must_use]
    pub fn yuyv(&self) -> Vec<u8> {
        let [cb, cr] = self.chroma.each_ref().map(|plane| plane.iter());
        let pairs = self.luma.exact_chunks((1, 2)).into_iter().zip(cb.zip(cr));
        pairs.flat_map(|(luma, (cb, cr))| [luma[(0, 0)], *cb, luma[(0, 1)], *cr]).collect()
    }

    /// What a sink makes of the codes: BT.709 from studio range to 8-bit red, green and blue (planes × rows × columns), chroma
    /// between sites the mean of its neighbours, after the last site its word.
    #[must_use]
    pub fn shown(&self) -> Array3<u8> {
        let (height, width) = self.luma.dim();
        let mut planes = Array3::zeros((3, height, width));
        for ((row, x), &luma) in self.luma.indexed_iter() {
            let chroma = self.chroma.each_ref().map(|plane| {
                let word = |site| i32::from(plane[(row, site)]) - CHROMA_ZERO;
                doubled(x, x / 2, width / 2, word)
            });
            for (plane, [cb, cr]) in SINK_CHROMA.into_iter().enumerate() {
                let sum = SINK_LUMA * (i32::from(luma) - i32::from(BLACK)) + cb * chroma[0] + cr * chroma[1];
                planes[(plane, row, x)] = rounded(sum, SINK_SHIFT).clamp(0, 255) as u8;
            }
        }
        planes
    }

    /// [`Picture::shown`] as a frame of 0…1, for writing to a file of 8 bits a sample.
    #[must_use]
    pub fn shown_frame(&self) -> ColourFrame {
        ColourFrame { planes: self.shown().mapv(|code| f32::from(code) / 255.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::colour::{chroma_word, luma_word, srgb_encode, ycbcr_matrix};
    use proptest::prelude::*;

    /// A frame of one colour in linear light.
    fn flat(rgb: [f64; 3]) -> Frame422 {
        let [luma, cb, cr] =
            ycbcr_matrix().map(|row| row.iter().zip(rgb).map(|(weight, light)| weight * light).sum::<f64>());
        let chroma = [cb, cr].map(|c| Array2::from_elem((2, 4), chroma_word(c)));
        Frame422 { luma: Array2::from_elem((2, 8), luma_word(luma)), chroma }
    }

    /// What a sink shows in the middle of a patch of linear light, as sRGB codes.
    fn shown(rgb: [f64; 3], mode: DisplayMode) -> [u8; 3] {
        let picture = Display::new(mode, Curve::Srgb).picture(&flat(rgb), (0, 0), (2, 8)).0;
        let shown = picture.shown();
        std::array::from_fn(|plane| shown[(plane, 1, 3)])
    }

    fn farthest(rgb: [f64; 3]) -> f64 {
        let exact = rgb.map(|light| 255.0 * srgb_encode(light));
        exact
            .iter()
            .zip(shown(rgb, DisplayMode::Colour))
            .map(|(e, s)| (e - f64::from(s)).abs())
            .fold(0.0, f64::max)
    }

    /// Linear light of a chart of our own: skin, sky, leaves, primaries and secondaries, six greys; then dark colours.
    const PATCHES: [[f64; 3]; 30] = [
        [0.17, 0.08, 0.05],
        [0.54, 0.30, 0.22],
        [0.11, 0.19, 0.34],
        [0.10, 0.15, 0.05],
        [0.22, 0.21, 0.43],
        [0.13, 0.51, 0.41],
        [0.70, 0.20, 0.025],
        [0.06, 0.10, 0.38],
        [0.55, 0.09, 0.12],
        [0.11, 0.04, 0.14],
        [0.34, 0.50, 0.04],
        [0.77, 0.36, 0.02],
        [0.03, 0.04, 0.28],
        [0.05, 0.30, 0.06],
        [0.45, 0.03, 0.04],
        [0.85, 0.57, 0.01],
        [0.51, 0.08, 0.30],
        [0.01, 0.24, 0.37],
        [0.90, 0.90, 0.88],
        [0.58, 0.58, 0.58],
        [0.36, 0.36, 0.36],
        [0.19, 0.19, 0.19],
        [0.09, 0.09, 0.09],
        [0.032, 0.032, 0.032],
        [0.05, 0.01, 0.01],
        [0.01, 0.05, 0.01],
        [0.01, 0.01, 0.05],
        [0.004, 0.002, 0.001],
        [0.0, 0.0, 0.0],
        [1.0, 1.0, 1.0],
    ];

    #[test]
    fn colour_patches_show_within_two_codes_of_their_light() {
        for rgb in PATCHES {
            assert!(farthest(rgb) <= 2.0, "{rgb:?} shows as {:?}", shown(rgb, DisplayMode::Colour));
        }
    }

    #[test]
    fn dark_red_is_red_in_colour_and_pale_in_luma_only() {
        let dark_red = [0.05, 0.01, 0.01];
        for (shown, exact) in shown(dark_red, DisplayMode::Colour).into_iter().zip([63, 25, 25]) {
            assert!(shown.abs_diff(exact) <= 1, "{shown}, expected {exact}");
        }
        assert!(shown(dark_red, DisplayMode::Luma)[0] < 50);
    }

    #[test]
    fn luma_only_rounds_chroma_with_ties_up_and_keeps_off_the_sync_codes() {
        let words = [63, 64, -64, -65, i16::MAX, i16::MIN];
        let frame = Frame422 {
            luma: Array2::zeros((1, 12)),
            chroma: [Array2::from_shape_vec((1, 6), words.to_vec()).unwrap(), Array2::zeros((1, 6))],
        };
        let (picture, counts) =
            Display::new(DisplayMode::Luma, Curve::Linear).picture(&frame, (0, 0), (1, 12));
        assert_eq!(picture.chroma[0].as_slice().unwrap(), [128, 129, 128, 127, 254, 1]);
        assert_eq!(counts, DisplayCounts { clamped_chroma: 2, out_of_gamut: 0 });
    }

    #[test]
    fn a_frame_that_starts_between_sites_takes_the_mean_of_its_neighbours() {
        let frame = Frame422 {
            luma: Array2::from_shape_fn((1, 6), |(_, x)| (x as i16) << 8),
            chroma: [0, 1].map(|_| Array2::from_shape_vec((1, 3), vec![0, 1280, 2561]).unwrap()),
        };
        let (picture, _) = Display::new(DisplayMode::Luma, Curve::Linear).picture(&frame, (0, 1), (1, 4));
        // (0 + 1280)/2 and (1280 + 2561)/2 in units of 128.
        assert_eq!(picture.chroma[0].as_slice().unwrap(), [133, 143]);
        assert_eq!(picture.luma[(0, 0)], LumaTable::new(Curve::Linear).code(256));
    }

    #[test]
    fn colours_that_no_screen_has_are_counted_and_clipped() {
        let mut frame = flat([0.5, 0.5, 0.5]);
        frame.chroma[1].fill(chroma_word(0.4));
        let (picture, counts) = Display::default().picture(&frame, (0, 0), (2, 8));
        assert_eq!(counts, DisplayCounts { clamped_chroma: 0, out_of_gamut: 16 });
        assert_eq!(picture.shown()[(0, 0, 0)], 255);
    }

    #[test]
    fn codes_are_written_luma_first() {
        let row = |values: [u8; 4]| Array2::from_shape_vec((2, 2), values.to_vec()).unwrap();
        let one = |values: [u8; 2]| Array2::from_shape_vec((2, 1), values.to_vec()).unwrap();
        let picture = Picture { luma: row([1, 2, 3, 4]), chroma: [one([11, 12]), one([21, 22])] };
        assert_eq!(picture.yuyv(), [1, 11, 2, 21, 3, 12, 4, 22]);
    }

    proptest! {
        #[test]
        fn grey_stays_grey_and_every_colour_shows_within_two_and_a_half_codes(rgb in prop::array::uniform3(0.0f64..1.0)) {
            prop_assert!(farthest(rgb) <= 2.5, "{:?}", shown(rgb, DisplayMode::Colour));
            let [r, g, b] = shown([rgb[0]; 3], DisplayMode::Colour);
            prop_assert!(r == g && g == b);
        }

        #[test]
        fn no_word_gives_a_sync_code(luma: i16, cb: i16, cr: i16) {
            let frame = Frame422 {
                luma: Array2::from_elem((1, 4), luma),
                chroma: [cb, cr].map(|word| Array2::from_elem((1, 2), word)),
            };
            for mode in DisplayMode::ALL {
                let picture = Display::new(mode, Curve::Srgb).picture(&frame, (0, 0), (1, 4)).0;
                prop_assert!(picture.yuyv().iter().all(|code| (1..=254).contains(code)));
            }
        }
    }
}
