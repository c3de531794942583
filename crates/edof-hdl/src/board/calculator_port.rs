//! The host's words into the calculator's clock domain, and what is shown there back to it.

use crate::crossing::BusSync;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// One access at a time: a word for the calculator, a word for a display table, or a question for what a stage shows. `ready` is high for a
/// cycle when it was carried out in the calculator's clock, or `fails` with it, where that clock stands still.
///
/// About ten cycles of each clock an access. What is offered stands until `ready`. A reset of either side drops an access; of one that
/// failed nothing is carried out later, since the calculator's domain is in reset when its clock comes back.
#[derive(Circuit)]
#[circuit(default(BusSync))]
pub struct CalculatorPort {
    /// Clock of the host.
    pub clock: Signal<In, Clock>,
    /// Drops the access on this side; high at least when the calculator's domain is to be reset.
    pub reset: Signal<In, Bit>,
    /// The calculator's clock does not run: whatever is offered fails.
    pub is_down: Signal<In, Bit>,
    /// A word for the calculator is offered.
    pub weight_valid: Signal<In, Bit>,
    /// A word for a display table is offered.
    pub table_valid: Signal<In, Bit>,
    /// What a stage shows is asked for.
    pub stage_valid: Signal<In, Bit>,
    /// Where: of the calculator; or table (2 bits) and entry (15); or what to show (7 bits).
    pub address: Signal<In, Bits<25>>,
    /// What.
    pub data: Signal<In, Bits<32>>,
    /// The access has ended.
    pub ready: Signal<Out, Bit>,
    /// It was not carried out.
    pub fails: Signal<Out, Bit>,
    /// What the stage shows.
    pub shown: Signal<Out, Bits<32>>,
    /// Clock of the calculator.
    pub to_clock: Signal<In, Clock>,
    /// Reset of its domain.
    pub to_reset: Signal<In, Bit>,
    /// A word is to be written into the calculator.
    pub write_weight: Signal<Out, Bit>,
    /// A word is to be written into a display table.
    pub write_table: Signal<Out, Bit>,
    /// Where; it stands until the next access.
    pub to_address: Signal<Out, Bits<25>>,
    /// What.
    pub to_data: Signal<Out, Bits<32>>,
    /// What is shown, two cycles after its address came.
    pub status: Signal<In, Bits<32>>,
    ask: BusSync<59>,
    answer: BusSync<32>,
    is_weight: DFF<Bit>,
    is_table: DFF<Bit>,
    asks: DFF<Bit>,
    waits: DFF<Bit>,
    ready_q: DFF<Bit>,
    fails_q: DFF<Bit>,
    looks: DFF<Bits<3>>,
    answers: DFF<Bit>,
    wanted: Signal<Local, Bit>,
    word: Signal<Local, Bits<59>>,
}

impl Logic for CalculatorPort {
    #[kernel]
    fn update(&mut self) {
        // The host's side.
        dff_setup!(self, clock, is_weight, is_table, asks, waits, ready_q, fails_q);
        self.wanted.next = self.weight_valid.val() || self.table_valid.val() || self.stage_valid.val();
        self.ready_q.d.next = false;
        self.fails_q.d.next = false;
        if self.waits.q.val() {
            if self.ask.ready.val() {
                self.asks.d.next = false;
            }
            if self.answer.arrives.val() {
                self.waits.d.next = false;
                self.ready_q.d.next = true;
            }
        } else if self.wanted.val() && !self.ready_q.q.val() {
            self.asks.d.next = true;
            self.waits.d.next = true;
            self.is_weight.d.next = self.weight_valid.val();
            self.is_table.d.next = self.table_valid.val();
        }
        if self.is_down.val() {
            self.ready_q.d.next = self.wanted.val() && !self.ready_q.q.val();
            self.fails_q.d.next = true;
        }
        if self.reset.val() || self.is_down.val() {
            self.asks.d.next = false;
            self.waits.d.next = false;
        }
        self.ready.next = self.ready_q.q.val();
        self.fails.next = self.fails_q.q.val();
        self.shown.next = self.answer.arrived.val();

        // Both ways.
        self.ask.from_clock.next = self.clock.val();
        self.ask.from_reset.next = self.reset.val();
        self.ask.valid.next = self.asks.q.val();
        self.word.next = bit_cast::<59, 25>(self.address.val()) | (bit_cast::<59, 32>(self.data.val()) << 25);
        if self.is_weight.q.val() {
            self.word.next = self.word.val() | (bit_cast::<59, 2>(1.into()) << 57);
        }
        if self.is_table.q.val() {
            self.word.next = self.word.val() | (bit_cast::<59, 2>(2.into()) << 57);
        }
        self.ask.word.next = self.word.val();
        self.ask.to_clock.next = self.to_clock.val();
        self.ask.to_reset.next = self.to_reset.val();
        self.answer.from_clock.next = self.to_clock.val();
        self.answer.from_reset.next = self.to_reset.val();
        self.answer.valid.next = self.answers.q.val();
        self.answer.word.next = self.status.val();
        self.answer.to_clock.next = self.clock.val();
        self.answer.to_reset.next = self.reset.val();

        // The calculator's side: a word is written as it comes, and what is shown has come three cycles later.
        self.looks.clock.next = self.to_clock.val();
        self.answers.clock.next = self.to_clock.val();
        self.write_weight.next = self.ask.arrives.val() && self.ask.arrived.val().get_bit(57);
        self.write_table.next = self.ask.arrives.val() && self.ask.arrived.val().get_bit(58);
        self.to_address.next = self.ask.arrived.val().get_bits::<25>(0);
        self.to_data.next = self.ask.arrived.val().get_bits::<32>(25);
        self.looks.d.next = self.looks.q.val() << 1;
        if self.ask.arrives.val() {
            self.looks.d.next = (self.looks.q.val() << 1) | 1;
        }
        self.answers.d.next = self.answers.q.val();
        if self.looks.q.val().get_bit(2) {
            self.answers.d.next = true;
        } else if self.answer.ready.val() {
            self.answers.d.next = false;
        }

        if self.to_reset.val() {
            self.looks.d.next = 0.into();
            self.answers.d.next = false;
        }
    }
}
