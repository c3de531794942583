//! The non-zero words of a sparse vector, two at a time, cut where a 32-bit sum could overflow.

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
    nonzeros: Vec<(u32, i16)>,
}

impl Pairs {
    /// Collects the non-zero words of `vector`; `bounds` are the columns' largest |weight|.
    pub fn collect(&mut self, vector: &[i16], bounds: &[u32]) {
        self.pairs.clear();
        self.ends.clear();
        self.nonzeros.resize(vector.len(), (0, 0));
        let mut count = 0;
        for (index, &word) in vector.iter().enumerate() {
            self.nonzeros[count] = (index as u32, word);
            count += usize::from(word != 0);
        }
        let bound =
            |(index, word): (u32, i16)| u64::from(bounds[index as usize]) * u64::from(word.unsigned_abs());
        let mut sum = 0;
        let mut push = |pair: Pair, bound: u64| {
            if sum + bound > i32::MAX as u64 {
                self.ends.push(self.pairs.len());
                sum = 0;
            }
            sum += bound;
            self.pairs.push(pair);
        };
        for two in self.nonzeros[..count].chunks(2) {
            match *two {
                [a, b] if bound(a) + bound(b) <= i32::MAX as u64 => push(pair(a, b), bound(a) + bound(b)),
                _ => two.iter().for_each(|&a| push(pair(a, (a.0, 0)), bound(a))),
            }
        }
        self.ends.push(self.pairs.len());
    }

    /// Segments of pairs, in order; always at least one, which may be empty.
    pub fn segments(&self) -> impl Iterator<Item = &[Pair]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.pairs[start..end])
    }
}

fn pair((first, a): (u32, i16), (second, b): (u32, i16)) -> Pair {
    Pair { first, second, words: i32::from(a as u16) | (i32::from(b) << 16) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collected(vector: &[i16], bound: u32) -> Vec<Vec<Pair>> {
        let mut pairs = Pairs::default();
        pairs.collect(vector, &vec![bound; vector.len()]);
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
