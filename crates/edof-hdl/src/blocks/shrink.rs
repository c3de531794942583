//! The soft threshold of one element.

use super::Word;
use crate::describe::{Circuit, kernel};
use crate::verilog::Optional;
use edof_network::network::Shrinkage;
use rust_hdl::prelude::*;

/// The soft threshold of one element, three cycles later: sign(b) max(|b| - theta, 0) where two_sided, else max(b - theta, 0).
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct Shrink {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// b.
    pub code: Signal<In, Word>,
    /// θ.
    pub threshold: Signal<In, Word>,
    /// z.
    pub result: Signal<Out, Word>,
    /// The result did not fit and is clamped (a negative θ).
    pub saturated: Signal<Out, Bits<1>>,
    two_sided: Constant<Bit>,
    max: Constant<Bits<17>>,
    above_1: DFF<Bits<17>>,
    below_1: DFF<Bits<17>>,
    above_2: DFF<Word>,
    below_2: DFF<Word>,
    is_above: DFF<Bit>,
    is_below: DFF<Bit>,
    too_large: DFF<Bit>,
    result_q: DFF<Word>,
    saturated_q: DFF<Bit>,
    wide_code: Signal<Local, Bits<17>>,
    wide_threshold: Signal<Local, Bits<17>>,
    firm: Optional<FirmSide>,
}

impl Shrink {
    /// For codes of `bits` bits.
    #[must_use]
    pub fn new(shrinkage: Shrinkage, bits: u32) -> Self {
        let (two_sided, firm) = match shrinkage {
            Shrinkage::TwoSided => (true, false),
            Shrinkage::OneSided => (false, false),
            Shrinkage::Firm => (true, true),
        };
        Self::from_parts(ShrinkParts {
            two_sided: Constant::new(two_sided),
            max: Constant::new(((1u64 << (bits - 1)) - 1).into()),
            firm: Optional::when(firm, FirmSide::default),
        })
    }
}

/// Returns the LUTs and registers of a block beyond those of a soft threshold, which [`crate::resources`] counts.
#[must_use]
pub const fn extra_logic(shrinkage: Shrinkage) -> (usize, usize) {
    match shrinkage {
        Shrinkage::TwoSided | Shrinkage::OneSided => (0, 0),
        // Two adders and a wider choice; the code waits two cycles.
        Shrinkage::Firm => (54, 69),
    }
}

impl Logic for Shrink {
    #[kernel]
    fn update(&mut self) {
        // Cycle 1: how far it is from both ends of the dead zone.
        self.wide_code.next = bit_cast::<17, 16>(self.code.val());
        if self.code.val().get_bit(15) {
            self.wide_code.next = bit_cast::<17, 16>(self.code.val()) | 0x1_0000;
        }
        self.wide_threshold.next = bit_cast::<17, 16>(self.threshold.val());
        if self.threshold.val().get_bit(15) {
            self.wide_threshold.next = bit_cast::<17, 16>(self.threshold.val()) | 0x1_0000;
        }
        self.above_1.d.next = self.wide_code.val() - self.wide_threshold.val();
        self.below_1.d.next = self.wide_code.val() + self.wide_threshold.val();

        // Cycle 2: on which side it lies, and whether too far.
        self.above_2.d.next = self.above_1.q.val().get_bits::<16>(0);
        self.below_2.d.next = self.below_1.q.val().get_bits::<16>(0);
        self.is_above.d.next = self.above_1.q.val().any() && !self.above_1.q.val().get_bit(16);
        self.is_below.d.next = self.two_sided.val() && self.below_1.q.val().get_bit(16);
        self.too_large.d.next = self.above_1.q.val() > self.max.val();

        // Cycle 3: the result.
        self.result_q.d.next = 0.into();
        self.saturated_q.d.next = false;
        if self.is_above.q.val() {
            self.result_q.d.next = self.above_2.q.val();
            if self.too_large.q.val() {
                self.result_q.d.next = self.max.val().get_bits::<16>(0);
                self.saturated_q.d.next = true;
            }
        } else if self.is_below.q.val() {
            self.result_q.d.next = self.below_2.q.val();
        }
        for i in 0..self.firm.count() {
            self.firm[i].clock.next = self.clock.val();
            self.firm[i].code.next = self.code.val();
            self.firm[i].threshold.next = self.threshold.val();
            // What is left doubles, until the code is whole.
            if self.firm[i].whole.val() {
                self.result_q.d.next = self.firm[i].delayed.val();
            } else if self.is_above.q.val() {
                self.result_q.d.next = self.above_2.q.val() << 1;
            } else if self.is_below.q.val() {
                self.result_q.d.next = self.below_2.q.val() << 1;
            }
        }

        self.result.next = self.result_q.q.val();
        self.saturated.next = self.saturated_q.q.val().into();
    }
}

/// What the firm threshold asks beside the soft one: whether a code keeps its size, two cycles later.
#[derive(Circuit)]
#[circuit(registers(clock))]
pub struct FirmSide {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// b.
    pub code: Signal<In, Word>,
    /// θ, 0 or more.
    pub threshold: Signal<In, Word>,
    /// b, two cycles later.
    pub delayed: Signal<Out, Word>,
    /// |b| is at least 2θ, two cycles later.
    pub whole: Signal<Out, Bit>,
    code_1: DFF<Word>,
    code_2: DFF<Word>,
    above_1: DFF<Bits<18>>,
    below_1: DFF<Bits<18>>,
    whole_2: DFF<Bit>,
    wide_code: Signal<Local, Bits<18>>,
    twice: Signal<Local, Bits<18>>,
}

impl Logic for FirmSide {
    #[kernel]
    fn update(&mut self) {
        self.wide_code.next = bit_cast::<18, 16>(self.code.val());
        if self.code.val().get_bit(15) {
            self.wide_code.next = bit_cast::<18, 16>(self.code.val()) | 0x3_0000;
        }
        self.twice.next = bit_cast::<18, 16>(self.threshold.val()) << 1;
        self.above_1.d.next = self.wide_code.val() - self.twice.val();
        self.below_1.d.next = self.wide_code.val() + self.twice.val();
        self.whole_2.d.next = !self.above_1.q.val().get_bit(17) || self.below_1.q.val().get_bit(17);
        self.code_1.d.next = self.code.val();
        self.code_2.d.next = self.code_1.q.val();
        self.whole.next = self.whole_2.q.val();
        self.delayed.next = self.code_2.q.val();
    }
}
