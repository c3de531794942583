//! Speeds of the slow interfaces and the size of the screen, so that a simulation can shorten them.

use edof_device::board::{Board, UART_TIME_OUT_MS};
use edof_device::video::VideoTiming;

/// How fast what is not video goes, in cycles of the core's clock; and a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pace {
    /// A bit on the host's line.
    pub cycles_per_bit: u16,
    /// A pause on it after which a frame is given up.
    pub uart_time_out: u32,
    /// A quarter of a bit on an I2C bus, at least 4.
    pub i2c_quarter: u32,
    /// A millisecond, as the set-up of the video chips counts them.
    pub millisecond: u32,
    /// A screen in place of the design's ([`edof_device::Design::screen`]), on a board that shows frames in the middle of one.
    pub screen: Option<VideoTiming>,
}

impl Pace {
    /// Returns the speeds of a board; I2C at 100 kHz.
    #[must_use]
    pub const fn of(board: &Board) -> Self {
        Self {
            cycles_per_bit: (1000 * board.core_khz / board.baud) as u16,
            uart_time_out: UART_TIME_OUT_MS * board.core_khz,
            i2c_quarter: board.core_khz / 400,
            millisecond: board.core_khz,
            screen: None,
        }
    }
}
