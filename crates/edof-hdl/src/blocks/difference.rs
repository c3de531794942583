//! The change of one element of z.

use super::Word;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// The change of one element of z, saturated, three cycles later.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct Difference {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// z of this layer.
    pub current: Signal<In, Word>,
    /// z of the layer before.
    pub previous: Signal<In, Word>,
    /// `current` minus `previous`, clamped to the bits of a code.
    pub result: Signal<Out, Word>,
    /// The result did not fit and is clamped.
    pub saturated: Signal<Out, Bits<1>>,
    max: Constant<Bits<17>>,
    min: Constant<Bits<17>>,
    change_1: DFF<Bits<17>>,
    change_2: DFF<Word>,
    too_large: DFF<Bit>,
    too_small: DFF<Bit>,
    result_q: DFF<Word>,
    saturated_q: DFF<Bit>,
    wide_current: Signal<Local, Bits<17>>,
    wide_previous: Signal<Local, Bits<17>>,
}

impl Difference {
    /// For codes of `bits` bits.
    #[must_use]
    pub fn new(bits: u32) -> Self {
        let max = (1u64 << (bits - 1)) - 1;
        Self::from_parts(DifferenceParts {
            max: Constant::new(max.into()),
            min: Constant::new((0x1_ffff & !max).into()),
        })
    }
}

impl Logic for Difference {
    #[kernel]
    fn update(&mut self) {
        self.wide_current.next = bit_cast::<17, 16>(self.current.val());
        if self.current.val().get_bit(15) {
            self.wide_current.next = bit_cast::<17, 16>(self.current.val()) | 0x1_0000;
        }
        self.wide_previous.next = bit_cast::<17, 16>(self.previous.val());
        if self.previous.val().get_bit(15) {
            self.wide_previous.next = bit_cast::<17, 16>(self.previous.val()) | 0x1_0000;
        }
        self.change_1.d.next = self.wide_current.val() - self.wide_previous.val();

        self.change_2.d.next = self.change_1.q.val().get_bits::<16>(0);
        self.too_large.d.next =
            !self.change_1.q.val().get_bit(16) && (self.change_1.q.val() > self.max.val());
        self.too_small.d.next = self.change_1.q.val().get_bit(16) && (self.change_1.q.val() < self.min.val());

        self.result_q.d.next = self.change_2.q.val();
        if self.too_large.q.val() {
            self.result_q.d.next = self.max.val().get_bits::<16>(0);
        } else if self.too_small.q.val() {
            self.result_q.d.next = self.min.val().get_bits::<16>(0);
        }
        self.saturated_q.d.next = self.too_large.q.val() || self.too_small.q.val();

        self.result.next = self.result_q.q.val();
        self.saturated.next = self.saturated_q.q.val().into();
    }
}
