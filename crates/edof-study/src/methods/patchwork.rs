//! Frames as patches: raw windows in rows of a matrix, and reconstructed patches added up to a frame again.

use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, PATCH_PIXELS, mirror};
use edof_core::overlap::Overlap;
use edof_core::{ColourFrame, Geometry, RawFrame, ReconstructError, Stride, Window};
use ndarray::{Array2, ArrayView2};

/// Patches that are at work at a time, about: what bounds the memory, however large the frame.
const BAND: usize = 4096;

/// How frames are taken apart and put together.
#[derive(Debug, Clone)]
pub struct Patchwork {
    geometry: Geometry,
    averaging: Array2<f32>,
}

impl Patchwork {
    /// Patches at a stride, averaged with raised cosines where they overlap.
    #[must_use]
    pub fn new(window: Window, stride: Stride) -> Self {
        let averaging = Overlap::default().weights(stride).mapv(|w| w as f32);
        Self { geometry: Geometry::new(window, stride), averaging }
    }

    /// The frame that `patches` makes of raw windows (rows of 0…1, red first; one patch of 192 values, plane by plane, for each), and
    /// how many patches that were. Windows come in bands of whole rows of patches.
    ///
    /// # Errors
    /// [`ReconstructError`] for frames that are odd or smaller than a window needs.
    pub fn frame(
        &self,
        raw: &RawFrame,
        mut patches: impl FnMut(ArrayView2<'_, f32>) -> Array2<f32>,
    ) -> Result<(ColourFrame, usize), ReconstructError> {
        let (height, width) = raw.size();
        self.geometry.check_frame((height, width))?;
        let (aligned, (row, column)) = raw.to_rggb();
        let (rows, columns) = self.geometry.patches(aligned.size().0, aligned.size().1);
        let mut frame = ColourFrame::zeros(aligned.size().0, aligned.size().1);
        let band = (BAND / columns).max(1);
        for first in (0..rows).step_by(band) {
            let places: Vec<(usize, usize)> =
                (first..rows.min(first + band)).flat_map(|r| (0..columns).map(move |c| (r, c))).collect();
            let made = patches(self.windows(&aligned, &places).view());
            for (patch, place) in made.outer_iter().zip(places) {
                self.add(&mut frame, patch.as_slice().unwrap_or_default(), place);
            }
        }
        Ok((frame.crop(row, column, height, width), rows * columns))
    }

    /// The windows around patches, as rows.
    fn windows(&self, raw: &RawFrame, places: &[(usize, usize)]) -> Array2<f32> {
        let (height, width) = raw.size();
        let side = self.geometry.window.side();
        let mut windows = Array2::zeros((places.len(), side * side));
        for (mut window, &(row, column)) in windows.outer_iter_mut().zip(places) {
            let (top, left) = (self.geometry.window_start(row), self.geometry.window_start(column));
            window.indexed_iter_mut().for_each(|(i, v)| {
                let at =
                    (mirror(top + (i / side) as isize, height), mirror(left + (i % side) as isize, width));
                *v = f32::from(raw.pixels()[at]) / 65536.0;
            });
        }
        windows
    }

    fn add(&self, frame: &mut ColourFrame, patch: &[f32], (row, column): (usize, usize)) {
        debug_assert_eq!(patch.len(), RGB_OUTPUTS);
        let (height, width) = frame.size();
        let (top, left) = (self.geometry.patch_start(row), self.geometry.patch_start(column));
        for (i, &value) in patch.iter().enumerate() {
            let (plane, r, c) = (i / PATCH_PIXELS, i % PATCH_PIXELS / PATCH, i % PATCH);
            let inside = |at: isize, n: usize| usize::try_from(at).ok().filter(|at| *at < n);
            if let (Some(y), Some(x)) = (inside(top + r as isize, height), inside(left + c as isize, width)) {
                frame.planes[(plane, y, x)] += value * self.averaging[(r, c)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::CfaPhase;

    /// Each patch shows the raw pixels at its place in all three colours.
    #[test]
    fn what_is_taken_apart_comes_together_again() {
        for phase in CfaPhase::ALL {
            for (window, stride) in [(8, 8), (8, 2), (12, 4)] {
                let values = Array2::from_shape_fn((22, 34), |(r, c)| (r * 1700 + c * 31) as u16);
                let raw = RawFrame::from_values(values, 16, phase).unwrap();
                let window = Window::new(window).unwrap();
                let work = Patchwork::new(window, Stride::new(stride).unwrap());
                let (frame, _) = work
                    .frame(&raw, |windows| {
                        Array2::from_shape_fn((windows.nrows(), RGB_OUTPUTS), |(patch, i)| {
                            let (r, c) = (i % PATCH_PIXELS / PATCH, i % PATCH);
                            windows[(patch, (r + window.margin()) * window.side() + c + window.margin())]
                        })
                    })
                    .unwrap();
                for ((_, r, c), &v) in frame.planes.indexed_iter() {
                    assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1e-5, "{phase} {r} {c}");
                }
            }
        }
    }
}
