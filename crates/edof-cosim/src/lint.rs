//! Verilator's opinion of a design.

use crate::error::{Error, at};
use crate::finding::{Finding, Findings};
use crate::{Source, tool, work};
use std::path::Path;

/// Verilator with all warnings has nothing to say about the design. `waivers` is a configuration file (`.vlt`) that says which
/// warnings are meant.
///
/// # Errors
/// [`Error::Lint`] with what it says; or Verilator is missing.
pub fn clean(source: &Source, waivers: Option<&Path>) -> Result<(), Error> {
    let work = work::folder()?;
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
        _ => Err(Error::Lint(Findings(found))),
    }
}

/// `%Warning-RULE: text` and `%Error: text`, without the count at the end and the explanations between.
fn findings(complaint: &str) -> Vec<Finding> {
    let finding = |line: &str| {
        let (kind, text) = line.strip_prefix('%')?.split_once(": ")?;
        let rule = kind.split_once('-').map_or("", |(_, rule)| rule);
        (!text.starts_with("Exiting due to")).then(|| Finding { rule: rule.into(), text: text.trim().into() })
    };
    complaint.lines().filter_map(finding).collect()
}
