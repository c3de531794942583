//! Leaf `edof_macc_bank`: four lanes of multipliers and the weight memory that they share.

use super::{Row, Sum};
use crate::describe::Circuit;
use crate::leaf::Leaf;
use edof_spec::design::{BANK_LANES, StagePlan, memory};
use rust_hdl::prelude::*;

/// Adds weight × value to four sums a cycle; see `rtl/edof_macc_bank.v` for the exact cycles.
#[derive(Circuit)]
pub struct MaccBank {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Starts the sums anew with this product.
    pub first: Signal<In, Bit>,
    /// Row of weights.
    pub address_a: Signal<In, Row>,
    /// Value; 0 where there is no work.
    pub value_a: Signal<In, Bits<25>>,
    /// Row of weights for the second DSP of each lane.
    pub address_b: Signal<In, Row>,
    /// Its value.
    pub value_b: Signal<In, Bits<25>>,
    /// Copies the sums to the holding registers in the next cycle.
    pub copy: Signal<In, Bit>,
    /// Hands two sums on in the next cycle.
    pub shift: Signal<In, Bit>,
    /// Sums handed on by the next bank.
    pub drain_even_in: Signal<In, Sum>,
    /// The odd one.
    pub drain_odd_in: Signal<In, Sum>,
    /// Sums that stand first.
    pub drain_even: Signal<Out, Sum>,
    /// The odd one.
    pub drain_odd: Signal<Out, Sum>,
    /// Writes half a row of one bank.
    pub write_enable: Signal<In, Bit>,
    /// Which bank this is.
    pub bank: Signal<In, Bits<6>>,
    /// Which bank is meant.
    pub write_bank: Signal<In, Bits<6>>,
    /// Which half: lanes 0 and 1, or 2 and 3.
    pub write_half: Signal<In, Bit>,
    /// Row.
    pub write_row: Signal<In, Row>,
    /// Two weights.
    pub write_data: Signal<In, Bits<32>>,
    _sizes: Sizes,
    _state: State,
}

#[derive(Debug, Clone)]
struct Sizes {
    depth: usize,
    rows: usize,
    sum_bits: u32,
    image: String,
}

/// Registers of the model, named for the cycle after the inputs in which they hold.
#[derive(Debug, Clone, Default)]
struct State {
    weights: Vec<u64>,
    copy: bool,
    shift: bool,
    first: [bool; 3],
    rows: [u64; 2],
    values: [i64; 2],
    factors: [[(i64, i64); BANK_LANES]; 2],
    products: [[i64; BANK_LANES]; 2],
    sums: [[i64; BANK_LANES]; 2],
    hold: [i64; BANK_LANES],
}

impl MaccBank {
    /// Bank `bank` of a stage; the model starts with both sets of `weights` (words of [`memory::weight_words`]).
    #[must_use]
    pub fn new(stage: &StagePlan, bank: usize, sum_bits: u32, weights: Vec<u64>) -> Self {
        let image = memory::weight_image(stage, bank);
        Self::from_parts(MaccBankParts {
            _sizes: Sizes { depth: stage.weight_depth(), rows: stage.rows, sum_bits, image },
            _state: State { weights, ..State::default() },
        })
    }

    fn step(&mut self) {
        let (sizes, old) = (&self._sizes, self._state.clone());
        let new = &mut self._state;
        let row = |address: Row| old.weights.get(address.to_u64() as usize).copied().unwrap_or(0);
        new.copy = self.copy.val();
        new.shift = self.shift.val();
        new.first = [self.first.val(), old.first[0], old.first[1]];
        new.rows = [row(self.address_a.val()), row(self.address_b.val())];
        new.values = [self.value_a.val(), self.value_b.val()].map(|v| extend(v.to_u64(), 25));
        for dsp in 0..sizes.rows {
            for lane in 0..BANK_LANES {
                let weight = extend(old.rows[dsp] >> (16 * lane), 16);
                new.factors[dsp][lane] = (weight, old.values[dsp]);
                let (weight, value) = old.factors[dsp][lane];
                new.products[dsp][lane] = weight * value;
                let sum = if old.first[2] { 0 } else { old.sums[dsp][lane] };
                new.sums[dsp][lane] = wrap(sum + old.products[dsp][lane], 48);
            }
        }
        if old.copy {
            new.hold =
                std::array::from_fn(|lane| wrap(old.sums[0][lane] + old.sums[1][lane], sizes.sum_bits));
        } else if old.shift {
            let next = [self.drain_even_in.val(), self.drain_odd_in.val()];
            let next = next.map(|sum| wrap(extend(sum.to_u64(), 48), sizes.sum_bits));
            new.hold = [old.hold[2], old.hold[3], next[0], next[1]];
        }
        if self.write_enable.val() && self.write_bank.val() == self.bank.val() {
            let shift = if self.write_half.val() { 32 } else { 0 };
            if let Some(word) = new.weights.get_mut(self.write_row.val().to_u64() as usize) {
                *word = (*word & !(0xffff_ffff << shift)) | (self.write_data.val().to_u64() << shift);
            }
        }
    }
}

/// The low `bits` bits as two's complement.
const fn extend(word: u64, bits: u32) -> i64 {
    ((word << (64 - bits)) as i64) >> (64 - bits)
}

/// A sum that has `bits` bits.
const fn wrap(sum: i64, bits: u32) -> i64 {
    extend(sum as u64, bits)
}

impl Logic for MaccBank {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.step();
        }
        let low = |sum: i64| (sum as u64 & ((1 << 48) - 1)).into();
        self.drain_even.next = low(self._state.hold[0]);
        self.drain_odd.next = low(self._state.hold[1]);
    }

    fn connect(&mut self) {
        self.drain_even.connect();
        self.drain_odd.connect();
    }

    fn hdl(&self) -> Verilog {
        Leaf::new("edof_macc_bank")
            .parameter("DEPTH", self._sizes.depth)
            .parameter("ROWS", self._sizes.rows)
            .parameter("SUM", self._sizes.sum_bits as usize)
            .text("INIT", &self._sizes.image)
            .port("clock_i", "clock")
            .port("first_i", "first")
            .port("address_a_i", "address_a")
            .port("value_a_i", "value_a")
            .port("address_b_i", "address_b")
            .port("value_b_i", "value_b")
            .port("copy_i", "copy")
            .port("shift_i", "shift")
            .port("drain_even_i", "drain_even_in")
            .port("drain_odd_i", "drain_odd_in")
            .port("drain_even_o", "drain_even")
            .port("drain_odd_o", "drain_odd")
            .port("write_enable_i", "write_enable")
            .port("bank_i", "bank")
            .port("write_bank_i", "write_bank")
            .port("write_half_i", "write_half")
            .port("write_address_i", "write_row")
            .port("write_data_i", "write_data")
            .verilog()
    }
}
