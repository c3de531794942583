//! Leaf `edof_delay`: a row of registers, the last of which is one of its own.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// The input of `N` cycles ago.
#[derive(Circuit)]
pub struct Delay<const W: usize, const N: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Input.
    pub data: Signal<In, Bits<W>>,
    /// Input, N cycles later.
    pub delayed: Signal<Out, Bits<W>>,
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
            self._row.push_back(self.data.val());
            self._row.pop_front();
        }
        self.delayed.next = self._row.front().copied().unwrap_or_default();
    }

    fn connect(&mut self) {
        self.delayed.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_delay")
            .parameter("WIDTH", W)
            .parameter("CYCLES", N)
            .port("clock_i", "clock")
            .port("data_i", "data")
            .port("data_o", "delayed")
            .verilog()
    }
}

/// A [`Delay`] whose length the design decides. One of 0 cycles has no registers, and its output is 0.
#[derive(Circuit)]
pub struct DelayOf<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Input.
    pub data: Signal<In, Bits<W>>,
    /// Input, N cycles later.
    pub delayed: Signal<Out, Bits<W>>,
    _row: VecDeque<Bits<W>>,
}

impl<const W: usize> DelayOf<W> {
    /// A delay of `cycles` cycles.
    #[must_use]
    pub fn new(cycles: usize) -> Self {
        Self::from_parts(DelayOfParts { _row: VecDeque::from(vec![Bits::default(); cycles]) })
    }
}

impl<const W: usize> Logic for DelayOf<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._row.push_back(self.data.val());
            self._row.pop_front();
        }
        self.delayed.next = self._row.front().copied().unwrap_or_default();
    }

    fn connect(&mut self) {
        self.delayed.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_delay")
            .parameter("WIDTH", W)
            .parameter("CYCLES", self._row.len())
            .port("clock_i", "clock")
            .port("data_i", "data")
            .port("data_o", "delayed")
            .verilog()
    }
}
