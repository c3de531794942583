//! Leaf `edof_fifo`: finished beats that wait for their receiver.

use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::design::timing::DRAIN_CREDITS;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// As many words as there are credits, or none at all; a pushed word stands on the output two cycles later. Who pushes must know that there is room.
#[derive(Circuit)]
pub struct Fifo<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties the memory.
    pub reset: Signal<In, Bit>,
    /// Pushes `data`.
    pub push: Signal<In, Bit>,
    /// Word to push.
    pub data: Signal<In, Bits<W>>,
    /// The output word is valid.
    pub front_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub front_ready: Signal<In, Bit>,
    /// Oldest word, valid while `front_valid`.
    pub front_data: Signal<Out, Bits<W>>,
    _depth: usize,
    _words: VecDeque<Bits<W>>,
    _front: Option<Bits<W>>,
}

impl<const W: usize> Default for Fifo<W> {
    fn default() -> Self {
        Self::new(true)
    }
}

impl<const W: usize> Fifo<W> {
    /// One that takes words, or one that nobody reads, which has no memory and shows 0.
    #[must_use]
    pub fn new(is_read: bool) -> Self {
        let _depth = if is_read { DRAIN_CREDITS } else { 0 };
        Self::from_parts(FifoParts { _depth, _words: VecDeque::new(), _front: None })
    }
}

impl<const W: usize> Logic for Fifo<W> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            if self.reset.val() {
                self._words.clear();
                self._front = None;
            } else {
                if self._front.is_none() || self.front_ready.val() {
                    self._front = self._words.pop_front();
                }
                if self.push.val() && self._depth > 0 {
                    self._words.push_back(self.data.val());
                }
            }
        }
        self.front_valid.next = self._front.is_some();
        self.front_data.next = self._front.unwrap_or_default();
    }

    fn connect(&mut self) {
        self.front_valid.connect();
        self.front_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_fifo")
            .parameter("WIDTH", W)
            .parameter("DEPTH", self._depth)
            .port("clock_i", "clock")
            .port("reset_i", "reset")
            .port("push_i", "push")
            .port("data_i", "data")
            .port("valid_o", "front_valid")
            .port("ready_i", "front_ready")
            .port("data_o", "front_data")
            .verilog()
    }
}
