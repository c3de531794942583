//! Leaf `edof_reset_sync`: the reset of a clock domain.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// Cycles for which a domain's reset stays high after the request fell: what pipelines need to run dry, and more than any
/// synchroniser needs to forget.
pub const RESET_CYCLES: usize = 64;

/// High as soon as the clock runs and `reset` was high; low again [`RESET_CYCLES`] and two cycles after `reset` fell.
#[derive(Circuit)]
pub struct ResetSync {
    /// Clock of the domain.
    pub clock: Signal<In, Clock>,
    /// The request, of any domain or none.
    pub reset: Signal<In, Bit>,
    /// The domain's reset.
    pub domain_reset: Signal<Out, Bit>,
    _caught: [bool; 2],
    _held: usize,
}

impl Default for ResetSync {
    fn default() -> Self {
        Self::from_parts(ResetSyncParts { _caught: [true; 2], _held: RESET_CYCLES })
    }
}

impl Logic for ResetSync {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._held = if self._caught[1] { RESET_CYCLES } else { self._held.saturating_sub(1) };
            self._caught = [false, self._caught[0]];
        }
        if self.reset.val() {
            self._caught = [true; 2];
        }
        self.domain_reset.next = self._held > 0;
    }

    fn connect(&mut self) {
        self.domain_reset.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_reset_sync")
            .parameter("CYCLES", RESET_CYCLES)
            .port("clock_i", "clock")
            .port("reset_i", "reset")
            .port("reset_o", "domain_reset")
            .verilog()
    }
}
