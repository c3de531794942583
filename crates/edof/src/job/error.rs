//! Reasons for which a job cannot be done.

use super::memory::MemoryError;
use crate::presets::PresetError;
use edof_io::levels::LevelsError;
use edof_io::photo::PhotoError;
use edof_io::raw::{RawError, Size};
use edof_io::record::RecordError;
use edof_optics::capture::CaptureError;
use edof_optics::draw::DrawError;
use std::path::{Path, PathBuf};

/// Inputs that cannot be used, or outputs that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JobError {
    /// A photograph.
    #[error(transparent)]
    Photo(#[from] PhotoError),
    /// A raw frame.
    #[error(transparent)]
    Raw(#[from] RawError),
    /// The record beside a raw frame.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// Levels of a raw frame.
    #[error(transparent)]
    Levels(#[from] LevelsError),
    /// A camera or a depth before it.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// A synthetic scene.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A scene that the camera cannot take.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A file that is not what it should be.
    #[error("{path}: {source}", path = path.display())]
    File { path: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
    /// A picture whose size differs from that of another one.
    #[error("{path}: {found}, expected {expected} as {other}", path = path.display(), other = other.display())]
    OtherSize { path: PathBuf, found: Size, expected: Size, other: PathBuf },
    /// A layer of a scene file.
    #[error("{path}: layer {index}: {source}", path = path.display())]
    Layer { path: PathBuf, index: usize, source: Box<dyn std::error::Error + Send + Sync> },
    /// A scene that is too large for the machine.
    #[error("scene {size}: {source}")]
    Memory { size: Size, source: MemoryError },
    /// A photograph with too many layers for the machine.
    #[error("{size} in {layers} layers: {source}")]
    Layers { size: Size, layers: usize, source: MemoryError },
}

impl JobError {
    /// Names the file of an error.
    pub(super) fn in_file(path: &Path, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::File { path: path.to_owned(), source: source.into() }
    }
}
