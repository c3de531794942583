//! From what a step read to a row of weights and values (I).

use super::delay::DelayOf;
use super::{Pair, Row, Word};
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// From what a step read to a row of weights and up to four values, four cycles after the step. Values without work are 0.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct DenseOperands {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// There is a step.
    pub valid: Signal<In, Bit>,
    /// The step is the first of its pass.
    pub first: Signal<In, Bit>,
    /// The odd one of two elements is meant.
    pub odd: Signal<In, Bit>,
    /// Row of weights of the pass's first step.
    pub base: Signal<In, Row>,
    /// What the step's row of weights is after it.
    pub offset: Signal<In, Row>,
    /// Two elements of the first part of the vector, two cycles after the step.
    pub pair_a: Signal<In, Pair>,
    /// Of the second.
    pub pair_b: Signal<In, Pair>,
    /// Of the third.
    pub pair_c: Signal<In, Pair>,
    /// Of the fourth.
    pub pair_d: Signal<In, Pair>,
    /// The step is the first of its pass.
    pub step_first: Signal<Out, Bit>,
    /// Row of weights.
    pub address: Signal<Out, Row>,
    /// Value.
    pub value_a: Signal<Out, Bits<25>>,
    /// Of the second part.
    pub value_b: Signal<Out, Bits<25>>,
    /// Of the third.
    pub value_c: Signal<Out, Bits<25>>,
    /// Of the fourth.
    pub value_d: Signal<Out, Bits<25>>,
    row: DFF<Row>,
    /// 1 in the stage that is dense (I); in others the delays are absent.
    dense: Constant<Bit>,
    #[is(CYCLES = if dense { 2 } else { 0 })]
    flags_to_2: DelayOf<3>,
    #[is(CYCLES = if dense { 3 } else { 0 })]
    row_to_4: DelayOf<12>,
    #[is(CYCLES = if dense { 2 } else { 0 })]
    first_to_4: DelayOf<1>,
    value_a_3: DFF<Word>,
    value_b_3: DFF<Word>,
    value_c_3: DFF<Word>,
    value_d_3: DFF<Word>,
    value_a_4: DFF<Bits<25>>,
    value_b_4: DFF<Bits<25>>,
    value_c_4: DFF<Bits<25>>,
    value_d_4: DFF<Bits<25>>,
    flags: Signal<Local, Bits<3>>,
    wide_a: Signal<Local, Bits<25>>,
    wide_b: Signal<Local, Bits<25>>,
    wide_c: Signal<Local, Bits<25>>,
    wide_d: Signal<Local, Bits<25>>,
}

impl DenseOperands {
    /// Those of an I stage; without `is_dense` those of another, which are 0.
    #[must_use]
    pub fn new(is_dense: bool) -> Self {
        let cycles = |cycles: usize| if is_dense { cycles } else { 0 };
        Self::from_parts(DenseOperandsParts {
            dense: Constant::new(is_dense),
            flags_to_2: DelayOf::new(cycles(2)),
            row_to_4: DelayOf::new(cycles(3)),
            first_to_4: DelayOf::new(cycles(2)),
        })
    }
}

impl Logic for DenseOperands {
    #[kernel]
    fn update(&mut self) {
        self.flags_to_2.clock.next = self.clock.val();
        self.row_to_4.clock.next = self.clock.val();
        self.first_to_4.clock.next = self.clock.val();

        // With the step, until what it read is there: bit 0 first, 1 valid, 2 odd.
        self.flags.next = (bit_cast::<3, 1>(self.odd.val().into()) << 2)
            | (bit_cast::<3, 1>(self.valid.val().into()) << 1)
            | bit_cast::<3, 1>(self.first.val().into());
        self.flags_to_2.data.next = self.flags.val();
        self.row.d.next = self.base.val() + self.offset.val();
        self.row_to_4.data.next = self.row.q.val();

        // Cycle 3: the element of two.
        self.value_a_3.d.next = self.pair_a.val().get_bits::<16>(0);
        self.value_b_3.d.next = self.pair_b.val().get_bits::<16>(0);
        self.value_c_3.d.next = self.pair_c.val().get_bits::<16>(0);
        self.value_d_3.d.next = self.pair_d.val().get_bits::<16>(0);
        if self.flags_to_2.delayed.val().get_bit(2) {
            self.value_a_3.d.next = self.pair_a.val().get_bits::<16>(16);
            self.value_b_3.d.next = self.pair_b.val().get_bits::<16>(16);
            self.value_c_3.d.next = self.pair_c.val().get_bits::<16>(16);
            self.value_d_3.d.next = self.pair_d.val().get_bits::<16>(16);
        }
        if !self.flags_to_2.delayed.val().get_bit(1) {
            self.value_a_3.d.next = 0.into();
            self.value_b_3.d.next = 0.into();
            self.value_c_3.d.next = 0.into();
            self.value_d_3.d.next = 0.into();
        }

        // Cycle 4: as wide as a multiplier's input.
        self.wide_a.next = bit_cast::<25, 16>(self.value_a_3.q.val());
        if self.value_a_3.q.val().get_bit(15) {
            self.wide_a.next = bit_cast::<25, 16>(self.value_a_3.q.val()) | 0x1ff_0000;
        }
        self.value_a_4.d.next = self.wide_a.val();
        self.wide_b.next = bit_cast::<25, 16>(self.value_b_3.q.val());
        if self.value_b_3.q.val().get_bit(15) {
            self.wide_b.next = bit_cast::<25, 16>(self.value_b_3.q.val()) | 0x1ff_0000;
        }
        self.value_b_4.d.next = self.wide_b.val();
        self.wide_c.next = bit_cast::<25, 16>(self.value_c_3.q.val());
        if self.value_c_3.q.val().get_bit(15) {
            self.wide_c.next = bit_cast::<25, 16>(self.value_c_3.q.val()) | 0x1ff_0000;
        }
        self.value_c_4.d.next = self.wide_c.val();
        self.wide_d.next = bit_cast::<25, 16>(self.value_d_3.q.val());
        if self.value_d_3.q.val().get_bit(15) {
            self.wide_d.next = bit_cast::<25, 16>(self.value_d_3.q.val()) | 0x1ff_0000;
        }
        self.value_d_4.d.next = self.wide_d.val();
        self.first_to_4.data.next = self.flags_to_2.delayed.val().get_bits::<1>(0);

        self.step_first.next = self.first_to_4.delayed.val().get_bit(0);
        self.address.next = self.row_to_4.delayed.val();
        self.value_a.next = self.value_a_4.q.val();
        self.value_b.next = self.value_b_4.q.val();
        self.value_c.next = self.value_c_4.q.val();
        self.value_d.next = self.value_d_4.q.val();
    }
}
