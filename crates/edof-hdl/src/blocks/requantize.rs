//! From a sum to a rounded word.

use super::add::Add;
use super::delay::Delay;
use super::{Sum, Word};
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), ten cycles later.
/// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement. Shifts are made in two cycles each, by less
/// than eight and by eights; additions in two, half by half; what does not fit is known a cycle before it is replaced.
#[derive(Circuit)]
#[circuit(default(Delay, Add), registers(clock))]
pub struct Requantize {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Sum out of the multipliers.
    pub sum: Signal<In, Sum>,
    /// Base word of the same element.
    pub base: Signal<In, Word>,
    /// Left shift of the base word.
    pub base_shift: Signal<In, Bits<6>>,
    /// Right shift of all.
    pub result_shift: Signal<In, Bits<6>>,
    /// Result.
    pub result: Signal<Out, Word>,
    /// The result did not fit and is clamped.
    pub saturated: Signal<Out, Bit>,
    base_bits: Constant<Sum>,
    one: Constant<Sum>,
    ones: Constant<Sum>,
    sign_bits: Constant<Sum>,
    beyond: Constant<Sum>,
    max: Constant<Word>,
    min: Constant<Word>,
    sum_to_4: Delay<48, 4>,
    shift_to_6: Delay<6, 6>,
    fine_1: DFF<Sum>,
    coarse_to_1: Delay<6, 1>,
    half_1: DFF<Sum>,
    aligned_2: DFF<Sum>,
    half_2: DFF<Sum>,
    with_half: Add,
    total: Add,
    fine_7: DFF<Sum>,
    coarse_7: DFF<Bits<6>>,
    shifted_8: DFF<Sum>,
    result_9: DFF<Word>,
    too_large: DFF<Bit>,
    too_small: DFF<Bit>,
    result_q: DFF<Word>,
    saturated_q: DFF<Bit>,
    extended: Signal<Local, Sum>,
    fine_fill: Signal<Local, Sum>,
    coarse_fill: Signal<Local, Sum>,
    outside: Signal<Local, Sum>,
}

impl Requantize {
    /// For results of `bits` bits, with or without a base.
    #[must_use]
    pub fn new(bits: u32, has_base: bool) -> Self {
        let max = (1u64 << (bits - 1)) - 1;
        let ones = (1u64 << 48) - 1;
        Self::from_parts(RequantizeParts {
            base_bits: Constant::new(if has_base { ones } else { 0 }.into()),
            one: Constant::new(1.into()),
            ones: Constant::new(ones.into()),
            sign_bits: Constant::new((ones & !0xffff).into()),
            beyond: Constant::new((ones & !max).into()),
            max: Constant::new(max.into()),
            min: Constant::new((0xffff & !max).into()),
        })
    }
}

impl Logic for Requantize {
    #[kernel]
    fn update(&mut self) {
        self.sum_to_4.clock.next = self.clock.val();
        self.coarse_to_1.clock.next = self.clock.val();
        self.shift_to_6.clock.next = self.clock.val();
        self.with_half.clock.next = self.clock.val();
        self.total.clock.next = self.clock.val();

        // Cycles 1 and 2: the base to its place; the rounding term.
        self.extended.next = bit_cast::<48, 16>(self.base.val());
        if self.base.val().get_bit(15) {
            self.extended.next = bit_cast::<48, 16>(self.base.val()) | self.sign_bits.val();
        }
        self.fine_1.d.next = self.extended.val() << (self.base_shift.val() & 7);
        self.coarse_to_1.data.next = self.base_shift.val() & 0x38;
        self.half_1.d.next = (self.one.val() << self.result_shift.val()) >> 1;
        self.aligned_2.d.next =
            (self.fine_1.q.val() << self.coarse_to_1.delayed.val()) & self.base_bits.val();
        self.half_2.d.next = self.half_1.q.val();

        // Cycles 3 to 6: the total.
        self.with_half.a.next = self.aligned_2.q.val();
        self.with_half.b.next = self.half_2.q.val();
        self.sum_to_4.data.next = self.sum.val();
        self.total.a.next = self.sum_to_4.delayed.val();
        self.total.b.next = self.with_half.sum.val();

        // Cycles 7 and 8: an arithmetic shift right, the sign filled in from above.
        self.shift_to_6.data.next = self.result_shift.val();
        self.fine_fill.next = 0.into();
        if self.total.sum.val().get_bit(47) {
            self.fine_fill.next = !(self.ones.val() >> (self.shift_to_6.delayed.val() & 7));
        }
        self.fine_7.d.next =
            (self.total.sum.val() >> (self.shift_to_6.delayed.val() & 7)) | self.fine_fill.val();
        self.coarse_7.d.next = self.shift_to_6.delayed.val() & 0x38;
        self.coarse_fill.next = 0.into();
        if self.fine_7.q.val().get_bit(47) {
            self.coarse_fill.next = !(self.ones.val() >> self.coarse_7.q.val());
        }
        self.shifted_8.d.next = (self.fine_7.q.val() >> self.coarse_7.q.val()) | self.coarse_fill.val();

        // Cycles 9 and 10: saturation. In a value that fits, all bits from the sign bit on are equal.
        self.outside.next = self.shifted_8.q.val() & self.beyond.val();
        if self.shifted_8.q.val().get_bit(47) {
            self.outside.next = !self.shifted_8.q.val() & self.beyond.val();
        }
        self.result_9.d.next = self.shifted_8.q.val().get_bits::<16>(0);
        self.too_large.d.next = self.outside.val().any() && !self.shifted_8.q.val().get_bit(47);
        self.too_small.d.next = self.outside.val().any() && self.shifted_8.q.val().get_bit(47);
        self.result_q.d.next = self.result_9.q.val();
        if self.too_large.q.val() {
            self.result_q.d.next = self.max.val();
        } else if self.too_small.q.val() {
            self.result_q.d.next = self.min.val();
        }
        self.saturated_q.d.next = self.too_large.q.val() || self.too_small.q.val();

        self.result.next = self.result_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
