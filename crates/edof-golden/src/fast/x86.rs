//! Kernels for AVX2 and AVX-512. They add the same products as [`super::portable`], in 32 bits where [`super::pack`] and
//! [`super::pairs`] prove that the sums fit, so the result is the same to the bit.

use super::pack::{Dense, GROUP, Sparse};
use super::pairs::Pairs;
use std::arch::x86_64::*;

/// Patches that share a load of weights.
const TILE: usize = 6;

/// Dense products with AVX-512. Inputs are 0…32767. Panics if slices do not hold whole vectors.
pub fn dense_avx512(matrix: &Dense, input: &[i16], sums: &mut [i64]) {
    each_tile(matrix, input, sums, |tile| {
        // SAFETY: the caller runs this only where AVX-512 F, BW, DQ, VL and VNNI were detected.
        unsafe {
            match tile.input.len() / matrix.columns {
                TILE => tile_avx512::<TILE>(tile),
                _ => {
                    for one in tile.singles() {
                        tile_avx512::<1>(one);
                    }
                }
            }
        }
    });
}

/// Dense products with AVX2.
pub fn dense_avx2(matrix: &Dense, input: &[i16], sums: &mut [i64]) {
    each_tile(matrix, input, sums, |tile| {
        // SAFETY: the caller runs this only where AVX2 was detected.
        unsafe {
            match tile.input.len() / matrix.columns {
                TILE => tile_avx2::<TILE>(tile),
                _ => {
                    for one in tile.singles() {
                        tile_avx2::<1>(one);
                    }
                }
            }
        }
    });
}

/// One group of rows times a few patches.
struct Tile<'a> {
    matrix: &'a Dense,
    /// First row of the group.
    row: usize,
    /// Pairs of columns that may be summed in 32 bits.
    block: usize,
    /// The patches' inputs, one after the other.
    input: &'a [i16],
    /// The patches' accumulators, `matrix.stride` each.
    sums: &'a mut [i64],
}

impl<'a> Tile<'a> {
    /// The same, patch by patch.
    fn singles(self) -> impl Iterator<Item = Tile<'a>> {
        let Tile { matrix, row, block, input, sums } = self;
        let patches = input.chunks_exact(matrix.columns).zip(sums.chunks_exact_mut(matrix.stride));
        patches.map(move |(input, sums)| Tile { matrix, row, block, input, sums })
    }
}

/// Cuts a dense product into tiles.
fn each_tile(matrix: &Dense, input: &[i16], sums: &mut [i64], mut run: impl FnMut(Tile<'_>)) {
    let largest = input.iter().copied().max().unwrap_or(0);
    for group in 0..matrix.stride / GROUP {
        let block = matrix.block(group, largest);
        let tiles = input.chunks(TILE * matrix.columns).zip(sums.chunks_mut(TILE * matrix.stride));
        for (input, sums) in tiles {
            run(Tile { matrix, row: group * GROUP, block, input, sums });
        }
    }
}

/// `P` patches × 64 rows.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni")]
fn tile_avx512<const P: usize>(tile: Tile<'_>) {
    let Tile { matrix, row, block, input, sums } = tile;
    let (columns, stride) = (matrix.columns, matrix.stride);
    let pairs = columns / 2;
    assert!(input.len() == P * columns && sums.len() >= P * stride && row + GROUP <= stride);
    assert!(matrix.weights.len() == columns * stride && block > 0);
    let (weights, y, out) = (matrix.weights.as_ptr(), input.as_ptr(), sums.as_mut_ptr());
    for start in (0..pairs).step_by(block) {
        let mut acc = [[_mm512_setzero_si512(); 4]; P];
        for pair in start..pairs.min(start + block) {
            // SAFETY: pair < columns/2 and row + 64 ≤ stride, so the four vectors lie inside the columns·stride weights.
            let w: [__m512i; 4] = std::array::from_fn(|v| unsafe {
                _mm512_loadu_si512(weights.add((pair * stride + row + 16 * v) * 2).cast())
            });
            for (p, acc) in acc.iter_mut().enumerate() {
                // SAFETY: the two words lie inside patch p's `columns` inputs.
                let two = unsafe { y.add(p * columns + 2 * pair).cast::<i32>().read_unaligned() };
                let two = _mm512_set1_epi32(two);
                for (acc, w) in acc.iter_mut().zip(w) {
                    *acc = _mm512_dpwssd_epi32(*acc, w, two);
                }
            }
        }
        for (p, acc) in acc.iter().enumerate() {
            for (v, acc) in acc.iter().enumerate() {
                // SAFETY: rows row…row+63 of patch p lie inside its `stride` accumulators.
                unsafe { widen_avx512(*acc, out.add(p * stride + row + 16 * v), start == 0) };
            }
        }
    }
}

/// Stores or adds 16 sums as 64-bit numbers.
///
/// # Safety
/// `out` must be valid for 16 reads and writes.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni")]
#[inline]
unsafe fn widen_avx512(sums: __m512i, out: *mut i64, store: bool) {
    let low = _mm512_cvtepi32_epi64(_mm512_castsi512_si256(sums));
    let high = _mm512_cvtepi32_epi64(_mm512_extracti64x4_epi64::<1>(sums));
    for (i, wide) in [low, high].into_iter().enumerate() {
        // SAFETY: 8 numbers from out + 8·i, i < 2, which the caller vouches for.
        unsafe {
            let at = out.add(8 * i).cast::<__m512i>();
            let before = if store { _mm512_setzero_si512() } else { _mm512_loadu_si512(at) };
            _mm512_storeu_si512(at, _mm512_add_epi64(before, wide));
        }
    }
}

/// `P` patches × 64 rows, 16 rows at a time.
#[target_feature(enable = "avx2")]
fn tile_avx2<const P: usize>(tile: Tile<'_>) {
    let Tile { matrix, row, block, input, sums } = tile;
    let (columns, stride) = (matrix.columns, matrix.stride);
    let pairs = columns / 2;
    assert!(input.len() == P * columns && sums.len() >= P * stride && row + GROUP <= stride);
    assert!(matrix.weights.len() == columns * stride && block > 0);
    let (weights, y, out) = (matrix.weights.as_ptr(), input.as_ptr(), sums.as_mut_ptr());
    for row in (row..row + GROUP).step_by(16) {
        for start in (0..pairs).step_by(block) {
            let mut acc = [[_mm256_setzero_si256(); 2]; P];
            for pair in start..pairs.min(start + block) {
                // SAFETY: pair < columns/2 and row + 16 ≤ stride, so both vectors lie inside the columns·stride weights.
                let w: [__m256i; 2] = std::array::from_fn(|v| unsafe {
                    _mm256_loadu_si256(weights.add((pair * stride + row + 8 * v) * 2).cast())
                });
                for (p, acc) in acc.iter_mut().enumerate() {
                    // SAFETY: the two words lie inside patch p's `columns` inputs.
                    let two = unsafe { y.add(p * columns + 2 * pair).cast::<i32>().read_unaligned() };
                    let two = _mm256_set1_epi32(two);
                    for (acc, w) in acc.iter_mut().zip(w) {
                        *acc = _mm256_add_epi32(*acc, _mm256_madd_epi16(w, two));
                    }
                }
            }
            for (p, acc) in acc.iter().enumerate() {
                for (v, acc) in acc.iter().enumerate() {
                    // SAFETY: rows row…row+15 of patch p lie inside its `stride` accumulators.
                    unsafe { widen_avx2(*acc, out.add(p * stride + row + 8 * v), start == 0) };
                }
            }
        }
    }
}

/// Stores or adds 8 sums as 64-bit numbers.
///
/// # Safety
/// `out` must be valid for 8 reads and writes.
#[target_feature(enable = "avx2")]
#[inline]
unsafe fn widen_avx2(sums: __m256i, out: *mut i64, store: bool) {
    let low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(sums));
    let high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(sums));
    for (i, wide) in [low, high].into_iter().enumerate() {
        // SAFETY: 4 numbers from out + 4·i, i < 2, which the caller vouches for.
        unsafe {
            let at = out.add(4 * i).cast::<__m256i>();
            let before = if store { _mm256_setzero_si256() } else { _mm256_loadu_si256(at) };
            _mm256_storeu_si256(at, _mm256_add_epi64(before, wide));
        }
    }
}

/// The product of a sparse vector with AVX-512.
pub fn sparse_avx512(matrix: &Sparse, pairs: &Pairs, sums: &mut [i64]) {
    let mut row = 0;
    while row < matrix.stride {
        // SAFETY: the caller runs this only where AVX-512 F, BW, DQ, VL and VNNI were detected.
        row += unsafe {
            match matrix.stride - row {
                192.. => rows_avx512::<6>(matrix, row, pairs, sums),
                128.. => rows_avx512::<4>(matrix, row, pairs, sums),
                _ => rows_avx512::<2>(matrix, row, pairs, sums),
            }
        };
    }
}

/// `V` vectors of 32 rows from `row` on; gives how many rows these are.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni")]
fn rows_avx512<const V: usize>(matrix: &Sparse, row: usize, pairs: &Pairs, sums: &mut [i64]) -> usize {
    let (stride, weights) = (matrix.stride, matrix.weights.as_ptr());
    let columns = matrix.bounds.len();
    assert!(row + 32 * V <= stride && sums.len() >= stride && matrix.weights.len() == columns * stride);
    let out = sums.as_mut_ptr();
    for (segment, pairs) in pairs.segments().enumerate() {
        let mut acc = [[_mm512_setzero_si512(); 2]; V];
        for pair in pairs {
            let (first, second) = (pair.first as usize, pair.second as usize);
            assert!(first < columns && second < columns);
            let two = _mm512_set1_epi32(pair.words);
            for (v, [low, high]) in acc.iter_mut().enumerate() {
                // SAFETY: both columns exist and rows row + 32·v…+31 lie inside their `stride` words.
                let (a, b) = unsafe {
                    (
                        _mm512_loadu_si512(weights.add(first * stride + row + 32 * v).cast()),
                        _mm512_loadu_si512(weights.add(second * stride + row + 32 * v).cast()),
                    )
                };
                *low = _mm512_dpwssd_epi32(*low, _mm512_unpacklo_epi16(a, b), two);
                *high = _mm512_dpwssd_epi32(*high, _mm512_unpackhi_epi16(a, b), two);
            }
        }
        for (v, acc) in acc.iter().enumerate() {
            for (half, acc) in acc.iter().enumerate() {
                // SAFETY: rows row + 32·v + 16·half…+15 lie inside the `stride` accumulators.
                unsafe { widen_avx512(*acc, out.add(row + 32 * v + 16 * half), segment == 0) };
            }
        }
    }
    32 * V
}

/// The product of a sparse vector with AVX2.
pub fn sparse_avx2(matrix: &Sparse, pairs: &Pairs, sums: &mut [i64]) {
    for row in (0..matrix.stride).step_by(GROUP) {
        // SAFETY: the caller runs this only where AVX2 was detected.
        unsafe { rows_avx2(matrix, row, pairs, sums) };
    }
}

/// 64 rows from `row` on.
#[target_feature(enable = "avx2")]
fn rows_avx2(matrix: &Sparse, row: usize, pairs: &Pairs, sums: &mut [i64]) {
    let (stride, weights) = (matrix.stride, matrix.weights.as_ptr());
    let columns = matrix.bounds.len();
    assert!(row + GROUP <= stride && sums.len() >= stride && matrix.weights.len() == columns * stride);
    let out = sums.as_mut_ptr();
    for (segment, pairs) in pairs.segments().enumerate() {
        let mut acc = [[_mm256_setzero_si256(); 2]; 4];
        for pair in pairs {
            let (first, second) = (pair.first as usize, pair.second as usize);
            assert!(first < columns && second < columns);
            let two = _mm256_set1_epi32(pair.words);
            for (v, [low, high]) in acc.iter_mut().enumerate() {
                // SAFETY: both columns exist and rows row + 16·v…+15 lie inside their `stride` words.
                let (a, b) = unsafe {
                    (
                        _mm256_loadu_si256(weights.add(first * stride + row + 16 * v).cast()),
                        _mm256_loadu_si256(weights.add(second * stride + row + 16 * v).cast()),
                    )
                };
                *low = _mm256_add_epi32(*low, _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), two));
                *high = _mm256_add_epi32(*high, _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), two));
            }
        }
        for (v, acc) in acc.iter().enumerate() {
            for (half, acc) in acc.iter().enumerate() {
                // SAFETY: rows row + 16·v + 8·half…+7 lie inside the `stride` accumulators.
                unsafe { widen_avx2(*acc, out.add(row + 16 * v + 8 * half), segment == 0) };
            }
        }
    }
}
