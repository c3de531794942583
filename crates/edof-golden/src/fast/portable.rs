//! Kernels in plain Rust, for machines without the others and for what the others' 32 bits cannot hold; 64-bit sums throughout.

use super::columns;
use super::operands::Entries;
use super::pack::{self, Line, PANEL};
use super::sums::split;

/// Products of a panel with all pairs of a vector's words, into 64 sums' high and low parts.
pub fn dense(panel: &[Line], vector: &[i16], high: &mut [i32], low: &mut [i32]) {
    let mut sums = [0i64; PANEL];
    for (lines, words) in panel.chunks_exact(pack::LINES).zip(vector.chunks_exact(2)) {
        let (first, second) = (i64::from(words[0]), i64::from(words[1]));
        let rows = lines.iter().flat_map(|line| line.0.chunks_exact(2));
        for (sum, w) in sums.iter_mut().zip(rows) {
            *sum += i64::from(w[0]) * first + i64::from(w[1]) * second;
        }
    }
    store(sums, high, low);
}

/// Products of a panel of columns with a vector's active words.
pub fn sparse<'a>(
    panel: &[Line],
    entries: impl Iterator<Item = Entries<'a>>,
    high: &mut [i32],
    low: &mut [i32],
) {
    let mut sums = [0i64; PANEL];
    for (word, column) in entries.flat_map(|e| e.words.iter().zip(e.columns)) {
        let lines = &panel[usize::from(*column) * columns::LINES..][..columns::LINES];
        for (sums, line) in sums.chunks_exact_mut(PANEL / columns::LINES).zip(lines) {
            for (row, sum) in sums.iter_mut().enumerate() {
                *sum += i64::from(line.0[columns::place(row)]) * i64::from(*word);
            }
        }
    }
    store(sums, high, low);
}

fn store(sums: [i64; PANEL], high: &mut [i32], low: &mut [i32]) {
    for ((sum, high), low) in sums.into_iter().zip(high).zip(low) {
        (*high, *low) = split(sum);
    }
}

/// Writes the words that are not zero and their columns; gives how many they are and Σ |word|. No branch, because vectors differ;
/// one more entry may be written than there are.
pub fn collect(vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    let (mut count, mut magnitude) = (0, 0);
    for (column, &word) in vector.iter().enumerate() {
        (words[count], columns[count]) = (word, column as u16);
        count += usize::from(word != 0);
        magnitude += u64::from(word.unsigned_abs());
    }
    (count, magnitude)
}
