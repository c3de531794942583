//! Video timing: what lies around a picture on the wires between devices (CEA-861, VESA DMT).
//!
//! The picture comes first, so that a frame begins with its first pixel: picture, front porch, sync, back porch, along a line and along
//! the lines of a frame.

use crate::design::frame::FrameSize;

/// A length along one axis: pixels of a line, or lines of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Axis {
    /// Pixels or lines that are seen.
    pub active: usize,
    /// From the picture to the sync.
    pub front: usize,
    /// Sync pulse.
    pub sync: usize,
    /// From the sync to the picture.
    pub back: usize,
}

impl Axis {
    /// All of it.
    #[must_use]
    pub const fn total(self) -> usize {
        self.active + self.front + self.sync + self.back
    }

    /// With a shorter picture in the middle.
    const fn around(self, active: usize) -> Self {
        let border = self.active.saturating_sub(active);
        Self { active, front: border - border / 2 + self.front, back: self.back + border / 2, ..self }
    }

    /// Whether the sync pulse is on at this place.
    #[must_use]
    pub const fn in_sync(self, at: usize) -> bool {
        let start = self.active + self.front;
        at >= start && at < start + self.sync
    }
}

/// The timing of a screen. A frame's sync begins with that of a line. Both syncs are positive pulses where a block has them; a cable's polarity is
/// its board's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VideoTiming {
    /// Along a line, in pixels.
    pub line: Axis,
    /// Along a frame, in lines.
    pub frame: Axis,
    /// Pixel clock in kilohertz.
    pub pixel_khz: usize,
}

impl VideoTiming {
    /// 1280×720 at 60 frames per second (CEA-861 format 4).
    pub const P720_60: Self = Self {
        line: Axis { active: 1280, front: 110, sync: 40, back: 220 },
        frame: Axis { active: 720, front: 5, sync: 5, back: 20 },
        pixel_khz: 74_250,
    };
    /// 1920×1080 at 60 frames per second (CEA-861 format 16).
    pub const P1080_60: Self = Self {
        line: Axis { active: 1920, front: 88, sync: 44, back: 148 },
        frame: Axis { active: 1080, front: 4, sync: 5, back: 36 },
        pixel_khz: 148_500,
    };
    /// 1920×1080 at 30 frames per second (CEA-861 format 34): as [`VideoTiming::P1080_60`] at half the clock.
    pub const P1080_30: Self = Self { pixel_khz: 74_250, ..Self::P1080_60 };

    /// 640×480 at 60 frames per second (VESA DMT 4, CEA-861 format 1), at 25 MHz in place of 25.175.
    pub const VGA_60: Self = Self {
        line: Axis { active: 640, front: 16, sync: 96, back: 48 },
        frame: Axis { active: 480, front: 10, sync: 2, back: 33 },
        pixel_khz: 25_000,
    };

    /// The video modes of frames.
    pub const MODES: [Self; 3] = [Self::P720_60, Self::P1080_60, Self::P1080_30];

    /// The mode of [`VideoTiming::MODES`] for frames of a size, the fastest of several.
    #[must_use]
    pub fn mode(frame: FrameSize) -> Option<Self> {
        let fits = |mode: &Self| (mode.line.active, mode.frame.active) == (frame.width, frame.height);
        Self::MODES.into_iter().filter(fits).max_by_key(|mode| mode.pixel_khz)
    }

    /// The timing for frames of a size: the mode where there is one; else porches and syncs of a few pixels and lines at 60 frames per
    /// second, which is for simulation, not for a screen.
    #[must_use]
    pub fn of_frame(frame: FrameSize) -> Self {
        Self::mode(frame).unwrap_or_else(|| {
            let line = Axis { active: frame.width, front: 4, sync: 6, back: 6 };
            let lines = Axis { active: frame.height, front: 2, sync: 2, back: 4 };
            Self { line, frame: lines, pixel_khz: line.total() * lines.total() * 60 / 1000 + 1 }
        })
    }

    /// Returns the timing of a picture in the middle of this screen: what is left around it counts as porches. A picture is no larger than the screen.
    ///
    /// ```
    /// # use edof_device::{design::FrameSize, video::VideoTiming};
    /// # let picture = FrameSize { width: 128, height: 80, stride: edof_core::Stride::PATCH };
    /// let small = VideoTiming::VGA_60.around(picture);
    /// assert_eq!((small.line.active, small.line.front, small.line.back), (128, 256 + 16, 48 + 256));
    /// assert_eq!((small.frame.active, small.frame.total()), (80, 525));
    /// ```
    #[must_use]
    pub const fn around(self, picture: FrameSize) -> Self {
        Self { line: self.line.around(picture.width), frame: self.frame.around(picture.height), ..self }
    }

    /// The mode for which the video chips are set up: that of the frames; [`VideoTiming::P1080_60`] for frames of no mode, which stand for it
    /// in simulation.
    #[must_use]
    pub fn on_the_cable(frame: FrameSize) -> Self {
        Self::mode(frame).unwrap_or(Self::P1080_60)
    }

    /// Columns and rows of its picture, as in `1920x1080`.
    #[must_use]
    pub fn size(self) -> String {
        format!("{}x{}", self.line.active, self.frame.active)
    }

    /// Its video identification code in CEA-861; `None` where it has none.
    #[must_use]
    pub fn code(self) -> Option<u8> {
        let codes = [(Self::P720_60, 4), (Self::P1080_60, 16), (Self::P1080_30, 34)];
        codes.into_iter().find(|(mode, _)| *mode == self).map(|(_, code)| code)
    }

    /// Size and rate, as in `1920x1080 at 60 Hz`.
    #[must_use]
    pub fn name(self) -> String {
        format!("{} at {:.0} Hz", self.size(), self.frames_per_second())
    }

    /// Returns the pixel cycles without an edge of the vertical sync after which there is no signal: four frames, as far as 24 bits go; a multiple of 4.
    #[must_use]
    pub fn signal_time_out(self) -> u32 {
        let frames = 4 * self.line.total() * self.frame.total();
        u32::try_from(frames).unwrap_or(u32::MAX).min((1 << 24) - 4)
    }

    /// Frames per second.
    #[must_use]
    pub fn frames_per_second(self) -> f64 {
        self.pixel_khz as f64 * 1000.0 / (self.line.total() * self.frame.total()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::geometry::Stride;

    #[test]
    fn standard_timings_have_the_frame_rates_in_their_names() {
        for (timing, rate) in
            [(VideoTiming::P720_60, 60.0), (VideoTiming::P1080_60, 60.0), (VideoTiming::P1080_30, 30.0)]
        {
            assert_eq!(timing.frames_per_second(), rate);
        }
        assert!((VideoTiming::VGA_60.frames_per_second() - 60.0).abs() < 0.5);
        let size = |width, height| FrameSize { width, height, stride: Stride::PATCH };
        assert_eq!(VideoTiming::of_frame(size(1920, 1080)), VideoTiming::P1080_60);
        assert!((VideoTiming::of_frame(size(64, 48)).frames_per_second() - 60.0).abs() < 0.5);
    }

    #[test]
    fn a_sync_lies_between_its_porches() {
        let line = VideoTiming::P720_60.line;
        let on: Vec<usize> = (0..line.total()).filter(|at| line.in_sync(*at)).collect();
        assert_eq!((on.len(), on[0], line.total() - on[39] - 1), (40, 1390, 220));
    }
}
