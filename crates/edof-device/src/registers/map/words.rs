//! Addresses that programs use by name, the bits of their words, and words that protect themselves.

use crate::i2c::receiver::{clock_polarity, clock_tap};
use crate::input_timing;
use edof_core::display::DisplayMode;

/// `EDOF` in ASCII: what `id` reads.
pub const ID: u32 = u32::from_be_bytes(*b"EDOF");
/// Version of this map: major in the upper half, minor in the lower. A client of the same major version understands the board.
pub const VERSION: u32 = 0x0002_0005;

/// Address of `weights_hash`.
pub const WEIGHTS_HASH: u32 = 0x10;
/// Address of `control`.
pub const CONTROL: u32 = 0x14;
/// Address of `scratch`.
pub const SCRATCH: u32 = 0x18;
/// Address of `protection`.
pub const PROTECTION: u32 = 0x1c;
/// Address of `status`.
pub const STATUS: u32 = 0x20;
/// Address of `uart_broken`.
pub const UART_BROKEN: u32 = 0x90;
/// Address of `video_setup`.
pub const VIDEO_SETUP: u32 = 0xa0;
/// Address of `chip_access`.
pub const CHIP_ACCESS: u32 = 0xa4;
/// Address of `chip_answer`.
pub const CHIP_ANSWER: u32 = 0xa8;
/// Address of `input_codes`; `input_malformed` is the next word.
pub const INPUT_CODES: u32 = 0x98;
/// Address of `pattern`.
pub const PATTERN: u32 = 0xb0;
/// Address of `check_raw`; `check_windows`, `check_codes`, `check_sent` and `check_frames` are the next words.
pub const CHECK_RAW: u32 = 0xb4;
/// Address of `core_cycles`; `input_cycles` and `screen_cycles` are the next words.
pub const CORE_CYCLES: u32 = 0xc8;
/// Address of `frame_blocks`; `frame_check` is the next word.
pub const FRAME_BLOCKS: u32 = 0xd8;
/// Bit of `frame_blocks`: a block is on its way.
pub const FRAME_BUSY: u32 = 1 << 16;
/// Address of `picture_corner`.
pub const PICTURE_CORNER: u32 = 0xd4;
/// Bit of `picture_corner`: raw pixel words in place of codes.
pub const RAW_WORDS: u32 = 1 << 31;
/// Bit of `video_setup`: pixels are grey, two of them a word.
pub const GREY: u32 = 1 << 1;
/// Bit of `video_setup`: pixels are bytes of any kind.
pub const PLAIN: u32 = 1 << 2;
/// `video_setup` after reset: RGB to the screen, the receiver's output clock as `input_timing` has it.
pub const VIDEO_SETUP_RESET: u32 =
    u32::from_le_bytes([0, clock_tap(input_timing::FIRST_TAP), clock_polarity(false), 0]);
/// Address of `writes_refused`.
pub const WRITES_REFUSED: u32 = 0x94;

/// Bit of `control`: frames are reconstructed.
pub const RUN: u32 = 1;
/// Bit of `control`: display in colour.
pub const COLOUR: u32 = 1 << 1;
/// Bit of `control`: the set of weights.
pub const WEIGHT_SET: u32 = 1 << 2;
/// Bit of `control`: its rise sets up the video chips.
pub const I2C_RESTART: u32 = 1 << 3;
/// Bit of `control`: drops the frame in progress.
pub const FLUSH: u32 = 1 << 4;

/// Bit of `protection`: the bank in use takes no words.
pub const PROTECT_BANK: u32 = 1;
/// Bit of `protection`: `control` takes checked words alone.
pub const PROTECT_CONTROL: u32 = 1 << 1;
/// Bit of `protection`: with [`PROTECT_BANK`], the other bank takes no words either.
pub const PROTECT_OTHER: u32 = 1 << 2;

/// A word of 16 bits with its complement above it, as `protection` and, under protection, `control` want it: one that lost, doubled or
/// changed a byte on its way is none.
///
/// ```
/// use edof_device::registers::map::{checked, is_checked};
/// assert_eq!(checked(0x0007), 0xfff8_0007);
/// assert!(is_checked(checked(0x0007)) && !is_checked(0x0007) && !is_checked(checked(0x0007) << 8));
/// ```
#[must_use]
pub const fn checked(word: u32) -> u32 {
    (word & 0xffff) | !word << 16
}

/// Whether a word is as [`checked`] makes it.
#[must_use]
pub const fn is_checked(word: u32) -> bool {
    word == checked(word)
}

/// The word of `control` with which frames are reconstructed, shown in that mode, with that set of weights.
#[must_use]
pub fn running(mode: DisplayMode, set: usize) -> u32 {
    RUN | if mode == DisplayMode::Colour { COLOUR } else { 0 } | if set == 0 { 0 } else { WEIGHT_SET }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input_timing::{FIRST_TAP, TAPS, delay_ns, margins_ns};
    use crate::video::VideoTiming;

    /// Before any alignment the first setting is within what the pads need, and at 1080p60 the nearest to the middle.
    #[test]
    fn the_first_setting_of_the_receivers_clock_is_the_budgets() {
        let [_, tap, polarity, _] = VIDEO_SETUP_RESET.to_le_bytes();
        assert_eq!((tap, polarity), (0x80 | FIRST_TAP, 0xa0));
        for mode in VideoTiming::MODES {
            let period = 1e6 / mode.pixel_khz as f64;
            let tap = period / f64::from(TAPS);
            let off = (f64::from(FIRST_TAP) * tap - delay_ns()).abs();
            assert!(off < margins_ns(period)[0], "{mode:?}: {off}");
            assert!(mode != VideoTiming::P1080_60 || off <= tap / 2.0, "{off}");
        }
    }
}
