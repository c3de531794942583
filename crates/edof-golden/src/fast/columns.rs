//! Weights for sparse vectors: column by column, so that any two of them can be multiplied at once.

use super::pack::{Line, PANEL, padded, worst_row};
use super::sums::SUM_BITS;
use ndarray::Array2;

/// Rows of a [`Line`] that holds one column.
const LINE_ROWS: usize = 32;

/// Lines that a column has in a panel.
pub const LINES: usize = PANEL / LINE_ROWS;

/// A matrix, panel by panel; in a panel column by column.
#[derive(Debug, Clone)]
pub struct Columns {
    /// Columns.
    pub columns: usize,
    /// Padded rows.
    pub rows: usize,
    lines: Vec<Line>,
    /// The largest |weight|.
    pub largest: u64,
    /// The largest Σ of |weights| over a row.
    row_sum: u64,
}

impl Columns {
    /// Lays out rows × columns weights.
    #[must_use]
    pub fn new(weights: &Array2<i16>) -> Self {
        let (columns, rows) = (weights.ncols(), padded(weights.nrows()));
        let mut lines = vec![Line([0; LINE_ROWS]); rows / LINE_ROWS * columns];
        for ((row, column), &w) in weights.indexed_iter() {
            let (panel, row) = (row / PANEL, row % PANEL);
            let line = (panel * columns + column) * LINES + row / LINE_ROWS;
            lines[line].0[place(row % LINE_ROWS)] = w;
        }
        let largest = weights.iter().map(|w| u64::from(w.unsigned_abs())).max().unwrap_or(0);
        Self { columns, rows, lines, largest, row_sum: worst_row(weights) }
    }

    /// Panels, each with its first row.
    pub fn panels(&self) -> impl Iterator<Item = (usize, &[Line])> {
        self.lines
            .chunks_exact((self.columns * LINES).max(1))
            .enumerate()
            .map(|(i, panel)| (i * PANEL, panel))
    }

    /// Whether the sums of any words of 16 bits fit [`SUM_BITS`].
    #[must_use]
    pub const fn fits(&self) -> bool {
        self.row_sum < 1 << (SUM_BITS - 16)
    }
}

/// Where a row's weight stands in its line. Vectors interleave the words of two columns in groups of four, the first half of each eight
/// and then the second; so ordered, the pairs come out row by row.
#[must_use]
pub const fn place(row: usize) -> usize {
    let (half, group, word) = (row / 16, row / 4 % 4, row % 4);
    8 * group + 4 * half + word
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_weight_has_a_place_of_its_own() {
        let weights = Array2::from_shape_fn((70, 5), |(row, column)| (row * 5 + column) as i16 + 1);
        let columns = Columns::new(&weights);
        assert_eq!((columns.columns, columns.rows, columns.largest), (5, 128, 350));
        let mut held: Vec<i16> =
            columns.panels().flat_map(|(_, panel)| panel.iter().flat_map(|line| line.0)).collect();
        held.retain(|w| *w != 0);
        held.sort_unstable();
        assert!(held.into_iter().eq(1..=350));
        let (first, panel) = columns.panels().nth(1).unwrap();
        assert_eq!((first, panel[3 * LINES].0[place(5)]), (64, weights[(69, 3)]));
    }

    #[test]
    fn halves_of_eight_words_are_rows_that_follow_each_other() {
        assert_eq!([0, 3, 4, 15, 16, 19, 31].map(place), [0, 3, 8, 27, 4, 7, 31]);
    }

    #[test]
    fn five_hundred_and_eleven_of_the_largest_products_fit_and_no_more() {
        let row = |columns| Columns::new(&Array2::from_elem((1, columns), i16::MIN));
        assert!(row(511).fits());
        assert!(!row(512).fits());
    }
}
