//! The registers and windows of the board; their addresses, bits and checked words by name are in `words.rs`, the windows in `windows.rs`.

mod windows;
mod words;

pub use windows::*;
pub use words::*;

use super::{Access, Field, Register};

const fn constant(
    name: &'static str,
    address: u32,
    reset: u32,
    fields: &'static [Field],
    doc: &'static str,
) -> Register {
    Register { name, address, access: Access::Constant, reset, doc, fields }
}

const fn status(name: &'static str, address: u32, fields: &'static [Field], doc: &'static str) -> Register {
    Register { name, address, access: Access::Status, reset: 0, doc, fields }
}

const fn control(
    name: &'static str,
    address: u32,
    reset: u32,
    fields: &'static [Field],
    doc: &'static str,
) -> Register {
    Register { name, address, access: Access::Control, reset, doc, fields }
}

const fn count(name: &'static str, address: u32, doc: &'static str) -> Register {
    status(name, address, &[], doc)
}

const fn bit(name: &'static str, low: u32, doc: &'static str) -> Field {
    Field { name, low, bits: 1, doc }
}

const fn half(name: &'static str, low: u32, doc: &'static str) -> Field {
    Field { name, low, bits: 16, doc }
}

const CAUSES: &str = "0 none, 1 not acknowledged, 2 arbitration lost, 3 data line held low, 4 clock line held low, 5 read back \
                      another value.";

/// How the set-up of a bus stands.
const SET_UP: [Field; 6] = [
    Field { name: "entry", low: 0, bits: 10, doc: "Entry of the table that is in progress, or that failed." },
    Field { name: "device", low: 10, bits: 7, doc: "7-bit address of that entry's chip." },
    Field { name: "cause", low: 17, bits: 3, doc: CAUSES },
    bit("done", 20, "The chips are set up, and polled."),
    bit("failed", 21, "The last set-up failed; it is tried again every second."),
    Field { name: "retries", low: 22, bits: 10, doc: "Attempts that were repeated since reset." },
];

/// Every register, by address. Counters wrap; they start from zero
/// at reset.
pub const REGISTERS: &[Register] = &[
    constant("id", 0x00, ID, &[], "`EDOF` in ASCII: identifies the board to a client."),
    constant(
        "version",
        0x04,
        VERSION,
        &[],
        "Version of this map: major in the upper half, minor in the lower.",
    ),
    constant(
        "design_hash",
        0x08,
        0,
        &[],
        "First 32 bits of the SHA-256 of the design's JSON (`identity::design_hash`).",
    ),
    constant(
        "frame_size",
        0x0c,
        0,
        &[half("width", 0, "Columns."), half("height", 16, "Rows.")],
        "Size of the design's picture.",
    ),
    control(
        "weights_hash",
        WEIGHTS_HASH,
        0,
        &[],
        "First 32 bits of the hash of the network in use (`identity::weights_hash`). Starts with the network that the design was generated with. A client that loads another network writes its hash here. A reset preserves it.",
    ),
    control(
        "control",
        CONTROL,
        0b11,
        &[
            bit("run", 0, "Frames are reconstructed. Off: the last picture is repeated."),
            bit("colour", 1, "Display in colour; off: luma only."),
            bit(
                "weight_set",
                2,
                "The set of weights for the next frames: the bank in use. A reset preserves it.",
            ),
            bit("i2c_restart", 3, "A change from 0 to 1 repeats the set-up of the video chips."),
            bit(
                "flush",
                4,
                "Drops the frame in progress and preserves all written words; hold for 48 cycles or more. Pictures resume with the next frame.",
            ),
        ],
        "Settings of the host.",
    ),
    control("scratch", SCRATCH, 0, &[], "Keeps the written word, for tests of the link; a reset clears it."),
    control(
        "protection",
        PROTECTION,
        PROTECT_BANK,
        &[
            bit(
                "bank",
                0,
                "Words for the bank in use, and for the display's tables while frames are reconstructed, are rejected.",
            ),
            bit(
                "control",
                1,
                "`control`, too, accepts only words whose upper half is the complement of the lower one.",
            ),
            bit(
                "other",
                2,
                "With `bank`, words for the other bank are rejected, too: what is checked before it is used stays as it was checked.",
            ),
        ],
        "Protection against stray words. The register accepts only words whose upper half is the complement of the lower one.",
    ),
    status(
        "status",
        STATUS,
        &[
            bit("dram_ready", 0, "The memory is ready: it is out of its reset."),
            bit("input_present", 1, "A video signal is present."),
            bit("input_fits", 2, "The video signal has the size of the design's frame."),
            bit("output_runs", 3, "Pictures leave the board; before the first one they are black."),
            bit("i2c_done", 4, "All video chips are set up."),
            bit("i2c_failed", 5, "A set-up failed: see `i2c_board`, `i2c_card`."),
            bit("weight_set", 6, "The set of weights of the last patch."),
            bit(
                "window_fault",
                7,
                "A window was too short or too long since the stages' counters were last copied.",
            ),
            bit(
                "calculator_runs",
                8,
                "The calculator's clock runs. Without it words of `stage_counters`, `stage_reads`, `display_tables` and `weights` are answered with an error.",
            ),
            bit(
                "weights_unchecked",
                9,
                "The calculator's clock was lost since `weights_hash` was last written: CRCs must show whether the weights are still there.",
            ),
        ],
        "State of the board.",
    ),
    status("i2c_board", 0x24, &SET_UP, "Set-up of the chips on the board's own I2C bus: the transmitter."),
    status(
        "input_size",
        0x28,
        &[half("width", 0, "Pixels of a line."), half("height", 16, "Lines of a frame.")],
        "The size of the incoming picture, as measured.",
    ),
    status("i2c_card", 0x2c, &SET_UP, "Set-up of the chips on the video card's I2C bus: the receiver."),
    status(
        "receiver",
        0x30,
        &[
            bit("de_locked", 0, "Active lines are regular. Bits 7 to 0 are IO 0x6A."),
            bit("vertical_locked", 1, "Frames are regular."),
            bit("clock", 4, "The source's clock is there."),
            bit("tmds_locked", 6, "The PLL is locked to the source's clock."),
            bit("cable", 8, "The source supplies 5 V through the cable. Bits 15 to 8 are IO 0x6F."),
            bit("hdcp", 22, "The source encrypts. Bits 23 to 16 are HDMI 0x05."),
            bit("hdmi", 23, "The source sends HDMI; 0 is DVI."),
            bit("interlaced", 29, "The source sends fields, not frames. Bits 31 to 24 are HDMI 0x0B."),
            Field {
                name: "deep_colour",
                low: 30,
                bits: 2,
                doc: "0 is 8 bits per colour, 1 to 3 are 10, 12, 16.",
            },
        ],
        "The receiver's inputs, as last polled; 0 until the receiver is set up.",
    ),
    status(
        "receiver_size",
        0x34,
        &[
            Field {
                name: "width",
                low: 0,
                bits: 13,
                doc: "Active pixels per line. Bits 15 to 0 are HDMI 0x07, 0x08.",
            },
            bit("de_locked", 13, "The width is valid."),
            bit("vertical_locked", 15, "The height is valid."),
            Field {
                name: "height",
                low: 16,
                bits: 13,
                doc: "Active lines per frame. Bits 31 to 16 are HDMI 0x09, 0x0A.",
            },
        ],
        "The picture's size as the receiver measures it on the cable.",
    ),
    status(
        "receiver_format",
        0x38,
        &[
            Field {
                name: "colour_space",
                low: 0,
                bits: 4,
                doc: "Colour space of the source, as the receiver's code. HDMI 0x53.",
            },
            bit("infoframe", 8, "The source sent an AVI infoframe. Bits 15 to 8 are IO 0x60."),
            bit("unlocked", 16, "The component processor is not locked. Bits 23 to 16 are IO 0x12."),
            bit("free_run", 28, "The receiver sends a picture of its own. Bits 31 to 24 are CP 0xFF."),
        ],
        "Format of the source's signal, as the receiver detects it.",
    ),
    status(
        "transmitter",
        0x3c,
        &[
            bit("monitor_sense", 5, "The screen's terminators are detected. Bits 7 to 0 are ADV7511 0x42."),
            bit("hot_plug", 6, "A screen is plugged in."),
            bit("powered_down", 14, "The transmitter is powered down. Bits 15 to 8 are ADV7511 0x41."),
            bit("output_422", 23, "Y'CbCr 4:2:2 to the screen; 0 is RGB. Bits 23 to 16 are ADV7511 0x16."),
            bit("hdmi", 25, "HDMI to the screen; 0 is DVI. Bits 31 to 24 are ADV7511 0xAF."),
        ],
        "The transmitter, as last polled; 0 until it is set up.",
    ),
    count("input_frames", 0x40, "Raw frames that were written whole."),
    count(
        "input_broken",
        0x44,
        "Raw frames that were begun and not completed: cable, wrong size or range, or a write that failed.",
    ),
    count("input_wrong", 0x48, "Frames on the cable that had another size than the design's."),
    count("input_overruns", 0x4c, "Frames on the cable that were dropped because the input FIFO was full."),
    count("input_write_errors", 0x50, "Bursts of raw frames that the memory answered with an error."),
    count("raw_frames", 0x54, "Raw frames whose reading was begun."),
    count(
        "raw_late",
        0x58,
        "Reads counted in `raw_frames` that repeat a frame because no newer one was complete.",
    ),
    count("raw_read_errors", 0x5c, "Words of raw frames that came with an error."),
    count(
        "busy_cycles",
        0x60,
        "Cycles of the calculator's clock with a window at its input or a patch at its output.",
    ),
    count("patches", 0x64, "Patches that left the calculator."),
    count("saturated_sums", 0x68, "Sums of overlapping patches that did not fit 16 bits."),
    count("clamped_chroma", 0x6c, "Chroma codes that were clamped (luma only)."),
    count("out_of_gamut", 0x70, "Pixels with less than no or more than full light of a colour (colour)."),
    count("picture_frames", 0x74, "Pictures that were written whole."),
    count(
        "picture_broken",
        0x78,
        "Pictures that were begun and not completed, or held back after raw words that came with an error.",
    ),
    count("picture_write_errors", 0x7c, "Bursts of pictures that the memory answered with an error."),
    count("output_frames", 0x80, "Pictures whose reading was begun."),
    count(
        "output_late",
        0x84,
        "Reads counted in `output_frames` that repeat a picture because no newer one was complete.",
    ),
    count("output_read_errors", 0x88, "Words of pictures that came with an error."),
    count("output_underruns", 0x8c, "Pictures on the cable whose pixels came late."),
    count(
        "uart_broken",
        UART_BROKEN,
        "Frames on the UART that were dropped, and bytes that were not a command.",
    ),
    count("writes_refused", WRITES_REFUSED, "Words that `protection` rejected."),
    count("input_codes", INPUT_CODES, "Codes of line start and end inside of the pixels."),
    count(
        "input_malformed",
        0x9c,
        "Damaged sync codes: a wrong word, a code on one of the two bytes only, or a code out of order.",
    ),
    control(
        "video_setup",
        VIDEO_SETUP,
        VIDEO_SETUP_RESET,
        &[
            bit("screen_422", 0, "Y'CbCr 4:2:2 to the screen in place of RGB."),
            bit(
                "grey",
                1,
                "Raw frames come in grey from a PC's graphics card, two pixels per word and two frames of video per raw frame (docs/contract.md, 1.4). Takes effect at once.",
            ),
            bit(
                "plain",
                2,
                "Every pixel is the raw word 256·Y + C of its bytes, whatever they are: for `edof board calibrate`, with `grey` 0. Takes effect at once.",
            ),
            Field {
                name: "receiver_tap",
                low: 8,
                bits: 8,
                doc: "Receiver's IO 0x19: 0x80 + tap (0 to 31) of its output clock's delay.",
            },
            Field {
                name: "receiver_polarity",
                low: 16,
                bits: 8,
                doc: "Receiver's IO 0x06: 0xA0, or 0xA1 with its output clock inverted.",
            },
        ],
        "Settings for the next set-up of the video chips (`control.i2c_restart` starts one), and of the input.",
    ),
    control(
        "chip_access",
        CHIP_ACCESS,
        0,
        &[
            Field { name: "value", low: 0, bits: 8, doc: "Byte to write." },
            Field { name: "register", low: 8, bits: 8, doc: "Register of the chip." },
            Field { name: "device", low: 16, bits: 7, doc: "7-bit address of the chip." },
            bit("read", 23, "Read; 0 writes."),
            bit("bare", 24, "The chip has no registers: a multiplexer."),
            bit("card", 25, "On the video card's bus; 0 is the board's own."),
            Field {
                name: "sequence",
                low: 28,
                bits: 4,
                doc: "A number other than the last starts the access.",
            },
        ],
        "Reads or writes one register of a chip, between two steps of its bus's set-up. A multiplexer stays as the set-up left it.",
    ),
    status(
        "chip_answer",
        CHIP_ANSWER,
        &[
            Field { name: "value", low: 0, bits: 8, doc: "Byte that was read." },
            Field { name: "cause", low: 8, bits: 3, doc: CAUSES },
            Field { name: "sequence", low: 28, bits: 4, doc: "`sequence` of the answered access." },
        ],
        "The answer to `chip_access`.",
    ),
    count(
        "input_range",
        0xac,
        "Frames on the cable with a code outside of 64…191, which carries no raw pixel word; such frames are dropped.",
    ),
    control(
        "pattern",
        PATTERN,
        0,
        &[
            Field {
                name: "kind",
                low: 0,
                bits: 3,
                doc: "0 none, 1 ramp, 2 chart, 3 noise, 4 zeros, 5 ones, 6 alternating, 7 the tile (`tile`).",
            },
            bit(
                "host",
                3,
                "The frame that the host wrote (`frame`), whatever `kind` is. Until it is whole, the last frame before it is repeated.",
            ),
        ],
        "Raw frames that the board makes in place of the source's frames, which are dropped meanwhile (docs/contract.md, 1.3).",
    ),
    status(
        "check_raw",
        CHECK_RAW,
        &[],
        "CRC-32 of the last whole raw frame that the calculator had read when the stages' counters were last copied (`stage_counters`).",
    ),
    status(
        "check_windows",
        CHECK_RAW + 4,
        &[],
        "CRC-32 of the last whole frame's windows, copied with `check_raw`.",
    ),
    status(
        "check_codes",
        CHECK_RAW + 8,
        &[],
        "CRC-32 of the codes of the last whole picture, copied with `check_raw`.",
    ),
    status(
        "check_sent",
        CHECK_RAW + 12,
        &[],
        "CRC-32 of the codes of the last whole picture that was read from the memory for the screen, copied with `check_raw`.",
    ),
    status(
        "check_frames",
        CHECK_RAW + 16,
        &[
            Field { name: "raw", low: 0, bits: 8, doc: "Number of `check_raw`." },
            Field { name: "windows", low: 8, bits: 8, doc: "Number of `check_windows`." },
            Field { name: "codes", low: 16, bits: 8, doc: "Number of `check_codes`." },
            Field {
                name: "sent",
                low: 24,
                bits: 8,
                doc: "Number of `check_sent`: pictures read, repeated ones included.",
            },
        ],
        "Frame numbers of the CRCs, modulo 256: equal numbers in the first three fields mean one frame. A reset or a flush restarts the numbers.",
    ),
    count(
        "core_cycles",
        CORE_CYCLES,
        "Cycles of the core's clock. This counter and the next two run independently: two reads of all three compare the clocks.",
    ),
    count("input_cycles", CORE_CYCLES + 4, "Cycles of the incoming pixels' clock."),
    count("screen_cycles", CORE_CYCLES + 8, "Cycles of the screen's clock."),
    control(
        "picture_corner",
        PICTURE_CORNER,
        0,
        &[
            Field { name: "column", low: 0, bits: 13, doc: "Column." },
            Field { name: "row", low: 16, bits: 13, doc: "Row." },
            bit("raw", 31, "`picture` shows raw pixel words that the calculator took, in place of codes."),
        ],
        "The first pixel of the square of codes that `picture` shows.",
    ),
    status(
        "frame_blocks",
        FRAME_BLOCKS,
        &[
            Field { name: "accepted", low: 0, bits: 16, doc: "Blocks that were accepted." },
            bit("busy", 16, "A block is checked or sent: words of `frame` are ignored."),
        ],
        "Blocks of the host's frame (`frame`). `pattern.host` 0, a reset, or a memory that stops serving restarts the frame.",
    ),
    count("frame_check", FRAME_BLOCKS + 4, "Check of the host's frame up to the last accepted block."),
];

/// A register by its name.
#[must_use]
pub fn register(name: &str) -> Option<&'static Register> {
    REGISTERS.iter().find(|register| register.name == name)
}

#[cfg(test)]
mod tests;
