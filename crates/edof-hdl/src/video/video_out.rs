//! The timing of a screen.

use super::Coordinate;
use crate::describe::{Circuit, kernel};
use edof_core::display::BLACK_PIXEL;
use edof_device::video::VideoTiming;
use rust_hdl::prelude::*;

/// The 16-bit 4:2:2 bus of a transmitter with separate syncs, positive pulses. A frame is shown whole if its first pixel waits as the
/// picture begins; black otherwise, so black until the first one. A frame whose pixels come late is black from there on, and counted;
/// what is left of it is dropped before the next picture begins. A pixel is on the pins two cycles after it was taken.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct VideoOut {
    /// The pixel clock.
    pub clock: Signal<In, Clock>,
    /// Starts a frame anew, in black.
    pub reset: Signal<In, Bit>,
    /// The input pixel is valid.
    pub pixels_valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub pixels_ready: Signal<Out, Bit>,
    /// Codes of the pixel: Y' low, Cb' or Cr' high.
    pub pixels_data: Signal<In, Bits<16>>,
    /// The pixel is the first of its frame.
    pub pixels_user: Signal<In, Bit>,
    /// The pixel is the last of its line; unused.
    pub pixels_last: Signal<In, Bit>,
    /// Horizontal sync.
    pub hs: Signal<Out, Bit>,
    /// Vertical sync.
    pub vs: Signal<Out, Bit>,
    /// A pixel is on the bus.
    pub de: Signal<Out, Bit>,
    /// Codes of the pixel.
    pub data: Signal<Out, Bits<16>>,
    /// Frames begun with a picture.
    pub shown_frames: Signal<Out, Bits<32>>,
    /// Frames counted in `shown_frames` whose pixels came late.
    pub late_pixels: Signal<Out, Bits<32>>,
    black: Constant<Bits<16>>,
    last_column: Constant<Coordinate>,
    last_row: Constant<Coordinate>,
    width: Constant<Coordinate>,
    height: Constant<Coordinate>,
    hs_on: Constant<Coordinate>,
    hs_off: Constant<Coordinate>,
    vs_on: Constant<Coordinate>,
    vs_off: Constant<Coordinate>,
    #[reset(width)]
    column: DFF<Coordinate>,
    #[reset(height)]
    row: DFF<Coordinate>,
    #[reset(false)]
    column_ends: DFF<Bit>,
    #[reset(false)]
    row_ends: DFF<Bit>,
    #[reset(false)]
    active: DFF<Bit>,
    #[reset(false)]
    begins: DFF<Bit>,
    #[reset(false)]
    hs_q: DFF<Bit>,
    #[reset(false)]
    vs_q: DFF<Bit>,
    #[reset(false)]
    showing: DFF<Bit>,
    de_1: DFF<Bit>,
    hs_1: DFF<Bit>,
    vs_1: DFF<Bit>,
    data_1: DFF<Bits<16>>,
    de_2: DFF<Bit>,
    hs_2: DFF<Bit>,
    vs_2: DFF<Bit>,
    data_2: DFF<Bits<16>>,
    #[reset(0)]
    shown_q: DFF<Bits<32>>,
    #[reset(0)]
    late_q: DFF<Bits<32>>,
    column_next: Signal<Local, Coordinate>,
    row_next: Signal<Local, Coordinate>,
    showing_next: Signal<Local, Bit>,
    request: Signal<Local, Bit>,
    pop: Signal<Local, Bit>,
    underrun: Signal<Local, Bit>,
}

impl VideoOut {
    /// For a timing whose lines and frames are shorter than 4096.
    #[must_use]
    pub fn new(timing: VideoTiming) -> Self {
        let number = |value: usize| Constant::new((value as u64).into());
        let (line, frame) = (timing.line, timing.frame);
        Self::from_parts(VideoOutParts {
            black: Constant::new(u64::from(BLACK_PIXEL).into()),
            last_column: number(line.total() - 1),
            last_row: number(frame.total() - 1),
            width: number(line.active),
            height: number(frame.active),
            hs_on: number(line.active + line.front),
            hs_off: number(line.active + line.front + line.sync),
            // The sync of a row here is the first of the next one where lines begin with their sync, as in the standards.
            vs_on: number(frame.active + frame.front - 1),
            vs_off: number(frame.active + frame.front + frame.sync - 1),
        })
    }
}

impl Logic for VideoOut {
    #[kernel]
    fn update(&mut self) {
        // Where the screen is.
        self.column_next.next = self.column.q.val() + 1;
        if self.column_ends.q.val() {
            self.column_next.next = 0.into();
        }
        self.row_next.next = self.row.q.val();
        if self.column_ends.q.val() {
            self.row_next.next = self.row.q.val() + 1;
            if self.row_ends.q.val() {
                self.row_next.next = 0.into();
            }
        }
        self.column.d.next = self.column_next.val();
        self.row.d.next = self.row_next.val();
        self.column_ends.d.next = self.column_next.val() == self.last_column.val();
        self.row_ends.d.next = self.row_next.val() == self.last_row.val();
        self.active.d.next =
            (self.column_next.val() < self.width.val()) && (self.row_next.val() < self.height.val());
        self.begins.d.next = !self.column_next.val().any() && !self.row_next.val().any();
        self.hs_q.d.next =
            (self.column_next.val() >= self.hs_on.val()) && (self.column_next.val() < self.hs_off.val());
        if self.column_next.val() == self.hs_on.val() {
            self.vs_q.d.next =
                (self.row_next.val() >= self.vs_on.val()) && (self.row_next.val() < self.vs_off.val());
        }

        // A picture begins with its first pixel and takes one in each cell that is seen; between pictures what is no first is dropped.
        self.showing_next.next = self.showing.q.val();
        if self.begins.q.val() {
            self.showing_next.next = self.pixels_valid.val() && self.pixels_user.val();
        }
        self.request.next = self.active.q.val() && self.showing_next.val();
        self.pop.next = self.begins.q.val() || !self.showing.q.val() || self.active.q.val();
        self.pixels_ready.next = self.pop.val();
        if self.pixels_user.val() {
            self.pixels_ready.next = self.begins.q.val();
        }
        self.underrun.next = self.request.val()
            && (!self.pixels_valid.val() || (self.pixels_user.val() && !self.begins.q.val()));
        self.showing.d.next = self.showing_next.val() && !self.underrun.val();

        // To the pins.
        self.data_1.d.next = self.black.val();
        if self.request.val() && !self.underrun.val() {
            self.data_1.d.next = self.pixels_data.val();
        }
        self.de_1.d.next = self.active.q.val();
        self.hs_1.d.next = self.hs_q.q.val();
        self.vs_1.d.next = self.vs_q.q.val();
        self.data_2.d.next = self.data_1.q.val();
        self.de_2.d.next = self.de_1.q.val();
        self.hs_2.d.next = self.hs_1.q.val();
        self.vs_2.d.next = self.vs_1.q.val();
        self.data.next = self.data_2.q.val();
        self.de.next = self.de_2.q.val();
        self.hs.next = self.hs_2.q.val();
        self.vs.next = self.vs_2.q.val();

        if self.begins.q.val() && self.showing_next.val() {
            self.shown_q.d.next = self.shown_q.q.val() + 1;
        }
        if self.underrun.val() {
            self.late_q.d.next = self.late_q.q.val() + 1;
        }
        self.shown_frames.next = self.shown_q.q.val();
        self.late_pixels.next = self.late_q.q.val();
    }
}
