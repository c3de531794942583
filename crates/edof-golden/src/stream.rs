//! Frames one after the other, in memory that is kept: strips of a few rows of patches, each on the next thread that is free.

use crate::fast::Batch;
use crate::frame::{Golden, GoldenFrame};
use crate::overlap_add::{Band, Lines};
use crate::trace::Counts;
use crate::windows::Mirrored;
use edof_core::geometry::{GeometryError, PATCH};
use edof_core::{Frame422, RawFrame};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Lines from one strip to the next: at least a patch's, so that strips share lines with their neighbours alone.
const STRIP: usize = 16;

/// A golden pipeline with room for its frames: after the first one of a size nothing is allocated but what the strips share.
///
/// ```
/// use edof_golden::Golden;
/// use edof_core::{CfaPhase, RawFrame};
/// use ndarray::Array2;
///
/// let golden = Golden::new(edof_device::random::natural(12, 8, 1))?;
/// let mut stream = golden.stream();
/// for light in [900, 1800] {
///     let raw = RawFrame::from_values(Array2::from_elem((32, 48), light), 12, CfaPhase::Rggb)?;
///     assert_eq!(*stream.frame(&raw)?, golden.frame(&raw)?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Stream<'a> {
    golden: &'a Golden,
    /// One a thread, made when it takes its first strip.
    workers: Vec<Option<Worker>>,
    last: GoldenFrame,
}

impl Golden {
    /// Reconstructs a frame of any CFA phase. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// [`GeometryError`] for frames too small for a window.
    pub fn frame(&self, raw: &RawFrame) -> Result<GoldenFrame, GeometryError> {
        let mut stream = self.stream();
        stream.frame(raw)?;
        Ok(stream.into_last())
    }

    /// Room for frames one after the other.
    #[must_use]
    pub fn stream(&self) -> Stream<'_> {
        Stream::new(self)
    }
}

impl<'a> Stream<'a> {
    /// Room for as many threads as there are here.
    #[must_use]
    pub fn new(golden: &'a Golden) -> Self {
        Self {
            golden,
            workers: (0..rayon::current_num_threads()).map(|_| None).collect(),
            last: GoldenFrame {
                frame: Frame422::zeros(0, 0),
                offset: (0, 0),
                size: (0, 0),
                counts: Counts::default(),
            },
        }
    }

    /// The last frame.
    #[must_use]
    pub fn into_last(self) -> GoldenFrame {
        self.last
    }

    /// [`Golden::frame`].
    ///
    /// # Errors
    /// [`GeometryError`] for frames too small for a window.
    pub fn frame(&mut self, raw: &RawFrame) -> Result<&GoldenFrame, GeometryError> {
        self.golden.geometry().check_frame(raw.size())?;
        let (aligned, offset) = raw.to_rggb();
        let (golden, last) = (self.golden, &mut self.last);
        let (height, width) = aligned.size();
        if last.frame.luma.dim() != (height, width) {
            last.frame = Frame422::zeros(height, width);
        }
        (last.offset, last.size) = (offset, raw.size());
        let mut strips = strips(golden, Lines::of(&mut last.frame), height, width);
        let next = Mutex::new(strips.iter_mut());
        self.workers.par_iter_mut().for_each(|worker| {
            while let Some(strip) = take_next(&next) {
                worker.get_or_insert_with(|| Worker::new(golden)).run(golden, &aligned, strip);
            }
        });
        last.counts = Counts::new(golden.network().form.layers);
        last.counts.saturated_sums += add_seams(&mut strips);
        strips.iter().for_each(|strip| last.counts.merge(&strip.counts));
        Ok(&self.last)
    }
}

/// The lock is held for no longer than this takes.
fn take_next<T>(next: &Mutex<impl Iterator<Item = T>>) -> Option<T> {
    next.lock().unwrap_or_else(PoisonError::into_inner).next()
}

/// A few rows of patches, and the lines of the frame between the first one's and the first one's of the strip below.
struct Strip<'a> {
    rows: Range<usize>,
    /// The lines that patches of the strip above cover, too.
    seam: Lines<'a>,
    rest: Lines<'a>,
    counts: Counts,
    /// Sums of the lines shared with the strips above and below; none where patches do not overlap.
    shared: Option<[Band; 2]>,
}

/// Cuts a frame into strips of a few rows of patches each. The lines of a strip end where the next one's begin.
fn strips<'a>(golden: &Golden, mut lines: Lines<'a>, height: usize, width: usize) -> Vec<Strip<'a>> {
    let stride = golden.geometry().stride.pixels();
    let (rows, _) = golden.geometry().patches(height, width);
    (0..rows)
        .step_by(STRIP / stride)
        .map(|first| {
            let rows = first..rows.min(first + STRIP / stride);
            // The grid's first patches start so far before the frame that its first lines have no strip above.
            let seam = if first == 0 { 0 } else { PATCH - stride };
            let whole = (rows.len() * stride).saturating_sub(PATCH - stride);
            let (seam, rest) = (lines.take_first(seam, width), lines.take_first(whole, width));
            Strip { rows, seam, rest, counts: Counts::new(golden.network().form.layers), shared: None }
        })
        .collect()
}

/// Finishes the lines that strips share; gives how many words did not fit.
fn add_seams(strips: &mut [Strip<'_>]) -> u64 {
    let mut saturated = 0;
    for i in 1..strips.len() {
        let (above, below) = strips.split_at_mut(i);
        let (above, below) = (&above[i - 1], &mut below[0]);
        if let (Some([_, bottom]), Some([top, _])) = (&above.shared, &mut below.shared) {
            top.add_lines(bottom, 0);
            saturated += top.finish(0, &mut below.seam);
        }
    }
    saturated
}

/// What a thread needs of its own.
#[derive(Debug)]
struct Worker {
    batch: Batch,
    mirrored: Mirrored,
    band: Band,
}

impl Worker {
    fn new(golden: &Golden) -> Self {
        Self {
            batch: Batch::new(golden.fast()),
            mirrored: Mirrored::empty(golden.geometry()),
            band: Band::new(0, 0),
        }
    }

    /// Reconstructs a strip except for the lines that it shares with the one above.
    fn run(&mut self, golden: &Golden, raw: &RawFrame, strip: &mut Strip<'_>) {
        let (geometry, width) = (golden.geometry(), raw.size().1);
        let stride = geometry.stride.pixels();
        let (_, columns) = geometry.patches(PATCH, width);
        let (first_row, patches) = (strip.rows.start, strip.rows.len() * columns);
        let overlap = stride < PATCH;
        self.mirrored.take(raw, strip.rows.clone());
        if overlap {
            self.band.clear(STRIP + PATCH, width);
        }
        let place = |i: usize| (i / columns, i % columns);
        for first in (0..patches).step_by(Batch::PATCHES) {
            let some = first..patches.min(first + Batch::PATCHES);
            golden.fast().run(&mut self.batch, some.len(), |i, words| {
                let (row, column) = place(first + i);
                self.mirrored.copy_window(first_row + row, column, words);
            });
            for (i, (row, column)) in some.map(place).enumerate() {
                let (words, line, left) = (self.batch.output(i), row * stride, geometry.patch_start(column));
                if overlap {
                    self.band.add_patch(words, line as isize, left);
                } else {
                    strip.rest.put_patch(width, words, line, left as usize);
                }
                strip.counts.add(self.batch.stages(i));
            }
        }
        if overlap {
            let (shared, end) = (PATCH - stride, strip.rows.len() * stride);
            strip.counts.saturated_sums += self.band.finish(shared, &mut strip.rest);
            strip.shared = Some([self.band.part(0..shared), self.band.part(end..end + shared)]);
        }
    }
}
