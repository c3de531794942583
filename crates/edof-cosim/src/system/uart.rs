//! The serial line of a core: the Verilated `uart_bus` at its host's port, and a terminal at the pins of that, or at the core's own.

use crate::bench::{Actor, ClockId, Serial};
use crate::verilator::{Library, Model, Options, Start};
use crate::{Error, Source};
use edof_hdl::board::UartBus;
use edof_hdl::crossing::reset_sync::RESET_CYCLES;

/// Signals of AXI4-Lite that the master drives, and those that it is given.
const DRIVEN: [&str; 9] =
    ["aw_valid", "w_valid", "ar_valid", "b_ready", "r_ready", "aw_addr", "w_data", "w_strb", "ar_addr"];
const GIVEN: [&str; 7] = ["aw_ready", "w_ready", "b_valid", "b_resp", "ar_ready", "r_valid", "r_data"];
/// Of those that it drives, how many say that it wants something.
const WANTS: usize = 5;

/// `uart_bus` between a terminal and a core.
///
/// The UART is a separate model that rises with the core's clock, so that a core is compiled once whatever stands at its host's port.
pub struct Uart {
    clock: ClockId,
    model: Model,
    /// Here and in the core: what the master drives.
    driven: [[usize; 9]; 2],
    /// What it is given.
    given: [[usize; 7]; 2],
    /// Reset, the two pins, frames that were given up.
    ports: [usize; 4],
    /// Of the core: reset, frames on the line that were given up.
    of_core: [usize; 2],
    /// Cycles of the domain's reset that are left.
    held: usize,
    wants: bool,
    last: Option<[u64; 9]>,
    /// The terminal.
    pub terminal: Serial,
}

impl Uart {
    /// A line with the given cycles per bit, on which a frame is dropped after a pause of `time_out` cycles.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or the core has no host's port.
    pub fn new(
        core: &Source,
        clock: ClockId,
        (cycles_per_bit, time_out): (u16, u32),
        seed: u64,
        options: &Options,
    ) -> Result<Self, Error> {
        let source = Source::circuit(&mut UartBus::new(cycles_per_bit, time_out))?.metastable();
        let library = Library::build(&source, options)?;
        let ends = |names: &[&str], bundle: &str, source: &Source| {
            names.iter().map(|name| source.signal(bundle, name)).collect::<Result<Vec<usize>, Error>>()
        };
        let driven = [ends(&DRIVEN, "bus", &source)?, ends(&DRIVEN, "host", core)?].map(fixed);
        let given = [ends(&GIVEN, "bus", &source)?, ends(&GIVEN, "host", core)?].map(fixed);
        let port = |name| source.port(name);
        let ports = [port("reset_i")?, port("receive_i")?, port("transmit_o")?, port("broken_o")?];
        Ok(Self {
            clock,
            model: library.start(&Start { seed, ..Start::default() })?,
            driven,
            given,
            ports,
            of_core: [core.port("reset_i")?, core.port("uart_broken_i")?],
            held: RESET_CYCLES + 2,
            wants: false,
            last: None,
            terminal: Serial::new(cycles_per_bit),
        })
    }
}

/// As many as there are names.
fn fixed<const N: usize>(ports: Vec<usize>) -> [usize; N] {
    std::array::from_fn(|i| ports[i])
}

impl Actor for Uart {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, core: &mut Model) -> Result<(), Error> {
        if core.peek(self.of_core[0])? == 1 {
            self.held = RESET_CYCLES + 2;
            self.terminal.forget();
        }
        let [reset, receive, transmit, _] = self.ports;
        self.model.poke(reset, u64::from(self.held > 0))?;
        self.held = self.held.saturating_sub(1);
        // The UART samples its inputs only while it requests something.
        if self.wants {
            for (here, there) in self.given[0].iter().zip(self.given[1]) {
                self.model.poke(*here, core.peek(there)?)?;
            }
        }
        let level = self.terminal.level();
        self.model.poke(receive, level.into())?;
        let level = self.model.peek(transmit)? == 1;
        if self.held == 0 {
            self.terminal.see(level);
        }
        self.model.tick()
    }

    fn after(&mut self, core: &mut Model) -> Result<(), Error> {
        let mut driven = [0; DRIVEN.len()];
        for (value, port) in driven.iter_mut().zip(self.driven[0]) {
            *value = self.model.peek(port)?;
        }
        self.wants = driven[..WANTS].contains(&1);
        if self.last != Some(driven) {
            for (value, port) in driven.iter().zip(self.driven[1]) {
                core.poke(port, *value)?;
            }
            core.poke(self.of_core[1], self.model.peek(self.ports[3])?)?;
            self.last = Some(driven);
        }
        Ok(())
    }
}

/// A terminal at the pins of a core that has its own serial line.
pub(super) struct Terminal {
    clock: ClockId,
    receive: usize,
    transmit: usize,
    pub(super) serial: Serial,
}

impl Terminal {
    /// # Errors
    /// The core has no such pins.
    pub(super) fn new(core: &Source, clock: ClockId, cycles_per_bit: u16) -> Result<Self, Error> {
        let (receive, transmit) = (core.port("uart_receive_i")?, core.port("uart_transmit_o")?);
        Ok(Self { clock, receive, transmit, serial: Serial::new(cycles_per_bit) })
    }
}

impl Actor for Terminal {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let level = model.peek(self.transmit)? == 1;
        self.serial.see(level);
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let level = self.serial.level();
        model.poke(self.receive, level.into())
    }
}
