//! The FMC-IMAGEON's HDMI side: its own bus with a PCA9546A, the PCA9534 that holds reset and hot plug, the ADV7611, a source at its cable.
//!
//! Sources: Avnet `fmc_imageon.c` (addresses, channels, pins of the expander); `zynq-zed-imageon.dts`; first the mux is in reset until LA01 is high.

use crate::chip_models::adv7511::{Adv7511, LowHotPlug};
use crate::chip_models::adv7611::eye::Eye;
use crate::chip_models::adv7611::output::Word;
use crate::chip_models::adv7611::{Adv7611, State};
use crate::chip_models::expander::Pca9534;
use crate::chip_models::faults::Faults;
use crate::chip_models::hdmi::{Link, Timing};
use crate::chip_models::memory::Bytes;
use crate::chip_models::source::{Place, Source};
use crate::chip_models::switch::Switch;
use crate::chip_models::wire::{Lines, Pulls, Tap, Target, Wires};

/// How long chips are deaf, in steps of the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Delays {
    /// ADV7511 after power-up.
    pub adv7511: u64,
    /// ADV7611 after reset.
    pub adv7611: u64,
    /// Until the ADV7611 has cleared its EDID memory.
    pub edid_clear: u64,
}

impl Delays {
    /// All chips answer at once.
    pub const NONE: Self = Self { adv7511: 0, adv7611: 0, edid_clear: 0 };

    /// 200 ms (ADV7511 Programming Guide), 5 ms (UG-180), 1 ms (UG-237 page 35).
    #[must_use]
    pub const fn of(steps_per_ms: u64) -> Self {
        Self { adv7511: 200 * steps_per_ms, adv7611: 5 * steps_per_ms, edid_clear: steps_per_ms }
    }
}

/// Pins of the expander: the ADV7611's reset, and hot plug of the cable.
const RESET_PIN: u8 = 0;
const HOT_PLUG_PIN: u8 = 2;
/// Channels of the switch.
const DDC: u8 = 0;
const HDMI_OUT: u8 = 1;
const HDMI_IN: u8 = 2;
const EXPANDER: u8 = 3;

/// The card.
#[derive(Debug, Clone)]
pub struct Imageon {
    switch: Tap<Switch>,
    ddc: Tap<Bytes>,
    transmitter: Tap<Adv7511>,
    receiver: Tap<Adv7611>,
    expander: Tap<Pca9534>,
    synthesiser: Tap<Bytes>,
    faults: Faults,
    /// The receiver's reset pin is held low by a short.
    is_shorted: bool,
    source: Option<Source>,
    /// The size of the free run's picture in a short simulation.
    short: Option<Timing>,
    own_place: Place,
    line: Vec<Word>,
    sampled: Word,
    eye: Eye,
}

impl Imageon {
    /// The card after power-up, its switch in reset.
    #[must_use]
    pub fn new(delays: Delays) -> Self {
        Self {
            switch: Tap::new(Switch::PCA9546A),
            ddc: Tap::new(Bytes::eeprom(0x50, [0xff; 256])),
            transmitter: Tap::new(Adv7511::new(delays.adv7511, LowHotPlug::HoldsDefaults)),
            receiver: Tap::new(Adv7611::new(delays.adv7611, delays.edid_clear)),
            expander: Tap::new(Pca9534::default()),
            synthesiser: Tap::new(Bytes::cdce913()),
            faults: Faults::default(),
            is_shorted: false,
            source: None,
            short: None,
            own_place: Place { row: 0, column: 0 },
            line: vec![],
            sampled: 0,
            eye: Eye::wide(),
        }
    }

    /// The level of LA01: reset of the switch, active low.
    pub fn set_reset(&mut self, high: bool) {
        self.switch.chip.set_reset(high);
    }

    /// What may go wrong on its bus.
    pub const fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }

    /// Holds the receiver in reset whatever the expander drives, or lets it go.
    pub fn short_reset(&mut self, low: bool) {
        self.is_shorted = low;
        self.refresh();
    }

    /// Whether a pin of the expander is driven high. Undriven pins have pull-downs.
    fn level(&self, pin: u8) -> bool {
        self.expander.chip.drives(pin) == Some(true)
    }

    fn receiver_runs(&self) -> bool {
        self.level(RESET_PIN) && !self.is_shorted
    }

    /// The receiver.
    #[must_use]
    pub const fn receiver(&self) -> &Adv7611 {
        &self.receiver.chip
    }

    /// The expander.
    #[must_use]
    pub const fn expander(&self) -> &Pca9534 {
        &self.expander.chip
    }

    /// The clock synthesiser, which nobody here needs.
    #[must_use]
    pub const fn synthesiser(&self) -> &Bytes {
        &self.synthesiser.chip
    }

    /// The switch.
    #[must_use]
    pub const fn switch(&self) -> &Switch {
        &self.switch.chip
    }

    /// Puts a source's cable in, or pulls it out.
    pub fn plug(&mut self, source: Option<Source>) {
        self.source = source;
        self.refresh();
    }

    /// The source at the cable.
    #[must_use]
    pub const fn source(&self) -> Option<&Source> {
        self.source.as_ref()
    }

    /// When the FPGA samples well.
    pub fn set_eye(&mut self, eye: Eye) {
        self.eye = eye;
    }

    /// The window in which the FPGA samples well.
    #[must_use]
    pub const fn eye(&self) -> &Eye {
        &self.eye
    }

    /// Passes pictures of this size in place of the free run's, for a short simulation; its clock stays that of the receiver's registers.
    pub const fn shorten_free_run(&mut self, short: Timing) {
        self.short = Some(short);
    }

    /// Levels of pins that are no bus: reset of the receiver, hot plug and 5 V of the cable.
    fn refresh(&mut self) {
        let (runs, hot_plug) = (self.receiver_runs(), self.level(HOT_PLUG_PIN));
        self.receiver.chip.set_reset(runs);
        if let Some(source) = &mut self.source {
            let receiver = &self.receiver.chip;
            source.see(hot_plug, || receiver.ddc());
        }
        let signal = self.source.as_ref().and_then(|source| Some((source.timing(), source.link()?)));
        self.receiver.chip.see(self.source.is_some(), signal);
    }

    /// Whether the pixel clock comes out of the receiver.
    pub fn clock_runs(&mut self) -> bool {
        self.refresh();
        self.receiver.chip.clock_runs()
    }

    /// The pixel clock that comes out of the receiver, in kilohertz; 0 where none comes.
    pub fn clock_khz(&mut self) -> u32 {
        self.refresh();
        self.receiver.chip.clock_khz()
    }

    /// One pixel clock: the word on `hdmi_rx_data` as the FPGA samples it; none while there is no clock.
    pub fn pixel(&mut self) -> Option<Word> {
        let Some((timing, link, place)) = self.clock_runs().then(|| self.place()).flatten() else {
            self.own_place = Place { row: 0, column: 0 };
            return None;
        };
        if place.column == 0 || self.line.len() != timing.line.total() {
            self.line = self.words(timing, link, place.row);
        }
        let word = self.line.get(place.column).copied().unwrap_or(0);
        let last = Place { row: timing.frame.total() - 1, column: timing.line.total() - 1 };
        if place == last {
            self.receiver.chip.frame();
        }
        let (inverted, tap) = self.receiver.chip.clock_phase();
        let word = if self.has_data() { word } else { 0 };
        let is_open = self.eye.is_open(inverted, tap);
        let before = std::mem::replace(&mut self.sampled, word);
        Some(self.eye.sample(is_open, before, word))
    }

    /// Data pins are on: IO 15 bit 1.
    const fn has_data(&self) -> bool {
        !self.receiver.chip.page(crate::chip_models::adv7611::maps::Map::Io).bit(0x15, 1)
    }

    /// Where the picture is: the source's, or the receiver's own.
    fn place(&mut self) -> Option<(Timing, Option<Link>, Place)> {
        if let Some(source) = self.source.as_mut().filter(|source| source.sends()) {
            return Some((source.timing(), source.link(), source.advance()));
        }
        let mode = self.receiver.chip.free_run()?;
        let timing = self.short.map_or(mode, |short| short.in_place_of(mode));
        let place = self.own_place;
        self.own_place.column += 1;
        if self.own_place.column == timing.line.total() {
            self.own_place = Place { row: (place.row + 1) % timing.frame.total(), column: 0 };
        }
        Some((timing, None, place))
    }

    fn words(&self, timing: Timing, link: Option<Link>, row: usize) -> Vec<Word> {
        let chip = &self.receiver.chip;
        let seen = |row: usize| row % timing.frame.total() < timing.frame.active;
        let shows = matches!(chip.state(), State::Runs) || chip.is_free_running();
        let pixels = match &self.source {
            _ if !seen(row) || !shows => vec![],
            Some(source) if source.sends() => source.line(row),
            _ => vec![[0; 3]; timing.line.active],
        };
        let link = link.unwrap_or(Link { is_hdmi: false, avi: None });
        chip.line(timing, link, &pixels, seen(row + 1))
    }

    /// What the chips behind open channels pull low.
    fn sda_low(&self) -> bool {
        let open = |channel: u8, low: bool| self.switch.chip.is_open(channel) && low;
        self.switch.sda_low()
            || open(DDC, self.ddc.sda_low())
            || open(HDMI_OUT, self.transmitter.sda_low())
            || open(HDMI_IN, self.receiver.sda_low())
            || open(EXPANDER, self.expander.sda_low() || self.synthesiser.sda_low())
    }
}

/// The lines behind a channel: those of the bus, or idle except for what the chip itself pulls.
pub(crate) const fn behind<T: Target>(switch: &Switch, channel: u8, lines: Lines, tap: &Tap<T>) -> Lines {
    if switch.is_open(channel) { lines } else { Lines { scl: true, sda: !tap.sda_low() } }
}

impl Wires for Imageon {
    fn step(&mut self, master: Pulls) -> Lines {
        let lines = self.faults.lines(master, self.sda_low());
        let switch = &self.switch.chip;
        let at = |channel, tap: &Tap<Bytes>| behind(switch, channel, lines, tap);
        let (ddc, synthesiser) = (at(DDC, &self.ddc), at(EXPANDER, &self.synthesiser));
        let transmitter = behind(switch, HDMI_OUT, lines, &self.transmitter);
        let receiver = behind(switch, HDMI_IN, lines, &self.receiver);
        let expander = behind(switch, EXPANDER, lines, &self.expander);
        let faults = &mut self.faults;
        self.switch.see(lines, faults);
        self.ddc.see(ddc, faults);
        self.synthesiser.see(synthesiser, faults);
        self.transmitter.see(transmitter, faults);
        self.receiver.see(receiver, faults);
        self.expander.see(expander, faults);
        let runs = self.receiver_runs();
        self.receiver.chip.set_reset(runs);
        self.receiver.chip.step();
        self.transmitter.chip.step();
        lines
    }
}
