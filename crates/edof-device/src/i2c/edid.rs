//! EDID of the receiver: the design's video mode, in Y'CbCr 4:2:2 and 4:4:4, over HDMI (EDID 1.3, CEA-861), and 640×480 beside it, which both
//! standards require of every sink. Its oracle is `edid-decode`.

use crate::video::VideoTiming;

/// Place of the physical address, which an HDMI receiver patches for each of its ports.
pub const PHYSICAL_ADDRESS: u8 = 0x8e;
/// That address: 1.0.0.0, the first input of a screen.
pub const ADDRESS: [u8; 2] = [0x10, 0x00];
/// Code of 640×480 at 60 Hz, and its rates: lines of 31.5 kHz, frames of 59.94 Hz.
const VGA: u8 = 1;
const VGA_RATES: [f64; 2] = [31.469, 59.94];

/// Both blocks, for a mode.
#[must_use]
pub fn edid(mode: VideoTiming) -> [u8; 256] {
    let mut bytes = [0; 256];
    let (base, extension) = bytes.split_at_mut(128);
    put(base, 0x00, &[0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00]);
    // Maker "EDF", product 1, no serial number, 2026, EDID 1.3.
    put(base, 0x08, &[0x14, 0x86, 0x01, 0x00, 0, 0, 0, 0, 0, 36, 1, 3]);
    // Digital; no size; gamma 2.2; colour, sRGB, the first timing is preferred; its chromaticities.
    put(base, 0x14, &[0x80, 0, 0, 120, 0x0e, 0xee, 0x91, 0xa3, 0x54, 0x4c, 0x99, 0x26, 0x0f, 0x50, 0x54]);
    // Established timing 640×480 at 60 Hz, no standard timing.
    put(base, 0x23, &[0x20, 0, 0]);
    put(base, 0x26, &[0x01; 16]);
    put(base, 0x36, &detailed(&mode));
    put(base, 0x48, b"\0\0\0\xfc\0edof raw in\n ");
    put(base, 0x5a, &limits(&mode));
    put(base, 0x6c, &[0, 0, 0, 0x10]);
    base[0x7e] = 1;
    // CEA revision 3, the timings after the data blocks would be at 16; no overscan, Y'CbCr 4:4:4 and 4:2:2, the one native timing is the
    // detailed one, no audio.
    put(extension, 0x00, &[0x02, 0x03, 16, 0xb1]);
    put(extension, 0x04, &[0x42, mode.code().unwrap_or_default(), VGA]);
    // Video capabilities: the range of RGB may be selected, no mode is overscanned.
    put(extension, 0x07, &[0xe2, 0x00, 0x4a]);
    // The HDMI vendor block with its physical address.
    put(extension, 0x0a, &[0x65, 0x03, 0x0c, 0x00, ADDRESS[0], ADDRESS[1]]);
    for block in [base, extension] {
        block[127] = block[..127].iter().fold(0u8, |sum, byte| sum.wrapping_sub(*byte));
    }
    bytes
}

/// The descriptor of range limits: rates of the mode and of 640×480, the pixel clock in steps of 10 MHz.
fn limits(mode: &VideoTiming) -> [u8; 18] {
    let rates = [mode.pixel_khz as f64 / mode.line.total() as f64, mode.frames_per_second()];
    let [lines, frames] = [0, 1].map(|i| [rates[i].min(VGA_RATES[i]), rates[i].max(VGA_RATES[i])]);
    let [low, high] = [0, 1].map(|i| [frames[i], lines[i]]);
    let [[frames_from, lines_from], [frames_to, lines_to]] = [low.map(f64::floor), high.map(f64::ceil)];
    let mut bytes = [0x20; 18];
    bytes[..5].copy_from_slice(&[0, 0, 0, 0xfd, 0]);
    bytes[5..9].copy_from_slice(&[frames_from, frames_to, lines_from, lines_to].map(|rate| rate as u8));
    bytes[9..12].copy_from_slice(&[mode.pixel_khz.div_ceil(10_000) as u8, 0, 0x0a]);
    bytes
}

fn put(block: &mut [u8], at: usize, bytes: &[u8]) {
    block[at..at + bytes.len()].copy_from_slice(bytes);
}

/// A timing in the 18 bytes of a detailed timing descriptor: both syncs separate and positive.
fn detailed(timing: &VideoTiming) -> [u8; 18] {
    let clock = (timing.pixel_khz / 10) as u16;
    let [h, v] = [timing.line, timing.frame];
    let [h_blank, v_blank] = [h, v].map(|part| part.total() - part.active);
    let low = |value: usize| value as u8;
    let highs = |one: usize, other: usize| ((one >> 8) << 4 | other >> 8) as u8;
    let [clock_low, clock_high] = clock.to_le_bytes();
    [
        clock_low,
        clock_high,
        low(h.active),
        low(h_blank),
        highs(h.active, h_blank),
        low(v.active),
        low(v_blank),
        highs(v.active, v_blank),
        low(h.front),
        low(h.sync),
        low((v.front & 15) << 4 | v.sync & 15),
        low((h.front >> 8) << 6 | (h.sync >> 8) << 4 | (v.front >> 4) << 2 | v.sync >> 4),
        0,
        0,
        0,
        0,
        0,
        0x1e,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The receiver patches the address of its port into the HDMI vendor block; `edid-decode` reads all else.
    #[test]
    fn the_physical_address_is_in_the_hdmi_vendor_block() {
        for mode in VideoTiming::MODES {
            let (edid, at) = (edid(mode), usize::from(PHYSICAL_ADDRESS));
            assert_eq!((&edid[at - 3..at], &edid[at..at + 2]), (&[0x03, 0x0c, 0x00][..], &ADDRESS[..]));
        }
    }
}
