//! Syncs that come inside of the pixels.

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// Takes the syncs out of a 16-bit 4:2:2 bus that has no pins for them (ITU-R BT.1120): before and after the pixels of a line stand
/// the words 255, 0, 0 and a code, on Y as on C. Bit 5 of the code is vertical blanking, bit 4 that the line ends.
///
/// Latency five cycles. Only Y is looked at: raw pixels have less than 128 there, so that none of them is taken for a code.
#[derive(Circuit)]
pub struct EmbeddedSyncs {
    /// Clock of the bus.
    pub clock: Signal<In, Clock>,
    /// Forgets where the line is.
    pub reset: Signal<In, Bit>,
    /// The bus: Y low, C high.
    pub data: Signal<In, Bits<16>>,
    /// Horizontal blanking.
    pub hs: Signal<Out, Bit>,
    /// Vertical blanking.
    pub vs: Signal<Out, Bit>,
    /// A pixel lies on the output.
    pub de: Signal<Out, Bit>,
    /// It.
    pub pixel: Signal<Out, Bits<16>>,
    code: DFF<Bits<16>>,
    third: DFF<Bits<16>>,
    second: DFF<Bits<16>>,
    first: DFF<Bits<16>>,
    pause: DFF<Bits<3>>,
    line: DFF<Bit>,
    hs_q: DFF<Bit>,
    vs_q: DFF<Bit>,
    de_q: DFF<Bit>,
    pixel_q: DFF<Bits<16>>,
    found: Signal<Local, Bit>,
}

impl Logic for EmbeddedSyncs {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, code, third, second, first, pause, line, hs_q, vs_q, de_q, pixel_q);
        self.code.d.next = self.data.val();
        self.third.d.next = self.code.q.val();
        self.second.d.next = self.third.q.val();
        self.first.d.next = self.second.q.val();
        self.found.next = (self.first.q.val().get_bits::<8>(0) == 255)
            && !self.second.q.val().get_bits::<8>(0).any()
            && !self.third.q.val().get_bits::<8>(0).any()
            && self.code.q.val().get_bit(7);

        // Four words of the code pass before the first pixel.
        if self.pause.q.val().any() {
            self.pause.d.next = self.pause.q.val() - 1;
        }
        if self.found.val() {
            self.vs_q.d.next = self.code.q.val().get_bit(5);
            self.hs_q.d.next = self.code.q.val().get_bit(4);
            self.line.d.next = !self.code.q.val().get_bit(5) && !self.code.q.val().get_bit(4);
            self.pause.d.next = 3.into();
        }
        self.de_q.d.next = self.line.q.val() && !self.found.val() && !self.pause.q.val().any();
        self.pixel_q.d.next = self.first.q.val();
        if self.reset.val() {
            self.line.d.next = false;
            self.pause.d.next = 0.into();
            self.hs_q.d.next = false;
            self.vs_q.d.next = false;
            self.de_q.d.next = false;
        }
        self.hs.next = self.hs_q.q.val();
        self.vs.next = self.vs_q.q.val();
        self.de.next = self.de_q.q.val();
        self.pixel.next = self.pixel_q.q.val();
    }
}
