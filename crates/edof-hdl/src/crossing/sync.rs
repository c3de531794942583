//! Leaf `edof_sync`: bits into another clock domain, each by itself.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// Two flip-flops per bit. A change arrives in the second or third cycle; bits that change together may arrive one cycle apart.
#[derive(Circuit)]
pub struct Sync<const W: usize> {
    /// Clock of the receiver.
    pub clock: Signal<In, Clock>,
    /// Straight from registers of another domain.
    pub from: Signal<In, Bits<W>>,
    /// Bits in the receiver's clock domain.
    pub to: Signal<Out, Bits<W>>,
    _first: Bits<W>,
}

impl<const W: usize> Default for Sync<W> {
    fn default() -> Self {
        Self::from_parts(SyncParts { _first: 0.into() })
    }
}

impl<const W: usize> Logic for Sync<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.to.next = self._first;
            self._first = self.from.val();
        }
    }

    fn connect(&mut self) {
        self.to.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_sync")
            .parameter("WIDTH", W)
            .port("clock_i", "clock")
            .port("from_i", "from")
            .port("to_o", "to")
            .verilog()
    }
}
