//! The board's numbers: memory, clocks, the line to the host.
//!
//! Frames lie in sets of three buffers of 16-bit pixels: raw frames, and pictures in the codes of the wire.

use crate::design::{Design, DesignError};
use crate::fifos;
use crate::video::VideoTiming;

/// Bits of a word of the DRAM's port.
pub const WORD_BITS: usize = 512;
/// Pixels in a word.
pub const WORD_PIXELS: usize = WORD_BITS / 16;
/// Words of a burst: 4 KiB, the most that a burst may have.
pub const BURST_WORDS: usize = 64;
/// Cycles that the memory may take for a burst, from the offer of its address to its last word, so that no pixel is late: a burst of
/// another agent before it, both ways, a refresh, and as much again.
pub const MEMORY_LATE: u64 = 512;
/// Words that an agent holds, in LUT RAM: a pixel a cycle at most.
pub const AGENT_WORDS: usize =
    fifos::agent_words(BURST_WORDS, MEMORY_LATE, WORD_PIXELS as u64).next_power_of_two();
/// Pixels between clock domains, in LUT RAM: for pixel clocks up to the memory's.
pub const CROSSING_PIXELS: usize = fifos::crossing_words(1, 1).next_power_of_two();
/// Bytes of a frame buffer.
pub const BUFFER_BYTES: u32 = 1 << 22;
/// Byte addresses of the buffers of raw frames.
pub const RAW_BUFFERS: [u32; 3] = [0, BUFFER_BYTES, 2 * BUFFER_BYTES];
/// Byte addresses of the buffers of pictures.
pub const PICTURE_BUFFERS: [u32; 3] = [4 * BUFFER_BYTES, 5 * BUFFER_BYTES, 6 * BUFFER_BYTES];

/// Clock of the DRAM's port, and of the calculator, in kilohertz.
pub const CORE_KILOHERTZ: u32 = 200_000;
/// Bits a second on the line to the host.
pub const BAUD: u32 = 921_600;
/// Milliseconds after which a frame on that line is given up.
pub const UART_TIME_OUT_MS: u32 = 100;
/// Memory images of the set-up tables: the board's bus, the card's.
pub const I2C_IMAGES: [&str; 2] = ["mem/i2c_kc705.hex", "mem/i2c_imageon.hex"];

/// Cycles of the pixel clock without an edge of the vertical sync after which there is no signal: four frames, as far as 24 bits go.
#[must_use]
pub fn patience(timing: VideoTiming) -> u32 {
    let frames = 4 * timing.line.total() * timing.frame.total();
    u32::try_from(frames).unwrap_or(u32::MAX).min((1 << 24) - 1)
}

/// # Errors
/// [`DesignError::Field`] for a frame that the buffers cannot hold.
pub fn check(design: &Design) -> Result<(), DesignError> {
    let pixels = design.frame.width * design.frame.height;
    let field = |expected: String| DesignError::Field {
        field: "frame".into(),
        value: format!("{}x{}", design.frame.width, design.frame.height),
        expected,
    };
    if !pixels.is_multiple_of(WORD_PIXELS) {
        return Err(field(format!(
            "a multiple of {WORD_PIXELS} pixels, so that it is whole words of memory"
        )));
    }
    if 2 * pixels > BUFFER_BYTES as usize {
        return Err(field(format!("at most {} pixels, which a buffer holds", BUFFER_BYTES / 2)));
    }
    Ok(())
}
