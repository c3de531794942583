//! Kernels for AVX2 and AVX-512. They add the same products as [`super::portable`], in 32 bits where [`super::pack`] and
//! [`super::active`] prove that the sums fit, so the result is the same to the bit.
//!
//! Both sets run the same code, written once over the names that they give to the same operations.

use super::columns;
use super::isa::{Avx2, Avx512, Avx512Vnni};
use super::operands::{Entries, Inputs, SLACK};
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
fn each_tile(matrix: &Packed, inputs: Inputs<'_>, sums: &mut Sums, mut run: impl FnMut(Tile<'_>)) {
    let (columns, stride) = (2 * matrix.pairs, matrix.rows);
    for (row, panel) in matrix.panels() {
        let tiles = inputs.words.chunks(TILE * columns).zip(inputs.largest.chunks(TILE));
        for (i, (input, largest)) in tiles.enumerate() {
            let block = matrix.block(row / PANEL, largest.iter().copied().fold(0, i16::max));
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
        add $add:ident, and $and:ident, shift_right $shift_right:ident,
        interleave $interleave_low:ident, $interleave_high:ident;
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
            pub fn dense(_: $Token, matrix: &Packed, inputs: Inputs<'_>, sums: &mut Sums) {
                each_tile(matrix, inputs, sums, |tile| {
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

            /// The product of a panel of columns and a vector's active words, into the parts of `PANEL` sums.
            pub fn sparse<'a>(
                _: $Token,
                panel: &[Line],
                segments: impl Iterator<Item = Entries<'a>>,
                high: &mut [i32],
                low: &mut [i32],
            ) {
                // SAFETY: the token proves that these features were detected.
                unsafe { active_columns(panel, segments, high, low) }
            }

            #[target_feature(enable = $features)]
            fn active_columns<'a>(
                panel: &[Line],
                segments: impl Iterator<Item = Entries<'a>>,
                high: &mut [i32],
                low: &mut [i32],
            ) {
                assert!(high.len() >= PANEL && low.len() >= PANEL);
                let mut split = [Split::zero(); WHOLE];
                for Entries { words, columns } in segments {
                    let mut acc = [$zero(); WHOLE];
                    for (words, columns) in words.as_chunks::<2>().0.iter().zip(columns.as_chunks::<2>().0) {
                        let two = $all(i32::from(words[0]) & 0xffff | i32::from(words[1]) << 16);
                        let [first, second] = columns.map(|column| {
                            panel[usize::from(column) * columns::LINES..][..columns::LINES].as_ptr().cast::<i16>()
                        });
                        for (v, acc) in acc.as_chunks_mut::<2>().0.iter_mut().enumerate() {
                            // SAFETY: both columns have `PANEL` words, `2 · LANES` in each of these vectors.
                            let [a, b] = [first, second].map(|column| unsafe { $load(column.add(2 * LANES * v).cast()) });
                            acc[0] = $multiply_add(acc[0], $interleave_low(a, b), two);
                            acc[1] = $multiply_add(acc[1], $interleave_high(a, b), two);
                        }
                    }
                    for (split, acc) in split.iter_mut().zip(acc) {
                        split.add(acc);
                    }
                }
                for (v, split) in split.iter().enumerate() {
                    let row = first_row(v, LANES);
                    // SAFETY: `LANES` rows from here on lie within `PANEL`, which both slices hold.
                    unsafe { split.store(high.as_mut_ptr().add(row), low.as_mut_ptr().add(row)) };
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
    mod vnni, token Avx512Vnni, features "avx512f,avx512bw,avx512dq,avx512vl,avx512vnni", vectors __m512i of 16 sums;
    a dense tile holds 4 of them;
    zero _mm512_setzero_si512, load _mm512_loadu_si512, store _mm512_storeu_si512, all _mm512_set1_epi32,
    multiply_add _mm512_dpwssd_epi32,
    add _mm512_add_epi32, and _mm512_and_si512, shift_right _mm512_srai_epi32,
    interleave _mm512_unpacklo_epi16, _mm512_unpackhi_epi16;
}

kernels! {
    /// With AVX-512 F, BW, DQ and VL.
    mod avx512, token Avx512, features "avx512f,avx512bw,avx512dq,avx512vl", vectors __m512i of 16 sums;
    a dense tile holds 4 of them;
    zero _mm512_setzero_si512, load _mm512_loadu_si512, store _mm512_storeu_si512, all _mm512_set1_epi32,
    multiply_add multiply_add_avx512,
    add _mm512_add_epi32, and _mm512_and_si512, shift_right _mm512_srai_epi32,
    interleave _mm512_unpacklo_epi16, _mm512_unpackhi_epi16;
}

kernels! {
    /// With AVX2.
    mod avx2, token Avx2, features "avx2", vectors __m256i of 8 sums;
    a dense tile holds 2 of them;
    zero _mm256_setzero_si256, load _mm256_loadu_si256, store _mm256_storeu_si256, all _mm256_set1_epi32,
    multiply_add multiply_add_avx2,
    add _mm256_add_epi32, and _mm256_and_si256, shift_right _mm256_srai_epi32,
    interleave _mm256_unpacklo_epi16, _mm256_unpackhi_epi16;
}

/// What `_mm512_dpwssd_epi32` does, of which AVX2 has only the product.
#[target_feature(enable = "avx2")]
#[inline]
fn multiply_add_avx2(sum: __m256i, a: __m256i, b: __m256i) -> __m256i {
    _mm256_add_epi32(sum, _mm256_madd_epi16(a, b))
}

/// What `_mm512_dpwssd_epi32` does, of which AVX-512 without VNNI has only the product.
#[target_feature(enable = "avx512f,avx512bw")]
#[inline]
fn multiply_add_avx512(sum: __m512i, a: __m512i, b: __m512i) -> __m512i {
    _mm512_add_epi32(sum, _mm512_madd_epi16(a, b))
}

/// First row of the v-th vector of interleaved pairs ([`columns::place`]).
const fn first_row(v: usize, lanes: usize) -> usize {
    let a_line = 32 / lanes;
    let (line, v) = (v / a_line, v % a_line);
    32 * line + 16 * (v % 2) + lanes * (v / 2)
}

/// [`super::portable::collect`]; up to [`SLACK`] more entries are written.
pub fn collect_vbmi2(_: Avx512Vnni, vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    // SAFETY: the token proves that these features were detected.
    unsafe { by_words(vector, words, columns) }
}

/// As [`collect_vbmi2`].
pub fn collect_avx512(_: Avx512, vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    // SAFETY: the token proves that these features were detected.
    unsafe { by_sums(vector, words, columns) }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi2")]
fn by_words(vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    assert!(words.len() >= vector.len() + SLACK && columns.len() >= vector.len() + SLACK);
    let first: [u16; 32] = std::array::from_fn(|i| i as u16);
    // SAFETY: 32 words are a vector.
    let mut places: __m512i = unsafe { _mm512_loadu_si512(first.as_ptr().cast()) };
    let (mut count, mut magnitude) = (0, _mm512_setzero_si512());
    for some in vector.chunks(32) {
        let inside = u32::MAX >> (32 - some.len());
        // SAFETY: only the words of the chunk are read.
        let v = unsafe { _mm512_maskz_loadu_epi16(inside, some.as_ptr()) };
        let active = _mm512_test_epi16_mask(v, v);
        // SAFETY: `count` is at most the words before this chunk, and `SLACK` words come after the vector's.
        unsafe {
            _mm512_storeu_si512(words.as_mut_ptr().add(count).cast(), _mm512_maskz_compress_epi16(active, v));
            _mm512_storeu_si512(
                columns.as_mut_ptr().add(count).cast(),
                _mm512_maskz_compress_epi16(active, places),
            );
        }
        count += active.count_ones() as usize;
        magnitude = _mm512_add_epi32(magnitude, magnitudes(v));
        places = _mm512_add_epi16(places, _mm512_set1_epi16(32));
    }
    (count, total(magnitude))
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn by_sums(vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    assert!(words.len() >= vector.len() + SLACK && columns.len() >= vector.len() + SLACK);
    let mut places = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let (mut count, mut magnitude) = (0, _mm512_setzero_si512());
    for some in vector.chunks(16) {
        let inside = u16::MAX >> (16 - some.len());
        // SAFETY: only the words of the chunk are read.
        let v = unsafe { _mm256_maskz_loadu_epi16(inside, some.as_ptr()) };
        let wide = _mm512_cvtepi16_epi32(v);
        let active = _mm512_test_epi32_mask(wide, wide);
        let narrow = |v| _mm512_cvtepi32_epi16(_mm512_maskz_compress_epi32(active, v));
        // SAFETY: `count` is at most the words before this chunk, and `SLACK` words come after the vector's.
        unsafe {
            _mm256_storeu_si256(words.as_mut_ptr().add(count).cast(), narrow(wide));
            _mm256_storeu_si256(columns.as_mut_ptr().add(count).cast(), narrow(places));
        }
        count += active.count_ones() as usize;
        magnitude = _mm512_add_epi32(magnitude, _mm512_abs_epi32(wide));
        places = _mm512_add_epi32(places, _mm512_set1_epi32(16));
    }
    (count, total(magnitude))
}

/// |word|, those of neighbours added.
#[target_feature(enable = "avx512f,avx512bw")]
#[inline]
fn magnitudes(v: __m512i) -> __m512i {
    let sizes = _mm512_abs_epi16(v);
    _mm512_add_epi32(_mm512_and_si512(sizes, _mm512_set1_epi32(0xffff)), _mm512_srli_epi32::<16>(sizes))
}

/// Σ of numbers without a sign, of at most 2^32 each.
#[target_feature(enable = "avx512f")]
#[inline]
fn total(sums: __m512i) -> u64 {
    let mut each = [0u32; 16];
    // SAFETY: 16 numbers of 32 bits are a vector.
    unsafe { _mm512_storeu_si512(each.as_mut_ptr().cast(), sums) };
    each.into_iter().map(u64::from).sum()
}
