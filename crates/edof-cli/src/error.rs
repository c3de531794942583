//! The one line that a failure prints.

use edof_core::storage::folder::FolderError;
use std::fmt;

/// Why a sub-command stopped: any error of ours, a message, or Ctrl-C. Always shown as one line.
///
/// Every `std::error::Error` converts with `?`, so it cannot be one itself.
#[derive(Debug)]
pub enum Error {
    /// Something was rejected or failed.
    Failed(Box<dyn std::error::Error + Send + Sync>),
    /// The user pressed Ctrl-C.
    Interrupted,
}

impl Error {
    /// A failure in the program's own words: place, value found, and value expected.
    pub fn message(text: impl Into<String>) -> Self {
        Self::Failed(text.into().into())
    }

    /// A folder that `--out` names and that is not written.
    pub fn of_folder(error: FolderError) -> Self {
        match error {
            FolderError::Write(line) => Self::message(line),
            refused => Self::message(format!("--out {refused}")),
        }
    }

    /// Whether the reader of our output went away, as in `edof … | head`: no failure of ours.
    pub fn is_broken_pipe(&self) -> bool {
        let Self::Failed(error) = self else { return false };
        error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    }

    /// A program of the system that is not installed, if that is why.
    pub fn missing_tool(&self) -> Option<&str> {
        let Self::Failed(error) = self else { return None };
        match error.downcast_ref::<edof_cosim::Error>() {
            Some(edof_cosim::Error::ToolMissing { tool }) => Some(tool),
            _ => None,
        }
    }

    /// Exit status of the program.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Failed(_) => 1,
            Self::Interrupted => 130,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failed(error) => f.write_str(&one_line(&error.to_string())),
            Self::Interrupted => f.write_str("interrupted"),
        }
    }
}

impl<E: std::error::Error + Send + Sync + 'static> From<E> for Error {
    fn from(error: E) -> Self {
        Self::Failed(Box::new(error))
    }
}

/// Text from parsers and libraries may hold line breaks; file names may hold control characters.
fn one_line(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let line: String = lines.join("; ").chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    without_numbers(&line)
}

/// What the system says comes with its number as the standard library writes it, which helps nobody.
fn without_numbers(line: &str) -> String {
    let mut parts = line.split(" (os error ");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once(')') {
            Some((number, rest)) if number.chars().all(|c| c.is_ascii_digit()) => text += rest,
            _ => text += &format!(" (os error {part}"),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_several_lines_is_shown_as_one() {
        assert_eq!(Error::message("first\n  second\n").to_string(), "first; second");
        let told = Error::message("a: No such file or directory (os error 2); b: (os error x)").to_string();
        assert_eq!(told, "a: No such file or directory; b: (os error x)");
    }

    #[test]
    fn a_closed_pipe_is_distinguished_from_other_failures() {
        let closed = Error::from(std::io::Error::from(std::io::ErrorKind::BrokenPipe));
        assert!(closed.is_broken_pipe() && !Error::message("x").is_broken_pipe());
    }
}
