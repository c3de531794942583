//! The KC705 project: everything that Vivado needs to make a bitstream, as text.

use crate::benches::{self, Benches, Recorded};
use crate::board::{EdofCore, Identity, Kc705Core, Pace};
use crate::crossing::constraints::{self, Period};
use crate::floorplan;
use crate::project::{self, Project, ProjectError};
use crate::verilog::{Crossing, emit};
use crate::video::display::TABLE_IMAGES;
use edof_device::board::{self, CORE_KILOHERTZ, Clocks, I2C_IMAGES, MadeClock};
use edof_device::design::{Design, FrameSize};
use edof_device::i2c;
use edof_device::input_timing;
use edof_device::registers::{c_header, markdown, systemrdl};
use edof_device::video::VideoTiming;
use edof_network::FixedNetwork;
use rust_hdl::prelude::Block;
use std::fmt::Write;

/// The board's own files: pins and clocks, the DRAM controller, the top and what it stands on. Numbers between `@` follow from the design.
const BOARD_FILES: [(&str, &str); 5] = [
    ("constraints/kc705.xdc", include_str!("../../../constraints/kc705.xdc")),
    ("constraints/mig.prj", include_str!("../../../constraints/mig.prj")),
    ("constraints/mig_kc705.v", include_str!("../../../constraints/mig_kc705.v")),
    ("rtl/kc705_top.v", include_str!("../../../rtl/kc705_top.v")),
    ("rtl/edof_debounce.v", include_str!("../../../rtl/edof_debounce.v")),
];
/// How the project is built.
const BUILD_FILES: [(&str, &str); 4] = [
    ("build.tcl", include_str!("../../../project/build.tcl")),
    ("reports.tcl", include_str!("../../../project/reports.tcl")),
    ("Makefile", include_str!("../../../project/Makefile")),
    ("README.md", include_str!("../../../project/README.md")),
];
/// The core file for FuseSoC, without the lists of files.
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
    project::spacious(|| whole(design, sets, identity, tables, recorded))
}

fn whole(
    design: &Design,
    sets: [&FixedNetwork; 2],
    identity: &Identity,
    tables: &Tables,
    recorded: &Recorded,
) -> Result<Kc705, ProjectError> {
    let clocks = board::clocks(design)?;
    let calculator = project::calculator(design, sets)?;
    let small = Design { frame: recorded.video.size, ..design.clone() };
    let tried = bare_core(&small, sets, identity, tables)?;
    let core = EdofCore::new(design, sets, identity, tables.luma, tables.colours)?;
    let mut top = Kc705Core::new(core, design.frame, &Pace::BOARD);
    top.connect_all();
    let crossings = emit(&top)?.crossings;
    let images =
        project::images(design, sets).into_iter().chain(table_images(tables, design.frame)).collect();
    let core = project::of_circuit(&mut top, images)?;
    let benches = benches::files(&core, &calculator, &tried, recorded);
    let mut files = files(design, clocks, &core, &crossings, &benches);
    files.extend(benches.files);
    Ok(Kc705 { core, files })
}

/// The core without images.
fn bare_core(
    design: &Design,
    sets: [&FixedNetwork; 2],
    identity: &Identity,
    tables: &Tables,
) -> Result<Project, ProjectError> {
    let mut core = EdofCore::new(design, sets, identity, tables.luma, tables.colours)?;
    Ok(project::of_circuit(&mut core, vec![])?)
}

/// Images of the display tables, and of the set-up tables for frames of a size.
#[must_use]
pub fn table_images(tables: &Tables, frame: FrameSize) -> Vec<(String, String)> {
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
    let chips = I2C_IMAGES.iter().zip(i2c::programs(VideoTiming::on_the_cable(frame)));
    display.chain(chips.map(|(path, program)| (path.to_string(), i2c::image(&program)))).collect()
}

fn files(
    design: &Design,
    clocks: Clocks,
    core: &Project,
    crossings: &[Crossing],
    benches: &Benches,
) -> Vec<(String, String)> {
    let pixel = clocks.screen.period_ns();
    let periods = [
        Period { clock: "clock", nanoseconds: CORE_PERIOD_NS },
        Period { clock: "calculator_clock", nanoseconds: clocks.calculator.period_ns() },
        Period { clock: "input_clock", nanoseconds: pixel },
        Period { clock: "screen_clock", nanoseconds: pixel },
    ];
    let fixed = BOARD_FILES
        .iter()
        .chain(&BUILD_FILES)
        .map(|(path, text)| (path.to_string(), with_clocks(text, clocks)));
    let made = [
        ("constraints/crossings.xdc", constraints::lines(crossings, "core", &periods)),
        ("constraints/floorplan.xdc", floorplan::lines(design, "core/core")),
        ("edof.core", fusesoc(core, benches)),
        ("source_map.json", core.source_map()),
        ("registers.md", markdown::page()),
        ("registers.h", c_header::header()),
        ("registers.rdl", systemrdl::address_map()),
        ("lint.vlt", include_str!("../../../rtl/waivers.vlt").to_string()),
    ];
    fixed.chain(made.map(|(path, text)| (path.to_string(), text))).collect()
}

/// Period of the clock of memory and host.
const CORE_PERIOD_NS: f64 = 1e6 / CORE_KILOHERTZ as f64;

/// A text with a design's clocks in place of their names.
pub(crate) fn with_clocks(text: &str, Clocks { calculator, screen }: Clocks) -> String {
    let mhz = |khz: u64| (khz as f64 / 1e3).to_string();
    let [earliest, latest] = input_timing::delays_ns(screen.period_ns());
    let numbers = [
        ("core_mhz", mhz(CORE_KILOHERTZ.into())),
        ("core_period", format!("{CORE_PERIOD_NS:.3}")),
        ("input_delay_max", format!("{latest:.3}")),
        ("input_delay_min", format!("{earliest:.3}")),
    ];
    let made = [figures("calculator", calculator), figures("screen", screen)];
    let numbers = numbers.map(|(name, number)| (name.to_owned(), number));
    let all = numbers.into_iter().chain(made.into_iter().flatten());
    all.fold(text.to_owned(), |text, (name, number)| text.replace(&format!("@{name}@"), &number))
}

/// The figures of a clock that an MMCM makes.
fn figures(name: &str, MadeClock { khz, mmcm }: MadeClock) -> [(String, String); 5] {
    let eighths = |eighths: u64| format!("{:.3}", eighths as f64 / 8.0);
    [
        ("mhz", (khz as f64 / 1e3).to_string()),
        ("period", format!("{:.3}", 1e6 / khz as f64)),
        ("divide", mmcm.divide.to_string()),
        ("multiply", eighths(mmcm.multiply_eighths)),
        ("output", eighths(mmcm.output_eighths)),
    ]
    .map(|(figure, number)| (format!("{name}_{figure}"), number))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The pin-to-pin figures of 7-series HR pads behind their zero-hold delay at speed grade -2: set-up and hold before the clock's edge
    /// (DS189 1.10, table 44, XC7S6 to XC7S100).
    const PADS: [(f64, f64); 5] = [(2.76, -0.40), (2.67, -0.37), (2.66, -0.28), (2.91, -0.33), (2.91, -0.33)];

    #[test]
    fn the_inputs_constraints_leave_what_the_pads_need() {
        let sizes = VideoTiming::MODES.map(|mode| (mode.line.active, mode.frame.active));
        for (width, height) in sizes {
            let mut design = Design::from_json(include_str!("../../../designs/kc705.json")).unwrap();
            (design.frame.width, design.frame.height) = (width, height);
            let clocks = board::clocks(&design).unwrap();
            let text = with_clocks(BOARD_FILES[0].1, clocks);
            let delay = |which: &str| -> f64 {
                let (_, rest) =
                    text.split_once(&format!("set_input_delay -clock hdmi_rx -{which} ")).unwrap();
                rest.split(' ').next().unwrap().parse().unwrap()
            };
            for (set_up, hold) in PADS {
                assert!(clocks.screen.period_ns() - delay("max") >= set_up, "{width}x{height}: set-up");
                assert!(delay("min") >= hold, "{width}x{height}: hold");
            }
            assert!(text.contains("set_property IOBDELAY IFD [get_ports {hdmi_rx_data[*]}]"));
        }
    }
}
