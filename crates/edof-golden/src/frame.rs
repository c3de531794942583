//! Whole frames: every window through the network, patches added up, 4:2:2 out.

use crate::display::{Display, DisplayCounts, Picture};
use crate::fast::{Batch, Fast};
use crate::overlap_add::{Band, Lines, empty_frame, overlap_add};
use crate::scalar;
use crate::trace::Counts;
use crate::windows::{Mirrored, window};
use edof_spec::colour::rgb_from_422;
use edof_spec::fixed_network::FixedNetworkError;
use edof_spec::geometry::{GeometryError, PATCH};
use edof_spec::{CfaPhase, ColourFrame, FixedNetwork, Frame422, Geometry, RawFrame};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// Lines from one strip to the next: at least a patch's, so that strips share lines with their neighbours alone.
const STRIP: usize = 16;

/// The golden pipeline, ready to run frames on all threads.
#[derive(Debug, Clone)]
pub struct Golden {
    fast: Fast,
    geometry: Geometry,
}

/// A reconstructed frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GoldenFrame {
    /// The board's words before the display step, for the frame with red first ([`RawFrame::to_rggb`]): as large as the raw frame,
    /// or two rows or columns larger where its colour filter starts with another colour.
    pub frame: Frame422,
    /// Rows and columns of it that come before the raw frame's first.
    pub offset: (usize, usize),
    /// Rows and columns of the raw frame.
    pub size: (usize, usize),
    /// Counters of all stages.
    pub counts: Counts,
}

impl GoldenFrame {
    /// The frame in linear red, green and blue, as large as the raw frame.
    #[must_use]
    pub fn colour(&self) -> ColourFrame {
        rgb_from_422(&self.frame).crop(self.offset.0, self.offset.1, self.size.0, self.size.1)
    }

    /// The codes that leave the board, as large as the raw frame, and what the display step could not show.
    #[must_use]
    pub fn picture(&self, display: &Display) -> (Picture, DisplayCounts) {
        display.picture(&self.frame, self.offset, self.size)
    }
}

impl Golden {
    /// # Errors
    /// [`FixedNetworkError`] for a network that could not run exactly.
    pub fn new(network: FixedNetwork) -> Result<Self, FixedNetworkError> {
        network.check()?;
        let geometry = Geometry::new(network.form.window, network.stride);
        Ok(Self { fast: Fast::new(network), geometry })
    }

    /// The kernels it runs on, patch by patch.
    #[must_use]
    pub const fn fast(&self) -> &Fast {
        &self.fast
    }

    /// Where patches and windows lie.
    #[must_use]
    pub const fn geometry(&self) -> Geometry {
        self.geometry
    }

    /// The network it runs.
    #[must_use]
    pub const fn network(&self) -> &FixedNetwork {
        self.fast.network()
    }

    /// Reconstructs a frame of any CFA phase. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`GeometryError`] for frames too small for a window.
    pub fn frame(&self, raw: &RawFrame) -> Result<GoldenFrame, GeometryError> {
        self.geometry.check_frame(raw.size())?;
        let (aligned, offset) = match raw.phase() {
            CfaPhase::Rggb => (Cow::Borrowed(raw), (0, 0)),
            _ => {
                let (aligned, offset) = raw.to_rggb();
                (Cow::Owned(aligned), offset)
            }
        };
        let (height, width) = aligned.size();
        let mut frame = empty_frame(height, width);
        let mut strips = self.strips(Lines::of(&mut frame), height, width);
        let done: Vec<(Counts, Seams)> = strips
            .par_iter_mut()
            .map_init(|| Worker::new(self, width), |worker, strip| self.strip(&aligned, strip, worker))
            .collect();
        let mut counts = Counts::new(self.network().form.layers);
        done.iter().for_each(|(part, _)| counts.merge(part));
        for (above, (strip, (_, below))) in done.iter().zip(strips.iter_mut().zip(&done).skip(1)) {
            let mut seam = below.top.clone();
            seam.add_lines(&above.1.bottom, 0);
            counts.saturated_sums += seam.finish(0, &mut strip.seam);
        }
        drop(strips);
        Ok(GoldenFrame { frame, offset, size: raw.size(), counts })
    }

    /// Cuts a frame into strips of a few rows of patches each. The lines of a strip end where the next one's begin.
    fn strips<'a>(&self, mut lines: Lines<'a>, height: usize, width: usize) -> Vec<Strip<'a>> {
        let stride = self.geometry.stride.pixels();
        let (rows, _) = self.geometry.patches(height, width);
        (0..rows)
            .step_by(STRIP / stride)
            .map(|first| {
                let rows = first..rows.min(first + STRIP / stride);
                // The grid's first patches start so far before the frame that its first lines have no strip above.
                let seam = if first == 0 { 0 } else { PATCH - stride };
                let whole = (rows.len() * stride).saturating_sub(PATCH - stride);
                Strip { rows, seam: lines.take_first(seam, width), rest: lines.take_first(whole, width) }
            })
            .collect()
    }

    /// Reconstructs a strip but for the lines that it shares with the one above.
    fn strip(&self, raw: &RawFrame, strip: &mut Strip<'_>, worker: &mut Worker) -> (Counts, Seams) {
        let Worker { batch, mirrored, band } = worker;
        let mut counts = Counts::new(self.network().form.layers);
        let stride = self.geometry.stride.pixels();
        let (_, columns) = self.geometry.patches(PATCH, raw.size().1);
        mirrored.take(raw, strip.rows.clone());
        band.clear();
        let place = |i: usize| (strip.rows.start + i / columns, i % columns);
        let patches = strip.rows.len() * columns;
        for first in (0..patches).step_by(Batch::PATCHES) {
            let some = first..patches.min(first + Batch::PATCHES);
            self.fast.run(batch, some.len(), |i, words| {
                let (row, column) = place(first + i);
                mirrored.copy_window(row, column, words);
            });
            for (i, (row, column)) in some.map(place).enumerate() {
                let line = (row - strip.rows.start) * stride;
                band.add_patch(batch.output(i), line as isize, self.geometry.patch_start(column));
                counts.add(batch.stages(i));
            }
        }
        let (shared, end) = (PATCH - stride, strip.rows.len() * stride);
        counts.saturated_sums += band.finish(shared, &mut strip.rest);
        (counts, Seams { top: band.part(0..shared), bottom: band.part(end..end + shared) })
    }
}

/// A few rows of patches, and the lines of the frame between the first one's and the first one's of the strip below.
struct Strip<'a> {
    rows: Range<usize>,
    /// The lines that patches of the strip above cover, too.
    seam: Lines<'a>,
    rest: Lines<'a>,
}

/// Sums of the lines that a strip shares with its neighbours.
struct Seams {
    top: Band,
    bottom: Band,
}

/// What a thread needs of its own.
struct Worker {
    batch: Batch,
    mirrored: Mirrored,
    band: Band,
}

impl Worker {
    fn new(golden: &Golden, width: usize) -> Self {
        Self {
            batch: Batch::new(&golden.fast),
            mirrored: Mirrored::empty(golden.geometry),
            band: Band::new(STRIP + PATCH, width),
        }
    }
}

/// The specification's frame, one patch after the other: slow, and equal to [`Golden::frame`] in every word and count.
///
/// # Errors
/// [`GeometryError`] for frames too small for a window.
pub fn scalar_frame(network: &FixedNetwork, raw: &RawFrame) -> Result<GoldenFrame, GeometryError> {
    let geometry = Geometry::new(network.form.window, network.stride);
    geometry.check_frame(raw.size())?;
    let (aligned, offset) = raw.to_rggb();
    let (height, width) = aligned.size();
    let mut patches = Counts::new(network.form.layers);
    let mut sums = Counts::new(network.form.layers);
    let patch = |row, column| {
        let trace = scalar::run(network, &window(&aligned, geometry, row, column));
        patches.add(&trace.stages);
        trace.output
    };
    let frame = overlap_add(geometry, (height, width), patch, &mut sums);
    patches.merge(&sums);
    Ok(GoldenFrame { frame, offset, size: raw.size(), counts: patches })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::CfaPhase;
    use ndarray::Array2;

    #[test]
    fn a_frame_too_small_is_refused_alike_in_all_phases_by_the_size_that_was_given() {
        let golden = Golden::new(edof_random::natural(8, 8, 1)).unwrap();
        let frame = |side, phase| {
            golden.frame(&RawFrame::from_values(Array2::zeros((side, side)), 8, phase).unwrap())
        };
        for phase in CfaPhase::ALL {
            let error = frame(8, phase).unwrap_err().to_string();
            assert_eq!(error, "frame 8x8: both sides must be at least 10 pixels for a window of 8");
            assert_eq!(frame(10, phase).unwrap().colour().size(), (10, 10));
        }
    }
}
