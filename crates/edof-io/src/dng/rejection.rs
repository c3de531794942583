//! Reasons for which a DNG is not read.

use super::tags::Tag;
use crate::camera_raw::CameraRawError;
use crate::levels::LevelsError;
use edof_core::words;
use std::path::Path;

/// What to do with a file of a kind that is not read.
const REMEDY: &str = "convert it to a DNG without this, or to a 16-bit PNG, TIFF or PGM of its mosaic";

/// Why a file cannot be used.
#[derive(Debug)]
pub enum Rejection {
    /// A tag has a value with which the picture would be another one.
    Value { tag: Tag, found: String, expected: String },
    /// A tag's numbers are not what the specification allows.
    Wrong { tag: Tag, found: String, expected: String },
    /// A tag without which there is no picture.
    Missing { tag: Tag, what: &'static str },
    /// The file ends before something does.
    Cut(String),
    /// Another mosaic than Bayer's, or none.
    Mosaic(String),
    /// Levels that exclude each other.
    Levels(LevelsError),
    /// What is stored as pixels cannot be decoded.
    Damaged(String),
}

impl Rejection {
    /// Rejects a value that is legal but not supported.
    pub fn value(tag: Tag, found: impl ToString, expected: impl ToString) -> Self {
        Self::Value { tag, found: found.to_string(), expected: expected.to_string() }
    }

    /// Rejects numbers that are not legal.
    pub fn wrong(tag: Tag, found: &[f64], expected: impl ToString) -> Self {
        Self::Wrong { tag, found: words::numbers(found), expected: expected.to_string() }
    }

    /// The error of a file with this reason.
    pub fn of(self, path: &Path) -> CameraRawError {
        let path = path.to_owned();
        let reason = match self {
            Self::Value { tag, found, expected } => {
                format!("{tag} is {found}, expected {expected}; {REMEDY}")
            }
            Self::Wrong { tag, found, expected } => {
                format!("{tag} has {found}, expected {expected}; the file is damaged, or its writer wrong")
            }
            Self::Missing { tag, what } => format!("{tag} is missing, {what}"),
            Self::Cut(what) => format!("the file is cut: it ends before {what}; copy it again"),
            Self::Damaged(reason) => reason,
            Self::Mosaic(found) => return CameraRawError::Mosaic { path, found },
            Self::Levels(source) => return CameraRawError::Levels { path, source },
        };
        CameraRawError::Decode { path, reason }
    }
}
