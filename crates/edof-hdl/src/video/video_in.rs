//! The bus of a receiver.

use super::Coordinate;
use crate::describe::{Circuit, kernel};
use edof_device::design::FrameSize;
use rust_hdl::prelude::*;

/// The 16-bit 4:2:2 bus of a receiver with separate syncs, from which raw pixel words come: bits 15 to 9 plus 64 lie where Y does (bits 0
/// to 7), bits 8 to 2 plus 64 where C does, and bits 1 and 0 are 0. Out goes a stream as AXI4-Stream has it for video.
/// A pixel stands on the output four cycles after it was on the pins. A frame begins with the first pixel after an edge of the vertical
/// sync, whichever its polarity. A frame whose line has another width than the design's, which ends early, or which is not taken in
/// time is left as it is: its receiver must not take it for whole until all of its pixels have come, and sees the next first pixel.
/// So is one in which the horizontal sync pauses for 8191 cycles, or in which a code lies outside of 64 to 191. Lines beyond the design's height are left out. What was measured of a
/// frame stands with its end, the first after a loss left out. With `plain` the output is every pixel's two bytes, Y above C, whatever they are.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct VideoIn {
    /// The bus' own clock.
    pub clock: Signal<In, Clock>,
    /// Forgets everything.
    pub reset: Signal<In, Bit>,
    /// Horizontal sync.
    pub hs: Signal<In, Bit>,
    /// Vertical sync.
    pub vs: Signal<In, Bit>,
    /// A pixel is on the bus.
    pub de: Signal<In, Bit>,
    /// Bits of the pixel: Y low, C high, each with seven bits of a raw pixel word.
    pub data: Signal<In, Bits<16>>,
    /// Any bytes are pixels, from the next cycle on.
    pub plain: Signal<In, Bit>,
    /// A raw pixel word stands on the output.
    pub pixels_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub pixels_ready: Signal<In, Bit>,
    /// The raw pixel word.
    pub pixels_data: Signal<Out, Bits<16>>,
    /// The pixel is the first of its frame.
    pub pixels_user: Signal<Out, Bit>,
    /// The pixel is the last of its line.
    pub pixels_last: Signal<Out, Bit>,
    /// Pixels of the last line.
    pub width: Signal<Out, Coordinate>,
    /// Lines of the last frame that had pixels.
    pub height: Signal<Out, Coordinate>,
    /// Cycles between the last two horizontal syncs.
    pub line_cycles: Signal<Out, Coordinate>,
    /// Horizontal syncs of the last frame.
    pub lines: Signal<Out, Coordinate>,
    /// Frames come.
    pub present: Signal<Out, Bit>,
    /// The last frame had the design's width and height.
    pub fits: Signal<Out, Bit>,
    /// Frames that had them.
    pub right_frames: Signal<Out, Bits<32>>,
    /// Frames that had others.
    pub wrong_frames: Signal<Out, Bits<32>>,
    /// Frames with a code outside of 64 to 191, of whatever size.
    pub range_frames: Signal<Out, Bits<32>>,
    /// Frames given up because a pixel was not taken in time.
    pub overruns: Signal<Out, Bits<32>>,
    expected_width: Constant<Coordinate>,
    expected_height: Constant<Coordinate>,
    last_column: Constant<Coordinate>,
    frame_cycles: Constant<Bits<24>>,
    #[is(4 * frame_cycles)]
    max_wait: Constant<Bits<24>>,
    hs_1: DFF<Bit>,
    vs_1: DFF<Bit>,
    de_1: DFF<Bit>,
    data_1: DFF<Bits<16>>,
    hs_2: DFF<Bit>,
    vs_2: DFF<Bit>,
    de_2: DFF<Bit>,
    pixel_2: DFF<Bits<16>>,
    in_range_2: DFF<Bit>,
    line_begins_2: DFF<Bit>,
    line_ends_2: DFF<Bit>,
    frame_ends_2: DFF<Bit>,
    sync_2: DFF<Bit>,
    #[reset(0)]
    column: DFF<Coordinate>,
    #[reset(0)]
    row: DFF<Coordinate>,
    #[reset(false)]
    begins: DFF<Bit>,
    #[reset(true)]
    malformed: DFF<Bit>,
    #[reset(false)]
    stray: DFF<Bit>,
    #[reset(false)]
    size_known: DFF<Bit>,
    #[reset(false)]
    sending: DFF<Bit>,
    pixel_3: DFF<Bits<16>>,
    #[reset(false)]
    send_3: DFF<Bit>,
    first_3: DFF<Bit>,
    last_3: DFF<Bit>,
    #[reset(false)]
    out_valid_q: DFF<Bit>,
    out_pixel_q: DFF<Bits<16>>,
    out_first_q: DFF<Bit>,
    out_last_q: DFF<Bit>,
    #[reset(0)]
    width_q: DFF<Coordinate>,
    #[reset(0)]
    height_q: DFF<Coordinate>,
    #[reset(0)]
    cycles: DFF<Coordinate>,
    #[reset(0)]
    line_cycles_q: DFF<Coordinate>,
    #[reset(0)]
    syncs: DFF<Coordinate>,
    #[reset(0)]
    lines_q: DFF<Coordinate>,
    #[reset(max_wait)]
    wait_count: DFF<Bits<24>>,
    #[reset(false)]
    present_q: DFF<Bit>,
    #[reset(false)]
    fits_q: DFF<Bit>,
    #[reset(0)]
    right_q: DFF<Bits<32>>,
    #[reset(0)]
    wrong_q: DFF<Bits<32>>,
    #[reset(0)]
    range_q: DFF<Bits<32>>,
    #[reset(0)]
    overruns_q: DFF<Bits<32>>,
    row_now: Signal<Local, Coordinate>,
    column_now: Signal<Local, Coordinate>,
    send: Signal<Local, Bit>,
    ends: Signal<Local, Bit>,
    is_stalled: Signal<Local, Bit>,
    size_matches: Signal<Local, Bit>,
}

impl VideoIn {
    /// For frames of one size. After `max_wait` cycles (a multiple of 4 below 2²⁴) without an edge of the vertical sync there is no signal.
    #[must_use]
    pub fn new(frame: FrameSize, max_wait: u32) -> Self {
        let number = |value: usize| Constant::new((value as u64).into());
        Self::from_parts(VideoInParts {
            expected_width: number(frame.width),
            expected_height: number(frame.height),
            last_column: number(frame.width - 1),
            frame_cycles: Constant::new(u64::from(max_wait / 4).into()),
        })
    }
}

impl Logic for VideoIn {
    #[kernel]
    fn update(&mut self) {
        // Cycles 1 and 2: the pins, and what changed on them.
        self.hs_1.d.next = self.hs.val();
        self.vs_1.d.next = self.vs.val();
        self.de_1.d.next = self.de.val();
        self.data_1.d.next = self.data.val();
        self.hs_2.d.next = self.hs_1.q.val();
        self.vs_2.d.next = self.vs_1.q.val();
        self.de_2.d.next = self.de_1.q.val();
        // Less 64, seven bits are left: the lower six, and the topmost. Codes of 64 to 191 are those whose upper two bits differ.
        self.pixel_2.d.next = (bit_cast::<16, 1>(self.data_1.q.val().get_bits::<1>(7)) << 15)
            | (bit_cast::<16, 6>(self.data_1.q.val().get_bits::<6>(0)) << 9)
            | (bit_cast::<16, 1>(self.data_1.q.val().get_bits::<1>(15)) << 8)
            | (bit_cast::<16, 6>(self.data_1.q.val().get_bits::<6>(8)) << 2);
        self.in_range_2.d.next = (self.data_1.q.val().get_bit(7) ^ self.data_1.q.val().get_bit(6))
            && (self.data_1.q.val().get_bit(15) ^ self.data_1.q.val().get_bit(14));
        if self.plain.val() {
            self.pixel_2.d.next = (bit_cast::<16, 8>(self.data_1.q.val().get_bits::<8>(0)) << 8)
                | bit_cast::<16, 8>(self.data_1.q.val().get_bits::<8>(8));
            self.in_range_2.d.next = true;
        }
        self.line_begins_2.d.next = self.de_1.q.val() && !self.de_2.q.val();
        self.line_ends_2.d.next = !self.de_1.q.val() && self.de_2.q.val();
        self.frame_ends_2.d.next = self.vs_1.q.val() ^ self.vs_2.q.val();
        self.sync_2.d.next = self.hs_1.q.val() && !self.hs_2.q.val();

        // Where the pixel lies. A frame ends with the vertical sync; the next one begins with a pixel.
        self.column_now.next = self.column.q.val();
        self.row_now.next = self.row.q.val();
        if self.line_begins_2.q.val() {
            self.column_now.next = 0.into();
        }
        if self.line_begins_2.q.val() && self.begins.q.val() {
            self.row_now.next = 0.into();
        }
        self.row.d.next = self.row_now.val();
        if self.de_2.q.val() && !self.column_now.val().all() {
            self.column.d.next = self.column_now.val() + 1;
        }
        if self.line_begins_2.q.val() {
            self.begins.d.next = false;
        }
        if self.line_ends_2.q.val() {
            self.width_q.d.next = self.column.q.val();
            if self.column.q.val() != self.expected_width.val() {
                self.malformed.d.next = true;
                self.sending.d.next = false;
            }
            if !self.row.q.val().all() {
                self.row.d.next = self.row.q.val() + 1;
            }
        }

        // Cycle 3: whether it is sent. A line's last pixel must be its last on the bus, too.
        self.send.next = self.sending.q.val();
        if self.line_begins_2.q.val() && self.begins.q.val() {
            self.send.next = true;
            self.sending.d.next = true;
        }
        self.ends.next = self.column_now.val() == self.last_column.val();
        if self.de_2.q.val() && !self.in_range_2.q.val() {
            self.stray.d.next = true;
            self.sending.d.next = false;
        }
        self.send_3.d.next = self.de_2.q.val()
            && self.send.val()
            && self.in_range_2.q.val()
            && !(self.ends.val() && self.de_1.q.val())
            && (self.column_now.val() < self.expected_width.val())
            && (self.row_now.val() < self.expected_height.val());
        self.first_3.d.next = !self.column_now.val().any() && !self.row_now.val().any();
        self.last_3.d.next = self.ends.val();
        self.pixel_3.d.next = self.pixel_2.q.val();

        // Cycle 4: out. What stands there and is not taken in time ends the frame.
        self.is_stalled.next = self.out_valid_q.q.val() && !self.pixels_ready.val();
        if !self.is_stalled.val() {
            self.out_valid_q.d.next = self.send_3.q.val();
            self.out_pixel_q.d.next = self.pixel_3.q.val();
            self.out_first_q.d.next = self.first_3.q.val();
            self.out_last_q.d.next = self.last_3.q.val();
        }
        if self.is_stalled.val() && self.send_3.q.val() {
            self.sending.d.next = false;
            self.send_3.d.next = false;
            self.overruns_q.d.next = self.overruns_q.q.val() + 1;
        }
        self.pixels_valid.next = self.out_valid_q.q.val();
        self.pixels_data.next = self.out_pixel_q.q.val();
        self.pixels_user.next = self.out_first_q.q.val();
        self.pixels_last.next = self.out_last_q.q.val();

        // What is measured.
        if !self.cycles.q.val().all() {
            self.cycles.d.next = self.cycles.q.val() + 1;
        } else {
            self.malformed.d.next = true;
            self.sending.d.next = false;
        }
        if self.sync_2.q.val() {
            self.cycles.d.next = 1.into();
            self.line_cycles_q.d.next = self.cycles.q.val();
            if !self.syncs.q.val().all() {
                self.syncs.d.next = self.syncs.q.val() + 1;
            }
        }
        self.size_matches.next = !self.malformed.q.val()
            && (self.row.q.val() == self.expected_height.val())
            && !self.begins.q.val();
        if self.wait_count.q.val() != self.max_wait.val() {
            self.wait_count.d.next = self.wait_count.q.val() + 1;
        } else {
            self.size_known.d.next = false;
            self.present_q.d.next = false;
            self.fits_q.d.next = false;
        }
        if self.frame_ends_2.q.val() {
            self.wait_count.d.next = 0.into();
        }
        if self.frame_ends_2.q.val() && !self.begins.q.val() {
            self.begins.d.next = true;
            self.malformed.d.next = false;
            self.stray.d.next = false;
            self.sending.d.next = false;
            self.syncs.d.next = 0.into();
            if self.sync_2.q.val() {
                self.syncs.d.next = 1.into();
            }
            self.size_known.d.next = true;
        }
        if self.frame_ends_2.q.val() && !self.begins.q.val() && self.size_known.q.val() {
            self.present_q.d.next = true;
            self.fits_q.d.next = self.size_matches.val();
            self.height_q.d.next = self.row.q.val();
            self.lines_q.d.next = self.syncs.q.val();
            if self.size_matches.val() {
                self.right_q.d.next = self.right_q.q.val() + 1;
            } else {
                self.wrong_q.d.next = self.wrong_q.q.val() + 1;
            }
            if self.stray.q.val() {
                self.range_q.d.next = self.range_q.q.val() + 1;
            }
        }
        self.width.next = self.width_q.q.val();
        self.height.next = self.height_q.q.val();
        self.line_cycles.next = self.line_cycles_q.q.val();
        self.lines.next = self.lines_q.q.val();
        self.present.next = self.present_q.q.val();
        self.fits.next = self.fits_q.q.val();
        self.right_frames.next = self.right_q.q.val();
        self.wrong_frames.next = self.wrong_q.q.val();
        self.range_frames.next = self.range_q.q.val();
        self.overruns.next = self.overruns_q.q.val();
    }
}
