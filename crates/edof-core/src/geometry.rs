//! Windows, strides, and where on a frame the patches lie.
//!
//! A network sees a window of w×w raw pixels and gives the 8×8 patch at its centre. Patches lie on a grid of the given
//! stride that covers every pixel equally often, so the grid starts before the frame's corner where patches overlap, and
//! windows reach beyond the frame by [`Geometry::reach`]; there the frame is mirrored (see [`mirror`]).

use serde::{Deserialize, Serialize};

/// Side of an output patch in pixels.
pub const PATCH: usize = 8;
/// Pixels of an output patch.
pub const PATCH_PIXELS: usize = PATCH * PATCH;

/// A window, stride or frame that the system cannot work with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum GeometryError {
    /// Not one of the supported windows.
    #[error("window {0}: must be 8, 12 or 16")]
    Window(usize),
    /// Not an even stride that divides 8.
    #[error("stride {0}: must be 2, 4 or 8, so that every window starts at the same Bayer phase")]
    Stride(usize),
    /// A Bayer frame has whole 2×2 cells.
    #[error("frame {width}x{height}: both sides must be even, so that it holds whole 2x2 Bayer cells")]
    OddFrame { height: usize, width: usize },
    /// Mirroring needs at least one window of pixels.
    #[error("frame {width}x{height}: both sides must be at least {min} pixels for a window of {window}")]
    SmallFrame { height: usize, width: usize, min: usize, window: usize },
}

/// Side w of the raw window that a network sees: 8, 12 or 16 pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "usize", into = "usize")]
pub struct Window(usize);

impl Window {
    /// As large as a patch: the paper's.
    pub const PATCH: Self = Self(PATCH);

    /// # Errors
    /// [`GeometryError::Window`] for any side but 8, 12 and 16.
    pub const fn new(side: usize) -> Result<Self, GeometryError> {
        match side {
            8 | 12 | 16 => Ok(Self(side)),
            _ => Err(GeometryError::Window(side)),
        }
    }

    /// Pixels along one side.
    #[must_use]
    pub const fn side(self) -> usize {
        self.0
    }

    /// Pixels in the window: the network's inputs.
    #[must_use]
    pub const fn pixels(self) -> usize {
        self.0 * self.0
    }

    /// Pixels between the window's border and its patch; always even, so the patch keeps the window's Bayer phase.
    #[must_use]
    pub const fn margin(self) -> usize {
        (self.0 - PATCH) / 2
    }
}

impl TryFrom<usize> for Window {
    type Error = GeometryError;

    fn try_from(side: usize) -> Result<Self, GeometryError> {
        Self::new(side)
    }
}

impl From<Window> for usize {
    fn from(w: Window) -> Self {
        w.0
    }
}

/// Pixels from one patch to the next: 2, 4 or 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "usize", into = "usize")]
pub struct Stride(usize);

impl Stride {
    /// Patches side by side, no overlap.
    pub const PATCH: Self = Self(PATCH);
    /// The smallest: the windows and patches of every other stride are among its own.
    pub const FINEST: Self = Self(2);

    /// # Errors
    /// [`GeometryError::Stride`] for any step but 2, 4 and 8.
    pub const fn new(step: usize) -> Result<Self, GeometryError> {
        match step {
            2 | 4 | 8 => Ok(Self(step)),
            _ => Err(GeometryError::Stride(step)),
        }
    }

    /// Pixels.
    #[must_use]
    pub const fn pixels(self) -> usize {
        self.0
    }
}

impl TryFrom<usize> for Stride {
    type Error = GeometryError;

    fn try_from(step: usize) -> Result<Self, GeometryError> {
        Self::new(step)
    }
}

impl From<Stride> for usize {
    fn from(s: Stride) -> Self {
        s.0
    }
}

/// Window and stride together: where patches lie on a frame and which raw pixels each of them sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Geometry {
    /// Side of the raw window.
    pub window: Window,
    /// Step of the patch grid.
    pub stride: Stride,
}

impl Geometry {
    /// Any window goes with any stride.
    #[must_use]
    pub const fn new(window: Window, stride: Stride) -> Self {
        Self { window, stride }
    }

    /// Rows and columns of patches on a frame of `height`×`width` pixels, so that every pixel lies in (8/stride)² patches.
    #[must_use]
    pub const fn patches(self, height: usize, width: usize) -> (usize, usize) {
        (self.patches_along(height), self.patches_along(width))
    }

    /// First row (or column) of patch `index` along one axis; negative where the grid starts before the frame.
    #[must_use]
    pub const fn patch_start(self, index: usize) -> isize {
        (index * self.stride.0) as isize - (PATCH - self.stride.0) as isize
    }

    /// First row (or column) of the window around patch `index`.
    #[must_use]
    pub const fn window_start(self, index: usize) -> isize {
        self.patch_start(index) - self.window.margin() as isize
    }

    /// How far beyond the frame windows read, at most: before the first pixel by less than this, after the last by
    /// less than this.
    #[must_use]
    pub const fn reach(self) -> usize {
        PATCH + self.window.margin()
    }

    /// Whether a raw frame of these rows and columns can be reconstructed. Asked of the frame as the sensor gives it, before it is
    /// made red-first ([`crate::RawFrame::to_rggb`]), so that the answer is the same for all CFA phases and names a size that the
    /// user knows.
    ///
    /// # Errors
    /// [`GeometryError::OddFrame`] or [`GeometryError::SmallFrame`].
    pub const fn check_frame(self, (height, width): (usize, usize)) -> Result<(), GeometryError> {
        if !height.is_multiple_of(2) || !width.is_multiple_of(2) {
            return Err(GeometryError::OddFrame { height, width });
        }
        let min = self.reach() + 2;
        if height < min || width < min {
            return Err(GeometryError::SmallFrame { height, width, min, window: self.window.0 });
        }
        Ok(())
    }

    const fn patches_along(self, length: usize) -> usize {
        (length + PATCH - self.stride.0).div_ceil(self.stride.0)
    }
}

/// Index inside 0..length that stands for `index` when the frame is mirrored about its edge pixel (… c b | a b c …). It keeps
/// the Bayer phase for even lengths. `index` may lie outside by less than `length` − 1 on either side.
///
/// ```
/// use edof_core::geometry::mirror;
/// assert_eq!([-2, -1, 0, 5, 6, 7].map(|i| mirror(i, 6)), [2, 1, 0, 5, 4, 3]);
/// ```
#[must_use]
pub const fn mirror(index: isize, length: usize) -> usize {
    let last = length as isize - 1;
    let folded = if index < 0 { -index } else { index };
    (if folded > last { 2 * last - folded } else { folded }) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_window_moved_by_an_odd_stride_is_rejected() {
        assert_eq!(
            Stride::new(3).unwrap_err().to_string(),
            "stride 3: must be 2, 4 or 8, so that every window starts at the same Bayer phase"
        );
    }

    #[test]
    fn an_odd_or_small_frame_is_rejected() {
        let g = Geometry::new(Window(12), Stride(8));
        assert!(matches!(g.check_frame((31, 40)), Err(GeometryError::OddFrame { .. })));
        assert!(matches!(g.check_frame((8, 40)), Err(GeometryError::SmallFrame { .. })));
        assert_eq!(g.check_frame((1080, 1920)), Ok(()));
    }

    proptest! {
        #[test]
        fn every_pixel_lies_in_equally_many_patches(
            length in 6usize..40, step in prop::sample::select(vec![2usize, 4, 8])
        ) {
            let length = 2 * length;
            let g = Geometry::new(Window(8), Stride(step));
            let (n, _) = g.patches(length, length);
            for pixel in 0..length as isize {
                let covers = (0..n).filter(|&i| (0..8).contains(&(pixel - g.patch_start(i)))).count();
                prop_assert_eq!(covers, PATCH / step);
            }
        }

        #[test]
        fn windows_stay_within_reach_and_mirroring_keeps_the_phase(
            half in 10usize..40, side in prop::sample::select(vec![8usize, 12, 16]),
            step in prop::sample::select(vec![2usize, 4, 8])
        ) {
            let length = 2 * half;
            let g = Geometry::new(Window(side), Stride(step));
            prop_assume!(g.check_frame((length, length)).is_ok());
            for i in 0..g.patches(length, length).0 {
                for offset in 0..side as isize {
                    let at = g.window_start(i) + offset;
                    prop_assert!(at > -(g.reach() as isize) && at < (length + g.reach()) as isize);
                    let inside = mirror(at, length);
                    prop_assert!(inside < length);
                    prop_assert_eq!(inside as isize & 1, at & 1);
                }
            }
        }
    }
}
