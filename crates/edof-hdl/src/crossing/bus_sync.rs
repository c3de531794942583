//! Leaf `edof_bus_sync`: a word now and then into another clock domain, all its bits at once.

use super::clear::Clear;
use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// A word that is given while `ready` arrives three to four cycles later and stands until the next one; 0 after the receiver's reset. A
/// reset of either side drops a word in flight, in any order and with either clock standing still.
#[derive(Circuit)]
pub struct BusSync<const W: usize> {
    /// Clock of the sender.
    pub from_clock: Signal<In, Clock>,
    /// Reset of the sender's domain: drops a word in flight.
    pub from_reset: Signal<In, Bit>,
    /// The word is valid.
    pub valid: Signal<In, Bit>,
    /// The crossing accepts a valid word in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Word to push.
    pub word: Signal<In, Bits<W>>,
    /// Clock of the receiver.
    pub to_clock: Signal<In, Clock>,
    /// Reset of the receiver's domain: back to 0, and drops a word in flight.
    pub to_reset: Signal<In, Bit>,
    /// A word has come in this cycle.
    pub arrives: Signal<Out, Bit>,
    /// The last word that came.
    pub arrived: Signal<Out, Bits<W>>,
    _handshake: Handshake,
    _held: Bits<W>,
    _word: Bits<W>,
}

/// A toggle that goes there and back through two flip-flops each way.
#[derive(Default)]
pub(super) struct Handshake {
    asked: bool,
    told: bool,
    asked_seen: [bool; 2],
    told_seen: [bool; 2],
    clear: Clear,
    /// Something has come at the receiver's last edge.
    pub arrived: bool,
}

impl Handshake {
    /// The sender may ask.
    pub const fn is_ready(&self) -> bool {
        self.clear.sender_open() && self.asked == self.told_seen[1]
    }

    /// An edge of the sender (reset, whether it asks), of the receiver (reset), or of both.
    pub fn step(&mut self, from: Option<(bool, bool)>, to: Option<bool>) {
        let (asked, told) = (self.asked, self.told);
        if let Some((reset, asks)) = from {
            self.asked = !self.clear.sender_clear() && (asked ^ (asks && !reset && self.is_ready()));
            self.told_seen = [told, self.told_seen[0]];
        }
        if let Some(reset) = to {
            let arrives = self.clear.receiver_open() && self.asked_seen[1] != told;
            self.arrived = arrives && !reset;
            self.told = !self.clear.receiver_clear() && (told ^ arrives);
            self.asked_seen = [asked, self.asked_seen[0]];
        }
        self.clear.step(from.map(|(reset, _)| reset), to);
    }
}

impl<const W: usize> Default for BusSync<W> {
    fn default() -> Self {
        let (_held, _word) = (0.into(), 0.into());
        Self::from_parts(BusSyncParts { _handshake: Handshake::default(), _held, _word })
    }
}

impl<const W: usize> Logic for BusSync<W> {
    fn update(&mut self) {
        let from = self.from_clock.pos_edge().then(|| (self.from_reset.val(), self.valid.val()));
        let to = self.to_clock.pos_edge().then(|| self.to_reset.val());
        let taken = from == Some((false, true)) && self._handshake.is_ready();
        self._handshake.step(from, to);
        match to {
            Some(true) => self._word = 0.into(),
            Some(false) if self._handshake.arrived => self._word = self._held,
            _ => {}
        }
        if taken {
            self._held = self.word.val();
        }
        self.ready.next = self._handshake.is_ready();
        self.arrives.next = self._handshake.arrived;
        self.arrived.next = self._word;
    }

    fn connect(&mut self) {
        self.ready.connect();
        self.arrives.connect();
        self.arrived.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_bus_sync")
            .parameter("WIDTH", W)
            .port("from_clock_i", "from_clock")
            .port("from_reset_i", "from_reset")
            .port("valid_i", "valid")
            .port("ready_o", "ready")
            .port("word_i", "word")
            .port("to_clock_i", "to_clock")
            .port("to_reset_i", "to_reset")
            .port("valid_o", "arrives")
            .port("word_o", "arrived")
            .verilog()
    }
}
