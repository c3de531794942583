//! The KC705's bus: a PCA9548A with eight channels, behind one of them the ADV7511, and a screen at its cable.
//!
//! Source: UG810 v1.9 page 53 and table of I2C devices; PoC `ucf/KC705/Bus.IIC.xdc`.

use crate::chip_models::adv7511::{Adv7511, Bus, Event, LowHotPlug, State};
use crate::chip_models::faults::Faults;
use crate::chip_models::imageon::{Delays, behind};
use crate::chip_models::memory::Bytes;
use crate::chip_models::screen::Screen;
use crate::chip_models::switch::Switch;
use crate::chip_models::wire::{Lines, Pulls, Tap, Wires};

/// The ADV7511's channel.
const HDMI: u8 = 5;

/// The board's chips.
#[derive(Debug, Clone)]
pub struct Kc705 {
    switch: Tap<Switch>,
    transmitter: Tap<Adv7511>,
    /// Chips that are only bytes to us, by channel.
    others: Vec<(u8, Tap<Bytes>)>,
    faults: Faults,
    screen: Option<Screen>,
}

impl Kc705 {
    /// The board after power-up, its switch in reset, an FMC-IMAGEON on its LPC connector, no SFP module, no screen.
    #[must_use]
    pub fn new(delays: Delays, low: LowHotPlug) -> Self {
        let others = [
            (0, Bytes::registers(0x5d)),
            // The card's identity: all that it has on the connector's own bus.
            (2, Bytes::eeprom(0x50, [0xff; 256])),
            (3, Bytes::eeprom(0x54, [0xff; 256])),
            (6, Bytes::eeprom(0x50, [0x92; 256])),
            (6, Bytes::registers(0x18)),
            (7, Bytes::registers(0x68)),
        ];
        Self {
            switch: Tap::new(Switch::PCA9548A),
            transmitter: Tap::new(Adv7511::new(delays.adv7511, low)),
            others: others.map(|(channel, chip)| (channel, Tap::new(chip))).into(),
            faults: Faults::default(),
            screen: None,
        }
    }

    /// The level of P23: reset of the switch, active low.
    pub fn set_reset(&mut self, high: bool) {
        self.switch.chip.set_reset(high);
    }

    /// What may go wrong on its bus.
    pub const fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }

    /// The transmitter.
    #[must_use]
    pub const fn transmitter(&self) -> &Adv7511 {
        &self.transmitter.chip
    }

    /// The switch.
    #[must_use]
    pub const fn switch(&self) -> &Switch {
        &self.switch.chip
    }

    /// Connects a screen, or takes its cable out.
    pub fn attach(&mut self, screen: Option<Screen>) {
        self.screen = screen;
        self.refresh();
    }

    /// Switches the screen on or off.
    pub fn switch_screen(&mut self, on: bool) {
        if let Some(screen) = &mut self.screen {
            screen.is_on = on;
            screen.dark();
        }
        self.refresh();
    }

    /// The screen.
    #[must_use]
    pub const fn screen(&self) -> Option<&Screen> {
        self.screen.as_ref()
    }

    /// The screen, to forget what it showed.
    pub const fn screen_mut(&mut self) -> Option<&mut Screen> {
        self.screen.as_mut()
    }

    fn refresh(&mut self) {
        let edid = self.screen.as_ref().map(Screen::edid);
        let hot_plug = self.screen.as_ref().is_some_and(|screen| screen.is_on);
        self.transmitter.chip.see(edid, hot_plug);
    }

    /// One pixel clock of the transmitter.
    pub fn pixel(&mut self, bus: Bus) {
        let event = self.transmitter.chip.pixel(bus);
        let Some(screen) = &mut self.screen else { return };
        match event {
            Some(Event::Line(pixels)) => screen.line(pixels),
            Some(Event::Sync) => screen.sync(self.transmitter.chip.link()),
            None if self.transmitter.chip.state() != State::Runs => screen.dark(),
            None => {}
        }
    }
}

impl Wires for Kc705 {
    fn step(&mut self, master: Pulls) -> Lines {
        let open = |channel: u8, low: bool| self.switch.chip.is_open(channel) && low;
        let low = self.switch.sda_low()
            || open(HDMI, self.transmitter.sda_low())
            || self.others.iter().any(|(channel, tap)| open(*channel, tap.sda_low()));
        let lines = self.faults.lines(master, low);
        let switch = self.switch.chip.clone();
        self.switch.see(lines, &mut self.faults);
        self.transmitter.see(behind(&switch, HDMI, lines, &self.transmitter), &mut self.faults);
        for (channel, tap) in &mut self.others {
            tap.see(behind(&switch, *channel, lines, tap), &mut self.faults);
        }
        self.transmitter.chip.step();
        lines
    }
}
