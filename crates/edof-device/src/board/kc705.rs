//! The KC705 with an FMC-IMAGEON: Xilinx XC7K325T, DDR3, HDMI in (ADV7611 on the card) and out (ADV7511).
//!
//! Sources: UG810 (board), DS180 (cells), DS182 (limits of the MMCM), UG472 (steps of its dividers), UG473 and UG479 (blocks).

use super::memory::Memory;
use super::part::{BlockMemory, Columns, DeepRows, Multiplier, Part, ReadsTwice, Resources};
use super::pll::Pll;
use super::{Board, ClockMaker, Frames, Setup, Shell, Source, VideoIn, VideoOut};
use crate::i2c::{receiver, transmitter};
use crate::input_timing;
use crate::video::VideoTiming;

/// The KC705.
pub const KC705: Board = Board {
    name: "kc705",
    part: XC7K325T,
    core_khz: 200_000,
    // The user clock of the memory controller.
    clocks: ClockMaker { source_khz: 200_000, pll: MMCM },
    // A burst of another agent before it, both ways, a refresh, and as much again.
    memory: Memory::of_port(512, 512),
    sets: &[2],
    baud: 921_600,
    video_in: Some(VideoIn {
        setup: Setup { image: "mem/i2c_imageon.mem", program: |mode, _| receiver::program(mode) },
        source: Source::Cable { delays_ns: input_timing::delays_ns },
    }),
    video_out: Some(VideoOut {
        setup: Some(Setup { image: "mem/i2c_kc705.mem", program: |_, _| transmitter::program() }),
        frames: Frames::OfModes(&VideoTiming::MODES, 25_000),
    }),
    shells: &[
        Shell {
            name: "mig",
            about: "Xilinx's memory controller (MIG), and a serial port for the host in the core",
            top: "kc705_top",
            files: &[&BOARD_FILES, &BUILD_FILES],
        },
        Shell {
            name: "litex",
            about: "The same, and a LiteX target in litex/: LiteDRAM, LiteX's bus and UARTBone",
            top: "kc705_top",
            files: &[&BOARD_FILES, &BUILD_FILES, &LITEX_FILES],
        },
    ],
};

/// Kintex-7 325T, speed grade -2.
const XC7K325T: Part = Part {
    name: "XC7K325T",
    multiplier: Multiplier { name: "DSP48E1", value_bits: 25 },
    memory: BlockMemory {
        name: "RAMB36E1",
        half: Some("RAMB18E1"),
        widest: (72, 512),
        reads_twice: ReadsTwice::BothPorts,
        deep_rows: DeepRows::PowerOfTwo,
    },
    logic: ["LUT", "FF"],
    logic_percent: [100, 100],
    cells: Resources { multipliers: 840, memories: 445, half_memories: 0, luts: 203_800, registers: 407_600 },
    leaves: &[],
    columns: Some(Columns { multipliers: (6, 140), memories: 7 }),
};

/// MMCME2 of speed grade -2. Outputs: from the oscillator's lowest by the largest divider to what a global buffer carries.
const MMCM: Pll = Pll {
    name: "MMCM",
    oscillator_khz: 600_000..=1_440_000,
    detector_khz: 10_000..=500_000,
    output_khz: 4_688..=710_000,
    divide: 1..=106,
    multiply_eighths: 16..=512,
    output_eighths: 16..=1024,
    step_eighths: 1,
    feedback: None,
};

/// Pins and clocks, the DRAM controller, the top and what it instantiates.
const BOARD_FILES: [(&str, &str); 5] = [
    ("constraints/kc705.xdc", include_str!("../../../../constraints/kc705.xdc")),
    ("constraints/mig.prj", include_str!("../../../../constraints/mig.prj")),
    ("constraints/mig_kc705.v", include_str!("../../../../constraints/mig_kc705.v")),
    ("rtl/kc705_top.v", include_str!("../../../../rtl/kc705_top.v")),
    ("rtl/edof_debounce.v", include_str!("../../../../rtl/edof_debounce.v")),
];

/// How the project is built.
const BUILD_FILES: [(&str, &str); 5] = [
    ("build.tcl", include_str!("../../../../project/build.tcl")),
    ("reports.tcl", include_str!("../../../../project/reports.tcl")),
    ("Makefile", include_str!("../../../../project/Makefile")),
    ("README.md", include_str!("../../../../project/README.md")),
    ("edof.core", include_str!("../../../../project/edof.core")),
];

/// LiteX around the core: a target, its simulation, and the host's script for the DRAM.
const LITEX_FILES: [(&str, &str); 8] = [
    ("litex/README.md", include_str!("../../../../project/litex/README.md")),
    ("litex/requirements.txt", include_str!("../../../../project/litex/requirements.txt")),
    ("litex/edof_soc.py", include_str!("../../../../project/litex/edof_soc.py")),
    ("litex/kc705.py", include_str!("../../../../project/litex/kc705.py")),
    ("litex/dram.py", include_str!("../../../../project/litex/dram.py")),
    ("litex/sim.py", include_str!("../../../../project/litex/sim.py")),
    ("litex/bench.sv", include_str!("../../../../project/litex/bench.sv")),
    ("litex/line.cpp", include_str!("../../../../project/litex/line.cpp")),
];
