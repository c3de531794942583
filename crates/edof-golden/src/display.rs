//! The display step (docs/contract.md, "Display"): overlap-added words to the 8-bit Y′CbCr 4:2:2 codes on the wire, in integers; and
//! what a sink shows of them.
//!
//! Both modes start from chroma at every pixel of the raw frame's size (between its sites the mean of its neighbours, kept
//! doubled so that nothing is lost), so that all CFA phases leave in the raw frame's size with chroma sited at even columns.

mod mix;

pub use mix::Mix;

use crate::fast::isa::{Isa, for_each_isa};
use crate::gamma::{ColourTable, Curve, LumaTable, index};
use edof_core::display::{
    BLACK, CHROMA_ZERO, CODES, DisplayMode, SINK_CHROMA, SINK_LUMA, TO_CHROMA, TO_LUMA, TO_RGB, ToChroma,
    ToRgb,
};
use edof_core::number::{ChromaCodes, OutputSum, OutputWord, TableIndex, bits_of, nearest_whole};
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

    /// The colour tables of a white balance: gains of red, green and blue.
    #[must_use]
    pub fn balanced(values: Tone, curve: Curve, gains: [f64; 3]) -> Self {
        let colours = gains.map(|gain| ColourTable::amplified(values, curve, gain));
        Self { mode: DisplayMode::Colour, luma: LumaTable::of_values(values, curve), colours }
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
        let isa = Isa::best();
        let tables = self.colours.each_ref().map(|table| {
            // Tables that are the same are looked up in one place, which the cache holds.
            if *table == self.colours[0] { &self.colours[0] } else { table }
        });
        each_line(frame, (top, left), (height, width), picture, |words, codes, buffers| match self.mode {
            DisplayMode::Luma => self.luma_only(isa, words, codes, buffers),
            DisplayMode::Colour => colour(isa, words, codes, buffers, |light| {
                light.iter_mut().zip(tables).for_each(|(plane, table)| table.encode(plane));
            }),
        })
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
                let code = CHROMA_ZERO + nearest_whole(ChromaCodes::from_bits(doubled.to_bits()));
                *sent = wire(code);
                counts.clamped_chroma += u64::from(i32::from(*sent) != code);
            }
        }
        counts
    }
}

/// Makes the codes of each line of a part of a frame, in the memory of another picture.
fn each_line(
    frame: &Frame422,
    (top, left): (usize, usize),
    (height, width): (usize, usize),
    picture: &mut Picture,
    line: impl Fn(&Line<'_>, Codes<'_>, &mut Buffers) -> DisplayCounts + Sync,
) -> DisplayCounts {
    if picture.luma.dim() != (height, width) {
        *picture = Picture::black(height, width);
    }
    let Picture { luma, chroma: [cb, cr] } = picture;
    let codes = luma.outer_iter_mut().zip(cb.outer_iter_mut()).zip(cr.outer_iter_mut());
    let lines: Vec<_> = codes.map(|((luma, cb), cr)| Codes { luma, chroma: [cb, cr] }).collect();
    lines
        .into_par_iter()
        .enumerate()
        .map_init(Buffers::default, |buffers, (row, codes)| {
            line(&Line::new(frame, top + row, left, width), codes, buffers)
        })
        .reduce(DisplayCounts::default, std::ops::Add::add)
}

/// To light of each colour, which `encode` makes entries of a colour's table in its place, and back.
fn colour(
    isa: Isa,
    words: &Line<'_>,
    mut codes: Codes<'_>,
    buffers: &mut Buffers,
    encode: impl Fn(&mut [Vec<TableIndex>; 3]),
) -> DisplayCounts {
    let width = words.luma.len();
    let mut light = std::mem::take(&mut buffers.light);
    light.iter_mut().for_each(|plane| plane.resize(width, TableIndex::ZERO));
    let doubled = words.doubled_chroma(isa, buffers);
    let out_of_gamut = light_line(isa, words.luma, doubled, &mut light);
    encode(&mut light);
    let encoded = light.each_ref().map(|plane| bits_of(plane));
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
    doubled: [Vec<OutputSum>; 2],
    /// Red, green and blue of every pixel: a table's index, then its entry.
    light: [Vec<TableIndex>; 3],
}

for_each_isa! {
    /// Red, green and blue light of a line as addresses of the tables, the nearest there is; gives how many pixels no screen has.
    fn light_line(luma: &[OutputWord], doubled: [&[OutputSum]; 2], light: &mut [Vec<TableIndex>; 3]) -> u64 {
        let [red, green, blue] = light;
        let mut out_of_gamut = 0u32;
        let each = luma.iter().zip(doubled[0]).zip(doubled[1]);
        for (((((luma, cb), cr), red), green), blue) in each.zip(red).zip(green).zip(blue) {
            let [r, g, b] = light_of(*luma, [*cb, *cr]);
            let (min, max) = (r.min(g).min(b), r.max(g).max(b));
            out_of_gamut += u32::from((min < OutputSum::ZERO) | (max > OutputSum::ONE));
            (*red, *green, *blue) = (index(r), index(g), index(b));
        }
        out_of_gamut.into()
    }
}

/// Red, green and blue light of a pixel, the nearest that has the fraction bits of its luma word.
#[inline(always)]
fn light_of(luma: OutputWord, doubled: [OutputSum; 2]) -> [OutputSum; 3] {
    TO_RGB.map(|row| OutputSum::from(luma) + from_chroma(row, doubled))
}

/// Σ coefficient·doubled, rounded, in 32 bits of integers: a coefficient's whole part passes the shift, and so does half of the doubled
/// word except for its last bit. Products of `fixed` would take 64 bits.
#[inline(always)]
fn from_chroma(coefficients: [ToRgb; 2], doubled: [OutputSum; 2]) -> OutputSum {
    const SHIFT: u32 = ToRgb::FRAC_NBITS - 1;
    let whole = |coefficient: i32| (coefficient + (1 << (SHIFT - 1))) >> SHIFT;
    let rest = |coefficient: i32| coefficient - (whole(coefficient) << SHIFT);
    let ([of_cb, of_cr], doubled) = (coefficients.map(ToRgb::to_bits), doubled.map(OutputSum::to_bits));
    let [cb, cr] = [doubled[0] >> 1, doubled[1] >> 1];
    let last = of_cb * (doubled[0] & 1) + of_cr * (doubled[1] & 1);
    let fraction = rest(of_cb) * cb + rest(of_cr) * cr + ((last + (1 << SHIFT)) >> 1);
    OutputSum::from_bits(whole(of_cb) * cb + whole(of_cr) * cr + (fraction >> SHIFT))
}

for_each_isa! {
    /// Luma codes of encoded red, green and blue.
    fn luma_codes(encoded: [&[u16]; 3], codes: &mut [u8]) -> () {
        let [red, green, blue] = encoded;
        for (((code, red), green), blue) in codes.iter_mut().zip(red).zip(green).zip(blue) {
            let [r, g, b] = TO_LUMA;
            let sum = r * i32::from(*red) + g * i32::from(*green) + b * i32::from(*blue);
            *code = wire(i32::from(BLACK) + nearest_whole(sum));
        }
    }
}

for_each_isa! {
    /// Chroma codes of encoded red, green and blue, filtered at even columns; before the first column the line is mirrored about it.
    fn chroma_codes(row: [ToChroma; 3], encoded: [&[u16]; 3], codes: &mut [u8]) -> () {
        let [red, green, blue] = encoded.map(|plane| &plane[..2 * codes.len()]);
        for (pair, code) in codes.iter_mut().enumerate() {
            let (x, before) = (2 * pair, if pair == 0 { 1 } else { 2 * pair - 1 });
            let filtered = |plane: &[u16]| i32::from(plane[before] + 2 * plane[x] + plane[x + 1]);
            let sum = row[0] * filtered(red) + row[1] * filtered(green) + row[2] * filtered(blue);
            *code = wire(CHROMA_ZERO + nearest_whole(sum));
        }
    }
}

/// Nearest code that is not a sync.
#[inline(always)]
fn wire(code: i32) -> u8 {
    code.clamp(CODES[0].into(), CODES[1].into()) as u8
}

/// A line of words, seen from the raw frame's first column.
struct Line<'a> {
    /// Of the raw frame's columns.
    luma: &'a [OutputWord],
    /// Cb and Cr of the enlarged frame's.
    chroma: [&'a [OutputWord]; 2],
    left: usize,
}

impl<'a> Line<'a> {
    fn new(frame: &'a Frame422, row: usize, left: usize, width: usize) -> Self {
        let line = |plane: &'a Array2<OutputWord>| {
            let words = plane.as_slice().unwrap_or_default();
            &words[row * plane.ncols()..][..plane.ncols()]
        };
        Self { luma: &line(&frame.luma)[left..left + width], chroma: frame.chroma.each_ref().map(line), left }
    }

    /// Twice Cb and Cr at every pixel: twice the word at a site, the sum of both neighbours between sites; after the last site twice
    /// its word.
    fn doubled_chroma<'b>(&self, isa: Isa, buffers: &'b mut Buffers) -> [&'b [OutputSum]; 2] {
        for (doubled, words) in buffers.doubled.iter_mut().zip(self.chroma) {
            doubled.resize(2 * words.len(), OutputSum::ZERO);
            between_sites(isa, words, doubled.as_chunks_mut().0);
            if let (Some(end), Some(word)) = (doubled.as_chunks_mut().0.last_mut(), words.last()) {
                *end = [OutputSum::from(*word) * 2; 2];
            }
        }
        buffers.doubled.each_ref().map(|doubled| &doubled[self.left..][..self.luma.len()])
    }
}

for_each_isa! {
    /// Twice the words of all sites but the last, and their sums with the next.
    fn between_sites(words: &[OutputWord], doubled: &mut [[OutputSum; 2]]) -> () {
        for (two, words) in doubled.iter_mut().zip(words.windows(2)) {
            let [word, next] = [0, 1].map(|i| OutputSum::from(words[i]));
            *two = [word * 2, word + next];
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
                planes[(plane, row, x)] = nearest_whole(sum).clamp(0, 255) as u8;
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
