//! Fourier transforms of even sequences (DCT-I), in which mirrored borders and lenses of round pupils are at home.
//!
//! A plane mirrored about its edge pixels without repeating them (… c b | a b c …) is periodic with period 2(n − 1) and even, so
//! its Fourier transform is real and n numbers a side say everything. Blurring it with an even kernel of any size, however far
//! beyond the picture it reaches, is one multiplication there. A round pupil, its field and its PSF are even as well. A kernel
//! that is not even is the sum of an even and an odd one; what the odd one makes of a mirrored plane is odd, a sum of sines (DST-I).

use edof_numerics::fft::{Complex, Fft, Real};
use ndarray::{Array2, ArrayView2, ShapeBuilder};
use std::sync::Arc;

/// Rows transformed at a time: with 16 `f32` a written cache line is filled at once.
const BLOCK: usize = 16;

/// What a sequence is about its middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// x\[−i\] = x\[i\]: a sum of cosines.
    Even,
    /// x\[−i\] = −x\[i\]: a sum of sines; zero at both of its ends.
    Odd,
}

impl Parity {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Even, Self::Odd];

    /// The sign of the mirror image.
    #[must_use]
    pub fn sign<T: Real>(self) -> T {
        match self {
            Self::Even => T::one(),
            Self::Odd => -T::one(),
        }
    }
}

/// Length of the period of `n` samples mirrored about both ends.
#[must_use]
pub fn period(n: usize) -> usize {
    (2 * n).saturating_sub(2).max(1)
}

/// Index 0…n−1 of the sample that stands at `index` of the mirrored, periodic sequence; `mirror` of `edof_core::geometry` without its limit.
#[must_use]
pub fn mirror_index(index: isize, n: usize) -> usize {
    let period = period(n);
    let folded = index.rem_euclid(period as isize) as usize;
    folded.min(period - folded)
}

/// The Fourier transform of even sequences of `n` samples each side of zero: X\[j\] = Σ over a period of x\[i\]·cos(2π i j / period).
/// Applying it twice multiplies by the period. Of odd sequences it takes the sines in place of the cosines.
pub struct EvenTransform<T: Real> {
    n: usize,
    fft: Arc<dyn Fft<T>>,
}

impl<T: Real> EvenTransform<T> {
    /// A plan for sequences whose samples 0…n−1 are given.
    #[must_use]
    pub fn new(n: usize) -> Self {
        assert!(n > 0, "an even transform needs a sample");
        Self { n, fft: T::forward(period(n)) }
    }

    /// Samples 0…n−1.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.n
    }

    /// Never: a plan has a sample at least.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Transforms every row (shorter ones are continued with zeros) and returns the first `keep` coefficients of each as a
    /// column: `keep` × rows. Two such steps are the transform in two dimensions.
    #[must_use]
    pub fn rows_transposed(&self, plane: ArrayView2<T>, keep: usize) -> Array2<T> {
        self.rows_transposed_as(plane, keep, Parity::Even)
    }

    /// The same for rows of either parity.
    #[must_use]
    pub fn rows_transposed_as(&self, plane: ArrayView2<T>, keep: usize, parity: Parity) -> Array2<T> {
        let (rows, columns) = plane.dim();
        let period = self.fft.len();
        assert!(columns <= self.n && keep <= self.n, "rows of at most {} samples", self.n);
        let zero = Complex::new(T::zero(), T::zero());
        let mut buffer = vec![zero; BLOCK / 2 * period];
        let mut scratch = vec![zero; self.fft.get_inplace_scratch_len()];
        let mut out = Array2::from_elem((keep, rows), T::zero());
        let written = out.as_slice_mut().unwrap_or_default();
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            let pairs = count.div_ceil(2);
            // Two real rows ride in one complex row: the transform of an even real row is real, so they come out apart.
            for (pair, row) in buffer.chunks_exact_mut(period).take(pairs).enumerate() {
                let even = plane.row(first + 2 * pair);
                if 2 * pair + 1 < count {
                    let odd = plane.row(first + 2 * pair + 1);
                    row.iter_mut()
                        .zip(even.iter().zip(odd))
                        .for_each(|(c, (&a, &b))| *c = Complex::new(a, b));
                } else {
                    row.iter_mut().zip(even).for_each(|(c, &a)| *c = Complex::new(a, T::zero()));
                }
                row[columns..].fill(zero);
                if parity == Parity::Odd {
                    (row[0], row[self.n - 1]) = (zero, zero);
                }
                for i in self.n..period {
                    row[i] = row[period - i] * parity.sign::<T>();
                }
            }
            self.fft.process_with_scratch(&mut buffer[..pairs * period], &mut scratch);
            for j in 0..keep {
                let line = &mut written[j * rows + first..][..count];
                for (pair, two) in line.chunks_mut(2).enumerate() {
                    let value = buffer[pair * period + j];
                    // Of odd rows a and b it is b − i·a.
                    let (first, other) = match parity {
                        Parity::Even => (value.re, value.im),
                        Parity::Odd => (-value.im, value.re),
                    };
                    two[0] = first;
                    if let Some(second) = two.get_mut(1) {
                        *second = other;
                    }
                }
            }
        }
        out
    }
}

/// Sums an even sequence, given by its samples 0…m−1 and zero beyond, into one period of `n` samples: entry j is the sum over all
/// integers q ≡ j modulo the period. Both ways of sampling need it: wrapping a kernel and folding a spectrum.
pub fn fold_rows<T: Real>(plane: ArrayView2<T>, n: usize) -> Array2<T> {
    fold_rows_as(plane, n, Parity::Even)
}

/// The same for sequences of either parity.
pub fn fold_rows_as<T: Real>(plane: ArrayView2<T>, n: usize, parity: Parity) -> Array2<T> {
    let (rows, columns) = plane.dim();
    let period = period(n) as isize;
    let places = (1 - columns as isize..columns as isize).filter_map(|q| {
        let sign = if q < 0 { parity.sign::<T>() } else { T::one() };
        let j = q.rem_euclid(period) as usize;
        (j < n).then_some((j, q.unsigned_abs(), sign))
    });
    // Memory is walked in its order, whether rows or columns lie in one piece.
    if plane.strides()[0] == 1 {
        let mut out = Array2::from_elem((rows, n).f(), T::zero());
        for (j, q, sign) in places {
            out.column_mut(j).zip_mut_with(&plane.column(q), |sum, &v| *sum = *sum + sign * v);
        }
        return out;
    }
    let (places, mut out) = (places.collect::<Vec<_>>(), Array2::from_elem((rows, n), T::zero()));
    for (row, mut sums) in plane.outer_iter().zip(out.outer_iter_mut()) {
        for &(j, q, sign) in &places {
            sums[j] = sums[j] + sign * row[q];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direct(row: &[f64], n: usize) -> Vec<f64> {
        let p = period(n);
        (0..n)
            .map(|j| {
                (0..p)
                    .map(|i| {
                        let x = row.get(mirror_index(i as isize, n)).copied().unwrap_or(0.0);
                        x * (std::f64::consts::TAU * (i * j) as f64 / p as f64).cos()
                    })
                    .sum()
            })
            .collect()
    }

    #[test]
    fn indices_are_mirrored_as_in_the_frame_and_on_for_ever() {
        for n in 2..9 {
            for i in -(n as isize) + 1..2 * n as isize - 1 {
                assert_eq!(mirror_index(i, n), edof_core::geometry::mirror(i, n));
            }
        }
        assert_eq!([-7, 7, 13].map(|i| mirror_index(i, 4)), [1, 1, 1]);
        assert_eq!([-3, 0, 5].map(|i| mirror_index(i, 1)), [0, 0, 0]);
    }

    #[test]
    fn a_folded_sequence_keeps_its_sum_over_both_sides() {
        let plane = Array2::from_shape_fn((1, 23), |(_, c)| c as f64 + 1.0);
        let whole: f64 = plane[(0, 0)] + 2.0 * plane.iter().skip(1).sum::<f64>();
        for n in [1, 2, 5, 40] {
            let folded = fold_rows(plane.view(), n);
            let sum: f64 = (0..period(n) as isize).map(|i| folded[(0, mirror_index(i, n))]).sum();
            assert!((sum - whole).abs() < 1e-9, "n = {n}");
        }
    }

    proptest! {
        #[test]
        fn the_transform_is_the_sum_of_cosines(
            rows in 1usize..40, n in 1usize..20, given in 1usize..20, seed in any::<u32>()
        ) {
            let given = given.min(n);
            let plane = Array2::from_shape_fn((rows, given), |(r, c)| {
                f64::from(seed.wrapping_mul(2_654_435_761).wrapping_add((r * 31 + c * 7) as u32) % 97) / 97.0
            });
            let out = EvenTransform::new(n).rows_transposed(plane.view(), n);
            for r in 0..rows {
                let row: Vec<f64> = plane.row(r).to_vec();
                for (a, b) in out.column(r).iter().zip(direct(&row, n)) { prop_assert!((a - b).abs() < 1e-9); }
            }
        }

        #[test]
        fn twice_is_the_period(rows in 1usize..20, columns in 2usize..20) {
            for parity in Parity::ALL {
                let inside = |c: usize| parity == Parity::Even || (c > 0 && c + 1 < columns);
                let plane = Array2::from_shape_fn((rows, columns), |(r, c)| {
                    if inside(c) { ((r * 5 + c * 3) % 11) as f64 } else { 0.0 }
                });
                let t = EvenTransform::new(columns);
                let once = t.rows_transposed_as(plane.view(), columns, parity).reversed_axes();
                let twice = t.rows_transposed_as(once.view(), columns, parity).reversed_axes();
                for (a, b) in twice.iter().zip(&plane) {
                    prop_assert!((a / period(columns) as f64 - b).abs() < 1e-9);
                }
            }
        }
    }
}
