//! What a generated design tries itself with, in a bench of Verilog alone.

use super::pictures::{PictureError, drawn, picture, sent};
use edof_core::{DisplayMode, RawFrame};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::cycle::estimate;
use edof_golden::{Display, Golden};
use edof_hdl::benches::RecordedVideo;
use edof_network::FixedNetwork;

/// Frames of a generated design's bench.
const FRAMES: usize = 5;
/// Size of the frames: four patches, and whole words of memory. Icarus takes three seconds for a thousand cycles of the smallest core.
const SIZE: (usize, usize) = (16, 16);

/// Random frames of a small size, and the pictures that a design with this network makes of them.
///
/// # Errors
/// A network that cannot run exactly, or windows that are larger than the frames.
pub fn recorded(
    design: &Design,
    network: &FixedNetwork,
    display: &Display,
) -> Result<RecordedVideo, PictureError> {
    let size = FrameSize { width: SIZE.0, height: SIZE.1, stride: design.frame.stride };
    let frames = drawn(size, FRAMES, 1)?;
    let golden = Golden::new(network.clone())?;
    let pictures = frames.iter().map(|raw| picture(&golden, display, raw)).collect::<Result<_, _>>()?;
    Ok(video(&Design { frame: size, ..design.clone() }, &frames, pictures, display.mode))
}

/// Frames of the design's size, with the pictures that they must become.
#[must_use]
pub fn video(
    design: &Design,
    frames: &[RawFrame],
    pictures: Vec<Vec<u16>>,
    mode: DisplayMode,
) -> RecordedVideo {
    let frames = frames.iter().map(sent).collect();
    RecordedVideo {
        size: design.frame,
        frames,
        pictures,
        mode,
        cycles: brisk(design),
        memory: design.board.memory,
        core_khz: design.board.core_khz.into(),
        calculator_khz: (1e3 * design.clock_mhz).round() as u64,
    }
}

/// Cycles in which the core has done with a frame in the bench, whose memory is a little late.
fn brisk(design: &Design) -> usize {
    let ahead = estimate(design, None);
    let patches = ahead.patches_per_frame as f64 + 2.0 * design.stages.len() as f64;
    (1.2 * ahead.cycles_per_patch * patches) as usize + 2 * design.frame.width * design.frame.height + 400
}

/// Cycles in which the core has surely done with a frame, in a memory that is late.
#[must_use]
pub fn cycles(design: &Design) -> usize {
    let ahead = estimate(design, None);
    let calculator = 1.2 * ahead.cycles_per_patch * ahead.patches_per_frame as f64;
    calculator as usize + 2 * design.frame.width * design.frame.height + 4000
}
