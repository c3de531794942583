//! Instances of hand-written Verilog modules, for what rust-hdl has no word for: memories, multipliers, synchronisers.
//!
//! A leaf block is a rust-hdl block whose `hdl()` is [`Leaf::verilog`] and whose `update()` is the leaf's behavioural model.
//! The backend prints a leaf as one instance in its parent, and lists its module as needed. A leaf carries its own text: the backend checks ports and
//! parameters against the text, and reads from the text which outputs follow which inputs within a cycle.
//!
//! ```
//! use edof_verilog::leaf::Leaf;
//! const TEXT: &str = "module ram (input wire clock_i, input wire [3:0] address_i, output reg [7:0] data_o);\n…\nendmodule";
//! let leaf = Leaf::new("ram", TEXT).port("clock_i", "clock").port("address_i", "address").port("data_o", "data");
//! assert_eq!(Leaf::of(&leaf.verilog()), Some(leaf));
//! ```

use rust_hdl::prelude::{Verilog, Wrapper};

/// First word of the code of a leaf, by which the backend recognises it.
const MARK: &str = "leaf";

/// An instance of a hand-written Verilog module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Name of the module, for instance `ram`.
    pub module: String,
    /// Verilog of the module. Modules that it instantiates may follow in the same text; an instance of a module whose text is missing
    /// is taken to connect every input with every output within the cycle.
    pub source: String,
    /// Parameters and their values as Verilog text.
    pub parameters: Vec<(String, String)>,
    /// Verilog port and the field of the block that is connected to it.
    pub ports: Vec<(String, String)>,
    /// For a leaf between clock domains: Verilog port and the clock port to whose domain it belongs. A port that is not listed may be
    /// connected to any domain.
    pub crossing: Option<Vec<(String, String)>>,
}

impl Leaf {
    /// The leaf `module` with its Verilog text, and with no parameters and ports yet.
    #[must_use]
    pub fn new(module: &str, source: &str) -> Self {
        Self {
            module: module.into(),
            source: source.into(),
            parameters: vec![],
            ports: vec![],
            crossing: None,
        }
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

    /// Declares a leaf that may connect clock domains, with the clock port of each port that belongs to a domain. The author of a leaf is
    /// responsible for its synchroniser; the backend lists every instance in [`crate::Emitted::crossings`].
    #[must_use]
    pub fn crossing(mut self, clocks: &[(&str, &str)]) -> Self {
        self.crossing = Some(clocks.iter().map(|(port, clock)| ((*port).into(), (*clock).into())).collect());
        self
    }

    /// The clock port to whose domain a port of a crossing belongs.
    pub(crate) fn clock_of(&self, port: &str) -> Option<&str> {
        let clocks = self.crossing.as_ref()?;
        clocks.iter().find(|(name, _)| name == port).map(|(_, clock)| clock.as_str())
    }

    /// Return value of the block's `hdl()`. One line each: mark and module, parameters, ports, clocks of a crossing.
    #[must_use]
    pub fn verilog(&self) -> Verilog {
        let mut code = format!("{MARK} {}\n", self.module);
        self.parameters.iter().for_each(|(name, value)| code += &format!("# {name} {value}\n"));
        self.ports.iter().for_each(|(port, field)| code += &format!(". {port} {field}\n"));
        if let Some(clocks) = &self.crossing {
            code += "crossing\n";
            clocks.iter().for_each(|(port, clock)| code += &format!("~ {port} {clock}\n"));
        }
        Verilog::Wrapper(Wrapper { code, cores: self.source.clone() })
    }

    /// Reads [`Leaf::verilog`] back; `None` where the code is something else.
    #[must_use]
    pub fn of(verilog: &Verilog) -> Option<Self> {
        let Verilog::Wrapper(wrapper) = verilog else { return None };
        let mut lines = wrapper.code.lines();
        let mut leaf = Self::new(lines.next()?.strip_prefix(MARK)?.trim(), &wrapper.cores);
        for line in lines {
            let mut words = line.splitn(3, ' ');
            let list = match words.next()? {
                "#" => &mut leaf.parameters,
                "." => &mut leaf.ports,
                "~" => leaf.crossing.as_mut()?,
                "crossing" => {
                    leaf.crossing = Some(vec![]);
                    continue;
                }
                _ => return None,
            };
            list.push((words.next()?.into(), words.next()?.into()));
        }
        Some(leaf)
    }
}

/// Which outputs of the first module of `text` may follow which inputs within a cycle: (input, output). Empty for a leaf with registered outputs.
///
/// # Errors
/// What of the text is not understood.
pub fn paths(text: &str) -> Result<Vec<(String, String)>, String> {
    crate::leaf_text::LeafText::read(text).map(|leaf| leaf.paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_read_back_as_it_was_written() {
        let leaf = Leaf::new("ram", "module ram (); endmodule")
            .parameter("DEPTH", 96)
            .text("INIT", "mem/a b.mem")
            .port("clock_i", "clock")
            .port("data_o", "data");
        assert_eq!(Leaf::of(&leaf.verilog()), Some(leaf.clone()));
        for clocks in [&[][..], &[("data_o", "clock_i")]] {
            let crossing = leaf.clone().crossing(clocks);
            assert_eq!(Leaf::of(&crossing.verilog()), Some(crossing));
        }
        assert_eq!(Leaf::of(&Verilog::Empty), None);
    }
}
