//! What a screen shows of 4:2:2.

use super::scale::Scale;
use super::{Factor, Wide};
use crate::blocks::delay::Delay;
use crate::describe::{Circuit, kernel};
use edof_core::display::{BLACK, SINK_CHROMA, SINK_LUMA, Sink};
use rust_hdl::prelude::*;

// Where a code begins in its sum.
const _: () = assert!(Sink::FRAC_NBITS == 16);

/// Cycles from a pixel to its colours.
pub const LATENCY: usize = 11;

/// Red, green and blue of a 4:2:2 bus as a sink makes them (docs/contract.md, 5.4), eleven cycles later; 0 where there is no pixel. A line has
/// an even number of pixels, and a cycle without a pixel before it.
#[derive(Circuit)]
#[circuit(default(Scale, Delay), registers(clock))]
pub struct SinkRgb {
    /// The pixel clock.
    pub clock: Signal<In, Clock>,
    /// A pixel is on the bus.
    pub de: Signal<In, Bit>,
    /// Codes of the pixel: Y' low, Cb' or Cr' high.
    pub data: Signal<In, Bits<16>>,
    /// Blue, green and red, blue low.
    pub colours: Signal<Out, Bits<24>>,
    #[signed]
    of_luma: Constant<Factor>,
    #[signed]
    red_of_cr: Constant<Factor>,
    #[signed]
    green_of_cb: Constant<Factor>,
    #[signed]
    green_of_cr: Constant<Factor>,
    #[signed]
    blue_of_cb: Constant<Factor>,
    luma_base: Constant<Wide>,
    de_1: DFF<Bit>,
    data_1: DFF<Bits<16>>,
    de_2: DFF<Bit>,
    odd_2: DFF<Bit>,
    data_2: DFF<Bits<16>>,
    chroma_3: DFF<Bits<8>>,
    cb: DFF<Factor>,
    cr: DFF<Factor>,
    luma_to_3: DFF<Bits<8>>,
    cb_to_5: Delay<18, 2>,
    cr_to_5: Delay<18, 2>,
    cr_to_7: Delay<18, 2>,
    de_to_10: Delay<1, 8>,
    luma: Scale,
    red: Scale,
    green_part: Scale,
    green: Scale,
    blue: Scale,
    red_to_10: Delay<48, 2>,
    blue_to_10: Delay<48, 2>,
    sums: [Signal<Local, Wide>; 3],
    codes: [Signal<Local, Bits<8>>; 3],
    colours_11: DFF<Bits<24>>,
    next_cb: Signal<Local, Bits<9>>,
    next_cr: Signal<Local, Bits<9>>,
    site_cb: Signal<Local, Bits<9>>,
    site_cr: Signal<Local, Bits<9>>,
}

/// A coefficient in two's complement.
fn factor(coefficient: Sink) -> Constant<Factor> {
    Constant::new(((coefficient.to_bits() as u64) & 0x3_ffff).into())
}

impl Default for SinkRgb {
    fn default() -> Self {
        let [[_, red_of_cr], [green_of_cb, green_of_cr], [blue_of_cb, _]] =
            SINK_CHROMA.map(|row| row.map(factor));
        let black = i64::from(SINK_LUMA.to_bits()) * i64::from(BLACK);
        let base = (1 << (Sink::FRAC_NBITS - 1)) - black;
        Self::from_parts(SinkRgbParts {
            of_luma: factor(SINK_LUMA),
            red_of_cr,
            green_of_cb,
            green_of_cr,
            blue_of_cb,
            luma_base: Constant::new(((base as u64) & ((1 << 48) - 1)).into()),
        })
    }
}

impl Logic for SinkRgb {
    #[kernel]
    fn update(&mut self) {
        // Three pixels of a line, the newest first; and the chroma of the one before them.
        self.de_1.d.next = self.de.val();
        self.data_1.d.next = self.data.val();
        self.de_2.d.next = self.de_1.q.val();
        self.data_2.d.next = self.data_1.q.val();
        self.odd_2.d.next = self.de_2.q.val() && !self.odd_2.q.val();
        self.chroma_3.d.next = self.data_2.q.val().get_bits::<8>(8);

        // Twice the chroma: of its own site, or the sum of its neighbours'; after the last site twice that.
        self.site_cb.next = bit_cast::<9, 8>(self.data_2.q.val().get_bits::<8>(8));
        self.site_cr.next = bit_cast::<9, 8>(self.data_1.q.val().get_bits::<8>(8));
        if self.odd_2.q.val() {
            self.site_cb.next = bit_cast::<9, 8>(self.chroma_3.q.val());
            self.site_cr.next = bit_cast::<9, 8>(self.data_2.q.val().get_bits::<8>(8));
        }
        self.next_cb.next = self.site_cb.val();
        self.next_cr.next = self.site_cr.val();
        if self.odd_2.q.val() && self.de_1.q.val() {
            self.next_cb.next = bit_cast::<9, 8>(self.data_1.q.val().get_bits::<8>(8));
            self.next_cr.next = bit_cast::<9, 8>(self.data.val().get_bits::<8>(8));
        }
        self.cb.d.next = bit_cast::<18, 9>(self.site_cb.val() + self.next_cb.val()) - 256;
        self.cr.d.next = bit_cast::<18, 9>(self.site_cr.val() + self.next_cr.val()) - 256;
        self.luma_to_3.d.next = self.data_2.q.val().get_bits::<8>(0);

        // Products, each added to the one before it.
        self.luma.clock.next = self.clock.val();
        self.luma.value.next = bit_cast::<18, 8>(self.luma_to_3.q.val());
        self.luma.factor.next = self.of_luma.val();
        self.luma.addend.next = self.luma_base.val();
        self.cb_to_5.clock.next = self.clock.val();
        self.cb_to_5.data.next = self.cb.q.val();
        self.cr_to_5.clock.next = self.clock.val();
        self.cr_to_5.data.next = self.cr.q.val();
        self.cr_to_7.clock.next = self.clock.val();
        self.cr_to_7.data.next = self.cr_to_5.delayed.val();
        self.red.clock.next = self.clock.val();
        self.red.value.next = self.cr_to_5.delayed.val();
        self.red.factor.next = self.red_of_cr.val();
        self.red.addend.next = self.luma.sum.val();
        self.blue.clock.next = self.clock.val();
        self.blue.value.next = self.cb_to_5.delayed.val();
        self.blue.factor.next = self.blue_of_cb.val();
        self.blue.addend.next = self.luma.sum.val();
        self.green_part.clock.next = self.clock.val();
        self.green_part.value.next = self.cb_to_5.delayed.val();
        self.green_part.factor.next = self.green_of_cb.val();
        self.green_part.addend.next = self.luma.sum.val();
        self.green.clock.next = self.clock.val();
        self.green.value.next = self.cr_to_7.delayed.val();
        self.green.factor.next = self.green_of_cr.val();
        self.green.addend.next = self.green_part.sum.val();
        self.red_to_10.clock.next = self.clock.val();
        self.red_to_10.data.next = self.red.sum.val();
        self.blue_to_10.clock.next = self.clock.val();
        self.blue_to_10.data.next = self.blue.sum.val();
        self.de_to_10.clock.next = self.clock.val();
        self.de_to_10.data.next = self.de_2.q.val().into();

        // The nearest code that there is.
        self.sums[0].next = self.blue_to_10.delayed.val();
        self.sums[1].next = self.green.sum.val();
        self.sums[2].next = self.red_to_10.delayed.val();
        for i in 0..3 {
            self.codes[i].next = self.sums[i].val().get_bits::<8>(16);
            if self.sums[i].val().get_bits::<8>(24).any() {
                self.codes[i].next = 255.into();
            }
            if self.sums[i].val().get_bit(47) || !self.de_to_10.delayed.val().any() {
                self.codes[i].next = 0.into();
            }
        }
        self.colours_11.d.next = bit_cast::<24, 8>(self.codes[0].val())
            | (bit_cast::<24, 8>(self.codes[1].val()) << 8)
            | (bit_cast::<24, 8>(self.codes[2].val()) << 16);
        self.colours.next = self.colours_11.q.val();
    }
}
