//! Reasons for which a raw frame cannot be read or written.

use super::options::Size;
use crate::camera_raw::CameraRawError;
use crate::packing::LineError;
use crate::picture::PictureError;
use edof_core::frame::FrameError;
use std::path::{Path, PathBuf};

/// What to do with light in place of sensor values, for errors.
pub const OF_LIGHT: &str =
    "light from 0 to 1 becomes sensor values by np.rint(65535 * np.clip(raw, 0, 1)).astype(np.uint16)";

/// A raw frame that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum RawError {
    /// Lines that cannot be padded so.
    #[error("{path}: {source}", path = path.display())]
    Line { path: PathBuf, source: LineError },
    /// The file itself.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Camera raw that cannot be used.
    #[error(transparent)]
    CameraRaw(#[from] CameraRawError),
    /// No known format, and no size to read the file as headerless.
    #[error("{path}: not a {known} file; for a headerless file state its size as WIDTHxHEIGHT", path = path.display())]
    NoSize { path: PathBuf, known: String },
    /// A colour picture.
    #[error("{path}: holds a colour picture, expected one raw value a pixel", path = path.display())]
    Colour { path: PathBuf },
    /// Fewer bits than stated.
    #[error("{path}: holds {found}-bit samples, expected {expected}", path = path.display())]
    Depth { path: PathBuf, found: u32, expected: String },
    /// Samples in floating point.
    #[error("{path}: holds {found} samples, expected sensor values, whole numbers from 0 to 65535; {OF_LIGHT}", path = path.display())]
    Float { path: PathBuf, found: String },
    /// A number that is no sensor value.
    #[error(
        "{path}: pixel at row {row}, column {column} is {value}, expected a sensor value, a whole number from 0 to 65535{hint}",
        path = path.display()
    )]
    Number { path: PathBuf, row: usize, column: usize, value: f64, hint: String },
    /// Another size than stated.
    #[error("{path}: {found}, expected {expected} for {size}{hint}", path = path.display())]
    Size { path: PathBuf, found: String, expected: String, size: Size, hint: String },
    /// Bits where a top-aligned value has none.
    #[error(
        "{path}: pixel at row {row}, column {column} is {value}, no {depth}-bit code aligned to the top of 16 bits",
        path = path.display()
    )]
    Alignment { path: PathBuf, row: usize, column: usize, value: u16, depth: u32 },
    /// A byte of video that carries nothing.
    #[error(
        "{path}: byte {code} at row {row}, column {column}, expected 64 to 191: no raw frame as video, or a link that changed it",
        path = path.display()
    )]
    Code { path: PathBuf, row: usize, column: usize, code: u8 },
    /// Odd sides, a depth outside 8…16, a value too large.
    #[error("{path}: {source}", path = path.display())]
    Frame { path: PathBuf, source: FrameError },
}

impl RawError {
    /// Rejects a file whose size is not the one that an option states.
    pub(super) fn check_size(found: Size, stated: Option<Size>, path: &Path) -> Result<(), Self> {
        match stated {
            Some(size) if size != found => Err(Self::Size {
                path: path.to_owned(),
                found: format!("{found} pixels"),
                expected: "as many as stated".to_owned(),
                size,
                hint: String::new(),
            }),
            _ => Ok(()),
        }
    }
}
