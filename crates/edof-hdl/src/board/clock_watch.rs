//! Whether a clock runs.

use crate::crossing::Sync;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Whether another clock stands still: it is divided by sixteen and looked at. 4096 cycles without a change, and it does; so the other
/// clock must be faster than a five-hundredth of this one.
#[derive(Circuit)]
#[circuit(default(Sync))]
pub struct ClockWatch {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// What it is taken for at first.
    pub reset: Signal<In, Bit>,
    /// The other clock.
    pub watched: Signal<In, Clock>,
    /// Reset of its domain.
    pub watched_reset: Signal<In, Bit>,
    /// It stands still.
    pub stopped: Signal<Out, Bit>,
    divider: DFF<Bits<4>>,
    seen: Sync<1>,
    before: DFF<Bits<1>>,
    waited: DFF<Bits<12>>,
    stopped_q: DFF<Bit>,
    at_first: Constant<Bit>,
    waited_at_first: Constant<Bits<12>>,
}

impl ClockWatch {
    /// Of a clock that is taken to stand still, or to run, until it was looked at.
    #[must_use]
    pub fn new(stands_at_first: bool) -> Self {
        let waited: u64 = if stands_at_first { 0xfff } else { 0 };
        Self::from_parts(ClockWatchParts {
            at_first: Constant::new(stands_at_first),
            waited_at_first: Constant::new(waited.into()),
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
        self.seen.clock.next = self.clock.val();
        self.seen.from.next = self.divider.q.val().get_bits::<1>(3);

        dff_setup!(self, clock, before, waited, stopped_q);
        self.before.d.next = self.seen.to.val();
        if self.seen.to.val() != self.before.q.val() {
            self.waited.d.next = 0.into();
        } else if !self.waited.q.val().all() {
            self.waited.d.next = self.waited.q.val() + 1;
        }
        self.stopped_q.d.next = self.waited.q.val().all();
        self.stopped.next = self.stopped_q.q.val();
        if self.reset.val() {
            self.waited.d.next = self.waited_at_first.val();
            self.stopped_q.d.next = self.at_first.val();
        }
    }
}
