//! When sums are copied out of the multipliers and taken from the holding registers.

use super::delay::Delay;
use super::{Whole, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::{StagePlan, timing};
use rust_hdl::prelude::*;

/// When sums are copied out of the multipliers, and when the copies are taken, two a cycle.
/// A pass's sums stand ready seven cycles after its last step and are copied with the last take of the drain before, or later. A drain
/// begins when all that it takes has room in the FIFO, and then takes in every cycle, two times at least. Two passes may be between
/// their start and their release: the next one's sums come so late that a drain may still have some takes to go.
/// Copy and take leave a cycle after they are decided.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct Drain {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets everything; held for 48 cycles or more.
    pub reset: Signal<In, Bit>,
    /// The last step of a pass is issued.
    pub pass_issued: Signal<In, Bit>,
    /// Set of the vector of that pass.
    pub set: Signal<In, Bit>,
    /// A beat has left the stage.
    pub credit_return: Signal<In, Bit>,
    /// A pass is released: its sums are taken, or will be before the sums of the next pass but one come.
    pub release: Signal<Out, Bit>,
    /// Copies the sums of a pass.
    pub copy: Signal<Out, Bit>,
    /// Takes the next two sums.
    pub take: Signal<Out, Bit>,
    /// Which two of the vector they are.
    pub beat: Signal<Out, Bits<8>>,
    /// The two sums are the last of their vector.
    pub last: Signal<Out, Bit>,
    /// Set of the vector of the two sums.
    pub take_set: Signal<Out, Bit>,
    /// Outputs that are computed at a time.
    lanes: Constant<Whole>,
    outputs: Constant<Whole>,
    #[is(lanes / 2 - 1)]
    before_last_take: Constant<Bits<8>>,
    #[is(if lanes > 18 { 8 } else { lanes / 2 - 1 })]
    release_at: Constant<Bits<8>>,
    #[is(outputs / 2 - 1)]
    last_beat: Constant<Bits<8>>,
    all_credits: Constant<Bits<8>>,
    #[is(lanes / 2)]
    needed_credits: Constant<Bits<8>>,
    in_flight: Delay<2, 6>,
    #[reset(false)]
    sum_ready: DFF<Bit>,
    sum_set: DFF<Bit>,
    #[reset(false)]
    busy: DFF<Bit>,
    #[reset(false)]
    loaded: DFF<Bit>,
    #[reset(false)]
    is_active: DFF<Bit>,
    remaining: DFF<Bits<8>>,
    at_last: DFF<Bit>,
    #[reset(0)]
    beat_q: DFF<Bits<8>>,
    drain_set: DFF<Bit>,
    #[reset(all_credits)]
    credits: DFF<Bits<8>>,
    has_credits: DFF<Bit>,
    copy_q: DFF<Bit>,
    take_q: DFF<Bit>,
    taken_beat: DFF<Bits<8>>,
    last_q: DFF<Bit>,
    set_q: DFF<Bit>,
    copy_now: Signal<Local, Bit>,
    pop: Signal<Local, Bit>,
    issued: Signal<Local, Bits<2>>,
}

impl Drain {
    /// The drain of a stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        const { assert!(timing::release(9) == 0 && timing::release(10) == 1, "`release_at` says that") };
        Self::from_parts(DrainParts {
            lanes: whole(stage.lanes),
            outputs: whole(stage.outputs),
            all_credits: Constant::new((timing::DRAIN_CREDITS as u64).into()),
        })
    }
}

impl Logic for Drain {
    #[kernel]
    fn update(&mut self) {
        self.in_flight.clock.next = self.clock.val();

        self.issued.next = 0.into();
        if self.pass_issued.val() && self.set.val() {
            self.issued.next = 3.into();
        } else if self.pass_issued.val() {
            self.issued.next = 1.into();
        }
        self.in_flight.data.next = self.issued.val();
        self.copy_now.next = self.sum_ready.q.val()
            && (!self.busy.q.val() || (self.is_active.q.val() && self.at_last.q.val()));
        self.pop.next = self.is_active.q.val() || (self.loaded.q.val() && self.has_credits.q.val());
        self.release.next = self.pop.val() && (self.remaining.q.val() == self.release_at.val());

        // A pass whose sums are taken, copied, stand ready: the last take of one may be the copy of the next.
        if self.pop.val() {
            self.loaded.d.next = false;
            self.is_active.d.next = true;
            self.remaining.d.next = self.remaining.q.val() - 1;
            self.at_last.d.next = self.remaining.q.val() == 1;
            if self.at_last.q.val() {
                self.is_active.d.next = false;
                self.busy.d.next = false;
            }
            self.beat_q.d.next = self.beat_q.q.val() + 1;
            if self.beat_q.q.val() == self.last_beat.val() {
                self.beat_q.d.next = 0.into();
            }
        }
        if self.copy_now.val() {
            self.sum_ready.d.next = false;
            self.busy.d.next = true;
            self.loaded.d.next = true;
            self.remaining.d.next = self.before_last_take.val();
            self.at_last.d.next = !self.before_last_take.val().any();
            self.drain_set.d.next = self.sum_set.q.val();
        }
        if self.in_flight.delayed.val().get_bit(0) {
            self.sum_ready.d.next = true;
            self.sum_set.d.next = self.in_flight.delayed.val().get_bit(1);
        }

        // Room in the FIFO.
        if self.pop.val() && !self.credit_return.val() {
            self.credits.d.next = self.credits.q.val() - 1;
        } else if self.credit_return.val() && !self.pop.val() {
            self.credits.d.next = self.credits.q.val() + 1;
        }
        // A drain may begin in the cycle after the last take of the one before: that one's credit is spent.
        self.has_credits.d.next = (self.credits.q.val() > self.needed_credits.val())
            || ((self.credits.q.val() == self.needed_credits.val()) && !self.pop.val());

        // A cycle later.
        self.copy_q.d.next = self.copy_now.val();
        self.take_q.d.next = self.pop.val();
        self.taken_beat.d.next = self.beat_q.q.val();
        self.last_q.d.next = self.beat_q.q.val() == self.last_beat.val();
        self.set_q.d.next = self.drain_set.q.val();
        self.copy.next = self.copy_q.q.val();
        self.take.next = self.take_q.q.val();
        self.beat.next = self.taken_beat.q.val();
        self.last.next = self.last_q.q.val();
        self.take_set.next = self.set_q.q.val();
    }
}
