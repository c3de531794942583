//! Leaf `edof_add`: a sum in two cycles, so that no carry runs through more than half of it.

use super::Sum;
use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// `a + b` two cycles later.
#[derive(Circuit)]
pub struct Add {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// First summand.
    pub a: Signal<In, Sum>,
    /// The other.
    pub b: Signal<In, Sum>,
    /// Sum of `a` and `b`, in two's complement.
    pub sum: Signal<Out, Sum>,
    _row: [Sum; 2],
}

impl Default for Add {
    fn default() -> Self {
        Self::from_parts(AddParts { _row: [0.into(); 2] })
    }
}

impl Logic for Add {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._row = [self.a.val() + self.b.val(), self._row[0]];
        }
        self.sum.next = self._row[1];
    }

    fn connect(&mut self) {
        self.sum.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_add")
            .port("clock_i", "clock")
            .port("a_i", "a")
            .port("b_i", "b")
            .port("sum_o", "sum")
            .verilog()
    }
}
