//! EDID of the receiver: 1080p60 alone, in Y'CbCr 4:2:2 and 4:4:4, over HDMI (EDID 1.3, CEA-861).

use crate::video::VideoTiming;

/// Where the physical address is, which an HDMI receiver patches for each of its ports.
pub const PHYSICAL_ADDRESS: u8 = 0x8a;
/// That address: 1.0.0.0, the first input of a screen.
pub const ADDRESS: [u8; 2] = [0x10, 0x00];

/// Both blocks.
#[must_use]
pub fn edid() -> [u8; 256] {
    let mut bytes = [0; 256];
    let (base, extension) = bytes.split_at_mut(128);
    put(base, 0x00, &[0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00]);
    // Maker "EDF", product 1, no serial number, 2026, EDID 1.3.
    put(base, 0x08, &[0x14, 0x86, 0x01, 0x00, 0, 0, 0, 0, 0, 36, 1, 3]);
    // Digital; no size; gamma 2.2; colour, the first timing is preferred; chromaticities of BT.709.
    put(base, 0x14, &[0x80, 0, 0, 120, 0x0a, 0xee, 0x91, 0xa3, 0x54, 0x4c, 0x99, 0x26, 0x0f, 0x50, 0x54]);
    // No established timing, no standard timing.
    put(base, 0x26, &[0x01; 16]);
    put(base, 0x36, &detailed(&VideoTiming::P1080_60));
    put(base, 0x48, b"\0\0\0\xfc\0edof raw in\n ");
    // 59 to 61 Hz, 67 to 68 kHz, at most 150 MHz.
    put(base, 0x5a, &[0, 0, 0, 0xfd, 0, 59, 61, 67, 68, 15, 0, 0x0a]);
    put(base, 0x66, &[0x20; 6]);
    put(base, 0x6c, &[0, 0, 0, 0x10]);
    base[0x7e] = 1;
    // CEA revision 3, the timings after the data blocks would be at 12; Y'CbCr 4:4:4 and 4:2:2, one native timing, no audio.
    put(extension, 0x00, &[0x02, 0x03, 12, 0x31]);
    // One video code: 16, 1080p60, native. The HDMI vendor block with its physical address.
    put(extension, 0x04, &[0x41, 0x80 | 16, 0x65, 0x03, 0x0c, 0x00, ADDRESS[0], ADDRESS[1]]);
    for block in [base, extension] {
        block[127] = block[..127].iter().fold(0u8, |sum, byte| sum.wrapping_sub(*byte));
    }
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

    /// Data blocks of a CEA extension: tag and payload.
    fn blocks(extension: &[u8]) -> Vec<(u8, &[u8])> {
        let (mut found, mut at) = (vec![], 4);
        while at < usize::from(extension[2]) {
            let length = usize::from(extension[at] & 31);
            found.push((extension[at] >> 5, &extension[at + 1..=at + length]));
            at += 1 + length;
        }
        assert_eq!(at, usize::from(extension[2]), "the blocks end where the timings begin");
        found
    }

    #[test]
    fn both_blocks_sum_to_zero_and_begin_as_they_must() {
        let edid = edid();
        for block in edid.chunks(128) {
            assert_eq!(block.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)), 0);
        }
        assert_eq!(&edid[..8], [0, 255, 255, 255, 255, 255, 255, 0]);
        let letters = u16::from_be_bytes([edid[8], edid[9]]);
        let name: Vec<u8> = [10, 5, 0].map(|shift| (letters >> shift & 31) as u8 + b'@').to_vec();
        assert_eq!(name, b"EDF");
        assert_eq!((edid[0x12], edid[0x13], edid[0x7e], edid[0x80]), (1, 3, 1, 2));
        assert!(edid[0x23..0x26].iter().all(|established| *established == 0));
        assert!(edid[0x26..0x36].iter().all(|standard| *standard == 1));
    }

    #[test]
    fn the_only_timing_is_1080p60() {
        let edid = edid();
        let d: Vec<usize> = edid[0x36..0x48].iter().map(|byte| usize::from(*byte)).collect();
        assert_eq!((d[0] | d[1] << 8) * 10, 148_500);
        let horizontal = (d[2] | (d[4] >> 4) << 8, d[3] | (d[4] & 15) << 8);
        let vertical = (d[5] | (d[7] >> 4) << 8, d[6] | (d[7] & 15) << 8);
        assert_eq!((horizontal, vertical), ((1920, 280), (1080, 45)));
        let fronts = (d[8] | (d[11] >> 6) << 8, d[10] >> 4 | (d[11] >> 2 & 3) << 4);
        let syncs = (d[9] | (d[11] >> 4 & 3) << 8, d[10] & 15 | (d[11] & 3) << 4);
        assert_eq!((fronts, syncs, d[17]), ((88, 4), (44, 5), 0x1e));
        // The other descriptors are no timings, nor is there one after the data blocks.
        assert!([0x48, 0x5a, 0x6c].iter().all(|at| edid[*at] == 0 && edid[at + 1] == 0));
        assert!(edid[0x80 + usize::from(edid[0x82])..0xff].iter().all(|byte| *byte == 0));
    }

    #[test]
    fn the_extension_declares_hdmi_ycbcr_and_one_video_code() {
        let edid = edid();
        let extension = &edid[128..];
        assert_eq!(extension[1], 3);
        assert_eq!(extension[3] & 0x70, 0x30, "no audio, Y'CbCr 4:4:4 and 4:2:2");
        let blocks = blocks(extension);
        assert_eq!(blocks[0], (2, &[0x80 | 16][..]));
        assert_eq!(blocks[1], (3, &[0x03, 0x0c, 0x00, 0x10, 0x00][..]));
        assert_eq!(blocks.len(), 2);
        let at = usize::from(PHYSICAL_ADDRESS);
        assert_eq!(edid[at..at + 2], ADDRESS);
        assert_eq!(edid[at - 3..at], [0x03, 0x0c, 0x00]);
    }
}
