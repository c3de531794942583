//! ADV7611: from a cable to words at pins.
//!
//! | step | module | gives |
//! |---|---|---|
//! | be set up | this one, [`maps`] | eight maps of registers behind I2C, the EDID's memory |
//! | find a signal | [`status`] | what stops it, and the registers that tell |
//! | convert | [`output`] | a line of a picture as words at the pins |
//! | be sampled | [`eye`] | what the FPGA makes of them |

pub mod eye;
pub mod maps;
pub mod output;
pub mod status;

use crate::chip_models::edid::{Edid, with_checksums};
use crate::chip_models::registers::Page;
use crate::chip_models::wire::Target;
use maps::{Map, RECOMMENDED};
pub use status::{Input, State};

/// The IO map's address, fixed by the chip (Linux `adv7604.c`: 0x98 in 8 bits).
const IO_ADDRESS: u8 = 0x4c;

/// An ADV7611.
#[derive(Debug, Clone)]
pub struct Adv7611 {
    pages: [Page; 8],
    is_reset: bool,
    /// Steps of the bus for which it does not answer, and for which its EDID memory is still to be cleared.
    deaf: [u64; 2],
    /// How long that takes after a reset.
    delays: [u64; 2],
    selected: Map,
    pointer: u8,
    has_pointer: bool,
    /// The cable: what comes through it, and for how long.
    input: Input,
    complaints: Vec<String>,
}

impl Adv7611 {
    /// A chip whose reset pin is low. After reset it is deaf for N steps, and clears its EDID memory after N.
    #[must_use]
    pub fn new(deaf: u64, clears: u64) -> Self {
        Self {
            pages: Map::ALL.map(Map::page),
            is_reset: true,
            deaf: [0; 2],
            delays: [deaf, clears],
            selected: Map::Io,
            pointer: 0,
            has_pointer: false,
            input: Input::default(),
            complaints: vec![],
        }
    }

    /// The level of the reset pin, which is active low.
    pub fn set_reset(&mut self, high: bool) {
        if self.is_reset && high {
            self.deaf = self.delays;
        }
        if !high && !self.is_reset {
            self.defaults();
        }
        self.is_reset = !high;
    }

    fn defaults(&mut self) {
        for page in &mut self.pages {
            page.reset(|_| false);
        }
        self.input.locked_frames = 0;
    }

    /// A step of the bus passes.
    pub fn step(&mut self) {
        if self.deaf == [0; 2] {
            return;
        }
        let clears = self.deaf[1] == 1;
        self.deaf = self.deaf.map(|left| left.saturating_sub(1));
        if clears {
            self.page_mut(Map::Edid).reset(|_| false);
        }
    }

    /// A page of registers.
    #[must_use]
    pub const fn page(&self, map: Map) -> &Page {
        &self.pages[map as usize]
    }

    const fn page_mut(&mut self, map: Map) -> &mut Page {
        &mut self.pages[map as usize]
    }

    /// Whether the ADV7611 is held in reset.
    #[must_use]
    pub const fn is_reset(&self) -> bool {
        self.is_reset
    }

    /// What a read over I2C gives.
    #[must_use]
    pub fn register(&self, map: Map, register: u8) -> u8 {
        match map {
            Map::Edid => self.edid()[usize::from(register)],
            _ => self.status(map, register).unwrap_or_else(|| self.page(map).get(register)),
        }
    }

    /// Writes against the rules since power-up, and recommended registers that do not have their value.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let written = self.pages.iter().flat_map(|page| page.complaints().iter().cloned());
        let unset = RECOMMENDED
            .iter()
            .filter(|(map, register, values)| !values.contains(&self.page(*map).get(*register)));
        let unset = unset.map(|(map, register, values)| {
            let value = self.page(*map).get(*register);
            format!("{map:?} {register:02X} is {value:02X}, recommended is {:02X}", values[0])
        });
        written.chain(self.complaints.iter().cloned()).chain(unset).collect()
    }

    /// The EDID memory, with both checksums computed by the chip once it is enabled (UG-237 page 38).
    fn edid(&self) -> Edid {
        let edid = std::array::from_fn(|place| self.page(Map::Edid).get(place as u8));
        if self.page(Map::Ksv).bit(0x74, 0) { with_checksums(edid) } else { edid }
    }

    /// What answers at 0x50 of the cable's I2C: the EDID memory, if it is enabled for port A (KSV 74 bit 0).
    #[must_use]
    pub fn ddc(&self) -> Option<Edid> {
        (!self.is_reset && self.page(Map::Ksv).bit(0x74, 0)).then(|| self.edid())
    }

    fn map_at(&self, address: u8) -> Option<Map> {
        let at = |map: &Map| match map.address_register() {
            None => address == IO_ADDRESS,
            Some(register) => self.page(Map::Io).get(register) >> 1 == address && address != 0,
        };
        Map::ALL.into_iter().find(at)
    }

    fn write_register(&mut self, register: u8, value: u8) {
        let map = self.selected;
        if map == Map::Edid && self.page(Map::Ksv).bits(0x74, 1, 0) != 0 {
            let complaint = "EDID written while sources may read it (KSV 74)".to_owned();
            if !self.complaints.contains(&complaint) {
                self.complaints.push(complaint);
            }
        }
        self.page_mut(map).write(register, value);
        // Main reset, as by the pin (UG-180: IO FF bit 7, self-clearing).
        if map == Map::Io && register == 0xff && value & 0x80 != 0 {
            self.defaults();
            self.deaf = self.delays;
        }
    }
}

impl Target for Adv7611 {
    fn is_alive(&self) -> bool {
        !self.is_reset
    }

    fn answers(&self, address: u8) -> bool {
        self.deaf[0] == 0 && self.map_at(address).is_some()
    }

    fn addressed(&mut self, address: u8, _: bool) {
        if let Some(map) = self.map_at(address) {
            self.selected = map;
        }
        self.has_pointer = false;
    }

    fn write(&mut self, byte: u8) -> bool {
        if self.has_pointer {
            self.write_register(self.pointer, byte);
            self.pointer = self.pointer.wrapping_add(1);
        } else {
            (self.pointer, self.has_pointer) = (byte, true);
        }
        true
    }

    fn read(&mut self) -> u8 {
        let byte = self.register(self.selected, self.pointer);
        self.pointer = self.pointer.wrapping_add(1);
        byte
    }
}
