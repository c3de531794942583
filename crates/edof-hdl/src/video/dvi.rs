//! A picture in 4:2:2 to the pins of a DVI cable.

use super::border::Border;
use super::ddr_out::DdrOut;
use super::sink_rgb::{self, SinkRgb};
use super::tmds_encoder::TmdsEncoder;
use crate::blocks::delay::Delay;
use crate::crossing::Serialiser;
use crate::describe::{Circuit, kernel};
use edof_device::video::VideoTiming;
use rust_hdl::prelude::*;

/// Cycles by which syncs are behind the border's.
const LATER: usize = sink_rgb::LATENCY - 1;

/// A picture in 4:2:2 to the pins of a DVI cable: R'G'B' as a screen makes them, black around the picture, syncs as negative pulses. No pixels
/// before the first vertical sync. Lanes 0 to 2 are blue, green and red, lane 3 the clock, whose rise begins a symbol.
#[derive(Circuit)]
#[circuit(default(SinkRgb, Delay, TmdsEncoder, Serialiser, DdrOut))]
pub struct Dvi {
    /// The pixel clock.
    pub clock: Signal<In, Clock>,
    /// A clock of the same source, five times as fast.
    pub bit_clock: Signal<In, Clock>,
    /// No pixels until the next vertical sync, in `clock`.
    pub reset: Signal<In, Bit>,
    /// Horizontal sync, a positive pulse.
    pub hs: Signal<In, Bit>,
    /// Vertical sync, a positive pulse.
    pub vs: Signal<In, Bit>,
    /// A pixel of the picture is on the bus.
    pub de: Signal<In, Bit>,
    /// Codes of the pixel: Y' low, Cb' or Cr' high.
    pub data: Signal<In, Bits<16>>,
    /// The cable's pairs, two bits per cycle of `bit_clock`.
    pub pins: Signal<Out, Bits<4>>,
    clock_symbol: Constant<Bits<10>>,
    sink: SinkRgb,
    border: Border,
    marks: Delay<3, LATER>,
    blue: TmdsEncoder,
    green: TmdsEncoder,
    red: TmdsEncoder,
    serialiser: Serialiser<40, 4>,
    out: DdrOut<4>,
    syncs: Signal<Local, Bits<3>>,
}

impl Dvi {
    /// For a screen's timing.
    #[must_use]
    pub fn new(timing: VideoTiming) -> Self {
        Self::from_parts(DviParts { clock_symbol: Constant::new(0x01f.into()), border: Border::new(timing) })
    }
}

impl Logic for Dvi {
    #[kernel]
    fn update(&mut self) {
        self.sink.clock.next = self.clock.val();
        self.sink.de.next = self.de.val();
        self.sink.data.next = self.data.val();
        self.border.clock.next = self.clock.val();
        self.border.reset.next = self.reset.val();
        self.border.hs.next = self.hs.val();
        self.border.vs.next = self.vs.val();
        self.syncs.next = 0.into();
        if !self.border.hs_later.val() {
            self.syncs.next = self.syncs.val() | 1;
        }
        if !self.border.vs_later.val() {
            self.syncs.next = self.syncs.val() | 2;
        }
        if self.border.de.val() {
            self.syncs.next = self.syncs.val() | 4;
        }
        self.marks.clock.next = self.clock.val();
        self.marks.data.next = self.syncs.val();

        // Syncs go with blue.
        self.blue.clock.next = self.clock.val();
        self.blue.de.next = self.marks.delayed.val().get_bit(2);
        self.blue.byte.next = self.sink.colours.val().get_bits::<8>(0);
        self.blue.control.next = self.marks.delayed.val().get_bits::<2>(0);
        self.green.clock.next = self.clock.val();
        self.green.de.next = self.marks.delayed.val().get_bit(2);
        self.green.byte.next = self.sink.colours.val().get_bits::<8>(8);
        self.green.control.next = 0.into();
        self.red.clock.next = self.clock.val();
        self.red.de.next = self.marks.delayed.val().get_bit(2);
        self.red.byte.next = self.sink.colours.val().get_bits::<8>(16);
        self.red.control.next = 0.into();

        self.serialiser.word_clock.next = self.clock.val();
        self.serialiser.bit_clock.next = self.bit_clock.val();
        self.serialiser.word.next = bit_cast::<40, 10>(self.blue.symbol.val())
            | (bit_cast::<40, 10>(self.green.symbol.val()) << 10)
            | (bit_cast::<40, 10>(self.red.symbol.val()) << 20)
            | (bit_cast::<40, 10>(self.clock_symbol.val()) << 30);
        self.out.clock.next = self.bit_clock.val();
        self.out.first.next = self.serialiser.first.val();
        self.out.second.next = self.serialiser.second.val();
        self.pins.next = self.out.pins.val();
    }
}
