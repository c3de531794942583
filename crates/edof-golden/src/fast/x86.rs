//! Kernels for AVX2 and AVX-512. They add the same products as [`super::portable`], in 32 bits where [`super::pack`] and
//! [`super::pairs`] prove that the sums fit, so the result is the same to the bit.
//!
//! Both sets run the same code, written once over the names that they give to the same operations.

use super::isa::{Avx2, Avx512};
use super::pack::{Dense, GROUP, Sparse};
use super::pairs::Pairs;
use std::arch::x86_64::*;

/// Patches that share a load of weights.
const TILE: usize = 6;

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

/// Defines `dense` and `sparse` for one instruction set.
macro_rules! kernels {
    (
        $(#[$doc:meta])*
        mod $isa:ident, token $Token:ident, features $features:literal, vectors $vector:ident of $lanes:literal sums;
        a dense tile holds $dense:literal of them, a sparse one up to $sparse:literal pairs;
        zero $zero:ident, load $load:ident, store $store:ident, all $all:ident, multiply_add $multiply_add:path,
        interleave $interleave_low:ident $interleave_high:ident,
        halves $low:ident $high:path, widen $widen:ident, add_wide $add_wide:ident;
    ) => {
        $(#[$doc])*
        pub mod $isa {
            use super::*;

            /// 32-bit sums in a vector.
            const LANES: usize = $lanes;
            /// Vectors of sums that a patch of a dense tile keeps in registers.
            const DENSE: usize = $dense;

            /// Dense products. Inputs are 0…32767. Panics if slices do not hold whole vectors.
            pub fn dense(_: $Token, matrix: &Dense, input: &[i16], sums: &mut [i64]) {
                each_tile(matrix, input, sums, |tile| {
                    // SAFETY: the token proves that these features were detected.
                    unsafe {
                        match tile.input.len() / matrix.columns {
                            TILE => patches::<TILE>(tile),
                            _ => tile.singles().for_each(|one| patches::<1>(one)),
                        }
                    }
                });
            }

            /// `P` patches × 64 rows, as many at a time as the registers hold.
            #[target_feature(enable = $features)]
            fn patches<const P: usize>(tile: Tile<'_>) {
                let Tile { matrix, row, block, input, sums } = tile;
                let (columns, stride) = (matrix.columns, matrix.stride);
                let pairs = columns / 2;
                assert!(input.len() == P * columns && sums.len() >= P * stride && row + GROUP <= stride);
                assert!(matrix.weights.len() == columns * stride && block > 0);
                let (weights, y, out) = (matrix.weights.as_ptr(), input.as_ptr(), sums.as_mut_ptr());
                for row in (row..row + GROUP).step_by(DENSE * LANES) {
                    for start in (0..pairs).step_by(block) {
                        let mut acc = [[$zero(); DENSE]; P];
                        for pair in start..pairs.min(start + block) {
                            // SAFETY: pair < columns/2 and row + DENSE·LANES ≤ stride, so all vectors lie inside the
                            // columns·stride weights.
                            let w: [$vector; DENSE] = std::array::from_fn(|v| unsafe {
                                $load(weights.add((pair * stride + row + LANES * v) * 2).cast())
                            });
                            for (p, acc) in acc.iter_mut().enumerate() {
                                // SAFETY: the two words lie inside patch p's `columns` inputs.
                                let two = unsafe { y.add(p * columns + 2 * pair).cast::<i32>().read_unaligned() };
                                let two = $all(two);
                                for (acc, w) in acc.iter_mut().zip(w) {
                                    *acc = $multiply_add(*acc, w, two);
                                }
                            }
                        }
                        for (p, acc) in acc.iter().enumerate() {
                            for (v, acc) in acc.iter().enumerate() {
                                // SAFETY: these rows of patch p lie inside its `stride` accumulators.
                                unsafe { widen(*acc, out.add(p * stride + row + LANES * v), start == 0) };
                            }
                        }
                    }
                }
            }

            /// The product of a sparse vector.
            pub fn sparse(_: $Token, matrix: &Sparse, pairs: &Pairs, sums: &mut [i64]) {
                let mut row = 0;
                while row < matrix.stride {
                    // SAFETY: the token proves that these features were detected.
                    row += unsafe {
                        match ((matrix.stride - row) / (2 * LANES)).min($sparse) {
                            6.. => rows::<6>(matrix, row, pairs, sums),
                            4.. => rows::<4>(matrix, row, pairs, sums),
                            _ => rows::<2>(matrix, row, pairs, sums),
                        }
                    };
                }
            }

            /// `V` vectors of weights, which have two rows a sum, from `row` on; gives how many rows these are.
            #[target_feature(enable = $features)]
            fn rows<const V: usize>(matrix: &Sparse, row: usize, pairs: &Pairs, sums: &mut [i64]) -> usize {
                let (stride, weights) = (matrix.stride, matrix.weights.as_ptr());
                let columns = matrix.bounds.len();
                assert!(row + 2 * LANES * V <= stride && sums.len() >= stride);
                assert!(matrix.weights.len() == columns * stride);
                let out = sums.as_mut_ptr();
                for (segment, pairs) in pairs.segments().enumerate() {
                    let mut acc = [[$zero(); 2]; V];
                    for pair in pairs {
                        let (first, second) = (pair.first as usize, pair.second as usize);
                        assert!(first < columns && second < columns);
                        let two = $all(pair.words);
                        for (v, [low, high]) in acc.iter_mut().enumerate() {
                            let row = row + 2 * LANES * v;
                            // SAFETY: both columns exist and 2·LANES rows from this one on lie inside their `stride` words.
                            let (a, b) = unsafe {
                                let at = |column: usize| $load(weights.add(column * stride + row).cast());
                                (at(first), at(second))
                            };
                            *low = $multiply_add(*low, $interleave_low(a, b), two);
                            *high = $multiply_add(*high, $interleave_high(a, b), two);
                        }
                    }
                    for (v, acc) in acc.iter().enumerate() {
                        for (half, acc) in acc.iter().enumerate() {
                            // SAFETY: these rows lie inside the `stride` accumulators.
                            unsafe { widen(*acc, out.add(row + LANES * (2 * v + half)), segment == 0) };
                        }
                    }
                }
                2 * LANES * V
            }

            /// Stores or adds a vector of sums as 64-bit numbers.
            ///
            /// # Safety
            /// `out` must be valid for `LANES` reads and writes.
            #[target_feature(enable = $features)]
            #[inline]
            unsafe fn widen(sums: $vector, out: *mut i64, store: bool) {
                for (i, wide) in [$widen($low(sums)), $widen($high(sums))].into_iter().enumerate() {
                    // SAFETY: half of the numbers each, which the caller vouches for.
                    unsafe {
                        let at = out.add(LANES / 2 * i).cast::<$vector>();
                        let before = if store { $zero() } else { $load(at) };
                        $store(at, $add_wide(before, wide));
                    }
                }
            }
        }
    };
}

kernels! {
    /// With AVX-512 F, BW, DQ, VL and VNNI.
    mod avx512, token Avx512, features "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni", vectors __m512i of 16 sums;
    a dense tile holds 4 of them, a sparse one up to 6 pairs;
    zero _mm512_setzero_si512, load _mm512_loadu_si512, store _mm512_storeu_si512, all _mm512_set1_epi32,
    multiply_add _mm512_dpwssd_epi32,
    interleave _mm512_unpacklo_epi16 _mm512_unpackhi_epi16,
    halves _mm512_castsi512_si256 _mm512_extracti64x4_epi64::<1>, widen _mm512_cvtepi32_epi64,
    add_wide _mm512_add_epi64;
}

kernels! {
    /// With AVX2.
    mod avx2, token Avx2, features "avx2", vectors __m256i of 8 sums;
    a dense tile holds 2 of them, a sparse one up to 4 pairs;
    zero _mm256_setzero_si256, load _mm256_loadu_si256, store _mm256_storeu_si256, all _mm256_set1_epi32,
    multiply_add multiply_add_avx2,
    interleave _mm256_unpacklo_epi16 _mm256_unpackhi_epi16,
    halves _mm256_castsi256_si128 _mm256_extracti128_si256::<1>, widen _mm256_cvtepi32_epi64,
    add_wide _mm256_add_epi64;
}

/// What `_mm512_dpwssd_epi32` does, of which AVX2 has only the product.
#[target_feature(enable = "avx2")]
#[inline]
fn multiply_add_avx2(sum: __m256i, a: __m256i, b: __m256i) -> __m256i {
    _mm256_add_epi32(sum, _mm256_madd_epi16(a, b))
}
