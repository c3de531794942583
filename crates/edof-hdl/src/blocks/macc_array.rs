//! All banks of a stage, their holding registers one chain.

use super::macc_bank::MaccBank;
use super::{Row, Sum};
use crate::describe::Circuit;
use edof_spec::FixedNetwork;
use edof_spec::design::{StagePlan, memory};
use rust_hdl::prelude::*;

/// All banks of a stage. Each sees the same addresses and values; copied sums are handed down the chain to bank 0.
#[derive(Circuit)]
pub struct MaccArray {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The step is the first of its pass.
    pub first: Signal<In, Bit>,
    /// Row of weights.
    pub address_a: Signal<In, Row>,
    /// Value.
    pub value_a: Signal<In, Bits<25>>,
    /// Row of weights for the second DSP.
    pub address_b: Signal<In, Row>,
    /// Its value.
    pub value_b: Signal<In, Bits<25>>,
    /// Copies the sums.
    pub copy: Signal<In, Bit>,
    /// Hands two on.
    pub shift: Signal<In, Bit>,
    /// The two that stand first.
    pub drain_even: Signal<Out, Sum>,
    /// The odd one.
    pub drain_odd: Signal<Out, Sum>,
    /// Writes half a row of one bank.
    pub write_enable: Signal<In, Bit>,
    /// Which bank.
    pub write_bank: Signal<In, Bits<6>>,
    /// Which half.
    pub write_half: Signal<In, Bit>,
    /// Row.
    pub write_row: Signal<In, Row>,
    /// Two weights.
    pub write_data: Signal<In, Bits<32>>,
    banks: Vec<MaccBank>,
    bank_ids: Vec<Constant<Bits<6>>>,
    _banks: usize,
}

impl MaccArray {
    /// The banks of a stage; the models hold the weights of both sets.
    #[must_use]
    pub fn new(stage: &StagePlan, sum_bits: u32, sets: [&FixedNetwork; 2]) -> Self {
        let words = |bank| sets.iter().flat_map(|n| memory::weight_words(n, stage, bank)).collect();
        Self::from_parts(MaccArrayParts {
            banks: (0..stage.banks()).map(|bank| MaccBank::new(stage, bank, sum_bits, words(bank))).collect(),
            bank_ids: (0..stage.banks() as u64).map(|bank| Constant::new(bank.into())).collect(),
            _banks: stage.banks(),
        })
    }
}

impl Logic for MaccArray {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..self._banks {
            self.banks[i].clock.next = self.clock.val();
            self.banks[i].first.next = self.first.val();
            self.banks[i].address_a.next = self.address_a.val();
            self.banks[i].value_a.next = self.value_a.val();
            self.banks[i].address_b.next = self.address_b.val();
            self.banks[i].value_b.next = self.value_b.val();
            self.banks[i].copy.next = self.copy.val();
            self.banks[i].shift.next = self.shift.val();
            self.banks[i].write_enable.next = self.write_enable.val();
            self.banks[i].bank.next = self.bank_ids[i].val();
            self.banks[i].write_bank.next = self.write_bank.val();
            self.banks[i].write_half.next = self.write_half.val();
            self.banks[i].write_row.next = self.write_row.val();
            self.banks[i].write_data.next = self.write_data.val();
        }
        for i in 0..(self._banks - 1) {
            self.banks[i].drain_even_in.next = self.banks[i + 1].drain_even.val();
            self.banks[i].drain_odd_in.next = self.banks[i + 1].drain_odd.val();
        }
        for i in (self._banks - 1)..self._banks {
            self.banks[i].drain_even_in.next = 0.into();
            self.banks[i].drain_odd_in.next = 0.into();
        }
        self.drain_even.next = self.banks[0].drain_even.val();
        self.drain_odd.next = self.banks[0].drain_odd.val();
    }
}
