//! A design after Yosys: the cells of a 7-series FPGA in place of its text, to be simulated.

use super::{Options, files, parameters, run_script};
use crate::error::{Error, at};
use crate::{Source, work};
use std::path::{Path, PathBuf};

/// Functional models of block RAMs, in place of Yosys' empty ones.
const BLOCK_RAM: &str = include_str!("../../../../sim/cells/block_ram.v");

/// A model of the carry chain that Verilator computes correctly, in place of Yosys' own.
const CARRY: &str = include_str!("../../../../sim/cells/carry.v");

/// Yosys 0.23 finds no cell for a ROM that must not be a block RAM; without the attribute it uses logic, as Vivado does.
const ROM_STYLE: &str = "(* rom_style = \"distributed\" *)";

/// The design laid flat and mapped by `synth_xilinx`, with models of its cells: Yosys' own, and ours of block RAMs. Top and ports stay; memory
/// images become part of the cells, and contents that nothing states are 0.
///
/// # Errors
/// Yosys or its models are missing, or it rejects the design.
pub fn mapped(source: &Source, options: &Options) -> Result<Source, Error> {
    let work = work::folder()?;
    let free = |(name, text): &(String, String)| (name.clone(), text.replace(ROM_STYLE, ""));
    Source { files: source.files.iter().map(free).collect(), ..source.clone() }.write(work.path())?;
    let netlist = work.path().join("netlist.v");
    let script = [
        format!("read_verilog -defer {}\n", files(source, work.path())),
        format!("hierarchy -top {}{}\n", source.top, parameters(options)),
        "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf\n".into(),
        format!("write_verilog -noattr \"{}\"\n", netlist.display()),
    ];
    run_script(&script.concat(), options, work.path())?;
    let text = std::fs::read_to_string(&netlist).map_err(at(&netlist))?;
    let files = [
        ("netlist.v", with_known_contents(&text)),
        ("cells.v", cells()?),
        ("block_ram.v", BLOCK_RAM.to_owned()),
        ("carry.v", CARRY.to_owned()),
    ];
    let files = files.map(|(name, text)| (name.to_owned(), text)).to_vec();
    Ok(Source { files, ..source.clone() })
}

/// A netlist whose registers and memories begin with 0 where nothing states what they hold: `.INIT_3A(256'hxx…01)`.
pub(super) fn with_known_contents(text: &str) -> String {
    let known = |line: &str| match line.split_once('\'') {
        Some((name, value)) if name.trim_start().starts_with(".INIT") => {
            format!("{name}'{}\n", value.replace('x', "0"))
        }
        _ => format!("{line}\n"),
    };
    text.lines().map(known).collect()
}

/// Yosys' models without what is about time alone, and without those of [`BLOCK_RAM`] and [`CARRY`].
fn cells() -> Result<String, Error> {
    let path = models("xilinx")?;
    let text = std::fs::read_to_string(&path).map_err(at(&path))?;
    let timeless = without(&text, "specify", "endspecify");
    let models = ["module RAMB18E1 ", "module RAMB36E1 ", "module CARRY4("];
    Ok(models.iter().fold(timeless, |text, start| without(&text, start, "endmodule")))
}

/// A family's `cells_sim.v` of the Yosys that is on the path.
pub(super) fn models(family: &str) -> Result<PathBuf, Error> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let program =
        std::env::split_paths(&folders).map(|folder| folder.join("yosys")).find(|path| path.is_file());
    let program = program.ok_or_else(|| Error::ToolMissing { tool: "yosys".into() })?;
    let folder = program.parent().and_then(Path::parent).unwrap_or(Path::new("/"));
    Ok(folder.join("share/yosys").join(family).join("cells_sim.v"))
}

/// The text without the lines from each one that begins so to the next one that ends it.
pub(super) fn without(text: &str, start: &str, end: &str) -> String {
    let (mut kept, mut is_inside) = (String::new(), false);
    for line in text.lines() {
        let word = line.trim_start();
        is_inside |= word.starts_with(start);
        if !is_inside {
            kept += line;
            kept.push('\n');
        }
        is_inside &= word != end;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_that_nothing_states_are_zero() {
        let text = "  FDRE #(\n    .INIT(1'hx)\n  ) x (\n    .INIT_0A(8'hx1),\n    .D(1'hx)\n";
        let expected = "  FDRE #(\n    .INIT(1'h0)\n  ) x (\n    .INIT_0A(8'h01),\n    .D(1'hx)\n";
        assert_eq!(with_known_contents(text), expected);
    }

    #[test]
    fn parts_are_left_out_from_their_first_line_to_their_last() {
        let text = "module a (\n  specify\n  $setup(b);\n  endspecify\nendmodule\nmodule b (\nendmodule\n";
        assert_eq!(without(text, "specify", "endspecify"), "module a (\nendmodule\nmodule b (\nendmodule\n");
        assert_eq!(without(text, "module a ", "endmodule"), "module b (\nendmodule\n");
    }
}
