//! Kernels in plain Rust, for machines without the others; 64-bit sums throughout.

use super::pack::{Dense, Sparse};
use super::pairs::Pairs;

/// Products of a dense matrix with inputs that lie one after the other.
pub fn dense(matrix: &Dense, input: &[i16], sums: &mut [i64]) {
    for (y, sums) in input.chunks_exact(matrix.columns).zip(sums.chunks_exact_mut(matrix.stride)) {
        sums.fill(0);
        for (two, weights) in y.chunks_exact(2).zip(matrix.weights.chunks_exact(2 * matrix.stride)) {
            for (sum, w) in sums.iter_mut().zip(weights.chunks_exact(2)) {
                *sum += i64::from(w[0]) * i64::from(two[0]) + i64::from(w[1]) * i64::from(two[1]);
            }
        }
    }
}

/// The product of a sparse vector.
pub fn sparse(matrix: &Sparse, pairs: &Pairs, sums: &mut [i64]) {
    sums.fill(0);
    for pair in pairs.segments().flatten() {
        let column = |index: u32| &matrix.weights[index as usize * matrix.stride..][..matrix.stride];
        let (a, b) = (i64::from(pair.words as i16), i64::from(pair.words >> 16));
        for ((sum, wa), wb) in sums.iter_mut().zip(column(pair.first)).zip(column(pair.second)) {
            *sum += i64::from(*wa) * a + i64::from(*wb) * b;
        }
    }
}
