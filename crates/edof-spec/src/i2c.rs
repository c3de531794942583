//! How the video chips around the FPGA are set up: what is written to which register of which chip, and why.
//!
//! Values are those of the makers' programming guides and of public board code; nothing here was tried on a board. The words of a table are
//! the contents of a memory, 32 bits an entry: kind, device, register, value.

use std::fmt::Write;

/// One step of a set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What is done.
    pub action: Action,
    /// Why: the meaning of the register's value.
    pub doc: &'static str,
}

/// What a step does. Device addresses have 7 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Writes one byte to a device that has no registers.
    Byte {
        /// Its address.
        device: u8,
        /// The byte.
        value: u8,
    },
    /// Writes a register.
    Register {
        /// Address of the device.
        device: u8,
        /// Which register.
        register: u8,
        /// Its new value.
        value: u8,
    },
    /// Waits so many milliseconds.
    Wait(u8),
}

impl Action {
    /// The memory's word: kind (8 bits; 0 ends the table), device, register, value.
    #[must_use]
    pub const fn word(self) -> u32 {
        let (kind, device, register, value) = match self {
            Self::Byte { device, value } => (1, device, 0, value),
            Self::Register { device, register, value } => (2, device, register, value),
            Self::Wait(milliseconds) => (3, 0, 0, milliseconds),
        };
        u32::from_be_bytes([kind, device, register, value])
    }
}

/// Entries of a table's memory, its end included.
pub const TABLE_DEPTH: usize = 128;

/// The memory image of a table: a word and its meaning a line.
#[must_use]
pub fn image(table: &[Entry]) -> String {
    let mut text = String::new();
    for entry in table {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:08x} // {}", entry.action.word(), entry.doc);
    }
    (table.len()..TABLE_DEPTH).for_each(|_| text += "00000000\n");
    text
}

const fn wait(milliseconds: u8, doc: &'static str) -> Entry {
    Entry { action: Action::Wait(milliseconds), doc }
}

const fn set(device: u8, register: u8, value: u8, doc: &'static str) -> Entry {
    Entry { action: Action::Register { device, register, value }, doc }
}

/// Multiplexer of the KC705's bus.
const PCA9548A: u8 = 0x74;
/// HDMI transmitter.
const ADV7511: u8 = 0x39;
/// HDMI receiver: its input and output map, and the maps to which it gives addresses.
const ADV7611: u8 = 0x4c;
const ADV7611_CP: u8 = 0x22;
const ADV7611_DPLL: u8 = 0x26;
const ADV7611_KSV: u8 = 0x32;
const ADV7611_HDMI: u8 = 0x34;

/// The KC705's own bus: its multiplexer, and the ADV7511 that sends the picture (ADV7511 Programming Guide; UG810).
pub const KC705: &[Entry] = &[
    wait(200, "the ADV7511 answers 200 ms after power-up"),
    Entry {
        action: Action::Byte { device: PCA9548A, value: 1 << 5 },
        doc: "channel 5 of the multiplexer: the ADV7511",
    },
    set(ADV7511, 0x41, 0x10, "power up; bit 4 as the guide wants it"),
    set(ADV7511, 0x98, 0x03, "fixed, as the guide wants it"),
    set(ADV7511, 0x9a, 0xe0, "fixed: bits 7 to 5"),
    set(ADV7511, 0x9c, 0x30, "fixed: input clock gating"),
    set(ADV7511, 0x9d, 0x61, "fixed: bits 1 and 0; no division of the clock"),
    set(ADV7511, 0xa2, 0xa4, "fixed"),
    set(ADV7511, 0xa3, 0xa4, "fixed"),
    set(ADV7511, 0xe0, 0xd0, "fixed"),
    set(ADV7511, 0xf9, 0x00, "fixed: an address that nothing else has"),
    set(ADV7511, 0x15, 0x01, "input 1: 16-bit 4:2:2 with separate syncs"),
    set(
        ADV7511,
        0x16,
        0xbd,
        "output 4:2:2; 8 bits a colour; input style 3 (luma on the lower byte); colour space Y'CbCr",
    ),
    set(ADV7511, 0x48, 0x08, "input bits right-justified, as the KC705 wires them"),
    set(ADV7511, 0x17, 0x02, "16:9; syncs pass as they come"),
    set(ADV7511, 0x18, 0x46, "no colour space conversion"),
    set(ADV7511, 0x55, 0x20, "AVI infoframe: Y'CbCr 4:2:2"),
    set(ADV7511, 0x56, 0xa8, "AVI infoframe: BT.709, 16:9"),
    set(ADV7511, 0xaf, 0x06, "HDMI, no encryption"),
    set(ADV7511, 0xba, 0x60, "no delay of the input clock"),
    set(ADV7511, 0x0a, 0x00, "audio: none is sent, defaults"),
    set(ADV7511, 0xd6, 0xc0, "works without a hot-plug signal, too"),
];

/// The FMC-IMAGEON card's bus: the ADV7611 that takes the raw frames (ADV7611 Reference Manual, UG-180, and its recommended settings).
pub const IMAGEON: &[Entry] = &[
    set(ADV7611, 0xff, 0x80, "reset of the whole chip"),
    wait(10, "it answers 5 ms after reset"),
    set(ADV7611, 0xf4, 0x80, "address of the CEC map"),
    set(ADV7611, 0xf5, 0x7c, "address of the infoframe map"),
    set(ADV7611, 0xf8, 0x4c, "address of the DPLL map"),
    set(ADV7611, 0xf9, 0x64, "address of the repeater map"),
    set(ADV7611, 0xfa, 0x6c, "address of the EDID map"),
    set(ADV7611, 0xfb, 0x68, "address of the HDMI map"),
    set(ADV7611, 0xfd, 0x44, "address of the component processor's map"),
    set(ADV7611, 0x01, 0x06, "primary mode: HDMI component video"),
    set(ADV7611, 0x02, 0xf4, "colour space found by itself; output Y'CbCr, codes not saturated"),
    set(ADV7611, 0x03, 0x80, "output 16-bit 4:2:2, single data rate"),
    set(ADV7611, 0x04, 0x62, "luma on the upper byte, chroma on the lower"),
    set(ADV7611, 0x05, 0x28, "no codes inserted into the data; data enable on its pin"),
    set(ADV7611, 0x06, 0xa6, "syncs are positive"),
    set(ADV7611, 0x0b, 0x44, "power up: clocks"),
    set(ADV7611, 0x0c, 0x42, "power up: processor and pads"),
    set(ADV7611, 0x14, 0x7f, "pads of full strength: 148.5 MHz"),
    set(ADV7611, 0x15, 0x80, "pads drive"),
    set(ADV7611, 0x19, 0x83, "output clock by its DLL, phase 3"),
    set(ADV7611, 0x33, 0x40, "DLL into the path of the output clock"),
    set(ADV7611_CP, 0xba, 0x01, "free run where there is no signal, so that the clock goes on"),
    set(ADV7611_KSV, 0x40, 0x81, "no HDCP 1.1 features"),
    set(ADV7611_DPLL, 0xb5, 0x01, "audio clock, as the settings want it"),
    set(ADV7611_HDMI, 0xc0, 0x03, "settings"),
    set(ADV7611_HDMI, 0x00, 0x08, "port A"),
    set(ADV7611_HDMI, 0x02, 0x03, "no HDCP in the background"),
    set(ADV7611_HDMI, 0x03, 0x98, "settings: audio"),
    set(ADV7611_HDMI, 0x10, 0xa5, "settings: audio"),
    set(ADV7611_HDMI, 0x1b, 0x08, "settings: deep colour"),
    set(ADV7611_HDMI, 0x45, 0x04, "settings: audio"),
    set(ADV7611_HDMI, 0x97, 0xc0, "settings: audio"),
    set(ADV7611_HDMI, 0x3d, 0x10, "settings: equaliser"),
    set(ADV7611_HDMI, 0x3e, 0x69, "settings: equaliser"),
    set(ADV7611_HDMI, 0x3f, 0x46, "settings: equaliser"),
    set(ADV7611_HDMI, 0x4e, 0xfe, "settings: equaliser"),
    set(ADV7611_HDMI, 0x4f, 0x08, "settings: equaliser"),
    set(ADV7611_HDMI, 0x50, 0x00, "settings: equaliser"),
    set(ADV7611_HDMI, 0x57, 0xa3, "settings: equaliser"),
    set(ADV7611_HDMI, 0x58, 0x07, "settings: equaliser"),
    set(ADV7611_HDMI, 0x6f, 0x08, "settings: equaliser"),
    set(ADV7611_HDMI, 0x83, 0xfe, "terminators of port A"),
    set(ADV7611_HDMI, 0x84, 0x04, "settings: frequency range"),
    set(ADV7611_HDMI, 0x85, 0x10, "settings: equaliser"),
    set(ADV7611_HDMI, 0x86, 0x9b, "settings: equaliser"),
    set(ADV7611_HDMI, 0x89, 0x03, "settings: equaliser"),
    set(ADV7611_HDMI, 0x9b, 0x03, "settings: equaliser"),
    set(ADV7611, 0x20, 0xf8, "hot plug: the source may send"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_fit_their_memories_and_every_step_has_a_meaning() {
        for table in [KC705, IMAGEON] {
            assert!(table.len() < TABLE_DEPTH);
            assert!(table.iter().all(|entry| !entry.doc.is_empty() && entry.action.word() >> 24 != 0));
            let image = image(table);
            assert_eq!(image.lines().count(), TABLE_DEPTH);
            assert!(image.lines().all(|line| u32::from_str_radix(&line[..8], 16).is_ok()));
        }
        assert_eq!(Action::Register { device: 0x39, register: 0x41, value: 0x10 }.word(), 0x0239_4110);
    }
}
