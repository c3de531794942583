//! A bench for any block whose ports are streams and AXI: clocks that have nothing to do with each other, senders, receivers and a
//! memory that stall as they like, and every rule of every port watched.
//!
//! | part | module | does |
//! |---|---|---|
//! | [`Bench`] | [`clocks`] | lets clocks rise, each with its own period, drift and jitter |
//! | [`Sender`], [`Receiver`] | [`stream`] | AXI4-Stream |
//! | [`Memory`] | [`axi`] | AXI4: latency, stalls, errors, and other orders where the standard allows them |
//! | [`Behaviour`] | [`behaviour`] | how late, how coupled and how starved a memory is |
//! | [`Host`] | [`axi_lite`] | AXI4-Lite |
//! | [`Serial`] | [`serial`] | a serial line, cycle by cycle |
//! | [`Throttle`] | [`throttle`] | when one of them pauses |
//! | [`Mark`] | [`marks`] | the most that something inside ever was |
//!
//! Every model next to the block is an [`Actor`] of one clock: it reads the ports right before its clock rises, and drives them right
//! after. The transaction model is the test's own: what the receivers and the memory have got is compared with it.

pub mod axi;
pub mod axi_lite;
pub mod behaviour;
pub mod clocks;
pub mod marks;
pub mod serial;
mod stability_check;
pub mod stream;
pub mod throttle;

pub use axi::Memory;
pub use axi_lite::Host;
pub use behaviour::{Behaviour, Coupling};
pub use clocks::{Bench, ClockId};
pub use marks::Mark;
pub use serial::Serial;
pub use stream::{Beat, Receiver, Sender};
pub use throttle::Throttle;

pub(crate) use stability_check::StabilityCheck;

use crate::verilator::Model;
use crate::{Direction, Error, Source};

/// Someone beside the block, in one clock domain.
pub trait Actor {
    /// Clock of the actor.
    fn clock(&self) -> ClockId;

    /// Reads ports as they are right before the clock rises.
    ///
    /// # Errors
    /// A rule of a port was broken.
    fn before(&mut self, model: &mut Model) -> Result<(), Error>;

    /// Drives ports right after the clock rose.
    ///
    /// # Errors
    /// The simulation stops.
    fn after(&mut self, model: &mut Model) -> Result<(), Error>;
}

impl Source {
    /// The same design, each of its synchronisers seeing a change one edge later at random (`rtl/edof_sync.v`).
    #[must_use]
    pub fn metastable(mut self) -> Self {
        for (_, text) in self.files.iter_mut().filter(|(name, _)| name == "edof_sync.v") {
            text.insert_str(0, "`define EDOF_METASTABLE\n");
        }
        self
    }

    /// The place of a bundle's signal, whichever way it goes: `pixels` and `valid` give `pixels_valid_i` or `pixels_valid_o`.
    ///
    /// # Errors
    /// There is none.
    pub fn signal(&self, bundle: &str, signal: &str) -> Result<usize, Error> {
        let found = ["i", "o"].map(|end| self.port(&format!("{bundle}_{signal}_{end}")));
        found.into_iter().find_map(Result::ok).ok_or_else(|| {
            Error::Port(format!("{} has no port {bundle}_{signal}_i or {bundle}_{signal}_o", self.top))
        })
    }

    /// Whether the design drives the signal.
    #[must_use]
    pub fn drives(&self, port: usize) -> bool {
        self.ports.get(port).is_some_and(|port| port.direction == Direction::Out)
    }
}

pub(crate) fn rule_broken(model: &Model, port: &str, rule: &str) -> Error {
    Error::Rule { port: port.into(), edge: model.cycle(), rule: rule.into() }
}
