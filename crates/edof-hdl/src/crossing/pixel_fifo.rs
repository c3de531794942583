//! A stream of pixels from one clock domain to another.

use super::async_fifo::AsyncFifo;
use crate::describe::{Circuit, kernel};
use crate::ports::{StreamIn, StreamOut};
use rust_hdl::prelude::*;

/// A stream of pixels from one clock domain to another, in order and whole.
///
/// Latency three to four cycles of `to_clock` and one of `from_clock`; a pixel a cycle of the slower clock. A reset of
/// either side empties both sides, in any order and with either clock standing still ([`AsyncFifo`]).
#[derive(Circuit)]
pub struct PixelFifo {
    /// Clock of the sender.
    pub from_clock: Signal<In, Clock>,
    /// The sender's reset.
    pub from_reset: Signal<In, Bit>,
    /// Pixels.
    pub from: StreamIn<16>,
    /// Clock of the receiver.
    pub to_clock: Signal<In, Clock>,
    /// The receiver's reset.
    pub to_reset: Signal<In, Bit>,
    /// Pixels in the receiver's clock domain.
    pub to: StreamOut<16>,
    fifo: AsyncFifo<18>,
    marks: Signal<Local, Bits<18>>,
}

impl PixelFifo {
    /// A FIFO with 2^`log_depth` pixels.
    #[must_use]
    pub fn new(log_depth: usize) -> Self {
        Self::from_parts(PixelFifoParts { fifo: AsyncFifo::new(log_depth) })
    }
}

impl Logic for PixelFifo {
    #[kernel]
    fn update(&mut self) {
        self.fifo.write_clock.next = self.from_clock.val();
        self.fifo.write_reset.next = self.from_reset.val();
        self.fifo.write_valid.next = self.from.valid.val();
        self.marks.next = 0.into();
        if self.from.user.val() {
            self.marks.next = self.marks.val() | 0x1_0000;
        }
        if self.from.last.val() {
            self.marks.next = self.marks.val() | 0x2_0000;
        }
        self.fifo.write_data.next = bit_cast::<18, 16>(self.from.data.val()) | self.marks.val();
        self.from.ready.next = self.fifo.write_ready.val();

        self.fifo.read_clock.next = self.to_clock.val();
        self.fifo.read_reset.next = self.to_reset.val();
        self.fifo.read_ready.next = self.to.ready.val();
        self.to.valid.next = self.fifo.read_valid.val();
        self.to.data.next = self.fifo.read_data.val().get_bits::<16>(0);
        self.to.user.next = self.fifo.read_data.val().get_bit(16);
        self.to.last.next = self.fifo.read_data.val().get_bit(17);
    }
}
