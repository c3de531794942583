//! The words of sparse vectors that are not zero, two by two, cut where a 32-bit sum could overflow.

use super::isa::Isa;
use super::operands::{Entries, SLACK};
use super::pack::MAX;
use super::portable;
#[cfg(target_arch = "x86_64")]
use super::x86;

/// The active words of a batch of vectors, in segments whose sums fit 32 bits whatever the row.
#[derive(Debug, Clone, Default)]
pub struct Active {
    words: Vec<i16>,
    columns: Vec<u16>,
    /// Entries in use, an even number.
    used: usize,
    /// Ends of segments.
    segments: Vec<usize>,
    vectors: Vec<Vector>,
}

/// A vector's part.
#[derive(Debug, Clone, Copy)]
struct Vector {
    /// Where its entries start.
    start: usize,
    /// First segment of the vector, and that of the next.
    segments: (usize, usize),
    /// Whether the products of each two words fit 32 bits.
    fits: bool,
}

impl Active {
    /// Forgets all vectors.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.vectors.clear();
        self.used = 0;
    }

    /// Adds a vector of at most 2^16 words, which are to be multiplied by weights of at most `largest`; gives how many are not zero.
    pub fn push(&mut self, isa: Isa, vector: &[i16], largest: u64) -> u64 {
        let start = self.used;
        let room = start + vector.len() + SLACK;
        if self.words.len() < room {
            self.words.resize(room, 0);
            self.columns.resize(room, 0);
        }
        let (count, magnitude) =
            collect(isa, vector, &mut self.words[start..room], &mut self.columns[start..room]);
        self.used += count;
        if !count.is_multiple_of(2) {
            (self.words[self.used], self.columns[self.used]) = (0, 0);
            self.used += 1;
        }
        let first = self.segments.len();
        let max = MAX / largest.max(1);
        let fits = magnitude <= max || self.cut(start, max);
        self.segments.push(self.used);
        self.vectors.push(Vector { start, segments: (first, self.segments.len()), fits });
        count as u64
    }

    /// Ends segments of the entries from `start` on before Σ |word| passes `max`, except for the last; returns whether that is possible.
    fn cut(&mut self, start: usize, max: u64) -> bool {
        let (mut sum, mut fits) = (0, true);
        for (i, two) in self.words[start..self.used].as_chunks::<2>().0.iter().enumerate() {
            let both: u64 = two.iter().map(|word| u64::from(word.unsigned_abs())).sum();
            fits &= both <= max;
            sum += both;
            if sum > max && i > 0 {
                self.segments.push(start + 2 * i);
                sum = both;
            }
        }
        fits
    }

    /// Whether vector `i` can be multiplied in sums of 32 bits, segment by segment.
    #[must_use]
    pub fn fits(&self, i: usize) -> bool {
        self.vectors[i].fits
    }

    /// Segments of vector `i`, in order.
    pub fn segments(&self, i: usize) -> impl Iterator<Item = Entries<'_>> {
        let Vector { start, segments: (first, end), .. } = self.vectors[i];
        let ends = &self.segments[first..end];
        let starts = std::iter::once(start).chain(ends.iter().copied());
        starts.zip(ends).map(|(start, &end)| Entries {
            words: &self.words[start..end],
            columns: &self.columns[start..end],
        })
    }
}

/// Writes the words that are not zero and their columns; gives how many they are and Σ |word|. Up to [`SLACK`] more entries are written.
fn collect(isa: Isa, vector: &[i16], words: &mut [i16], columns: &mut [u16]) -> (usize, u64) {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512Vnni(token) => x86::collect_vbmi2(token, vector, words, columns),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512(token) => x86::collect_avx512(token, vector, words, columns),
        _ => portable::collect(vector, words, columns),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::draw::Draw;

    type Segments = Vec<Vec<(u16, i16)>>;

    fn segments(vectors: &[&[i16]], largest: u64) -> Vec<(bool, Segments)> {
        let mut active = Active::default();
        for vector in vectors {
            active.push(Isa::best(), vector, largest);
        }
        let entries = |e: Entries<'_>| e.columns.iter().copied().zip(e.words.iter().copied()).collect();
        (0..vectors.len()).map(|i| (active.fits(i), active.segments(i).map(entries).collect())).collect()
    }

    #[test]
    fn zeros_are_left_out_and_an_odd_number_gets_one() {
        let vectors: [&[i16]; 3] = [&[0, 5, 0, 0, -6, 7], &[0, 0], &[1, 0, 2]];
        let expected = [vec![(1, 5), (4, -6), (5, 7), (0, 0)], vec![], vec![(0, 1), (2, 2)]];
        assert_eq!(segments(&vectors, 100), expected.map(|entries| (true, vec![entries])));
    }

    #[test]
    fn segments_end_before_a_sum_could_pass_32_bits() {
        let max = |columns: [u16; 2]| columns.map(|column| (column, i16::MAX)).to_vec();
        // Two may reach 2^31 − 2^16, four twice as much.
        assert_eq!(segments(&[&[i16::MAX; 4]], 32768), [(true, vec![max([0, 1]), max([2, 3])])]);
        assert_eq!(segments(&[&[i16::MAX; 4]], 16384), [(true, vec![[max([0, 1]), max([2, 3])].concat()])]);
    }

    #[test]
    fn a_segment_goes_on_as_long_as_its_sum_is_the_most_that_fits() {
        // Weights of 32768 leave 65535 for the words.
        for (last, lengths) in [(3, [4, 2]), (4, [2, 4])] {
            let found = segments(&[&[32_767, -100, 32_665, last, 5, 6]], 32_768);
            let found: Vec<usize> = found[0].1.iter().map(Vec::len).collect();
            assert_eq!(found, lengths, "{last}");
        }
    }

    #[test]
    fn two_words_whose_products_pass_32_bits_are_reported() {
        let told = segments(&[&[i16::MIN; 2], &[1, 1]], 32768);
        assert_eq!(told.iter().map(|(fits, _)| *fits).collect::<Vec<_>>(), [false, true]);
        // No segment is empty.
        assert!(told.iter().all(|(_, segments)| segments.len() == 1 && segments[0].len() == 2));
    }

    #[test]
    fn vectors_have_room_for_their_words_and_for_what_kernels_write_after_them() {
        let mut active = Active::default();
        active.push(Isa::best(), &[1; 64], 1);
        assert_eq!([active.words.len(), active.columns.len()], [64 + SLACK; 2]);
        active.push(Isa::best(), &[1, 0, 3, 4], 1);
        assert_eq!([active.words.len(), active.columns.len()], [64 + 4 + SLACK; 2]);
        // What is there is used again.
        active.clear();
        active.push(Isa::best(), &[1; 8], 1);
        assert_eq!([active.words.len(), active.columns.len()], [64 + 4 + SLACK; 2]);
    }

    #[test]
    fn every_instruction_set_finds_the_same_words() {
        let draw = &mut Draw::new(7);
        for length in [1, 31, 32, 33, 64, 192, 330] {
            let vector: Vec<i16> =
                (0..length).map(|_| if draw.whole(0, 2) == 0 { draw.extreme(16) } else { 0 }).collect();
            let (mut words, mut columns) = (vec![0; length + SLACK], vec![0; length + SLACK]);
            let (count, magnitude) = portable::collect(&vector, &mut words, &mut columns);
            assert_eq!(count, vector.iter().filter(|w| **w != 0).count());
            assert_eq!(magnitude, vector.iter().map(|w| u64::from(w.unsigned_abs())).sum::<u64>());
            for isa in Isa::available() {
                let (mut again, mut places) = (vec![0; length + SLACK], vec![0; length + SLACK]);
                assert_eq!(collect(isa, &vector, &mut again, &mut places), (count, magnitude), "{isa:?}");
                assert_eq!(
                    (&again[..count], &places[..count]),
                    (&words[..count], &columns[..count]),
                    "{isa:?}"
                );
            }
        }
    }
}
