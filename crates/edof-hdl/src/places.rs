//! Where a project's Verilog comes from: file and line of the Rust behind its blocks.

use crate::project::Project;
use std::fmt::{self, Write};

/// Where something is driven, in Verilog and in Rust.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// File and line, for instance `stage.v:77`.
    pub verilog: String,
    /// Rust source line; empty if an instance drives the signal.
    pub rust: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, from {}", self.verilog, self.rust)
    }
}

impl Project {
    /// The source map as JSON: for each file of Verilog its Rust file, and runs of lines: first and last line of Verilog, line of Rust.
    #[must_use]
    pub fn source_map(&self) -> String {
        let file = |(name, map): (&String, &crate::verilog::SourceMap)| {
            let runs = map.runs().into_iter().map(|(first, last, rust)| format!("[{first}, {last}, {rust}]"));
            let runs = runs.collect::<Vec<_>>().join(", ");
            format!("  \"{name}\": {{ \"source\": \"{}\", \"lines\": [{runs}] }}", map.file)
        };
        let files: Vec<String> = self.sources.iter().map(file).collect();
        let mut text = String::from("{\n");
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}\n}}", files.join(",\n"));
        text
    }

    /// What drives an output of the block that these instances lead to from the top.
    #[must_use]
    pub fn driver(&self, instances: &[&str], port: &str) -> Option<Place> {
        let module =
            instances.iter().try_fold(self.top.clone(), |module, instance| self.part(&module, instance))?;
        let file = format!("{module}.v");
        let text = self.text(&file)?;
        let drives = |line: &str| {
            let line = line.trim_start();
            let is_assigned = line.starts_with("assign ") && line.contains(&format!(" {port} = "));
            is_assigned || line.starts_with(&format!("{port} ="))
        };
        let at = text
            .lines()
            .position(drives)
            .or_else(|| text.lines().position(|line| line.contains(&format!("_o({port})"))))?;
        let map = self.sources.get(&file)?;
        let line = map.lines.get(at).copied().flatten();
        let rust = line.map_or_else(|| map.file.clone(), |line| format!("{}:{line}", map.file));
        Some(Place { verilog: format!("{file}:{}", at + 1), rust })
    }

    fn text(&self, file: &str) -> Option<&str> {
        self.verilog.iter().find(|(name, _)| name == file).map(|(_, text)| text.as_str())
    }

    /// The module of an instance.
    fn part(&self, module: &str, instance: &str) -> Option<String> {
        let text = self.text(&format!("{module}.v"))?;
        let end = text.find(&format!(" {instance} ("))?;
        let start = |end: usize| text[..end].rfind('\n').map_or(0, |at| at + 1);
        let mut at = start(end);
        if text[at..end].trim().is_empty() {
            at = start(at - 1);
        }
        if text[at..].trim_start().starts_with(')') {
            at = start(text[..at].rfind("#(\n")?);
        }
        text[at..].split_whitespace().next().map(String::from)
    }
}
