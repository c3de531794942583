//! The OV7670, a camera at the pins: raw Bayer, a byte per pixel, nothing automatic.
//!
//! Sources: Linux `ov7670.c` (meaning of bits, window, BGGR at the window's corner); OV7670 data sheet 1.4, which was not at hand (values after a reset, 1 ms
//! of settling, VGA frame timing): `docs/decisions/0059-camera.md`. Transfers are writes alone: an SCCB read needs a stop in its middle. Undocumented
//! registers, which drivers write by the dozen, keep their values.

use super::program::{Action, Builder, Entry};
use crate::video::{Axis, VideoTiming};

/// Address of the chip: 0x42 with its write bit.
pub const OV7670: u8 = 0x21;
/// Slot whose bits are pins: bit 0 lets the chip out of power-down, bit 1 out of reset. All slots are 0 before a set-up and after one that failed.
pub const PINS: u8 = 11;

/// Frames of the chip with half of a clock of 25 MHz.
pub const TIMING: VideoTiming = VideoTiming {
    line: Axis { active: 640, front: 19, sync: 80, back: 45 },
    frame: Axis { active: 480, front: 10, sync: 3, back: 17 },
    pixel_khz: 12_500,
};

/// Counts of pixel and line at the corner of the whole picture, one right of and below Linux's, whose pixel is blue: this one is red.
const CORNER: [usize; 2] = [158 + 1, 10 + 1];

const FORMAT: &[(u8, u8, &str)] = &[
    (0x11, 0x01, "CLKRC: pixel clock of half the input"),
    (0x12, 0x01, "COM7: VGA, raw Bayer"),
    (0x3a, 0x04, "TSLB: windows are not chosen by the chip"),
    (0x13, 0x80, "COM8: no automatic gain, white balance, exposure; no banding filter"),
    (0x00, 0x00, "GAIN: 1, as automatic gain may have left another"),
    (0x07, 0x00, "AECHH: exposure, upper bits"),
    (0x10, 0x40, "AECH: 256 lines, 16 ms"),
    (0x04, 0x00, "COM1: exposure, lower bits"),
    (0x3d, 0x08, "COM13: no gamma, no saturation"),
    (0x41, 0x00, "COM16: no gains of white balance, no edges enhanced, no noise removed"),
    (0xb1, 0x0c, "ABLC1: black is held by the chip's black lines"),
];

/// Most pixels by which a window is moved.
pub const MAX_MOVE: u8 = 8;

/// Returns the program for windows of a timing's picture ([`VideoTiming::around`] of [`TIMING`]), moved by up to a pixel so that their first one is red. They are moved
/// right and down by `corner` besides, for modules whose first pixel is elsewhere; at most by [`MAX_MOVE`].
#[must_use]
pub fn program(mode: VideoTiming, corner: [i8; 2]) -> Vec<Entry> {
    let mut program = Builder::default();
    let pins = |value| Action::Store { value, slot: PINS };
    program.add(pins(0b01), "out of power-down, in reset");
    program.add(Action::Wait(2), "reset of 1 ms or more");
    program.add(pins(0b11), "out of reset");
    program.add(Action::Wait(2), "1 ms or more before the first transfer");
    program.write(OV7670, FORMAT);
    program.write(OV7670, &window(mode, corner));
    program.add(Action::Done, "frames come");
    program.finish()
}

/// The registers of the window: first pixel and the one after the last, modulo the line; first line and the one after the last.
fn window(mode: VideoTiming, corner: [i8; 2]) -> [(u8, u8, &'static str); 6] {
    let first =
        |axis: usize, border: usize| CORNER[axis].saturating_add_signed(corner[axis].into()) + border / 4 * 2;
    let (line, frame) = (mode.line, mode.frame);
    let left = first(0, TIMING.line.active - line.active);
    let right = (left + line.active) % TIMING.line.total();
    let top = first(1, TIMING.frame.active - frame.active);
    let bottom = top + frame.active;
    [
        (0x17, (left >> 3) as u8, "HSTART: first pixel, upper bits"),
        (0x18, (right >> 3) as u8, "HSTOP: pixel after the last, upper bits"),
        (0x32, 0x80 | ((right & 7) << 3 | left & 7) as u8, "HREF: their lower bits"),
        (0x19, (top >> 2) as u8, "VSTRT: first line, upper bits"),
        (0x1a, (bottom >> 2) as u8, "VSTOP: line after the last, upper bits"),
        (0x03, ((bottom & 3) << 2 | top & 3) as u8, "VREF: their lower bits; gain, upper bits"),
    ]
}
