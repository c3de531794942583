//! The core with what the ULX3S has around it: a serial line, an SDRAM for its frames, and DVI.

use super::axi_sdram::AxiSdram;
use super::edof_core::EdofCore;
use super::pace::Pace;
use super::power_on::PowerOn;
use super::registers::Identity;
use super::tables::Tables;
use super::uart_bus::UartBus;
use crate::crossing::ResetSync;
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiLiteMaster, AxiReadMaster, AxiWriteMaster};
use crate::video::dvi::Dvi;
use edof_device::board::ULX3S;
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Bits and bytes of a word of the memory's port.
pub(crate) const W: usize = ULX3S.memory.word_bits;
pub(crate) const S: usize = W / 8;

/// The core with what the ULX3S has around it: a serial line to the host, an SDRAM for its frames, and DVI. No video comes in: the host writes raw
/// frames. Pictures are in the middle of a black screen. Pins and clocks are `ulx3s_top`'s.
#[derive(Circuit)]
#[circuit(default(ResetSync, PowerOn))]
pub struct Ulx3sCore {
    /// Clock of memory and host.
    pub clock: Signal<In, Clock>,
    /// Clock of the calculator: the design's.
    pub calculator_clock: Signal<In, Clock>,
    /// Clock of the screen's pixels.
    pub screen_clock: Signal<In, Clock>,
    /// A clock of the same source, five times as fast: two bits of each pair a cycle.
    pub bit_clock: Signal<In, Clock>,
    /// Begins anew, of no clock.
    pub reset: Signal<In, Bit>,
    /// The calculator's clock is lost, in `clock`.
    pub calculator_reset: Signal<In, Bit>,
    /// From the host, of no clock.
    pub uart_receive: Signal<In, Bit>,
    /// To the host.
    pub uart_transmit: Signal<Out, Bit>,
    /// Pairs of the DVI cable: blue, green, red, clock.
    pub dvi: Signal<Out, Bits<4>>,
    /// LEDs: 0 the memory is ready; 3 pictures leave the memory.
    pub leds: Signal<Out, Bits<4>>,
    /// The SDRAM's RAS#, CAS# and WE#; the pins are registered outside.
    pub sdram_command: Signal<Out, Bits<3>>,
    /// Its bank.
    pub sdram_bank: Signal<Out, Bits<2>>,
    /// Its row, column or mode.
    pub sdram_address: Signal<Out, Bits<13>>,
    /// Its masks of bytes.
    pub sdram_mask: Signal<Out, Bits<2>>,
    /// Data to it.
    pub sdram_data_out: Signal<Out, Bits<16>>,
    /// Its data lines are driven; no register outside.
    pub sdram_drive: Signal<Out, Bit>,
    /// Data from it.
    pub sdram_data_in: Signal<In, Bits<16>>,
    core: EdofCore<W, S>,
    sdram: AxiSdram,
    uart: UartBus,
    screen: Dvi,
    reset_of_screen: ResetSync,
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
        let screen = pace.screen.unwrap_or_else(|| design.screen());
        let picture = screen.around(design.frame);
        Ok(Self::from_parts(Ulx3sCoreParts {
            core: EdofCore::on_screen(design, sets, identity, tables, picture)?,
            sdram: AxiSdram::new(design.board.core_khz.into()),
            uart: UartBus::new(pace.cycles_per_bit, pace.uart_time_out),
            screen: Dvi::new(screen),
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
        self.sdram.clock.next = self.clock.val();
        self.sdram.reset.next = self.power_on.first.val();
        self.core.dram_ready.next = self.sdram.ready.val();
        AxiWriteMaster::<W, S>::join(&mut self.core.dram_write, &mut self.sdram.write);
        AxiReadMaster::<W>::join(&mut self.core.dram_read, &mut self.sdram.read);
        self.sdram_command.next = self.sdram.command.val();
        self.sdram_bank.next = self.sdram.bank.val();
        self.sdram_address.next = self.sdram.address.val();
        self.sdram_mask.next = self.sdram.mask.val();
        self.sdram_data_out.next = self.sdram.data_out.val();
        self.sdram_drive.next = self.sdram.drive.val();
        self.sdram.data_in.next = self.sdram_data_in.val();

        self.uart.clock.next = self.clock.val();
        self.uart.reset.next = self.reset_of_core.domain_reset.val();
        self.uart.receive.next = self.uart_receive.val();
        self.uart_transmit.next = self.uart.transmit.val();
        self.core.uart_broken.next = self.uart.broken.val();
        AxiLiteMaster::join(&mut self.uart.bus, &mut self.core.host);

        self.reset_of_screen.clock.next = self.screen_clock.val();
        self.reset_of_screen.reset.next = self.reset.val();
        self.screen.clock.next = self.screen_clock.val();
        self.screen.bit_clock.next = self.bit_clock.val();
        self.screen.reset.next = self.reset_of_screen.domain_reset.val();
        self.screen.hs.next = self.core.screen_hs.val();
        self.screen.vs.next = self.core.screen_vs.val();
        self.screen.de.next = self.core.screen_de.val();
        self.screen.data.next = self.core.screen_data.val();
        self.dvi.next = self.screen.pins.val();

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
