//! The KC705 project: everything that Vivado needs to make a bitstream, as text.

use crate::board::{EdofCore, Identity, Kc705Core};
use crate::crossing::constraints::{self, Period};
use crate::project::{self, Project, ProjectError};
use crate::verilog::{Crossing, Direction, Port, emit};
use crate::video::display::TABLE_IMAGES;
use edof_spec::board::{CORE_KILOHERTZ, I2C_IMAGES};
use edof_spec::design::Design;
use edof_spec::registers::{c_header, markdown, systemrdl};
use edof_spec::video::VideoTiming;
use edof_spec::{FixedNetwork, i2c};
use rust_hdl::prelude::Block;
use std::fmt::Write;

/// The board's own files: pins and clocks, the DRAM controller, the top.
const BOARD_FILES: [(&str, &str); 4] = [
    ("constraints/kc705.xdc", include_str!("../../../constraints/kc705.xdc")),
    ("constraints/mig.prj", include_str!("../../../constraints/mig.prj")),
    ("constraints/mig_kc705.v", include_str!("../../../constraints/mig_kc705.v")),
    ("rtl/kc705_top.v", include_str!("../../../rtl/kc705_top.v")),
];
/// How the project is built.
const BUILD_FILES: [(&str, &str); 3] = [
    ("build.tcl", include_str!("../../../project/build.tcl")),
    ("Makefile", include_str!("../../../project/Makefile")),
    ("README.md", include_str!("../../../project/README.md")),
];
/// The test bench that needs no Rust, without its numbers.
const BENCH: &str = include_str!("../../../project/bench.sv");
/// Its core for FuseSoC, without the lists of files.
const FUSESOC: &str = include_str!("../../../project/edof.core");

/// The display tables that a design starts with: luma codes; encoded red, green and blue.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    /// 2¹⁵ luma codes.
    pub luma: &'a [u64],
    /// 2¹⁴ entries of 12 bits for each colour.
    pub colours: [&'a [u64]; 3],
}

/// Windows, and the patches that the network makes of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recorded {
    /// Words of each window.
    pub windows: Vec<Vec<i16>>,
    /// Words of each patch.
    pub patches: Vec<Vec<i16>>,
}

/// A project: the modules and images, and all other files by their paths.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kc705 {
    /// `kc705_core` with what it stands on.
    pub core: Project,
    /// Everything else.
    pub files: Vec<(String, String)>,
}

/// The project of a design; both sets of weights start with these networks.
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn project(
    design: &Design,
    sets: [&FixedNetwork; 2],
    identity: &Identity,
    tables: &Tables,
    recorded: &Recorded,
) -> Result<Kc705, ProjectError> {
    let calculator = project::calculator(design, sets)?;
    let core = EdofCore::new(design, sets, identity, tables.luma, tables.colours)?;
    let mut top = Kc705Core::new(core);
    top.connect_all();
    let crossings = emit(&top)?.crossings;
    let images = project::images(design, sets).into_iter().chain(table_images(tables)).collect();
    let core = project::of_circuit(&mut top, images)?;
    let mut files = files(design, &core, &crossings);
    files.extend(bench(&calculator, recorded));
    Ok(Kc705 { core, files })
}

/// Images of the display tables and of the set-up tables.
#[must_use]
pub fn table_images(tables: &Tables) -> Vec<(String, String)> {
    let all = [tables.luma, tables.colours[0], tables.colours[1], tables.colours[2]];
    let display = TABLE_IMAGES.iter().zip(all).map(|(path, words)| {
        let text = words.iter().fold(String::new(), |mut text, word| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{word:03x}");
            text
        });
        (path.to_string(), text)
    });
    let chips = I2C_IMAGES.iter().zip([i2c::KC705, i2c::IMAGEON]);
    display.chain(chips.map(|(path, table)| (path.to_string(), i2c::image(table)))).collect()
}

fn files(design: &Design, core: &Project, crossings: &[Crossing]) -> Vec<(String, String)> {
    let screen = VideoTiming::of_frame(design.frame).pixel_khz as f64;
    let nanoseconds = |kilohertz: f64| 1e6 / kilohertz;
    let periods = [
        Period { clock: "clock", nanoseconds: nanoseconds(CORE_KILOHERTZ.into()) },
        Period { clock: "input_clock", nanoseconds: nanoseconds(screen) },
        Period { clock: "screen_clock", nanoseconds: nanoseconds(screen) },
    ];
    let fixed =
        BOARD_FILES.iter().chain(&BUILD_FILES).map(|(path, text)| (path.to_string(), (*text).to_string()));
    let made = [
        ("constraints/crossings.xdc", constraints::lines(crossings, "core", &periods)),
        ("edof.core", fusesoc(core)),
        ("registers.md", markdown::page()),
        ("registers.h", c_header::header()),
        ("registers.rdl", systemrdl::address_map()),
        ("lint.vlt", include_str!("../../../rtl/waivers.vlt").to_string()),
    ];
    fixed.chain(made.map(|(path, text)| (path.to_string(), text))).collect()
}

/// The CAPI2 file with its lists of files.
fn fusesoc(core: &Project) -> String {
    let list = |paths: &mut dyn Iterator<Item = String>| {
        paths.map(|path| format!("      - {path}\n")).collect::<String>()
    };
    let rtl = list(&mut core.verilog.iter().map(|(name, _)| format!("rtl/{name}")));
    let memory = list(&mut core.memory.iter().map(|(path, _)| format!("{path}: {{copyto: {path}}}")));
    FUSESOC.replace("@rtl@\n", &rtl).replace("@memory@\n", &memory)
}

/// The bench with the calculator's ports, and its words.
fn bench(calculator: &Project, recorded: &Recorded) -> Vec<(String, String)> {
    let beats = |words: &[Vec<i16>]| words.first().map_or(0, |words| words.len() / 2);
    let windows = recorded.windows.len();
    let text = BENCH
        .replace("@windows@", &windows.to_string())
        .replace("@window_beats@", &beats(&recorded.windows).to_string())
        .replace("@patch_beats@", &beats(&recorded.patches).to_string())
        .replace("@limit@", &(20_000 + 4_000 * windows).to_string())
        .replace("@ports@", &pins(calculator));
    vec![
        ("sim/bench.sv".into(), text),
        ("sim/windows.hex".into(), pairs(&recorded.windows)),
        ("sim/patches.hex".into(), pairs(&recorded.patches)),
    ]
}

/// What the bench connects to each port; other inputs are 0, other outputs open.
fn pins(calculator: &Project) -> String {
    let value = |port: &Port| match port.name.as_str() {
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
        _ if port.direction == Direction::Input => "0",
        _ => "",
    };
    let pin = |port: &Port| format!(".{}({})", port.name, value(port));
    calculator.ports.iter().map(pin).collect::<Vec<_>>().join(",\n        ")
}

/// Two words a line, the first one low.
fn pairs(vectors: &[Vec<i16>]) -> String {
    let mut text = String::new();
    for pair in vectors.iter().flat_map(|words| words.chunks_exact(2)) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:04x}{:04x}", pair[1] as u16, pair[0] as u16);
    }
    text
}
