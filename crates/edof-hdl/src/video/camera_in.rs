//! The bus of a camera, as that of a receiver.

use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// The bus of a camera, a byte per pixel, as [`VideoIn`](super::video_in::VideoIn) takes that of a receiver, a cycle later. A byte less black is the upper half of a raw pixel word; what is
/// below black is 0. Each line's reference is its horizontal sync; where lines pause another one comes every 4096 cycles, so that a long pause between
/// frames is no lost sync.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct CameraIn {
    /// The camera's pixel clock.
    pub clock: Signal<In, Clock>,
    /// Forgets how long lines have paused.
    pub reset: Signal<In, Bit>,
    /// Vertical sync.
    pub camera_vs: Signal<In, Bit>,
    /// A pixel is on the bus.
    pub camera_href: Signal<In, Bit>,
    /// The pixel.
    pub camera_data: Signal<In, Bits<8>>,
    /// Horizontal sync.
    pub hs: Signal<Out, Bit>,
    /// Vertical sync.
    pub vs: Signal<Out, Bit>,
    /// A pixel is on the bus.
    pub de: Signal<Out, Bit>,
    /// Codes of the pixel: Y low, C high, each with seven bits of a raw pixel word.
    pub data: Signal<Out, Bits<16>>,
    black: Constant<Bits<8>>,
    vs_q: DFF<Bit>,
    href_q: DFF<Bit>,
    light_q: DFF<Bits<8>>,
    #[reset(0)]
    pause: DFF<Bits<12>>,
}

impl CameraIn {
    /// Of a camera whose black is such a byte.
    #[must_use]
    pub fn new(black: u8) -> Self {
        Self::from_parts(CameraInParts { black: Constant::new(u64::from(black).into()) })
    }
}

impl Logic for CameraIn {
    #[kernel]
    fn update(&mut self) {
        self.vs_q.d.next = self.camera_vs.val();
        self.href_q.d.next = self.camera_href.val();
        self.light_q.d.next = 0.into();
        if self.camera_data.val() > self.black.val() {
            self.light_q.d.next = self.camera_data.val() - self.black.val();
        }
        self.pause.d.next = self.pause.q.val() + 1;
        if self.camera_href.val() {
            self.pause.d.next = 0.into();
        }

        self.vs.next = self.vs_q.q.val();
        self.de.next = self.href_q.q.val();
        self.hs.next = self.href_q.q.val() || self.pause.q.val().get_bit(11);
        // 64 more than seven bits: the top one, its inverse, and the others. The lower code has one bit alone.
        self.data.next = bit_cast::<16, 6>(self.light_q.q.val().get_bits::<6>(1)) | 0x4040;
        if self.light_q.q.val().get_bit(7) {
            self.data.next = bit_cast::<16, 6>(self.light_q.q.val().get_bits::<6>(1)) | 0x4080;
        }
        if self.light_q.q.val().get_bit(0) {
            self.data.next = self.data.val() ^ 0xc000;
        }
    }
}
