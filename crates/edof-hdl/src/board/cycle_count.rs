//! Cycles of a clock.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Cycles of a clock since its reset, modulo 2^32.
#[derive(Circuit)]
pub struct CycleCount {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins at 0.
    pub reset: Signal<In, Bit>,
    /// How many.
    pub count: Signal<Out, Bits<32>>,
    count_q: DFF<Bits<32>>,
}

impl Logic for CycleCount {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, count_q);
        self.count_q.d.next = self.count_q.q.val() + 1;
        if self.reset.val() {
            self.count_q.d.next = 0.into();
        }
        self.count.next = self.count_q.q.val();
    }
}
