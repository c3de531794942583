//! The line above rows: of what study they are, and which program measured them on which machine.

use super::{JournalError, Line};
use edof_core::storage::provenance::Host;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What rows have in common: the line above them. It holds for the rows below it, up to the next such line.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Header {
    /// Name of the study, as in `single-depth`.
    pub study: String,
    /// Version of the rows' layout.
    pub layout: u32,
    /// What measured them.
    pub maker: Maker,
}

/// What measured rows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Maker {
    /// A program of a known revision.
    Program(Program),
    /// A program that did not state itself: rows of layout 1.
    Old {
        /// Whole kernels.
        exact: bool,
        /// CPU and threads.
        machine: String,
    },
}

/// A program and the machine that it ran on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Git revision of its sources, followed by `-dirty` and a hash of the difference where they differed; `unknown` outside of git.
    pub revision: String,
    /// Version of the compiler, as in `rustc 1.95.0 (…)`.
    pub compiler: String,
    /// CPU with family and model, instruction sets, threads.
    pub host: Host,
}

/// A file of rows, by its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowsFile {
    /// How many rows it holds.
    pub rows: usize,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Where git has the file, as in `REVISION:docs/results/blind.jsonl`, if it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub git: Option<String>,
}

/// A header as files hold it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    study: String,
    layout: u32,
    revision: Option<String>,
    compiler: Option<String>,
    host: Option<Host>,
    exact: Option<bool>,
    machine: Option<String>,
}

impl TryFrom<Stored> for Header {
    type Error = String;

    fn try_from(stored: Stored) -> Result<Self, String> {
        let Stored { study, layout, revision, compiler, host, exact, machine } = stored;
        let maker = match (revision, compiler, host, exact, machine) {
            (Some(revision), Some(compiler), Some(host), None, None) => {
                Maker::Program(Program { revision, compiler, host })
            }
            (None, None, None, Some(exact), Some(machine)) => Maker::Old { exact, machine },
            _ => return Err("expected revision, compiler and host, or exact and machine".into()),
        };
        Ok(Self { study, layout, maker })
    }
}

impl Serialize for Header {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Written<'a> {
            study: &'a str,
            layout: u32,
            #[serde(flatten)]
            maker: &'a Maker,
        }
        Written { study: &self.study, layout: self.layout, maker: &self.maker }.serialize(to)
    }
}

impl Maker {
    /// CPU and threads, as tables state whose times they hold.
    #[must_use]
    pub fn machine(&self) -> String {
        match self {
            Self::Program(program) => program.machine(),
            Self::Old { machine, .. } => machine.clone(),
        }
    }
}

impl Program {
    /// CPU and threads, as tables state whose times they hold.
    #[must_use]
    pub fn machine(&self) -> String {
        let Host { cpu, family, model, threads, .. } = &self.host;
        let numbers =
            family.zip(*model).map_or_else(String::new, |(f, m)| format!(" (family {f}, model {m})"));
        let threads = threads.map_or_else(String::new, |n| format!(", {n} threads"));
        format!("{cpu}{numbers}{threads}")
    }

    /// Whether another one runs on an equal machine: only there times compare and sums have the same LSB.
    #[must_use]
    pub fn is_on_the_machine_of(&self, other: &Self) -> bool {
        self.host == other.host
    }

    /// Whether another one was built from the same sources by the same compiler. This is unknown for a program from outside of git.
    #[must_use]
    pub fn is_built_as(&self, other: &Self) -> bool {
        self.revision != UNKNOWN && self.revision == other.revision && self.compiler == other.compiler
    }
}

/// What a header begins with, and no row.
const BEGINNING: &str = "{\"study\":";

/// Revision of a program that was built outside of git.
pub const UNKNOWN: &str = "unknown";

impl Header {
    /// The line above rows of `L` that `program` measures.
    #[must_use]
    pub fn of<L: Line>(program: Program) -> Self {
        Self { study: L::STUDY.into(), layout: L::LAYOUT, maker: Maker::Program(program) }
    }

    /// The first line of a file.
    ///
    /// # Errors
    /// [`JournalError::Read`], [`JournalError::Empty`] or [`JournalError::Line`].
    pub fn read(path: &Path) -> Result<Self, JournalError> {
        let missing =
            || JournalError::Read { path: path.to_owned(), source: std::io::Error::from_raw_os_error(2) };
        let text = super::file::read(path)?.ok_or_else(missing)?;
        let first = text.lines.first().ok_or_else(|| JournalError::Empty(path.to_owned()))?;
        super::parsed(path, 1, first)
    }

    /// Whether a line of a file is one.
    pub(super) fn is_at(line: &str) -> bool {
        line.starts_with(BEGINNING)
    }

    /// Whether bytes may be the beginning of one.
    pub(super) fn may_begin(bytes: &[u8]) -> bool {
        bytes.iter().zip(BEGINNING.as_bytes()).all(|(a, b)| a == b)
    }
}

impl std::fmt::Display for Header {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} ({}", self.study, self.layout, self.maker.machine())?;
        match &self.maker {
            Maker::Program(p) => write!(f, "; revision {}; {}; {})", p.revision, p.compiler, p.host.isa),
            Maker::Old { exact, .. } => {
                write!(f, "; {} kernels; revision not stated)", if *exact { "whole" } else { "cut" })
            }
        }
    }
}

#[cfg(test)]
impl Program {
    /// A program of a revision on a machine, for tests.
    pub(crate) fn stub(revision: &str, cpu: &str) -> Self {
        let host = Host { cpu: cpu.into(), threads: Some(2), ..Host::default() };
        Self { revision: revision.into(), compiler: "rustc".into(), host }
    }
}
