//! Syncs that come inside of the pixels.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Takes the syncs out of a 16-bit 4:2:2 bus that has no pins for them (ITU-R BT.1120): before and after the pixels of a line stand
/// the words 255, 0, 0 and a code, on Y as on C. Bit 5 of the code is vertical blanking, bit 4 that the line ends.
///
/// Latency five cycles. Only Y is looked at. Codes are counted: those that are whole on both bytes, with their parity; and the words that
/// spoil one: 0 or 255 on either byte outside of a whole code, and a line that begins or ends twice.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
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
    /// The output pixel is valid.
    pub de: Signal<Out, Bit>,
    /// The pixel.
    pub pixel: Signal<Out, Bits<16>>,
    /// Whole codes.
    pub codes: Signal<Out, Bits<32>>,
    /// Damaged ones.
    pub malformed: Signal<Out, Bits<32>>,
    code: DFF<Bits<16>>,
    third: DFF<Bits<16>>,
    second: DFF<Bits<16>>,
    first: DFF<Bits<16>>,
    #[reset(0)]
    pause: DFF<Bits<3>>,
    #[reset(false)]
    line: DFF<Bit>,
    #[reset(false)]
    hs_q: DFF<Bit>,
    #[reset(false)]
    vs_q: DFF<Bit>,
    #[reset(false)]
    de_q: DFF<Bit>,
    pixel_q: DFF<Bits<16>>,
    // What each of four words is: 255 on both bytes, 0 on both, either on one; a code; the end of a line.
    kinds: [DFF<Bits<5>>; 4],
    #[reset(3)]
    inside: DFF<Bits<2>>,
    ended: DFF<Bit>,
    #[reset(false)]
    is_known: DFF<Bit>,
    #[reset(0)]
    codes_q: DFF<Bits<32>>,
    #[reset(0)]
    malformed_q: DFF<Bits<32>>,
    found: Signal<Local, Bit>,
    kind: Signal<Local, Bits<5>>,
    whole: Signal<Local, Bit>,
    damaged: Signal<Local, Bit>,
}

impl Logic for EmbeddedSyncs {
    #[kernel]
    fn update(&mut self) {
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

        // Each word's kind, and four of them one after the other.
        self.kind.next = 0.into();
        if self.code.q.val().all() {
            self.kind.next = 1.into();
        }
        if !self.code.q.val().any() {
            self.kind.next = 2.into();
        }
        if self.code.q.val().get_bits::<8>(0).all()
            || !self.code.q.val().get_bits::<8>(0).any()
            || self.code.q.val().get_bits::<8>(8).all()
            || !self.code.q.val().get_bits::<8>(8).any()
        {
            self.kind.next = self.kind.val() | 4;
        }
        // The four codes of progressive video with their parity.
        if (self.code.q.val() == 0x8080)
            || (self.code.q.val() == 0x9d9d)
            || (self.code.q.val() == 0xabab)
            || (self.code.q.val() == 0xb6b6)
        {
            self.kind.next = self.kind.val() | 8;
        }
        if self.code.q.val().get_bit(4) {
            self.kind.next = self.kind.val() | 16;
        }
        self.kinds[0].clock.next = self.clock.val();
        self.kinds[0].d.next = self.kind.val();
        for i in 1..4 {
            self.kinds[i].clock.next = self.clock.val();
            self.kinds[i].d.next = self.kinds[i - 1].q.val();
        }
        self.whole.next = self.kinds[3].q.val().get_bit(0)
            && self.kinds[2].q.val().get_bit(1)
            && self.kinds[1].q.val().get_bit(1)
            && self.kinds[0].q.val().get_bit(3);
        self.damaged.next =
            self.kinds[3].q.val().get_bit(2) && !self.whole.val() && !self.inside.q.val().any();
        if self.inside.q.val().any() {
            self.inside.d.next = self.inside.q.val() - 1;
        }
        if self.whole.val() {
            self.inside.d.next = 3.into();
            self.ended.d.next = self.kinds[0].q.val().get_bit(4);
            self.is_known.d.next = true;
            self.codes_q.d.next = self.codes_q.q.val() + 1;
            if self.is_known.q.val() && (self.ended.q.val() == self.kinds[0].q.val().get_bit(4)) {
                self.damaged.next = true;
            }
        }
        if self.damaged.val() {
            self.malformed_q.d.next = self.malformed_q.q.val() + 1;
        }
        self.codes.next = self.codes_q.q.val();
        self.malformed.next = self.malformed_q.q.val();
        self.hs.next = self.hs_q.q.val();
        self.vs.next = self.vs_q.q.val();
        self.de.next = self.de_q.q.val();
        self.pixel.next = self.pixel_q.q.val();
    }
}
