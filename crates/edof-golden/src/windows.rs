//! Windows: the input words that a network sees around a patch.

use edof_core::geometry::{GeometryError, mirror};
use edof_core::number::{InputWord, input_word};
use edof_core::{Geometry, RawFrame};
use edof_network::FixedNetwork;
use std::ops::Range;

/// Input words of the window around patch (`row`, `column`) of a red-first frame, row by row, mirrored at the borders.
/// Reads like the specification; [`Mirrored`] gives the same words faster.
#[must_use]
pub fn window(raw: &RawFrame, geometry: Geometry, row: usize, column: usize) -> Vec<InputWord> {
    let (height, width) = raw.size();
    let (top, left) = (geometry.window_start(row), geometry.window_start(column));
    let side = geometry.window.side() as isize;
    (top..top + side)
        .flat_map(|r| (left..left + side).map(move |c| (r, c)))
        .map(|(r, c)| input_word(raw.pixels()[(mirror(r, height), mirror(c, width))]))
        .collect()
}

/// All windows of a red-first frame, in the order in which the hardware takes them.
///
/// # Errors
/// [`GeometryError`] for a frame that is too small for the network's windows.
pub fn all<'a>(
    network: &FixedNetwork,
    raw: &'a RawFrame,
) -> Result<impl Iterator<Item = Vec<InputWord>> + use<'a>, GeometryError> {
    let geometry = Geometry::new(network.form.window, network.stride);
    let (height, width) = raw.size();
    geometry.check_frame((height, width))?;
    let (rows, columns) = geometry.patches(height, width);
    Ok((0..rows).flat_map(move |row| (0..columns).map(move |column| window(raw, geometry, row, column))))
}

/// The lines that some rows of patches see, as input words with the mirrored border around them, so that every window is a plain block.
#[derive(Debug, Clone)]
pub struct Mirrored {
    words: Vec<InputWord>,
    width: usize,
    geometry: Geometry,
    /// First row of patches.
    first: usize,
}

impl Mirrored {
    /// The lines of all patches of a red-first frame that [`Geometry::check_frame`] accepts.
    #[must_use]
    pub fn new(raw: &RawFrame, geometry: Geometry) -> Self {
        let mut all = Self::empty(geometry);
        all.take(raw, 0..geometry.patches(raw.size().0, raw.size().1).0);
        all
    }

    /// No lines yet.
    #[must_use]
    pub const fn empty(geometry: Geometry) -> Self {
        Self { words: Vec::new(), width: 0, geometry, first: 0 }
    }

    /// Takes the lines around some rows of patches of a red-first frame that [`Geometry::check_frame`] accepts.
    pub fn take(&mut self, raw: &RawFrame, rows: Range<usize>) {
        let (height, width) = raw.size();
        let (reach, side) = (self.geometry.reach(), self.geometry.window.side());
        self.first = rows.start;
        self.width = width + 2 * reach;
        self.words.clear();
        let top = self.geometry.window_start(rows.start);
        let bottom = self.geometry.window_start(rows.end - 1) + side as isize;
        for line in top..bottom {
            let line = raw.pixels().row(mirror(line, height));
            let outside = |columns: Range<isize>| columns.map(|c| input_word(line[mirror(c, width)]));
            let (reach, width) = (reach as isize, width as isize);
            self.words.extend(outside(-reach..0));
            match line.as_slice() {
                Some(line) => self.words.extend(line.iter().map(|v| input_word(*v))),
                None => self.words.extend(outside(0..width)),
            }
            self.words.extend(outside(width..width + reach));
        }
    }

    /// Writes the window around patch (`row`, `column`), one of the rows taken, into `out`, row by row.
    pub fn copy_window(&self, row: usize, column: usize, out: &mut [InputWord]) {
        let side = self.geometry.window.side();
        let top = (row - self.first) * self.geometry.stride.pixels();
        let left = (self.geometry.window_start(column) + self.geometry.reach() as isize) as usize;
        let words = &self.words[top * self.width + left..];
        match side {
            8 => copy_block::<8>(words, self.width, out),
            12 => copy_block::<12>(words, self.width, out),
            _ => copy_block::<16>(words, self.width, out),
        }
    }
}

/// Writes a block whose lines are `SIDE` words long: a length that the compiler knows makes them a few moves.
fn copy_block<const SIDE: usize>(words: &[InputWord], width: usize, out: &mut [InputWord]) {
    for (line, out) in words.chunks(width).zip(out.as_chunks_mut::<SIDE>().0) {
        out.copy_from_slice(&line[..SIDE]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::{CfaPhase, Stride, Window};
    use ndarray::Array2;

    #[test]
    fn blocks_of_the_mirrored_frame_are_the_windows() {
        let (height, width) = (22, 26);
        let values = Array2::from_shape_fn((height, width), |(r, c)| (r * 997 + c * 31) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();
        for (side, step) in [(8, 8), (8, 2), (12, 4), (16, 8), (16, 2)] {
            let g = Geometry::new(Window::new(side).unwrap(), Stride::new(step).unwrap());
            let mut mirrored = Mirrored::empty(g);
            let (rows, columns) = g.patches(height, width);
            for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
                mirrored.take(&raw, r / 2 * 2..rows.min(r / 2 * 2 + 2));
                let mut block = vec![InputWord::ZERO; side * side];
                mirrored.copy_window(r, c, &mut block);
                assert_eq!(block, window(&raw, g, r, c), "window {side} stride {step} patch {r},{c}");
            }
        }
    }

    #[test]
    fn a_window_of_a_frame_mirrors_about_the_edge_pixel_and_halves_the_words() {
        let values = Array2::from_shape_fn((20, 20), |(r, c)| (r * 20 + c) as u16);
        let raw = RawFrame::from_values(values, 8 + 1, CfaPhase::Rggb).unwrap();
        let g = Geometry::new(Window::new(12).unwrap(), Stride::PATCH);
        let first = window(&raw, g, 0, 0);
        // Window row 0, column 0 is frame row −2, column −2: pixel (2, 2), sensor value 42 of 9 bits.
        assert_eq!(first[0].to_bits(), 42 << 6);
        assert_eq!(first[2 * 12 + 2], InputWord::ZERO);
    }
}
