//! The sum of overlapping patches: the board's 4:2:2 frame in words.
//!
//! F's weights carry the averaging window, so here is only addition: words of all patches over a pixel are summed in 32 bits
//! (at most 16 words of 16 bits), saturated to 16 bits once a pixel.

use crate::trace::Counts;
use edof_spec::geometry::{PATCH, PATCH_PIXELS};
use edof_spec::number::saturate;
use edof_spec::{Frame422, Geometry};
use ndarray::Array2;

/// Sums of words over a band of lines.
#[derive(Debug, Clone)]
pub struct Band {
    /// Rows × columns.
    luma: Array2<i32>,
    /// Cb and Cr: rows × columns/2.
    chroma: [Array2<i32>; 2],
}

impl Band {
    /// An empty band of `rows`×`width` pixels (`width` even).
    #[must_use]
    pub fn new(rows: usize, width: usize) -> Self {
        let chroma = || Array2::zeros((rows, width / 2));
        Self { luma: Array2::zeros((rows, width)), chroma: [chroma(), chroma()] }
    }

    /// Empties the band.
    pub fn clear(&mut self) {
        self.planes_mut().for_each(|plane| plane.fill(0));
    }

    /// Adds a patch of 128 words whose corner lies at `row`, `column` (even); what lies outside the band is left out.
    pub fn add_patch(&mut self, words: &[i16], row: isize, column: isize) {
        let (luma, chroma) = words.split_at(PATCH_PIXELS);
        let (cb, cr) = chroma.split_at(PATCH_PIXELS / 2);
        let [sum_cb, sum_cr] = &mut self.chroma;
        add_block(&mut self.luma, luma, PATCH, row, column);
        add_block(sum_cb, cb, PATCH / 2, row, column / 2);
        add_block(sum_cr, cr, PATCH / 2, row, column / 2);
    }

    /// Adds a band of the same width whose first line is this one's line `row`; what lies outside is left out.
    pub fn add_band(&mut self, other: &Self, row: isize) {
        let first = usize::try_from(-row).unwrap_or(0);
        let start = usize::try_from(row).unwrap_or(0);
        for (plane, more) in self.planes_mut().zip([&other.luma, &other.chroma[0], &other.chroma[1]]) {
            let lines = plane.outer_iter_mut().skip(start).zip(more.outer_iter().skip(first));
            lines.for_each(|(mut line, more)| line += &more);
        }
    }

    /// Saturates the sums to the 4:2:2 frame and counts what did not fit.
    #[must_use]
    pub fn finish(&self, counts: &mut Counts) -> Frame422 {
        let mut words = |sums: &Array2<i32>| {
            counts.saturated_sums += sums.iter().filter(|s| i32::from(**s as i16) != **s).count() as u64;
            sums.mapv(|s| saturate(s.into(), 16).0)
        };
        Frame422 { luma: words(&self.luma), chroma: self.chroma.each_ref().map(words) }
    }

    fn planes_mut(&mut self) -> impl Iterator<Item = &mut Array2<i32>> {
        std::iter::once(&mut self.luma).chain(&mut self.chroma)
    }
}

/// Adds patches and finishes the frame the slow way, patch by patch: `words(row, column)` are F's words of that patch.
#[must_use]
pub fn overlap_add(
    geometry: Geometry,
    (height, width): (usize, usize),
    mut words: impl FnMut(usize, usize) -> Vec<i16>,
    counts: &mut Counts,
) -> Frame422 {
    let (rows, columns) = geometry.patches(height, width);
    let mut band = Band::new(height, width);
    for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        band.add_patch(&words(row, column), geometry.patch_start(row), geometry.patch_start(column));
    }
    band.finish(counts)
}

/// Adds a block of lines `side` words long at `row`, `column` of a plane, cut at the plane's borders.
fn add_block(plane: &mut Array2<i32>, block: &[i16], side: usize, row: isize, column: isize) {
    let hidden = |start: isize| usize::try_from(-start).unwrap_or(0);
    let visible = |start: isize| usize::try_from(start).unwrap_or(0);
    let lines = plane.outer_iter_mut().skip(visible(row)).zip(block.chunks_exact(side).skip(hidden(row)));
    for (mut line, words) in lines {
        let sums = line.iter_mut().skip(visible(column));
        sums.zip(words.iter().skip(hidden(column))).for_each(|(sum, word)| *sum += i32::from(*word));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::overlap::Overlap;
    use edof_spec::{Stride, Window};

    #[test]
    fn patches_that_carry_the_averaging_window_add_up_to_an_even_frame() {
        for step in [2, 4, 8] {
            let stride = Stride::new(step).unwrap();
            let g = Geometry::new(Window::new(8).unwrap(), stride);
            let weights = Overlap::Flat.weights(stride);
            let patch: Vec<i16> = (0..128).map(|i| (weights[(i / 8 % 8, i % 8)] * 8192.0) as i16).collect();
            let mut counts = Counts::new(2);
            let frame = overlap_add(g, (18, 22), |_, _| patch.clone(), &mut counts);
            assert!(frame.luma.iter().all(|v| *v == 8192), "stride {step}");
            assert!(frame.chroma.iter().flatten().all(|v| *v == 8192), "stride {step}");
            assert_eq!(counts, Counts::new(2));
        }
    }

    #[test]
    fn a_sum_saturates_once_at_its_end() {
        let g = Geometry::new(Window::new(8).unwrap(), Stride::new(4).unwrap());
        let mut sign = 1;
        let mut counts = Counts::new(2);
        // Two words of 30000 and two of −30000 over every pixel: 0, though partial sums pass 32767.
        let frame = overlap_add(
            g,
            (16, 16),
            |_, column| {
                sign = if column % 2 == 0 { 30000 } else { -30000 };
                vec![sign; 128]
            },
            &mut counts,
        );
        assert!(frame.luma.iter().all(|v| *v == 0));
        assert_eq!(counts.saturated_sums, 0);
        let frame = overlap_add(g, (16, 16), |_, _| vec![-30000; 128], &mut counts);
        assert!(frame.luma.iter().all(|v| *v == i16::MIN));
        assert_eq!(counts.saturated_sums, 2 * 256);
    }
}
