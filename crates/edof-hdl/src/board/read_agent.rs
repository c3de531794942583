//! The newest complete frame buffer as a stream of pixels.

use super::{Buffer, Frames};
use crate::blocks::Row;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiReadMaster, StreamOut};
use edof_core::display::BLACK_PIXEL;
use rust_hdl::prelude::*;

/// The newest complete frame buffer as a stream of pixels, in bursts of full length, several at a time.
///
/// A frame begins when the last pixel of the one before was taken. Where no newer frame is there by then, the same one is sent again
/// and counted as late, or, without `repeats`, the agent waits. A burst is asked for once there is room for all its
/// words, so that the memory never waits. A pixel a cycle, as long as the memory keeps up. From a word on that came with an error the frame
/// is black.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct ReadAgent<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the frame.
    pub reset: Signal<In, Bit>,
    /// The newest complete buffer.
    pub newest: Signal<In, Buffer>,
    /// A frame is sent again where no newer one is there.
    pub repeats: Signal<In, Bit>,
    /// The buffer that is being read.
    pub reading: Signal<Out, Buffer>,
    /// Memory.
    pub dram: AxiReadMaster<W>,
    /// Pixels.
    pub pixels: StreamOut<16>,
    /// Frames that were begun.
    pub frames: Signal<Out, Bits<32>>,
    /// Frames counted in `frames` that repeat an earlier one.
    pub late: Signal<Out, Bits<32>>,
    /// Words that came with an error.
    pub errors: Signal<Out, Bits<32>>,
    /// Such a word came in the cycle before.
    pub corrupted: Signal<Out, Bit>,
    last_column: Constant<Bits<12>>,
    last_row: Constant<Bits<12>>,
    before_last_lane: Constant<Bits<6>>,
    burst: Constant<Row>,
    max_held: Constant<Row>,
    row_mask: Constant<Row>,
    frame_words: Constant<Bits<24>>,
    burst_words: Constant<Bits<24>>,
    burst_bytes: Constant<Bits<32>>,
    word_size: Constant<Bits<3>>,
    base_0: Constant<Bits<32>>,
    base_1: Constant<Bits<32>>,
    base_2: Constant<Bits<32>>,
    black: Constant<Bits<16>>,
    #[reset(false)]
    busy: DFF<Bit>,
    #[reset(3)]
    reading_q: DFF<Buffer>,
    // Words of this frame that are still to be asked for: any, and fewer than a burst, a cycle later.
    #[reset(0)]
    remaining: DFF<Bits<24>>,
    #[reset(false)]
    any_remaining: DFF<Bit>,
    is_last_burst: DFF<Bit>,
    #[reset(false)]
    request: DFF<Bit>,
    // A burst was just accepted: what depends on it follows.
    #[reset(false)]
    settle: DFF<Bit>,
    address: DFF<Bits<32>>,
    request_address: DFF<Bits<32>>,
    request_words: DFF<Row>,
    // Words: asked for, come, taken out of the RAM (and the one after). How many are asked for and not taken, two cycles later.
    #[reset(0)]
    reserved: DFF<Row>,
    #[reset(0)]
    held: DFF<Row>,
    #[reset(false)]
    has_space: DFF<Bit>,
    #[reset(0)]
    write_ptr: DFF<Row>,
    #[reset(0)]
    read_ptr: DFF<Row>,
    #[reset(1)]
    read_ptr_next: DFF<Row>,
    #[reset(0)]
    received: DFF<Row>,
    #[reset(false)]
    has_word: DFF<Bit>,
    #[reset(false)]
    full: DFF<Bit>,
    #[reset(false)]
    is_last_lane: DFF<Bit>,
    word: DFF<Bits<W>>,
    // A word of this frame came with an error; the first is in `word`, or was.
    #[reset(false)]
    black_on: DFF<Bit>,
    #[reset(false)]
    corrupted_q: DFF<Bit>,
    #[reset(0)]
    lane: DFF<Bits<6>>,
    #[reset(0)]
    column: DFF<Bits<12>>,
    #[reset(0)]
    row: DFF<Bits<12>>,
    #[reset(0)]
    frames_q: DFF<Bits<32>>,
    #[reset(0)]
    late_q: DFF<Bits<32>>,
    #[reset(0)]
    errors_q: DFF<Bits<32>>,
    ram: Ram<W>,
    marks: Ram<1>,
    begins: Signal<Local, Bit>,
    words: Signal<Local, Row>,
    pop: Signal<Local, Bit>,
    advance: Signal<Local, Bit>,
    next_read_ptr: Signal<Local, Row>,
    is_line_end: Signal<Local, Bit>,
}

impl<const W: usize> ReadAgent<W> {
    /// An agent for these frames.
    ///
    /// # Panics
    /// For frames that no agent supports; the check of a design excludes them (`edof_device::board`).
    #[must_use]
    pub fn new(frames: &Frames) -> Self {
        frames.check(W);
        let row = |value: usize| Constant::new((value as u64).into());
        let base = frames.buffers.map(|address| Constant::new(u64::from(address).into()));
        let words = frames.width * frames.height / (W / 16);
        Self::from_parts(ReadAgentParts {
            last_column: Constant::new((frames.width as u64 - 1).into()),
            last_row: Constant::new((frames.height as u64 - 1).into()),
            before_last_lane: Constant::new((W as u64 / 16 - 2).into()),
            burst: row(frames.burst),
            max_held: row(frames.depth - frames.burst),
            row_mask: row(frames.depth - 1),
            frame_words: Constant::new((words as u64).into()),
            burst_words: Constant::new((frames.burst as u64).into()),
            burst_bytes: Constant::new((frames.burst as u64 * W as u64 / 8).into()),
            word_size: Constant::new(u64::from((W / 8).ilog2()).into()),
            base_0: base[0],
            base_1: base[1],
            base_2: base[2],
            black: Constant::new(u64::from(BLACK_PIXEL).into()),
            ram: Ram::new(Shape::distributed(frames.depth), &[]),
            marks: Ram::new(Shape::distributed(frames.depth), &[]),
        })
    }
}

impl<const W: usize> Logic for ReadAgent<W> {
    #[kernel]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();
        self.marks.clock.next = self.clock.val();

        // A frame begins.
        self.begins.next = !self.busy.q.val()
            && (self.newest.val() != 3)
            && (self.repeats.val() || (self.newest.val() != self.reading_q.q.val()));
        if self.begins.val() {
            self.busy.d.next = true;
            self.reading_q.d.next = self.newest.val();
            self.frames_q.d.next = self.frames_q.q.val() + 1;
            if self.newest.val() == self.reading_q.q.val() {
                self.late_q.d.next = self.late_q.q.val() + 1;
            }
            self.remaining.d.next = self.frame_words.val();
            self.address.d.next = self.base_0.val();
            if self.newest.val() == 1 {
                self.address.d.next = self.base_1.val();
            } else if self.newest.val() == 2 {
                self.address.d.next = self.base_2.val();
            }
        }

        // Bursts: asked for when there is room for them. What the last one changed is known two cycles after it was accepted.
        self.any_remaining.d.next = self.remaining.q.val().any();
        self.is_last_burst.d.next = self.remaining.q.val() < self.burst_words.val();
        self.held.d.next = self.reserved.q.val() - self.read_ptr.q.val();
        self.has_space.d.next = self.held.q.val() <= self.max_held.val();
        self.words.next = self.burst.val();
        if self.is_last_burst.q.val() {
            self.words.next = self.remaining.q.val().get_bits::<12>(0);
        }
        self.settle.d.next = self.request.q.val();
        if self.request.q.val() && self.dram.ar_ready.val() {
            self.request.d.next = false;
        }
        if !self.request.q.val()
            && !self.settle.q.val()
            && self.any_remaining.q.val()
            && self.has_space.q.val()
        {
            self.request.d.next = true;
            self.request_address.d.next = self.address.q.val();
            self.request_words.d.next = self.words.val();
            self.address.d.next = self.address.q.val() + self.burst_bytes.val();
            self.remaining.d.next = self.remaining.q.val() - self.burst_words.val();
            if self.is_last_burst.q.val() {
                self.remaining.d.next = 0.into();
            }
            self.reserved.d.next = self.reserved.q.val() + self.words.val();
        }

        // Words into the RAM; on its output two cycles later.
        self.received.d.next = self.write_ptr.q.val();
        self.corrupted_q.d.next = self.dram.r_valid.val() && self.dram.r_resp.val().any();
        if self.dram.r_valid.val() {
            self.write_ptr.d.next = self.write_ptr.q.val() + 1;
        }
        if self.corrupted_q.q.val() {
            self.errors_q.d.next = self.errors_q.q.val() + 1;
        }
        self.marks.write_enable.next = self.dram.r_valid.val();
        self.marks.write_address.next = self.write_ptr.q.val() & self.row_mask.val();
        self.marks.write_data.next = bit_cast::<1, 2>(self.dram.r_resp.val() | (self.dram.r_resp.val() >> 1));
        self.ram.write_enable.next = self.dram.r_valid.val();
        self.ram.write_address.next = self.write_ptr.q.val() & self.row_mask.val();
        self.ram.write_data.next = self.dram.r_data.val();

        // Words out of it, and their pixels.
        self.pop.next = self.full.q.val() && self.pixels.ready.val();
        if self.pop.val() {
            self.word.d.next = self.word.q.val() >> 16;
            self.lane.d.next = self.lane.q.val() + 1;
            self.is_last_lane.d.next = self.lane.q.val() == self.before_last_lane.val();
        }
        self.advance.next = !self.full.q.val() || (self.is_last_lane.q.val() && self.pixels.ready.val());
        self.next_read_ptr.next = self.read_ptr.q.val();
        self.has_word.d.next = self.read_ptr.q.val() != self.received.q.val();
        if self.advance.val() {
            self.full.d.next = self.has_word.q.val();
            self.word.d.next = self.ram.read_data.val();
            self.lane.d.next = 0.into();
            self.is_last_lane.d.next = false;
            if self.has_word.q.val() {
                if self.marks.read_data.val().any() {
                    self.black_on.d.next = true;
                }
                self.next_read_ptr.next = self.read_ptr_next.q.val();
                self.read_ptr_next.d.next = self.read_ptr_next.q.val() + 1;
                self.has_word.d.next = self.read_ptr_next.q.val() != self.received.q.val();
            }
        }
        self.read_ptr.d.next = self.next_read_ptr.val();
        // Not held back by a reset: what is read in one is of no meaning.
        self.ram.read_address.next = self.next_read_ptr.val() & self.row_mask.val();
        self.marks.read_address.next = self.next_read_ptr.val() & self.row_mask.val();
        self.is_line_end.next = self.column.q.val() == self.last_column.val();
        if self.pop.val() {
            self.column.d.next = self.column.q.val() + 1;
            if self.is_line_end.val() {
                self.column.d.next = 0.into();
                self.row.d.next = self.row.q.val() + 1;
                if self.row.q.val() == self.last_row.val() {
                    self.row.d.next = 0.into();
                    self.busy.d.next = false;
                    self.black_on.d.next = false;
                }
            }
        }

        self.dram.ar_id.next = 0.into();
        self.dram.ar_addr.next = self.request_address.q.val();
        self.dram.ar_len.next = (self.request_words.q.val() - 1).get_bits::<8>(0);
        self.dram.ar_size.next = self.word_size.val();
        self.dram.ar_burst.next = 1.into();
        self.dram.ar_valid.next = self.request.q.val();
        self.dram.r_ready.next = true;
        self.pixels.valid.next = self.full.q.val();
        self.pixels.data.next = self.word.q.val().get_bits::<16>(0);
        if self.black_on.q.val() {
            self.pixels.data.next = self.black.val();
        }
        self.pixels.user.next = !self.column.q.val().any() && !self.row.q.val().any();
        self.pixels.last.next = self.is_line_end.val();
        self.reading.next = self.reading_q.q.val();
        self.frames.next = self.frames_q.q.val();
        self.late.next = self.late_q.q.val();
        self.errors.next = self.errors_q.q.val();
        self.corrupted.next = self.corrupted_q.q.val();
    }
}
