//! Leaf `edof_queue`: where a pipeline ends.

use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// Words in the leaf's LUT RAM; one more stands on the output.
pub const DEPTH: usize = 32;

/// A FIFO of 32 words and an output register at the end of a pipeline. The pipeline accepts input only while `space` is high. After
/// `space` falls, as many words as the slack may follow, so no stage of the pipeline has to stall.
#[derive(Circuit)]
pub struct Queue<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties the memory.
    pub reset: Signal<In, Bit>,
    /// Pushes `data`.
    pub push: Signal<In, Bit>,
    /// Word to push.
    pub data: Signal<In, Bits<W>>,
    /// The pipeline may accept input in this cycle.
    pub space: Signal<Out, Bit>,
    /// The output word is valid.
    pub front_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub front_ready: Signal<In, Bit>,
    /// Oldest word, valid while `front_valid`.
    pub front_data: Signal<Out, Bits<W>>,
    _slack: usize,
    _words: VecDeque<Bits<W>>,
    _front: Option<Bits<W>>,
    _space: bool,
}

impl<const W: usize> Queue<W> {
    /// A queue for a pipeline that pushes up to `slack` words after `space` fell: the latency plus two at one word per cycle.
    #[must_use]
    pub fn new(slack: usize) -> Self {
        Self::from_parts(QueueParts { _slack: slack, _words: VecDeque::new(), _front: None, _space: false })
    }
}

impl<const W: usize> Logic for Queue<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            if self.reset.val() {
                self._words.clear();
                self._front = None;
                self._space = false;
            } else {
                self._space = self._words.len() <= DEPTH - self._slack;
                if self._front.is_none() || self.front_ready.val() {
                    self._front = self._words.pop_front();
                }
                if self.push.val() {
                    self._words.push_back(self.data.val());
                }
            }
        }
        self.space.next = self._space;
        self.front_valid.next = self._front.is_some();
        self.front_data.next = self._front.unwrap_or_default();
    }

    fn connect(&mut self) {
        self.space.connect();
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
            .port("space_o", "space")
            .port("valid_o", "front_valid")
            .port("ready_i", "front_ready")
            .port("data_o", "front_data")
            .verilog()
    }
}
