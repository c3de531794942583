//! Leaf `edof_scale`: one multiplication and one addition.

use super::{Factor, Wide};
use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// value × factor + addend in one DSP48E1, in two's complement: three cycles after value and factor, two after addend.
#[derive(Circuit)]
pub struct Scale {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Value.
    pub value: Signal<In, Factor>,
    /// Factor of `value`.
    pub factor: Signal<In, Factor>,
    /// What is added, a cycle later.
    pub addend: Signal<In, Wide>,
    /// The sum.
    pub sum: Signal<Out, Wide>,
    _factors: (i64, i64),
    _product: i64,
    _addend: i64,
    _sum: i64,
}

impl Default for Scale {
    fn default() -> Self {
        Self::from_parts(ScaleParts { _factors: (0, 0), _product: 0, _addend: 0, _sum: 0 })
    }
}

/// The low `bits` bits as two's complement.
const fn extend(word: u64, bits: u32) -> i64 {
    ((word << (64 - bits)) as i64) >> (64 - bits)
}

impl Logic for Scale {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._sum = self._product + self._addend;
            self._product = self._factors.0 * self._factors.1;
            self._addend = extend(self.addend.val().to_u64(), 48);
            self._factors = (extend(self.value.val().to_u64(), 18), extend(self.factor.val().to_u64(), 18));
        }
        self.sum.next = (self._sum as u64 & ((1 << 48) - 1)).into();
    }

    fn connect(&mut self) {
        self.sum.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_scale")
            .port("clock_i", "clock")
            .port("value_i", "value")
            .port("factor_i", "factor")
            .port("addend_i", "addend")
            .port("sum_o", "sum")
            .verilog()
    }
}
