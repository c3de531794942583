//! Matrix products on AMX, whose tiles have 16 rows of 64 bytes.
//!
//! A word is `256 · high + low`, its high byte with a sign and its low one without. So a sum of products of words is four sums of products of
//! bytes, and each of these fits 32 bits for vectors of up to [`MAX_COLUMNS`] words, whatever they are: nothing is bounded or split, and sparse
//! vectors take no longer to list than to multiply.

use super::isa::{Amx, Isa, for_each_isa};
use super::pack::padded;
use super::sums::{LOW, LOW_BITS, Sums};
use ndarray::Array2;

/// Vectors, or rows of a matrix, that a tile holds.
pub const TILE: usize = 16;

/// Columns of a tile: a byte each.
const STEP: usize = 64;

/// Words of a vector: 2^31 divided by the largest sum of a word's mixed products of bytes.
const MAX_COLUMNS: usize = (1 << 31) / (2 * 255 * 128);

/// 64 bytes: a row of a tile, in a line of the cache.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Row([u8; STEP]);

const EMPTY: Row = Row([0; STEP]);

/// A matrix in tiles of 16 of its rows and 64 of its columns.
#[derive(Debug, Clone)]
pub struct Tiled {
    /// Rows as [`super::pack::Packed`] pads them.
    rows: usize,
    /// Tiles with columns.
    steps: usize,
    /// For each 16 rows and each 64 columns a tile of high bytes, then one of low ones. A tile's row has four columns of each of the 16 rows.
    tiles: Vec<[Row; 2 * TILE]>,
}

impl Tiled {
    /// Packs rows × columns weights, of at most 32,896 columns.
    #[must_use]
    pub fn new(weights: &Array2<i16>) -> Self {
        let (rows, steps) = (padded(weights.nrows()), weights.ncols().div_ceil(STEP));
        assert!(weights.ncols() <= MAX_COLUMNS, "{} columns: must be at most {MAX_COLUMNS}", weights.ncols());
        let mut tiles = vec![[EMPTY; 2 * TILE]; rows / TILE * steps];
        for ((row, column), &weight) in weights.indexed_iter() {
            let tile = &mut tiles[row / TILE * steps + column / STEP];
            let (line, byte) = (column % STEP / 4, row % TILE * 4 + column % 4);
            let [low, high] = weight.to_le_bytes();
            (tile[line].0[byte], tile[TILE + line].0[byte]) = (high, low);
        }
        Self { rows, steps, tiles }
    }
}

/// Bytes of some vectors' words: for each vector and each 64 of its words their high bytes, then their low ones.
#[derive(Debug, Clone, Default)]
pub struct Planes(Vec<[Row; 2]>);

impl Planes {
    /// Takes vectors apart, into as many rows for each as a matrix has tiles with columns.
    fn fill(&mut self, isa: Isa, vectors: Vectors<'_>, steps: usize) {
        let each = vectors.words.chunks(vectors.stride);
        self.0.resize(each.len().next_multiple_of(TILE) * steps, [EMPTY; 2]);
        for (vector, rows) in each.zip(self.0.chunks_mut(steps)) {
            for (some, rows) in vector[..vectors.columns].chunks(STEP).zip(rows) {
                halves(isa, some, rows);
            }
        }
    }
}

for_each_isa! {
    /// High and low bytes of up to 64 words.
    fn halves(words: &[i16], rows: &mut [Row; 2]) -> () {
        let [high, low] = rows;
        for ((word, high), low) in words.iter().zip(&mut high.0).zip(&mut low.0) {
            [*low, *high] = word.to_le_bytes();
        }
    }
}

/// Sums of products of high bytes, of mixed ones, and of low ones: for each of 16 vectors those of 16 rows of a matrix.
type Products = [[[i32; TILE]; TILE]; 3];

/// Vectors that begin some words after each other.
#[derive(Debug, Clone, Copy)]
pub struct Vectors<'a> {
    /// The words of all of them.
    pub words: &'a [i16],
    /// Words from one's first to the next one's.
    pub stride: usize,
    /// Words of each.
    pub columns: usize,
}

/// A matrix times vectors, into `matrix.rows` sums each. Low parts of sums stay as they were where the caller does not want them.
pub fn dense(
    token: Amx,
    matrix: &Tiled,
    vectors: Vectors<'_>,
    planes: &mut Planes,
    (sums, wants_low): (&mut Sums, bool),
) {
    let (isa, steps) = (Isa::Amx(token), matrix.steps);
    planes.fill(isa, vectors, steps);
    let count = vectors.words.len() / vectors.stride;
    let mut products: Products = [[[0; TILE]; TILE]; 3];
    let tiles = Tiles::configured(token);
    for (row, weights) in (0..matrix.rows).step_by(TILE).zip(matrix.tiles.chunks(steps)) {
        for (number, some) in planes.0.chunks(TILE * steps).enumerate() {
            tiles.multiply(some, weights, &mut products);
            let (first, from) = (TILE * number, TILE * number * matrix.rows + row);
            let count = (count - first).min(TILE);
            high_parts(isa, &products, count, matrix.rows, &mut sums.high[from..]);
            if wants_low {
                low_parts(isa, &products, count, matrix.rows, &mut sums.low[from..]);
            }
        }
    }
}

for_each_isa! {
    /// High parts of the first vectors' sums, those of a vector `stride` after the one's before it.
    fn high_parts(products: &Products, vectors: usize, stride: usize, to: &mut [i32]) -> () {
        let [highs, mixed, lows] = products.each_ref().map(|tile| tile.as_flattened());
        let sum = |i: usize| (highs[i] << 8) + mixed[i] + (lows[i] >> LOW_BITS);
        let mut sums = [0; TILE * TILE];
        (0..TILE * TILE).for_each(|i| sums[i] = sum(i));
        spread(&sums, vectors, stride, to);
    }
}

for_each_isa! {
    /// Low parts, likewise.
    fn low_parts(products: &Products, vectors: usize, stride: usize, to: &mut [i32]) -> () {
        let mut sums = [0; TILE * TILE];
        for (sum, low) in sums.iter_mut().zip(products[2].as_flattened()) {
            *sum = low & LOW;
        }
        spread(&sums, vectors, stride, to);
    }
}

#[inline(always)]
fn spread(sums: &[i32; TILE * TILE], vectors: usize, stride: usize, to: &mut [i32]) {
    for (from, to) in sums.chunks_exact(TILE).zip(to.chunks_mut(stride)).take(vectors) {
        to[..TILE].copy_from_slice(from);
    }
}

for_each_isa! {
    /// How many words are not zero.
    pub fn nonzeros(words: &[i16]) -> u64 {
        words.iter().map(|word| u32::from(*word != 0)).sum::<u32>().into()
    }
}

/// This thread's tile registers, each of 16 rows of 64 bytes, until it is dropped.
struct Tiles {
    /// They are of one thread.
    _thread: std::marker::PhantomData<*const ()>,
}

#[cfg(target_arch = "x86_64")]
mod registers {
    use super::{Amx, Products, Row, STEP, TILE, Tiles};
    use std::arch::asm;

    /// Palette 1, and for each of eight tiles bytes of a row, and rows (Intel's manual, LDTILECFG).
    #[repr(C, align(64))]
    struct Configuration {
        palette: u8,
        start_row: u8,
        reserved: [u8; 14],
        row_bytes: [u16; 16],
        rows: [u8; 16],
    }

    static ALL_WHOLE: Configuration = Configuration {
        palette: 1,
        start_row: 0,
        reserved: [0; 14],
        row_bytes: [64, 64, 64, 64, 64, 64, 64, 64, 0, 0, 0, 0, 0, 0, 0, 0],
        rows: [16, 16, 16, 16, 16, 16, 16, 16, 0, 0, 0, 0, 0, 0, 0, 0],
    };

    impl Tiles {
        pub(super) fn configured(_: Amx) -> Self {
            // SAFETY: the token proves that this process may use tiles; what is read is a legal configuration.
            unsafe { asm!("ldtilecfg [{}]", in(reg) &raw const ALL_WHOLE, options(nostack, readonly)) };
            Self { _thread: std::marker::PhantomData }
        }

        /// 16 vectors times 16 rows. Panics if one has not the other's columns.
        pub(super) fn multiply(&self, vectors: &[[Row; 2]], weights: &[[Row; 2 * TILE]], out: &mut Products) {
            let steps = weights.len();
            assert!(steps > 0 && vectors.len() == TILE * steps, "{} steps for {}", vectors.len(), steps);
            // SAFETY: tiles are configured. A tile of vectors has 16 rows, `steps` pairs of rows apart, which the slice holds, as it holds
            // `steps` of them, a pair apart; weights have two tiles per step; `out` has four tiles.
            unsafe {
                asm!(
                    "tilezero tmm0",
                    "tilezero tmm1",
                    "tilezero tmm2",
                    "2:",
                    "tileloadd tmm4, [{vectors} + {apart}*1]",
                    "tileloadd tmm5, [{weights} + {row}*1]",
                    "tdpbssd tmm0, tmm4, tmm5",
                    "tileloadd tmm6, [{vectors} + {apart}*1 + 64]",
                    "tdpbusd tmm1, tmm6, tmm5",
                    "tileloadd tmm7, [{weights} + {row}*1 + 1024]",
                    "tdpbuud tmm2, tmm6, tmm7",
                    "tdpbsud tmm1, tmm4, tmm7",
                    "add {vectors}, 128",
                    "add {weights}, 2048",
                    "dec {steps}",
                    "jnz 2b",
                    "tilestored [{out} + {row}*1], tmm0",
                    "tilestored [{out} + {row}*1 + 1024], tmm1",
                    "tilestored [{out} + {row}*1 + 2048], tmm2",
                    vectors = inout(reg) vectors.as_ptr() => _,
                    weights = inout(reg) weights.as_ptr() => _,
                    steps = inout(reg) steps => _,
                    apart = in(reg) steps * size_of::<[Row; 2]>(),
                    row = in(reg) STEP,
                    out = in(reg) out,
                    out("tmm0") _, out("tmm1") _, out("tmm2") _,
                    out("tmm4") _, out("tmm5") _, out("tmm6") _, out("tmm7") _,
                    options(nostack),
                );
            }
        }
    }

    impl Drop for Tiles {
        fn drop(&mut self) {
            // SAFETY: tiles were configured, so the processor has the instruction.
            unsafe { asm!("tilerelease", options(nostack, nomem)) };
        }
    }
}

/// What tiles compute, in plain Rust.
#[cfg(any(test, not(target_arch = "x86_64")))]
fn multiplied(vectors: &[[Row; 2]], weights: &[[Row; 2 * TILE]]) -> Products {
    let mut products: Products = [[[0; TILE]; TILE]; 3];
    let steps = weights.len();
    let signed = |byte: u8| i32::from(byte as i8);
    for (vector, row, step, column) in (0..TILE * TILE * steps * STEP)
        .map(|i| (i / (TILE * steps * STEP), i / (steps * STEP) % TILE, i / STEP % steps, i % STEP))
    {
        let [high, low] = vectors[vector * steps + step].map(|row| row.0[column]);
        let place = 4 * row + column % 4;
        let [of_high, of_low] = [0, TILE].map(|tile| weights[step][tile + column / 4].0[place]);
        products[0][vector][row] += signed(high) * signed(of_high);
        products[1][vector][row] += i32::from(low) * signed(of_high) + signed(high) * i32::from(of_low);
        products[2][vector][row] += i32::from(low) * i32::from(of_low);
    }
    products
}

#[cfg(not(target_arch = "x86_64"))]
impl Tiles {
    fn configured(_: Amx) -> Self {
        Self { _thread: std::marker::PhantomData }
    }

    fn multiply(&self, vectors: &[[Row; 2]], weights: &[[Row; 2 * TILE]], out: &mut Products) {
        *out = multiplied(vectors, weights);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::draw::Draw;

    /// Words that are often the least, the greatest, 0 or ±1.
    fn extreme(draw: &mut Draw, count: usize) -> Vec<i16> {
        (0..count).map(|_| draw.extreme(16)).collect()
    }

    #[test]
    fn four_sums_of_bytes_are_the_sum_of_words() {
        let draw = &mut Draw::new(1);
        for (rows, columns, count) in [(1, 1, 1), (16, 64, 16), (70, 144, 17), (192, 192, 48), (3, 400, 5)] {
            let weights = Array2::from_shape_vec((rows, columns), extreme(draw, rows * columns)).unwrap();
            let (stride, matrix) = (columns + 3, Tiled::new(&weights));
            let words = extreme(draw, count * stride);
            let mut planes = Planes::default();
            planes.fill(Isa::Portable, Vectors { words: &words, stride, columns }, matrix.steps);
            for (number, vectors) in planes.0.chunks(TILE * matrix.steps).enumerate() {
                for (tile, weights_of) in matrix.tiles.chunks(matrix.steps).enumerate() {
                    let products = multiplied(vectors, weights_of);
                    let (mut high, mut low) = ([0; TILE * TILE], [0; TILE * TILE]);
                    high_parts(Isa::Portable, &products, TILE, TILE, &mut high);
                    low_parts(Isa::Portable, &products, TILE, TILE, &mut low);
                    for (vector, row) in (0..TILE * TILE).map(|i| (i / TILE, i % TILE)) {
                        let (high, low) = (high[vector * TILE + row], low[vector * TILE + row]);
                        let found = (i64::from(high) << LOW_BITS) + i64::from(low);
                        let of = words.chunks(stride).nth(TILE * number + vector);
                        let row = TILE * tile + row;
                        let expected = match of {
                            Some(vector) if row < rows => (0..columns)
                                .map(|at| i64::from(weights[(row, at)]) * i64::from(vector[at]))
                                .sum(),
                            _ => 0,
                        };
                        // Sums of more than 40 bits are not this module's.
                        if expected.unsigned_abs() < 1 << 39 {
                            assert_eq!(found, expected, "{rows} x {columns}, row {row}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn tiles_multiply_as_plain_rust_does() {
        let Some(Isa::Amx(token)) = Isa::available().pop() else {
            eprintln!("SKIPPED: no AMX here");
            return;
        };
        let draw = &mut Draw::new(2);
        for steps in [1, 2, 3, 7] {
            let bytes = |draw: &mut Draw| Row(std::array::from_fn(|_| draw.bits() as u8));
            let vectors: Vec<[Row; 2]> = (0..TILE * steps).map(|_| [bytes(draw), bytes(draw)]).collect();
            let weights: Vec<[Row; 2 * TILE]> =
                (0..steps).map(|_| std::array::from_fn(|_| bytes(draw))).collect();
            let mut found: Products = [[[7; TILE]; TILE]; 3];
            Tiles::configured(token).multiply(&vectors, &weights, &mut found);
            assert_eq!(found, multiplied(&vectors, &weights), "{steps} steps");
        }
    }

    #[test]
    fn words_that_are_not_zero_are_counted() {
        let words: Vec<i16> = (0..1000).map(|i| if i % 3 == 0 { 0 } else { i - 500 }).collect();
        let expected = words.iter().filter(|word| **word != 0).count() as u64;
        assert!(Isa::available().into_iter().all(|isa| nonzeros(isa, &words) == expected));
    }
}
