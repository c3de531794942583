//! The KC705's own bus: its multiplexer, and the ADV7511 that sends the picture (UG810; ADV7511 Programming Guide; Linux `adv7511_drv.c`).
//!
//! Slots: 0 register 0x42 (hot plug), 1 register 0x41 (power), 2 register 0x16 (format), 3 register 0xAF (HDMI or DVI): register
//! `transmitter` of the map. 4 whether a screen was plugged in at the last look, 5 what 0xAF shall be.

use super::program::{Action, Builder, Entry, Jump, SETTINGS, SLOTS};

/// Multiplexer of the bus; the ADV7511 is at channel 5.
const PCA9548A: u8 = 0x74;
/// HDMI transmitter.
const ADV7511: u8 = 0x39;
/// Where it shows the EDID of the screen.
const SCREEN_EDID: u8 = 0x3f;

const HOT_PLUG: u8 = 1 << 6;
const CHANGED: u8 = 1 << 7;
const EDID_READY: u8 = 1 << 2;
const WAS_PLUGGED: u8 = 4;
const MODE: u8 = 5;
const DVI: u8 = 0x04;
const HDMI: u8 = 0x06;
/// Milliseconds between two looks.
const LOOK_MS: u16 = 50;

const POWER: &[(u8, u8, &str)] = &[
    (0xd6, 0xc0, "hot plug counts as high, first of all: where it is low, registers fall to their defaults"),
    (0x41, 0x10, "power up; bit 4 as the guide wants it"),
];

const FIXED: &[(u8, u8, &str)] = &[
    (0x98, 0x03, "fixed, as the guide wants it"),
    (0x9a, 0xe0, "fixed"),
    (0x9c, 0x30, "fixed"),
    (0x9d, 0x61, "fixed; no division of the clock"),
    (0xa2, 0xa4, "fixed"),
    (0xa3, 0xa4, "fixed"),
    (0xe0, 0xd0, "fixed"),
    (0xf9, 0x00, "fixed: an address that nothing else has"),
    (0x43, 0x7e, "where the screen's EDID is shown"),
    (0x15, 0x01, "input: 16-bit 4:2:2 with separate syncs"),
    (0x48, 0x08, "input: right-justified, as the KC705 wires D8 to D23"),
    (0x17, 0x02, "16:9; syncs pass as they come"),
    (0xba, 0x60, "no delay of the input clock"),
];

/// Limited BT.709 Y'CbCr to full-range RGB: twelve coefficients from 0x18 on, the upper half first.
const TO_RGB: [u16; 12] = [
    0x0734, 0x04ad, 0x0000, 0x1c1b, //
    0x1ddc, 0x04ad, 0x1f24, 0x0135, //
    0x0000, 0x04ad, 0x087c, 0x1b77,
];
/// Above the first coefficient: on, coefficients up to 4.
const CSC_ON: u8 = 0xc0;
/// Above the second one: coefficients do not count before it falls.
const CSC_GUARD: u8 = 0x20;

/// Set-up, then a look every 50 ms: the table runs again when a screen is plugged in, or the chip has lost its power-up.
#[must_use]
pub fn program() -> Vec<Entry> {
    let mut p = Builder::default();
    p.add(Action::Wait(200), "the ADV7511 answers 200 ms after power-up");
    p.add(Action::Store { value: DVI, slot: MODE }, "DVI until a screen says that it takes HDMI");
    select(&mut p);
    let table = p.here();
    p.write(ADV7511, POWER);
    p.expect((ADV7511, 0x41), (0x40, 0x00), 10, "powered up");
    p.write(ADV7511, FIXED);
    format(&mut p);
    p.add(Action::Copy { device: ADV7511, register: 0xaf, slot: MODE }, "HDMI or DVI, no encryption");
    p.expect((ADV7511, 0x15), (0x0f, 0x01), 0, "the chip kept what was written");
    p.add(Action::Done, "pictures may be sent");

    let look = p.here();
    p.add(Action::Wait(LOOK_MS), "until the next look");
    select(&mut p);
    p.add(Action::Read { device: ADV7511, register: 0x16, slot: 2 }, "format of the output");
    p.add(Action::Read { device: ADV7511, register: 0xaf, slot: 3 }, "HDMI or DVI");
    p.add(Action::Read { device: ADV7511, register: 0x41, slot: 1 }, "power");
    p.goto_if(table, 0x40, 0x40, "the chip is powered down: its registers are lost");
    p.add(Action::Read { device: ADV7511, register: 0x96, slot: SLOTS }, "what has happened");
    let changed = p.jump_if(CHANGED, CHANGED, "a screen came or went");
    let unchanged = p.here();
    let edid = p.jump_if(EDID_READY, EDID_READY, "a screen's EDID was read");
    let known = p.here();
    p.add(Action::Read { device: ADV7511, register: 0x42, slot: 0 }, "hot plug");
    let plugged = p.jump_if(HOT_PLUG, HOT_PLUG, "a screen is plugged in");
    p.add(Action::Store { value: 0, slot: WAS_PLUGGED }, "no screen");
    p.add(Action::Store { value: DVI, slot: MODE }, "the next one may be another");
    p.goto(look, "until one comes");

    p.land(plugged);
    p.add(Action::Load(WAS_PLUGGED), "was it there before?");
    p.goto_if(look, 1, 1, "it was");
    p.add(Action::Store { value: 1, slot: WAS_PLUGGED }, "from now on");
    p.goto(table, "a screen has come: everything anew");

    p.land(changed);
    p.add(Action::Write { device: ADV7511, register: 0x96, value: CHANGED }, "noted");
    p.add(Action::Store { value: 0, slot: WAS_PLUGGED }, "a screen that is there has come anew");
    p.goto(unchanged, "and on");

    p.land(edid);
    let hdmi = scan(&mut p);
    p.add(Action::Store { value: DVI, slot: MODE }, "no HDMI vendor block: DVI");
    let told = p.jump("tell the chip");
    hdmi.into_iter().for_each(|jump| p.land(jump));
    p.add(Action::Store { value: HDMI, slot: MODE }, "the HDMI vendor block is there");
    p.land(told);
    p.add(Action::Copy { device: ADV7511, register: 0xaf, slot: MODE }, "HDMI or DVI, no encryption");
    p.goto(known, "and on");
    p.finish()
}

/// Channel 5, and no other: the clock synthesisers of channels 0 and 7 keep what they have.
fn select(p: &mut Builder) {
    p.add(Action::Byte { device: PCA9548A, value: 1 << 5 }, "channel 5 of the multiplexer: the ADV7511");
}

/// RGB, or 4:2:2 as it comes where the host asked for it.
fn format(p: &mut Builder) {
    p.add(Action::Load(SETTINGS), "what the host asked for");
    let as_it_comes = p.jump_if(1, 1, "4:2:2");
    p.write(
        ADV7511,
        &[
            (0x16, 0x38, "output 4:4:4, RGB; 8 bits a colour; input style 1: chroma on the upper byte, luma on the lower"),
            (0x1a, CSC_GUARD | high(TO_RGB[1]), "coefficients are about to change"),
        ],
    );
    for (index, coefficient) in TO_RGB.iter().enumerate() {
        let flags = [CSC_ON, CSC_GUARD].get(index).copied().unwrap_or(0);
        let register = 0x18 + 2 * index as u8;
        let [upper, lower] = [flags | high(*coefficient), *coefficient as u8];
        p.write(
            ADV7511,
            &[(register, upper, "limited BT.709 to RGB"), (register + 1, lower, "limited BT.709 to RGB")],
        );
    }
    p.write(
        ADV7511,
        &[
            (0x1a, high(TO_RGB[1]), "coefficients count"),
            (0x55, 0x00, "AVI infoframe: RGB"),
            (0x56, 0x28, "AVI infoframe: 16:9"),
            (0x57, 0x08, "AVI infoframe: full range"),
        ],
    );
    let done = p.jump("RGB is set up");
    p.land(as_it_comes);
    p.write(
        ADV7511,
        &[
            (0x16, 0xb9, "output 4:2:2 Y'CbCr; 8 bits a colour; input style 1: chroma on the upper byte, luma on the lower"),
            (0x18, 0x46, "no colour space conversion"),
            (0x55, 0x20, "AVI infoframe: Y'CbCr 4:2:2"),
            (0x56, 0xa8, "AVI infoframe: BT.709, 16:9"),
            (0x57, 0x00, "AVI infoframe: range as the format has it"),
        ],
    );
    p.land(done);
}

const fn high(coefficient: u16) -> u8 {
    (coefficient >> 8) as u8
}

/// Looks through the extension of the screen's EDID for 03 0C 00, the HDMI vendor block. The program continues after the last byte without the block; the jumps
/// are taken with it.
fn scan(p: &mut Builder) -> Vec<Jump> {
    let next = Action::ReadNext { device: SCREEN_EDID };
    p.add(Action::Write { device: ADV7511, register: 0x96, value: EDID_READY }, "noted");
    p.add(Action::Index(0x80), "the extension of the EDID");
    p.add(next, "its kind");
    p.add(Action::If { mask: 0xff, value: 0x02 }, "is it CEA-861?");
    let is_cea = p.jump("it is");
    let other = p.jump("it is not: DVI");
    p.land(is_cea);
    p.add(Action::Index(0x84), "the first data block");
    let search = p.here();
    let mut ends = vec![other];
    for (byte, doc) in [(0x03, "first byte of the identifier"), (0x0c, "second byte")] {
        p.add(next, doc);
        let found = p.jump_if(0xff, byte, doc);
        p.add(Action::More, "is there more?");
        p.goto(search, "from the begin");
        ends.push(p.jump("there is none: DVI"));
        p.land(found);
    }
    p.add(next, "third byte");
    let found = p.jump_if(0xff, 0x00, "HDMI");
    p.add(Action::More, "is there more?");
    p.goto(search, "from the begin");
    ends.into_iter().for_each(|jump| p.land(jump));
    vec![found]
}
