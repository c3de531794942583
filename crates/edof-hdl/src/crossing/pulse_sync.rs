//! Leaf `edof_pulse_sync`: pulses of one clock domain as pulses of another.

use super::bus_sync::Handshake;
use crate::describe::Circuit;
use crate::leaves::leaf;
use rust_hdl::prelude::*;

/// One pulse for each that is given while `ready`, three to four cycles later. A reset of either side drops a pulse in
/// flight, in any order and with either clock standing still.
#[derive(Circuit)]
pub struct PulseSync {
    /// Clock of the sender.
    pub from_clock: Signal<In, Clock>,
    /// Reset of the sender's domain: drops a pulse in flight.
    pub from_reset: Signal<In, Bit>,
    /// A pulse.
    pub pulse: Signal<In, Bit>,
    /// The crossing accepts a pulse in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Clock of the receiver.
    pub to_clock: Signal<In, Clock>,
    /// Reset of the receiver's domain: drops a pulse in flight.
    pub to_reset: Signal<In, Bit>,
    /// The pulse.
    pub arrives: Signal<Out, Bit>,
    _handshake: Handshake,
}

impl Default for PulseSync {
    fn default() -> Self {
        Self::from_parts(PulseSyncParts { _handshake: Handshake::default() })
    }
}

impl Logic for PulseSync {
    fn update(&mut self) {
        let from = self.from_clock.pos_edge().then(|| (self.from_reset.val(), self.pulse.val()));
        let to = self.to_clock.pos_edge().then(|| self.to_reset.val());
        self._handshake.step(from, to);
        self.ready.next = self._handshake.is_ready();
        self.arrives.next = self._handshake.arrived;
    }

    fn connect(&mut self) {
        self.ready.connect();
        self.arrives.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_pulse_sync")
            .port("from_clock_i", "from_clock")
            .port("from_reset_i", "from_reset")
            .port("pulse_i", "pulse")
            .port("ready_o", "ready")
            .port("to_clock_i", "to_clock")
            .port("to_reset_i", "to_reset")
            .port("pulse_o", "arrives")
            .verilog()
    }
}
