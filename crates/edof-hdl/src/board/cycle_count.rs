//! Cycles of a clock.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Cycles of a clock since its reset, modulo 2^32.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct CycleCount {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins at 0.
    pub reset: Signal<In, Bit>,
    /// How many.
    pub count: Signal<Out, Bits<32>>,
    #[reset(0)]
    count_q: DFF<Bits<32>>,
}

impl Logic for CycleCount {
    #[kernel]
    fn update(&mut self) {
        self.count_q.d.next = self.count_q.q.val() + 1;
        self.count.next = self.count_q.q.val();
    }
}
