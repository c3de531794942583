//! A hard case, as data: its purpose, its input, the possible fault, and the acceptance limit.

mod trial;

pub use trial::*;

use edof_core::storage::json;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// One case of the suite, as its file holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the case: small letters, digits and dashes.
    pub id: String,
    /// Why it is there, in one line.
    pub intent: String,
    /// What could go wrong.
    pub danger: String,
    /// What is run.
    pub trial: Trial,
    /// Acceptance limit.
    pub promise: Promise,
    /// Whether the case is slow: the quick run leaves it out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slow: bool,
}

/// Acceptance limit of everything that a case runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Promise {
    /// The same result as the reference, to an error in the units that the trial states.
    Same {
        /// The largest difference.
        error: f64,
        /// Why this much.
        because: String,
        /// Methods that may be further off, by the beginning of their names.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        except: Vec<Exception>,
    },
    /// The same result to an error that follows from formats and weights before anything is run.
    Bounded {
        /// From what it follows.
        because: String,
    },
    /// A loss of N dB at most.
    Graceful {
        /// The largest loss.
        db: f64,
        /// Loss against what, and why this much.
        because: String,
        /// Methods that may lose more, by the beginning of their names.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        except: Vec<Exception>,
    },
    /// An error whose message contains these words.
    Refused {
        /// A part of the message.
        says: String,
    },
}

/// A method with a limit of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exception {
    /// The beginning of its name.
    pub method: String,
    /// The largest error or loss.
    pub limit: f64,
    /// Why this much.
    pub because: String,
}

impl Promise {
    /// In a few words.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Same { error, .. } => format!("same, to {}", short(*error)),
            Self::Bounded { .. } => "same, to a bound told before".to_owned(),
            Self::Graceful { db, .. } => format!("loses {db} dB at most"),
            Self::Refused { says } => format!("refused: “{says}”"),
        }
    }

    /// Why the limit is what it is.
    #[must_use]
    pub fn because(&self) -> String {
        match self {
            Self::Same { because, except, .. } | Self::Graceful { because, except, .. } => {
                let each = |e: &Exception| format!("; {}: {}, {}", e.method, short(e.limit), e.because);
                format!("{because}{}", except.iter().map(each).collect::<String>())
            }
            Self::Bounded { because } => because.clone(),
            Self::Refused { .. } => "what cannot be right is not run".to_owned(),
        }
    }

    /// The limit for one method or solver; none for bounds that the trial computes and for rejected inputs.
    #[must_use]
    pub fn limit(&self, subject: &str) -> Option<f64> {
        let own = |limit: f64, except: &[Exception]| {
            let own = except.iter().find(|e| subject.starts_with(&e.method));
            Some(own.map_or(limit, |e| e.limit))
        };
        match self {
            Self::Same { error, except, .. } => own(*error, except),
            Self::Graceful { db, except, .. } => own(*db, except),
            Self::Bounded { .. } | Self::Refused { .. } => None,
        }
    }
}

/// A number with three digits that matter.
#[must_use]
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..1e5).contains(&size) => {
            let decimals = (2.0 - size.log10().floor()).clamp(0.0, 4.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.1e}"),
    }
}

/// Cases that cannot be read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CasesError {
    /// A folder or file.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Text that holds no cases.
    #[error("{file}: not a list of cases: {source}")]
    Parse { file: String, source: json::JsonError },
    /// Two of one name, or an invalid name.
    #[error("{file}: case id '{id}': {why}")]
    Id { file: String, id: String, why: &'static str },
    /// Nothing.
    #[error("{0}: no case files (*.json) there")]
    None(String),
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../cases/", $name)))),*]
    };
}

/// Most bytes of a file of cases.
const MAX_BYTES: u64 = 1 << 24;

/// The files that come with the program.
const FILES: &[(&str, &str)] = files!(
    "bounds.json",
    "deblurring.json",
    "frames.json",
    "lenses.json",
    "numbers.json",
    "pursuits.json",
    "refusals.json",
    "sizes.json",
    "solves.json",
    "words.json",
);

/// The cases that come with the program.
///
/// # Errors
/// [`CasesError`] where they are broken, which a test would have found.
pub fn own() -> Result<Vec<Case>, CasesError> {
    read(FILES.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())))
}

/// The cases of all JSON files of a folder.
///
/// # Errors
/// [`CasesError`].
pub fn of_folder(folder: &Path) -> Result<Vec<Case>, CasesError> {
    let unreadable = |source| CasesError::Read { path: folder.to_owned(), source };
    let mut paths = vec![];
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            paths.push(path);
        }
    }
    paths.sort();
    if paths.is_empty() {
        return Err(CasesError::None(folder.display().to_string()));
    }
    let text = |path: PathBuf| match json::text(&path, MAX_BYTES) {
        Ok(text) => Ok((path.display().to_string(), text)),
        Err(source) => Err(CasesError::Read { path, source }),
    };
    read(paths.into_iter().map(text).collect::<Result<Vec<_>, _>>()?)
}

fn read(files: impl IntoIterator<Item = (String, String)>) -> Result<Vec<Case>, CasesError> {
    let mut all: Vec<Case> = vec![];
    let mut ids = BTreeSet::new();
    for (file, text) in files {
        let cases: Vec<Case> =
            json::parse(&text).map_err(|source| CasesError::Parse { file: file.clone(), source })?;
        for case in cases {
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            let why = if case.id.is_empty() || !case.id.chars().all(plain) {
                Some("must be of small letters, digits and dashes")
            } else if !ids.insert(case.id.clone()) {
                Some("is there twice")
            } else {
                None
            };
            if let Some(why) = why {
                return Err(CasesError::Id { file, id: case.id, why });
            }
            all.push(case);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_of_one_name_or_of_a_name_that_is_none_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |text: &str| {
            std::fs::write(folder.path().join("a.json"), text).unwrap();
            of_folder(folder.path()).unwrap_err().to_string()
        };
        let one = |id: &str| {
            format!(
                r#"{{"id": "{id}", "intent": "i", "danger": "d", "trial": {{"solve": "twin-inputs"}}, "promise": {{"bounded": {{"because": "b"}}}}}}"#
            )
        };
        assert!(refused(&format!("[{}, {}]", one("a"), one("a"))).ends_with("case id 'a': is there twice"));
        assert!(refused(&format!("[{}]", one("A b"))).contains("must be of small letters"));
        assert!(refused("[{}]").contains("not a list of cases: [0]: missing field"));
    }
}
