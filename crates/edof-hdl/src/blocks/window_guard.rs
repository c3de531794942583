//! Whole windows only, whatever the `last` of a stream says.

use super::Pair;
use super::counters::Counter;
use crate::describe::{Circuit, kernel};
use edof_device::design::StagePlan;
use rust_hdl::prelude::*;

/// Passes whole windows only. A window whose `last` is early is filled with zeros, one beat per cycle. If `last` is late, the excess
/// beats are discarded. Both kinds are counted, and the beat after `last` is the first of the next window. A correct window passes
/// within the cycle.
#[derive(Circuit)]
#[circuit(default(Counter), registers(clock, reset))]
pub struct WindowGuard {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Waits for a window's first beat.
    pub reset: Signal<In, Bit>,
    /// Counters back to zero.
    pub reset_counters: Signal<In, Bit>,
    /// The input beat is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two pixels of the beat, the left one low.
    pub data: Signal<In, Pair>,
    /// The sender marks the beat as the last of its window.
    pub last: Signal<In, Bit>,
    /// The set of weights for this window.
    pub set: Signal<In, Bit>,
    /// The output beat is valid.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Two pixels of the beat, the left one low.
    pub out_data: Signal<Out, Pair>,
    /// The beat is the last of its window.
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
    #[reset(0)]
    beat: DFF<Bits<7>>,
    #[reset(false)]
    at_end: DFF<Bit>,
    #[reset(false)]
    fill: DFF<Bit>,
    #[reset(false)]
    drop: DFF<Bit>,
    set_q: DFF<Bit>,
    fault_q: DFF<Bit>,
    #[reset(false)]
    short_q: DFF<Bit>,
    #[reset(false)]
    long_q: DFF<Bit>,
    count_short: Counter,
    count_long: Counter,
    is_available: Signal<Local, Bit>,
    advance: Signal<Local, Bit>,
    accept: Signal<Local, Bit>,
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
        self.count_short.clock.next = self.clock.val();
        self.count_long.clock.next = self.clock.val();

        self.is_available.next = self.fill.q.val() || (self.valid.val() && !self.drop.q.val());
        self.advance.next = self.is_available.val() && self.out_ready.val();
        self.accept.next = self.advance.val() && !self.fill.q.val();
        self.ready.next = self.drop.q.val() || (self.out_ready.val() && !self.fill.q.val());
        self.out_valid.next = self.is_available.val();
        self.out_data.next = self.data.val();
        self.out_set.next = self.set.val();
        if self.fill.q.val() {
            self.out_data.next = 0.into();
            self.out_set.next = self.set_q.q.val();
        }
        self.out_last.next = self.at_end.q.val();

        self.short_q.d.next = false;
        self.long_q.d.next = false;
        if self.advance.val() {
            self.beat.d.next = self.beat.q.val() + 1;
            self.at_end.d.next = self.beat.q.val() == self.before_last.val();
            if self.at_end.q.val() {
                self.beat.d.next = 0.into();
                self.fill.d.next = false;
            }
        }
        if self.accept.val() {
            self.set_q.d.next = self.set.val();
            self.fill.d.next = self.last.val() && !self.at_end.q.val();
            self.short_q.d.next = self.last.val() && !self.at_end.q.val();
            self.drop.d.next = self.at_end.q.val() && !self.last.val();
            self.long_q.d.next = self.at_end.q.val() && !self.last.val();
        }
        if self.drop.q.val() && self.valid.val() && self.last.val() {
            self.drop.d.next = false;
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

        if self.reset_counters.val() || self.snapshot.val() {
            self.fault_q.d.next = false;
        }
    }
}
