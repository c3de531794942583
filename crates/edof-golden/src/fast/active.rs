//! Which pairs of neighbouring words of sparse vectors are not both zero, cut where a 32-bit sum could overflow.

use super::isa::{Isa, for_each_isa};
use super::pack::MOST;

/// The active pairs of a batch of vectors, in segments whose sums fit 32 bits whatever the row.
#[derive(Debug, Clone, Default)]
pub struct Active {
    pairs: Vec<u16>,
    /// Ends of segments in `pairs`.
    segments: Vec<usize>,
    /// For each vector, the end of its segments and whether no segment could hold its largest pair.
    vectors: Vec<(usize, bool)>,
    /// Pairs in use.
    used: usize,
}

impl Active {
    /// Forgets all vectors.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.vectors.clear();
        self.used = 0;
    }

    /// Adds a vector of an even number of words, at most 2^16; its products are with weights of at most `largest`.
    pub fn push(&mut self, isa: Isa, vector: &[i16], largest: u64) {
        let first = self.used;
        let room = first + vector.len() / 2;
        if self.pairs.len() < room {
            self.pairs.resize(room, 0);
        }
        self.used += collect(vector, &mut self.pairs[first..room]);
        let most = MOST / largest.max(1);
        let mut too_large = false;
        if magnitude(isa, vector) > most {
            let mut sum = 0;
            for (i, &pair) in self.pairs[first..self.used].iter().enumerate() {
                let [a, b] = [0, 1].map(|k| u64::from(vector[2 * usize::from(pair) + k].unsigned_abs()));
                too_large |= a + b > most;
                sum += a + b;
                if sum > most && i > 0 {
                    self.segments.push(first + i);
                    sum = a + b;
                }
            }
        }
        self.segments.push(self.used);
        self.vectors.push((self.segments.len(), too_large));
    }

    /// Segments of vector `i`, each a few pairs, in order; none where a single pair's products could pass 32 bits.
    pub fn segments(&self, i: usize) -> Option<impl Iterator<Item = &[u16]> + Clone> {
        let first = i.checked_sub(1).map_or(0, |before| self.vectors[before].0);
        let (end, too_large) = self.vectors[i];
        let start = first.checked_sub(1).map_or(0, |before| self.segments[before]);
        let ends = &self.segments[first..end];
        let starts = std::iter::once(start).chain(ends.iter().copied());
        (!too_large).then(|| starts.zip(ends).map(|(start, &end)| &self.pairs[start..end]))
    }
}

/// Writes the active pairs of a vector and gives how many they are: no branch, for no two vectors are alike.
fn collect(vector: &[i16], pairs: &mut [u16]) -> usize {
    let mut count = 0;
    for (pair, words) in vector.chunks_exact(2).enumerate() {
        pairs[count] = pair as u16;
        count += usize::from(words != [0, 0]);
    }
    count
}

for_each_isa! {
    /// Σ |word|.
    fn magnitude(vector: &[i16]) -> u64 {
        vector.iter().map(|w| u32::from(w.unsigned_abs())).sum::<u32>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segments(vectors: &[&[i16]], largest: u64) -> Vec<Option<Vec<Vec<u16>>>> {
        let mut active = Active::default();
        vectors.iter().for_each(|vector| active.push(Isa::best(), vector, largest));
        let of = |i| active.segments(i).map(|all| all.map(<[u16]>::to_vec).collect());
        (0..vectors.len()).map(of).collect()
    }

    #[test]
    fn pairs_of_zeros_are_left_out() {
        let vectors: [&[i16]; 3] = [&[0, 5, 0, 0, -6, 7], &[0, 0], &[1, 0]];
        assert_eq!(
            segments(&vectors, 100),
            [Some(vec![vec![0, 2]]), Some(vec![vec![]]), Some(vec![vec![0]])]
        );
    }

    #[test]
    fn segments_end_before_a_sum_could_pass_32_bits() {
        // Each pair may reach 2^30: two of them would pass 2^31 − 1.
        let alone = vec![vec![0], vec![1], vec![2]];
        assert_eq!(segments(&[&[i16::MIN, 0, 0, i16::MIN, i16::MIN, 0]], 32768), [Some(alone)]);
        assert_eq!(segments(&[&[i16::MAX; 8]], 32768), [Some(vec![vec![0], vec![1], vec![2], vec![3]])]);
        assert_eq!(segments(&[&[i16::MAX; 8]], 16384), [Some(vec![vec![0, 1], vec![2, 3]])]);
    }

    #[test]
    fn a_pair_whose_products_pass_32_bits_is_told() {
        assert_eq!(segments(&[&[i16::MIN; 2], &[1, 1]], 32768), [None, Some(vec![vec![0]])]);
    }
}
