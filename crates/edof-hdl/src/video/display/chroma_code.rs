//! A chroma word as a code.

use crate::blocks::Word;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// The code of a chroma word where the display shows luma only: rounded, clamped to 1 to 254, two cycles later.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct ChromaCode {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Word, in two's complement.
    pub word: Signal<In, Word>,
    /// Its code.
    pub code: Signal<Out, Bits<8>>,
    /// The code was clamped.
    pub clamped: Signal<Out, Bit>,
    rounded_1: DFF<Bits<17>>,
    code_2: DFF<Bits<8>>,
    clamped_2: DFF<Bit>,
    wide: Signal<Local, Bits<17>>,
}

impl Logic for ChromaCode {
    #[kernel]
    fn update(&mut self) {
        self.wide.next = bit_cast::<17, 16>(self.word.val());
        if self.word.val().get_bit(15) {
            self.wide.next = bit_cast::<17, 16>(self.word.val()) | 0x1_0000;
        }
        self.rounded_1.d.next = self.wide.val() + 64;
        self.code_2.d.next = self.rounded_1.q.val().get_bits::<8>(7) ^ 0x80;
        self.clamped_2.d.next = false;
        if self.rounded_1.q.val().get_bit(16) {
            if self.rounded_1.q.val().get_bits::<9>(7) <= 0x180 {
                self.code_2.d.next = 1.into();
                self.clamped_2.d.next = true;
            }
        } else if self.rounded_1.q.val().get_bits::<9>(7) > 126 {
            self.code_2.d.next = 254.into();
            self.clamped_2.d.next = true;
        }
        self.code.next = self.code_2.q.val();
        self.clamped.next = self.clamped_2.q.val();
    }
}
