//! A stream of pixels into one of three frame buffers.

use super::{Buffer, Frames};
use crate::blocks::Row;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiWriteMaster, StreamIn};
use rust_hdl::prelude::*;

/// Bursts that wait for their answer at a time, at most.
const OUTSTANDING: u64 = 8;

/// Where the agent is in a frame.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// Waits for the first pixel of a frame; others are dropped.
    Between,
    /// Takes pixels.
    Frame,
    /// All pixels have come: writes what is left, and waits for all answers.
    Complete,
    /// The frame was not as it should be: waits for the answers that are still to come.
    Broken,
}

/// A stream of pixels into one of three frame buffers, in bursts of full length.
///
/// A burst is asked for once all its words are here, so that it never waits for pixels. A frame counts as complete, and becomes the
/// newest, when all its lines were of the right length, all its bursts are answered, no answer was an error, and no `corrupted` came since
/// the frame before the last; otherwise it is counted as broken and its buffer used again. After a frame the stream waits until all answers have come. A pixel a cycle otherwise, as long
/// as the memory keeps up.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct WriteAgent<const W: usize, const S: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets all frames.
    pub reset: Signal<In, Bit>,
    /// Pixels.
    pub pixels: StreamIn<16>,
    /// Memory.
    pub dram: AxiWriteMaster<W, S>,
    /// What the frames are made of was corrupted in this cycle: the next two frames that end are held back. One of them may have left the
    /// source before, the other is made of it.
    pub corrupted: Signal<In, Bit>,
    /// The buffer that is being read.
    pub reading: Signal<In, Buffer>,
    /// The newest complete buffer.
    pub newest: Signal<Out, Buffer>,
    /// Complete frames.
    pub frames: Signal<Out, Bits<32>>,
    /// Frames that were begun and not completed, or held back.
    pub broken: Signal<Out, Bits<32>>,
    /// Answers that were errors.
    pub errors: Signal<Out, Bits<32>>,
    last_column: Constant<Bits<12>>,
    last_row: Constant<Bits<12>>,
    last_lane: Constant<Bits<6>>,
    top_lane: Constant<Bits<12>>,
    burst: Constant<Row>,
    last_word: Constant<Row>,
    max_held: Constant<Row>,
    row_mask: Constant<Row>,
    burst_bytes: Constant<Bits<32>>,
    word_size: Constant<Bits<3>>,
    all_bytes: Constant<Bits<S>>,
    base_0: Constant<Bits<32>>,
    base_1: Constant<Bits<32>>,
    base_2: Constant<Bits<32>>,
    max_outstanding: Constant<Bits<4>>,
    #[reset(Phase::Between)]
    phase: DFF<Phase>,
    column: DFF<Bits<12>>,
    row: DFF<Bits<12>>,
    lane: DFF<Bits<6>>,
    word: DFF<Bits<W>>,
    // Words of this frame: put into the RAM, announced, taken out of the RAM (and the one after).
    write_ptr: DFF<Row>,
    announced: DFF<Row>,
    sent: DFF<Row>,
    sent_next: DFF<Row>,
    // How many the RAM holds and whether there is room for more, how many wait to be announced, whether any may be sent: each from the
    // counts of the cycle before.
    held: DFF<Row>,
    has_space: DFF<Bit>,
    waiting: DFF<Row>,
    has_word: DFF<Bit>,
    #[reset(false)]
    push: DFF<Bit>,
    push_row: DFF<Row>,
    #[reset(false)]
    request: DFF<Bit>,
    // All pixels had come by the cycle before.
    is_whole: DFF<Bit>,
    address: DFF<Bits<32>>,
    request_address: DFF<Bits<32>>,
    request_words: DFF<Row>,
    #[reset(false)]
    word_valid: DFF<Bit>,
    sent_word: DFF<Bits<W>>,
    sent_last: DFF<Bit>,
    #[reset(0)]
    outstanding: DFF<Bits<4>>,
    failed: DFF<Bit>,
    // Frames that are to be held back.
    #[reset(0)]
    suspect_frames: DFF<Bits<2>>,
    target: DFF<Buffer>,
    #[reset(3)]
    newest_q: DFF<Buffer>,
    #[reset(0)]
    frames_q: DFF<Bits<32>>,
    #[reset(0)]
    broken_q: DFF<Bits<32>>,
    #[reset(0)]
    errors_q: DFF<Bits<32>>,
    ram: Ram<W>,
    accept: Signal<Local, Bit>,
    is_short: Signal<Local, Bit>,
    advance: Signal<Local, Bit>,
    sent_then: Signal<Local, Row>,
    accepted: Signal<Local, Bit>,
    answered: Signal<Local, Bit>,
    is_quiet: Signal<Local, Bit>,
    is_over: Signal<Local, Bit>,
    is_line_end: Signal<Local, Bit>,
    free: Signal<Local, Buffer>,
}

impl<const W: usize, const S: usize> WriteAgent<W, S> {
    /// An agent for these frames.
    ///
    /// # Panics
    /// For frames that no agent supports; the check of a design excludes them (`edof_device::board`).
    #[must_use]
    pub fn new(frames: &Frames) -> Self {
        frames.check(W);
        let row = |value: usize| Constant::new((value as u64).into());
        let base = frames.buffers.map(|address| Constant::new(u64::from(address).into()));
        Self::from_parts(WriteAgentParts {
            last_column: Constant::new((frames.width as u64 - 1).into()),
            last_row: Constant::new((frames.height as u64 - 1).into()),
            last_lane: Constant::new((W as u64 / 16 - 1).into()),
            top_lane: Constant::new((W as u64 - 16).into()),
            burst: row(frames.burst),
            last_word: row(frames.burst - 1),
            max_held: row(frames.depth - 3),
            row_mask: row(frames.depth - 1),
            burst_bytes: Constant::new((frames.burst as u64 * W as u64 / 8).into()),
            word_size: Constant::new(u64::from((W / 8).ilog2()).into()),
            all_bytes: Constant::new(!Bits::<S>::default()),
            base_0: base[0],
            base_1: base[1],
            base_2: base[2],
            max_outstanding: Constant::new(OUTSTANDING.into()),
            ram: Ram::new(Shape::distributed(frames.depth), &[]),
        })
    }
}

impl<const W: usize, const S: usize> Logic for WriteAgent<W, S> {
    #[kernel]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();

        // Pixels into words, words into the RAM a cycle later.
        self.held.d.next = self.write_ptr.q.val() - self.sent.q.val();
        self.has_space.d.next = self.held.q.val() <= self.max_held.val();
        self.accept.next = false;
        self.pixels.ready.next = false;
        if self.phase.q.val() == Phase::Between {
            self.pixels.ready.next = true;
            self.accept.next = self.pixels.valid.val() && self.pixels.user.val();
        } else if self.phase.q.val() == Phase::Frame {
            self.pixels.ready.next = self.has_space.q.val() && !self.pixels.user.val();
            self.accept.next = self.pixels.valid.val() && self.has_space.q.val() && !self.pixels.user.val();
        }
        self.is_line_end.next = self.column.q.val() == self.last_column.val();
        self.push.d.next = false;
        self.push_row.d.next = self.write_ptr.q.val() & self.row_mask.val();
        if self.accept.val() {
            self.word.d.next = (self.word.q.val() >> 16)
                | (bit_cast::<W, 16>(self.pixels.data.val()) << self.top_lane.val());
            self.lane.d.next = self.lane.q.val() + 1;
            if self.lane.q.val() == self.last_lane.val() {
                self.lane.d.next = 0.into();
                self.push.d.next = true;
                self.write_ptr.d.next = self.write_ptr.q.val() + 1;
            }
            self.column.d.next = self.column.q.val() + 1;
            if self.is_line_end.val() {
                self.column.d.next = 0.into();
                self.row.d.next = self.row.q.val() + 1;
            }
        }
        self.ram.write_enable.next = self.push.q.val();
        self.ram.write_address.next = self.push_row.q.val();
        self.ram.write_data.next = self.word.q.val();

        // Bursts: asked for when their words are here. An address stands for a cycle at least, in which the count of those that wait
        // follows.
        self.waiting.d.next = self.write_ptr.q.val() - self.announced.q.val();
        self.is_whole.d.next = self.phase.q.val() == Phase::Complete;
        self.is_short.next = self.waiting.q.val() < self.burst.val();
        self.accepted.next = self.request.q.val() && self.dram.aw_ready.val();
        if self.accepted.val() {
            self.request.d.next = false;
        }
        if !self.request.q.val()
            && (self.outstanding.q.val() != self.max_outstanding.val())
            && (((self.phase.q.val() == Phase::Frame) && !self.is_short.val())
                || ((self.phase.q.val() == Phase::Complete)
                    && self.is_whole.q.val()
                    && self.waiting.q.val().any()))
        {
            self.request.d.next = true;
            self.request_address.d.next = self.address.q.val();
            self.address.d.next = self.address.q.val() + self.burst_bytes.val();
            self.request_words.d.next = self.burst.val();
            self.announced.d.next = self.announced.q.val() + self.burst.val();
            if self.is_short.val() {
                self.request_words.d.next = self.waiting.q.val();
                self.announced.d.next = self.write_ptr.q.val();
            }
        }

        // Words of the burst pass a register and do not wait for the address to be accepted.
        self.advance.next = !self.word_valid.q.val() || self.dram.w_ready.val();
        self.sent_then.next = self.sent.q.val();
        self.has_word.d.next = self.sent.q.val() != self.announced.q.val();
        if self.advance.val() {
            self.word_valid.d.next = self.has_word.q.val();
            self.sent_word.d.next = self.ram.read_data.val();
            self.sent_last.d.next = ((self.sent.q.val() & self.last_word.val()) == self.last_word.val())
                || ((self.phase.q.val() == Phase::Complete)
                    && (self.sent_next.q.val() == self.write_ptr.q.val()));
            if self.has_word.q.val() {
                self.sent_then.next = self.sent_next.q.val();
                self.sent_next.d.next = self.sent_next.q.val() + 1;
                self.has_word.d.next = self.sent_next.q.val() != self.announced.q.val();
            }
        }
        self.sent.d.next = self.sent_then.val();
        // Not held back by a reset: words of the next frame come later.
        self.ram.read_address.next = self.sent_then.val() & self.row_mask.val();

        // Answers.
        self.answered.next = self.dram.b_valid.val();
        if self.accepted.val() && !self.answered.val() {
            self.outstanding.d.next = self.outstanding.q.val() + 1;
        } else if self.answered.val() && !self.accepted.val() {
            self.outstanding.d.next = self.outstanding.q.val() - 1;
        }
        if self.answered.val() && self.dram.b_resp.val().any() {
            self.failed.d.next = true;
            self.errors_q.d.next = self.errors_q.q.val() + 1;
        }

        // Frames. The next buffer is neither the newest nor the one that is read.
        self.free.next = 0.into();
        if (self.newest_q.q.val() == 0) || (self.reading.val() == 0) {
            self.free.next = 1.into();
            if (self.newest_q.q.val() == 1) || (self.reading.val() == 1) {
                self.free.next = 2.into();
            }
        }
        self.is_quiet.next = !self.request.q.val()
            && !self.word_valid.q.val()
            && !self.push.q.val()
            && !self.has_word.q.val()
            && !self.outstanding.q.val().any();
        self.is_over.next = self.is_quiet.val()
            && ((self.phase.q.val() == Phase::Broken)
                || ((self.phase.q.val() == Phase::Complete)
                    && self.is_whole.q.val()
                    && !self.waiting.q.val().any()));
        match self.phase.q.val() {
            Phase::Between => {
                if self.accept.val() {
                    self.phase.d.next = Phase::Frame;
                    self.failed.d.next = false;
                    self.target.d.next = self.free.val();
                    self.address.d.next = self.base_0.val();
                    if self.free.val() == 1 {
                        self.address.d.next = self.base_1.val();
                    } else if self.free.val() == 2 {
                        self.address.d.next = self.base_2.val();
                    }
                }
            }
            Phase::Frame => {
                if self.pixels.valid.val() && self.pixels.user.val() {
                    self.phase.d.next = Phase::Broken;
                }
                if self.accept.val() {
                    if self.pixels.last.val() != self.is_line_end.val() {
                        self.phase.d.next = Phase::Broken;
                    } else if self.is_line_end.val() && (self.row.q.val() == self.last_row.val()) {
                        self.phase.d.next = Phase::Complete;
                    }
                }
            }
            Phase::Complete => {
                if self.is_over.val() {
                    self.phase.d.next = Phase::Between;
                    if self.failed.q.val() || self.suspect_frames.q.val().any() {
                        self.broken_q.d.next = self.broken_q.q.val() + 1;
                    } else {
                        self.frames_q.d.next = self.frames_q.q.val() + 1;
                        self.newest_q.d.next = self.target.q.val();
                    }
                }
            }
            Phase::Broken => {
                if self.is_over.val() {
                    self.phase.d.next = Phase::Between;
                    self.broken_q.d.next = self.broken_q.q.val() + 1;
                }
            }
        }
        if self.is_over.val() && self.suspect_frames.q.val().any() {
            self.suspect_frames.d.next = self.suspect_frames.q.val() - 1;
        }
        if self.corrupted.val() {
            self.suspect_frames.d.next = 2.into();
        }
        if self.is_over.val() || self.reset.val() {
            self.column.d.next = 0.into();
            self.row.d.next = 0.into();
            self.lane.d.next = 0.into();
            self.write_ptr.d.next = 0.into();
            self.announced.d.next = 0.into();
            self.sent.d.next = 0.into();
            self.sent_next.d.next = 1.into();
            self.held.d.next = 0.into();
            self.has_space.d.next = true;
            self.waiting.d.next = 0.into();
            self.has_word.d.next = false;
        }

        self.dram.aw_id.next = 0.into();
        self.dram.aw_addr.next = self.request_address.q.val();
        self.dram.aw_len.next = (self.request_words.q.val() - 1).get_bits::<8>(0);
        self.dram.aw_size.next = self.word_size.val();
        self.dram.aw_burst.next = 1.into();
        self.dram.aw_valid.next = self.request.q.val();
        self.dram.w_data.next = self.sent_word.q.val();
        self.dram.w_strb.next = self.all_bytes.val();
        self.dram.w_last.next = self.sent_last.q.val();
        self.dram.w_valid.next = self.word_valid.q.val();
        self.dram.b_ready.next = true;
        self.newest.next = self.newest_q.q.val();
        self.frames.next = self.frames_q.q.val();
        self.broken.next = self.broken_q.q.val();
        self.errors.next = self.errors_q.q.val();
    }
}
