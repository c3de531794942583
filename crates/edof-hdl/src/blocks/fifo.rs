//! Leaf `edof_fifo`: finished beats that wait for their receiver.

use super::Pair;
use crate::describe::Circuit;
use crate::leaf::Leaf;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// Sixteen beats deep; a pushed beat stands on the output in the next cycle. Who pushes must know that there is room.
#[derive(Circuit)]
pub struct Fifo {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties it.
    pub reset: Signal<In, Bit>,
    /// Takes the beat below.
    pub push: Signal<In, Bit>,
    /// The words to be multiplied.
    pub data: Signal<In, Pair>,
    /// Their base words.
    pub base: Signal<In, Pair>,
    /// Whether the beat is its vector's last.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// Whether a beat stands on the output.
    pub front_valid: Signal<Out, Bit>,
    /// Whether the receiver takes it.
    pub front_ready: Signal<In, Bit>,
    /// Its words.
    pub front_data: Signal<Out, Pair>,
    /// Its base words; 0 where bases are not kept.
    pub front_base: Signal<Out, Pair>,
    /// Whether it is its vector's last.
    pub front_last: Signal<Out, Bit>,
    /// Its vector's set.
    pub front_set: Signal<Out, Bit>,
    _base: bool,
    _beats: VecDeque<(Pair, Pair, bool, bool)>,
}

impl Fifo {
    /// A FIFO with or without base words.
    #[must_use]
    pub fn new(base: bool) -> Self {
        Self::from_parts(FifoParts { _base: base, _beats: VecDeque::new() })
    }
}

impl Logic for Fifo {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            if self.reset.val() {
                self._beats.clear();
            } else {
                if self.front_valid.val() && self.front_ready.val() {
                    self._beats.pop_front();
                }
                if self.push.val() {
                    let base = if self._base { self.base.val() } else { 0.into() };
                    self._beats.push_back((self.data.val(), base, self.last.val(), self.set.val()));
                }
            }
        }
        self.front_valid.next = !self._beats.is_empty();
        let zero = (0.into(), 0.into(), false, false);
        let (data, base, last, set) = self._beats.front().copied().unwrap_or(zero);
        self.front_data.next = data;
        self.front_base.next = base;
        self.front_last.next = last;
        self.front_set.next = set;
    }

    fn connect(&mut self) {
        self.front_valid.connect();
        self.front_data.connect();
        self.front_base.connect();
        self.front_last.connect();
        self.front_set.connect();
    }

    fn hdl(&self) -> Verilog {
        Leaf::new("edof_fifo")
            .parameter("BASE", usize::from(self._base))
            .port("clock_i", "clock")
            .port("reset_i", "reset")
            .port("push_i", "push")
            .port("data_i", "data")
            .port("base_i", "base")
            .port("last_i", "last")
            .port("set_i", "set")
            .port("valid_o", "front_valid")
            .port("ready_i", "front_ready")
            .port("data_o", "front_data")
            .port("base_o", "front_base")
            .port("last_o", "front_last")
            .port("set_o", "front_set")
            .verilog()
    }
}
