//! A window to a board's pictures over the line: raw pixels in, codes out.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_device::pattern::{TILE, TILE_PIXELS, TILE_SIDE};
use edof_device::registers::map;
use ndarray::{Array2, s};
use std::ops::ControlFlow;
use std::time::Duration;

/// Words of one exchange on the line.
const AT_ONCE: usize = 128;

impl<L: Line> Board<L> {
    /// Writes the tile of 64 × 64 raw pixel words, row by row, and has the board repeat it over its frames.
    ///
    /// # Errors
    /// The line fails, or `step` (words done, of how many) says stop.
    pub fn put_tile(
        &mut self,
        tile: &Array2<u16>,
        step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let words: Vec<u32> = tile.iter().map(|word| u32::from(*word)).collect();
        for (index, some) in words.chunks(AT_ONCE).enumerate() {
            if step(index * AT_ONCE, words.len()).is_break() {
                return Err(Error::Interrupted);
            }
            self.link.write(map::TILE_PIXELS.word((index * AT_ONCE) as u32), some)?;
        }
        self.link.set(map::PATTERN, TILE)
    }

    /// Checks that there is a picture, or that a frame for one has come: waits a second for the first.
    ///
    /// # Errors
    /// [`Error::NoPicture`], or a line that fails.
    pub fn check_picture(&mut self) -> Result<(), Error> {
        let end = self.line().time() + FIRST_FRAME;
        while self.named("status.output_runs")? == 0 && self.named("raw_frames")? == 0 {
            if self.line().time() >= end {
                return Err(Error::NoPicture { port: self.port() });
            }
        }
        Ok(())
    }

    /// The codes of a part of the last picture, whose first pixel is at `row`, `column` and which has so many rows and columns; 0 outside of the picture.
    ///
    /// # Errors
    /// As [`Board::put_tile`].
    pub fn get_codes(
        &mut self,
        (row, column): (usize, usize),
        (rows, columns): (usize, usize),
        step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Array2<u16>, Error> {
        let mut codes = Array2::zeros((rows, columns));
        let starts = |length: usize| (0..length).step_by(TILE_SIDE);
        let total = starts(rows).len() * starts(columns).len() * TILE_PIXELS;
        let mut before = 0;
        for (r, c) in starts(rows).flat_map(|r| starts(columns).map(move |c| (r, c))) {
            let square =
                self.square(((row + r) << 16 | (column + c)) as u32, &mut |done| step(before + done, total))?;
            before += TILE_PIXELS;
            let (height, width) = (TILE_SIDE.min(rows - r), TILE_SIDE.min(columns - c));
            codes.slice_mut(s![r..r + height, c..c + width]).assign(&square.slice(s![..height, ..width]));
        }
        Ok(codes)
    }

    /// The square of 64 × 64 pixels that the word of `picture_corner` asks for.
    pub(crate) fn square(
        &mut self,
        corner: u32,
        step: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<Array2<u16>, Error> {
        self.link.set(map::PICTURE_CORNER, corner)?;
        // A whole picture passes after the corner was set.
        self.pass("picture_frames", 2)?;
        let mut words = vec![];
        while words.len() < TILE_PIXELS {
            if step(words.len()).is_break() {
                return Err(Error::Interrupted);
            }
            let some = self.link.read(map::PICTURE_PIXELS.word(words.len() as u32), AT_ONCE)?;
            words.extend(some.into_iter().map(|word| word as u16));
        }
        Ok(Array2::from_shape_fn((TILE_SIDE, TILE_SIDE), |(r, c)| words[TILE_SIDE * r + c]))
    }

    /// Waits until a counter of frames has grown by so much.
    pub(crate) fn pass(&mut self, counter: &str, frames: u32) -> Result<(), Error> {
        let first = self.named(counter)?;
        for _ in 0..MAX_LOOKS {
            if self.named(counter)?.wrapping_sub(first) >= frames {
                return Ok(());
            }
        }
        Err(Error::NoFrame { port: self.port() })
    }
}

/// Within this time the first frame comes, where there is a source.
const FIRST_FRAME: Duration = Duration::from_secs(1);

/// Looks for a picture before it is given up.
const MAX_LOOKS: usize = 20_000;
