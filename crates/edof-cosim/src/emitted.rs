//! What the backend printed, as a design for the simulators.

use crate::{Direction, Error, Port, Source};
use edof_hdl::describe::Circuit;
use edof_hdl::leaves::LEAVES;
use edof_hdl::project::Project;
use edof_hdl::verilog::{self, EmitError, Emitted};
use std::collections::BTreeMap;

impl Source {
    /// A circuit by itself, with the leaves of `rtl/` that it stands on.
    ///
    /// # Errors
    /// The circuit has no exact Verilog.
    pub fn circuit(circuit: &mut dyn Circuit) -> Result<Self, Error> {
        circuit.connect_all();
        let refuse =
            |error: EmitError| Error::Source { top: error.block.clone(), problem: error.to_string() };
        let emitted = verilog::emit(circuit).map_err(refuse)?;
        let leaf =
            |name: &str| LEAVES.iter().find(|(leaf, _)| *leaf == name).map(|(_, text)| (*text).to_string());
        Self::emitted(&emitted, leaf)
    }

    /// The modules, and the leaves that they stand on. `leaf` gives the text of `rtl/NAME.v`, if there is such a file.
    ///
    /// # Errors
    /// A leaf has no text.
    pub fn emitted(emitted: &Emitted, leaf: impl Fn(&str) -> Option<String>) -> Result<Self, Error> {
        let mut files: Vec<(String, String)> = leaves(emitted, leaf)?.into_iter().collect();
        let modules = emitted.modules.iter();
        files.extend(modules.map(|module| (format!("{}.v", module.name), module.text.clone())));
        let ports = emitted.ports.iter().map(Port::from).collect();
        Ok(Self { top: emitted.top.clone(), files, ports })
    }
}

impl From<&verilog::Port> for Port {
    fn from(port: &verilog::Port) -> Self {
        let direction = match port.direction {
            verilog::Direction::Input => Direction::In,
            verilog::Direction::Output => Direction::Out,
        };
        Self { name: port.name.clone(), direction, bits: port.bits, is_clock: port.is_clock }
    }
}

impl From<&Project> for Source {
    fn from(project: &Project) -> Self {
        let ports = project.ports.iter().map(Port::from).collect();
        Self { top: project.top.clone(), files: project.verilog.clone(), ports }
    }
}

/// Files of the leaves by name, with those that leaves stand on.
fn leaves(
    emitted: &Emitted,
    leaf: impl Fn(&str) -> Option<String>,
) -> Result<BTreeMap<String, String>, Error> {
    let mut files = BTreeMap::new();
    let mut wanted: Vec<String> = emitted.leaves.iter().cloned().collect();
    while let Some(name) = wanted.pop() {
        let Some(text) = leaf(&name) else {
            let problem = format!("there is no leaf {name}: it must be rtl/{name}.v");
            return Err(Error::Source { top: emitted.top.clone(), problem });
        };
        let parts = text.lines().filter_map(|line| line.split_whitespace().next());
        let parts: Vec<String> = parts.filter(|part| leaf(part).is_some()).map(String::from).collect();
        files.insert(format!("{name}.v"), text);
        wanted.extend(parts.into_iter().filter(|part| !files.contains_key(&format!("{part}.v"))));
    }
    Ok(files)
}
