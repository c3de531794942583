//! Addresses and values for the multipliers, pass by pass.

use super::{Index, IndexedValue, Pair, Row};
use crate::describe::Circuit;
use edof_spec::design::StagePlan;
use rust_hdl::prelude::*;

/// Addresses and values for the multipliers, pass by pass: first the pairs of the waiting vector, then the window (F).
/// A pass begins when it may_start and then takes one step a cycle; a vector without pairs takes one idle step.
/// A step's pair is read in the next cycle and stands at the multipliers one later, shifted left where F aligns its two sums.
#[derive(Circuit)]
pub struct Sequencer {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Back to the start.
    pub reset: Signal<In, Bit>,
    /// A vector waits.
    pub available: Signal<In, Bit>,
    /// Its pairs.
    pub count: Signal<In, Index>,
    /// Its set.
    pub set: Signal<In, Bit>,
    /// Whether a pass may begin.
    pub may_start: Signal<In, Bit>,
    /// Left shift of code values.
    pub code_shift: Signal<In, Bits<4>>,
    /// Left shift of pixels.
    pub linear_shift: Signal<In, Bits<4>>,
    /// Set whose shifts are wanted.
    pub shift_set: Signal<Out, Bit>,
    /// Which two pairs to read.
    pub read_pair: Signal<Out, Bits<8>>,
    /// The even one, a cycle later.
    pub even_pair: Signal<In, IndexedValue>,
    /// The odd one.
    pub odd_pair: Signal<In, IndexedValue>,
    /// Which two pixels to read.
    pub read_pixel: Signal<Out, Bits<8>>,
    /// They, a cycle later.
    pub pixels: Signal<In, Pair>,
    /// The last step of a pass is issued.
    pub pass_issued: Signal<Out, Bit>,
    /// The last step of a vector is issued.
    pub finished: Signal<Out, Bit>,
    /// A row is read, so that none can be written where both ports read.
    pub busy: Signal<Out, Bit>,
    /// The step is the first of its pass.
    pub first: Signal<Out, Bit>,
    /// Row of weights.
    pub address_a: Signal<Out, Row>,
    /// Value, 0 where there is no work.
    pub value_a: Signal<Out, Bits<25>>,
    /// Row of weights for the second DSP.
    pub address_b: Signal<Out, Row>,
    /// Its value.
    pub value_b: Signal<Out, Bits<25>>,
    two_rows: Constant<Bit>,
    linear_steps: Constant<Bits<10>>,
    codes: Constant<Row>,
    pass_rows: Constant<Row>,
    set_rows: Constant<Row>,
    last_pass: Constant<Bits<6>>,
    step: DFF<Bits<10>>,
    pass: DFF<Bits<6>>,
    pass_row: DFF<Row>,
    valid_a_q: DFF<Bit>,
    valid_b_q: DFF<Bit>,
    first_q: DFF<Bit>,
    linear_q: DFF<Bit>,
    odd_q: DFF<Bit>,
    set_q: DFF<Bit>,
    row_q: DFF<Row>,
    linear_row_q: DFF<Row>,
    first_q2: DFF<Bit>,
    busy_q2: DFF<Bit>,
    address_a_q2: DFF<Row>,
    value_a_q2: DFF<Bits<25>>,
    address_b_q2: DFF<Row>,
    value_b_q2: DFF<Bits<25>>,
    wanted_steps: Signal<Local, Bits<10>>,
    code_steps: Signal<Local, Bits<10>>,
    linear_step: Signal<Local, Bits<10>>,
    in_codes: Signal<Local, Bit>,
    issue: Signal<Local, Bit>,
    at_end: Signal<Local, Bit>,
    pair_a: Signal<Local, IndexedValue>,
    pixel_a: Signal<Local, Bits<16>>,
    extended_a: Signal<Local, Bits<25>>,
    extended_b: Signal<Local, Bits<25>>,
    shift: Signal<Local, Bits<4>>,
}

impl Sequencer {
    /// The sequencer of a stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        Self::from_parts(SequencerParts {
            two_rows: Constant::new(stage.rows == 2),
            linear_steps: Constant::new((stage.linear.div_ceil(stage.rows) as u64).into()),
            codes: Constant::new((stage.inputs as u64).into()),
            pass_rows: Constant::new((stage.pass_rows() as u64).into()),
            set_rows: Constant::new((stage.weight_rows() as u64).into()),
            last_pass: Constant::new((stage.passes() as u64 - 1).into()),
        })
    }
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(
            self,
            clock,
            step,
            pass,
            pass_row,
            valid_a_q,
            valid_b_q,
            first_q,
            linear_q,
            odd_q,
            set_q,
            row_q,
            linear_row_q,
            first_q2,
            busy_q2,
            address_a_q2,
            value_a_q2,
            address_b_q2,
            value_b_q2
        );

        // The step that is issued in this cycle.
        self.wanted_steps.next = bit_cast::<10, 9>(self.count.val());
        if self.two_rows.val() {
            self.wanted_steps.next = (bit_cast::<10, 9>(self.count.val()) + 1) >> 1;
        }
        self.code_steps.next = self.wanted_steps.val();
        if self.wanted_steps.val() == 0 {
            self.code_steps.next = 1.into();
        }
        self.in_codes.next = self.step.q.val() < self.code_steps.val();
        self.linear_step.next = self.step.q.val() - self.code_steps.val();
        self.issue.next = self.available.val() && (self.step.q.val().any() || self.may_start.val());
        self.at_end.next = (self.step.q.val() + 1) == (self.code_steps.val() + self.linear_steps.val());
        self.pass_issued.next = self.issue.val() && self.at_end.val();
        self.finished.next =
            self.issue.val() && self.at_end.val() && (self.pass.q.val() == self.last_pass.val());
        if self.issue.val() {
            self.step.d.next = self.step.q.val() + 1;
            if self.at_end.val() {
                self.step.d.next = 0.into();
                self.pass.d.next = self.pass.q.val() + 1;
                self.pass_row.d.next = self.pass_row.q.val() + self.pass_rows.val();
                if self.pass.q.val() == self.last_pass.val() {
                    self.pass.d.next = 0.into();
                    self.pass_row.d.next = 0.into();
                }
            }
        }

        // What it reads.
        self.read_pair.next = bit_cast::<8, 10>(self.step.q.val() >> 1);
        self.read_pixel.next = bit_cast::<8, 10>(self.linear_step.val() >> 1);
        self.odd_q.d.next = self.step.q.val().get_bit(0);
        if !self.in_codes.val() {
            self.odd_q.d.next = self.linear_step.val().get_bit(0);
        }
        self.valid_a_q.d.next = self.issue.val();
        if self.in_codes.val() {
            self.valid_a_q.d.next =
                self.issue.val() && (self.step.q.val() < bit_cast::<10, 9>(self.count.val()));
        }
        self.valid_b_q.d.next = false;
        self.linear_row_q.d.next = self.codes.val() + bit_cast::<12, 10>(self.linear_step.val());
        if self.two_rows.val() {
            self.read_pair.next = bit_cast::<8, 10>(self.step.q.val());
            self.read_pixel.next = bit_cast::<8, 10>(self.linear_step.val());
            self.odd_q.d.next = false;
            self.valid_b_q.d.next = self.issue.val();
            if self.in_codes.val() {
                self.valid_a_q.d.next = self.issue.val() && self.count.val().any();
                self.valid_b_q.d.next = self.issue.val()
                    && (((self.step.q.val() << 1) + 1) < bit_cast::<10, 9>(self.count.val()));
            }
            self.linear_row_q.d.next = self.codes.val() + (bit_cast::<12, 10>(self.linear_step.val()) << 1);
        }
        self.first_q.d.next = self.issue.val() && !self.step.q.val().any();
        self.linear_q.d.next = !self.in_codes.val();
        self.set_q.d.next = self.set.val();
        self.row_q.d.next = self.pass_row.q.val();
        if self.set.val() {
            self.row_q.d.next = self.pass_row.q.val() + self.set_rows.val();
        }

        // The pairs read a cycle ago.
        self.shift_set.next = self.set_q.q.val();
        self.shift.next = self.code_shift.val();
        self.pair_a.next = self.even_pair.val();
        self.pixel_a.next = self.pixels.val().get_bits::<16>(0);
        if self.odd_q.q.val() {
            self.pair_a.next = self.odd_pair.val();
            self.pixel_a.next = self.pixels.val().get_bits::<16>(16);
        }
        self.address_a_q2.d.next =
            self.row_q.q.val() + bit_cast::<12, 9>(self.pair_a.val().get_bits::<9>(16));
        self.address_b_q2.d.next =
            self.row_q.q.val() + bit_cast::<12, 9>(self.odd_pair.val().get_bits::<9>(16));
        self.extended_a.next = bit_cast::<25, 16>(self.pair_a.val().get_bits::<16>(0));
        if self.pair_a.val().get_bit(15) {
            self.extended_a.next = bit_cast::<25, 16>(self.pair_a.val().get_bits::<16>(0)) | 0x1ff_0000;
        }
        self.extended_b.next = bit_cast::<25, 16>(self.odd_pair.val().get_bits::<16>(0));
        if self.odd_pair.val().get_bit(15) {
            self.extended_b.next = bit_cast::<25, 16>(self.odd_pair.val().get_bits::<16>(0)) | 0x1ff_0000;
        }
        if self.linear_q.q.val() {
            self.shift.next = self.linear_shift.val();
            self.address_a_q2.d.next = self.row_q.q.val() + self.linear_row_q.q.val();
            self.address_b_q2.d.next = self.row_q.q.val() + self.linear_row_q.q.val() + 1;
            self.extended_a.next = bit_cast::<25, 16>(self.pixel_a.val());
            self.extended_b.next = bit_cast::<25, 16>(self.pixels.val().get_bits::<16>(16));
        }
        self.first_q2.d.next = self.first_q.q.val();
        self.busy_q2.d.next = self.valid_a_q.q.val();
        self.value_a_q2.d.next = 0.into();
        if self.valid_a_q.q.val() {
            self.value_a_q2.d.next = self.extended_a.val() << self.shift.val();
        }
        self.value_b_q2.d.next = 0.into();
        if self.valid_b_q.q.val() {
            self.value_b_q2.d.next = self.extended_b.val() << self.shift.val();
        }

        // At the multipliers.
        self.first.next = self.first_q2.q.val();
        self.busy.next = self.busy_q2.q.val();
        self.address_a.next = self.address_a_q2.q.val();
        self.value_a.next = self.value_a_q2.q.val();
        self.address_b.next = self.address_b_q2.q.val();
        self.value_b.next = self.value_b_q2.q.val();

        if self.reset.val() {
            self.step.d.next = 0.into();
            self.pass.d.next = 0.into();
            self.pass_row.d.next = 0.into();
            self.valid_a_q.d.next = false;
            self.valid_b_q.d.next = false;
            self.first_q.d.next = false;
        }
    }
}
