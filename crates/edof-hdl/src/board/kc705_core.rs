//! The core with what the KC705 has around it: a serial line, video chips, syncs inside of the pixels.

use super::chip_setup::ChipSetup;
use super::edof_core::EdofCore;
use super::embedded_syncs::EmbeddedSyncs;
use super::pace::Pace;
use super::registers::Identity;
use super::tables::Tables;
use super::uart_bus::UartBus;
use crate::crossing::ResetSync;
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiLiteMaster, AxiReadMaster, AxiWriteMaster};
use edof_device::board::{KC705, Setup};
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// Bits and bytes of a word of the DRAM's port.
pub(crate) const W: usize = KC705.memory.word_bits;
pub(crate) const S: usize = W / 8;

/// The core with what the KC705 has around it: a serial line to the host, two buses of video chips to be set up, and an HDMI receiver
/// whose syncs come inside of the pixels. Buffers, DRAM controller and clocks are `kc705_top`'s.
#[derive(Circuit)]
#[circuit(default(EmbeddedSyncs, ResetSync), registers(clock))]
pub struct Kc705Core {
    /// Clock of memory and host: 200 MHz.
    pub clock: Signal<In, Clock>,
    /// Clock of the calculator: the design's.
    pub calculator_clock: Signal<In, Clock>,
    /// Clock of the incoming pixels.
    pub input_clock: Signal<In, Clock>,
    /// Clock of the screen: 148.5 MHz.
    pub screen_clock: Signal<In, Clock>,
    /// Begins anew, of no clock.
    pub reset: Signal<In, Bit>,
    /// The calculator's clock is lost, in `clock`.
    pub calculator_reset: Signal<In, Bit>,
    /// The screen's clock is lost, in `clock`.
    pub screen_reset: Signal<In, Bit>,
    /// From the receiver: Y high, C low, syncs inside.
    pub input_data: Signal<In, Bits<16>>,
    /// To the transmitter: horizontal sync.
    pub screen_hs: Signal<Out, Bit>,
    /// Vertical sync.
    pub screen_vs: Signal<Out, Bit>,
    /// A pixel is on the bus.
    pub screen_de: Signal<Out, Bit>,
    /// Codes of the pixel: Y' low, Cb' or Cr' high.
    pub screen_data: Signal<Out, Bits<16>>,
    /// Writes to the DRAM.
    pub dram_write: AxiWriteMaster<W, S>,
    /// Reads from the DRAM.
    pub dram_read: AxiReadMaster<W>,
    /// The DRAM is calibrated.
    pub dram_ready: Signal<In, Bit>,
    /// From the host, of no clock.
    pub uart_receive: Signal<In, Bit>,
    /// To the host.
    pub uart_transmit: Signal<Out, Bit>,
    /// Clock lines of the board's I2C and the card's, as they are.
    pub scl: [Signal<In, Bit>; 2],
    /// Data lines, as they are.
    pub sda: [Signal<In, Bit>; 2],
    /// Pulls the clock lines down.
    pub scl_low: [Signal<Out, Bit>; 2],
    /// Pulls the data lines down.
    pub sda_low: [Signal<Out, Bit>; 2],
    /// LEDs: 0 the memory is ready; 1 video comes in, blinking where a cable is in and nothing comes; 2 it has the design's size; 3 pictures
    /// leave; 4 all video chips are set up; 5 a set-up failed; 6 a screen is plugged in.
    pub leds: Signal<Out, Bits<7>>,
    core: EdofCore<W, S>,
    syncs: EmbeddedSyncs,
    uart: UartBus,
    chips: [ChipSetup; 2],
    reset_of_input: ResetSync,
    reset_of_core: ResetSync,
    swapped: Signal<Local, Bits<16>>,
    blink: DFF<Bits<27>>,
    led_levels: Signal<Local, Bits<7>>,
}

impl Kc705Core {
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
        let [output, input] = design.video_chips()?;
        let core = EdofCore::new(design, sets, identity, tables)?;
        let setup =
            |setup: &Setup, is_card| ChipSetup::new(pace, &design.program(setup), setup.image, is_card);
        Ok(Self::from_parts(Kc705CoreParts {
            core,
            uart: UartBus::new(pace.cycles_per_bit, pace.uart_time_out),
            chips: [setup(output, false), setup(input, true)],
        }))
    }
}

impl Logic for Kc705Core {
    #[kernel]
    fn update(&mut self) {
        self.core.clock.next = self.clock.val();
        self.core.input_clock.next = self.input_clock.val();
        self.core.screen_clock.next = self.screen_clock.val();
        self.core.reset.next = self.reset.val();
        self.core.calculator_clock.next = self.calculator_clock.val();
        self.core.calculator_reset.next = self.calculator_reset.val();
        self.core.screen_reset.next = self.screen_reset.val();
        self.reset_of_input.clock.next = self.input_clock.val();
        self.reset_of_input.reset.next = self.reset.val();
        self.reset_of_core.clock.next = self.clock.val();
        self.reset_of_core.reset.next = self.reset.val();

        self.syncs.clock.next = self.input_clock.val();
        self.syncs.reset.next = self.reset_of_input.domain_reset.val();
        // The card has luma on the upper byte, the core on the lower.
        self.swapped.next = (self.input_data.val() >> 8) | (self.input_data.val() << 8);
        self.syncs.data.next = self.swapped.val();
        self.core.input_codes.next = self.syncs.codes.val();
        self.core.input_malformed.next = self.syncs.malformed.val();
        self.core.input_hs.next = self.syncs.hs.val();
        self.core.input_vs.next = self.syncs.vs.val();
        self.core.input_de.next = self.syncs.de.val();
        self.core.input_data.next = self.syncs.pixel.val();
        self.screen_hs.next = self.core.screen_hs.val();
        self.screen_vs.next = self.core.screen_vs.val();
        self.screen_de.next = self.core.screen_de.val();
        self.screen_data.next = self.core.screen_data.val();

        AxiWriteMaster::<W, S>::link(&mut self.dram_write, &mut self.core.dram_write);
        AxiReadMaster::<W>::link(&mut self.dram_read, &mut self.core.dram_read);
        self.core.dram_ready.next = self.dram_ready.val();

        self.uart.clock.next = self.clock.val();
        self.uart.reset.next = self.reset_of_core.domain_reset.val();
        self.uart.receive.next = self.uart_receive.val();
        self.uart_transmit.next = self.uart.transmit.val();
        self.core.uart_broken.next = self.uart.broken.val();
        AxiLiteMaster::join(&mut self.uart.bus, &mut self.core.host);

        for i in 0..2 {
            self.chips[i].clock.next = self.clock.val();
            self.chips[i].reset.next = self.reset_of_core.domain_reset.val();
            self.chips[i].restart.next = self.core.i2c_restart.val();
            self.chips[i].scl.next = self.scl[i].val();
            self.chips[i].sda.next = self.sda[i].val();
            self.scl_low[i].next = self.chips[i].scl_low.val();
            self.sda_low[i].next = self.chips[i].sda_low.val();
        }
        self.core.i2c_done.next = self.chips[0].done.val() && self.chips[1].done.val();
        self.core.i2c_failed.next = self.chips[0].failed.val() || self.chips[1].failed.val();
        for i in 0..2 {
            self.chips[i].settings.next = self.core.video_setup.val();
            self.chips[i].access.next = self.core.chip_access.val();
            self.core.i2c[i].next = self.chips[i].word.val();
        }
        for i in 0..3 {
            self.core.chips[i].next = self.chips[1].slots[i].val();
        }
        self.core.chips[3].next = self.chips[0].slots[0].val();
        self.core.chip_answer.next = self.chips[0].answer.val();
        if self.core.chip_access.val().get_bit(25) {
            self.core.chip_answer.next = self.chips[1].answer.val();
        }

        self.blink.d.next = self.blink.q.val() + 1;
        self.led_levels.next = self.core.status.val().get_bits::<7>(0) & 0x3f;
        if self.chips[1].slots[0].val().get_bit(8) && self.blink.q.val().get_bit(26) {
            self.led_levels.next = self.led_levels.val() | 2;
        }
        if self.chips[0].slots[0].val().get_bit(6) {
            self.led_levels.next = self.led_levels.val() | 0x40;
        }
        self.leds.next = self.led_levels.val();
    }
}
