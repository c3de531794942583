//! Which step of which pass is next.

use super::{Descriptor, Row, Whole, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::StagePlan;
use rust_hdl::prelude::*;

/// Which step of which pass is next: over a vector's pairs first, then over the window (F), once a pass, one step a cycle.
/// What a pass must know is looked up before it begins, so that the next begins in the cycle after the last step of the one before;
/// all that a step reads comes out of registers. In the cycle after `steal_next`, no step is issued and the current pass is held.
/// At most two passes are begun and not released. The registers that decide whether a pass begins are all in this block, so that the decision
/// crosses no distance (docs/fabric.md).
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct Sequencer {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Back to the start.
    pub reset: Signal<In, Bit>,
    /// A vector is whole.
    pub arrived: Signal<In, Bit>,
    /// What must be known of it: steps before its last one (8 bits), one step only, no pairs, an odd number, set.
    pub descriptor: Signal<In, Descriptor>,
    /// A pass is released: one more may begin from the next cycle on.
    pub release: Signal<In, Bit>,
    /// No step in the next cycle.
    pub steal_next: Signal<In, Bit>,
    /// There is a step in this cycle, with a first value.
    pub valid_a: Signal<Out, Bit>,
    /// With a second one.
    pub valid_b: Signal<Out, Bit>,
    /// The step is the first of its pass.
    pub first: Signal<Out, Bit>,
    /// The step belongs to the window (linear path).
    pub linear: Signal<Out, Bit>,
    /// The odd one of two elements that are read is meant (where one is taken a cycle).
    pub odd: Signal<Out, Bit>,
    /// The vector's set.
    pub set: Signal<Out, Bit>,
    /// Which two elements of which slot to read.
    pub read_row: Signal<Out, Bits<9>>,
    /// Which two pixels of the window to read.
    pub read_pixels: Signal<Out, Bits<7>>,
    /// Row of weights of input 0 in this pass.
    pub base: Signal<Out, Row>,
    /// Offset of the step's row of weights after `base`; for a pair, its index is added.
    pub offset: Signal<Out, Row>,
    /// The step is the last of its pass.
    pub pass_issued: Signal<Out, Bit>,
    /// The step is the last of its vector.
    pub finished: Signal<Out, Bit>,
    inputs: Constant<Whole>,
    /// 1 where elements come as pairs of index and value (M, F).
    pairs: Constant<Whole>,
    /// Parts of a vector that are read in step (I).
    parts: Constant<Whole>,
    /// Rows of weights in a step (M, F).
    rows: Constant<Whole>,
    /// Pixels of the linear path (F).
    window_pixels: Constant<Whole>,
    /// Outputs that are computed at a time.
    lanes: Constant<Whole>,
    outputs: Constant<Whole>,
    #[is(rows == 2)]
    two_rows: Constant<Bit>,
    #[is(window_pixels > 0)]
    has_linear: Constant<Bit>,
    #[is(if window_pixels > 0 { (window_pixels - 1) / rows } else { 0 })]
    linear_before_last: Constant<Bits<8>>,
    #[is(window_pixels == rows)]
    linear_single: Constant<Bit>,
    #[is(pairs * inputs)]
    codes: Constant<Row>,
    #[is(inputs / parts + window_pixels)]
    pass_rows: Constant<Row>,
    #[is(outputs / lanes * (inputs / parts + window_pixels))]
    set_rows: Constant<Row>,
    #[is(outputs / lanes - 1)]
    last_pass: Constant<Bits<6>>,
    // Vectors that wait.
    #[reset(0)]
    write_slot: DFF<Bits<2>>,
    descriptor_0: DFF<Descriptor>,
    descriptor_1: DFF<Descriptor>,
    descriptor_2: DFF<Descriptor>,
    descriptor_3: DFF<Descriptor>,
    #[reset(0)]
    waiting: DFF<Bits<3>>,
    // The pass that begins next.
    #[reset(0)]
    slot: DFF<Bits<2>>,
    #[reset(0)]
    pass: DFF<Bits<6>>,
    #[reset(0)]
    pass_row: DFF<Row>,
    // Passes that have begun and are not released.
    #[reset(0)]
    open: DFF<Bits<2>>,
    #[reset(false)]
    may_begin: DFF<Bit>,
    job: DFF<Descriptor>,
    job_row: DFF<Row>,
    job_slot: DFF<Bits<2>>,
    job_is_last: DFF<Bit>,
    // The step of this cycle.
    steal: DFF<Bit>,
    #[reset(false)]
    active: DFF<Bit>,
    linear_q: DFF<Bit>,
    remaining: DFF<Bits<8>>,
    at_end: DFF<Bit>,
    step: DFF<Bits<8>>,
    first_q: DFF<Bit>,
    odd_count: DFF<Bit>,
    empty: DFF<Bit>,
    set_q: DFF<Bit>,
    slot_q: DFF<Bits<2>>,
    base_q: DFF<Row>,
    is_last: DFF<Bit>,
    step_valid: Signal<Local, Bit>,
    pass_done: Signal<Local, Bit>,
    grant: Signal<Local, Bit>,
    pop: Signal<Local, Bit>,
    next: Signal<Local, Descriptor>,
    row: Signal<Local, Bits<7>>,
}

impl Sequencer {
    /// The sequencer of a stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let is_dense = stage.is_dense();
        Self::from_parts(SequencerParts {
            inputs: whole(stage.inputs),
            pairs: whole((!is_dense).into()),
            parts: whole(if is_dense { stage.rows } else { 1 }),
            rows: whole(if is_dense { 1 } else { stage.rows }),
            window_pixels: whole(stage.linear),
            lanes: whole(stage.lanes),
            outputs: whole(stage.outputs),
        })
    }
}

impl Logic for Sequencer {
    #[kernel]
    fn update(&mut self) {
        self.steal.d.next = self.steal_next.val();

        // The step of this cycle, and whether a pass begins with the next.
        self.step_valid.next = self.active.q.val() && !self.steal.q.val();
        self.pass_done.next =
            self.step_valid.val() && self.at_end.q.val() && (self.linear_q.q.val() || !self.has_linear.val());
        self.grant.next = self.may_begin.q.val() && (!self.active.q.val() || self.pass_done.val());
        self.pop.next = self.grant.val() && self.job_is_last.q.val();
        self.pass_issued.next = self.pass_done.val();
        self.finished.next = self.pass_done.val() && self.is_last.q.val();

        // Vectors that wait.
        if self.arrived.val() {
            self.write_slot.d.next = self.write_slot.q.val() + 1;
            if self.write_slot.q.val() == 0 {
                self.descriptor_0.d.next = self.descriptor.val();
            } else if self.write_slot.q.val() == 1 {
                self.descriptor_1.d.next = self.descriptor.val();
            } else if self.write_slot.q.val() == 2 {
                self.descriptor_2.d.next = self.descriptor.val();
            } else {
                self.descriptor_3.d.next = self.descriptor.val();
            }
        }
        if self.arrived.val() && !self.pop.val() {
            self.waiting.d.next = self.waiting.q.val() + 1;
        } else if self.pop.val() && !self.arrived.val() {
            self.waiting.d.next = self.waiting.q.val() - 1;
        }

        // The pass that begins next.
        if self.grant.val() {
            self.pass.d.next = self.pass.q.val() + 1;
            self.pass_row.d.next = self.pass_row.q.val() + self.pass_rows.val();
            if self.job_is_last.q.val() {
                self.pass.d.next = 0.into();
                self.pass_row.d.next = 0.into();
                self.slot.d.next = self.slot.q.val() + 1;
            }
        }
        self.next.next = self.descriptor_0.q.val();
        if self.slot.q.val() == 1 {
            self.next.next = self.descriptor_1.q.val();
        } else if self.slot.q.val() == 2 {
            self.next.next = self.descriptor_2.q.val();
        } else if self.slot.q.val() == 3 {
            self.next.next = self.descriptor_3.q.val();
        }
        if self.grant.val() && !self.release.val() {
            self.open.d.next = self.open.q.val() + 1;
        } else if self.release.val() && !self.grant.val() {
            self.open.d.next = self.open.q.val() - 1;
        }
        self.may_begin.d.next = self.waiting.q.val().any()
            && !self.grant.val()
            && (!self.open.q.val().get_bit(1) || self.release.val());
        self.job.d.next = self.next.val();
        self.job_slot.d.next = self.slot.q.val();
        self.job_is_last.d.next = self.pass.q.val() == self.last_pass.val();
        self.job_row.d.next = self.pass_row.q.val();
        if self.next.val().get_bit(0) {
            self.job_row.d.next = self.pass_row.q.val() + self.set_rows.val();
        }

        // The step of the next cycle.
        if self.step_valid.val() {
            self.first_q.d.next = false;
            self.remaining.d.next = self.remaining.q.val() - 1;
            self.at_end.d.next = self.remaining.q.val() == 1;
            self.step.d.next = self.step.q.val() + 1;
            if self.at_end.q.val() {
                self.linear_q.d.next = true;
                self.remaining.d.next = self.linear_before_last.val();
                self.at_end.d.next = self.linear_single.val();
                self.step.d.next = 0.into();
            }
        }
        if self.pass_done.val() {
            self.active.d.next = false;
        }
        if self.grant.val() {
            self.active.d.next = true;
            self.linear_q.d.next = false;
            self.remaining.d.next = self.job.q.val().get_bits::<8>(4);
            self.at_end.d.next = self.job.q.val().get_bit(3);
            self.step.d.next = 0.into();
            self.first_q.d.next = true;
            self.set_q.d.next = self.job.q.val().get_bit(0);
            self.odd_count.d.next = self.job.q.val().get_bit(1);
            self.empty.d.next = self.job.q.val().get_bit(2);
            self.slot_q.d.next = self.job_slot.q.val();
            self.base_q.d.next = self.job_row.q.val();
            self.is_last.d.next = self.job_is_last.q.val();
        }

        // What the step reads.
        self.valid_a.next = self.step_valid.val() && (self.linear_q.q.val() || !self.empty.q.val());
        self.valid_b.next = self.step_valid.val()
            && (self.linear_q.q.val() || !(self.at_end.q.val() && self.odd_count.q.val()));
        self.first.next = self.step_valid.val() && self.first_q.q.val();
        self.linear.next = self.linear_q.q.val();
        self.set.next = self.set_q.q.val();
        self.base.next = self.base_q.q.val();
        self.row.next = self.step.q.val().get_bits::<7>(1);
        self.odd.next = self.step.q.val().get_bit(0);
        self.offset.next = self.codes.val() + bit_cast::<12, 8>(self.step.q.val());
        if self.two_rows.val() {
            self.row.next = self.step.q.val().get_bits::<7>(0);
            self.odd.next = false;
            self.offset.next = self.codes.val() + (bit_cast::<12, 8>(self.step.q.val()) << 1);
        }
        self.read_row.next = (bit_cast::<9, 2>(self.slot_q.q.val()) << 7) | bit_cast::<9, 7>(self.row.val());
        self.read_pixels.next = self.row.val();
    }
}
