//! Kernels in plain Rust, for machines without the others and for what the others' 32 bits cannot hold; 64-bit sums throughout.

use super::pack::{Line, PANEL};
use super::sums::split;

/// Products of a panel with all pairs of a vector's words, into 64 sums' high and low parts.
pub fn dense(panel: &[Line], vector: &[i16], high: &mut [i32], low: &mut [i32]) {
    products(panel, vector, 0..vector.len() / 2, high, low);
}

/// Products of a panel with some pairs of a vector's words.
pub fn products(
    panel: &[Line],
    vector: &[i16],
    pairs: impl Iterator<Item = usize>,
    high: &mut [i32],
    low: &mut [i32],
) {
    const LINES: usize = super::pack::LINES;
    let mut sums = [0i64; PANEL];
    for pair in pairs {
        let (first, second) = (i64::from(vector[2 * pair]), i64::from(vector[2 * pair + 1]));
        let rows = panel[pair * LINES..][..LINES].iter().flat_map(|line| line.0.chunks_exact(2));
        for (sum, w) in sums.iter_mut().zip(rows) {
            *sum += i64::from(w[0]) * first + i64::from(w[1]) * second;
        }
    }
    for ((sum, high), low) in sums.into_iter().zip(high).zip(low) {
        (*high, *low) = split(sum);
    }
}
