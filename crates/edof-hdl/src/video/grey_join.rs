//! Raw frames out of grey pixels.

use super::Coordinate;
use crate::describe::{Circuit, kernel};
use crate::ports::{StreamIn, StreamOut};
use edof_device::design::FrameSize;
use rust_hdl::prelude::*;

/// Raw frames in grey (docs/contract.md, 1.4) become raw frames: two pixels a word, two frames of video a raw frame.
///
/// With `grey` 0 pixels pass without a register. With `grey` 1 a word stands on the output in the cycle after its second pixel. A lower half
/// continues the frame of the upper half that was whole before it, and a word whose mark differs from the upper half's first line ends the
/// frame: what comes to the end of it is thrown away, and its receiver sees the next first pixel too early. Of a lower half without its upper
/// half only the first word goes on, as a frame's first. After `grey` changed pixels are thrown away up to the next frame's first one.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct GreyJoin {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets everything.
    pub reset: Signal<In, Bit>,
    /// Pixels are grey, and carry half a word each.
    pub grey: Signal<In, Bit>,
    /// The bus' pixels: their luma in the upper seven bits.
    pub source: StreamIn<16>,
    /// Raw pixel words.
    pub pixels: StreamOut<16>,
    expected_height: Constant<Coordinate>,
    #[reset(false)]
    is_grey: DFF<Bit>,
    #[reset(false)]
    sending: DFF<Bit>,
    #[reset(false)]
    is_second: DFF<Bit>,
    upper_code: DFF<Bits<7>>,
    begins: DFF<Bit>,
    place: DFF<Bits<16>>,
    tag: DFF<Bits<16>>,
    #[reset(false)]
    is_learning: DFF<Bit>,
    #[reset(false)]
    is_lower: DFF<Bit>,
    row: DFF<Coordinate>,
    #[reset(false)]
    out_valid_q: DFF<Bit>,
    out_word_q: DFF<Bits<16>>,
    out_first_q: DFF<Bit>,
    out_last_q: DFF<Bit>,
    passes: Signal<Local, Bit>,
    can_take: Signal<Local, Bit>,
    mark: Signal<Local, Bit>,
    place_now: Signal<Local, Bits<16>>,
    marked_place: Signal<Local, Bits<16>>,
    row_now: Signal<Local, Coordinate>,
    tag_bit: Signal<Local, Bit>,
    continues: Signal<Local, Bit>,
    goes_on: Signal<Local, Bit>,
}

impl GreyJoin {
    /// For frames of a size.
    #[must_use]
    pub fn new(frame: FrameSize) -> Self {
        Self::from_parts(GreyJoinParts { expected_height: Constant::new((frame.height as u64).into()) })
    }
}

impl Logic for GreyJoin {
    #[kernel]
    fn update(&mut self) {
        self.is_grey.d.next = self.grey.val();

        // Words that are whole already pass from a frame's first one on.
        self.passes.next = self.sending.q.val() || self.source.user.val();
        self.can_take.next = self.pixels.ready.val() || !self.out_valid_q.q.val();
        self.source.ready.next = self.pixels.ready.val() || !(self.source.valid.val() && self.passes.val());
        self.pixels.valid.next = self.source.valid.val() && self.passes.val();
        self.pixels.data.next = self.source.data.val();
        self.pixels.user.next = self.source.user.val();
        self.pixels.last.next = self.source.last.val();
        if self.is_grey.q.val() {
            self.source.ready.next = self.can_take.val();
            self.pixels.valid.next = self.out_valid_q.q.val();
            self.pixels.data.next = self.out_word_q.q.val();
            self.pixels.user.next = self.out_first_q.q.val();
            self.pixels.last.next = self.out_last_q.q.val();
        } else if self.source.valid.val() && self.source.user.val() {
            self.sending.d.next = true;
        }

        // The place of a word is that of its mark, one of 16 bits; a line begins with the lowest.
        self.mark.next = self.source.data.val().get_bit(9);
        self.place_now.next = self.place.q.val();
        self.row_now.next = self.row.q.val();
        if self.begins.q.val() {
            self.place_now.next = 1.into();
            self.row_now.next = 0.into();
        }
        self.marked_place.next = 0.into();
        if self.mark.val() {
            self.marked_place.next = self.place_now.val();
        }
        self.tag_bit.next = (self.tag.q.val() & self.place_now.val()).any()
            || (self.is_lower.q.val() && self.place_now.val().get_bit(0));
        self.continues.next = self.sending.q.val()
            && !self.is_lower.q.val()
            && (self.row.q.val() == self.expected_height.val());
        self.goes_on.next =
            self.sending.q.val() && (self.is_learning.q.val() || (self.mark.val() == self.tag_bit.val()));
        if self.begins.q.val() {
            self.goes_on.next = !self.mark.val() || self.continues.val();
        }

        if self.is_grey.q.val() && self.pixels.ready.val() {
            self.out_valid_q.d.next = false;
        }
        if self.is_grey.q.val() && self.source.valid.val() && self.can_take.val() {
            self.is_second.d.next = !self.is_second.q.val() || self.source.user.val();
            if !self.is_second.q.val() || self.source.user.val() {
                self.upper_code.d.next = self.source.data.val().get_bits::<7>(9);
                self.begins.d.next = self.source.user.val();
                // A frame was cut off after half a word.
                if self.is_second.q.val() {
                    self.sending.d.next = false;
                }
            } else {
                // A word is whole.
                self.begins.d.next = false;
                self.sending.d.next = self.goes_on.val();
                self.place.d.next =
                    (self.place_now.val() << 1) | bit_cast::<16, 1>(self.place_now.val().get_bits::<1>(15));
                self.row.d.next = self.row_now.val();
                if self.is_learning.q.val() {
                    self.tag.d.next = self.tag.q.val() | self.marked_place.val();
                }
                if self.begins.q.val() {
                    self.is_lower.d.next = self.mark.val();
                    self.is_learning.d.next = !self.mark.val();
                    if !self.mark.val() {
                        self.tag.d.next = 0.into();
                    }
                }
                if self.place_now.val().get_bit(15) {
                    self.is_learning.d.next = false;
                }
                if self.source.last.val() {
                    self.is_learning.d.next = false;
                    self.place.d.next = 1.into();
                    self.row.d.next = self.row_now.val() + 1;
                }
                self.out_valid_q.d.next = self.goes_on.val() || self.begins.q.val();
                self.out_word_q.d.next = (bit_cast::<16, 7>(self.upper_code.q.val()) << 9)
                    | (bit_cast::<16, 6>(self.source.data.val().get_bits::<6>(10)) << 3);
                self.out_first_q.d.next = self.begins.q.val() && !(self.mark.val() && self.continues.val());
                self.out_last_q.d.next = self.source.last.val() && self.row_now.val().get_bit(0);
            }
        }
        if self.grey.val() != self.is_grey.q.val() {
            self.sending.d.next = false;
            self.is_second.d.next = false;
            self.out_valid_q.d.next = false;
        }
    }
}
