//! Detects a stopped clock.

use crate::crossing::Sync;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Detects that another clock has stopped. The watched clock is divided by 16 and sampled. After 4096 cycles without an edge `stopped` is
/// set, so the watched clock must be faster than 1/500 of this one.
#[derive(Circuit)]
#[circuit(default(Sync))]
pub struct ClockWatch {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Restarts the measurement; `stopped` returns to its start value.
    pub reset: Signal<In, Bit>,
    /// The watched clock.
    pub watched: Signal<In, Clock>,
    /// Reset of the watched clock's domain.
    pub watched_reset: Signal<In, Bit>,
    /// The watched clock has stopped.
    pub stopped: Signal<Out, Bit>,
    divider: DFF<Bits<4>>,
    watched_sync: Sync<1>,
    previous: DFF<Bits<1>>,
    idle_cycles: DFF<Bits<12>>,
    stopped_q: DFF<Bit>,
    at_first: Constant<Bit>,
    idle_at_start: Constant<Bits<12>>,
}

impl ClockWatch {
    /// Of a clock that is taken to stand still, or to run, until it was looked at.
    #[must_use]
    pub fn new(stands_at_first: bool) -> Self {
        let idle_cycles: u64 = if stands_at_first { 0xfff } else { 0 };
        Self::from_parts(ClockWatchParts {
            at_first: Constant::new(stands_at_first),
            idle_at_start: Constant::new(idle_cycles.into()),
        })
    }
}

impl Logic for ClockWatch {
    #[kernel]
    fn update(&mut self) {
        self.divider.clock.next = self.watched.val();
        self.divider.d.next = self.divider.q.val() + 1;
        if self.watched_reset.val() {
            self.divider.d.next = 0.into();
        }
        self.watched_sync.clock.next = self.clock.val();
        self.watched_sync.from.next = self.divider.q.val().get_bits::<1>(3);

        dff_setup!(self, clock, previous, idle_cycles, stopped_q);
        self.previous.d.next = self.watched_sync.to.val();
        if self.watched_sync.to.val() != self.previous.q.val() {
            self.idle_cycles.d.next = 0.into();
        } else if !self.idle_cycles.q.val().all() {
            self.idle_cycles.d.next = self.idle_cycles.q.val() + 1;
        }
        self.stopped_q.d.next = self.idle_cycles.q.val().all();
        self.stopped.next = self.stopped_q.q.val();
        if self.reset.val() {
            self.idle_cycles.d.next = self.idle_at_start.val();
            self.stopped_q.d.next = self.at_first.val();
        }
    }
}
