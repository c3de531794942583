//! The ULX3S: Lattice LFE5U-85F-6, an SDRAM and an FT231X, for open tools from Verilog to the bitstream. Frames come from an
//! OV7670 at pins or over the serial line, lie in the SDRAM, and are shown by DVI.
//!
//! Sources: FPGA-DS-02012 (cells, limits of the PLL), FPGA-TN-02200 (its dividers; feedback from the output), ULX3S manual (25 MHz, FT231X, pairs of the
//! video connector at pads of the FPGA).

use super::memory::Memory;
use super::part::{BlockMemory, DeepRows, Multiplier, Part, ReadsTwice, Resources};
use super::pll::Pll;
use super::{Board, ClockMaker, Frames, Setup, Shell, Source, VideoIn, VideoOut};
use crate::i2c::ov7670;
use crate::video::VideoTiming;

/// The ULX3S.
pub const ULX3S: Board = Board {
    name: "ulx3s",
    part: LFE5U_85F,
    // The whole board held 60 MHz when it was routed (docs/ulx3s.md); the rest is for other designs and seeds.
    core_khz: 50_000,
    clocks: ClockMaker { source_khz: 25_000, pll: EHXPLLL },
    memory: SDRAM,
    sets: &[1, 2],
    // Of the FT231X's rates the fastest that divides the clock; a bit is 25 cycles.
    baud: 2_000_000,
    video_in: Some(VideoIn {
        setup: Setup { image: "mem/i2c_ov7670.mem", program: ov7670::program },
        // The chip's black is in no public source: a dark frame tells it.
        source: Source::Camera { timing: ov7670::TIMING, black: 0 },
    }),
    video_out: Some(VideoOut { setup: None, frames: Frames::Middle(VideoTiming::VGA_60) }),
    shells: &[Shell {
        name: "serial",
        about: "Frames in the SDRAM, a serial line for the host; Yosys and nextpnr",
        top: "ulx3s_top",
        files: &[&BOARD_FILES, &BUILD_FILES],
    }],
};

/// The chip's 32 MiB behind words of eight columns. A burst has a quarter of a row: with longer ones the LUT RAM of the agents was the longest path. It waits
/// at most for one of the other direction, and each of the two for another row and a refresh.
const SDRAM: Memory = Memory { burst_words: 16, ..Memory::of_port(128, 368) };

/// Pins, and the top.
const BOARD_FILES: [(&str, &str); 3] = [
    ("ulx3s.lpf", include_str!("../../../../project/ulx3s/ulx3s.lpf")),
    ("rtl/ulx3s_top.v", include_str!("../../../../rtl/ulx3s_top.v")),
    ("rtl/edof_debounce.v", include_str!("../../../../rtl/edof_debounce.v")),
];

/// How the project is built.
const BUILD_FILES: [(&str, &str); 10] = [
    ("Makefile", include_str!("../../../../project/ulx3s/Makefile")),
    ("README.md", include_str!("../../../../project/ulx3s/README.md")),
    ("requirements.txt", include_str!("../../../../tests/route/requirements.txt")),
    ("synth.ys", include_str!("../../../../project/ecp5/synth.ys")),
    ("weights_map.v", include_str!("../../../../project/ecp5/weights_map.v")),
    ("tables_map.v", include_str!("../../../../project/ecp5/tables_map.v")),
    ("output_register.v", include_str!("../../../../project/ecp5/output_register.v")),
    ("report.py", include_str!("../../../../project/ecp5/report.py")),
    ("sim/block_cells.v", include_str!("../../../../sim/cells/ecp5.v")),
    ("sim/carry_cells.v", include_str!("../../../../sim/cells/ecp5_carry.v")),
];

/// ECP5 85k, speed grade 6.
const LFE5U_85F: Part = Part {
    name: "LFE5U-85F",
    multiplier: Multiplier { name: "MULT18X18D", value_bits: 18 },
    memory: BlockMemory {
        name: "DP16KD",
        half: None,
        widest: (36, 512),
        reads_twice: ReadsTwice::Copies,
        deep_rows: DeepRows::MultipleOf(1024),
    },
    logic: ["LUT4", "FF"],
    // Accumulators are outside of the multipliers, and LUTs have four inputs: within 5 % of the whole chains that Yosys 0.70 mapped.
    logic_percent: [218, 144],
    cells: Resources { multipliers: 156, memories: 208, half_memories: 0, luts: 83_640, registers: 83_640 },
    leaves: &LEAVES,
    columns: None,
};

/// Cells of pads, and multipliers with their own registers; what the portable ones become here has them outside.
const LEAVES: [(&str, &str); 3] = [
    ("edof_ddr_out", include_str!("../../../../rtl/ecp5/edof_ddr_out.v")),
    ("edof_macc", include_str!("../../../../rtl/ecp5/edof_macc.v")),
    ("edof_scale", include_str!("../../../../rtl/ecp5/edof_scale.v")),
];

/// EHXPLLL, its feedback from the output that makes the clock.
const EHXPLLL: Pll = Pll {
    name: "EHXPLLL",
    oscillator_khz: 400_000..=800_000,
    detector_khz: 3_125..=400_000,
    output_khz: 3_125..=400_000,
    divide: 1..=128,
    multiply_eighths: 8..=8 * 80 * 128,
    output_eighths: 8..=8 * 128,
    step_eighths: 8,
    feedback: Some(1..=80),
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::pll::Settings;

    /// What Lattice's own tool chooses (Clarity Designer, as prjtrellis' `ecppll.cpp` records it): input and output in MHz, divisions of
    /// input, feedback and output.
    const CLARITY: [[u64; 5]; 13] = [
        [12, 48, 1, 4, 12],
        [12, 60, 1, 5, 10],
        [20, 30, 2, 3, 20],
        [45, 30, 3, 2, 20],
        [100, 400, 1, 4, 1],
        [200, 400, 1, 2, 2],
        [50, 400, 1, 8, 2],
        [70, 40, 7, 4, 15],
        [12, 36, 1, 3, 18],
        [12, 96, 1, 8, 6],
        [90, 40, 9, 4, 15],
        [90, 50, 9, 5, 13],
        [43, 86, 1, 2, 7],
    ];

    #[test]
    fn clocks_are_made_as_the_vendors_tool_makes_them() {
        for [input, output, divide, feedback, division] in CLARITY {
            let theirs =
                Settings { divide, multiply_eighths: 8 * feedback * division, output_eighths: 8 * division };
            assert!(EHXPLLL.is_legal(theirs, 1000 * input), "{theirs:?}");
            let ours = EHXPLLL.make(1000 * input, 1000 * output).unwrap().settings;
            let ratio =
                |settings: Settings| (settings.divide, settings.multiply_eighths / settings.output_eighths);
            assert_eq!(ratio(ours), ratio(theirs), "{input} MHz to {output} MHz");
        }
    }

    #[test]
    fn a_clock_that_needs_a_fraction_is_not_made() {
        assert_eq!(EHXPLLL.make(25_000, 99_999), None);
    }
}
