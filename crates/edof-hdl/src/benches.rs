//! Test benches in Verilog alone, with what they try a design with: for users with a simulator and without Rust.

use crate::project::Project;
use crate::verilog::{Direction, Port};
use edof_core::DisplayMode;
use edof_core::cable;
use edof_core::display::{BLACK, CHROMA_ZERO};
use edof_core::number::{Fixed, InputWord, OutputWord};
use edof_device::board::Memory;
use edof_device::design::FrameSize;
use edof_device::registers::map;
use edof_device::video::VideoTiming;

/// The benches without their numbers: the calculator's, the core's.
const BENCH: &str = include_str!("../../../project/bench.sv");
const CORE_BENCH: &str = include_str!("../../../project/core_bench.sv");

/// What benches of whole frames have in common: sizes and recorded frames; the camera; the screen, which decides what is right.
const PARTS: [(&str, &str); 3] = [
    ("@frames_svh@\n", include_str!("../../../project/bench/frames.svh")),
    ("@camera_svh@\n", include_str!("../../../project/bench/camera.svh")),
    ("@screen_svh@\n", include_str!("../../../project/bench/screen.svh")),
];

/// Units of time in a cycle of the memory's clock.
const CORE_UNITS: u64 = 1000;

/// What the benches try a design with, and what it must become.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recorded {
    /// Words of each window.
    pub windows: Vec<Vec<InputWord>>,
    /// Words of the patch that the network makes of each.
    pub patches: Vec<Vec<OutputWord>>,
    /// Frames for the core.
    pub video: RecordedVideo,
}

/// Frames from bus to bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedVideo {
    /// Frame size: small, because a simulator is slow.
    pub size: FrameSize,
    /// Pixel words of each.
    pub frames: Vec<Vec<u16>>,
    /// Codes of the picture on the screen for each.
    pub pictures: Vec<Vec<u16>>,
    /// How the display makes codes of words.
    pub mode: DisplayMode,
    /// Cycles of the slower of memory and calculator in which the core has done with one.
    pub cycles: usize,
    /// The memory.
    pub memory: Memory,
    /// The memory's clock in kilohertz.
    pub core_khz: u64,
    /// The calculator's clock in kilohertz.
    pub calculator_khz: u64,
}

/// The benches of a generated directory.
pub(crate) struct Benches {
    /// All files, by their paths.
    pub files: Vec<(String, String)>,
    /// Paths of the modules that the core's bench needs.
    pub core_verilog: Vec<String>,
}

/// The benches of a core, its calculator, and a core of small frames: what of the latter is not in the larger one already goes below
/// `sim/rtl`.
pub(crate) fn files(core: &Project, calculator: &Project, small: &Project, recorded: &Recorded) -> Benches {
    let others = small.verilog.iter().filter(|module| !core.verilog.contains(module));
    let others: Vec<_> = others.map(|(name, text)| (format!("sim/rtl/{name}"), text.clone())).collect();
    let is_other = |path: &String| others.iter().any(|(other, _)| other == path);
    let path = |(name, _): &(String, String)| {
        Some(format!("sim/rtl/{name}")).filter(is_other).unwrap_or_else(|| format!("rtl/{name}"))
    };
    let core_verilog: Vec<String> = small.verilog.iter().map(path).collect();
    let mut files = calculator_bench(calculator, recorded);
    files.push(list("bench", core.verilog.iter().map(|(name, _)| format!("rtl/{name}"))));
    files.extend(core_bench(small, &recorded.video));
    files.push(list("core_bench", core_verilog.iter().cloned()));
    files.extend(others);
    Benches { files, core_verilog }
}

/// What a simulator that is started in the directory compiles.
fn list(bench: &str, verilog: impl Iterator<Item = String>) -> (String, String) {
    let paths = std::iter::once(format!("sim/{bench}.sv")).chain(verilog);
    (format!("sim/{bench}.f"), paths.map(|path| path + "\n").collect())
}

/// What the benches read: windows and their patches, frames and their pictures.
pub(crate) const RECORDED: [&str; 4] =
    ["sim/windows.hex", "sim/patches.hex", "sim/frames.hex", "sim/pictures.hex"];

/// The calculator's bench, and its words.
fn calculator_bench(calculator: &Project, recorded: &Recorded) -> Vec<(String, String)> {
    let windows = recorded.windows.len();
    let value = |port: &str| match port {
        "clock_i" => "clock",
        "reset_i" => "reset",
        "window_valid_i" => "window_valid",
        "window_ready_o" => "window_ready",
        "window_data_i" => "windows[sent]",
        "window_last_i" => "sent % WINDOW_BEATS == WINDOW_BEATS - 1",
        "patch_valid_o" => "patch_valid",
        "patch_ready_i" => "patch_ready",
        "patch_data_o" => "patch_data",
        "patch_last_o" => "patch_last",
        _ => "",
    };
    let text = BENCH
        .replace("@windows@", &windows.to_string())
        .replace("@window_beats@", &beats(&recorded.windows).to_string())
        .replace("@patch_beats@", &beats(&recorded.patches).to_string())
        .replace("@limit@", &(20_000 + 4_000 * windows).to_string())
        .replace("@ports@", &pins(calculator, value));
    vec![
        ("sim/bench.sv".into(), text),
        (RECORDED[0].into(), pairs(&recorded.windows)),
        (RECORDED[1].into(), pairs(&recorded.patches)),
    ]
}

/// The core's bench, its frames as they lie on the bus (the luma code low, the chroma code high), and its pictures: to be run above
/// the folders of the core's images.
#[must_use]
pub fn core_bench(core: &Project, recorded: &RecordedVideo) -> Vec<(String, String)> {
    let value = |port: &str| match port {
        "clock_i" => "clock",
        "calculator_clock_i" => "calculator_clock",
        "input_clock_i" => "input_clock",
        "screen_clock_i" => "screen_clock",
        "reset_i" => "reset",
        "input_hs_i" => "input_hs",
        "input_vs_i" => "input_vs",
        "input_de_i" => "input_de",
        "input_data_i" => "input_data",
        "screen_hs_o" => "screen_hs",
        "screen_vs_o" => "screen_vs",
        "screen_de_o" => "screen_de",
        "screen_data_o" => "screen_data",
        "dram_write_aw_id_o" => "aw_id",
        "dram_write_aw_addr_o" => "aw_addr",
        "dram_write_aw_valid_o" => "aw_valid",
        "dram_write_aw_ready_i" => "aw_ready",
        "dram_write_w_data_o" => "w_data",
        "dram_write_w_last_o" => "w_last",
        "dram_write_w_valid_o" => "w_valid",
        "dram_write_w_ready_i" => "w_ready",
        "dram_write_b_id_i" => "b_id",
        "dram_write_b_valid_i" => "b_valid",
        "dram_write_b_ready_o" => "b_ready",
        "dram_read_ar_id_o" => "ar_id",
        "dram_read_ar_addr_o" => "ar_addr",
        "dram_read_ar_len_o" => "ar_len",
        "dram_read_ar_valid_o" => "ar_valid",
        "dram_read_ar_ready_i" => "ar_ready",
        "dram_read_r_id_i" => "r_id",
        "dram_read_r_data_i" => "memory[read_at]",
        "dram_read_r_last_i" => "left == 8'd0",
        "dram_read_r_valid_i" => "r_valid",
        "dram_read_r_ready_o" => "r_ready",
        "host_aw_addr_i" => "CONTROL_ADDRESS",
        "host_aw_valid_i" => "aw_request",
        "host_aw_ready_o" => "aw_grant",
        "host_w_data_i" => "CONTROL",
        "host_w_strb_i" => "4'hf",
        "host_w_valid_i" => "w_request",
        "host_w_ready_o" => "w_grant",
        "host_b_ready_i" => "1'b1",
        "dram_ready_i" | "i2c_done_i" => "1'b1",
        _ => "",
    };
    let text = with_numbers(CORE_BENCH, recorded).replace("@ports@", &pins(core, value));
    let codes = |pixel: &u16| u16::from_le_bytes(cable::codes(*pixel));
    let on_the_bus: Vec<Vec<u16>> =
        recorded.frames.iter().map(|frame| frame.iter().map(codes).collect()).collect();
    vec![
        ("sim/core_bench.sv".into(), text),
        (RECORDED[2].into(), lines(&on_the_bus)),
        (RECORDED[3].into(), lines(&recorded.pictures)),
    ]
}

/// A bench's text with the parts in common, and the numbers of frames, their timing and their pace, in place of their names.
pub(crate) fn with_numbers(text: &str, recorded: &RecordedVideo) -> String {
    let timing = VideoTiming::of_frame(recorded.size);
    let numbers = [
        ("@frames@", recorded.frames.len()),
        ("@width@", recorded.size.width),
        ("@height@", recorded.size.height),
        ("@line_front@", timing.line.front),
        ("@line_sync@", timing.line.sync),
        ("@line_back@", timing.line.back),
        ("@frame_front@", timing.frame.front),
        ("@frame_sync@", timing.frame.sync),
        ("@frame_back@", timing.frame.back),
        ("@cycles@", recorded.cycles),
        ("@word_bits@", recorded.memory.word_bits),
        ("@buffer_bytes@", recorded.memory.buffer_bytes as usize),
        ("@core_units@", CORE_UNITS as usize),
        ("@calculator_units@", (CORE_UNITS * recorded.core_khz / recorded.calculator_khz) as usize),
    ];
    let hexadecimal = |word: u32| format!("{word:08x}");
    let whole = PARTS.iter().fold(text.to_owned(), |text, (name, part)| text.replace(name, part));
    let text = whole
        .replace("@control_address@", &hexadecimal(map::CONTROL))
        .replace("@control@", &hexadecimal(map::running(recorded.mode, 0)))
        .replace("@black@", &format!("{:02x}{:02x}", CHROMA_ZERO, BLACK));
    numbers.iter().fold(text, |text, (name, number)| text.replace(name, &number.to_string()))
}

/// What a bench connects to each port; other inputs are 0, other outputs open.
fn pins(circuit: &Project, value: impl Fn(&str) -> &'static str) -> String {
    let zero = |port: &Port| format!("{}'d0", port.bits);
    let pin = |port: &Port| match (value(&port.name), port.direction) {
        ("", Direction::Input) => format!(".{}({})", port.name, zero(port)),
        (value, _) => format!(".{}({value})", port.name),
    };
    circuit.ports.iter().map(pin).collect::<Vec<_>>().join(",\n        ")
}

/// Returns the beats of a vector.
fn beats<W>(vectors: &[Vec<W>]) -> usize {
    vectors.first().map_or(0, |words| words.len() / 2)
}

/// Two words a line, the first one low.
fn pairs(vectors: &[Vec<impl Fixed<Bits = i16>>]) -> String {
    let pairs = vectors.iter().flat_map(|words| words.chunks_exact(2));
    pairs.map(|pair| format!("{:04x}{:04x}\n", pair[1].to_bits(), pair[0].to_bits())).collect()
}

/// A word a line.
fn lines(frames: &[Vec<u16>]) -> String {
    frames.iter().flatten().map(|word| format!("{word:04x}\n")).collect()
}
