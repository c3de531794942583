//! Windows: the input words that a network sees around a patch.

use edof_spec::geometry::mirror;
use edof_spec::number::input_word;
use edof_spec::{Geometry, RawFrame};

/// Input words of the window around patch (`row`, `column`) of a red-first frame, row by row, mirrored at the borders.
/// Reads like the specification; [`Mirrored`] gives the same words faster.
#[must_use]
pub fn window(raw: &RawFrame, geometry: Geometry, row: usize, column: usize) -> Vec<i16> {
    let (height, width) = raw.size();
    let (top, left) = (geometry.window_start(row), geometry.window_start(column));
    let side = geometry.window.side() as isize;
    (top..top + side)
        .flat_map(|r| (left..left + side).map(move |c| (r, c)))
        .map(|(r, c)| input_word(raw.pixels()[(mirror(r, height), mirror(c, width))]))
        .collect()
}

/// A frame as input words with its mirrored border around it, so that every window is a plain block.
#[derive(Debug, Clone)]
pub struct Mirrored {
    words: Vec<i16>,
    width: usize,
    geometry: Geometry,
}

impl Mirrored {
    /// Takes a red-first frame that [`Geometry::check_frame`] accepts.
    #[must_use]
    pub fn new(raw: &RawFrame, geometry: Geometry) -> Self {
        let (height, width) = raw.size();
        let reach = geometry.reach();
        let inside = |index: usize, length| mirror(index as isize - reach as isize, length);
        let columns: Vec<usize> = (0..width + 2 * reach).map(|c| inside(c, width)).collect();
        let mut words = Vec::with_capacity((height + 2 * reach) * columns.len());
        for r in 0..height + 2 * reach {
            let line = raw.pixels().row(inside(r, height));
            words.extend(columns.iter().map(|&c| input_word(line[c])));
        }
        Self { words, width: columns.len(), geometry }
    }

    /// Writes the window around patch (`row`, `column`) into `out`, row by row.
    pub fn copy_window(&self, row: usize, column: usize, out: &mut [i16]) {
        let start = |index| (self.geometry.window_start(index) + self.geometry.reach() as isize) as usize;
        let (top, left, side) = (start(row), start(column), self.geometry.window.side());
        for (line, out) in self.words.chunks_exact(self.width).skip(top).zip(out.chunks_exact_mut(side)) {
            out.copy_from_slice(&line[left..left + side]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::{CfaPhase, Stride, Window};
    use ndarray::Array2;

    #[test]
    fn blocks_of_the_mirrored_frame_are_the_windows() {
        let (height, width) = (22, 26);
        let values = Array2::from_shape_fn((height, width), |(r, c)| (r * 997 + c * 31) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();
        for (side, step) in [(8, 8), (8, 2), (12, 4), (16, 8), (16, 2)] {
            let g = Geometry::new(Window::new(side).unwrap(), Stride::new(step).unwrap());
            let mirrored = Mirrored::new(&raw, g);
            let (rows, columns) = g.patches(height, width);
            for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
                let mut block = vec![0; side * side];
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
        assert_eq!(first[0], 42 << 6);
        assert_eq!(first[2 * 12 + 2], 0);
    }
}
