//! When sums are copied out of the multipliers and taken from the holding registers.

use super::delay::Delay;
use crate::describe::Circuit;
use edof_spec::design::{StagePlan, timing};
use rust_hdl::prelude::*;

/// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
/// A pass's sums stand ready five cycles after its last step and are copied once the drain of the pass before is over.
/// Credits bound what is on the way to the FIFO. The next pass may start unless its sums could meet those not yet copied.
#[derive(Circuit)]
#[circuit(default(Delay))]
pub struct Drain {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets everything; held for 16 cycles or more.
    pub reset: Signal<In, Bit>,
    /// The last step of a pass is issued.
    pub pass_issued: Signal<In, Bit>,
    /// Its vector's set.
    pub set: Signal<In, Bit>,
    /// A beat has left the stage.
    pub returned: Signal<In, Bit>,
    /// Whether the next pass may begin.
    pub may_start: Signal<Out, Bit>,
    /// Copies the sums of a pass.
    pub copy: Signal<Out, Bit>,
    /// Takes the next two sums.
    pub take: Signal<Out, Bit>,
    /// Which two of the vector they are.
    pub beat: Signal<Out, Bits<8>>,
    /// Whether they are its last.
    pub last: Signal<Out, Bit>,
    /// Its set.
    pub taken_set: Signal<Out, Bit>,
    last_take: Constant<Bits<8>>,
    last_beat: Constant<Bits<8>>,
    all_credits: Constant<Bits<5>>,
    on_the_way: Delay<2, 4>,
    sum_ready: DFF<Bit>,
    sum_set: DFF<Bit>,
    outstanding: DFF<Bits<2>>,
    active: DFF<Bit>,
    taken: DFF<Bits<8>>,
    beat_q: DFF<Bits<8>>,
    drain_set: DFF<Bit>,
    credits: DFF<Bits<5>>,
    arrives: Signal<Local, Bit>,
    copies: Signal<Local, Bit>,
    takes: Signal<Local, Bit>,
    passed: Signal<Local, Bits<2>>,
}

impl Drain {
    /// The drain of a stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        Self::from_parts(DrainParts {
            last_take: Constant::new((stage.drain_beats() as u64 - 1).into()),
            last_beat: Constant::new((stage.beats_out() as u64 - 1).into()),
            all_credits: Constant::new((timing::DRAIN_CREDITS as u64).into()),
        })
    }
}

impl Logic for Drain {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, sum_ready, sum_set, outstanding, active, taken, beat_q, drain_set, credits);
        self.on_the_way.clock.next = self.clock.val();

        self.passed.next = 0.into();
        if self.pass_issued.val() && self.set.val() {
            self.passed.next = 3.into();
        } else if self.pass_issued.val() {
            self.passed.next = 1.into();
        }
        self.on_the_way.now.next = self.passed.val();
        self.arrives.next = self.on_the_way.later.val().get_bit(0);
        self.copies.next = self.sum_ready.q.val() && !self.active.q.val();
        self.takes.next = self.active.q.val() && self.credits.q.val().any();

        if self.copies.val() {
            self.sum_ready.d.next = false;
            self.active.d.next = true;
            self.taken.d.next = 0.into();
            self.drain_set.d.next = self.sum_set.q.val();
        }
        if self.arrives.val() {
            self.sum_ready.d.next = true;
            self.sum_set.d.next = self.on_the_way.later.val().get_bit(1);
        }
        if self.pass_issued.val() && !self.copies.val() {
            self.outstanding.d.next = self.outstanding.q.val() + 1;
        } else if self.copies.val() && !self.pass_issued.val() {
            self.outstanding.d.next = self.outstanding.q.val() - 1;
        }
        if self.takes.val() {
            self.taken.d.next = self.taken.q.val() + 1;
            if self.taken.q.val() == self.last_take.val() {
                self.active.d.next = false;
            }
            self.beat_q.d.next = self.beat_q.q.val() + 1;
            if self.beat_q.q.val() == self.last_beat.val() {
                self.beat_q.d.next = 0.into();
            }
        }
        if self.takes.val() && !self.returned.val() {
            self.credits.d.next = self.credits.q.val() - 1;
        } else if self.returned.val() && !self.takes.val() {
            self.credits.d.next = self.credits.q.val() + 1;
        }

        self.may_start.next =
            (self.outstanding.q.val() == 0) || ((self.outstanding.q.val() == 1) && !self.active.q.val());
        self.copy.next = self.copies.val();
        self.take.next = self.takes.val();
        self.beat.next = self.beat_q.q.val();
        self.last.next = self.beat_q.q.val() == self.last_beat.val();
        self.taken_set.next = self.drain_set.q.val();

        if self.reset.val() {
            self.sum_ready.d.next = false;
            self.outstanding.d.next = 0.into();
            self.active.d.next = false;
            self.beat_q.d.next = 0.into();
            self.credits.d.next = self.all_credits.val();
        }
    }
}
