//! From what a step read to rows of weights and values (M, F).

use super::delay::DelayOf;
use super::{IndexedValue, Pair, Row, Word};
use crate::describe::{Circuit, kernel};
use edof_device::design::{Kind, StagePlan};
use rust_hdl::prelude::*;

/// From what a step read to rows of weights and values, four cycles after the step: pairs, or pixels of the window (F), shifted left
/// where F aligns its two sums. A value without work is 0.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct PairOperands {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// There is a step, with a first value.
    pub valid_a: Signal<In, Bit>,
    /// With a second one.
    pub valid_b: Signal<In, Bit>,
    /// The step is the first of its pass.
    pub first: Signal<In, Bit>,
    /// The step belongs to the window (linear path).
    pub linear: Signal<In, Bit>,
    /// The odd one of two elements is meant.
    pub odd: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// Row of weights of input 0.
    pub base: Signal<In, Row>,
    /// What the row of weights of a pixel is after it.
    pub offset: Signal<In, Row>,
    /// The even pair, two cycles after the step.
    pub even_pair: Signal<In, IndexedValue>,
    /// The odd one.
    pub odd_pair: Signal<In, IndexedValue>,
    /// Two pixels, in the same way.
    pub pixels: Signal<In, Pair>,
    /// Left shifts of set 0: of codes, of pixels.
    pub shifts_0: Signal<In, Bits<8>>,
    /// Of set 1.
    pub shifts_1: Signal<In, Bits<8>>,
    /// The step is the first of its pass.
    pub step_first: Signal<Out, Bit>,
    /// Row of weights.
    pub address_a: Signal<Out, Row>,
    /// Of the second value.
    pub address_b: Signal<Out, Row>,
    /// Value.
    pub value_a: Signal<Out, Bits<25>>,
    /// The second one.
    pub value_b: Signal<Out, Bits<25>>,
    aligns: Constant<Bit>,
    two_rows: Constant<Bit>,
    /// 1 in the stage that is dense (I), where the delays are absent.
    dense: Constant<Bit>,
    #[is(CYCLES = if dense { 0 } else { 2 })]
    flags_to_2: DelayOf<6>,
    #[is(CYCLES = if dense { 0 } else { 2 })]
    rows_to_2: DelayOf<24>,
    #[is(CYCLES = if dense { 0 } else { 2 })]
    first_to_4: DelayOf<1>,
    value_a_3: DFF<Word>,
    value_b_3: DFF<Word>,
    base_3: DFF<Row>,
    offset_a_3: DFF<Row>,
    offset_b_3: DFF<Row>,
    shift_3: DFF<Bits<4>>,
    address_a_4: DFF<Row>,
    address_b_4: DFF<Row>,
    value_a_4: DFF<Bits<25>>,
    value_b_4: DFF<Bits<25>>,
    flags: Signal<Local, Bits<6>>,
    pair_a: Signal<Local, IndexedValue>,
    pixel_a: Signal<Local, Word>,
    shifts: Signal<Local, Bits<8>>,
    wide_a: Signal<Local, Bits<25>>,
    wide_b: Signal<Local, Bits<25>>,
}

impl PairOperands {
    /// Those of an M or F stage; those of an I are 0.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let cycles = if stage.is_dense() { 0 } else { 2 };
        Self::from_parts(PairOperandsParts {
            dense: Constant::new(stage.is_dense()),
            flags_to_2: DelayOf::new(cycles),
            rows_to_2: DelayOf::new(cycles),
            first_to_4: DelayOf::new(cycles),
            aligns: Constant::new(stage.kind == Kind::F),
            two_rows: Constant::new(stage.reads_both_ports()),
        })
    }
}

impl Logic for PairOperands {
    #[kernel]
    fn update(&mut self) {
        self.flags_to_2.clock.next = self.clock.val();
        self.rows_to_2.clock.next = self.clock.val();
        self.first_to_4.clock.next = self.clock.val();

        // With the step, until what it read is there: bit 0 first, 1 valid, 2 a second valid, 3 window, 4 odd, 5 set.
        self.flags.next = (bit_cast::<6, 1>(self.set.val().into()) << 5)
            | (bit_cast::<6, 1>(self.odd.val().into()) << 4)
            | (bit_cast::<6, 1>(self.linear.val().into()) << 3)
            | (bit_cast::<6, 1>(self.valid_b.val().into()) << 2)
            | (bit_cast::<6, 1>(self.valid_a.val().into()) << 1)
            | bit_cast::<6, 1>(self.first.val().into());
        self.flags_to_2.data.next = self.flags.val();
        self.rows_to_2.data.next =
            (bit_cast::<24, 12>(self.base.val()) << 12) | bit_cast::<24, 12>(self.offset.val());

        // Cycle 3: the pair or pixel.
        self.pair_a.next = self.even_pair.val();
        self.pixel_a.next = self.pixels.val().get_bits::<16>(0);
        if self.flags_to_2.delayed.val().get_bit(4) {
            self.pair_a.next = self.odd_pair.val();
            self.pixel_a.next = self.pixels.val().get_bits::<16>(16);
        }
        self.value_a_3.d.next = self.pair_a.val().get_bits::<16>(0);
        self.value_b_3.d.next = self.odd_pair.val().get_bits::<16>(0);
        self.offset_a_3.d.next = bit_cast::<12, 9>(self.pair_a.val().get_bits::<9>(16));
        self.offset_b_3.d.next = bit_cast::<12, 9>(self.odd_pair.val().get_bits::<9>(16));
        self.shifts.next = self.shifts_0.val();
        if self.flags_to_2.delayed.val().get_bit(5) {
            self.shifts.next = self.shifts_1.val();
        }
        self.shift_3.d.next = self.shifts.val().get_bits::<4>(0);
        if self.flags_to_2.delayed.val().get_bit(3) {
            self.value_a_3.d.next = self.pixel_a.val();
            self.value_b_3.d.next = self.pixels.val().get_bits::<16>(16);
            self.offset_a_3.d.next = self.rows_to_2.delayed.val().get_bits::<12>(0);
            self.offset_b_3.d.next = self.rows_to_2.delayed.val().get_bits::<12>(0) | 1;
            self.shift_3.d.next = self.shifts.val().get_bits::<4>(4);
        }
        // Without work the row is one that there is, not what an unwritten pair says.
        if !self.flags_to_2.delayed.val().get_bit(1) {
            self.value_a_3.d.next = 0.into();
            self.offset_a_3.d.next = 0.into();
        }
        if !(self.two_rows.val() && self.flags_to_2.delayed.val().get_bit(2)) {
            self.value_b_3.d.next = 0.into();
            self.offset_b_3.d.next = 0.into();
        }
        self.base_3.d.next = self.rows_to_2.delayed.val().get_bits::<12>(12);

        // Cycle 4: aligned, and its row.
        self.wide_a.next = bit_cast::<25, 16>(self.value_a_3.q.val());
        if self.value_a_3.q.val().get_bit(15) {
            self.wide_a.next = bit_cast::<25, 16>(self.value_a_3.q.val()) | 0x1ff_0000;
        }
        self.wide_b.next = bit_cast::<25, 16>(self.value_b_3.q.val());
        if self.value_b_3.q.val().get_bit(15) {
            self.wide_b.next = bit_cast::<25, 16>(self.value_b_3.q.val()) | 0x1ff_0000;
        }
        self.value_a_4.d.next = self.wide_a.val();
        self.value_b_4.d.next = self.wide_b.val();
        if self.aligns.val() {
            self.value_a_4.d.next = self.wide_a.val() << self.shift_3.q.val();
            self.value_b_4.d.next = self.wide_b.val() << self.shift_3.q.val();
        }
        self.address_a_4.d.next = self.base_3.q.val() + self.offset_a_3.q.val();
        self.address_b_4.d.next = self.base_3.q.val() + self.offset_b_3.q.val();
        self.first_to_4.data.next = self.flags_to_2.delayed.val().get_bits::<1>(0);

        self.step_first.next = self.first_to_4.delayed.val().get_bit(0);
        self.address_a.next = self.address_a_4.q.val();
        self.address_b.next = self.address_b_4.q.val();
        self.value_a.next = self.value_a_4.q.val();
        self.value_b.next = self.value_b_4.q.val();
    }
}
