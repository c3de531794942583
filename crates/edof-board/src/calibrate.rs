//! The luma that a PC's graphics card makes of each grey, read pixel by pixel from the chart that it shows (docs/bring-up.md).

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_device::registers::map::{self, GREY, PLAIN, RAW_WORDS, VIDEO_SETUP};
use edof_golden::video::greys::{Greys, Path, SIDE};
use ndarray::Array2;
use std::ops::ControlFlow;

/// Raw frames after a change of the input of which the last one is of the new kind.
const SETTLING: u32 = 3;

impl<L: Line> Board<L> {
    /// Reads the chart of all greys that the source shows, finds the grey of each code, and has the board take raw frames in grey from now on.
    ///
    /// # Errors
    /// The line fails, no frame comes, or what comes is no chart or carries no words, when the input is as before.
    pub fn calibrate(
        &mut self,
        step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<(Path, Greys), Error> {
        let (width, height) = (self.identity.width, self.identity.height);
        if width.min(height) < SIDE as u32 {
            return Err(Error::NoRoom { port: self.port(), width, height });
        }
        let before = self.link.read(VIDEO_SETUP, 1)?[0];
        let port = self.port();
        let grey = |source| Error::Grey { port, source };
        let found = self.chart(before & !GREY | PLAIN, step).and_then(|words| {
            let path = Path::of_chart(&words).and_then(|path| path.greys().map(|greys| (path, greys)));
            path.map_err(grey)
        });
        let after = if found.is_ok() { before & !PLAIN | GREY } else { before };
        self.link.set(VIDEO_SETUP, after)?;
        found
    }

    /// The first 64 × 64 pixels of the source's frame, luma above chroma.
    fn chart(
        &mut self,
        video_setup: u32,
        step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Array2<u16>, Error> {
        self.link.set(map::PATTERN, 0)?;
        self.link.set(VIDEO_SETUP, video_setup)?;
        self.pass("input_frames", SETTLING)?;
        self.square(RAW_WORDS, &mut |done| step(done, SIDE * SIDE))
    }
}
