//! What can go wrong between Verilog text and a simulation's outputs.

use edof_core::storage::atomic::reason;
use std::path::{Path, PathBuf};

/// Why a design was not built, run, checked or mapped.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum Error {
    /// A program that we need is not installed.
    #[error(
        "{tool} not found: install it by 'apt-get install {}', or all tools by `source scripts/prepare.sh; need_simulators`",
        package(tool)
    )]
    ToolMissing { tool: String },
    /// A program that the system does not start.
    #[error("{tool}: cannot start: {}", reason(source))]
    NotStarted { tool: String, source: std::io::Error },
    /// A program rejected its input; the lines are its own, with file and line where it gave them.
    #[error("{tool} failed: {}", lines.join("; "))]
    ToolFailed { tool: String, lines: Vec<String> },
    /// Verilator has something to say about the text of the design.
    #[error("{0}")]
    Lint(crate::finding::Findings),
    /// The description of the design is wrong.
    #[error("design {top}: {problem}")]
    Source { top: String, problem: String },
    /// A port or a row that the design does not have.
    #[error("{0}")]
    Port(String),
    /// The simulation itself stopped, for instance for a memory image that is not there.
    #[error("simulation stopped: {0}")]
    Stopped(String),
    /// A block or the model beside it broke a rule of a port (`bench`).
    #[error("{port}, edge {edge}: {rule}")]
    Rule { port: String, edge: u64, rule: String },
    /// A compiled model could not be loaded.
    #[error("{}: {problem}", path.display())]
    Load { path: PathBuf, problem: String },
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    /// A router, or what it needs, is missing.
    #[error("{0}")]
    Router(String),
    /// A simulator or a synthesizer gave something that we cannot read.
    #[error("{tool} gave something unexpected: {problem}")]
    Output { tool: String, problem: String },
}

/// The Debian package that a program is in.
fn package(tool: &str) -> &str {
    match tool {
        "iverilog" | "vvp" => "iverilog",
        "c++" => "g++",
        tool => tool,
    }
}

/// For `map_err` on operations on one file.
pub(crate) fn at(path: &Path) -> impl Fn(std::io::Error) -> Error + '_ {
    move |source| Error::File { path: path.into(), source }
}
