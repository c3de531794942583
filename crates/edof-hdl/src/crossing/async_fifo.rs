//! Leaf `edof_async_fifo`: a word a cycle from one clock domain to another.

use crate::describe::Circuit;
use crate::leaf::Leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// 2^`log_depth` words in LUT RAM, and one at the output. A word can be read three to four read cycles after it was written.
/// Both resets come from the same request and overlap; what was inside is lost.
#[derive(Circuit)]
pub struct AsyncFifo<const W: usize> {
    /// Clock of the writer.
    pub write_clock: Signal<In, Clock>,
    /// Empties it, together with the reader's reset.
    pub write_reset: Signal<In, Bit>,
    /// A word is offered.
    pub write_valid: Signal<In, Bit>,
    /// It is taken, if there is one.
    pub write_ready: Signal<Out, Bit>,
    /// The word.
    pub write_data: Signal<In, Bits<W>>,
    /// Clock of the reader.
    pub read_clock: Signal<In, Clock>,
    /// Empties it, together with the writer's reset.
    pub read_reset: Signal<In, Bit>,
    /// A word stands on the output.
    pub read_valid: Signal<Out, Bit>,
    /// It is taken.
    pub read_ready: Signal<In, Bit>,
    /// The word.
    pub read_data: Signal<Out, Bits<W>>,
    _log_depth: usize,
    _words: VecDeque<Bits<W>>,
    _pointers: Pointers,
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
    /// A FIFO of so many words, as a power of two.
    #[must_use]
    pub fn new(log_depth: usize) -> Self {
        Self::from_parts(AsyncFifoParts {
            _log_depth: log_depth,
            _words: VecDeque::new(),
            _pointers: Pointers::default(),
            _front: None,
        })
    }

    fn has_room(&self) -> bool {
        self._pointers.written - self._pointers.read_seen[1] < 1 << self._log_depth
    }
}

impl<const W: usize> Logic for AsyncFifo<W> {
    fn update(&mut self) {
        let (written, read) = (self._pointers.written, self._pointers.read);
        let (writes, reads) = (self.write_clock.pos_edge(), self.read_clock.pos_edge());
        if writes {
            if self.write_reset.val() {
                self._pointers.written = 0;
            } else if self.write_valid.val() && self.has_room() {
                self._words.push_back(self.write_data.val());
                self._pointers.written += 1;
            }
            self._pointers.read_seen = [read, self._pointers.read_seen[0]];
        }
        if reads {
            if self.read_reset.val() {
                self._pointers.read = 0;
                self._front = None;
                self._words.clear();
            } else if self._front.is_none() || self.read_ready.val() {
                let arrived = self._pointers.written_seen[1] > read;
                self._front = if arrived { self._words.pop_front() } else { None };
                self._pointers.read += u64::from(self._front.is_some());
            }
            self._pointers.written_seen = [written, self._pointers.written_seen[0]];
        }
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
        Leaf::new("edof_async_fifo")
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
