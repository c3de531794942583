//! How the video chips are, in words: what each of them waits for, or that it works.

use crate::status::StatusSnapshot;
use edof_device::board::{Board, Source};
use edof_device::i2c::{Cause, Entry};
use edof_device::video::VideoTiming;
use serde::Serialize;

/// What is said of a chip.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Chip or bus: `receiver`, `transmitter`, `input`.
    pub about: &'static str,
    /// All is well.
    pub is_good: bool,
    /// Missing items, or how it is.
    pub text: String,
}

/// Names of the receiver's colour spaces, by code.
const COLOUR_SPACES: [&str; 9] = [
    "RGB, limited range",
    "RGB, full range",
    "Y'CbCr BT.601",
    "Y'CbCr BT.709",
    "xvYCC BT.601",
    "xvYCC BT.709",
    "Y'CbCr BT.601, full range",
    "Y'CbCr BT.709, full range",
    "another colour space",
];

/// All chips of a board with video, in the order in which a picture passes them; none of a board without.
#[must_use]
pub fn findings(board: &Board, look: &StatusSnapshot) -> Vec<Finding> {
    let Some(video) = &board.video_in else { return vec![] };
    let finding = |about, result: Result<String, String>| {
        let is_good = result.is_ok();
        Finding { about, is_good, text: result.unwrap_or_else(|missing| missing) }
    };
    let from_video = finding("input", input(look, &video.source));
    let mode = match video.source {
        Source::Cable { .. } => VideoTiming::P1080_60,
        Source::Camera { timing, .. } => timing,
    };
    let of_input = set_up(look, "i2c_card", &(video.setup.program)(mode, [0, 0]));
    if let Source::Camera { .. } = video.source {
        return vec![finding("camera", of_input.map(|()| "set up".into())), from_video];
    }
    let output = board.video_out.as_ref().and_then(|video| video.setup.as_ref());
    let of_output = output.map(|setup| set_up(look, "i2c_board", &(setup.program)(mode, [0, 0])));
    let receives = finding("receiver", of_input.and_then(|()| receiver(look)));
    let transmits = of_output.map(|done| finding("transmitter", done.and_then(|()| transmitter(look))));
    [receives, from_video].into_iter().chain(transmits).collect()
}

/// Whether the chips of a bus are set up.
fn set_up(look: &StatusSnapshot, register: &str, program: &[Entry]) -> Result<(), String> {
    let value = |field: &str| look.value(&format!("{register}.{field}"));
    if value("done") == 1 {
        return Ok(());
    }
    let (entry, device) = (value("entry"), value("device"));
    if value("failed") == 0 {
        return Err(format!("is being set up, entry {entry}"));
    }
    let step = program.get(entry as usize).map_or("", |entry| entry.doc);
    let cause = Cause::of_number(value("cause"));
    let told = cause.map_or_else(|| "fails".to_owned(), |cause| cause.to_string());
    let hint = match (cause, device) {
        (Some(Cause::DataLow | Cause::ClockLow), _) => {
            "a chip or a short holds the bus: switch power off and on"
        }
        (_, 0x70) => "is the FMC-IMAGEON seated in the LPC connector (J2), and VADJ on?",
        (_, 0x20) => "the card's expander: is its power good?",
        (_, 0x74) => "the board's own multiplexer: its reset must be high",
        (_, 0x21) => {
            "are the camera's wires in, and its 3.3 V? Without a camera put frames by 'edof board picture put'"
        }
        (_, 0x39) => "the board's transmitter: is its power good?",
        _ => "is the receiver out of reset, and its power good?",
    };
    Err(format!("set-up failed: chip 0x{device:02x} {told} at entry {entry} ({step}): {hint}"))
}

fn receiver(look: &StatusSnapshot) -> Result<String, String> {
    let is = |name: &str| look.value(name) == 1;
    let size = [look.value("receiver_size.width"), look.value("receiver_size.height")];
    let wanted = [look.value("frame_size.width"), look.value("frame_size.height")];
    let colour = look.value("receiver_format.colour_space") as usize;
    let [width, height] = size;
    let missing = if !is("receiver.cable") {
        "no source: no 5 V comes through its cable; without one put frames by 'edof board picture put'"
            .to_owned()
    } else if !is("receiver.clock") {
        "the source sends nothing: it sleeps, or does not take the mode of the EDID".to_owned()
    } else if !is("receiver.tmds_locked") {
        "not locked to the source's clock: cable, or more than 165 MHz".to_owned()
    } else if !is("receiver.vertical_locked") || !is("receiver.de_locked") {
        "locked to the source's clock, but no regular picture comes".to_owned()
    } else if is("receiver.interlaced") {
        "the source sends fields: it must send whole frames".to_owned()
    } else if size != wanted {
        format!("the source sends {width}x{height}, the design takes {}x{}", wanted[0], wanted[1])
    } else if is("receiver.hdcp") {
        "the source encrypts: switch HDCP off at the source".to_owned()
    } else if !is("receiver.hdmi") {
        "the source sends DVI, which is RGB: raw words need Y'CbCr 4:2:2 over HDMI".to_owned()
    } else if colour < 2 {
        format!("the source sends {}: raw words need Y'CbCr 4:2:2", COLOUR_SPACES[colour])
    } else if look.value("receiver.deep_colour") != 0 {
        "the source sends more than 8 bits a colour: switch deep colour off".to_owned()
    } else if is("receiver_format.free_run") {
        "the receiver sends a picture of its own, not the source's".to_owned()
    } else {
        return Ok(format!("{width}x{height}, {}", COLOUR_SPACES[colour.min(COLOUR_SPACES.len() - 1)]));
    };
    Err(missing)
}

/// From the pins of the receiver or of a camera to the core.
fn input(look: &StatusSnapshot, source: &Source) -> Result<String, String> {
    let is = |name: &str| look.value(name) == 1;
    let is_camera = matches!(source, Source::Camera { .. });
    if is_camera && !is("status.input_present") {
        Err("no frames: the camera's clock or its vertical sync does not come".into())
    } else if !is_camera && look.value("input_codes") == 0 {
        Err("no sync codes come from the receiver: its clock does not run, or 'edof board align' is needed"
            .into())
    } else if !is("status.input_present") {
        Err("no video: the sync codes make no frames".into())
    } else if !is("status.input_fits") {
        let [width, height] = ["input_size.width", "input_size.height"].map(|name| look.value(name));
        Err(format!("frames of {width}x{height}, not of the design's size"))
    } else {
        Ok("frames of the design's size".into())
    }
}

fn transmitter(look: &StatusSnapshot) -> Result<String, String> {
    let is = |name: &str| look.value(&format!("transmitter.{name}")) == 1;
    if is("powered_down") {
        Err("powered down: its set-up runs again".into())
    } else if !is("hot_plug") {
        Err("no screen: it is not plugged in, or off".into())
    } else {
        let link = if is("hdmi") { "HDMI" } else { "DVI" };
        let format = if is("output_422") { "Y'CbCr 4:2:2" } else { "RGB" };
        let sleeps = if is("monitor_sense") { "" } else { "; it sleeps" };
        Ok(format!("screen plugged in, {link}, {format}{sleeps}"))
    }
}
