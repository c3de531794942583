//! Values of all inputs, or all outputs, of a design in every cycle, as 32-bit words.

use crate::{Direction, Error, Port, Source};

/// Where each port lies in a row of words: in the order of the ports, least significant word first, clocks left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    slots: Vec<Slot>,
    words: usize,
}

/// The place of one port in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slot {
    /// Place of the port in [`Source::ports`].
    pub port: usize,
    /// First word in the row.
    pub at: usize,
    /// Width of the port.
    pub bits: usize,
}

impl Slot {
    /// The port's words in a row.
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.at..self.at + self.bits.div_ceil(32)
    }
}

impl Layout {
    /// Rows of what a stimulus gives: every input but the clocks.
    #[must_use]
    pub fn inputs(source: &Source) -> Self {
        Self::of(source, |port| port.direction == Direction::In && !port.is_clock)
    }

    /// Rows of every output.
    #[must_use]
    pub fn outputs(source: &Source) -> Self {
        Self::of(source, |port| port.direction == Direction::Out)
    }

    fn of(source: &Source, belongs: impl Fn(&Port) -> bool) -> Self {
        let mut layout = Self { slots: vec![], words: 0 };
        for (index, port) in source.ports.iter().enumerate().filter(|(_, port)| belongs(port)) {
            layout.slots.push(Slot { port: index, at: layout.words, bits: port.bits });
            layout.words += port.words();
        }
        layout
    }

    /// Words in a row.
    #[must_use]
    pub const fn words(&self) -> usize {
        self.words
    }

    /// The places of the ports, in order.
    #[must_use]
    pub fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// The place of a port.
    ///
    /// # Errors
    /// The port is not among these rows.
    pub fn slot(&self, port: usize) -> Result<&Slot, Error> {
        let found = self.slots.iter().find(|slot| slot.port == port);
        found.ok_or_else(|| Error::Port(format!("port {port} is not in these rows")))
    }

    /// Puts the value of a port into a row; bits beyond the port's width are lost, those beyond 64 become 0.
    ///
    /// # Errors
    /// The port is not among these rows.
    pub fn put(&self, row: &mut [u32], port: usize, value: u64) -> Result<(), Error> {
        let slot = self.slot(port)?;
        put(&mut row[slot.range()], value, slot.bits);
        Ok(())
    }

    /// The value of a port in a row; its low 64 bits if it is wider.
    ///
    /// # Errors
    /// The port is not among these rows.
    pub fn get(&self, row: &[u32], port: usize) -> Result<u64, Error> {
        Ok(get(&row[self.slot(port)?.range()]))
    }

    /// Uniformly random rows. The same seed gives the same rows for ever.
    #[must_use]
    pub fn random(&self, cycles: usize, seed: u64) -> Rows {
        let mut state = seed;
        let mut rows = Rows::new(self.words);
        for _ in 0..cycles {
            let row = rows.push_zeros();
            row.iter_mut().for_each(|word| *word = (split_mix(&mut state) >> 32) as u32);
            self.slots.iter().for_each(|slot| mask(&mut row[slot.range()], slot.bits));
        }
        rows
    }
}

/// The words of a value of `bits` bits.
pub(crate) fn put(words: &mut [u32], value: u64, bits: usize) {
    let halves = [value as u32, (value >> 32) as u32];
    words.iter_mut().enumerate().for_each(|(i, word)| *word = halves.get(i).copied().unwrap_or(0));
    mask(words, bits);
}

/// The low 64 bits.
pub(crate) fn get(words: &[u32]) -> u64 {
    let word = |i: usize| u64::from(words.get(i).copied().unwrap_or(0));
    word(0) | word(1) << 32
}

/// Clears what lies beyond the width in the last word.
pub(crate) fn mask(words: &mut [u32], bits: usize) {
    if let (Some(last), rest @ 1..) = (words.last_mut(), bits % 32) {
        *last &= (1 << rest) - 1;
    }
}

/// Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// One row of words a cycle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows {
    width: usize,
    len: usize,
    words: Vec<u32>,
}

impl Rows {
    /// An empty list of rows with the given words per row.
    #[must_use]
    pub const fn new(width: usize) -> Self {
        Self { width, len: 0, words: vec![] }
    }

    /// The given number of rows of zeros.
    #[must_use]
    pub fn zeros(width: usize, len: usize) -> Self {
        Self { width, len, words: vec![0; width * len] }
    }

    /// Words in a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no row.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// One more row, to be filled in.
    pub fn push_zeros(&mut self) -> &mut [u32] {
        let start = self.words.len();
        self.len += 1;
        self.words.resize(start + self.width, 0);
        &mut self.words[start..]
    }

    /// A row.
    ///
    /// # Panics
    /// The index is out of range.
    #[must_use]
    pub fn row(&self, index: usize) -> &[u32] {
        &self.words[index * self.width..][..self.width]
    }

    /// A row, to be changed.
    ///
    /// # Panics
    /// The index is out of range.
    pub fn row_mut(&mut self, index: usize) -> &mut [u32] {
        &mut self.words[index * self.width..][..self.width]
    }

    /// All rows.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.len).map(|index| self.row(index))
    }

    /// All words, row by row.
    pub(crate) fn words(&self) -> &[u32] {
        &self.words
    }

    /// All words, row by row.
    pub(crate) fn words_mut(&mut self) -> &mut [u32] {
        &mut self.words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source() -> Source {
        let ports = vec![Port::clock("c"), Port::input("a", 3), Port::output("y", 40), Port::input("w", 70)];
        Source { top: "t".into(), files: vec![], ports }
    }

    #[test]
    fn a_value_comes_back_cut_to_its_width() {
        let layout = Layout::inputs(&source());
        let mut rows = Rows::new(layout.words());
        let row = rows.push_zeros();
        layout.put(row, 1, 0xff).unwrap();
        layout.put(row, 3, 0x0123_4567_89ab_cdef).unwrap();
        assert_eq!(row, [7, 0x89ab_cdef, 0x0123_4567, 0]);
        assert_eq!(layout.get(row, 3).unwrap(), 0x0123_4567_89ab_cdef);
        assert_eq!(layout.get(row, 0).unwrap_err().to_string(), "port 0 is not in these rows");
    }

    #[test]
    fn random_rows_are_the_seeds_and_inside_their_widths() {
        let layout = Layout::inputs(&source());
        let rows = layout.random(100, 3);
        assert_eq!(rows, layout.random(100, 3));
        assert_ne!(rows, layout.random(100, 4));
        assert!(rows.iter().all(|row| row[0] < 8 && row[3] < 64));
        assert_eq!(rows.iter().fold(0, |seen, row| seen | row[3]), 63);
    }
}
