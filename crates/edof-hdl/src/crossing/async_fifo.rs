//! Leaf `edof_async_fifo`: a word a cycle from one clock domain to another.

use super::clear::Clear;
use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// 2^`log_depth` words in LUT RAM, and one at the output. A word can be read three to four read cycles after it was written.
/// A reset of either side empties both sides, in any order and with either clock standing still; until both clocks have run nothing is
/// taken and nothing new is offered.
#[derive(Circuit)]
pub struct AsyncFifo<const W: usize> {
    /// Clock of the writer.
    pub write_clock: Signal<In, Clock>,
    /// Reset of the writer's domain: empties the FIFO.
    pub write_reset: Signal<In, Bit>,
    /// The word is valid.
    pub write_valid: Signal<In, Bit>,
    /// The FIFO accepts a valid word in this cycle.
    pub write_ready: Signal<Out, Bit>,
    /// Word to push.
    pub write_data: Signal<In, Bits<W>>,
    /// Clock of the reader.
    pub read_clock: Signal<In, Clock>,
    /// Reset of the reader's domain: empties the FIFO and the output.
    pub read_reset: Signal<In, Bit>,
    /// The output word is valid.
    pub read_valid: Signal<Out, Bit>,
    /// The receiver accepts the word.
    pub read_ready: Signal<In, Bit>,
    /// Word to push.
    pub read_data: Signal<Out, Bits<W>>,
    _log_depth: usize,
    _words: VecDeque<Bits<W>>,
    _pointers: Pointers,
    _clear: Clear,
    _front: Option<Bits<W>>,
}

/// Words written and read so far, and what each side has seen of the other's count.
#[derive(Default)]
struct Pointers {
    written: u64,
    read: u64,
    written_seen: [u64; 2],
    read_seen: [u64; 2],
}

impl<const W: usize> AsyncFifo<W> {
    /// A FIFO with 2^`log_depth` words.
    #[must_use]
    pub fn new(log_depth: usize) -> Self {
        Self::from_parts(AsyncFifoParts {
            _log_depth: log_depth,
            _words: VecDeque::new(),
            _pointers: Pointers::default(),
            _clear: Clear::default(),
            _front: None,
        })
    }

    fn has_room(&self) -> bool {
        let held = self._pointers.written.wrapping_sub(self._pointers.read_seen[1]);
        self._clear.sender_open() && held < 1 << self._log_depth
    }

    fn write(&mut self, read: u64) {
        if self._clear.sender_clear() {
            self._pointers.written = 0;
            self._words.clear();
        } else if self.write_valid.val() && self.has_room() && !self.write_reset.val() {
            self._words.push_back(self.write_data.val());
            self._pointers.written += 1;
        }
        self._pointers.read_seen = [read, self._pointers.read_seen[0]];
    }

    fn read(&mut self, written: u64) {
        let moves = self._front.is_none() || self.read_ready.val();
        let fetches =
            self._clear.receiver_open() && moves && self._pointers.written_seen[1] != self._pointers.read;
        if self._clear.receiver_clear() {
            self._pointers.read = 0;
        } else if fetches {
            self._pointers.read += 1;
        }
        if fetches {
            self._front = self._words.pop_front();
        } else if moves {
            self._front = None;
        }
        if self.read_reset.val() {
            self._front = None;
        }
        self._pointers.written_seen = [written, self._pointers.written_seen[0]];
    }
}

impl<const W: usize> Logic for AsyncFifo<W> {
    fn update(&mut self) {
        let (written, read) = (self._pointers.written, self._pointers.read);
        let (writes, reads) = (self.write_clock.pos_edge(), self.read_clock.pos_edge());
        if writes {
            self.write(read);
        }
        if reads {
            self.read(written);
        }
        self._clear.step(writes.then(|| self.write_reset.val()), reads.then(|| self.read_reset.val()));
        self.write_ready.next = self.has_room();
        self.read_valid.next = self._front.is_some();
        if let Some(front) = self._front {
            self.read_data.next = front;
        }
    }

    fn connect(&mut self) {
        self.write_ready.connect();
        self.read_valid.connect();
        self.read_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_async_fifo")
            .parameter("WIDTH", W)
            .parameter("LOG_DEPTH", self._log_depth)
            .port("write_clock_i", "write_clock")
            .port("write_reset_i", "write_reset")
            .port("write_valid_i", "write_valid")
            .port("write_ready_o", "write_ready")
            .port("write_data_i", "write_data")
            .port("read_clock_i", "read_clock")
            .port("read_reset_i", "read_reset")
            .port("read_valid_o", "read_valid")
            .port("read_ready_i", "read_ready")
            .port("read_data_o", "read_data")
            .verilog()
    }
}
