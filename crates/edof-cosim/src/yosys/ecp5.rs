//! A design after Yosys for an ECP5: its cells in place of the text, to be simulated.

use super::mapped::{models, with_known_contents, without};
use super::{Options, files, parameters, run_script};
use crate::error::{Error, at};
use crate::{Source, work};
use std::path::Path;

/// Commands from a known hierarchy to cells, and the maps that they read, as a generated directory has them.
pub const SYNTHESIS: [(&str, &str); 4] = [
    ("synth.ys", include_str!("../../../../project/ecp5/synth.ys")),
    ("weights_map.v", include_str!("../../../../project/ecp5/weights_map.v")),
    ("tables_map.v", include_str!("../../../../project/ecp5/tables_map.v")),
    ("output_register.v", include_str!("../../../../project/ecp5/output_register.v")),
];

/// Functional models of the cells of which Yosys has ports alone.
const CELLS: &str = include_str!("../../../../sim/cells/ecp5.v");

/// Returns a leaf or netlist with models of its cells: Yosys' own, and ours of multiplier and block RAM.
///
/// # Errors
/// Yosys' models are missing.
pub fn with_cells(source: Source) -> Result<Source, Error> {
    let path = models("ecp5")?;
    let text = std::fs::read_to_string(&path).map_err(at(&path))?;
    let text = without(&without(&text, "specify", "endspecify"), "(* blackbox *)", "endmodule");
    // What it includes has names of the vendor's for the same flip-flops.
    let text = format!("`define NO_INCLUDES\n{text}");
    let cells = [("cells.v", text), ("ecp5.v", CELLS.to_owned())];
    let cells = cells.map(|(name, text)| (name.to_owned(), text));
    Ok(Source { files: source.files.into_iter().chain(cells).collect(), ..source })
}

/// Returns the design mapped by such commands and maps ([`SYNTHESIS`]), with models of its cells. Contents that nothing states are 0.
///
/// # Errors
/// Yosys or its models are missing, or it rejects the design.
pub fn mapped(source: &Source, options: &Options, synthesis: &[(&str, &str)]) -> Result<Source, Error> {
    let work = work::folder()?;
    let dir = work.path();
    source.write(dir)?;
    let mut commands = String::new();
    for (name, text) in synthesis {
        let path = dir.join(name);
        std::fs::write(&path, text).map_err(at(&path))?;
        if Path::new(name).extension().is_some_and(|end| end == "ys") {
            commands += text;
        }
    }
    for (name, _) in synthesis {
        commands =
            commands.replace(&format!("-map {name}"), &format!("-map \"{}\"", dir.join(name).display()));
    }
    let netlist = dir.join("netlist.v");
    let script = [
        "read_verilog -lib -specify +/ecp5/cells_sim.v +/ecp5/cells_bb.v\n".into(),
        format!("read_verilog -defer {}\n", files(source, dir)),
        format!("hierarchy -top {}{}\n", source.top, parameters(options)),
        commands,
        format!("write_verilog -noattr \"{}\"\n", netlist.display()),
    ];
    run_script(&script.concat(), options, dir)?;
    let text = std::fs::read_to_string(&netlist).map_err(at(&netlist))?;
    with_cells(Source { files: vec![("netlist.v".into(), with_known_contents(&text))], ..source.clone() })
}
