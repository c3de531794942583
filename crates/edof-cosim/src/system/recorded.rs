//! What a generated design tries itself with, in a bench of Verilog alone.

use super::pictures::{PictureError, drawn, picture, sent};
use edof_golden::cycle::estimate;
use edof_golden::{Display, Golden};
use edof_hdl::benches::RecordedVideo;
use edof_spec::design::FrameSize;
use edof_spec::{Design, FixedNetwork, RawFrame};

/// Frames of a generated design's bench.
const FRAMES: usize = 3;
/// Their size: all strides, and whole words of memory.
const SIZE: (usize, usize) = (32, 16);

/// Drawn frames of a small size, and the pictures that a design with this network makes of them.
///
/// # Errors
/// A network that cannot run exactly, or windows that are larger than the frames.
pub fn recorded(
    design: &Design,
    network: &FixedNetwork,
    display: &Display,
) -> Result<RecordedVideo, PictureError> {
    let size = FrameSize { width: SIZE.0, height: SIZE.1, stride: design.frame.stride };
    video(&Design { frame: size, ..design.clone() }, network, display, &drawn(size, FRAMES, 1)?)
}

/// Frames of the design's size, and their pictures.
///
/// # Errors
/// As [`recorded`].
pub fn video(
    design: &Design,
    network: &FixedNetwork,
    display: &Display,
    frames: &[RawFrame],
) -> Result<RecordedVideo, PictureError> {
    let golden = Golden::new(network.clone())?;
    let pictures = frames.iter().map(|raw| picture(&golden, display, raw)).collect::<Result<_, _>>()?;
    let cycles = cycles(design);
    Ok(RecordedVideo { size: design.frame, frames: frames.iter().map(sent).collect(), pictures, cycles })
}

/// Cycles in which the core has surely done with a frame, in a memory that is late.
#[must_use]
pub fn cycles(design: &Design) -> usize {
    let ahead = estimate(design, None);
    let calculator = 1.2 * ahead.cycles_per_patch * ahead.patches_per_frame as f64;
    calculator as usize + 2 * design.frame.width * design.frame.height + 4000
}
