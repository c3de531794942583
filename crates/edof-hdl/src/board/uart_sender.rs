//! Bytes to a serial line.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Bytes to a serial line: eight bits, the least significant first, no parity, one stop bit.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct UartSender {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Ends the byte; the line is at rest.
    pub reset: Signal<In, Bit>,
    /// The byte is valid.
    pub valid: Signal<In, Bit>,
    /// The byte is accepted.
    pub ready: Signal<Out, Bit>,
    /// Byte to send.
    pub byte: Signal<In, Bits<8>>,
    /// The line.
    pub line: Signal<Out, Bit>,
    cycles_per_bit: Constant<Bits<16>>,
    #[is(cycles_per_bit - 1)]
    last_cycle: Constant<Bits<16>>,
    #[reset(false)]
    busy: DFF<Bit>,
    cycle: DFF<Bits<16>>,
    bit_number: DFF<Bits<4>>,
    shift: DFF<Bits<9>>,
    #[reset(true)]
    line_q: DFF<Bit>,
}

impl UartSender {
    /// A sender for a line with the given cycles per bit.
    #[must_use]
    pub fn new(cycles_per_bit: u16) -> Self {
        Self::from_parts(UartSenderParts { cycles_per_bit: Constant::new(u64::from(cycles_per_bit).into()) })
    }
}

impl Logic for UartSender {
    #[kernel]
    fn update(&mut self) {
        if !self.busy.q.val() {
            self.line_q.d.next = true;
            self.cycle.d.next = 0.into();
            self.bit_number.d.next = 0.into();
            if self.valid.val() {
                self.busy.d.next = true;
                // The start bit first.
                self.shift.d.next = bit_cast::<9, 8>(self.byte.val()) << 1;
            }
        } else {
            self.line_q.d.next = self.shift.q.val().get_bit(0);
            self.cycle.d.next = self.cycle.q.val() + 1;
            if self.cycle.q.val() == self.last_cycle.val() {
                self.cycle.d.next = 0.into();
                self.bit_number.d.next = self.bit_number.q.val() + 1;
                // What follows the byte is the stop bit.
                self.shift.d.next = (self.shift.q.val() >> 1) | 0x100;
                if self.bit_number.q.val() == 9 {
                    self.busy.d.next = false;
                }
            }
        }
        self.ready.next = !self.busy.q.val();
        self.line.next = self.line_q.q.val();
    }
}
