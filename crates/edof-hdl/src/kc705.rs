//! The KC705 project: everything that Vivado needs to make a bitstream, as text.

use crate::benches::{self, Benches, Recorded};
use crate::board::{EdofCore, Identity, Kc705Core};
use crate::crossing::constraints::{self, Period};
use crate::project::{self, Project, ProjectError};
use crate::verilog::{Crossing, emit};
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
    let small = Design { frame: recorded.video.size, ..design.clone() };
    let tried = bare_core(&small, sets, identity, tables)?;
    let core = EdofCore::new(design, sets, identity, tables.luma, tables.colours)?;
    let mut top = Kc705Core::new(core);
    top.connect_all();
    let crossings = emit(&top)?.crossings;
    let images = project::images(design, sets).into_iter().chain(table_images(tables)).collect();
    let core = project::of_circuit(&mut top, images)?;
    let benches = benches::files(&core, &calculator, &tried, recorded);
    let mut files = files(design, &core, &crossings, &benches);
    files.extend(benches.files);
    Ok(Kc705 { core, files })
}

/// The core without images. By itself, since a core is large on the stack.
fn bare_core(
    design: &Design,
    sets: [&FixedNetwork; 2],
    identity: &Identity,
    tables: &Tables,
) -> Result<Project, ProjectError> {
    let mut core = EdofCore::new(design, sets, identity, tables.luma, tables.colours)?;
    Ok(project::of_circuit(&mut core, vec![])?)
}

/// Images of the display tables and of the set-up tables.
#[must_use]
pub fn table_images(tables: &Tables) -> Vec<(String, String)> {
    // Codes of 8 bits, encoded light of 12.
    let [red, green, blue] = tables.colours;
    let all = [(tables.luma, 2), (red, 3), (green, 3), (blue, 3)];
    let display = TABLE_IMAGES.iter().zip(all).map(|(path, (words, digits))| {
        let text = words.iter().fold(String::new(), |mut text, word| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{word:0digits$x}");
            text
        });
        (path.to_string(), text)
    });
    let chips = I2C_IMAGES.iter().zip([i2c::KC705, i2c::IMAGEON]);
    display.chain(chips.map(|(path, table)| (path.to_string(), i2c::image(table)))).collect()
}

fn files(
    design: &Design,
    core: &Project,
    crossings: &[Crossing],
    benches: &Benches,
) -> Vec<(String, String)> {
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
        ("edof.core", fusesoc(core, benches)),
        ("registers.md", markdown::page()),
        ("registers.h", c_header::header()),
        ("registers.rdl", systemrdl::address_map()),
        ("lint.vlt", include_str!("../../../rtl/waivers.vlt").to_string()),
    ];
    fixed.chain(made.map(|(path, text)| (path.to_string(), text))).collect()
}

/// The CAPI2 file with its lists of files.
fn fusesoc(core: &Project, benches: &Benches) -> String {
    let list = |paths: &mut dyn Iterator<Item = String>| {
        paths.map(|path| format!("      - {path}\n")).collect::<String>()
    };
    let copied = |path: &str| format!("{path}: {{copyto: {path}}}");
    let memory = list(&mut core.memory.iter().map(|(path, _)| copied(path)));
    let tried = list(&mut benches::RECORDED.iter().map(|path| copied(path)));
    FUSESOC
        .replace("@rtl@\n", &list(&mut core.verilog.iter().map(|(name, _)| format!("rtl/{name}"))))
        .replace("@core_rtl@\n", &list(&mut benches.core_verilog.iter().cloned()))
        .replace("@memory@\n", &memory)
        .replace("@recorded@\n", &tried)
}
