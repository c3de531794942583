//! Windows of the board: addresses of many words each.

use crate::design::memory::ADDRESS_BITS;
use crate::registers::{Access, Window};
use edof_core::display::LUMA_ENTRIES;

/// Counters of the calculator's stages.
pub const STAGE_COUNTERS: Window = Window {
    name: "stage_counters",
    address: 0x100,
    bytes: 0x100,
    access: Access::Status,
    doc: "Word 4·stage + counter. Counters: 0 non-zero words sent, 1 saturated results, 2 saturated codes, 3 saturated differences; of stage \
          15, which is the whole calculator, 0 windows that were too short, 1 too long. A write to register 0 of stage 15 (`weights`) copies all counters to this window and restarts them.",
};

/// What the calculator's stages read back.
pub const STAGE_READS: Window = Window {
    name: "stage_reads",
    address: 0x200,
    bytes: 0x100,
    access: Access::Status,
    doc: "Word 4·stage + part; stage 14 is the display's tables. Parts: 0 CRC-32 of the rows that were read, 1 and 2 low and high half of the \
          last one, 3 whether the stage still reads. A command written to register 3 of the stage (`weights`) starts a read: space (2 bits), \
          bank (6), first row (12), rows after it (12).",
};

/// Tables of the display step.
pub const DISPLAY_TABLES: Window = Window {
    name: "display_tables",
    address: 0x10_0000,
    bytes: 4 * 4 * LUMA_ENTRIES as u32,
    access: Access::WriteOnly,
    doc: "Word 32768·table + entry. Tables: 0 luma (8-bit codes), 1 red, 2 green, 3 blue (12-bit encoded light, 16384 entries).",
};

/// The tile of raw pixels that the pattern repeats.
pub const TILE_PIXELS: Window = Window {
    name: "tile",
    address: 0x1_0000,
    bytes: 4 * crate::pattern::TILE_PIXELS as u32,
    access: Access::WriteOnly,
    doc: "Word 64·row + column: the raw pixel word (16 bits) of the tile that pattern 7 repeats over the frame.",
};

/// A square of the codes of every picture.
pub const PICTURE_PIXELS: Window = Window {
    name: "picture",
    address: 0x1_4000,
    bytes: 4 * crate::pattern::TILE_PIXELS as u32,
    access: Access::Status,
    doc: "Word 64·row + column: codes of a pixel, Y' low, Cb' or Cr' high, of the last picture that passed, counted from `picture_corner`. With `picture_corner.raw`: raw pixel words of the last raw frame.",
};

/// A block of the host's raw frame.
pub const FRAME: Window = Window {
    name: "frame",
    address: 0x1_8000,
    bytes: 0x4000,
    access: Access::WriteOnly,
    doc: "Words 0 to 2047: a block of lines, two raw pixel words each, the left one in the lower half. Word 2048: the block's check; if it is \
          right, the block becomes the next lines of the frame (`pattern.host`), else it is ignored. Word 2049 restarts the frame.",
};

/// Weights, thresholds and shifts of all stages.
pub const WEIGHTS: Window = Window {
    name: "weights",
    address: 0x0800_0000,
    bytes: 4 << (ADDRESS_BITS[0] + ADDRESS_BITS[1] + ADDRESS_BITS[2] + ADDRESS_BITS[3] + ADDRESS_BITS[4]),
    access: Access::WriteOnly,
    doc: "Word {stage (4 bits), space (2), bank (6), row (12), half (1)}. Spaces: 0 weights, 1 thresholds, 2 thresholds of the stage \
          before, 3 registers (0 and 1 shifts of each set, 2 control, 3 command to read back; read only: 4 CRC-32 of the stage's output of the last whole frame when the counters were last copied, 5 that frame's number modulo 256).",
};

/// Every window, by address.
pub const WINDOWS: &[Window] =
    &[STAGE_COUNTERS, STAGE_READS, TILE_PIXELS, PICTURE_PIXELS, FRAME, DISPLAY_TABLES, WEIGHTS];
