//! Block RAM behind an AXI4 port.

use crate::describe::{Circuit, kernel};
use crate::ports::{AxiReadSlave, AxiWriteSlave};
use crate::video::Place;
use crate::video::memory::Memory;
use crate::video::queue::Queue;
use rust_hdl::prelude::*;

/// Words that may follow into the queue after it has no more space: two cycles of the memory, and two of the queue's own.
const SLACK: usize = 4;

/// Block RAM behind an AXI4 port: a burst of writes and one of reads at a time, whose addresses grow by a word.
///
/// A burst of N words that nobody delays takes N + 2 cycles in writing and N + 5 in reading. What was answered is read. Words are written whole: one of
/// which some bytes alone are enabled is not written, and its burst is answered with an error. Bits of an address above the
/// memory are ignored.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct AxiRam<const W: usize, const S: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the bursts in flight; words stay.
    pub reset: Signal<In, Bit>,
    /// Writes.
    pub write: AxiWriteSlave<W, S>,
    /// Reads.
    pub read: AxiReadSlave<W>,
    word_shift: Constant<Bits<6>>,
    all_bytes: Constant<Bits<S>>,
    // A burst whose words are still to come, and one that is to be answered.
    #[reset(false)]
    is_writing: DFF<Bit>,
    #[reset(false)]
    answer: DFF<Bit>,
    is_partial: DFF<Bit>,
    write_id: DFF<Bits<1>>,
    write_row: DFF<Place>,
    #[reset(false)]
    store: DFF<Bit>,
    store_row: DFF<Place>,
    store_word: DFF<Bits<W>>,
    // A burst whose words have not all left; words to ask the memory for, and words that follow the next one that leaves.
    #[reset(false)]
    is_reading: DFF<Bit>,
    read_id: DFF<Bits<1>>,
    read_row: DFF<Place>,
    #[reset(0)]
    to_ask: DFF<Bits<9>>,
    to_follow: DFF<Bits<8>>,
    #[reset(false)]
    asked_1: DFF<Bit>,
    #[reset(false)]
    asked_2: DFF<Bit>,
    memory: Memory<W>,
    queue: Queue<W>,
    is_whole: Signal<Local, Bit>,
    ask: Signal<Local, Bit>,
}

impl<const W: usize, const S: usize> AxiRam<W, S> {
    /// A memory of `words` words or more, a power of two.
    #[must_use]
    pub fn new(words: usize) -> Self {
        Self::from_parts(AxiRamParts {
            word_shift: Constant::new(u64::from(S.ilog2()).into()),
            all_bytes: Constant::new(!Bits::<S>::default()),
            memory: Memory::open(words),
            queue: Queue::new(SLACK),
        })
    }
}

impl<const W: usize, const S: usize> Logic for AxiRam<W, S> {
    #[kernel]
    fn update(&mut self) {
        // Writes: an address, its words, the answer.
        self.write.aw_ready.next = !self.is_writing.q.val() && !self.answer.q.val();
        if self.write.aw_valid.val() && !self.is_writing.q.val() && !self.answer.q.val() {
            self.is_writing.d.next = true;
            self.is_partial.d.next = false;
            self.write_id.d.next = self.write.aw_id.val();
            self.write_row.d.next = (self.write.aw_addr.val() >> self.word_shift.val()).get_bits::<16>(0);
        }
        self.write.w_ready.next = self.is_writing.q.val();
        self.is_whole.next = self.write.w_strb.val() == self.all_bytes.val();
        self.store.d.next = false;
        self.store_row.d.next = self.write_row.q.val();
        self.store_word.d.next = self.write.w_data.val();
        if self.is_writing.q.val() && self.write.w_valid.val() {
            self.store.d.next = self.is_whole.val();
            self.write_row.d.next = self.write_row.q.val() + 1;
            if self.write.w_strb.val().any() && !self.is_whole.val() {
                self.is_partial.d.next = true;
            }
            if self.write.w_last.val() {
                self.is_writing.d.next = false;
                self.answer.d.next = true;
            }
        }
        self.write.b_valid.next = self.answer.q.val();
        self.write.b_id.next = self.write_id.q.val();
        self.write.b_resp.next = 0.into();
        if self.is_partial.q.val() {
            self.write.b_resp.next = 2.into();
        }
        if self.answer.q.val() && self.write.b_ready.val() {
            self.answer.d.next = false;
        }

        // Reads: an address, then its words by way of the queue.
        self.read.ar_ready.next = !self.is_reading.q.val();
        self.ask.next = self.to_ask.q.val().any() && self.queue.space.val();
        if self.ask.val() {
            self.read_row.d.next = self.read_row.q.val() + 1;
            self.to_ask.d.next = self.to_ask.q.val() - 1;
        }
        if self.read.ar_valid.val() && !self.is_reading.q.val() {
            self.is_reading.d.next = true;
            self.read_id.d.next = self.read.ar_id.val();
            self.read_row.d.next = (self.read.ar_addr.val() >> self.word_shift.val()).get_bits::<16>(0);
            self.to_ask.d.next = bit_cast::<9, 8>(self.read.ar_len.val()) + 1;
            self.to_follow.d.next = self.read.ar_len.val();
        }
        self.asked_1.d.next = self.ask.val();
        self.asked_2.d.next = self.asked_1.q.val();
        self.read.r_valid.next = self.queue.front_valid.val();
        self.read.r_id.next = self.read_id.q.val();
        self.read.r_data.next = self.queue.front_data.val();
        self.read.r_resp.next = 0.into();
        self.read.r_last.next = !self.to_follow.q.val().any();
        if self.queue.front_valid.val() && self.read.r_ready.val() {
            self.to_follow.d.next = self.to_follow.q.val() - 1;
            if !self.to_follow.q.val().any() {
                self.is_reading.d.next = false;
            }
        }

        self.memory.clock.next = self.clock.val();
        self.memory.write_enable.next = self.store.q.val();
        self.memory.write_address.next = self.store_row.q.val();
        self.memory.write_data.next = self.store_word.q.val();
        self.memory.read_address.next = self.read_row.q.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();
        self.queue.push.next = self.asked_2.q.val();
        self.queue.data.next = self.memory.read_data.val();
        self.queue.front_ready.next = self.read.r_ready.val();
    }
}
