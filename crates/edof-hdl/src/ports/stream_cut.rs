//! Registers in a stream.

use super::{StreamIn, StreamOut};
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Registers in a stream: no path leads through it, neither with the beats nor against them.
///
/// Latency one cycle, one beat per cycle; two beats fit inside. A stall holds everything.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct StreamCut<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets what is inside.
    pub reset: Signal<In, Bit>,
    /// Beats.
    pub from: StreamIn<W>,
    /// Beats, one cycle later.
    pub to: StreamOut<W>,
    #[reset(false)]
    full: DFF<Bit>,
    data: DFF<Bits<W>>,
    user: DFF<Bit>,
    last: DFF<Bit>,
    #[reset(false)]
    spare_full: DFF<Bit>,
    spare_data: DFF<Bits<W>>,
    spare_user: DFF<Bit>,
    spare_last: DFF<Bit>,
    advance: Signal<Local, Bit>,
}

impl<const W: usize> Logic for StreamCut<W> {
    #[kernel]
    fn update(&mut self) {
        // What comes goes to the output, or, where that is occupied, to the spare place.
        self.advance.next = !self.full.q.val() || self.to.ready.val();
        if self.advance.val() {
            self.full.d.next = self.spare_full.q.val() || self.from.valid.val();
            self.spare_full.d.next = false;
            self.data.d.next = self.from.data.val();
            self.user.d.next = self.from.user.val();
            self.last.d.next = self.from.last.val();
            if self.spare_full.q.val() {
                self.data.d.next = self.spare_data.q.val();
                self.user.d.next = self.spare_user.q.val();
                self.last.d.next = self.spare_last.q.val();
            }
        } else if !self.spare_full.q.val() {
            self.spare_full.d.next = self.from.valid.val();
            self.spare_data.d.next = self.from.data.val();
            self.spare_user.d.next = self.from.user.val();
            self.spare_last.d.next = self.from.last.val();
        }

        self.from.ready.next = !self.spare_full.q.val();
        self.to.valid.next = self.full.q.val();
        self.to.data.next = self.data.q.val();
        self.to.user.next = self.user.q.val();
        self.to.last.next = self.last.q.val();
    }
}
