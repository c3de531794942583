//! The core with what the ULX3S has around it: a serial line, and block RAM for its frames.

use super::axi_ram::AxiRam;
use super::edof_core::EdofCore;
use super::pace::Pace;
use super::power_on::PowerOn;
use super::registers::Identity;
use super::tables::Tables;
use super::uart_bus::UartBus;
use crate::crossing::ResetSync;
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiLiteMaster, AxiReadMaster, AxiWriteMaster};
use edof_device::board::ULX3S;
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Bits and bytes of a word of the memory's port.
pub(crate) const W: usize = ULX3S.memory.word_bits;
pub(crate) const S: usize = W / 8;

/// The core with what the ULX3S has around it: a serial line to the host, and block RAM for its frames. Video neither comes in nor goes out: the
/// host writes raw frames and reads pictures. The picture's reader runs all the same, at the screen's clock, so that what it reads is checked.
/// Pins and clocks are `ulx3s_top`'s.
#[derive(Circuit)]
#[circuit(default(ResetSync, PowerOn))]
pub struct Ulx3sCore {
    /// Clock of memory and host.
    pub clock: Signal<In, Clock>,
    /// Clock of the calculator: the design's.
    pub calculator_clock: Signal<In, Clock>,
    /// Clock of the pictures' reader.
    pub screen_clock: Signal<In, Clock>,
    /// Begins anew, of no clock.
    pub reset: Signal<In, Bit>,
    /// The calculator's clock is lost, in `clock`.
    pub calculator_reset: Signal<In, Bit>,
    /// From the host, of no clock.
    pub uart_receive: Signal<In, Bit>,
    /// To the host.
    pub uart_transmit: Signal<Out, Bit>,
    /// LEDs: 0 the memory is ready; 3 pictures leave the memory.
    pub leds: Signal<Out, Bits<4>>,
    core: EdofCore<W, S>,
    ram: AxiRam<W, S>,
    uart: UartBus,
    reset_of_core: ResetSync,
    power_on: PowerOn,
}

impl Ulx3sCore {
    /// Makes the core of a design and surrounds it.
    ///
    /// # Errors
    /// As [`EdofCore::new`].
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        identity: &Identity,
        tables: &Tables,
        pace: &Pace,
    ) -> Result<Self, DesignError> {
        let memory = &design.board.memory;
        Ok(Self::from_parts(Ulx3sCoreParts {
            core: EdofCore::new(design, sets, identity, tables)?,
            ram: AxiRam::new(memory.words()),
            uart: UartBus::new(pace.cycles_per_bit, pace.uart_time_out),
        }))
    }
}

impl Logic for Ulx3sCore {
    #[kernel]
    fn update(&mut self) {
        self.core.clock.next = self.clock.val();
        self.core.calculator_clock.next = self.calculator_clock.val();
        self.core.screen_clock.next = self.screen_clock.val();
        self.core.reset.next = self.reset.val();
        self.core.calculator_reset.next = self.calculator_reset.val();
        self.core.screen_reset.next = false;
        self.reset_of_core.clock.next = self.clock.val();
        self.reset_of_core.reset.next = self.reset.val();
        self.power_on.clock.next = self.clock.val();
        self.power_on.reset.next = self.reset_of_core.domain_reset.val();

        // The memory is reset once, with all of the core; a later reset of the core completes what is in flight.
        self.ram.clock.next = self.clock.val();
        self.ram.reset.next = self.power_on.first.val();
        self.core.dram_ready.next = !self.power_on.first.val();
        AxiWriteMaster::<W, S>::join(&mut self.core.dram_write, &mut self.ram.write);
        AxiReadMaster::<W>::join(&mut self.core.dram_read, &mut self.ram.read);

        self.uart.clock.next = self.clock.val();
        self.uart.reset.next = self.reset_of_core.domain_reset.val();
        self.uart.receive.next = self.uart_receive.val();
        self.uart_transmit.next = self.uart.transmit.val();
        self.core.uart_broken.next = self.uart.broken.val();
        AxiLiteMaster::join(&mut self.uart.bus, &mut self.core.host);

        // No video comes in, and no chip is there to be set up.
        self.core.input_clock.next = self.clock.val();
        self.core.input_hs.next = false;
        self.core.input_vs.next = false;
        self.core.input_de.next = false;
        self.core.input_data.next = 0.into();
        self.core.input_codes.next = 0.into();
        self.core.input_malformed.next = 0.into();
        self.core.i2c_done.next = true;
        self.core.i2c_failed.next = false;
        for i in 0..2 {
            self.core.i2c[i].next = 0.into();
        }
        for i in 0..4 {
            self.core.chips[i].next = 0.into();
        }
        self.core.chip_answer.next = 0.into();

        self.leds.next = self.core.status.val().get_bits::<4>(0) & 9;
    }
}
