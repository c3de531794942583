//! What a tool finds wrong with a design's text.

use std::fmt;

/// One warning or error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Verilator's name of the warning, such as `WIDTH`; empty for an error.
    pub rule: String,
    /// File, line and column, and what was said.
    pub text: String,
}

/// All that was found; never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Findings(pub Vec<Finding>);

/// Number of findings that are printed.
const SHOWN: usize = 5;

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, finding) in self.0.iter().take(SHOWN).enumerate() {
            let between = if i == 0 { "" } else { "; " };
            let rule = if finding.rule.is_empty() { "error" } else { &finding.rule };
            write!(f, "{between}{rule} {}", finding.text)?;
        }
        match self.0.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for Findings {}
