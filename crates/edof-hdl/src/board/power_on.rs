//! Leaf `edof_power_on`: the reset after configuration.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// Distinguishes the first reset from later ones, which must preserve what the host wrote: `first` is high from configuration until
/// `reset` falls for the first time.
#[derive(Circuit)]
pub struct PowerOn {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The domain's reset.
    pub reset: Signal<In, Bit>,
    /// The reset is the first one since configuration.
    pub first: Signal<Out, Bit>,
    _was: bool,
    _ended: bool,
}

impl Default for PowerOn {
    fn default() -> Self {
        Self::from_parts(PowerOnParts { _was: false, _ended: false })
    }
}

impl Logic for PowerOn {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._ended |= self._was && !self.reset.val();
            self._was = self.reset.val();
        }
        self.first.next = !self._ended;
    }

    fn connect(&mut self) {
        self.first.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_power_on")
            .port("clock_i", "clock")
            .port("reset_i", "reset")
            .port("first_o", "first")
            .verilog()
    }
}
