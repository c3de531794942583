//! The generated directory of a board: it builds and tries itself with nothing but tools, and its parts fit each other.

use crate::common::committed;
use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_cosim::system::{self, TableWords};
use edof_golden::{Display, scalar};
use edof_hdl::benches::Recorded;
use edof_hdl::board::Identity;
use edof_hdl::board_project::{self, BoardProject};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// A folder of its own, gone afterwards.
pub struct Place(tempfile::TempDir);

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// The sources of a design with a random network.
pub fn project(design: &str) -> BoardProject {
    let design = committed(design);
    let network = edof_device::random::for_design(&design, 1);
    let display = Display::default();
    let words = TableWords::of(&display);
    let draw = &mut Draw::new(1);
    let windows: Vec<Vec<InputWord>> =
        (0..12).map(|_| edof_device::random::extreme_window(draw, design.form.window.pixels())).collect();
    let patches = windows.iter().map(|window| scalar::run(&network, window).output).collect();
    let identity = Identity {
        design_hash: 1,
        weights_hash: 2,
        frame: (design.frame.width as u16, design.frame.height as u16),
    };
    let video = system::recorded(&design, &network, &display).unwrap();
    let recorded = Recorded { windows, patches, video };
    let (sets, shell) = ([&network, &network], &design.board.shells[0]);
    board_project::project(&design, shell, sets, &identity, &words.tables(), &recorded).unwrap()
}

/// The sources of `tiny` in the folder `out`.
pub fn generated(place: &Place) -> PathBuf {
    static PROJECT: LazyLock<BoardProject> = LazyLock::new(|| project("tiny"));
    written(place, &PROJECT)
}

/// Sources in the folder `out`.
pub fn written(place: &Place, project: &BoardProject) -> PathBuf {
    let folder = place.path("out");
    let verilog = project.core.verilog.iter().map(|(name, text)| (format!("rtl/{name}"), text));
    let others = project.core.memory.iter().chain(&project.files).map(|(path, text)| (path.clone(), text));
    for (path, text) in verilog.chain(others) {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

pub fn run(program: &str, arguments: &[&str], folder: &Path) -> Output {
    let program = if program.contains('/') { folder.join(program) } else { program.into() };
    Command::new(program).args(arguments).current_dir(folder).output().unwrap()
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// Changes one word of a file of hexadecimal words.
fn spoil(file: &Path) {
    let text = std::fs::read_to_string(file).unwrap();
    let line = text.lines().nth(40).unwrap();
    let other: String = line.chars().map(|c| if c == '7' { '6' } else { '7' }).collect();
    std::fs::write(file, text.replacen(line, &other, 1)).unwrap();
}

/// A folder with everything on the path but the programs whose names begin so.
fn path_without(place: &Place, beginnings: &[&str]) -> PathBuf {
    let folder = place.path("path");
    std::fs::create_dir(&folder).unwrap();
    let all = std::env::var_os("PATH").unwrap();
    for program in std::env::split_paths(&all).filter_map(|path| std::fs::read_dir(path).ok()).flatten() {
        let program = program.unwrap();
        let name = program.file_name().into_string().unwrap();
        if !beginnings.iter().any(|beginning| name.starts_with(beginning)) {
            // The first of a name is the one that counts.
            let _ = std::os::unix::fs::symlink(program.path(), folder.join(name));
        }
    }
    folder
}

/// A bench, the words that it is given wrong, and what it says of them.
const SPOILT_PATCH: (&str, &str, &str) = ("bench", "patches", "FAIL: patch");

/// `make sim` where only one simulator is installed, then with wrong words.
fn tries_itself(simulator: &str, missing: &[&str], spoilt: &[(&str, &str, &str)]) {
    let place = Place::new();
    let folder = generated(&place);
    let path = path_without(&place, missing);
    let output = Command::new("make").arg("sim").current_dir(&folder).env("PATH", path).output().unwrap();
    let told = said(&output);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("PASS: 12 patches") && told.contains("PASS: 5 pictures"), "{told}");
    for (bench, words, complaint) in spoilt {
        spoil(&folder.join(format!("sim/{words}.hex")));
        let output = run(&format!("build/{simulator}/{bench}"), &[], &folder);
        assert!(!output.status.success() && said(&output).contains(complaint), "{}", said(&output));
    }
}

#[test]
fn the_directory_tries_itself_with_verilator_alone_and_finds_wrong_words() {
    tries_itself(
        "verilator",
        &["iverilog", "vvp"],
        &[SPOILT_PATCH, ("core_bench", "pictures", "FAIL: a frame")],
    );
}

#[test]
fn the_directory_tries_itself_with_icarus_alone_and_finds_wrong_words() {
    // The other bench takes ten times as long here, and finds the wrong pixel as above.
    tries_itself("icarus", &["verilator"], &[SPOILT_PATCH]);
}

#[test]
fn the_directory_is_clean() {
    let place = Place::new();
    let output = run("make", &["lint"], &generated(&place));
    assert!(output.status.success(), "{}", said(&output));
}

/// The ports of `chain_axis` as the calculator's bench drives them.
const AXI4_STREAM: &str = "chain_axis dut (
        .aclk(clock), .aresetn(!reset), .s_axis_tvalid(window_valid), .s_axis_tready(window_ready), .s_axis_tdata(windows[sent]),
        .s_axis_tlast(sent % WINDOW_BEATS == WINDOW_BEATS - 1), .s_axis_tuser(1'b0),
        .m_axis_tvalid(patch_valid), .m_axis_tready(patch_ready), .m_axis_tdata(patch_data), .m_axis_tlast(patch_last), .m_axis_tuser(),
        .flush(1'b0), .write_valid(1'b0), .write_address(25'd0), .write_data(32'd0), .status_address(7'd0), .status(), .window_fault()
    );";

#[test]
fn the_calculator_makes_the_same_patches_behind_axi4_stream_ports() {
    let place = Place::new();
    let folder = generated(&place);
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let bench = read("sim/bench.sv");
    let (head, rest) = bench.split_once("chain dut (").unwrap();
    let (_, tail) = rest.split_once("\n    );").unwrap();
    std::fs::write(folder.join("sim/axis.sv"), [head, AXI4_STREAM, tail].concat()).unwrap();
    let list = read("sim/bench.f").replace("sim/bench.sv", "sim/axis.sv");
    std::fs::write(folder.join("axis.f"), list + "axi4_stream/chain_axis.v\n").unwrap();
    let line = ["-g2012", "-Wno-timescale", "-s", "edof_bench", "-o", "axis", "-c", "axis.f"];
    let compiled = run("iverilog", &line, &folder);
    assert!(compiled.status.success(), "{}", said(&compiled));
    let output = run("vvp", &["axis"], &folder);
    assert!(said(&output).contains("PASS: 12 patches"), "{}", said(&output));
}

#[test]
fn modules_with_axi4_stream_ports_have_the_widths_of_what_they_hold() {
    let place = Place::new();
    let folder = generated(&place);
    let modules = read_list(&folder);
    for top in ["chain_axis", "stream_core_axis", "sensor_words"] {
        let file = format!("axi4_stream/{top}.v");
        let mut line = vec!["--lint-only", "-Wall", "-Wno-PINCONNECTEMPTY", "--top-module", top];
        line.extend(["lint.vlt", file.as_str()]);
        line.extend(modules.iter().map(String::as_str));
        let output = run("verilator", &line, &folder);
        assert!(output.status.success(), "{}", said(&output));
    }
}

/// The modules of a generated folder but its top.
fn read_list(folder: &Path) -> Vec<String> {
    let list = std::fs::read_to_string(folder.join("sim/bench.f")).unwrap();
    list.lines().filter(|line| line.starts_with("rtl/")).map(str::to_owned).collect()
}

#[test]
fn the_top_elaborates_with_the_memory_controller_as_a_black_box() {
    let place = Place::new();
    let folder = generated(&place);
    let output = run("make", &["top"], &folder);
    assert!(output.status.success(), "{}", said(&output));
    let top = folder.join("rtl/kc705_top.v");
    let text = std::fs::read_to_string(&top).unwrap();
    std::fs::write(&top, text.replace(".s_axi_awlen(", ".s_axi_awlength(")).unwrap();
    assert!(!run("make", &["top"], &folder).status.success(), "a port that the controller does not have");
}

/// Ports of a module by name, one for each bit of a vector.
fn ports(verilog: &str) -> BTreeSet<String> {
    let header = verilog.split_once(");\n").unwrap().0;
    let mut found = BTreeSet::new();
    for port in header
        .split([',', '\n'])
        .map(str::trim)
        .filter(|l| l.starts_with("input") || l.starts_with("output") || l.starts_with("inout"))
    {
        let name = port.split_whitespace().last().unwrap();
        match port.split_once('[').and_then(|(_, rest)| rest.split_once(':')) {
            Some((high, _)) => {
                found.extend((0..=high.parse::<usize>().unwrap()).map(|bit| format!("{name}[{bit}]")))
            }
            None => _ = found.insert(name.into()),
        }
    }
    found
}

/// What a constraints file gives a pin.
fn placed(xdc: &str) -> Vec<String> {
    let lines = xdc.lines().filter(|line| line.contains("PACKAGE_PIN"));
    lines
        .map(|line| {
            line.rsplit_once("[get_ports ").unwrap().1.trim_end_matches(']').trim_matches(['{', '}']).into()
        })
        .map(closed)
        .collect()
}

/// `leds[0` as `leds[0]`: the bracket of the command was taken with it.
fn closed(name: String) -> String {
    if name.contains('[') && !name.ends_with(']') { name + "]" } else { name }
}

/// Pins of the memory controller's project file.
fn of_controller(project: &str) -> Vec<String> {
    let names = project.lines().filter(|line| line.contains("PADName=") && line.contains("VCCAUX_IO"));
    names.map(|line| line.split("name=\"").nth(1).unwrap().split('"').next().unwrap().into()).collect()
}

#[test]
fn every_port_of_the_top_has_one_pin_and_every_pin_a_port() {
    let place = Place::new();
    let folder = generated(&place);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let all: Vec<String> = placed(&read("constraints/kc705.xdc"))
        .into_iter()
        .chain(of_controller(&read("constraints/mig.prj")))
        .collect();
    let pins: BTreeSet<String> = all.iter().cloned().collect();
    assert_eq!(pins.len(), all.len(), "a port is placed twice");
    assert_eq!(ports(&read("rtl/kc705_top.v")), pins);
    let pads = |text: &str, from: &str| {
        let words = text.split(from).skip(1).map(|rest| rest.split(['"', ' ']).next().unwrap().to_string());
        words.collect::<Vec<_>>()
    };
    let mut places = pads(&read("constraints/kc705.xdc"), "PACKAGE_PIN ");
    places.extend(pads(&read("constraints/mig.prj"), "PADName=\"").into_iter().filter(|pad| pad != "No"));
    assert_eq!(places.iter().collect::<BTreeSet<_>>().len(), places.len(), "a pin is given twice");
}

/// The instance names of a module's parts, with their modules.
fn parts(folder: &Path, module: &str) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(folder.join(format!("rtl/{module}.v"))).unwrap();
    crate::support::instances(&text)
}

#[test]
fn every_bank_is_in_one_block_of_the_floorplan() {
    let place = Place::new();
    let folder = generated(&place);
    let text = std::fs::read_to_string(folder.join("constraints/floorplan.xdc")).unwrap();
    let cells: Vec<&str> = text
        .lines()
        .filter_map(|line| line.split_once("[get_cells {")?.1.strip_suffix("}]"))
        .flat_map(|cells| cells.split(' '))
        .collect();
    let banks: BTreeSet<&str> = cells.iter().copied().filter(|cell| cell.ends_with(".lanes")).collect();
    assert_eq!(banks.len(), committed("tiny").stages().map(|stage| stage.banks()).sum::<usize>(), "{text}");
    let multipliers: BTreeSet<&str> =
        cells.iter().map(|cell| cell.strip_prefix("core/").unwrap().rsplit_once('/').unwrap().0).collect();
    assert_eq!(multipliers.len(), committed("tiny").stages.len(), "{text}");
    for path in multipliers {
        path.split('/').fold("kc705_core".to_string(), |module, name| {
            let found = parts(&folder, &module).into_iter().find(|(instance, _)| instance == name);
            found.unwrap_or_else(|| panic!("{path}: {module} has no part {name}")).1
        });
    }
    assert!(
        !std::fs::read_to_string(folder.join("build.tcl")).unwrap().contains("floorplan"),
        "it is optional"
    );
}

#[test]
fn every_limited_crossing_is_in_the_design_and_every_synchroniser_limited() {
    let place = Place::new();
    let folder = generated(&place);
    let xdc = std::fs::read_to_string(folder.join("constraints/crossings.xdc")).unwrap();
    let heads: Vec<(String, String)> = xdc
        .lines()
        .filter_map(|line| line.strip_prefix("# core/")?.split_once(": "))
        .map(|(path, leaf)| (path.into(), leaf.into()))
        .collect();
    assert!(heads.len() >= 10, "{heads:?}");
    for (path, leaf) in &heads {
        let mut module = "kc705_core".to_string();
        for name in path.split('/') {
            let found = parts(&folder, &module).into_iter().find(|(instance, _)| instance == name);
            let (_, next) = found.unwrap_or_else(|| panic!("{path}: {module} has no part {name}"));
            module = if next == ")" { leaf.clone() } else { next };
        }
        assert!(std::fs::read_to_string(folder.join(format!("rtl/{leaf}.v"))).is_ok());
    }
    let limits = xdc.lines().filter(|line| line.starts_with("set_")).count();
    assert!(limits >= heads.len(), "{limits} limits for {} crossings", heads.len());
    // Registers that the limits name are in the leaves.
    for line in xdc.lines().filter(|line| line.starts_with("set_")) {
        for word in line.split(['{', '}', ' ']).filter(|word| word.starts_with("core/")) {
            let register = word.rsplit('/').find(|part| part.contains("_reg")).unwrap();
            let name = register.split("_reg").next().unwrap();
            let leaves = ["sync", "reset_sync", "async_fifo", "pulse_sync", "bus_sync", "clear"];
            let is_there = leaves.iter().any(|leaf| {
                std::fs::read_to_string(folder.join(format!("rtl/edof_{leaf}.v")))
                    .is_ok_and(|text| text.contains(name))
            });
            assert!(is_there, "{line}");
        }
    }
}

#[test]
fn the_register_map_is_there_for_people_and_programs() {
    let place = Place::new();
    let folder = generated(&place);
    std::fs::write(
        place.path("try.c"),
        "#include \"registers.h\"\nint main(void) { return EDOF_CONTROL == 0x14u ? 0 : 1; }\n",
    )
    .unwrap();
    let include = format!("-I{}", folder.display());
    let compiled = run("cc", &["-Wall", "-Werror", &include, "-o", "try", "try.c"], &place.path(""));
    assert!(compiled.status.success(), "{}", said(&compiled));
    assert!(run("./try", &[], &place.path("")).status.success());
    let page = std::fs::read_to_string(folder.join("registers.md")).unwrap();
    assert!(page.contains("`input_overruns`") && page.contains("## `control`"));
}
