//! The soft threshold of one element.

use super::Word;
use crate::describe::Circuit;
use edof_spec::network::Shrinkage;
use rust_hdl::prelude::*;

/// The soft threshold of one element, a cycle later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
#[derive(Circuit)]
pub struct Shrink {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// b.
    pub code: Signal<In, Word>,
    /// θ.
    pub threshold: Signal<In, Word>,
    /// z.
    pub result: Signal<Out, Word>,
    /// Whether it did not fit (a negative θ).
    pub saturated: Signal<Out, Bit>,
    two_sided: Constant<Bit>,
    most: Constant<Bits<17>>,
    result_q: DFF<Word>,
    saturated_q: DFF<Bit>,
    wide_code: Signal<Local, Bits<17>>,
    wide_threshold: Signal<Local, Bits<17>>,
    above: Signal<Local, Bits<17>>,
    below: Signal<Local, Bits<17>>,
}

impl Shrink {
    /// For codes of `bits` bits.
    #[must_use]
    pub fn new(shrinkage: Shrinkage, bits: u32) -> Self {
        Self::from_parts(ShrinkParts {
            two_sided: Constant::new(shrinkage == Shrinkage::TwoSided),
            most: Constant::new(((1u64 << (bits - 1)) - 1).into()),
        })
    }
}

impl Logic for Shrink {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, result_q, saturated_q);

        self.wide_code.next = bit_cast::<17, 16>(self.code.val());
        if self.code.val().get_bit(15) {
            self.wide_code.next = bit_cast::<17, 16>(self.code.val()) | 0x1_0000;
        }
        self.wide_threshold.next = bit_cast::<17, 16>(self.threshold.val());
        if self.threshold.val().get_bit(15) {
            self.wide_threshold.next = bit_cast::<17, 16>(self.threshold.val()) | 0x1_0000;
        }
        self.above.next = self.wide_code.val() - self.wide_threshold.val();
        self.below.next = self.wide_code.val() + self.wide_threshold.val();

        self.result_q.d.next = 0.into();
        self.saturated_q.d.next = false;
        if self.above.val().any() && !self.above.val().get_bit(16) {
            self.result_q.d.next = self.above.val().get_bits::<16>(0);
            if self.above.val() > self.most.val() {
                self.result_q.d.next = self.most.val().get_bits::<16>(0);
                self.saturated_q.d.next = true;
            }
        } else if self.two_sided.val() && self.below.val().get_bit(16) {
            self.result_q.d.next = self.below.val().get_bits::<16>(0);
        }

        self.result.next = self.result_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
