//! Kernels for AVX2 and AVX-512. They add the same products as [`super::portable`], in 32 bits where [`super::pack`] and
//! [`super::active`] prove that the sums fit, so the result is the same to the bit.
//!
//! Both sets run the same code, written once over the names that they give to the same operations.

use super::isa::{Avx2, Avx512};
use super::pack::{LINES, Line, PANEL, Packed};
use super::sums::{LOW, LOW_BITS, Sums};
use std::arch::x86_64::*;

/// Vectors of inputs that share a load of weights.
const TILE: usize = 6;

/// A panel times a few vectors of inputs.
struct Tile<'a> {
    panel: &'a [Line],
    /// Pairs of columns that may be summed in 32 bits.
    block: usize,
    /// Words of a vector.
    columns: usize,
    /// The vectors, one after the other.
    input: &'a [i16],
    /// From one vector's sums to the next one's.
    stride: usize,
    high: &'a mut [i32],
    low: &'a mut [i32],
}

/// Cuts a dense product into tiles. Panics if `sums` are too few.
fn each_tile(matrix: &Packed, input: &[i16], sums: &mut Sums, mut run: impl FnMut(Tile<'_>)) {
    let largest = input.iter().copied().fold(0, i16::max);
    let (columns, stride) = (2 * matrix.pairs, matrix.rows);
    for (row, panel) in matrix.panels() {
        let block = matrix.block(row / PANEL, largest);
        for (i, input) in input.chunks(TILE * columns).enumerate() {
            let from = i * TILE * stride + row;
            let (high, low) = (&mut sums.high[from..], &mut sums.low[from..]);
            run(Tile { panel, block, columns, input, stride, high, low });
        }
    }
}

/// Defines `dense` and `sparse` for one instruction set.
macro_rules! kernels {
    (
        $(#[$doc:meta])*
        mod $isa:ident, token $Token:ident, features $features:literal, vectors $vector:ident of $lanes:literal sums;
        a dense tile holds $dense:literal of them;
        zero $zero:ident, load $load:ident, store $store:ident, all $all:ident, multiply_add $multiply_add:path,
        add $add:ident, and $and:ident, shift_right $shift_right:ident;
    ) => {
        $(#[$doc])*
        pub mod $isa {
            use super::*;

            /// 32-bit sums in a vector.
            const LANES: usize = $lanes;
            /// Vectors of sums that each input of a dense tile keeps in registers.
            const DENSE: usize = $dense;
            /// Vectors of sums in a panel.
            const WHOLE: usize = PANEL / LANES;

            /// Dense products; inputs are 0…32767. Panics if slices do not hold whole vectors.
            pub fn dense(_: $Token, matrix: &Packed, input: &[i16], sums: &mut Sums) {
                each_tile(matrix, input, sums, |tile| {
                    // SAFETY: the token proves that these features were detected.
                    unsafe {
                        match tile.input.len() / tile.columns {
                            1 => tile_of::<1>(tile),
                            2 => tile_of::<2>(tile),
                            3 => tile_of::<3>(tile),
                            4 => tile_of::<4>(tile),
                            5 => tile_of::<5>(tile),
                            _ => tile_of::<TILE>(tile),
                        }
                    }
                });
            }

            /// `P` inputs × a panel, as many rows at a time as the registers hold.
            #[target_feature(enable = $features)]
            fn tile_of<const P: usize>(tile: Tile<'_>) {
                let Tile { panel, block, columns, input, stride, high, low } = tile;
                let pairs = columns / 2;
                assert!(input.len() == P * columns && panel.len() == pairs * LINES && block > 0);
                assert!(high.len() >= (P - 1) * stride + PANEL && low.len() >= (P - 1) * stride + PANEL);
                let (weights, y) = (panel.as_ptr().cast::<i32>(), input.as_ptr());
                for row in (0..PANEL).step_by(DENSE * LANES) {
                    let mut split = [[Split::zero(); DENSE]; P];
                    for start in (0..pairs).step_by(block) {
                        let mut acc = [[$zero(); DENSE]; P];
                        for pair in start..pairs.min(start + block) {
                            // SAFETY: pair < pairs and row + DENSE·LANES ≤ PANEL, so all vectors lie inside the panel.
                            let w: [$vector; DENSE] = std::array::from_fn(|v| unsafe {
                                $load(weights.add(pair * PANEL + row + LANES * v).cast())
                            });
                            for (p, acc) in acc.iter_mut().enumerate() {
                                // SAFETY: the two words lie inside vector p's `columns` words.
                                let two = unsafe { y.add(p * columns + 2 * pair).cast::<i32>().read_unaligned() };
                                let two = $all(two);
                                for (acc, w) in acc.iter_mut().zip(w) {
                                    *acc = $multiply_add(*acc, w, two);
                                }
                            }
                        }
                        // Nested loops are unrolled, and only then do the sums above stay in registers.
                        for (split, acc) in split.iter_mut().zip(acc) {
                            for (split, acc) in split.iter_mut().zip(acc) {
                                split.add(acc);
                            }
                        }
                    }
                    for (p, split) in split.iter().enumerate() {
                        for (v, split) in split.iter().enumerate() {
                            let at = p * stride + row + LANES * v;
                            // SAFETY: `LANES` sums from here on lie inside both slices.
                            unsafe { split.store(high.as_mut_ptr().add(at), low.as_mut_ptr().add(at)) };
                        }
                    }
                }
            }

            /// The product of a panel and the active pairs of a vector, into the parts of `PANEL` sums.
            pub fn sparse<'a>(
                _: $Token,
                panel: &[Line],
                vector: &[i16],
                segments: impl Iterator<Item = &'a [u16]>,
                high: &mut [i32],
                low: &mut [i32],
            ) {
                // SAFETY: the token proves that these features were detected.
                unsafe { active_pairs(panel, vector, segments, high, low) }
            }

            #[target_feature(enable = $features)]
            fn active_pairs<'a>(
                panel: &[Line],
                vector: &[i16],
                segments: impl Iterator<Item = &'a [u16]>,
                high: &mut [i32],
                low: &mut [i32],
            ) {
                let pairs = (vector.len() / 2).min(panel.len() / LINES);
                assert!(high.len() >= PANEL && low.len() >= PANEL);
                let (weights, words) = (panel.as_ptr().cast::<i32>(), vector.as_ptr());
                let mut split = [Split::zero(); WHOLE];
                for segment in segments {
                    let mut acc = [$zero(); WHOLE];
                    for &pair in segment {
                        let pair = usize::from(pair);
                        assert!(pair < pairs);
                        // SAFETY: the vector has both words of this pair.
                        let two = $all(unsafe { words.add(2 * pair).cast::<i32>().read_unaligned() });
                        for (v, acc) in acc.iter_mut().enumerate() {
                            // SAFETY: the panel has all lines of this pair, `PANEL` rows in `WHOLE` vectors.
                            let w = unsafe { $load(weights.add(pair * PANEL + LANES * v).cast()) };
                            *acc = $multiply_add(*acc, w, two);
                        }
                    }
                    for (split, acc) in split.iter_mut().zip(acc) {
                        split.add(acc);
                    }
                }
                for (v, split) in split.iter().enumerate() {
                    // SAFETY: `WHOLE` vectors of `LANES` sums are `PANEL`, which both slices hold.
                    unsafe { split.store(high.as_mut_ptr().add(LANES * v), low.as_mut_ptr().add(LANES * v)) };
                }
            }

            /// A vector of sums in two parts; the low ones not yet carried.
            #[derive(Clone, Copy)]
            struct Split {
                high: $vector,
                low: $vector,
            }

            impl Split {
                #[target_feature(enable = $features)]
                #[inline]
                fn zero() -> Self {
                    Self { high: $zero(), low: $zero() }
                }

                /// Adds sums of 32 bits.
                #[target_feature(enable = $features)]
                #[inline]
                fn add(&mut self, sums: $vector) {
                    self.high = $add(self.high, $shift_right::<{ LOW_BITS as _ }>(sums));
                    self.low = $add(self.low, $and(sums, $all(LOW)));
                }

                /// Carries and writes both parts.
                ///
                /// # Safety
                /// `high` and `low` must be valid for `LANES` writes.
                #[target_feature(enable = $features)]
                #[inline]
                unsafe fn store(&self, high: *mut i32, low: *mut i32) {
                    let carried = $add(self.high, $shift_right::<{ LOW_BITS as _ }>(self.low));
                    // SAFETY: the caller vouches for both.
                    unsafe {
                        $store(high.cast(), carried);
                        $store(low.cast(), $and(self.low, $all(LOW)));
                    }
                }
            }
        }
    };
}

kernels! {
    /// With AVX-512 F, BW, DQ, VL and VNNI.
    mod avx512, token Avx512, features "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni", vectors __m512i of 16 sums;
    a dense tile holds 4 of them;
    zero _mm512_setzero_si512, load _mm512_loadu_si512, store _mm512_storeu_si512, all _mm512_set1_epi32,
    multiply_add _mm512_dpwssd_epi32,
    add _mm512_add_epi32, and _mm512_and_si512, shift_right _mm512_srai_epi32;
}

kernels! {
    /// With AVX2.
    mod avx2, token Avx2, features "avx2", vectors __m256i of 8 sums;
    a dense tile holds 2 of them;
    zero _mm256_setzero_si256, load _mm256_loadu_si256, store _mm256_storeu_si256, all _mm256_set1_epi32,
    multiply_add multiply_add_avx2,
    add _mm256_add_epi32, and _mm256_and_si256, shift_right _mm256_srai_epi32;
}

/// What `_mm512_dpwssd_epi32` does, of which AVX2 has only the product.
#[target_feature(enable = "avx2")]
#[inline]
fn multiply_add_avx2(sum: __m256i, a: __m256i, b: __m256i) -> __m256i {
    _mm256_add_epi32(sum, _mm256_madd_epi16(a, b))
}
