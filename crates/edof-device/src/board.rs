//! The board's numbers: memory, clocks, the line to the host.
//!
//! Frames lie in sets of three buffers of 16-bit pixels: raw frames, and pictures in the codes of the wire.

use crate::design::{Design, DesignError};
use crate::fifos;
use crate::mmcm::Mmcm;
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

/// Clock of the DRAM's port and of the host's registers, in kilohertz: the user clock of the memory controller, from which all others but
/// the receiver's are made.
pub const CORE_KILOHERTZ: u32 = 200_000;
/// Bits per second on the line to the host.
pub const BAUD: u32 = 921_600;
/// Milliseconds after which a frame on that line is given up.
pub const UART_TIME_OUT_MS: u32 = 100;
/// Memory images of the programs of [`crate::i2c::programs`]: the board's bus, the card's.
pub const I2C_IMAGES: [&str; 2] = ["mem/i2c_kc705.mem", "mem/i2c_imageon.mem"];

/// Sides below which a frame that is of no video mode is taken, for simulation.
pub const SIMULATED_SIDES: (usize, usize) = (640, 480);
/// Pixel clock for such frames, in kilohertz: the slowest that the transmitter takes. No screen shows them.
const SIMULATED_KHZ: u64 = 25_000;

/// A clock that an MMCM makes of the memory's ([`CORE_KILOHERTZ`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MadeClock {
    /// Kilohertz.
    pub khz: u64,
    /// How.
    pub mmcm: Mmcm,
}

impl MadeClock {
    fn of(khz: u64) -> Option<Self> {
        Mmcm::of(CORE_KILOHERTZ.into(), khz).map(|mmcm| Self { khz, mmcm })
    }

    /// The period in nanoseconds.
    #[must_use]
    pub fn period_ns(self) -> f64 {
        1e6 / self.khz as f64
    }
}

/// The clocks that are made of the memory's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clocks {
    /// The calculator's: the design's `clock_mhz`.
    pub calculator: MadeClock,
    /// The screen's pixels.
    pub screen: MadeClock,
}

/// The clocks of a design's board.
///
/// # Errors
/// As [`calculator_clock`] and [`screen_clock`].
pub fn clocks(design: &Design) -> Result<Clocks, DesignError> {
    Ok(Clocks { calculator: calculator_clock(design)?, screen: screen_clock(design)? })
}

/// The clock of a design's calculator.
///
/// # Errors
/// [`DesignError::Field`] for a clock that no MMCM makes of the memory's; it names the next ones that can be made.
pub fn calculator_clock(design: &Design) -> Result<MadeClock, DesignError> {
    let khz = design.clock_mhz * 1e3;
    let nearest = khz.round() as u64;
    let exact = if (khz - nearest as f64).abs() < 1e-6 { MadeClock::of(nearest) } else { None };
    exact.ok_or_else(|| {
        let around =
            (0..SEARCH_KHZ).map(|i| nearest.saturating_sub(i)).find(|khz| MadeClock::of(*khz).is_some());
        let above = (1..SEARCH_KHZ).map(|i| nearest + i).find(|khz| MadeClock::of(*khz).is_some());
        let named: Vec<String> =
            around.into_iter().chain(above).map(|khz| (khz as f64 / 1e3).to_string()).collect();
        let memory = f64::from(CORE_KILOHERTZ) / 1e3;
        let expected = format!("a clock that an MMCM makes of {memory} MHz, such as {}", named.join(" or "));
        DesignError::Field {
            field: "clock_mhz".into(),
            value: edof_core::words::number(design.clock_mhz),
            expected,
        }
    })
}

/// How far around a clock that cannot be made one is looked for that can, in kilohertz.
const SEARCH_KHZ: u64 = 5_000;

/// The pixel clock of a design's screen, from the video mode of its frames.
///
/// # Errors
/// [`DesignError::Field`] for frames that no video mode has.
pub fn screen_clock(design: &Design) -> Result<MadeClock, DesignError> {
    let field =
        |field: &str, value: String, expected| DesignError::Field { field: field.into(), value, expected };
    let (width, height) = (design.frame.width, design.frame.height);
    let simulated = (width < SIMULATED_SIDES.0 && height < SIMULATED_SIDES.1).then_some(SIMULATED_KHZ);
    let mode = VideoTiming::mode(design.frame).map(|mode| mode.pixel_khz as u64);
    mode.or(simulated).and_then(MadeClock::of).ok_or_else(|| {
        let mut sizes: Vec<String> = VideoTiming::MODES.map(VideoTiming::size).into();
        sizes.dedup();
        let (sizes, (columns, rows)) = (sizes.join(", "), SIMULATED_SIDES);
        let expected =
            format!("the size of a video mode ({sizes}), or below {columns}x{rows} for simulation");
        field("frame", format!("{width}x{height}"), expected)
    })
}

/// Cycles of the pixel clock without an edge of the vertical sync after which there is no signal: four frames, as far as 24 bits go.
#[must_use]
pub fn patience(timing: VideoTiming) -> u32 {
    let frames = 4 * timing.line.total() * timing.frame.total();
    u32::try_from(frames).unwrap_or(u32::MAX).min((1 << 24) - 1)
}

/// # Errors
/// [`DesignError::Field`] for a frame that the buffers cannot hold, or as [`clocks`].
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
    clocks(design).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(clock_mhz: f64, width: usize, height: usize) -> Design {
        let mut design = Design::from_json(include_str!("../../../designs/kc705.json")).unwrap();
        design.clock_mhz = clock_mhz;
        (design.frame.width, design.frame.height) = (width, height);
        design
    }

    #[test]
    fn every_video_mode_has_a_pixel_clock_that_an_mmcm_makes() {
        for mode in VideoTiming::MODES {
            let made = MadeClock::of(mode.pixel_khz as u64).unwrap();
            assert!(made.mmcm.is_legal(CORE_KILOHERTZ.into()), "{made:?}");
        }
        assert_eq!(screen_clock(&design(150.0, 1280, 720)).unwrap().khz, 74_250);
    }

    #[test]
    fn clocks_and_frames_that_no_board_has_are_rejected_in_words() {
        for (design, words) in [
            (
                design(200.0, 1366, 768),
                "frame 1366x768: must be the size of a video mode (1280x720, 1920x1080), or below",
            ),
            (
                design(199.999, 1280, 720),
                "clock_mhz 199.999: must be a clock that an MMCM makes of 200 MHz, such as 199.6 or 200",
            ),
            (design(2.0, 1280, 720), "clock_mhz 2: must be a clock that an MMCM makes of 200 MHz, such as "),
        ] {
            let error = clocks(&design).unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }

    #[test]
    fn a_frame_is_no_larger_than_its_buffer() {
        let error = check(&design(200.0, 2048, 1032)).unwrap_err().to_string();
        assert_eq!(error, "frame 2048x1032: must be at most 2097152 pixels, which a buffer holds");
    }

    #[test]
    fn calculators_run_at_their_designs_clock() {
        for mhz in [5.0, 100.0, 125.0, 150.0, 200.0, 212.5, 215.0, 220.0, 333.0] {
            let made = clocks(&design(mhz, 1920, 1080)).unwrap().calculator;
            assert_eq!(made.khz as f64, mhz * 1e3);
            assert!(made.mmcm.is_legal(CORE_KILOHERTZ.into()), "{made:?}");
        }
    }
}
