//! Leaf `edof_ddr_out`: two bits per cycle to each pin.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// Two bits per cycle to each pin: `first` while the clock is high, `second` while it is low, from the third rising edge on after they came.
#[derive(Circuit)]
pub struct DdrOut<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// What the pins are while the clock is high.
    pub first: Signal<In, Bits<W>>,
    /// What they are while it is low.
    pub second: Signal<In, Bits<W>>,
    /// The pins.
    pub pins: Signal<Out, Bits<W>>,
    _pairs: [[Bits<W>; 2]; 3],
    _is_high: bool,
}

impl<const W: usize> Default for DdrOut<W> {
    fn default() -> Self {
        Self::from_parts(DdrOutParts { _pairs: [[0.into(); 2]; 3], _is_high: false })
    }
}

impl<const W: usize> Logic for DdrOut<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._pairs = [[self.first.val(), self.second.val()], self._pairs[0], self._pairs[1]];
            self._is_high = true;
        } else if self.clock.neg_edge() {
            self._is_high = false;
        }
        self.pins.next = self._pairs[2][usize::from(!self._is_high)];
    }

    fn connect(&mut self) {
        self.pins.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_ddr_out")
            .parameter("WIDTH", W)
            .port("clock_i", "clock")
            .port("first_i", "first")
            .port("second_i", "second")
            .port("pins_o", "pins")
            .verilog()
    }
}
