//! The ULX3S' SDRAM at the controller's ports, behind the registers that the board has at its pins.

use crate::bench::{Actor, ClockId};
use crate::verilator::Model;
use crate::{Error, Source};
use edof_board::chip_models::sdram::{Pins, Sdram};

/// The chip. A rule that is broken stops the simulation.
pub struct SdramChip {
    clock: ClockId,
    chip: Sdram,
    /// RAS#, CAS# and WE#, bank, address, mask, data to the chip; whether the lines are driven; data from the chip.
    outputs: [usize; 5],
    drive: usize,
    data_in: usize,
    /// Ports of the cycle before, and what the chip drove in it.
    pins: [u64; 5],
    word: Option<u16>,
    cycles: u16,
}

impl SdramChip {
    /// A chip at the ports whose names begin so, of a controller whose clock has a period in picoseconds.
    ///
    /// # Errors
    /// There are no such ports.
    pub fn new(source: &Source, prefix: &str, clock: ClockId, period: u64) -> Result<Self, Error> {
        let port = |name: &str| source.port(&format!("{prefix}{name}"));
        let [command, bank, address, mask, data] =
            ["command_o", "bank_o", "address_o", "mask_o", "data_out_o"].map(port);
        Ok(Self {
            clock,
            chip: Sdram::new(period),
            outputs: [command?, bank?, address?, mask?, data?],
            drive: port("drive_o")?,
            data_in: port("data_in_i")?,
            // Registers start with anything, which the power-up time must cover: no command is what the reset gives.
            pins: [0b111, 0, 0, 0, 0],
            word: None,
            cycles: 0,
        })
    }

    /// Notes when the controller writes the words at these byte addresses, of which a row's 512 are in one bank, and the next row's in the next.
    #[must_use]
    pub fn watching(mut self, addresses: impl IntoIterator<Item = u32>) -> Self {
        let place = |address: u32| {
            let word = address / 2;
            ((word >> 9 & 3) as usize, (word >> 11) as u16, (word & 511) as u16)
        };
        self.chip.watch(addresses.into_iter().map(place));
        self
    }

    /// Returns when words that are watched were written, in picoseconds.
    #[must_use]
    pub fn moments(&self) -> &[u64] {
        self.chip.moments()
    }

    /// Refreshes so far.
    #[must_use]
    pub fn refreshes(&self) -> usize {
        self.chip.refreshes()
    }
}

impl Actor for SdramChip {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    /// Half a cycle after the controller's clock the chip's rises: it sees what the registers at the pins took, which is what the ports had a cycle before.
    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        self.cycles = self.cycles.wrapping_add(1);
        let [command, bank, address, mask, data] = self.pins;
        let is_driven = model.peek(self.drive)? == 1;
        let pins = Pins {
            cke: true,
            cs_n: false,
            command: command as u8,
            bank: bank as u8,
            address: address as u16,
            mask: mask as u8,
            data: is_driven.then_some(data as u16),
        };
        for (pin, port) in self.pins.iter_mut().zip(self.outputs) {
            *pin = model.peek(port)?;
        }
        // Lines that nobody drives have any value.
        let lines = self.word.unwrap_or(0xa5a5 ^ self.cycles);
        let port = "SDRAM".to_owned();
        if is_driven && self.word.is_some() {
            let rule = "both sides drive the data lines".to_owned();
            return Err(Error::Rule { port, edge: model.cycle(), rule });
        }
        self.word = self.chip.edge(pins).map_err(|rule| Error::Rule { port, edge: model.cycle(), rule })?;
        model.poke(self.data_in, lines.into())
    }
}
