//! The project of a design for its board: everything that makes a bitstream, as text.

use crate::benches::{self, Benches, Recorded};
use crate::board::{Identity, Tables};
use crate::boards::circuits;
use crate::crossing::constraints::{self, Period};
use crate::floorplan;
use crate::project::{self, Project, ProjectError};
use edof_device::board::{Board, MadeClock, Shell, Source};
use edof_device::design::Design;
use edof_device::registers::{c_header, markdown, systemrdl};
use edof_network::FixedNetwork;

/// A project: the modules and images, and all other files by their paths.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BoardProject {
    /// The core with what the board has around it.
    pub core: Project,
    /// Everything else.
    pub files: Vec<(String, String)>,
}

/// Makes the project of a design with a shell of its board; both sets of weights start with these networks.
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn project(
    design: &Design,
    shell: &Shell,
    sets: [&FixedNetwork; 2],
    identity: &Identity,
    tables: &Tables,
    recorded: &Recorded,
) -> Result<BoardProject, ProjectError> {
    project::spacious(|| {
        let numbers = numbers(design)?;
        let calculator = project::calculator(design, sets)?;
        let small = Design { frame: recorded.video.size, ..design.clone() };
        let circuits = circuits(design.board)?;
        let mut small_core = (circuits.core)(&small, sets, identity, tables)?;
        let tried = project::of_circuit(&mut *small_core, vec![])?;
        let mut top = (circuits.top)(design, sets, identity, tables)?;
        let images = project::images(design, sets).into_iter().chain(tables.images(design)).collect();
        let core = project::of_circuit(&mut *top, images)?.on_part(&design.board.part);
        let benches = benches::files(&core, &calculator, &tried, recorded);
        let mut files = made_files(design, shell, &core)?;
        files.extend(shell.files.concat().iter().map(|(path, text)| {
            let text = benches::with_numbers(&lists(text, &core, &benches), &recorded.video);
            let filled =
                |text: String, (name, number): &(String, String)| text.replace(&format!("@{name}@"), number);
            (path.to_string(), numbers.iter().fold(text, filled))
        }));
        files.extend(benches.files);
        Ok(BoardProject { core, files })
    })
}

/// Files that follow from the design; constraints in Vivado's language for a shell that has such files.
fn made_files(design: &Design, shell: &Shell, core: &Project) -> Result<Vec<(String, String)>, ProjectError> {
    let clocks = design.clocks()?;
    let pixel = clocks.screen.map(MadeClock::period_ns);
    let periods = [
        ("clock", Some(core_period_ns(design.board))),
        ("calculator_clock", Some(clocks.calculator.period_ns())),
        ("input_clock", pixel),
        ("screen_clock", pixel),
    ];
    let period = |(clock, ns): (&'static str, Option<f64>)| Some(Period { clock, nanoseconds: ns? });
    let periods: Vec<Period> = periods.into_iter().filter_map(period).collect();
    let floorplan = design
        .board
        .part
        .columns
        .map(|columns| ("constraints/floorplan.xdc", floorplan::lines(design, columns, "core/core")));
    let is_xdc = |(path, _): &(&str, &str)| path.ends_with(".xdc");
    let crossings = shell
        .files
        .iter()
        .any(|files| files.iter().any(is_xdc))
        .then(|| ("constraints/crossings.xdc", constraints::lines(&core.crossings, "core", &periods)));
    let made = [
        ("source_map.json", core.source_map()),
        ("registers.md", markdown::page()),
        ("registers.h", c_header::header()),
        ("registers.rdl", systemrdl::address_map()),
        ("lint.vlt", include_str!("../../../rtl/waivers.vlt").to_string()),
        (
            "axi4_stream/sensor_words.v",
            include_str!("../../../project/axi4_stream/sensor_words.v").to_string(),
        ),
        ("axi4_stream/chain_axis.v", include_str!("../../../project/axi4_stream/chain_axis.v").to_string()),
        (
            "axi4_stream/stream_core_axis.v",
            include_str!("../../../project/axi4_stream/stream_core_axis.v").to_string(),
        ),
    ];
    Ok(crossings
        .into_iter()
        .chain(made)
        .chain(floorplan)
        .map(|(path, text)| (path.to_string(), text))
        .collect())
}

/// Period of the clock of memory and host.
fn core_period_ns(board: &Board) -> f64 {
    1e6 / f64::from(board.core_khz)
}

/// Names in a shell's files, and the numbers of a design that stand for them.
fn numbers(design: &Design) -> Result<Vec<(String, String)>, ProjectError> {
    let (clocks, board) = (design.clocks()?, design.board);
    let mut numbers = vec![
        ("baud".to_owned(), board.baud.to_string()),
        ("burst_words".to_owned(), board.memory.burst_words.to_string()),
    ];
    numbers.extend(figures(board, "calculator", clocks.calculator));
    numbers
        .extend(board.clock(board.core_khz.into()).into_iter().flat_map(|core| figures(board, "core", core)));
    if let Some(screen) = clocks.screen {
        numbers.extend(figures(board, "screen", screen));
        numbers.extend(board.clock(5 * screen.khz).into_iter().flat_map(|bits| figures(board, "bits", bits)));
        match board.video_in.as_ref().map(|video| &video.source) {
            Some(Source::Cable { delays_ns }) => {
                let [earliest, latest] = delays_ns(screen.period_ns());
                numbers.push(("input_delay_max".to_owned(), format!("{latest:.3}")));
                numbers.push(("input_delay_min".to_owned(), format!("{earliest:.3}")));
            }
            Some(Source::Camera { timing, .. }) => {
                numbers.push(("camera_mhz".to_owned(), mhz(timing.pixel_khz as u64)));
            }
            None => {}
        }
    }
    Ok(numbers)
}

fn mhz(khz: u64) -> String {
    (khz as f64 / 1e3).to_string()
}

/// The figures of a clock that a board's PLL makes, as the vendor's cell has them: whole, or with three digits where a PLL has eighths.
fn figures(board: &Board, name: &str, MadeClock { khz, settings }: MadeClock) -> [(String, String); 6] {
    let is_whole = board.clocks.pll.step_eighths == 8;
    let eighths = |eighths: u64| match is_whole {
        true => (eighths / 8).to_string(),
        false => format!("{:.3}", eighths as f64 / 8.0),
    };
    [
        ("mhz", mhz(khz)),
        ("period", format!("{:.3}", 1e6 / khz as f64)),
        ("divide", settings.divide.to_string()),
        ("multiply", eighths(settings.multiply_eighths)),
        ("output", eighths(settings.output_eighths)),
        ("feedback", (settings.multiply_eighths / settings.output_eighths).to_string()),
    ]
    .map(|(figure, number)| (format!("{name}_{figure}"), number))
}

/// A text with lists of files for FuseSoC in place of their names.
fn lists(text: &str, core: &Project, benches: &Benches) -> String {
    let list = |paths: &mut dyn Iterator<Item = String>| {
        paths.map(|path| format!("      - {path}\n")).collect::<String>()
    };
    let copied = |path: &str| format!("{path}: {{copyto: {path}}}");
    text.replace("@rtl@\n", &list(&mut core.verilog.iter().map(|(name, _)| format!("rtl/{name}"))))
        .replace("@core_rtl@\n", &list(&mut benches.core_verilog.iter().cloned()))
        .replace("@memory@\n", &list(&mut core.memory.iter().map(|(path, _)| copied(path))))
        .replace("@recorded@\n", &list(&mut benches::RECORDED.iter().map(|path| copied(path))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_device::video::VideoTiming;

    /// The pin-to-pin figures of 7-series HR pads behind their zero-hold delay at speed grade -2: set-up and hold before the clock's edge
    /// (DS189 1.10, table 44, XC7S6 to XC7S100).
    const PADS: [(f64, f64); 5] = [(2.76, -0.40), (2.67, -0.37), (2.66, -0.28), (2.91, -0.33), (2.91, -0.33)];

    #[test]
    fn the_inputs_constraints_leave_what_the_pads_need() {
        for mode in VideoTiming::MODES {
            let mut design = Design::from_json(include_str!("../../../designs/kc705.json")).unwrap();
            (design.frame.width, design.frame.height) = (mode.line.active, mode.frame.active);
            let period = design.clocks().unwrap().screen.unwrap().period_ns();
            let numbers = numbers(&design).unwrap();
            let delay = |which: &str| -> f64 {
                let name = format!("input_delay_{which}");
                numbers.iter().find(|(key, _)| *key == name).unwrap().1.parse().unwrap()
            };
            for (set_up, hold) in PADS {
                assert!(period - delay("max") >= set_up, "{}: set-up", mode.name());
                assert!(delay("min") >= hold, "{}: hold", mode.name());
            }
        }
        let constraints = include_str!("../../../constraints/kc705.xdc");
        assert!(constraints.contains("set_property IOBDELAY IFD [get_ports {hdmi_rx_data[*]}]"));
    }
}
