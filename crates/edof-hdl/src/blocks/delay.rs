//! Leaf `edof_delay`: a row of registers, the last of which is one of its own.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// What came in `N` cycles ago.
#[derive(Circuit)]
pub struct Delay<const W: usize, const N: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// In.
    pub now: Signal<In, Bits<W>>,
    /// Out.
    pub later: Signal<Out, Bits<W>>,
    _row: VecDeque<Bits<W>>,
}

impl<const W: usize, const N: usize> Default for Delay<W, N> {
    fn default() -> Self {
        Self::from_parts(DelayParts { _row: VecDeque::from(vec![Bits::default(); N]) })
    }
}

impl<const W: usize, const N: usize> Logic for Delay<W, N> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._row.push_back(self.now.val());
            self._row.pop_front();
        }
        self.later.next = self._row.front().copied().unwrap_or_default();
    }

    fn connect(&mut self) {
        self.later.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_delay")
            .parameter("WIDTH", W)
            .parameter("CYCLES", N)
            .port("clock_i", "clock")
            .port("now_i", "now")
            .port("later_o", "later")
            .verilog()
    }
}
