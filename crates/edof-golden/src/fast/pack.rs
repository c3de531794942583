//! Weights for dense vectors, pair of columns by pair of columns, with what bounds their sums.

use super::sums::SUM_BITS;
use ndarray::Array2;

/// Rows that a kernel works on at a time.
pub const PANEL: usize = 64;

/// Rows of a [`Line`].
const LINE_ROWS: usize = 16;

/// Lines that a pair of columns has in a panel.
pub const LINES: usize = PANEL / LINE_ROWS;

/// The largest sum that 32 bits hold.
pub const MAX: u64 = i32::MAX as u64;

/// Block lengths, in pairs of columns, whose sums may run in 32 bits; a block of one pair always fits.
const BLOCKS: [usize; 6] = [128, 36, 18, 8, 4, 1];

/// Rows rounded up to whole panels.
#[must_use]
pub const fn padded(rows: usize) -> usize {
    rows.div_ceil(PANEL) * PANEL
}

/// Thirty-two weights: a line of the cache. Here sixteen rows of a pair of columns, row by row.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Line(pub [i16; 2 * LINE_ROWS]);

/// A matrix, panel by panel; in a panel pair of columns by pair of columns.
#[derive(Debug, Clone)]
pub struct Packed {
    /// Pairs of columns: an odd last column has zeros beside it.
    pub pairs: usize,
    /// Padded rows.
    pub rows: usize,
    lines: Vec<Line>,
    /// For each panel and each of [`BLOCKS`]: the largest Σ of weights of one sign over a row's block.
    one_signed: Vec<[u64; BLOCKS.len()]>,
    /// The largest Σ of |weights| over a row.
    row_sum: u64,
}

impl Packed {
    /// Packs rows × columns weights.
    #[must_use]
    pub fn new(weights: &Array2<i16>) -> Self {
        let (pairs, rows) = (weights.ncols().div_ceil(2), padded(weights.nrows()));
        let mut lines = vec![Line([0; 2 * LINE_ROWS]); rows / LINE_ROWS * pairs];
        for ((row, column), &w) in weights.indexed_iter() {
            let (panel, row) = (row / PANEL, row % PANEL);
            let line = (panel * pairs + column / 2) * LINES + row / LINE_ROWS;
            lines[line].0[row % LINE_ROWS * 2 + column % 2] = w;
        }
        let one_signed = (0..rows / PANEL)
            .map(|panel| {
                let of_panel = panel * PANEL..weights.nrows().min((panel + 1) * PANEL);
                BLOCKS.map(|pairs| {
                    of_panel.clone().map(|row| worst_block(weights, row, pairs)).max().unwrap_or(0)
                })
            })
            .collect();
        Self { pairs, rows, lines, one_signed, row_sum: worst_row(weights) }
    }

    /// Panels, each with its first row.
    pub fn panels(&self) -> impl Iterator<Item = (usize, &[Line])> {
        self.lines.chunks_exact((self.pairs * LINES).max(1)).enumerate().map(|(i, panel)| (i * PANEL, panel))
    }

    /// Whether the sums of any words of 16 bits fit [`SUM_BITS`].
    #[must_use]
    pub const fn fits(&self) -> bool {
        self.row_sum < 1 << (SUM_BITS - 16)
    }

    /// Pairs of columns whose sums provably fit 32 bits in this panel, for inputs of 0…`input`.
    #[must_use]
    pub fn block(&self, panel: usize, input: i16) -> usize {
        let fits = |sum: &u64| sum * u64::from(input.unsigned_abs()) <= MAX;
        let best = self.one_signed[panel].iter().position(fits).unwrap_or(BLOCKS.len() - 1);
        BLOCKS[best]
    }
}

/// The largest Σ of |weights| over a row.
#[must_use]
pub fn worst_row(weights: &Array2<i16>) -> u64 {
    let sizes = |row: ndarray::ArrayView1<'_, i16>| row.iter().map(|w| u64::from(w.unsigned_abs())).sum();
    weights.rows().into_iter().map(sizes).max().unwrap_or(0)
}

/// Over a row's blocks, the larger of the sums of positive and of negative weights: times the largest input it bounds every partial
/// sum.
fn worst_block(weights: &Array2<i16>, row: usize, pairs: usize) -> u64 {
    let row: Vec<i64> = weights.row(row).iter().map(|w| i64::from(*w)).collect();
    let one_signed = |block: &[i64]| {
        let positive: i64 = block.iter().filter(|w| **w > 0).sum();
        let negative: i64 = block.iter().filter(|w| **w < 0).sum();
        positive.unsigned_abs().max(negative.unsigned_abs())
    };
    row.chunks(2 * pairs).map(one_signed).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_weight_has_a_place_of_its_own() {
        let weights = Array2::from_shape_fn((70, 5), |(row, column)| (row * 5 + column) as i16 + 1);
        let packed = Packed::new(&weights);
        assert_eq!((packed.pairs, packed.rows), (3, 128));
        let mut held: Vec<i16> =
            packed.panels().flat_map(|(_, panel)| panel.iter().flat_map(|line| line.0)).collect();
        held.retain(|w| *w != 0);
        held.sort_unstable();
        assert!(held.into_iter().eq(1..=350));
        let (first, panel) = packed.panels().nth(1).unwrap();
        assert_eq!((first, panel[LINES].0[2], panel[LINES].0[3]), (64, weights[(65, 2)], weights[(65, 3)]));
    }

    #[test]
    fn a_block_is_as_long_as_its_worst_row_allows() {
        let one = |w: i16| Packed::new(&Array2::from_elem((3, 144), w));
        assert_eq!(one(i16::MIN).block(0, i16::MAX), 1);
        assert_eq!(one(i16::MIN).block(0, 16384), 1);
        assert_eq!(one(3000).block(0, i16::MAX), 8);
        assert_eq!(one(100).block(0, i16::MAX), 128);
        // Alternating signs: partial sums stay within the positive weights' sum.
        let mixed =
            Packed::new(&Array2::from_shape_fn((1, 36), |(_, c)| if c % 2 == 0 { 8000 } else { -8000 }));
        assert_eq!(mixed.block(0, i16::MAX), 8);
    }

    #[test]
    fn five_hundred_and_eleven_of_the_largest_products_fit_and_no_more() {
        let row = |columns| Packed::new(&Array2::from_elem((1, columns), i16::MIN));
        assert!(row(511).fits());
        assert!(!row(512).fits());
    }
}
