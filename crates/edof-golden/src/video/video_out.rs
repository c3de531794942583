//! The transmitter's bus: where the screen is, and what it shows.

use super::Pins;
use edof_device::video::VideoTiming;

/// What is shown where there is no picture.
pub use edof_core::display::BLACK_PIXEL;

/// The transmitter's bus since reset.
#[derive(Debug, Clone)]
pub struct VideoOut {
    timing: VideoTiming,
    /// Column and row of the screen, porches and syncs included.
    place: (usize, usize),
    vs: bool,
    /// The frame has a picture, so far without a gap.
    showing: bool,
    /// On their way to the pins, the older one first.
    pins: [Pins; 2],
    /// Frames begun with a picture.
    pub shown_frames: u64,
    /// Frames counted above whose pixels came late.
    pub late_pixels: u64,
}

impl VideoOut {
    /// As after reset: past the picture, so that a frame of black does not come first.
    #[must_use]
    pub fn new(timing: VideoTiming) -> Self {
        let place = (timing.line.active, timing.frame.active);
        let (showing, vs, pins) = (false, false, [Pins::default(); 2]);
        Self { timing, place, vs, showing, pins, shown_frames: 0, late_pixels: 0 }
    }

    /// What is on the pins.
    #[must_use]
    pub const fn pins(&self) -> Pins {
        self.pins[0]
    }

    /// One cycle: the pixel that waits, and whether it is its frame's first. Returns whether it was taken.
    pub fn step(&mut self, front: Option<(u16, bool)>) -> bool {
        let (line, frame) = (self.timing.line, self.timing.frame);
        let (column, row) = self.place;
        let active = column < line.active && row < frame.active;
        let begins = self.place == (0, 0);
        if begins {
            self.showing = matches!(front, Some((_, true)));
            self.shown_frames += u64::from(self.showing);
        }
        let fitting = front.filter(|(_, first)| *first == begins);
        let shown = fitting.filter(|_| active && self.showing);
        let blanked = !self.showing;
        if active && self.showing && shown.is_none() {
            self.showing = false;
            self.late_pixels += 1;
        }
        // What belongs to no picture is dropped until a first pixel waits.
        let dropped = blanked && matches!(front, Some((_, false)));
        let in_sync = line.in_sync(column);
        if column == line.active + line.front {
            // Porches are counted in lines that begin with their sync, as in the standards.
            self.vs = frame.in_sync(row + 1);
        }
        let data = shown.map_or(BLACK_PIXEL, |(pixel, _)| pixel);
        self.pins = [self.pins[1], Pins { hs: in_sync, vs: self.vs, de: active, data }];
        self.place = match (column + 1 == line.total(), row + 1 == frame.total()) {
            (false, _) => (column + 1, row),
            (true, false) => (0, row + 1),
            (true, true) => (0, 0),
        };
        shown.is_some() || dropped
    }
}
