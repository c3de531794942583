//! A design as the simulators take it: Verilog files and the ports of the top module.

use crate::error::{Error, at};
use std::collections::BTreeSet;
use std::path::Path;

/// Which way a port goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Into the design.
    In,
    /// Out of the design.
    Out,
}

/// A port of the top module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// Name of the port in Verilog.
    pub name: String,
    /// Which way it goes.
    pub direction: Direction,
    /// Width of the port, at least 1.
    pub bits: usize,
    /// Whether `tick` and `rise` move it.
    pub is_clock: bool,
}

impl Port {
    /// An input that a stimulus gives.
    #[must_use]
    pub fn input(name: &str, bits: usize) -> Self {
        Self { name: name.into(), direction: Direction::In, bits, is_clock: false }
    }

    /// An output.
    #[must_use]
    pub fn output(name: &str, bits: usize) -> Self {
        Self { name: name.into(), direction: Direction::Out, bits, is_clock: false }
    }

    /// A clock.
    #[must_use]
    pub fn clock(name: &str) -> Self {
        Self { name: name.into(), direction: Direction::In, bits: 1, is_clock: true }
    }

    /// 32-bit words that its value takes.
    #[must_use]
    pub const fn words(&self) -> usize {
        self.bits.div_ceil(32)
    }
}

/// Verilog text and the ports of its top module. A port is known by its place in `ports`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the top module.
    pub top: String,
    /// File names without directory, and their text.
    pub files: Vec<(String, String)>,
    /// Ports of the top module, in any order.
    pub ports: Vec<Port>,
}

impl Source {
    /// The place of the port of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn port(&self, name: &str) -> Result<usize, Error> {
        let found = self.ports.iter().position(|port| port.name == name);
        found.ok_or_else(|| Error::Port(format!("{} has no port {name}", self.top)))
    }

    /// Writes the files into a directory that exists.
    ///
    /// # Errors
    /// The description is wrong (an odd name, a port twice), or a file cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), Error> {
        self.check()?;
        for (name, text) in &self.files {
            let path = dir.join(name);
            std::fs::write(&path, text).map_err(at(&path))?;
        }
        Ok(())
    }

    /// File names, in order.
    pub(crate) fn file_names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    /// Rejects text that the tools would misunderstand.
    fn check(&self) -> Result<(), Error> {
        let refuse = |problem: String| Err(Error::Source { top: self.top.clone(), problem });
        if !is_identifier(&self.top) {
            return refuse("the name of the top must be letters, digits and underscores".into());
        }
        if let Some(name) = self.file_names().find(|name| !is_file_name(name)) {
            return refuse(format!("file {name:?}: must be a plain name ending in .v, .sv or .vh"));
        }
        if let Some(name) = first_twice(self.file_names()) {
            return refuse(format!("file {name} is there twice"));
        }
        if let Some(name) = first_twice(self.ports.iter().map(|port| port.name.as_str())) {
            return refuse(format!("port {name} is there twice"));
        }
        match self.ports.iter().find_map(|port| wrong_port(port).map(|why| (port, why))) {
            Some((port, why)) => refuse(format!("port {:?}: {why}", port.name)),
            None => Ok(()),
        }
    }
}

fn wrong_port(port: &Port) -> Option<&'static str> {
    match port {
        port if !is_identifier(&port.name) => Some("the name must be letters, digits and underscores"),
        port if port.bits == 0 => Some("must have at least one bit"),
        port if port.is_clock && (port.bits, port.direction) != (1, Direction::In) => {
            Some("a clock must be an input of one bit")
        }
        _ => None,
    }
}

fn is_identifier(name: &str) -> bool {
    let starts_well = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    starts_well && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Starts with a letter or underscore, so that no tool takes it for an option.
fn is_file_name(name: &str) -> bool {
    let stem = [".v", ".sv", ".vh"].iter().find_map(|end| name.strip_suffix(end));
    stem.is_some_and(|stem| is_identifier(&stem.replace(['.', '-'], "_")) && !stem.starts_with(['.', '-']))
}

fn first_twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut seen = BTreeSet::new();
    names.into_iter().find(|name| !seen.insert(*name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(files: &[&str], ports: Vec<Port>) -> String {
        let files = files.iter().map(|&name| (name.into(), String::new())).collect();
        Source { top: "top".into(), files, ports }.check().unwrap_err().to_string()
    }

    #[test]
    fn what_tools_would_misunderstand_is_rejected() {
        for (found, expected) in [
            (
                refusal(&["../a.v"], vec![]),
                r#"design top: file "../a.v": must be a plain name ending in .v, .sv or .vh"#,
            ),
            (
                refusal(&["-f.v"], vec![]),
                r#"design top: file "-f.v": must be a plain name ending in .v, .sv or .vh"#,
            ),
            (refusal(&["a.v", "a.v"], vec![]), "design top: file a.v is there twice"),
            (
                refusal(&[], vec![Port::input("a b", 1)]),
                r#"design top: port "a b": the name must be letters, digits and underscores"#,
            ),
            (refusal(&[], vec![Port::output("a", 0)]), r#"design top: port "a": must have at least one bit"#),
            (
                refusal(&[], vec![Port { bits: 2, ..Port::clock("c") }]),
                r#"design top: port "c": a clock must be an input of one bit"#,
            ),
            (
                refusal(&[], vec![Port::input("a", 1), Port::output("a", 1)]),
                "design top: port a is there twice",
            ),
        ] {
            assert_eq!(found, expected);
        }
    }
}
