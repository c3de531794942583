//! What a design becomes on a 7-series FPGA, according to Yosys.

pub mod ecp5;
pub mod fan_out;
mod mapped;
mod netlist;
mod output_registers;
pub mod route;
pub mod timing;

use crate::error::{Error, at};
use crate::{Source, tool, work};
pub use mapped::mapped;
use netlist::Netlist;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How a design is mapped.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Options {
    /// Parameters of the top module and their values as Verilog text.
    pub parameters: Vec<(String, String)>,
    /// Where relative paths of `$readmemh` start; without it, in the working directory of the process.
    pub memory_dir: Option<PathBuf>,
}

/// How many cells of each type a mapped design has.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Cells(pub BTreeMap<String, usize>);

/// What a design was mapped to.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Report {
    /// All cells.
    pub cells: Cells,
    /// Every DSP48E1.
    pub dsps: Vec<Dsp>,
}

/// How one DSP48E1 is used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dsp {
    /// Name of the DSP in the netlist.
    pub name: String,
    /// The result is registered inside (PREG).
    pub registers_result: bool,
    /// The product is registered inside (MREG).
    pub registers_product: bool,
    /// Both factors are registered inside (AREG, BREG).
    pub registers_factors: bool,
    /// The Z multiplexer can select P: the sum comes back inside.
    pub sums_inside: bool,
    /// What chooses the operation comes from a flip-flop of this DSP's own that a tool may take in as OPMODEREG.
    pub free_operation: bool,
    /// P goes to a carry chain, by way of at most one LUT: something adds to it, or compares it, outside.
    pub feeds_carry: bool,
}

impl Dsp {
    /// The accumulator is inside: it is registered there and comes back there.
    #[must_use]
    pub const fn accumulates(&self) -> bool {
        self.registers_result && self.sums_inside
    }
}

impl Dsp {
    /// All registers that a multiplier has are used: no path leads through it.
    #[must_use]
    pub const fn is_registered(&self) -> bool {
        self.registers_factors && self.registers_product && self.registers_result
    }
}

impl Cells {
    /// Cells of one type.
    #[must_use]
    pub fn count(&self, cell: &str) -> usize {
        self.0.get(cell).copied().unwrap_or(0)
    }

    /// LUT sites: logic, distributed RAM and shift registers. Inverters are left out, as a LUT takes them in.
    #[must_use]
    pub fn luts(&self) -> usize {
        self.0.iter().map(|(cell, count)| lut_sites(cell) * count).sum()
    }

    /// Flip-flops.
    #[must_use]
    pub fn flip_flops(&self) -> usize {
        ["FDRE", "FDSE", "FDCE", "FDPE", "FDRE_1", "FDSE_1", "FDCE_1", "FDPE_1"]
            .iter()
            .map(|cell| self.count(cell))
            .sum()
    }
}

impl Report {
    /// DSP48E1 whose accumulator is inside.
    #[must_use]
    pub fn accumulators_inside(&self) -> usize {
        self.dsps.iter().filter(|dsp| dsp.accumulates()).count()
    }
}

/// LUT sites that a cell takes (UG474, tables 2-2 to 2-5).
fn lut_sites(cell: &str) -> usize {
    match cell {
        "LUT1" | "LUT2" | "LUT3" | "LUT4" | "LUT5" | "LUT6" | "SRL16E" | "SRLC16E" | "SRLC32E" => 1,
        "RAM16X1S" | "RAM32X1S" | "RAM64X1S" => 1,
        "RAM16X1D" | "RAM32X1D" | "RAM64X1D" | "RAM128X1S" => 2,
        "RAM32M" | "RAM64M" | "RAM128X1D" | "RAM256X1S" => 4,
        _ => 0,
    }
}

/// Maps the design flat by `synth_xilinx -family xc7`, without buffers for pins and clocks.
///
/// # Errors
/// Yosys is missing or rejects the design.
pub fn synthesize(source: &Source, options: &Options) -> Result<Report, Error> {
    let work = work::folder()?;
    source.write(work.path())?;
    run_script(&commands(source, options, work.path()), options, work.path())?;
    let path = work.path().join("netlist.json");
    let file = std::fs::File::open(&path).map_err(at(&path))?;
    let unexpected = |problem: String| Error::Output { tool: "yosys".into(), problem };
    let netlist =
        Netlist::read(std::io::BufReader::new(file)).map_err(|error| unexpected(error.to_string()))?;
    netlist.report().ok_or_else(|| unexpected("no top in the netlist".into()))
}

/// Runs commands of Yosys; relative paths of memory images start where the options say.
fn run_script(commands: &str, options: &Options, work: &Path) -> Result<(), Error> {
    let script = work.join("commands.ys");
    std::fs::write(&script, commands).map_err(at(&script))?;
    let dir = options.memory_dir.as_deref().unwrap_or(Path::new("."));
    tool::run(tool::command("yosys", dir).arg("-q").arg("-s").arg(&script)).map(drop)
}

/// The files of a design that was written to `work`, as Yosys is given them.
fn files(source: &Source, work: &Path) -> String {
    let files = source.file_names().filter(|name| !name.ends_with(".vh"));
    let files: Vec<String> = files.map(|name| format!("\"{}\"", work.join(name).display())).collect();
    files.join(" ")
}

/// The parameters of the top, as `hierarchy` is given them.
fn parameters(options: &Options) -> String {
    options.parameters.iter().map(|(name, value)| format!(" -chparam {name} {value}")).collect()
}

/// Modules are elaborated once their parameters are known: before, a memory image may have no name.
fn commands(source: &Source, options: &Options, work: &Path) -> String {
    let language = if source.file_names().any(|name| name.ends_with(".sv")) { "-sv " } else { "" };
    [
        format!("read_verilog {language}-defer {}\n", files(source, work)),
        format!("hierarchy -top {}{}\n", source.top, parameters(options)),
        "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf\n".into(),
        format!("write_json \"{}\"\n", work.join("netlist.json").display()),
    ]
    .concat()
}
