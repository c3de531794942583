//! The display step (docs/contract.md, "Display"): overlap-added words to the 8-bit Y′CbCr 4:2:2 codes on the wire, in integers; and
//! what a sink shows of them.
//!
//! Both modes start from chroma at every pixel of the raw frame's size (between its sites the mean of its neighbours, kept
//! doubled so that nothing is lost), so that all CFA phases leave in the raw frame's size with chroma sited at even columns.

use crate::fast::isa::{Isa, for_each_isa};
use crate::gamma::{ColourTable, Curve, LumaTable};
use edof_core::display::{
    BLACK, CHROMA_ZERO, CODES, COLOUR_ADDRESS_BITS, DisplayMode, SINK_CHROMA, SINK_LUMA, SINK_SHIFT,
    TO_CHROMA, TO_CHROMA_SHIFT, TO_LUMA, TO_LUMA_SHIFT, TO_RGB, TO_RGB_SHIFT,
};
use edof_core::number::CHROMA_SHIFT;
use edof_core::{ColourFrame, Frame422, Tone};
use edof_network::FixedNetwork;
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
        Self::of_values(Tone::Linear, mode, curve)
    }

    /// All tables made from one curve, for words that are values of a tone: those of a network of such values.
    #[must_use]
    pub fn of_values(values: Tone, mode: DisplayMode, curve: Curve) -> Self {
        let colour = ColourTable::of_values(values, curve);
        let luma = LumaTable::of_values(values, curve);
        Self { mode, luma, colours: [colour.clone(), colour.clone(), colour] }
    }

    /// sRGB's codes in colour, of what a network gives.
    #[must_use]
    pub fn of_network(network: &FixedNetwork) -> Self {
        Self::of_values(network.origin.values, DisplayMode::default(), Curve::default())
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
            let (min, max) = (r.min(g).min(b), r.max(g).max(b));
            out_of_gamut += u32::from((min < 0) | (max > 1 << COLOUR_ADDRESS_BITS));
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
/// except for its last bit.
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

/// Nearest code that is not a sync.
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
mod tests;
