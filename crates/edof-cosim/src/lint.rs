//! Verilator's opinion of a design.

use crate::error::{Error, at};
use crate::{Source, tool};
use std::fmt;
use std::path::Path;

/// One warning or error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Verilator's name of the warning, such as `WIDTH`; empty for an error.
    pub code: String,
    /// File, line and column, and what was said.
    pub text: String,
}

/// All that was found; never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LintErrors(pub Vec<Finding>);

/// So many are shown.
const SHOWN: usize = 5;

impl fmt::Display for LintErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, finding) in self.0.iter().take(SHOWN).enumerate() {
            let between = if i == 0 { "" } else { "; " };
            let code = if finding.code.is_empty() { "error" } else { &finding.code };
            write!(f, "{between}{code} {}", finding.text)?;
        }
        match self.0.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for LintErrors {}

/// Verilator with all warnings has nothing to say about the design. `waivers` is a configuration file (`.vlt`) that says which
/// warnings are meant.
///
/// # Errors
/// [`Error::Lint`] with what it says; or Verilator is missing.
pub fn clean(source: &Source, waivers: Option<&Path>) -> Result<(), Error> {
    let work = tempfile::tempdir().map_err(at(&std::env::temp_dir()))?;
    source.write(work.path())?;
    let mut command = tool::command("verilator", work.path());
    command.args(["--lint-only", "-Wall", "--top-module", &source.top]);
    if let Some(path) = waivers {
        command.arg(std::path::absolute(path).map_err(at(path))?);
    }
    let output = tool::output(command.args(source.file_names().filter(|name| !name.ends_with(".vh"))))?;
    let found = findings(&String::from_utf8_lossy(&output.stderr));
    match (found.is_empty(), output.status.success()) {
        (true, true) => Ok(()),
        (true, false) => {
            Err(Error::ToolFailed { tool: "verilator".into(), lines: vec![output.status.to_string()] })
        }
        _ => Err(Error::Lint(LintErrors(found))),
    }
}

/// `%Warning-CODE: text` and `%Error: text`, without the count at the end and the explanations between.
fn findings(complaint: &str) -> Vec<Finding> {
    let finding = |line: &str| {
        let (kind, text) = line.strip_prefix('%')?.split_once(": ")?;
        let code = kind.split_once('-').map_or("", |(_, code)| code);
        (!text.starts_with("Exiting due to")).then(|| Finding { code: code.into(), text: text.trim().into() })
    };
    complaint.lines().filter_map(finding).collect()
}
