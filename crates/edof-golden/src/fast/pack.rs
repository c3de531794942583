//! Weights laid out for the kernels, with what bounds their sums.

use super::isa::Isa;
use ndarray::Array2;

/// Accumulators are computed in groups of this many rows.
pub const GROUP: usize = 64;

/// Block lengths, in pairs of columns, whose sums may run in 32 bits; a block of one pair always fits.
const BLOCKS: [usize; 6] = [128, 36, 18, 8, 4, 1];

/// Rows rounded up to whole groups.
#[must_use]
pub const fn padded(rows: usize) -> usize {
    rows.div_ceil(GROUP) * GROUP
}

/// A matrix for dense inputs of 0…32767.
#[derive(Debug, Clone)]
pub struct Dense {
    /// Inputs; even.
    pub columns: usize,
    /// Padded rows.
    pub stride: usize,
    /// Pair of columns, then row, then column within the pair.
    pub weights: Vec<i16>,
    /// For each group of rows and each of [`BLOCKS`]: the largest Σ of weights of one sign over a row's block.
    largest: Vec<[u64; BLOCKS.len()]>,
}

impl Dense {
    /// Packs rows × columns weights; an odd last column gets a zero beside it.
    #[must_use]
    pub fn new(weights: &Array2<i16>) -> Self {
        let (rows, columns) = (weights.nrows(), weights.ncols().next_multiple_of(2));
        let stride = padded(rows);
        let mut packed = vec![0; stride * columns];
        for ((row, column), &w) in weights.indexed_iter() {
            packed[(column / 2 * stride + row) * 2 + column % 2] = w;
        }
        let largest = (0..stride / GROUP)
            .map(|group| {
                BLOCKS.map(|pairs| {
                    (group * GROUP..rows.min((group + 1) * GROUP))
                        .flat_map(|row| {
                            let row: Vec<i64> = weights.row(row).iter().map(|w| i64::from(*w)).collect();
                            row.chunks(2 * pairs).map(one_signed).max()
                        })
                        .max()
                        .unwrap_or(0)
                })
            })
            .collect();
        Self { columns, stride, weights: packed, largest }
    }

    /// Pairs of columns whose sums provably fit 32 bits in this group of rows, for inputs of 0…`input`.
    #[must_use]
    pub fn block(&self, group: usize, input: i16) -> usize {
        let fits = |sum: &u64| sum * input.unsigned_abs() as u64 <= i32::MAX as u64;
        let best = self.largest[group].iter().position(fits).unwrap_or(BLOCKS.len() - 1);
        BLOCKS[best]
    }
}

/// The larger of the sums of positive and of negative weights: times the largest input it bounds every partial sum.
fn one_signed(weights: &[i64]) -> u64 {
    let positive: i64 = weights.iter().filter(|w| **w > 0).sum();
    let negative: i64 = weights.iter().filter(|w| **w < 0).sum();
    positive.unsigned_abs().max(negative.unsigned_abs())
}

/// A matrix for sparse inputs.
#[derive(Debug, Clone)]
pub struct Sparse {
    /// Padded rows.
    pub stride: usize,
    /// Column by column; the rows of a column in the order in which the kernel interleaves two columns.
    pub weights: Vec<i16>,
    /// Largest |weight| of each column.
    pub bounds: Vec<u32>,
}

impl Sparse {
    /// Packs rows × columns weights for an instruction set.
    #[must_use]
    pub fn new(weights: &Array2<i16>, isa: Isa) -> Self {
        let stride = padded(weights.nrows());
        let place: Vec<usize> = (0..stride).map(|row| place(row, interleaved(isa))).collect();
        let mut packed = vec![0; stride * weights.ncols()];
        for ((row, column), &w) in weights.indexed_iter() {
            packed[column * stride + place[row]] = w;
        }
        let largest = |column: ndarray::ArrayView1<'_, i16>| {
            column.iter().map(|w| u32::from(w.unsigned_abs())).max().unwrap_or(0)
        };
        Self { stride, weights: packed, bounds: weights.columns().into_iter().map(largest).collect() }
    }
}

/// Words in a vector that is interleaved with another; none where columns are taken word by word.
const fn interleaved(isa: Isa) -> Option<usize> {
    match isa {
        Isa::Portable => None,
        Isa::Avx2(_) => Some(16),
        Isa::Avx512(_) => Some(32),
    }
}

/// Where a column holds `row`. Interleaving two vectors of 2h words takes from each 128-bit lane its lower four words into
/// one result and its upper four into the other; rows are placed so that the first result is rows 0…h−1 and the second the rest.
fn place(row: usize, words: Option<usize>) -> usize {
    let Some(words) = words else { return row };
    let (vector, within) = (row / words * words, row % words);
    let (upper, in_half) = (within / (words / 2), within % (words / 2));
    vector + in_half / 4 * 8 + upper * 4 + in_half % 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_a_place_of_its_own() {
        for words in [None, Some(16), Some(32)] {
            let mut places: Vec<usize> = (0..GROUP).map(|row| place(row, words)).collect();
            places.sort_unstable();
            assert_eq!(places, (0..GROUP).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_block_is_as_long_as_its_worst_row_allows() {
        let one = |w: i16| Dense::new(&Array2::from_elem((3, 144), w));
        assert_eq!(one(i16::MIN).block(0, i16::MAX), 1);
        assert_eq!(one(i16::MIN).block(0, 16384), 1);
        assert_eq!(one(3000).block(0, i16::MAX), 8);
        assert_eq!(one(100).block(0, i16::MAX), 128);
        // Alternating signs: partial sums stay within the positive weights' sum.
        let mixed =
            Dense::new(&Array2::from_shape_fn((1, 36), |(_, c)| if c % 2 == 0 { 8000 } else { -8000 }));
        assert_eq!(mixed.block(0, i16::MAX), 8);
    }
}
