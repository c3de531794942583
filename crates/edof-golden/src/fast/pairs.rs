//! The non-zero words of a sparse vector, two at a time, cut where a 32-bit sum could overflow.

use super::finish;
use super::isa::Isa;

/// The largest sum that 32 bits hold.
const MOST: u64 = i32::MAX as u64;

/// A column and its word.
type Word = (u32, i16);

/// Two non-zero words and their columns; the second is zero (of the first's column) where the first stands alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// Column of the first word.
    pub first: u32,
    /// Column of the second.
    pub second: u32,
    /// The first word in the lower half, the second in the upper.
    pub words: i32,
}

/// Pairs in order, in segments whose sums fit 32 bits whatever the row.
#[derive(Debug, Clone, Default)]
pub struct Pairs {
    pairs: Vec<Pair>,
    ends: Vec<usize>,
    /// What bounds the sums of the last segment.
    sum: u64,
}

impl Pairs {
    /// Collects the non-zero words of `vector`; `bounds` are the columns' largest |weight|.
    pub fn collect(&mut self, isa: Isa, vector: &[i16], bounds: &[u32]) {
        self.pairs.clear();
        self.ends.clear();
        self.sum = 0;
        let mut alone: Option<(Word, u64)> = None;
        for (start, words) in vector.chunks(64).enumerate() {
            let mut mask = finish::nonzero_mask(isa, words);
            while mask != 0 {
                let index = start * 64 + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let word = (index as u32, vector[index]);
                let bound = u64::from(bounds[index]) * u64::from(word.1.unsigned_abs());
                match alone.take() {
                    None => alone = Some((word, bound)),
                    Some((first, of_first)) if of_first + bound <= MOST => {
                        self.push(pair(first, word), of_first + bound);
                    }
                    Some((first, of_first)) => {
                        self.push(pair(first, (first.0, 0)), of_first);
                        alone = Some((word, bound));
                    }
                }
            }
        }
        if let Some((last, bound)) = alone {
            self.push(pair(last, (last.0, 0)), bound);
        }
        self.ends.push(self.pairs.len());
    }

    /// Adds a pair whose products stay within `bound`.
    fn push(&mut self, pair: Pair, bound: u64) {
        if self.sum + bound > MOST {
            self.ends.push(self.pairs.len());
            self.sum = 0;
        }
        self.sum += bound;
        self.pairs.push(pair);
    }

    /// Segments of pairs, in order; always at least one, which may be empty.
    pub fn segments(&self) -> impl Iterator<Item = &[Pair]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.pairs[start..end])
    }
}

fn pair((first, a): Word, (second, b): Word) -> Pair {
    Pair { first, second, words: i32::from(a as u16) | (i32::from(b) << 16) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collected(vector: &[i16], bound: u32) -> Vec<Vec<Pair>> {
        let mut pairs = Pairs::default();
        pairs.collect(Isa::best(), vector, &vec![bound; vector.len()]);
        pairs.segments().map(<[Pair]>::to_vec).collect()
    }

    #[test]
    fn zeros_are_left_out_and_an_odd_one_stands_alone() {
        let pairs = [pair((1, 5), (3, -6)), pair((4, 7), (4, 0))];
        assert_eq!(collected(&[0, 5, 0, -6, 7], 100), [pairs.to_vec()]);
        assert_eq!(collected(&[0, 0], 100), [vec![]]);
    }

    #[test]
    fn segments_end_before_a_sum_could_pass_32_bits() {
        // Each product may reach 2^30: two of them would pass 2^31 − 1.
        let alone = |i| vec![pair((i, i16::MIN), (i, 0))];
        assert_eq!(collected(&[i16::MIN; 3], 32768), [alone(0), alone(1), alone(2)]);
        assert_eq!([4, 6].map(|n| collected(&vec![i16::MAX; n], 16384).len()), [1, 2]);
    }
}
