//! The sum of overlapping patches: the board's 4:2:2 frame in words.
//!
//! F's weights carry the averaging window, so here is only addition: words of all patches over a pixel are summed in 32 bits
//! (at most 16 words of 16 bits), saturated to 16 bits once a pixel.

use crate::fast::isa::{Isa, for_each_isa};
use crate::trace::Counts;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::number::{OutputSum, OutputWord};
use edof_core::{Frame422, Geometry};
use std::ops::Range;

/// Sums of words over a band of lines.
#[derive(Debug, Clone)]
pub struct Band {
    /// Luma, Cb and Cr.
    planes: [Plane; 3],
}

/// Sums of one kind of words, line by line.
#[derive(Debug, Clone)]
struct Plane {
    sums: Vec<OutputSum>,
    width: usize,
}

/// Some lines of a 4:2:2 frame to be filled: luma, Cb, Cr.
#[derive(Debug)]
pub struct Lines<'a>([&'a mut [OutputWord]; 3]);

impl Band {
    /// An empty band of `rows`×`width` pixels (`width` even).
    #[must_use]
    pub fn new(rows: usize, width: usize) -> Self {
        let plane = |width| Plane { sums: vec![OutputSum::ZERO; rows * width], width };
        Self { planes: [width, width / 2, width / 2].map(plane) }
    }

    /// Makes it an empty band of `rows`×`width` pixels.
    pub fn clear(&mut self, rows: usize, width: usize) {
        for (plane, width) in self.planes.iter_mut().zip([width, width / 2, width / 2]) {
            plane.sums.clear();
            plane.sums.resize(rows * width, OutputSum::ZERO);
            plane.width = width;
        }
    }

    /// Adds a patch of 128 words whose corner lies at `row`, `column` (even); what lies outside the band is left out.
    pub fn add_patch(&mut self, words: &[OutputWord], row: isize, column: isize) {
        let (luma, chroma) = words.split_at(PATCH_PIXELS);
        let (cb, cr) = chroma.split_at(PATCH_PIXELS / 2);
        let [sums_luma, sums_cb, sums_cr] = &mut self.planes;
        sums_luma.add_block::<PATCH>(luma, row, column);
        sums_cb.add_block::<{ PATCH / 2 }>(cb, row, column / 2);
        sums_cr.add_block::<{ PATCH / 2 }>(cr, row, column / 2);
    }

    /// Adds lines that another band of the same width has from its line `row` on to the first lines of this one.
    pub fn add_lines(&mut self, other: &Self, row: usize) {
        for (plane, more) in self.planes.iter_mut().zip(&other.planes) {
            let more = &more.sums[row * plane.width..];
            plane.sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
    }

    /// The lines from `rows.start` to `rows.end` alone.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        let part = |plane: &Plane| Plane {
            sums: plane.sums[rows.start * plane.width..rows.end * plane.width].to_vec(),
            width: plane.width,
        };
        Self { planes: self.planes.each_ref().map(part) }
    }

    /// Saturates the sums from line `row` on into as many words as `lines` has; gives how many did not fit.
    pub fn finish(&self, row: usize, lines: &mut Lines<'_>) -> u64 {
        let planes = self.planes.iter().zip(&mut lines.0);
        planes.map(|(plane, words)| saturated(Isa::best(), &plane.sums[row * plane.width..], words)).sum()
    }
}

impl Plane {
    /// Adds a block of lines `SIDE` words long at `row`, `column`, cut at the plane's borders.
    fn add_block<const SIDE: usize>(&mut self, block: &[OutputWord], row: isize, column: isize) {
        let hidden = |start: isize| usize::try_from(-start).unwrap_or(0);
        let visible = |start: isize| usize::try_from(start).unwrap_or(0);
        let lines = self.sums.chunks_exact_mut(self.width).skip(visible(row));
        for (line, words) in lines.zip(block.as_chunks::<SIDE>().0.iter().skip(hidden(row))) {
            let sums = line.get_mut(visible(column)..).unwrap_or_default();
            match sums.first_chunk_mut::<SIDE>() {
                Some(sums) if column >= 0 => add(sums, words),
                _ => add(sums, words.get(hidden(column)..).unwrap_or_default()),
            }
        }
    }
}

/// Writes a block of lines `SIDE` words long into a plane's lines.
fn put_block<const SIDE: usize>(
    plane: &mut [OutputWord],
    width: usize,
    block: &[OutputWord],
    row: usize,
    column: usize,
) {
    let lines = plane.chunks_exact_mut(width).skip(row);
    for (line, words) in lines.zip(block.as_chunks::<SIDE>().0) {
        let line = &mut line[column..];
        match line.first_chunk_mut::<SIDE>() {
            Some(whole) => *whole = *words,
            None => line.copy_from_slice(&words[..line.len()]),
        }
    }
}

/// Adds words to sums.
#[inline]
fn add(sums: &mut [OutputSum], words: &[OutputWord]) {
    sums.iter_mut().zip(words).for_each(|(sum, word)| *sum += OutputSum::from(*word));
}

for_each_isa! {
    /// Saturates sums to words and gives how many did not fit.
    fn saturated(sums: &[OutputSum], words: &mut [OutputWord]) -> u64 {
        let mut clipped = 0u32;
        for (word, sum) in words.iter_mut().zip(sums) {
            // `saturating_from_num` takes four times as long.
            let held = (*sum).clamp(OutputWord::MIN.into(), OutputWord::MAX.into());
            clipped += u32::from(held != *sum);
            *word = OutputWord::wrapping_from_num(held);
        }
        clipped.into()
    }
}

impl<'a> Lines<'a> {
    /// All lines of a frame in standard layout.
    #[must_use]
    pub fn of(frame: &'a mut Frame422) -> Self {
        let [cb, cr] = &mut frame.chroma;
        Self([&mut frame.luma, cb, cr].map(|plane| plane.as_slice_mut().unwrap_or_default()))
    }

    /// Writes a patch of 128 words that no other overlaps, its corner at `row`, `column` (even) of lines of `width` pixels; what lies
    /// outside is left out.
    pub fn put_patch(&mut self, width: usize, words: &[OutputWord], row: usize, column: usize) {
        let (luma, chroma) = words.split_at(PATCH_PIXELS);
        let (cb, cr) = chroma.split_at(PATCH_PIXELS / 2);
        let [lines_luma, lines_cb, lines_cr] = &mut self.0;
        put_block::<PATCH>(lines_luma, width, luma, row, column);
        put_block::<{ PATCH / 2 }>(lines_cb, width / 2, cb, row, column / 2);
        put_block::<{ PATCH / 2 }>(lines_cr, width / 2, cr, row, column / 2);
    }

    /// Takes the first `rows` lines of `width` pixels, or as many as there are.
    #[must_use]
    pub fn take_first(&mut self, rows: usize, width: usize) -> Self {
        let lengths = [width, width / 2, width / 2].into_iter();
        let mut taken = self.0.iter_mut().zip(lengths).map(|(plane, width)| {
            let length = (rows * width).min(plane.len());
            let (first, rest) = std::mem::take(plane).split_at_mut(length);
            *plane = rest;
            first
        });
        Self(std::array::from_fn(|_| taken.next().unwrap_or_default()))
    }
}

/// Adds patches and finishes the frame the slow way, patch by patch: `words(row, column)` are F's words of that patch.
#[must_use]
pub fn overlap_add(
    geometry: Geometry,
    (height, width): (usize, usize),
    mut words: impl FnMut(usize, usize) -> Vec<OutputWord>,
    counts: &mut Counts,
) -> Frame422 {
    let (rows, columns) = geometry.patches(height, width);
    let mut band = Band::new(height, width);
    let mut frame = Frame422::zeros(height, width);
    for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        band.add_patch(&words(row, column), geometry.patch_start(row), geometry.patch_start(column));
    }
    counts.saturated_sums += band.finish(0, &mut Lines::of(&mut frame));
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::overlap::Overlap;
    use edof_core::{Stride, Window};

    #[test]
    fn patches_that_carry_the_averaging_window_add_up_to_an_even_frame() {
        for step in [2, 4, 8] {
            let stride = Stride::new(step).unwrap();
            let g = Geometry::new(Window::new(8).unwrap(), stride);
            let weights = Overlap::Flat.weights(stride);
            let patch: Vec<OutputWord> =
                (0..128).map(|i| OutputWord::from_num(weights[(i / 8 % 8, i % 8)] * 0.5)).collect();
            let mut counts = Counts::new(2);
            let frame = overlap_add(g, (18, 22), |_, _| patch.clone(), &mut counts);
            assert!(frame.luma.iter().all(|v| *v == 0.5), "stride {step}");
            assert!(frame.chroma.iter().flatten().all(|v| *v == 0.5), "stride {step}");
            assert_eq!(counts, Counts::new(2));
        }
    }

    #[test]
    fn a_sum_saturates_once_at_its_end() {
        let g = Geometry::new(Window::new(8).unwrap(), Stride::new(4).unwrap());
        let mut counts = Counts::new(2);
        // Two words of 1.5 and two of −1.5 over every pixel: 0, though partial sums pass 2.
        let frame = overlap_add(
            g,
            (16, 16),
            |_, column| vec![OutputWord::from_num(if column % 2 == 0 { 1.5 } else { -1.5 }); 128],
            &mut counts,
        );
        assert!(frame.luma.iter().all(|v| *v == 0));
        assert_eq!(counts.saturated_sums, 0);
        let frame = overlap_add(g, (16, 16), |_, _| vec![OutputWord::from_num(-1.5); 128], &mut counts);
        assert!(frame.luma.iter().all(|v| *v == OutputWord::MIN));
        assert_eq!(counts.saturated_sums, 2 * 256);
    }
}
