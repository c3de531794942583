//! The display step (docs/contract.md, "Display"): overlap-added words to the 8-bit Y′CbCr 4:2:2 codes on the wire, in integers; and
//! what a sink shows of them.
//!
//! Both modes start from chroma at every pixel of the raw frame's size (between its sites the mean of its neighbours, kept
//! doubled so that nothing is lost), so that all CFA phases leave in the raw frame's size with chroma sited at even columns.

use crate::fast::isa::{Isa, for_each_isa};
use crate::gamma::{ColourTable, Curve, LumaTable};
use edof_spec::display::{
    BLACK, CHROMA_ZERO, CODES, COLOUR_ADDRESS_BITS, DisplayMode, SINK_CHROMA, SINK_LUMA, SINK_SHIFT,
    TO_CHROMA, TO_CHROMA_SHIFT, TO_LUMA, TO_LUMA_SHIFT, TO_RGB, TO_RGB_SHIFT,
};
use edof_spec::number::CHROMA_SHIFT;
use edof_spec::{ColourFrame, Frame422};
use ndarray::{Array2, Array3, ArrayViewMut1};
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
        let mut picture = Picture::empty();
        let counts = self.picture_into(frame, (top, left), (height, width), &mut picture);
        (picture, counts)
    }

    /// As [`Display::picture`], in the memory of another picture: none is allocated where that has the same size.
    pub fn picture_into(
        &self,
        frame: &Frame422,
        (top, left): (usize, usize),
        (height, width): (usize, usize),
        picture: &mut Picture,
    ) -> DisplayCounts {
        if picture.luma.dim() != (height, width) {
            *picture = Picture::black(height, width);
        }
        let Picture { luma, chroma: [cb, cr] } = picture;
        let codes = luma.outer_iter_mut().zip(cb.outer_iter_mut()).zip(cr.outer_iter_mut());
        let lines: Vec<_> = codes.map(|((luma, cb), cr)| Codes { luma, chroma: [cb, cr] }).collect();
        let isa = Isa::best();
        let tables = self.colours.each_ref().map(|table| {
            // Tables that are the same are looked up in one place, which the cache holds.
            if *table == self.colours[0] { &self.colours[0] } else { table }
        });
        lines
            .into_par_iter()
            .enumerate()
            .map_init(Buffers::default, |buffers, (row, codes)| {
                let words = Line::new(frame, top + row, left, width);
                match self.mode {
                    DisplayMode::Luma => self.luma_only(isa, &words, codes, buffers),
                    DisplayMode::Colour => colour(isa, tables, &words, codes, buffers),
                }
            })
            .reduce(DisplayCounts::default, std::ops::Add::add)
    }

    /// The paper's way: a table for luma, chroma rounds.
    fn luma_only(
        &self,
        isa: Isa,
        words: &Line<'_>,
        mut codes: Codes<'_>,
        buffers: &mut Buffers,
    ) -> DisplayCounts {
        let mut counts = DisplayCounts::default();
        for (code, word) in codes.luma.iter_mut().zip(words.luma) {
            *code = self.luma.code(*word);
        }
        for (doubled, codes) in words.doubled_chroma(isa, buffers).into_iter().zip(&mut codes.chroma) {
            for (sent, doubled) in codes.iter_mut().zip(doubled.iter().step_by(2)) {
                let code = CHROMA_ZERO + rounded(*doubled, CHROMA_SHIFT + 1);
                *sent = wire(code);
                counts.clamped_chroma += u64::from(i32::from(*sent) != code);
            }
        }
        counts
    }
}

/// To light of each colour, through its table, and back.
fn colour(
    isa: Isa,
    tables: [&ColourTable; 3],
    words: &Line<'_>,
    mut codes: Codes<'_>,
    buffers: &mut Buffers,
) -> DisplayCounts {
    let width = words.luma.len();
    let mut light = std::mem::take(&mut buffers.light);
    light.iter_mut().for_each(|plane| plane.resize(width, 0));
    let doubled = words.doubled_chroma(isa, buffers);
    let out_of_gamut = light_line(isa, words.luma, doubled, &mut light);
    for (plane, table) in light.iter_mut().zip(tables) {
        table.encode(plane);
    }
    let encoded = light.each_ref().map(Vec::as_slice);
    luma_codes(isa, encoded, codes.luma.as_slice_mut().unwrap_or_default());
    for (codes, row) in codes.chroma.iter_mut().zip(TO_CHROMA) {
        chroma_codes(isa, row, encoded, codes.as_slice_mut().unwrap_or_default());
    }
    buffers.light = light;
    DisplayCounts { clamped_chroma: 0, out_of_gamut }
}

/// Lines of numbers that a thread works on.
#[derive(Debug, Default)]
struct Buffers {
    /// Twice Cb and Cr at every pixel of the enlarged frame.
    doubled: [Vec<i32>; 2],
    /// Red, green and blue of every pixel: a table's address, then its entry.
    light: [Vec<u16>; 3],
}

for_each_isa! {
    /// Red, green and blue light of a line as addresses of the tables, the nearest there is; gives how many pixels no screen has.
    fn light_line(luma: &[i16], doubled: [&[i32]; 2], light: &mut [Vec<u16>; 3]) -> u64 {
        let [red, green, blue] = light;
        let mut out_of_gamut = 0u32;
        let each = luma.iter().zip(doubled[0]).zip(doubled[1]);
        for (((((luma, cb), cr), red), green), blue) in each.zip(red).zip(green).zip(blue) {
            let [r, g, b] = light_of(*luma, [*cb, *cr]);
            let (least, most) = (r.min(g).min(b), r.max(g).max(b));
            out_of_gamut += u32::from((least < 0) | (most > 1 << COLOUR_ADDRESS_BITS));
            let address = |light: i32| light.clamp(0, (1 << COLOUR_ADDRESS_BITS) - 1) as u16;
            (*red, *green, *blue) = (address(r), address(g), address(b));
        }
        out_of_gamut.into()
    }
}

/// Red, green and blue light of a pixel, with as many fraction bits as its luma word.
#[inline(always)]
fn light_of(luma: i16, doubled: [i32; 2]) -> [i32; 3] {
    TO_RGB.map(|row| i32::from(luma) + from_chroma(row, doubled))
}

/// (Σ coefficient·doubled + 2^16) >> 17, in 32 bits: a coefficient's whole part passes the shift, and so does half of the doubled word
/// but for its last bit.
#[inline(always)]
fn from_chroma(coefficients: [i32; 2], doubled: [i32; 2]) -> i32 {
    const SHIFT: u32 = TO_RGB_SHIFT - 1;
    let whole = |coefficient: i32| (coefficient + (1 << (SHIFT - 1))) >> SHIFT;
    let rest = |coefficient: i32| coefficient - (whole(coefficient) << SHIFT);
    let ([of_cb, of_cr], [cb, cr]) = (coefficients, [doubled[0] >> 1, doubled[1] >> 1]);
    let last = of_cb * (doubled[0] & 1) + of_cr * (doubled[1] & 1);
    let fraction = rest(of_cb) * cb + rest(of_cr) * cr + ((last + (1 << SHIFT)) >> 1);
    whole(of_cb) * cb + whole(of_cr) * cr + (fraction >> SHIFT)
}

for_each_isa! {
    /// Luma codes of encoded red, green and blue.
    fn luma_codes(encoded: [&[u16]; 3], codes: &mut [u8]) -> () {
        let [red, green, blue] = encoded;
        for (((code, red), green), blue) in codes.iter_mut().zip(red).zip(green).zip(blue) {
            *code = wire(i32::from(BLACK) + rounded(sum(TO_LUMA, [*red, *green, *blue].map(i32::from)), TO_LUMA_SHIFT));
        }
    }
}

for_each_isa! {
    /// Chroma codes of encoded red, green and blue, filtered at even columns; before the first column the line is mirrored about it.
    fn chroma_codes(row: [i32; 3], encoded: [&[u16]; 3], codes: &mut [u8]) -> () {
        let [red, green, blue] = encoded.map(|plane| &plane[..2 * codes.len()]);
        for (pair, code) in codes.iter_mut().enumerate() {
            let (x, before) = (2 * pair, if pair == 0 { 1 } else { 2 * pair - 1 });
            let filtered = |plane: &[u16]| i32::from(plane[before] + 2 * plane[x] + plane[x + 1]);
            let rgb = [filtered(red), filtered(green), filtered(blue)];
            *code = wire(CHROMA_ZERO + rounded(sum(row, rgb), TO_CHROMA_SHIFT));
        }
    }
}

/// Σ coefficient·value: below 2³¹ for all encoded values.
#[inline(always)]
fn sum(coefficients: [i32; 3], values: [i32; 3]) -> i32 {
    coefficients[0] * values[0] + coefficients[1] * values[1] + coefficients[2] * values[2]
}

/// (value + 2^(shift−1)) >> shift: ties toward +∞.
const fn rounded(value: i32, shift: u32) -> i32 {
    (value + (1 << (shift - 1))) >> shift
}

/// Nearest code that is no sync.
#[inline(always)]
fn wire(code: i32) -> u8 {
    code.clamp(CODES[0].into(), CODES[1].into()) as u8
}

/// A line of words, seen from the raw frame's first column.
struct Line<'a> {
    /// Of the raw frame's columns.
    luma: &'a [i16],
    /// Cb and Cr of the enlarged frame's.
    chroma: [&'a [i16]; 2],
    left: usize,
}

impl<'a> Line<'a> {
    fn new(frame: &'a Frame422, row: usize, left: usize, width: usize) -> Self {
        let line = |plane: &'a Array2<i16>| {
            let words = plane.as_slice().unwrap_or_default();
            &words[row * plane.ncols()..][..plane.ncols()]
        };
        Self { luma: &line(&frame.luma)[left..left + width], chroma: frame.chroma.each_ref().map(line), left }
    }

    /// Twice Cb and Cr at every pixel: twice the word at a site, the sum of both neighbours between sites; after the last site twice
    /// its word.
    fn doubled_chroma<'b>(&self, isa: Isa, buffers: &'b mut Buffers) -> [&'b [i32]; 2] {
        for (doubled, words) in buffers.doubled.iter_mut().zip(self.chroma) {
            doubled.resize(2 * words.len(), 0);
            between_sites(isa, words, doubled.as_chunks_mut().0);
            if let (Some(end), Some(word)) = (doubled.as_chunks_mut().0.last_mut(), words.last()) {
                *end = [2 * i32::from(*word); 2];
            }
        }
        buffers.doubled.each_ref().map(|doubled| &doubled[self.left..][..self.luma.len()])
    }
}

for_each_isa! {
    /// Twice the words of all sites but the last, and their sums with the next.
    fn between_sites(words: &[i16], doubled: &mut [[i32; 2]]) -> () {
        for (two, words) in doubled.iter_mut().zip(words.windows(2)) {
            let [word, next] = [0, 1].map(|i| i32::from(words[i]));
            *two = [2 * word, word + next];
        }
    }
}

/// Twice the chroma at a column: that of its site twice, or of both neighbours.
fn doubled(column: usize, sites: usize, word: impl Fn(usize) -> i32) -> i32 {
    let site = column / 2;
    let next = if column.is_multiple_of(2) { site } else { (site + 1).min(sites - 1) };
    word(site) + word(next)
}

/// A line of codes to be filled.
struct Codes<'a> {
    luma: ArrayViewMut1<'a, u8>,
    chroma: [ArrayViewMut1<'a, u8>; 2],
}

impl Picture {
    /// A picture without pixels, for [`Display::picture_into`] to make.
    #[must_use]
    pub fn empty() -> Self {
        Self::black(0, 0)
    }

    /// Codes of 0.
    fn black(height: usize, width: usize) -> Self {
        let chroma = || Array2::zeros((height, width / 2));
        Self { luma: Array2::zeros((height, width)), chroma: [chroma(), chroma()] }
    }

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
                doubled(x, width / 2, word)
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
        fn light_in_32_bits_is_the_contracts(luma: i16, cb in -65_536..=65_534, cr in -65_536..=65_534) {
            let contract: [i64; 3] = TO_RGB.map(|[of_cb, of_cr]| {
                let chroma = i64::from(of_cb) * i64::from(cb) + i64::from(of_cr) * i64::from(cr);
                ((i64::from(luma) << TO_RGB_SHIFT) + chroma + (1 << (TO_RGB_SHIFT - 1))) >> TO_RGB_SHIFT
            });
            prop_assert_eq!(light_of(luma, [cb, cr]).map(i64::from), contract);
            for isa in Isa::available() {
                let mut light = [0; 3].map(|_| vec![0; 40]);
                let outside = light_line(isa, &[luma; 40], [&[cb; 40], &[cr; 40]], &mut light);
                prop_assert_eq!(outside == 40, contract.iter().any(|light| !(0..=1 << 14).contains(light)));
                for (plane, expected) in light.iter().zip(contract) {
                    let address = expected.clamp(0, (1 << 14) - 1);
                    prop_assert!(plane.iter().all(|light| i64::from(*light) == address), "{isa:?}");
                }
            }
        }

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
