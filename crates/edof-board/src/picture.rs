//! A window to a board's pictures over the line: raw pixels in, codes out.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use edof_device::pattern::{TILE, TILE_PIXELS, TILE_SIDE};
use edof_device::registers::map;
use ndarray::{Array2, s};
use std::ops::ControlFlow;

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
            let square = self.square((row + r, column + c), &mut |done| step(before + done, total))?;
            before += TILE_PIXELS;
            let (height, width) = (TILE_SIDE.min(rows - r), TILE_SIDE.min(columns - c));
            codes.slice_mut(s![r..r + height, c..c + width]).assign(&square.slice(s![..height, ..width]));
        }
        Ok(codes)
    }

    /// The codes of the square of 64 × 64 pixels from a corner on.
    fn square(
        &mut self,
        (row, column): (usize, usize),
        step: &mut dyn FnMut(usize) -> ControlFlow<()>,
    ) -> Result<Array2<u16>, Error> {
        self.link.set(map::PICTURE_CORNER, (row << 16 | column) as u32)?;
        // A whole picture passes after the corner was set.
        let first = self.named("picture_frames")?;
        let mut looks = 0;
        while self.named("picture_frames")?.wrapping_sub(first) < 2 {
            looks += 1;
            if looks > MAX_LOOKS {
                return Err(Error::NoFrame { port: self.port() });
            }
        }
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
}

/// Looks for a picture before it is given up.
const MAX_LOOKS: usize = 20_000;
