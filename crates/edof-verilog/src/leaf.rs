//! Instances of the hand-written Verilog leaves in `rtl/`: what rust-hdl has no word for.
//!
//! A leaf block is a rust-hdl block whose `hdl()` is [`Leaf::verilog`] and whose `update()` is the leaf's behavioural model.
//! The backend prints it as one instance in its parent, and lists the leaf's file as needed. It carries the leaf's own text, to
//! which the backend holds ports and parameters, and in which it sees which outputs follow which inputs within a cycle.

use crate::leaves::LEAVES;
use rust_hdl::prelude::{Verilog, Wrapper};

/// First word of the code of a leaf, by which the backend knows it.
const MARK: &str = "leaf";

/// An instance of a Verilog module in `rtl/`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Name of the module and of its file, for instance `edof_ram`.
    pub module: String,
    /// The file.
    pub source: String,
    /// Parameters and their values as Verilog text.
    pub parameters: Vec<(String, String)>,
    /// Verilog port and the block's field that it is.
    pub ports: Vec<(String, String)>,
}

impl Leaf {
    /// The leaf `module`, with no parameters and ports yet. Its file is one of [`LEAVES`], unless [`Leaf::source`] gives another.
    #[must_use]
    pub fn new(module: &str) -> Self {
        let source = LEAVES.iter().find(|(name, _)| *name == module).map_or("", |(_, text)| text);
        Self { module: module.into(), source: source.into(), parameters: vec![], ports: vec![] }
    }

    /// The text of a leaf that is not one of ours.
    #[must_use]
    pub fn source(mut self, text: &str) -> Self {
        self.source = text.into();
        self
    }

    /// A whole-number parameter.
    #[must_use]
    pub fn parameter(mut self, name: &str, value: usize) -> Self {
        self.parameters.push((name.into(), value.to_string()));
        self
    }

    /// A text parameter, such as the path of a memory image.
    #[must_use]
    pub fn text(mut self, name: &str, value: &str) -> Self {
        self.parameters.push((name.into(), format!("\"{value}\"")));
        self
    }

    /// Connects the Verilog port to a field of the block.
    #[must_use]
    pub fn port(mut self, verilog: &str, field: &str) -> Self {
        self.ports.push((verilog.into(), field.into()));
        self
    }

    /// What the block's `hdl()` gives. One line each: mark and module, parameters, ports.
    #[must_use]
    pub fn verilog(&self) -> Verilog {
        let mut code = format!("{MARK} {}\n", self.module);
        self.parameters.iter().for_each(|(name, value)| code += &format!("# {name} {value}\n"));
        self.ports.iter().for_each(|(port, field)| code += &format!(". {port} {field}\n"));
        Verilog::Wrapper(Wrapper { code, cores: self.source.clone() })
    }

    /// Reads [`Leaf::verilog`] back; none where the code is something else.
    #[must_use]
    pub fn of(verilog: &Verilog) -> Option<Self> {
        let Verilog::Wrapper(wrapper) = verilog else { return None };
        let mut lines = wrapper.code.lines();
        let module = lines.next()?.strip_prefix(MARK)?.trim().into();
        let mut leaf = Self { module, source: wrapper.cores.clone(), parameters: vec![], ports: vec![] };
        for line in lines {
            let mut words = line.splitn(3, ' ');
            let list = match words.next()? {
                "#" => &mut leaf.parameters,
                "." => &mut leaf.ports,
                _ => return None,
            };
            list.push((words.next()?.into(), words.next()?.into()));
        }
        Some(leaf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_read_back_as_it_was_written() {
        let leaf = Leaf::new("edof_ram")
            .parameter("DEPTH", 96)
            .text("INIT", "mem/a b.hex")
            .port("clock_i", "clock")
            .port("data_o", "data");
        assert!(leaf.source.contains("module edof_ram"));
        assert_eq!(Leaf::of(&leaf.verilog()), Some(leaf));
        assert_eq!(Leaf::of(&Verilog::Empty), None);
    }
}
