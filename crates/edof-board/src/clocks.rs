//! The pixel clocks of a board, counted in cycles of its core's clock.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_device::board;
use edof_device::registers::map;

/// Share by which a clock may be off: an oscillator is off by 1e-4, a mode of 59.94 Hz by 1e-3, two looks at counters by less than 1e-2 at
/// any line's speed.
const SHARE: f64 = 0.01;
/// Looks at the cycle counters.
const LOOKS: usize = 50;

/// Megahertz of the pixel clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelClocks {
    /// The receiver's; 0 while it stands still.
    pub input: f64,
    /// The screen's.
    pub screen: f64,
}

/// Whether a clock is another one within the counters' precision.
#[must_use]
pub fn is_clock(megahertz: f64, expected: f64) -> bool {
    (megahertz / expected - 1.0).abs() <= SHARE
}

impl<L: Line> Board<L> {
    /// Counts the pixel clocks against the core's; `None` where that one stands still.
    ///
    /// # Errors
    /// The line fails.
    pub fn pixel_clocks(&mut self, board: &board::Board) -> Result<Option<PixelClocks>, Error> {
        let before = self.link.glance(map::CORE_CYCLES, 3)?;
        let mut after = before.clone();
        for _ in 0..LOOKS {
            after = self.link.glance(map::CORE_CYCLES, 3)?;
        }
        let passed = |clock: usize| f64::from(after[clock].wrapping_sub(before[clock]));
        let megahertz = |clock: usize| passed(clock) / passed(0) * f64::from(board.core_khz) / 1e3;
        Ok((passed(0) > 0.0).then(|| PixelClocks { input: megahertz(1), screen: megahertz(2) }))
    }
}
