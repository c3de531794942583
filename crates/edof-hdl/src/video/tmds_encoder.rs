//! The code of a colour's channel on a DVI cable.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// A channel of DVI 1.0 (section 3): a byte as ten bits with few transitions and as many ones as zeros in the long run, or one of four symbols that
/// mark syncs. The symbol stands four cycles after its byte. There is no reset: a cycle without a pixel sets the disparity to 0.
#[derive(Circuit)]
#[circuit(default(BitCount), registers(clock))]
pub struct TmdsEncoder {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// A pixel is sent; a symbol of control otherwise.
    pub de: Signal<In, Bit>,
    /// The byte.
    pub byte: Signal<In, Bits<8>>,
    /// Bits C0 and C1, C0 low.
    pub control: Signal<In, Bits<2>>,
    /// The symbol, its first bit low.
    pub symbol: Signal<Out, Bits<10>>,
    /// Half of what ones exceed zeros by since the last control, in two's complement.
    pub disparity: Signal<Out, Bits<4>>,
    ones_1: BitCount,
    byte_1: DFF<Bits<8>>,
    marks_1: DFF<Bits<3>>,
    word_2: DFF<Bits<9>>,
    marks_2: DFF<Bits<3>>,
    ones_3: BitCount,
    word_3: DFF<Bits<9>>,
    marks_3: DFF<Bits<3>>,
    symbol_4: DFF<Bits<10>>,
    disparity_4: DFF<Bits<4>>,
    parity: [Signal<Local, Bit>; 8],
    by_xnor: Signal<Local, Bit>,
    minimal: Signal<Local, Bits<9>>,
    balance: Signal<Local, Bits<4>>,
    by_xor: Signal<Local, Bits<4>>,
    is_level: Signal<Local, Bit>,
    inverts: Signal<Local, Bit>,
    inverted: Signal<Local, Bits<10>>,
}

impl Logic for TmdsEncoder {
    #[kernel]
    fn update(&mut self) {
        // How many ones the byte has.
        self.ones_1.clock.next = self.clock.val();
        self.ones_1.bits.next = self.byte.val();
        self.byte_1.d.next = self.byte.val();
        self.marks_1.d.next = bit_cast::<3, 2>(self.control.val());
        if self.de.val() {
            self.marks_1.d.next = bit_cast::<3, 2>(self.control.val()) | 4;
        }

        // Each bit is added to those before it; with more ones than zeros, the complement of every second sum has fewer transitions.
        self.by_xnor.next = (self.ones_1.count.val() > 4)
            || ((self.ones_1.count.val() == 4) && !self.byte_1.q.val().get_bit(0));
        self.parity[0].next = self.byte_1.q.val().get_bit(0);
        for i in 1..8 {
            self.parity[i].next = self.parity[i - 1].val() ^ self.byte_1.q.val().get_bit(i);
        }
        self.minimal.next = 0.into();
        for i in 0..8 {
            self.minimal.next = self.minimal.val().replace_bit(i, self.parity[i].val());
        }
        self.word_2.d.next = self.minimal.val() | 0x100;
        if self.by_xnor.val() {
            self.word_2.d.next = self.minimal.val() ^ 0xaa;
        }
        self.marks_2.d.next = self.marks_1.q.val();

        // By how many pairs its ones exceed its zeros.
        self.ones_3.clock.next = self.clock.val();
        self.ones_3.bits.next = self.word_2.q.val().get_bits::<8>(0);
        self.balance.next = self.ones_3.count.val() - 4;
        self.word_3.d.next = self.word_2.q.val();
        self.marks_3.d.next = self.marks_2.q.val();

        // Inverted if ones exceed zeros both here and before, or zeros ones. The flags of both choices count as bits, too.
        self.is_level.next = !self.disparity_4.q.val().any() || !self.balance.val().any();
        self.inverts.next = self.disparity_4.q.val().get_bit(3) == self.balance.val().get_bit(3);
        if self.is_level.val() {
            self.inverts.next = !self.word_3.q.val().get_bit(8);
        }
        self.by_xor.next = bit_cast::<4, 1>(self.word_3.q.val().get_bits::<1>(8));
        self.inverted.next = bit_cast::<10, 9>(self.word_3.q.val()) ^ 0x2ff;
        if self.inverts.val() {
            self.symbol_4.d.next = self.inverted.val();
            self.disparity_4.d.next = self.disparity_4.q.val() + self.by_xor.val() - self.balance.val();
        } else {
            self.symbol_4.d.next = bit_cast::<10, 9>(self.word_3.q.val());
            self.disparity_4.d.next = self.disparity_4.q.val() + self.by_xor.val() + self.balance.val() - 1;
        }
        if !self.marks_3.q.val().get_bit(2) {
            self.disparity_4.d.next = 0.into();
            if self.marks_3.q.val().get_bits::<2>(0) == 0 {
                self.symbol_4.d.next = 0x354.into();
            } else if self.marks_3.q.val().get_bits::<2>(0) == 1 {
                self.symbol_4.d.next = 0x0ab.into();
            } else if self.marks_3.q.val().get_bits::<2>(0) == 2 {
                self.symbol_4.d.next = 0x154.into();
            } else {
                self.symbol_4.d.next = 0x2ab.into();
            }
        }
        self.symbol.next = self.symbol_4.q.val();
        self.disparity.next = self.disparity_4.q.val();
    }
}

/// How many bits of a byte are set, in the next cycle.
#[derive(Circuit)]
#[circuit(default, registers(clock))]
pub struct BitCount {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The byte.
    pub bits: Signal<In, Bits<8>>,
    /// How many are set.
    pub count: Signal<Out, Bits<4>>,
    count_q: DFF<Bits<4>>,
    halves: [Signal<Local, Bits<4>>; 2],
}

impl Logic for BitCount {
    #[kernel]
    fn update(&mut self) {
        self.halves[0].next = (bit_cast::<4, 1>(self.bits.val().get_bits::<1>(0))
            + bit_cast::<4, 1>(self.bits.val().get_bits::<1>(1)))
            + (bit_cast::<4, 1>(self.bits.val().get_bits::<1>(2))
                + bit_cast::<4, 1>(self.bits.val().get_bits::<1>(3)));
        self.halves[1].next = (bit_cast::<4, 1>(self.bits.val().get_bits::<1>(4))
            + bit_cast::<4, 1>(self.bits.val().get_bits::<1>(5)))
            + (bit_cast::<4, 1>(self.bits.val().get_bits::<1>(6))
                + bit_cast::<4, 1>(self.bits.val().get_bits::<1>(7)));
        self.count_q.d.next = self.halves[0].val() + self.halves[1].val();
        self.count.next = self.count_q.q.val();
    }
}
