//! build.tcl and the constraints against a Vivado that knows its commands, their arguments and the objects of the netlist (sim/vivado/commands.tcl):
//! it gets to the end without a doubt, and with any constraint or image missing it does not.

mod netlist;
mod reports;

use crate::board::{Place, generated, project, said, written};
use netlist::Objects;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// Modules in which there is one clock, left out here to be quick; `scripts/soak.sh` has all of `kc705`.
const BOXES: [&str; 5] = ["chain", "window_reorder", "overlap_add", "display", "raster_reorder"];

/// The objects of `tiny`.
static OBJECTS: LazyLock<Objects> = LazyLock::new(|| {
    let place = Place::new();
    netlist::objects(&generated(&place), &BOXES)
});

/// A generated directory and the objects of its design.
struct Design {
    place: Place,
    folder: PathBuf,
}

impl Design {
    fn tiny() -> Self {
        let place = Place::new();
        let folder = generated(&place);
        Self::of(place, folder, &OBJECTS)
    }

    fn of(place: Place, folder: PathBuf, objects: &Objects) -> Self {
        fs::write(place.path("objects.tcl"), &objects.tcl).unwrap();
        Self { place, folder }
    }

    /// Runs build.tcl with reports of the newer form; returns its output and the commands.
    fn build(&self, fault: &str) -> (Output, String) {
        self.build_with(fault, "newer")
    }

    /// Runs build.tcl with reports of one form.
    fn build_with(&self, fault: &str, form: &str) -> (Output, String) {
        self.build_by(&[], fault, form)
    }

    /// Runs build.tcl with `-tclargs` of a strategy.
    fn build_by(&self, strategy: &[&str], fault: &str, form: &str) -> (Output, String) {
        let script = "source $env(STUB)\nsource $env(BUILD)\n";
        let log = self.place.path("commands.log");
        fs::write(self.place.path("run.tcl"), script).unwrap();
        let mut tclsh = Command::new("tclsh");
        tclsh.arg(self.place.path("run.tcl")).args(strategy).current_dir("/");
        tclsh.env("STUB", stub()).env("BUILD", self.folder.join("build.tcl")).env("FAULT", fault);
        tclsh.env("COMMANDS", &log).env("NETLIST", self.place.path("objects.tcl"));
        tclsh.env("REPORTS", reports::folder()).env("FORM", form);
        let output = tclsh.output().unwrap();
        (output, fs::read_to_string(&log).unwrap_or_default())
    }

    /// Asserts that the build fails with a message before the bitstream.
    fn fails(&self, fault: &str, words: &str) {
        self.fails_with(fault, words, "newer");
    }

    /// Asserts the same with reports of one form.
    fn fails_with(&self, fault: &str, words: &str, form: &str) {
        let (output, commands) = self.build_with(fault, form);
        assert!(!output.status.success(), "{fault}{words}: nobody missed it");
        assert!(said(&output).contains(words), "{fault}: '{words}' is not in {}", said(&output));
        assert!(!self.folder.join("build/edof.bit").exists(), "{commands}");
    }
}

fn stub() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../sim/vivado/commands.tcl")
}

#[test]
fn the_build_script_gets_to_its_end_and_does_so_again_with_reports_of_another_form() {
    let design = Design::tiny();
    for form in ["older", "newer"] {
        let (output, commands) = design.build_with("", form);
        assert!(output.status.success(), "{form}: {}", said(&output));
        assert_eq!(warnings(&output), Vec::<String>::new(), "{form}");
        let steps = [
            "create_ip",
            "synth_ip",
            "read_mem",
            "synth_design",
            "crossings.xdc",
            "place_design",
            "route_design",
            "write_bitstream",
        ];
        let at: Vec<usize> =
            steps.iter().map(|step| commands.find(step).unwrap_or_else(|| panic!("no {step}"))).collect();
        assert!(at.is_sorted(), "{commands}");
        fs::remove_file(design.folder.join("build/edof.bit")).unwrap();
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn kc705_with_all_of_its_netlist_gets_to_the_end() {
    let place = Place::new();
    let folder = written(&place, &project("kc705"));
    let objects = netlist::objects(&folder, &[]);
    assert_eq!(objects.glitches, Vec::<String>::new());
    let design = Design::of(place, folder, &objects);
    let (output, _) = design.build("");
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(warnings(&output), Vec::<String>::new());
}

/// Warnings of a build, except those of the DRAM controller's own constraints.
fn warnings(output: &Output) -> Vec<String> {
    let text = said(output);
    let of_controller = |line: &str| line.starts_with("WARNING") && line.contains("/build/mig_kc705/");
    text.lines().filter(|line| line.contains("WARNING") && !of_controller(line)).map(str::to_owned).collect()
}

#[test]
fn the_controllers_own_constraints_raise_warnings_and_stop_nothing() {
    let (output, _) = Design::tiny().build("");
    for id in ["[Vivado 12-180]", "[Common 17-55]"] {
        let line = said(&output).lines().find(|line| line.contains(id)).map(str::to_owned).unwrap();
        assert!(line.starts_with("WARNING: ") && line.contains("/build/mig_kc705/"), "{line}");
    }
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn nothing_asynchronous_is_behind_logic() {
    assert_eq!(OBJECTS.glitches, Vec::<String>::new(), "a set or reset that a glitch could trigger");
}

/// Lines of a file of constraints that are one.
fn constraints(folder: &Path, file: &str) -> Vec<String> {
    let text = fs::read_to_string(folder.join(file)).unwrap();
    text.lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_lowercase()))
        .map(str::to_owned)
        .collect()
}

#[test]
fn any_constraint_that_is_taken_away_is_missed() {
    let design = Design::tiny();
    for file in ["constraints/kc705.xdc", "constraints/crossings.xdc"] {
        let path = design.folder.join(file);
        let text = fs::read_to_string(&path).unwrap();
        let lines = constraints(&design.folder, file);
        assert!(lines.len() > 20, "{file}: {} lines", lines.len());
        for line in lines {
            fs::write(&path, text.replacen(&format!("{line}\n"), "", 1)).unwrap();
            let (output, _) = design.build("");
            assert!(!output.status.success(), "{file}: nobody missed {line}");
        }
        fs::write(&path, text).unwrap();
    }
}

#[test]
fn any_image_that_is_missing_or_not_hexadecimal_alone_is_reported() {
    let design = Design::tiny();
    let images: Vec<PathBuf> =
        fs::read_dir(design.folder.join("mem")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(images.len() > 30);
    for image in images {
        let name = image.file_name().unwrap().to_str().unwrap();
        let text = fs::read_to_string(&image).unwrap();
        fs::remove_file(&image).unwrap();
        design.fails("", &format!("[Synth 8-4445] could not open $readmem data file '{name}'"));
        for (other, words) in [
            (format!("{text}0\n"), "lines, expected"),
            (text.replacen('\n', " // a comment\n", 1), "is no word"),
            (text.replacen('\n', " 0\n", 1), "is no word"),
        ] {
            fs::write(&image, other).unwrap();
            design.fails("", words);
        }
        fs::write(&image, text).unwrap();
    }
}

#[test]
fn whatever_a_report_says_stops_it() {
    let design = Design::tiny();
    let faults = [
        ("slack", "the worst setup slack from screen_mmcm/CLKOUT0 to screen_mmcm/CLKOUT0 is -0.01 ns"),
        ("calculator_hold", "the worst hold slack from calculator_mmcm/CLKOUT0"),
        (
            "utilization",
            "report_utilization: DSPs: 852 of 840 are used; black box edof_window: see build/utilization.rpt",
        ),
        (
            "clock_interaction",
            "report_clock_interaction: from screen_clock to hdmi_rx: Timed (unsafe): see build/clocks.rpt",
        ),
        (
            "pulse_width",
            "report_pulse_width: screen_clock: Min Period at core/screen/frames/words_reg/CLKARDCLK: slack -0.183 ns",
        ),
        (
            "cdc",
            "report_cdc: CDC-10: Combinatorial logic detected before a synchronizer: from core/screen/busy_q_reg/C to",
        ),
        ("methodology", "report_methodology: TIMING-6#1: The clocks screen_clock and memory_clock"),
        ("drc", "report_drc: NDRV-1#1: Net core/screen/late has no driver; PLCK-12#1: "),
        ("bus_skew", "report_bus_skew: bus 1 from core/"),
        ("critical", "synth_design: 1 critical warnings"),
        ("pad", "place_design: "),
    ];
    for (fault, words) in faults {
        for form in ["older", "newer"] {
            design.fails_with(fault, words, form);
        }
    }
}

#[test]
fn a_calculator_that_misses_its_clock_gives_a_bitstream_with_its_rate_in_the_name_and_an_error() {
    let design = Design::tiny();
    let (output, _) = design.build("calculator_slack");
    // 10 ns and 0.4 more.
    assert!(
        !output.status.success() && said(&output).contains("the calculator holds 96 MHz"),
        "{}",
        said(&output)
    );
    assert!(design.folder.join("build/edof-holds-96mhz.bit").exists());
    assert!(!design.folder.join("build/edof.bit").exists());
    // What a later run leaves is its own.
    assert!(design.build("").0.status.success());
    assert!(!design.folder.join("build/edof-holds-96mhz.bit").exists());
}

#[test]
fn strategies_differ_in_directives_and_have_folders_of_their_own() {
    let design = Design::tiny();
    for (strategy, directive) in
        [("explore", "place_design -directive Explore"), ("wires", "ExtraNetDelay_high")]
    {
        let (output, commands) = design.build_by(&[strategy], "", "newer");
        assert!(output.status.success() && commands.contains(directive), "{}", said(&output));
        let line =
            fs::read_to_string(design.folder.join("build").join(strategy).join("strategy.txt")).unwrap();
        assert_eq!(line, format!("{strategy} 0.05 0.05 edof.bit\n"));
    }
    assert!(!design.folder.join("build/edof.bit").exists());
    let (output, _) = design.build_by(&["fastest"], "", "newer");
    assert!(said(&output).contains("strategy 'fastest': expected one of default, explore, wires"));
}

/// `make strategies` with a Vivado that gives each strategy another slack.
#[test]
fn make_strategies_prints_a_table_and_keeps_the_best() {
    let design = Design::tiny();
    let vivado = "#!/bin/sh\nname=${6:-default}; at=build; [ $name = default ] || at=build/$name; mkdir -p $at\n\
        case $name in default) slack=-0.2;; explore) slack=-1e-3;; wires) slack=0.031;; esac\n\
        echo $name > $at/edof.bit; echo $name $slack 0.05 edof.bit > $at/strategy.txt\n[ $name = wires ]\n";
    let tools = design.place.path("tools");
    fs::create_dir(&tools).unwrap();
    fs::write(tools.join("vivado"), vivado).unwrap();
    assert!(Command::new("chmod").arg("+x").arg(tools.join("vivado")).status().unwrap().success());
    let path = format!("{}:{}", tools.display(), std::env::var("PATH").unwrap());
    let output = Command::new("make")
        .arg("strategies")
        .current_dir(&design.folder)
        .env("PATH", path)
        .output()
        .unwrap();
    let text = said(&output);
    let rows: Vec<&str> = text.lines().filter(|line| line.contains(" 0.05 ")).collect();
    assert!(output.status.success(), "{text}");
    assert_eq!(rows.iter().map(|row| &row[..4]).collect::<Vec<_>>(), ["wire", "expl", "defa"], "{text}");
    assert_eq!(fs::read_to_string(design.folder.join("build/edof.bit")).unwrap(), "wires\n");
}

#[test]
fn an_object_that_is_not_there_and_a_line_that_is_no_constraint_stop_it() {
    let design = Design::tiny();
    let path = design.folder.join("constraints/kc705.xdc");
    let text = fs::read_to_string(&path).unwrap();
    for (line, words) in [
        ("set_false_path -from [get_ports no_such]", "[Vivado 12-584] No ports matched 'no_such'"),
        ("set_false_path -to [get_pins core/no/D]", "[Vivado 12-508] No pins matched 'core/no/D'"),
        ("foreach port {a b} { puts $port }", "[Designutils 20-1307] Command 'foreach' is not supported"),
        ("set_max_delay -datapath -from [get_ports uart_rx] 3.0", "unknown option '-datapath'"),
    ] {
        fs::write(&path, format!("{text}{line}\n")).unwrap();
        design.fails("", words);
    }
}
