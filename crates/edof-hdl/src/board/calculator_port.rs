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
    /// A status word of a stage is requested.
    pub stage_valid: Signal<In, Bit>,
    /// Address in the calculator; or table (2 bits) and entry (15); or status word (7 bits).
    pub address: Signal<In, Bits<25>>,
    /// Word to write.
    pub data: Signal<In, Bits<32>>,
    /// The access has ended.
    pub ready: Signal<Out, Bit>,
    /// The access ended without being carried out.
    pub error: Signal<Out, Bit>,
    /// Status word of the stage, valid with `ready`.
    pub read_value: Signal<Out, Bits<32>>,
    /// Clock of the calculator.
    pub to_clock: Signal<In, Clock>,
    /// Reset of the calculator's domain.
    pub to_reset: Signal<In, Bit>,
    /// A word is to be written into the calculator.
    pub write_weight: Signal<Out, Bit>,
    /// A word is to be written into a display table.
    pub write_table: Signal<Out, Bit>,
    /// Address of the access, held until the next one.
    pub to_address: Signal<Out, Bits<25>>,
    /// Word to write.
    pub to_data: Signal<Out, Bits<32>>,
    /// Status word, two cycles after its address.
    pub status: Signal<In, Bits<32>>,
    request_sync: BusSync<59>,
    answer: BusSync<32>,
    is_weight: DFF<Bit>,
    is_table: DFF<Bit>,
    request: DFF<Bit>,
    is_waiting: DFF<Bit>,
    ready_q: DFF<Bit>,
    error_q: DFF<Bit>,
    read_delay: DFF<Bits<3>>,
    answer_valid: DFF<Bit>,
    is_requested: Signal<Local, Bit>,
    word: Signal<Local, Bits<59>>,
}

impl Logic for CalculatorPort {
    #[kernel]
    fn update(&mut self) {
        // The host's side.
        dff_setup!(self, clock, is_weight, is_table, request, is_waiting, ready_q, error_q);
        self.is_requested.next = self.weight_valid.val() || self.table_valid.val() || self.stage_valid.val();
        self.ready_q.d.next = false;
        self.error_q.d.next = false;
        if self.is_waiting.q.val() {
            if self.request_sync.ready.val() {
                self.request.d.next = false;
            }
            if self.answer.arrives.val() {
                self.is_waiting.d.next = false;
                self.ready_q.d.next = true;
            }
        } else if self.is_requested.val() && !self.ready_q.q.val() {
            self.request.d.next = true;
            self.is_waiting.d.next = true;
            self.is_weight.d.next = self.weight_valid.val();
            self.is_table.d.next = self.table_valid.val();
        }
        if self.is_down.val() {
            self.ready_q.d.next = self.is_requested.val() && !self.ready_q.q.val();
            self.error_q.d.next = true;
        }
        if self.reset.val() || self.is_down.val() {
            self.request.d.next = false;
            self.is_waiting.d.next = false;
        }
        self.ready.next = self.ready_q.q.val();
        self.error.next = self.error_q.q.val();
        self.read_value.next = self.answer.arrived.val();

        // Both ways.
        self.request_sync.from_clock.next = self.clock.val();
        self.request_sync.from_reset.next = self.reset.val();
        self.request_sync.valid.next = self.request.q.val();
        self.word.next = bit_cast::<59, 25>(self.address.val()) | (bit_cast::<59, 32>(self.data.val()) << 25);
        if self.is_weight.q.val() {
            self.word.next = self.word.val() | (bit_cast::<59, 2>(1.into()) << 57);
        }
        if self.is_table.q.val() {
            self.word.next = self.word.val() | (bit_cast::<59, 2>(2.into()) << 57);
        }
        self.request_sync.word.next = self.word.val();
        self.request_sync.to_clock.next = self.to_clock.val();
        self.request_sync.to_reset.next = self.to_reset.val();
        self.answer.from_clock.next = self.to_clock.val();
        self.answer.from_reset.next = self.to_reset.val();
        self.answer.valid.next = self.answer_valid.q.val();
        self.answer.word.next = self.status.val();
        self.answer.to_clock.next = self.clock.val();
        self.answer.to_reset.next = self.reset.val();

        // The calculator's side: a word is written as it comes, and what is shown has come three cycles later.
        self.read_delay.clock.next = self.to_clock.val();
        self.answer_valid.clock.next = self.to_clock.val();
        self.write_weight.next =
            self.request_sync.arrives.val() && self.request_sync.arrived.val().get_bit(57);
        self.write_table.next =
            self.request_sync.arrives.val() && self.request_sync.arrived.val().get_bit(58);
        self.to_address.next = self.request_sync.arrived.val().get_bits::<25>(0);
        self.to_data.next = self.request_sync.arrived.val().get_bits::<32>(25);
        self.read_delay.d.next = self.read_delay.q.val() << 1;
        if self.request_sync.arrives.val() {
            self.read_delay.d.next = (self.read_delay.q.val() << 1) | 1;
        }
        self.answer_valid.d.next = self.answer_valid.q.val();
        if self.read_delay.q.val().get_bit(2) {
            self.answer_valid.d.next = true;
        } else if self.answer.ready.val() {
            self.answer_valid.d.next = false;
        }

        if self.to_reset.val() {
            self.read_delay.d.next = 0.into();
            self.answer_valid.d.next = false;
        }
    }
}
