//! Frames for a camera, and what the screen must show for them.

use edof_core::cable::carried;
use edof_core::draw::Draw;
use edof_core::frame::FrameError;
use edof_core::geometry::GeometryError;
use edof_core::{CfaPhase, RawFrame};
use edof_device::design::FrameSize;
use edof_golden::gamma::ColourTable;
use edof_golden::video::video_out::BLACK_PIXEL;
use edof_golden::{Display, Golden};
use edof_hdl::board::Tables;
use edof_network::fixed_network::FixedNetworkError;
use ndarray::Array2;

/// Frames that have no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// A size that no raw frame has.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A frame that is too small for the network.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A network that cannot run exactly.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
}

/// A display's tables as memory words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableWords {
    luma: Vec<u64>,
    colours: [Vec<u64>; 3],
}

impl TableWords {
    /// Those of a display.
    #[must_use]
    pub fn of(display: &Display) -> Self {
        let luma = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
        let words = |table: &ColourTable| table.entries().iter().map(|entry| u64::from(*entry)).collect();
        Self { luma, colours: display.colours.each_ref().map(words) }
    }

    /// The words.
    #[must_use]
    pub fn tables(&self) -> Tables<'_> {
        Tables { luma: &self.luma, colours: self.colours.each_ref().map(Vec::as_slice) }
    }
}

/// Raw frames of one size: slopes with an edge and noise.
///
/// # Errors
/// A size that no raw frame has.
pub fn drawn(size: FrameSize, count: usize, seed: u64) -> Result<Vec<RawFrame>, FrameError> {
    let draw = &mut Draw::new(seed);
    let frame = |_| {
        let (right, down) = (draw.whole(-300, 300), draw.whole(-300, 300));
        let values = Array2::from_shape_fn((size.height, size.width), |(r, c)| {
            let edge = if c > size.width / 2 { 9000 } else { 0 };
            let value = 20_000 + edge + right * c as i64 + down * r as i64 + draw.whole(-400, 400);
            value.clamp(0, 65_535) as u16
        });
        RawFrame::from_values(values, 16, CfaPhase::Rggb)
    };
    (0..count).map(frame).collect()
}

/// The raw pixel words of a frame, as a camera sends them.
#[must_use]
pub fn sent(raw: &RawFrame) -> Vec<u16> {
    raw.pixels().iter().copied().collect()
}

/// What the screen must show for a frame: what `edof reconstruct --board` writes, a word a pixel.
///
/// # Errors
/// The frame is too small for the network.
pub fn picture(golden: &Golden, display: &Display, raw: &RawFrame) -> Result<Vec<u16>, GeometryError> {
    let bytes = golden.frame(&carried(raw))?.picture(display).0.yuyv();
    Ok(bytes.chunks_exact(2).map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]])).collect())
}

/// A frame that is not what was sent.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "shown frame {shown}: {differing} of {pixels} pixels differ from picture {nearest}, the nearest; \
     the first at row {row}, column {column}: {got:04x}, expected {expected:04x}"
)]
#[allow(missing_docs, reason = "the message names the fields")]
pub struct Torn {
    pub shown: usize,
    pub nearest: usize,
    pub differing: usize,
    pub pixels: usize,
    pub row: usize,
    pub column: usize,
    pub got: u16,
    pub expected: u16,
}

/// Which picture each shown frame is, none where it is black.
///
/// # Errors
/// [`Torn`]: the first frame that is neither.
pub fn compare(
    shown: &[(u64, Vec<u16>)],
    pictures: &[Vec<u16>],
    width: usize,
) -> Result<Vec<Option<usize>>, Torn> {
    shown.iter().enumerate().map(|(number, (_, frame))| which(number, frame, pictures, width)).collect()
}

fn which(number: usize, frame: &[u16], pictures: &[Vec<u16>], width: usize) -> Result<Option<usize>, Torn> {
    if frame.iter().all(|pixel| *pixel == BLACK_PIXEL) {
        return Ok(None);
    }
    if let Some(found) = pictures.iter().position(|picture| picture == frame) {
        return Ok(Some(found));
    }
    let differing = |picture: &[u16]| picture.iter().zip(frame).filter(|(a, b)| a != b).count();
    let nearest = (0..pictures.len()).min_by_key(|i| differing(&pictures[*i])).unwrap_or(0);
    let expected = pictures.get(nearest).map_or(&[][..], Vec::as_slice);
    let at = expected.iter().zip(frame).position(|(a, b)| a != b).unwrap_or(0);
    Err(Torn {
        shown: number,
        nearest,
        differing: differing(expected),
        pixels: frame.len(),
        row: at / width,
        column: at % width,
        got: frame.get(at).copied().unwrap_or(0),
        expected: expected.get(at).copied().unwrap_or(0),
    })
}

/// Most pictures that were shown one after the other, each once or more.
#[must_use]
pub fn longest_run(shown: &[Option<usize>]) -> usize {
    let mut numbers: Vec<usize> = shown.iter().flatten().copied().collect();
    numbers.dedup();
    let mut best = usize::from(!numbers.is_empty());
    let mut run = best;
    for two in numbers.windows(2) {
        run = if two[1] == two[0] + 1 { run + 1 } else { 1 };
        best = best.max(run);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_of_two_pictures_is_torn() {
        let pictures = vec![vec![1, 2, 3, 4], vec![1, 2, 5, 6]];
        let shown = |frame: [u16; 4]| compare(&[(0, frame.to_vec())], &pictures, 2);
        assert_eq!(shown([BLACK_PIXEL; 4]), Ok(vec![None]));
        assert_eq!(shown([1, 2, 5, 6]), Ok(vec![Some(1)]));
        let torn = shown([1, 2, 3, 6]).unwrap_err();
        assert_eq!((torn.nearest, torn.row, torn.column, torn.differing), (0, 1, 1, 1));
    }

    #[test]
    fn a_run_counts_pictures_and_not_how_often_each_was_shown() {
        assert_eq!(longest_run(&[None, Some(0), Some(0), Some(1), Some(3), Some(4), Some(4), Some(5)]), 3);
        assert_eq!(longest_run(&[None]), 0);
    }
}
