//! A counter with a valid/ready stream at its output: each number is held until the receiver takes it.

use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// Sends 0, 1, 2 …, 8 bits each, one number per accepted beat.
#[derive(Circuit)]
struct StreamCounter {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Restarts at 0; synchronous.
    pub reset: Signal<In, Bit>,
    /// A number is offered. It stays valid until it is accepted.
    pub valid: Signal<Out, Bit>,
    /// The receiver accepts the number in this cycle.
    pub ready: Signal<In, Bit>,
    /// The number; valid with `valid`.
    pub data: Signal<Out, Bits<8>>,
    running: DFF<Bit>,
    number: DFF<Bits<8>>,
}

impl Logic for StreamCounter {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, running, number);
        self.running.d.next = !self.reset.val();
        if self.running.q.val() && self.ready.val() {
            self.number.d.next = self.number.q.val() + 1;
        }
        if self.reset.val() {
            self.number.d.next = 0.into();
        }
        self.valid.next = self.running.q.val();
        self.data.next = self.number.q.val();
    }
}

fn main() -> Result<(), edof_verilog::EmitError> {
    let mut counter = StreamCounter::default();
    counter.connect_all();
    print!("{}", edof_verilog::emit(&counter)?.modules[0].text);
    Ok(())
}
