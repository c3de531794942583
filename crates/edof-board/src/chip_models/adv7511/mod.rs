//! ADV7511: from words at pins to a cable.
//!
//! Sources: ADI's ADV7511 Programming Guide and Linux `adv7511_drv.c` for registers, defaults and fixed values; EngineerZone document 837 for
//! what hot plug does; [`pixels`] for the way of the pixels.

pub mod pixels;

use crate::chip_models::edid::Edid;
use crate::chip_models::hdmi::{Avi, Coding, Link};
use crate::chip_models::registers::{Entry, Page, Rule};
use crate::chip_models::wire::Target;
pub use pixels::{Bus, Event};
use pixels::{Csc, Line};

/// Main map: 0x72 in 8 bits, with the address pin low.
const ADDRESS: u8 = 0x39;
/// Registers that a low hot plug leaves alone (EngineerZone document 837).
const KEPT: std::ops::RangeInclusive<u8> = 0x97..=0xaf;
/// HPD control and interrupts, which answer always (the same document: "HPD state and interrupt registers remain available").
const POWER_2: u8 = 0xd6;
const INTERRUPTS: u8 = 0x96;

/// What writes do while hot plug is low. Sources disagree, so a set-up has to live with both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LowHotPlug {
    /// Registers stay at their defaults all the time ("during power down all registers are reset", EngineerZone document 837).
    HoldsDefaults,
    /// Registers fall to their defaults once; only power-up is rejected (EngineerZone 13858: others "write and read good").
    ResetsOnce,
}

/// The first thing that stops a picture, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum State {
    /// Hot plug is low, and not overridden by D6.
    #[error("the ADV7511 sees no hot plug")]
    NoHotPlug,
    /// 41 bit 6.
    #[error("the ADV7511 is powered down")]
    PoweredDown,
    /// 15, 16, 48 are not those of 16 bits of 4:2:2 with separate syncs on D8 to D23.
    #[error("the ADV7511 expects another bus")]
    OtherBus,
    /// Pixels leave.
    #[error("the ADV7511 sends")]
    Runs,
}

/// An ADV7511.
#[derive(Debug, Clone)]
pub struct Adv7511 {
    page: Page,
    low: LowHotPlug,
    /// What is at the other end: its EDID, and whether its hot plug is high.
    sink: Option<Edid>,
    hot_plug: bool,
    /// Steps of the bus for which it does not answer.
    deaf: u64,
    selected: Map,
    pointer: u8,
    has_pointer: bool,
    csc: Csc,
    line: Line,
}

/// Which of the chip's addresses was meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Map {
    Main,
    Edid,
    Packet,
}

/// Linux `adv7511_register_defaults`, those that are not 0.
const DEFAULTS: &[(u8, &[u8])] = &[
    (0x00, &[0x12]),
    (0x0a, &[0x01, 0x0e, 0xbc, 0x18, 0x01, 0x13, 0x25, 0x37]),
    (0x18, &[0x46, 0x62, 0x04, 0xa8, 0x00, 0x00, 0x1c, 0x84, 0x1c, 0xbf, 0x04, 0xa8, 0x1e, 0x70, 0x02, 0x1e]),
    (0x28, &[0x00, 0x00, 0x04, 0xa8, 0x08, 0x12, 0x1b, 0xac]),
    (0x3b, &[0x80]),
    (0x3f, &[0xb0, 0x00, 0x50, 0x90, 0x7e, 0x79, 0x70]),
    (0x49, &[0xa8, 0x80]),
    (0x52, &[0x02, 0x0d]),
    (0x70, &[0x01, 0x0a]),
    (0x94, &[0xc0]),
    (0x98, &[0x0b, 0x02, 0x00, 0x18, 0x5a, 0x60]),
    (0xa2, &[0x80, 0x80, 0x08, 0x04]),
    (0xab, &[0x40]),
    (0xae, &[0x40, 0x14]),
    (0xc9, &[0x03, 0x00, 0x00, 0x02, 0x00, 0x01, 0x04]),
    (0xd0, &[0x30, 0xff, 0x80, 0x80, 0x80]),
    (0xde, &[0x10, 0x01, 0x80, 0x75, 0x00, 0x00, 0x60]),
    (0xf5, &[0x75, 0x11]),
    (0xf9, &[0x7c]),
];

/// Registers whose value ADI fixes: Linux `adv7511_fixed_registers`; the second row are Avnet's, whose defaults are allowed too.
const RULES: &[Entry] = &[
    (0x98..=0x98, 0, Rule::Fixed(&[0x03])),
    (0x9a..=0x9a, 0, Rule::Fixed(&[0xe0])),
    (0x9c..=0x9c, 0, Rule::Fixed(&[0x30])),
    (0x9d..=0x9d, 0, Rule::Fixed(&[0x61])),
    (0xa2..=0xa3, 0, Rule::Fixed(&[0xa4])),
    (0xe0..=0xe0, 0, Rule::Fixed(&[0xd0])),
    (0xf9..=0xf9, 0, Rule::Fixed(&[0x00])),
    (0x99..=0x99, 0, Rule::Fixed(&[0x02])),
    (0xa5..=0xa5, 0, Rule::Fixed(&[0x04, 0x44])),
    (0xab..=0xab, 0, Rule::Fixed(&[0x40])),
    (0xd1..=0xd1, 0, Rule::Fixed(&[0xff])),
    (0xde..=0xde, 0, Rule::Fixed(&[0x10, 0x9c])),
    (0xe4..=0xe4, 0, Rule::Fixed(&[0x60])),
    (0xfa..=0xfa, 0, Rule::Fixed(&[0x00])),
    (0x00..=0x00, 0, Rule::ReadOnly),
    (0x42..=0x42, 0, Rule::ReadOnly),
    (0x9e..=0x9e, 0, Rule::ReadOnly),
    (0xc8..=0xc8, 0, Rule::ReadOnly),
    (0xf5..=0xf6, 0, Rule::ReadOnly),
];

/// Registers that must have a value other than their default.
const TO_BE_SET: &[(u8, u8)] = &[
    (0x98, 0x03),
    (0x9a, 0xe0),
    (0x9c, 0x30),
    (0x9d, 0x61),
    (0xa2, 0xa4),
    (0xa3, 0xa4),
    (0xe0, 0xd0),
    (0xf9, 0x00),
];

impl Adv7511 {
    /// A chip after power-up with nothing at its cable; it answers after N steps of the bus.
    #[must_use]
    pub fn new(deaf: u64, low: LowHotPlug) -> Self {
        let mut defaults = [0; 256];
        for (first, values) in DEFAULTS {
            defaults[usize::from(*first)..][..values.len()].copy_from_slice(values);
        }
        let page = Page::documented("ADV7511", defaults, RULES);
        let csc = Csc::of(&page);
        Self {
            page,
            low,
            sink: None,
            hot_plug: false,
            deaf,
            selected: Map::Main,
            pointer: 0,
            has_pointer: false,
            csc,
            line: Line::default(),
        }
    }

    /// A step of the bus passes.
    pub const fn step(&mut self) {
        self.deaf = self.deaf.saturating_sub(1);
    }

    /// What is at the other end of the cable, and the level of hot plug.
    pub fn see(&mut self, sink: Option<Edid>, hot_plug: bool) {
        if hot_plug != self.hot_plug {
            self.hot_plug = hot_plug;
            // Interrupts: bit 7 hot plug, bit 6 receiver sense (Linux `adv7511.h`).
            self.page.set(INTERRUPTS, self.page.get(INTERRUPTS) | 0xc0);
            if !hot_plug && !self.ignores_hot_plug() {
                self.page.reset(|register| KEPT.contains(&register) || register == INTERRUPTS);
                self.csc = Csc::of(&self.page);
            }
        }
        self.sink = sink;
    }

    /// D6 bits 7 and 6: both set is "hot plug is always high".
    const fn ignores_hot_plug(&self) -> bool {
        self.page.bits(POWER_2, 7, 6) == 3
    }

    const fn is_plugged(&self) -> bool {
        self.hot_plug || self.ignores_hot_plug()
    }

    /// Whether the ADV7511 is powered up: 41 bit 6.
    const fn is_powered(&self) -> bool {
        self.is_plugged() && !self.page.bit(0x41, 6)
    }

    /// The first thing that stops a picture.
    #[must_use]
    pub const fn state(&self) -> State {
        if !self.is_plugged() {
            State::NoHotPlug
        } else if !self.is_powered() {
            State::PoweredDown
        } else if !pixels::fits(&self.page) {
            State::OtherBus
        } else {
            State::Runs
        }
    }

    /// How it runs the link: AF bit 1, infoframe by 44 bit 4, 55 bits 6..5, quantisation by 57 bits 3..2.
    #[must_use]
    pub const fn link(&self) -> Link {
        let coding = match self.page.bits(0x55, 6, 5) {
            1 => Coding::Ycc422,
            2 => Coding::Ycc444,
            _ => Coding::Rgb,
        };
        let avi = Avi { coding, is_full: self.page.bits(0x57, 3, 2) == 2 };
        let avi = if self.page.bit(0x44, 4) { Some(avi) } else { None };
        Link { is_hdmi: self.page.bit(0xaf, 1), avi }
    }

    /// One clock of the pixel bus.
    pub fn pixel(&mut self, bus: Bus) -> Option<Event> {
        if self.state() != State::Runs {
            self.line = Line::default();
            return None;
        }
        self.line.pixel(&self.page, &self.csc, bus)
    }

    /// What a read over I2C gives.
    #[must_use]
    pub fn register(&self, register: u8) -> u8 {
        let bit = |place: u8, is_set: bool| u8::from(is_set) << place;
        match register {
            0x42 => 0x90 | bit(6, self.hot_plug) | bit(5, self.sink.is_some()),
            INTERRUPTS => self.page.get(INTERRUPTS) | bit(2, self.has_edid()),
            0x9e => bit(4, self.is_powered()),
            0xc8 => {
                if self.has_edid() {
                    2
                } else {
                    1
                }
            }
            _ => self.page.get(register),
        }
    }

    /// The chip reads the screen's EDID by itself once it is powered and hot plug is high.
    const fn has_edid(&self) -> bool {
        self.is_powered() && self.hot_plug && self.sink.is_some()
    }

    /// Writes against the rules since power-up, and fixed registers that do not have their value.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let unset = TO_BE_SET.iter().filter(|(register, value)| self.page.get(*register) != *value);
        let unset = unset.map(|(register, value)| {
            format!("ADV7511 {register:02X} is {:02X}, to be {value:02X}", self.page.get(*register))
        });
        self.page.complaints().iter().cloned().chain(unset).collect()
    }

    fn map_at(&self, address: u8) -> Option<Map> {
        match address {
            ADDRESS => Some(Map::Main),
            _ if self.page.get(0x43) >> 1 == address => Some(Map::Edid),
            _ if self.page.get(0x45) >> 1 == address => Some(Map::Packet),
            _ => None,
        }
    }

    fn write_register(&mut self, register: u8, value: u8) {
        let is_low = !self.is_plugged();
        if register == INTERRUPTS {
            // A 1 clears.
            self.page.set(INTERRUPTS, self.page.get(INTERRUPTS) & !value);
            return;
        }
        if is_low && self.low == LowHotPlug::HoldsDefaults && !KEPT.contains(&register) && register != POWER_2
        {
            return;
        }
        let value = if is_low && register == 0x41 { value | 0x40 } else { value };
        self.page.write(register, value);
        // 1A bit 5 holds coefficients back until it is cleared.
        if !self.page.bit(0x1a, 5) {
            self.csc = Csc::of(&self.page);
        }
    }
}

impl Target for Adv7511 {
    fn answers(&self, address: u8) -> bool {
        self.deaf == 0 && self.map_at(address).is_some()
    }

    fn addressed(&mut self, address: u8, _: bool) {
        if let Some(map) = self.map_at(address) {
            self.selected = map;
        }
        self.has_pointer = false;
    }

    fn write(&mut self, byte: u8) -> bool {
        if !self.has_pointer {
            (self.pointer, self.has_pointer) = (byte, true);
            return true;
        }
        if self.selected == Map::Main {
            self.write_register(self.pointer, byte);
        }
        self.pointer = self.pointer.wrapping_add(1);
        true
    }

    fn read(&mut self) -> u8 {
        let byte = match self.selected {
            Map::Main => self.register(self.pointer),
            Map::Edid => {
                self.sink.filter(|_| self.has_edid()).map_or(0, |edid| edid[usize::from(self.pointer)])
            }
            Map::Packet => 0,
        };
        self.pointer = self.pointer.wrapping_add(1);
        byte
    }
}
