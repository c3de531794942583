//! Frames: raw Bayer words, linear colour, and the board's 4:2:2 output.

use crate::cfa::CfaPhase;
use crate::geometry::{GeometryError, mirror};
use crate::number::OutputWord;
use ndarray::{Array2, Array3, ArrayView2};
use std::borrow::Cow;

/// A raw Bayer frame. Words of 16 bits hold `depth` bits aligned to the top; full scale (1.0 in linear light) is 65536.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawFrame {
    pixels: Array2<u16>,
    depth: u32,
    phase: CfaPhase,
}

/// A frame that is not a raw frame.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum FrameError {
    /// Sides that hold no whole Bayer cells.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Sensors of 8 to 16 bits are supported.
    #[error("bit depth {0}: must be 8 to 16")]
    Depth(u32),
    /// A word is larger than its depth allows.
    #[error("pixel at row {row}, column {column} is {value}, more than {depth} bits can hold")]
    Value { row: usize, column: usize, value: u16, depth: u32 },
}

impl RawFrame {
    /// A frame of sensor values 0…2^depth − 1, as sensors and files give them.
    ///
    /// # Errors
    /// [`FrameError`] for odd sides, a depth outside 8…16 or a value that does not fit the depth.
    pub fn from_values(values: Array2<u16>, depth: u32, phase: CfaPhase) -> Result<Self, FrameError> {
        Self::check(values.view(), depth)?;
        Ok(Self { pixels: values.mapv_into(|v| v << (16 - depth)), depth, phase })
    }

    /// As [`RawFrame::from_values`], of somebody else's memory in any layout: words are aligned in the one pass that reads it.
    ///
    /// # Errors
    /// As [`RawFrame::from_values`].
    pub fn from_view(values: ArrayView2<'_, u16>, depth: u32, phase: CfaPhase) -> Result<Self, FrameError> {
        Self::check(values, depth)?;
        let mut pixels = Array2::zeros(values.raw_dim());
        ndarray::Zip::from(&mut pixels).and(values).for_each(|word, value| *word = value << (16 - depth));
        Ok(Self { pixels, depth, phase })
    }

    fn check(values: ArrayView2<'_, u16>, depth: u32) -> Result<(), FrameError> {
        if !(8..=16).contains(&depth) {
            return Err(FrameError::Depth(depth));
        }
        let (height, width) = values.dim();
        if height % 2 != 0 || width % 2 != 0 || height == 0 || width == 0 {
            return Err(GeometryError::OddFrame { height, width }.into());
        }
        if depth < 16
            && let Some(((row, column), &value)) =
                values.indexed_iter().find(|(_, v)| u32::from(**v) >> depth != 0)
        {
            return Err(FrameError::Value { row, column, value, depth });
        }
        Ok(())
    }

    /// Words aligned to the top of 16 bits, rows × columns.
    #[must_use]
    pub const fn pixels(&self) -> &Array2<u16> {
        &self.pixels
    }

    /// The memory of its words, for another frame.
    #[must_use]
    pub fn into_pixels(self) -> Array2<u16> {
        self.pixels
    }

    /// Sensor values 0…2^depth − 1, as [`RawFrame::from_values`] takes them.
    #[must_use]
    pub fn values(&self) -> Array2<u16> {
        self.pixels.mapv(|v| v >> (16 - self.depth))
    }

    /// Bits that the sensor gives.
    #[must_use]
    pub const fn depth(&self) -> u32 {
        self.depth
    }

    /// Colour filter of the first pixel.
    #[must_use]
    pub const fn phase(&self) -> CfaPhase {
        self.phase
    }

    /// Rows and columns.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        self.pixels.dim()
    }

    /// The frame with each word made into another of 16 bits.
    pub(crate) fn mapped(&self, word: impl Fn(u16) -> u16) -> Self {
        Self { pixels: self.pixels.mapv(word), depth: 16, phase: self.phase }
    }

    /// The frame with the bits of each word that the mask has.
    #[must_use]
    pub fn with_mask(&self, mask: u16) -> Self {
        Self { pixels: self.pixels.mapv(|word| word & mask), ..*self }
    }

    /// The frame as every network wants it, red first: other phases get a mirrored row or column before the first and after
    /// the last. The second value says how many rows and columns (0 or 1) came before; results are cropped by as many.
    #[must_use]
    pub fn to_rggb(&self) -> (Cow<'_, Self>, (usize, usize)) {
        let (dr, dc) = self.phase.red_site();
        if (dr, dc) == (0, 0) {
            return (Cow::Borrowed(self), (0, 0));
        }
        let (height, width) = self.size();
        let pixels = Array2::from_shape_fn((height + 2 * dr, width + 2 * dc), |(r, c)| {
            let row = mirror(r as isize - dr as isize, height);
            self.pixels[(row, mirror(c as isize - dc as isize, width))]
        });
        (Cow::Owned(Self { pixels, depth: self.depth, phase: CfaPhase::Rggb }), (dr, dc))
    }
}

/// Linear light, nominally 0…1: 3 planes (red, green, blue) × rows × columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourFrame {
    /// Shape (3, rows, columns).
    pub planes: Array3<f32>,
}

impl ColourFrame {
    /// A black frame.
    #[must_use]
    pub fn zeros(height: usize, width: usize) -> Self {
        Self { planes: Array3::zeros((3, height, width)) }
    }

    /// Rows and columns.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        let (_, height, width) = self.planes.dim();
        (height, width)
    }

    /// The `height`×`width` part that starts at `row`, `column`.
    #[must_use]
    pub fn crop(&self, row: usize, column: usize, height: usize, width: usize) -> Self {
        let part = self.planes.slice(ndarray::s![.., row..row + height, column..column + width]);
        Self { planes: part.to_owned() }
    }
}

/// The board's picture before the display step: 16-bit linear luma, and 16-bit chroma at half the columns, co-sited with the even ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame422 {
    /// Luma; rows × columns.
    pub luma: Array2<OutputWord>,
    /// Cb and Cr with the gain [`crate::number::CHROMA_GAIN`]; rows × columns/2 each.
    pub chroma: [Array2<OutputWord>; 2],
}

impl Frame422 {
    /// Returns a frame of zeros.
    #[must_use]
    pub fn zeros(height: usize, width: usize) -> Self {
        let plane = |width| Array2::from_elem((height, width), OutputWord::ZERO);
        Self { luma: plane(width), chroma: [plane(width / 2), plane(width / 2)] }
    }

    /// Returns luma, Cb and Cr as integers.
    #[must_use]
    pub fn bits(&self) -> [Array2<i16>; 3] {
        [&self.luma, &self.chroma[0], &self.chroma[1]].map(|plane| plane.mapv(OutputWord::to_bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(height: usize, width: usize) -> Array2<u16> {
        Array2::from_shape_fn((height, width), |(r, c)| (r * width + c) as u16)
    }

    #[test]
    fn values_are_aligned_to_the_top_and_come_back() {
        let frame = RawFrame::from_values(ramp(4, 6), 12, CfaPhase::Rggb).unwrap();
        assert_eq!(frame.pixels()[(0, 1)], 16);
        assert_eq!(frame.values(), ramp(4, 6));
    }

    #[test]
    fn a_view_of_any_strides_is_the_frame_of_its_values() {
        let values = ramp(8, 12);
        let view = values.slice(ndarray::s![..;-2, 1..;2]);
        let owned = RawFrame::from_values(view.to_owned(), 12, CfaPhase::Gbrg).unwrap();
        assert_eq!(RawFrame::from_view(view, 12, CfaPhase::Gbrg).unwrap(), owned);
        assert!(RawFrame::from_view(values.slice(ndarray::s![1.., ..]), 12, CfaPhase::Rggb).is_err());
    }

    #[test]
    fn every_phase_becomes_red_first_and_keeps_its_colours() {
        for phase in CfaPhase::ALL {
            let frame = RawFrame::from_values(ramp(4, 6), 16, phase).unwrap();
            let (aligned, (dr, dc)) = frame.to_rggb();
            assert_eq!(aligned.size(), (4 + 2 * dr, 6 + 2 * dc));
            for ((r, c), &v) in frame.pixels().indexed_iter() {
                assert_eq!(aligned.pixels()[(r + dr, c + dc)], v);
                assert_eq!(CfaPhase::Rggb.channel(r + dr, c + dc), phase.channel(r, c));
            }
            for ((r, c), &v) in aligned.pixels().indexed_iter() {
                let (y, x) = (v as usize / 6, v as usize % 6);
                assert_eq!(CfaPhase::Rggb.channel(r, c), phase.channel(y, x));
            }
        }
    }

    #[test]
    fn wrong_depths_sides_and_values_are_rejected() {
        let refused = |h, w, depth| RawFrame::from_values(ramp(h, w), depth, CfaPhase::Rggb).unwrap_err();
        assert_eq!(refused(4, 4, 7).to_string(), "bit depth 7: must be 8 to 16");
        assert!(refused(3, 4, 8).to_string().contains("4x3"));
        assert_eq!(
            refused(2, 200, 8).to_string(),
            "pixel at row 1, column 56 is 256, more than 8 bits can hold"
        );
    }
}
