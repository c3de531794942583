//! Leaf `edof_queue`: where a pipeline ends.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// Words in the leaf's LUT RAM; one more stands on the output.
pub const DEPTH: usize = 32;

/// Thirty-two words that wait for their receiver, and one on the output. A pipeline that ends here takes in only while there is room:
/// so many words as there is slack may follow, and nothing in the pipeline has to stall.
#[derive(Circuit)]
pub struct Queue<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties it.
    pub reset: Signal<In, Bit>,
    /// Takes the word below.
    pub push: Signal<In, Bit>,
    /// It.
    pub data: Signal<In, Bits<W>>,
    /// Whether the pipeline may take in more.
    pub room: Signal<Out, Bit>,
    /// Whether a word stands on the output.
    pub front_valid: Signal<Out, Bit>,
    /// Whether the receiver takes it.
    pub front_ready: Signal<In, Bit>,
    /// It.
    pub front_data: Signal<Out, Bits<W>>,
    _slack: usize,
    _words: VecDeque<Bits<W>>,
    _front: Option<Bits<W>>,
    _room: bool,
}

impl<const W: usize> Queue<W> {
    /// For a pipeline of which `slack` words may come after it was told to stop: its latency and two more at one word a cycle.
    #[must_use]
    pub fn new(slack: usize) -> Self {
        Self::from_parts(QueueParts { _slack: slack, _words: VecDeque::new(), _front: None, _room: false })
    }
}

impl<const W: usize> Logic for Queue<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            if self.reset.val() {
                self._words.clear();
                self._front = None;
                self._room = false;
            } else {
                self._room = self._words.len() <= DEPTH - self._slack;
                if self._front.is_none() || self.front_ready.val() {
                    self._front = self._words.pop_front();
                }
                if self.push.val() {
                    self._words.push_back(self.data.val());
                }
            }
        }
        self.room.next = self._room;
        self.front_valid.next = self._front.is_some();
        self.front_data.next = self._front.unwrap_or_default();
    }

    fn connect(&mut self) {
        self.room.connect();
        self.front_valid.connect();
        self.front_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_queue")
            .parameter("WIDTH", W)
            .parameter("DEPTH", DEPTH)
            .parameter("SLACK", self._slack)
            .port("clock_i", "clock")
            .port("reset_i", "reset")
            .port("push_i", "push")
            .port("data_i", "data")
            .port("room_o", "room")
            .port("valid_o", "front_valid")
            .port("ready_i", "front_ready")
            .port("data_o", "front_data")
            .verilog()
    }
}
