//! The pixel clocks of a board, counted in cycles of its core's clock, and those that its frames need.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_core::Stride;
use edof_device::board::CORE_KILOHERTZ;
use edof_device::design::FrameSize;
use edof_device::registers::map;
use edof_device::video::VideoTiming;

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

/// The mode for which the chips of a board with such frames are set up.
pub(crate) fn mode(width: u32, height: u32) -> VideoTiming {
    let [width, height] = [width, height].map(|side| side as usize);
    VideoTiming::on_the_cable(FrameSize { width, height, stride: Stride::PATCH })
}

impl<L: Line> Board<L> {
    /// Counts the pixel clocks against the core's; `None` where that one stands still.
    ///
    /// # Errors
    /// The line fails.
    pub fn pixel_clocks(&mut self) -> Result<Option<PixelClocks>, Error> {
        let before = self.link.glance(map::CORE_CYCLES, 3)?;
        let mut after = before.clone();
        for _ in 0..LOOKS {
            after = self.link.glance(map::CORE_CYCLES, 3)?;
        }
        let passed = |clock: usize| f64::from(after[clock].wrapping_sub(before[clock]));
        let megahertz = |clock: usize| passed(clock) / passed(0) * f64::from(CORE_KILOHERTZ) / 1e3;
        Ok((passed(0) > 0.0).then(|| PixelClocks { input: megahertz(1), screen: megahertz(2) }))
    }
}
