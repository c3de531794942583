//! Bytes from a serial line.

use crate::crossing::Sync;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Bytes from a serial line: eight bits, the least significant first, no parity, one stop bit.
///
/// Each bit is looked at in its middle. A byte whose start or stop bit is wrong is dropped.
#[derive(Circuit)]
#[circuit(default(Sync), registers(clock, reset))]
pub struct UartReceiver {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Waits for a start bit.
    pub reset: Signal<In, Bit>,
    /// The line, of no clock.
    pub line: Signal<In, Bit>,
    /// A byte has come.
    pub valid: Signal<Out, Bit>,
    /// The received byte.
    pub byte: Signal<Out, Bits<8>>,
    cycles_per_bit: Constant<Bits<16>>,
    #[is(cycles_per_bit - 1)]
    last_cycle: Constant<Bits<16>>,
    #[is(cycles_per_bit / 2)]
    half: Constant<Bits<16>>,
    sync: Sync<1>,
    #[reset(false)]
    busy: DFF<Bit>,
    cycle: DFF<Bits<16>>,
    bit_number: DFF<Bits<4>>,
    shift: DFF<Bits<8>>,
    #[reset(false)]
    done: DFF<Bit>,
    level: Signal<Local, Bit>,
    from_line: Signal<Local, Bits<1>>,
}

impl UartReceiver {
    /// A receiver for a line with the given cycles per bit.
    #[must_use]
    pub fn new(cycles_per_bit: u16) -> Self {
        Self::from_parts(UartReceiverParts {
            cycles_per_bit: Constant::new(u64::from(cycles_per_bit).into()),
        })
    }
}

impl Logic for UartReceiver {
    #[kernel]
    fn update(&mut self) {
        self.sync.clock.next = self.clock.val();
        self.from_line.next = 0.into();
        if self.line.val() {
            self.from_line.next = 1.into();
        }
        self.sync.from.next = self.from_line.val();
        self.level.next = self.sync.to.val().any();

        // Bit 0 is the start bit, 1 to 8 the byte, 9 the stop bit.
        self.done.d.next = false;
        if !self.busy.q.val() {
            self.busy.d.next = !self.level.val();
            self.cycle.d.next = 0.into();
            self.bit_number.d.next = 0.into();
        } else {
            self.cycle.d.next = self.cycle.q.val() + 1;
            if self.cycle.q.val() == self.last_cycle.val() {
                self.cycle.d.next = 0.into();
                self.bit_number.d.next = self.bit_number.q.val() + 1;
            }
            if self.cycle.q.val() == self.half.val() {
                if self.bit_number.q.val() == 0 {
                    self.busy.d.next = !self.level.val();
                } else if self.bit_number.q.val() == 9 {
                    self.busy.d.next = false;
                    self.done.d.next = self.level.val();
                } else {
                    self.shift.d.next = self.shift.q.val() >> 1;
                    if self.level.val() {
                        self.shift.d.next = (self.shift.q.val() >> 1) | 0x80;
                    }
                }
            }
        }
        self.valid.next = self.done.q.val();
        self.byte.next = self.shift.q.val();
    }
}
