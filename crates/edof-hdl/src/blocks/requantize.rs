//! From a sum to a rounded word.

use super::delay::Delay;
use super::{Sum, Word};
use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// From a sum to a rounded word: saturate((sum + (base << base_shift) + half) >> result_shift), four cycles later.
/// half is 2^(result_shift - 1), or 0 for a shift of 0. Numbers are in two's complement; `most` and `least` bound the result.
#[derive(Circuit)]
#[circuit(default(Delay))]
pub struct Requantize {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Sum out of the multipliers.
    pub sum: Signal<In, Sum>,
    /// Base word of the same element.
    pub base: Signal<In, Word>,
    /// Its left shift.
    pub base_shift: Signal<In, Bits<6>>,
    /// Right shift of all.
    pub result_shift: Signal<In, Bits<6>>,
    /// Result.
    pub result: Signal<Out, Word>,
    /// Whether it did not fit.
    pub saturated: Signal<Out, Bit>,
    has_base: Constant<Bit>,
    one: Constant<Sum>,
    ones: Constant<Sum>,
    sign_bits: Constant<Sum>,
    most: Constant<Sum>,
    least: Constant<Sum>,
    sum_q: DFF<Sum>,
    aligned_q: DFF<Sum>,
    total_q: DFF<Sum>,
    shifted_q: DFF<Sum>,
    result_q: DFF<Word>,
    saturated_q: DFF<Bit>,
    shift_later: Delay<6, 2>,
    extended: Signal<Local, Sum>,
    half: Signal<Local, Sum>,
    fill: Signal<Local, Sum>,
}

impl Requantize {
    /// For results of `bits` bits, with or without a base.
    #[must_use]
    pub fn new(bits: u32, has_base: bool) -> Self {
        let most = (1u64 << (bits - 1)) - 1;
        let ones = (1u64 << 48) - 1;
        Self::from_parts(RequantizeParts {
            has_base: Constant::new(has_base),
            one: Constant::new(1.into()),
            ones: Constant::new(ones.into()),
            sign_bits: Constant::new((ones & !0xffff).into()),
            most: Constant::new(most.into()),
            least: Constant::new((ones & !most).into()),
        })
    }
}

impl Logic for Requantize {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, sum_q, aligned_q, total_q, shifted_q, result_q, saturated_q);
        self.shift_later.clock.next = self.clock.val();
        self.shift_later.now.next = self.result_shift.val();

        // Cycle 1: base and rounding term.
        self.extended.next = bit_cast::<48, 16>(self.base.val());
        if self.base.val().get_bit(15) {
            self.extended.next = bit_cast::<48, 16>(self.base.val()) | self.sign_bits.val();
        }
        self.half.next = (self.one.val() << self.result_shift.val()) >> 1;
        self.sum_q.d.next = self.sum.val();
        self.aligned_q.d.next = self.half.val();
        if self.has_base.val() {
            self.aligned_q.d.next = (self.extended.val() << self.base_shift.val()) + self.half.val();
        }

        // Cycle 2: the total.
        self.total_q.d.next = self.sum_q.q.val() + self.aligned_q.q.val();

        // Cycle 3: an arithmetic shift right, the sign filled in from above.
        self.fill.next = 0.into();
        if self.total_q.q.val().get_bit(47) {
            self.fill.next = !(self.ones.val() >> self.shift_later.later.val());
        }
        self.shifted_q.d.next = (self.total_q.q.val() >> self.shift_later.later.val()) | self.fill.val();

        // Cycle 4: saturation.
        self.result_q.d.next = self.shifted_q.q.val().get_bits::<16>(0);
        self.saturated_q.d.next = false;
        if self.shifted_q.q.val().get_bit(47) {
            if self.shifted_q.q.val() < self.least.val() {
                self.result_q.d.next = self.least.val().get_bits::<16>(0);
                self.saturated_q.d.next = true;
            }
        } else if self.shifted_q.q.val() > self.most.val() {
            self.result_q.d.next = self.most.val().get_bits::<16>(0);
            self.saturated_q.d.next = true;
        }

        self.result.next = self.result_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
