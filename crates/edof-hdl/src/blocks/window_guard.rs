//! Whole windows only, whatever the `last` of a stream says.

use super::Pair;
use super::counters::Counter;
use crate::describe::{Circuit, kernel};
use edof_device::design::StagePlan;
use rust_hdl::prelude::*;

/// Hands on whole windows only. One whose `last` comes too early is filled up with zeros, a beat a cycle; of one whose `last` comes
/// too late the rest is thrown away. Each is counted, and the beat after its `last` is the first of the next window. A window that is
/// right passes within the cycle.
#[derive(Circuit)]
#[circuit(default(Counter))]
pub struct WindowGuard {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Waits for a window's first beat.
    pub reset: Signal<In, Bit>,
    /// Counters back to zero.
    pub reset_counters: Signal<In, Bit>,
    /// A beat stands on the input.
    pub valid: Signal<In, Bit>,
    /// It is taken in this cycle, if there is one.
    pub ready: Signal<Out, Bit>,
    /// Its two pixels.
    pub data: Signal<In, Pair>,
    /// Whether the sender says that it is its window's last.
    pub last: Signal<In, Bit>,
    /// The set of weights for this window.
    pub set: Signal<In, Bit>,
    /// A beat stands on the output.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver takes it.
    pub out_ready: Signal<In, Bit>,
    /// Its two pixels.
    pub out_data: Signal<Out, Pair>,
    /// Whether it is its window's last.
    pub out_last: Signal<Out, Bit>,
    /// The window's set.
    pub out_set: Signal<Out, Bit>,
    /// Whether a window was too short or too long since the last reset or snapshot.
    pub fault: Signal<Out, Bit>,
    /// Copies the counters to be shown, and starts them anew.
    pub snapshot: Signal<In, Bit>,
    /// Windows that were too short, as copied.
    pub too_short: Signal<Out, Bits<32>>,
    /// Windows that were too long.
    pub too_long: Signal<Out, Bits<32>>,
    before_last: Constant<Bits<7>>,
    beat: DFF<Bits<7>>,
    at_end: DFF<Bit>,
    fills: DFF<Bit>,
    drops: DFF<Bit>,
    set_q: DFF<Bit>,
    fault_q: DFF<Bit>,
    short_q: DFF<Bit>,
    long_q: DFF<Bit>,
    count_short: Counter,
    count_long: Counter,
    offers: Signal<Local, Bit>,
    passes: Signal<Local, Bit>,
    comes: Signal<Local, Bit>,
}

impl WindowGuard {
    /// Before stage I.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        Self::from_parts(WindowGuardParts {
            before_last: Constant::new((stage.beats_in() as u64 - 2).into()),
        })
    }
}

impl Logic for WindowGuard {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, beat, at_end, fills, drops, set_q, fault_q, short_q, long_q);
        self.count_short.clock.next = self.clock.val();
        self.count_long.clock.next = self.clock.val();

        self.offers.next = self.fills.q.val() || (self.valid.val() && !self.drops.q.val());
        self.passes.next = self.offers.val() && self.out_ready.val();
        self.comes.next = self.passes.val() && !self.fills.q.val();
        self.ready.next = self.drops.q.val() || (self.out_ready.val() && !self.fills.q.val());
        self.out_valid.next = self.offers.val();
        self.out_data.next = self.data.val();
        self.out_set.next = self.set.val();
        if self.fills.q.val() {
            self.out_data.next = 0.into();
            self.out_set.next = self.set_q.q.val();
        }
        self.out_last.next = self.at_end.q.val();

        self.short_q.d.next = false;
        self.long_q.d.next = false;
        if self.passes.val() {
            self.beat.d.next = self.beat.q.val() + 1;
            self.at_end.d.next = self.beat.q.val() == self.before_last.val();
            if self.at_end.q.val() {
                self.beat.d.next = 0.into();
                self.fills.d.next = false;
            }
        }
        if self.comes.val() {
            self.set_q.d.next = self.set.val();
            self.fills.d.next = self.last.val() && !self.at_end.q.val();
            self.short_q.d.next = self.last.val() && !self.at_end.q.val();
            self.drops.d.next = self.at_end.q.val() && !self.last.val();
            self.long_q.d.next = self.at_end.q.val() && !self.last.val();
        }
        if self.drops.q.val() && self.valid.val() && self.last.val() {
            self.drops.d.next = false;
        }
        self.fault_q.d.next = self.fault_q.q.val() || self.short_q.q.val() || self.long_q.q.val();

        self.count_short.enable.next = self.short_q.q.val();
        self.count_short.events.next = 1.into();
        self.count_short.reset.next = self.reset_counters.val();
        self.count_short.snapshot.next = self.snapshot.val();
        self.count_long.enable.next = self.long_q.q.val();
        self.count_long.events.next = 1.into();
        self.count_long.reset.next = self.reset_counters.val();
        self.count_long.snapshot.next = self.snapshot.val();
        self.too_short.next = self.count_short.count.val();
        self.too_long.next = self.count_long.count.val();
        self.fault.next = self.fault_q.q.val();

        if self.reset.val() {
            self.beat.d.next = 0.into();
            self.at_end.d.next = false;
            self.fills.d.next = false;
            self.drops.d.next = false;
            self.short_q.d.next = false;
            self.long_q.d.next = false;
        }
        if self.reset_counters.val() || self.snapshot.val() {
            self.fault_q.d.next = false;
        }
    }
}
