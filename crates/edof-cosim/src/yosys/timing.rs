//! Static timing of a design, one part at a time: the worst path of logic alone, and the nets that lead to the most loads.
//!
//! Each part is mapped flat from the emitted files as they are, and Yosys' own `sta` adds the delays that its Xilinx library states
//! for cells, with set-up and clock-to-output. There is no placement, so that wires take no time, the clock no skew and a net of a
//! thousand loads no longer than one of two. Registers behind block RAMs are taken into them, as every tool but Yosys does. Such a figure shows which paths are long, not at which clock a board runs.

mod report;

use super::Cells;
use super::fan_out::FanOut;
use super::netlist::Netlist;
pub use super::netlist::paths::Kind;
use super::output_registers;
use crate::cache;
use crate::error::{Error, at};
use crate::{Source, tool, work};
use edof_device::design::stage::GROUP_BANKS;
use edof_hdl::project::Project;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Nets of highest fan-out that are listed per stage.
pub const NETS: usize = 10;
/// Kinds of paths that are listed per stage.
pub const KINDS: usize = 10;
/// Borders between blocks of the floorplan that a path may cross: from a group of banks to its neighbour.
pub const MAX_CROSSED: usize = 1;
/// Parts that are mapped at once, at most: a big one takes 400 MB.
const AT_ONCE: usize = 2;
/// Changes with what is read out of a run, so that older results in the cache are not taken for it.
const FORMAT: &str = "timing 7";

/// Where a user's results belong: `edof/timing` in `$XDG_CACHE_HOME`, or else in `~/.cache`.
#[must_use]
pub fn user_cache() -> Option<PathBuf> {
    cache::of_user("timing")
}

/// One part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartTiming {
    /// Module of the part.
    pub module: String,
    /// Delay of the worst path in picoseconds, from clock edge to set-up. A port counts as a register.
    pub delay_ps: u64,
    /// LUTs, multiplexers and carry blocks on it.
    pub levels: usize,
    /// The path, where it begins first.
    pub path: Vec<Step>,
    /// The kinds of paths that are longest, the longest first, at most [`KINDS`].
    pub kinds: Vec<Kind>,
    /// Registers that lead to banks of multipliers in more than one group of neighbours (`rtl/edof_macc_array.v`): name and groups.
    pub strays: Vec<String>,
    /// Borders between blocks of the floorplan (groups of banks) that a path crosses at most, and the register where that path begins.
    pub crossed: (usize, String),
    /// Nets of highest fan-out, those of control and those of data; the clock is left out.
    pub nets: Vec<FanOut>,
    /// Loads of the net of control that has most; 0 without one.
    pub control_loads: usize,
    /// What it was mapped to.
    pub cells: Cells,
    /// Multipliers whose accumulator is inside them.
    pub accumulating_dsps: usize,
    /// Multipliers.
    pub dsps: usize,
    /// Those of them whose registers A, B, M and P are all used.
    pub registered_dsps: usize,
    /// Those of them whose operation comes from a register that may become the DSP's own OPMODEREG.
    pub free_operations: usize,
}

/// One cell on a path, and the net at which it is left.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// Picoseconds since the clock edge.
    pub arrival_ps: u64,
    /// Type of the cell and the pins through which the path goes, such as `LUT6.I0->O`.
    pub cell: String,
    /// The net in the source's own name; empty where the mapping made it.
    pub net: String,
}

/// Where the stages of a calculator that is the top are: paths for [`parts`].
#[must_use]
pub fn stages(count: usize) -> Vec<String> {
    (0..count).map(|stage| format!("stages_{stage}")).collect()
}

/// Parts of a generated design, each by the names of instances from the top down to it, with `/` between them. Equal ones are mapped once.
/// `cache` keeps results under the hash of everything that went in; `done` gets the number of finished parts and of all parts.
///
/// # Errors
/// Yosys is missing, rejects the design, or prints what cannot be read; there is no such part.
pub fn parts(
    project: &Project,
    paths: &[String],
    cache: Option<&Path>,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<PartTiming>, Error> {
    let work = work::folder()?;
    let design = elaborated(project, work.path())?;
    let text = std::fs::read_to_string(&design).map_err(at(&design))?;
    let modules =
        paths.iter().map(|path| module_of(&text, &project.top, path)).collect::<Result<Vec<_>, _>>()?;
    let mut wanted = modules.clone();
    wanted.sort();
    wanted.dedup();
    let version = tool::run(tool::command("yosys", work.path()).arg("-V"))?;
    let (next, finished, found) = (AtomicUsize::new(0), AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    let worker = || {
        while let Some(module) = wanted.get(next.fetch_add(1, Ordering::Relaxed)) {
            let key = cache::key([FORMAT, &version, &text, module]);
            let timing = of_module(&design, module, &key, cache);
            done(finished.fetch_add(1, Ordering::Relaxed) + 1, wanted.len());
            // A poisoned lock means that the other worker panicked: its panic is what counts.
            if let Ok(mut found) = found.lock() {
                found.insert(module.clone(), timing);
            }
        }
    };
    std::thread::scope(|scope| {
        // This thread is a worker, too: all is done, however few others can be started.
        for _ in 1..AT_ONCE.min(wanted.len()) {
            let _ = std::thread::Builder::new().spawn_scoped(scope, worker);
        }
        worker();
    });
    let mut all = BTreeMap::new();
    for (module, timing) in found.into_inner().unwrap_or_default() {
        all.insert(module, timing?);
    }
    let of = |module: &String| all.get(module).cloned().ok_or_else(|| unreadable(format!("no {module}")));
    modules.iter().map(of).collect()
}

/// A whole design as one: for a block by itself.
///
/// # Errors
/// As [`parts`].
pub fn whole(project: &Project, cache: Option<&Path>) -> Result<PartTiming, Error> {
    let work = work::folder()?;
    let design = elaborated(project, work.path())?;
    let text = std::fs::read_to_string(&design).map_err(at(&design))?;
    let version = tool::run(tool::command("yosys", work.path()).arg("-V"))?;
    let module = format!("\\{}", project.top);
    of_module(&design, &module, &cache::key([FORMAT, &version, &text, &module]), cache)
}

/// The design with all parameters and memory images in place, before anything is mapped.
pub(super) fn elaborated(project: &Project, work: &Path) -> Result<PathBuf, Error> {
    let source = Source::from(project);
    source.write(work)?;
    crate::chain::verilated::write_images(project, work)?;
    let files: Vec<&str> = source.file_names().collect();
    let script = format!(
        "read_verilog -defer {}\nhierarchy -top {}\nproc\nwrite_rtlil design.il\n",
        files.join(" "),
        source.top
    );
    run(&script, "elaborate.ys", work)?;
    Ok(work.join("design.il"))
}

/// The module of a part.
pub(super) fn module_of(rtlil: &str, top: &str, path: &str) -> Result<String, Error> {
    path.split('/').try_fold(format!("\\{top}"), |module, name| {
        let begin = format!("module {module}");
        let lines = rtlil.lines().skip_while(|line| *line != begin).take_while(|line| *line != "end");
        let cell = format!("\\{name}");
        let mut words = lines.map(|line| line.split_whitespace().collect::<Vec<_>>());
        let kind = words.find_map(|words| match words[..] {
            ["cell", kind, name] if name == cell => Some(kind.to_string()),
            _ => None,
        });
        kind.ok_or_else(|| unreadable(format!("no cell {name} of {path} in {module}")))
    })
}

fn of_module(design: &Path, module: &str, key: &str, cache: Option<&Path>) -> Result<PartTiming, Error> {
    let name = format!("{key}.json");
    let product = cache::obtain(cache, &name, |work| {
        let timing = mapped(design, module, work)?;
        let text = serde_json::to_string(&timing).map_err(|error| unreadable(error.to_string()))?;
        let path = work.join(&name);
        std::fs::write(&path, text).map_err(at(&path))
    })?;
    let text = std::fs::read_to_string(&product.path).map_err(at(&product.path))?;
    serde_json::from_str(&text).map_err(|error| unreadable(format!("{}: {error}", product.path.display())))
}

/// Maps a module flat and times it.
fn mapped(design: &Path, module: &str, work: &Path) -> Result<PartTiming, Error> {
    let script = format!(
        "read_rtlil \"{}\"\n\
         hierarchy -top {module}\n\
         synth_xilinx -family xc7 -flatten -noiopad -noclkbuf\n\
         write_json netlist.json\n\
         read_verilog -lib -specify +/xilinx/cells_sim.v\n\
         delete {module}\n\
         proc\n\
         write_json delays.json\n",
        design.display()
    );
    run(&script, "map.ys", work)?;
    with_output_registers(work)?;
    let text = std::fs::read_to_string(work.join("sta.txt")).map_err(at(&work.join("sta.txt")))?;
    let (delay_ps, path) = report::path(&text).map_err(unreadable)?;
    let read = |name: &str| {
        let file = std::fs::File::open(work.join(name)).map_err(at(&work.join(name)))?;
        Netlist::read(std::io::BufReader::new(file)).map_err(|error| unreadable(error.to_string()))
    };
    let netlist = read("netlist.json")?;
    let missing = || unreadable("no top in the netlist".into());
    let nets = netlist.fan_out().ok_or_else(missing)?;
    let report = netlist.report().ok_or_else(missing)?;
    let of_kind = |control: bool| nets.iter().filter(move |net| net.control == control);
    Ok(PartTiming {
        module: module.trim_start_matches('\\').into(),
        delay_ps,
        levels: path.iter().filter(|step| report::is_logic(&step.cell)).count(),
        path,
        kinds: netlist.kinds(&read("delays.json")?).ok_or_else(missing)?.into_iter().take(KINDS).collect(),
        strays: netlist.strays(GROUP_BANKS).ok_or_else(missing)?,
        crossed: netlist.crossed(GROUP_BANKS).ok_or_else(missing)?,
        control_loads: of_kind(true).map(|net| net.loads).max().unwrap_or(0),
        nets: of_kind(true).take(NETS).chain(of_kind(false).take(NETS)).cloned().collect(),
        accumulating_dsps: report.accumulators_inside(),
        dsps: report.dsps.len(),
        registered_dsps: report.dsps.iter().filter(|dsp| dsp.is_registered()).count(),
        free_operations: report.dsps.iter().filter(|dsp| dsp.free_operation).count(),
        cells: report.cells,
    })
}

/// Times what was mapped, its block RAMs with the output registers that they have.
fn with_output_registers(work: &Path) -> Result<(), Error> {
    let (from, to) = (work.join("netlist.json"), work.join("timed.json"));
    let file = std::fs::File::open(&from).map_err(at(&from))?;
    let mut netlist: serde_json::Value = serde_json::from_reader(std::io::BufReader::new(file))
        .map_err(|error| unreadable(error.to_string()))?;
    output_registers::take_in(&mut netlist);
    std::fs::write(&to, netlist.to_string()).map_err(at(&to))?;
    // A type of their own: Yosys' library has both delays, whatever a block RAM's parameters say.
    let types: String = output_registers::BLOCK_RAMS
        .iter()
        .map(|ram| {
            let with = format!("{ram}{}", output_registers::WITH_REGISTERS);
            format!("copy {ram} {with}\ndelete ={with}/r:T_RISE_MAX={OUT_WITHOUT_REGISTER_PS}\n")
        })
        .collect();
    let script = format!(
        "read_json timed.json\nread_verilog -lib -specify +/xilinx/cells_sim.v\n{types}tee -q -o sta.txt sta\n"
    );
    run(&script, "time.ys", work)
}

/// Picoseconds from a block RAM's clock to its output without an output register, in Yosys' library.
const OUT_WITHOUT_REGISTER_PS: u64 = 2454;

pub(super) fn run(script: &str, name: &str, dir: &Path) -> Result<(), Error> {
    std::fs::write(dir.join(name), script).map_err(at(&dir.join(name)))?;
    tool::run(tool::command("yosys", dir).args(["-q", "-s", name])).map(drop)
}

pub(super) fn unreadable(problem: String) -> Error {
    Error::Output { tool: "yosys".into(), problem }
}
