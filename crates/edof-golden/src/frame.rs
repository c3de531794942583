//! Whole frames: every window through the network, patches added up, 4:2:2 out.

use crate::display::{Display, DisplayCounts, Picture};
use crate::fast::{Batch, Fast};
use crate::overlap_add::{Band, overlap_add};
use crate::scalar;
use crate::trace::Counts;
use crate::windows::{Mirrored, window};
use edof_spec::colour::rgb_from_422;
use edof_spec::fixed_network::FixedNetworkError;
use edof_spec::geometry::{GeometryError, PATCH};
use edof_spec::{ColourFrame, FixedNetwork, Frame422, Geometry, RawFrame};
use rayon::prelude::*;

/// Rows of patches that are summed before they go into the frame: bounds the memory of wide overlaps.
const ROWS_AT_ONCE: usize = 32;

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
        let (aligned, offset) = raw.to_rggb();
        let (height, width) = aligned.size();
        let mirrored = Mirrored::new(&aligned, self.geometry);
        let (rows, _) = self.geometry.patches(height, width);
        let mut counts = Counts::new(self.network().form.layers);
        let mut sums = Band::new(height, width);
        let all: Vec<usize> = (0..rows).collect();
        for some in all.chunks(ROWS_AT_ONCE) {
            let bands: Vec<(Band, Counts)> = some
                .par_iter()
                .map_init(
                    || Batch::new(&self.fast),
                    |batch, &row| self.patch_row(&mirrored, row, width, batch),
                )
                .collect();
            for (&row, (band, part)) in some.iter().zip(&bands) {
                sums.add_band(band, self.geometry.patch_start(row));
                counts.merge(part);
            }
        }
        let frame = sums.finish(&mut counts);
        Ok(GoldenFrame { frame, offset, size: raw.size(), counts })
    }

    /// One row of patches, added up sideways.
    fn patch_row(&self, mirrored: &Mirrored, row: usize, width: usize, batch: &mut Batch) -> (Band, Counts) {
        let mut band = Band::new(PATCH, width);
        let mut counts = Counts::new(self.network().form.layers);
        let (_, columns) = self.geometry.patches(PATCH, width);
        for first in (0..columns).step_by(Batch::PATCHES) {
            let some = first..columns.min(first + Batch::PATCHES);
            self.fast.run(batch, some.len(), |i, words| mirrored.copy_window(row, first + i, words));
            for (i, column) in some.enumerate() {
                band.add_patch(batch.output(i), 0, self.geometry.patch_start(column));
                counts.add(batch.stages(i));
            }
        }
        (band, counts)
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
