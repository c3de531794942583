//! Leaf `edof_serialiser`: words into a clock five times as fast, bit by bit.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// Bits of a word per lane, two of which leave in a cycle.
const BITS: u32 = 10;

/// Words of ten bits per lane into a clock five times as fast, of the same source and any phase: two bits per lane and cycle, the lowest first.
/// `W` is ten times `L`, the number of lanes. A word's first bits leave three to four cycles of `bit_clock` after the word came. There is no reset: the first
/// words after a start may be cut.
#[derive(Circuit)]
pub struct Serialiser<const W: usize, const L: usize> {
    /// Clock of the words.
    pub word_clock: Signal<In, Clock>,
    /// A word, lane 0 low.
    pub word: Signal<In, Bits<W>>,
    /// Clock of the bits, five times as fast.
    pub bit_clock: Signal<In, Clock>,
    /// The earlier bit of each lane.
    pub first: Signal<Out, Bits<L>>,
    /// The later one.
    pub second: Signal<Out, Bits<L>>,
    _toggle: bool,
    _word: u64,
    _seen: [bool; 3],
    _count: u8,
    _bits: u64,
}

impl<const W: usize, const L: usize> Default for Serialiser<W, L> {
    fn default() -> Self {
        assert!(W == BITS as usize * L && W <= 64, "{W} bits in {L} lanes");
        Self::from_parts(SerialiserParts { _toggle: false, _word: 0, _seen: [false; 3], _count: 0, _bits: 0 })
    }
}

impl<const W: usize, const L: usize> Logic for Serialiser<W, L> {
    fn update(&mut self) {
        let (toggle, word) = (self._toggle, self._word);
        if self.word_clock.pos_edge() {
            (self._toggle, self._word) = (!toggle, self.word.val().to_u64());
        }
        if self.bit_clock.pos_edge() {
            let is_off = self._seen[1] != self._seen[2] && matches!(self._count, 2 | 3);
            let top_two = (0..L as u32).fold(0, |mask, lane| mask | 3u64 << (BITS * lane + BITS - 2));
            self._bits = if self._count == 0 { word } else { (self._bits >> 2) & !top_two };
            self._count = match self._count {
                2 if is_off => 2,
                3 if is_off => 0,
                count => (count + 1) % 5,
            };
            self._seen = [toggle, self._seen[0], self._seen[1]];
        }
        let each = |bit: u32| {
            (0..L as u32).fold(0, |bits, lane| bits | (self._bits >> (BITS * lane + bit) & 1) << lane)
        };
        self.first.next = each(0).into();
        self.second.next = each(1).into();
    }

    fn connect(&mut self) {
        self.first.connect();
        self.second.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_serialiser")
            .parameter("LANES", L)
            .port("word_clock_i", "word_clock")
            .port("word_i", "word")
            .port("bit_clock_i", "bit_clock")
            .port("first_o", "first")
            .port("second_o", "second")
            .verilog()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: [u64; 4] = [0xabcde, 0x12345, 0xfffff, 0x00000];

    /// The bits of both lanes, the lower lane's first, of random words that came: a word every fifth cycle of bits, in any phase.
    #[test]
    fn every_bit_of_every_word_leaves_in_order() {
        let mut block = Serialiser::<20, 2>::default();
        block.connect_all();
        let mut lanes = [vec![], vec![]];
        for cycle in 0..200 {
            if cycle % 5 == 3 {
                block.word.next = WORDS[cycle / 5 % WORDS.len()].into();
            }
            for clk in [true, false] {
                block.word_clock.next = Clock { clk: clk && cycle % 5 == 3 };
                simulate(&mut block, 10);
            }
            for clk in [true, false] {
                block.bit_clock.next = Clock { clk };
                simulate(&mut block, 10);
            }
            for (i, lane) in lanes.iter_mut().enumerate() {
                lane.extend([block.first.val().get_bit(i), block.second.val().get_bit(i)]);
            }
        }
        for (i, lane) in lanes.iter().enumerate() {
            let bits = |word: &u64| (0..10).map(|bit| word >> (10 * i + bit) & 1 == 1).collect::<Vec<_>>();
            let expected: Vec<bool> = WORDS.iter().cycle().take(8).flat_map(bits).collect();
            assert!(lane[100..].windows(expected.len()).any(|found| found == expected), "lane {i}: {lane:?}");
        }
    }
}
