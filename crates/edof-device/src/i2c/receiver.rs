//! The FMC-IMAGEON card's bus: its multiplexer, the expander that holds resets and hot plug, and the ADV7611 that takes the raw frames (Avnet's
//! `fmc_imageon.c`; UG-180; ADV7611 Register Settings Recommendations 1.5; Linux `adv7604.c`).
//!
//! The card's clock synthesiser (0x65), behind the expander's channel, is left alone. Slots 0 to 11 are the registers `receiver`,
//! `receiver_size` and `receiver_format` of the map.

use super::edid::{ADDRESS, PHYSICAL_ADDRESS, edid};
use super::program::{Action, Builder, Entry, SETTINGS, SLOTS};
use crate::video::VideoTiming;

/// Multiplexer of the bus.
const PCA9546A: u8 = 0x70;
/// Channels of it.
const CHANNEL_RECEIVER: u8 = 1 << 2;
const CHANNEL_EXPANDER: u8 = 1 << 3;
/// Expander: bit 0 lets the receiver out of reset, bit 2 is its hot plug.
const PCA9534: u8 = 0x20;
const OUT_OF_RESET: u8 = 0x01;
const HOT_PLUG: u8 = 0x04;
/// HDMI receiver: its input and output map, and the maps to which it gives addresses.
pub const IO: u8 = 0x4c;
/// Register of it: polarity of the output clock.
pub const CLOCK_POLARITY: u8 = 0x06;
/// Register of it: tap of the output clock's delay.
pub const CLOCK_TAP: u8 = 0x19;
const CP: u8 = 0x22;
const KSV: u8 = 0x32;
const HDMI: u8 = 0x34;
const EDID: u8 = 0x36;
/// Milliseconds between two looks.
const LOOK_MS: u16 = 50;
/// Register 0x0C of the input and output map once the chip is powered up.
const POWERED_UP: u8 = 0x42;

const MAPS: &[(u8, u8, &str)] = &[
    (0xf4, 0x80, "address of the CEC map"),
    (0xf5, 0x7c, "address of the infoframe map"),
    (0xf8, 0x4c, "address of the DPLL map"),
    (0xf9, KSV << 1, "address of the repeater map"),
    (0xfa, EDID << 1, "address of the EDID map"),
    (0xfb, HDMI << 1, "address of the HDMI map"),
    (0xfd, CP << 1, "address of the component processor's map"),
    (0x0b, 0x44, "power up: clocks"),
    (0x0c, POWERED_UP, "power up: processor and pads"),
];

const EDID_OFF: &[(u8, u8, &str)] = &[
    (0x77, 0x00, "no EDID while it is written"),
    (0x74, 0x00, "no EDID while it is written"),
    (0x40, 0x81, "no HDCP 1.1 features"),
];

const EDID_ON: &[(u8, u8, &str)] = &[
    (0x77, 0x00, "physical address in the first 256 bytes"),
    (0x52, ADDRESS[0], "physical address"),
    (0x53, ADDRESS[1], "physical address"),
    (0x70, PHYSICAL_ADDRESS, "where the EDID has it"),
    (0x74, 0x01, "the EDID answers at port A"),
];

const PICTURE: &[(u8, u8, &str)] = &[
    (
        0x02,
        0x35,
        "input Y'CbCr 709 of limited range whatever the infoframe says; output the same, not clipped",
    ),
    (0x03, 0x80, "output 16-bit 4:2:2, single data rate"),
    (0x04, 0x62, "luma on the upper byte, chroma on the lower"),
    (0x05, 0x2c, "codes of line start and end inserted into the data: the card has no pins for syncs"),
    (0x14, 0x7f, "pads of full strength: 148.5 MHz"),
    (0x15, 0x80, "pads drive"),
    (0x33, 0x40, "DLL into the path of the output clock"),
];

const PROCESSOR: &[(u8, u8, &str)] = &[
    (0x3e, 0x00, "no contrast and brightness: they multiply by 4095/4096"),
    (0x6c, 0x00, "no clamp"),
    (0x7b, 0x05, "data enable as the codes have it"),
    (0xba, 0x01, "free run where there is no clock, so that the pixel clock goes on"),
    (0xbd, 0x10, "4:2:2 passes the preprocessor by"),
];

/// The ADV7611's own recommendations, revision 1.5.
const RECOMMENDED: &[(u8, u8, &str)] = &[
    (0x9b, 0x03, "recommended"),
    (0x6f, 0x08, "recommended"),
    (0x85, 0x1f, "recommended"),
    (0x87, 0x70, "recommended"),
    (0x57, 0xda, "recommended"),
    (0x58, 0x01, "recommended"),
    (0x03, 0x98, "recommended"),
    (0x4c, 0x44, "recommended"),
    (0x8d, 0x04, "recommended: equaliser"),
    (0x8e, 0x1e, "recommended: equaliser"),
    (0x83, 0xfe, "terminators of port A"),
    (0x1a, 0x1a, "audio is muted"),
];

/// What is polled: device and register of each slot, and what they say.
const POLLED: [(u8, u8, &str); SLOTS as usize] = [
    (IO, 0x6a, "clock and locks"),
    (IO, 0x6f, "cable"),
    (HDMI, 0x05, "HDMI or DVI, encryption"),
    (HDMI, 0x0b, "interlaced, deep colour"),
    (HDMI, 0x08, "width"),
    (HDMI, 0x07, "width, locks"),
    (HDMI, 0x0a, "height"),
    (HDMI, 0x09, "height"),
    (HDMI, 0x53, "colour space"),
    (IO, 0x60, "infoframe"),
    (IO, 0x12, "component processor"),
    (CP, 0xff, "free run"),
];

/// Video standard and primary mode, "HDMI component" at a vertical frequency, in which the receiver runs free without a source (Linux
/// `adv7604.c`, `adv76xx_prim_mode_hdmi_comp`). With a source the rate is the signal's.
const fn free_run(mode: VideoTiming) -> [(u8, u8, &'static str); 2] {
    let (standard, frequency) = match mode {
        VideoTiming::P720_60 => (0x13, 0),
        VideoTiming::P1080_30 => (0x1e, 2),
        _ => (0x1e, 0),
    };
    [
        (0x00, standard, "video standard of the free run"),
        (0x01, frequency << 4 | 0x05, "primary mode: HDMI component; vertical frequency of the free run"),
    ]
}

/// What [`CLOCK_POLARITY`] holds.
#[must_use]
pub const fn clock_polarity(is_inverted: bool) -> u8 {
    if is_inverted { 0xa1 } else { 0xa0 }
}

/// What [`CLOCK_TAP`] holds: the delay is on.
#[must_use]
pub const fn clock_tap(tap: u8) -> u8 {
    0x80 | tap
}

/// Set-up for a video mode with the hot plug low, hot plug, then a look every 50 ms; from the begin where the chip has forgotten it.
#[must_use]
pub fn program(mode: VideoTiming) -> Vec<Entry> {
    let mut p = Builder::default();
    let start = p.here();
    p.add(Action::Byte { device: PCA9546A, value: CHANNEL_EXPANDER }, "channel of the expander");
    p.write(
        PCA9534,
        &[
            (0x03, 0xea, "bits 0, 2 and 4 are outputs"),
            (0x01, OUT_OF_RESET, "receiver out of reset, hot plug low"),
        ],
    );
    p.expect((PCA9534, 0x01), (0xff, OUT_OF_RESET), 0, "the expander kept it");
    p.add(Action::Wait(1000), "the receiver comes out of reset");
    p.add(Action::Byte { device: PCA9546A, value: CHANNEL_RECEIVER }, "channel of the receiver");
    p.write(IO, MAPS);
    p.add(Action::Wait(5), "the EDID's memory clears itself");
    p.write(KSV, EDID_OFF);
    let edid = edid(mode);
    for (register, value) in (0..=255).zip(edid) {
        p.add(Action::Write { device: EDID, register, value }, "EDID");
    }
    p.expect((EDID, 0x36), (0xff, edid[0x36]), 0, "the EDID's timing is there");
    p.write(KSV, EDID_ON);
    p.expect((KSV, 0x76), (0x01, 0x01), 100, "the EDID answers");
    p.write(IO, &free_run(mode));
    p.write(IO, PICTURE);
    p.add(Action::Copy { device: IO, register: CLOCK_TAP, slot: SETTINGS + 1 }, "tap of the output clock");
    p.add(
        Action::Copy { device: IO, register: CLOCK_POLARITY, slot: SETTINGS + 2 },
        "polarity of the output clock",
    );
    p.write(CP, PROCESSOR);
    p.write(HDMI, RECOMMENDED);
    p.expect((IO, 0x04), (0xff, 0x62), 0, "the chip kept what was written");
    p.add(Action::Wait(143), "before the hot plug, as the Linux driver has it");
    p.add(Action::Byte { device: PCA9546A, value: CHANNEL_EXPANDER }, "channel of the expander");
    p.write(PCA9534, &[(0x01, OUT_OF_RESET | HOT_PLUG, "hot plug: the source may read the EDID and send")]);
    p.expect((PCA9534, 0x01), (0xff, OUT_OF_RESET | HOT_PLUG), 0, "the expander kept it");
    p.add(Action::Byte { device: PCA9546A, value: CHANNEL_RECEIVER }, "channel of the receiver");
    p.add(Action::Done, "raw frames may come");

    let look = p.here();
    p.add(Action::Wait(LOOK_MS), "until the next look");
    p.add(Action::Byte { device: PCA9546A, value: CHANNEL_RECEIVER }, "channel of the receiver");
    p.add(Action::Read { device: IO, register: 0x0c, slot: SLOTS }, "is it powered up?");
    let alive = p.jump_if(0xff, POWERED_UP, "it is");
    p.goto(start, "it has forgotten its set-up");
    p.land(alive);
    for (slot, (device, register, doc)) in (0..).zip(POLLED) {
        p.add(Action::Read { device, register, slot }, doc);
    }
    p.goto(look, "again and again");
    p.finish()
}
