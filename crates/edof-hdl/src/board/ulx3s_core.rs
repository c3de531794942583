//! The core with what the ULX3S has around it: a camera, a serial line, an SDRAM for its frames, and DVI.

use super::axi_sdram::AxiSdram;
use super::chip_setup::ChipSetup;
use super::edof_core::EdofCore;
use super::pace::Pace;
use super::power_on::PowerOn;
use super::registers::Identity;
use super::tables::Tables;
use super::uart_bus::UartBus;
use crate::crossing::ResetSync;
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiLiteMaster, AxiReadMaster, AxiWriteMaster};
use crate::video::camera_in::CameraIn;
use crate::video::dvi::Dvi;
use edof_device::board::ULX3S;
use edof_device::design::{Design, DesignError};
use edof_device::i2c::ov7670::PINS;
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Bits and bytes of a word of the memory's port.
pub(crate) const W: usize = ULX3S.memory.word_bits;
pub(crate) const S: usize = W / 8;

/// Bit of the last four slots at which the camera's pins are.
const CAMERA_PINS: usize = 8 * (PINS as usize - 8);

/// The core with what the ULX3S has around it: a camera and its set-up, a serial line to the host, an SDRAM for its frames, and DVI. Without a camera the host
/// writes raw frames. Pictures are in the middle of a black screen. Pins and clocks are `ulx3s_top`'s.
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
    /// The camera's pixel clock.
    pub camera_clock: Signal<In, Clock>,
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
    /// The camera's vertical sync.
    pub camera_vs: Signal<In, Bit>,
    /// A pixel of the camera's.
    pub camera_href: Signal<In, Bit>,
    /// The pixel.
    pub camera_data: Signal<In, Bits<8>>,
    /// Lets the camera out of power-down (bit 0) and of reset (bit 1).
    pub camera_on: Signal<Out, Bits<2>>,
    /// Clock line of the camera's bus, as it is.
    pub camera_scl: Signal<In, Bit>,
    /// Data line, as it is.
    pub camera_sda: Signal<In, Bit>,
    /// Pulls the clock line down.
    pub camera_scl_low: Signal<Out, Bit>,
    /// Pulls the data line down.
    pub camera_sda_low: Signal<Out, Bit>,
    /// LEDs: 0 the memory is ready; 1 video comes in; 2 it has the design's size; 3 pictures leave the memory; 4 the camera is set up; 5 its set-up failed.
    pub leds: Signal<Out, Bits<6>>,
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
    camera: CameraIn,
    setup: ChipSetup,
    pins_at: Constant<Bits<5>>,
    reset_of_camera: ResetSync,
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
        let (setup, black) = design.camera_chip()?;
        let program = design.program(setup);
        Ok(Self::from_parts(Ulx3sCoreParts {
            core: EdofCore::on_screen(design, sets, identity, tables, picture)?,
            sdram: AxiSdram::new(design.board.core_khz.into()),
            uart: UartBus::new(pace.cycles_per_bit, pace.uart_time_out),
            screen: Dvi::new(screen),
            camera: CameraIn::new(black),
            setup: ChipSetup::new(pace, &program, setup.image, true),
            pins_at: Constant::new((CAMERA_PINS as u64).into()),
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

        self.reset_of_camera.clock.next = self.camera_clock.val();
        self.reset_of_camera.reset.next = self.reset.val();
        self.camera.clock.next = self.camera_clock.val();
        self.camera.reset.next = self.reset_of_camera.domain_reset.val();
        self.camera.camera_vs.next = self.camera_vs.val();
        self.camera.camera_href.next = self.camera_href.val();
        self.camera.camera_data.next = self.camera_data.val();
        self.core.input_clock.next = self.camera_clock.val();
        self.core.input_hs.next = self.camera.hs.val();
        self.core.input_vs.next = self.camera.vs.val();
        self.core.input_de.next = self.camera.de.val();
        self.core.input_data.next = self.camera.data.val();
        // No codes are inside of the pixels.
        self.core.input_codes.next = 0.into();
        self.core.input_malformed.next = 0.into();

        // The camera is the one chip; it is not read.
        self.setup.clock.next = self.clock.val();
        self.setup.reset.next = self.reset_of_core.domain_reset.val();
        self.setup.restart.next = self.core.i2c_restart.val();
        self.setup.settings.next = self.core.video_setup.val();
        self.setup.access.next = self.core.chip_access.val();
        self.setup.scl.next = self.camera_scl.val();
        self.setup.sda.next = self.camera_sda.val();
        self.camera_scl_low.next = self.setup.scl_low.val();
        self.camera_sda_low.next = self.setup.sda_low.val();
        self.camera_on.next =
            (self.setup.slots[2].val() >> bit_cast::<32, 5>(self.pins_at.val())).get_bits::<2>(0);
        self.core.i2c_done.next = self.setup.done.val();
        self.core.i2c_failed.next = self.setup.failed.val();
        self.core.i2c[0].next = 0.into();
        self.core.i2c[1].next = self.setup.word.val();
        for i in 0..4 {
            self.core.chips[i].next = 0.into();
        }
        self.core.chip_answer.next = self.setup.answer.val();

        self.leds.next = self.core.status.val().get_bits::<6>(0);
    }
}
