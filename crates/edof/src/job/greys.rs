//! The file that says which grey of a PC's graphics card becomes which code: written by a calibration, read by a capture.

use super::error::JobError;
use edof_core::storage::atomic;
use edof_core::storage::json;
use edof_core::storage::provenance::Provenance;
use edof_golden::video::greys::{Greys, Path as GreyPath};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Largest file that is read.
const MAX_BYTES: u64 = 1 << 20;

/// A calibration of a graphics card.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GreyFile {
    /// The grey of each luma code from 64 to 191.
    pub greys: Vec<u8>,
    /// The luma code of each grey from 0 to 255, as it was measured.
    pub luma: Vec<u8>,
    /// How it was made.
    pub provenance: Provenance,
}

impl GreyFile {
    /// Makes the file of what was found.
    #[must_use]
    pub fn new(path: &GreyPath, greys: &Greys, provenance: Provenance) -> Self {
        Self { greys: greys.all().to_vec(), luma: path.luma().to_vec(), provenance }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`JobError::Write`] naming the file.
    pub fn save(&self, file: &Path) -> Result<(), JobError> {
        let text = serde_json::to_string(self).map_err(|e| JobError::in_file(file, e))? + "\n";
        Ok(atomic::write(file, text.as_bytes())?)
    }

    /// Reads the greys of such a file.
    ///
    /// # Errors
    /// [`JobError::File`]: it cannot be read, or has other greys than 128 different ones.
    pub fn load(file: &Path) -> Result<Greys, JobError> {
        let text = json::text(file, MAX_BYTES).map_err(|e| JobError::in_file(file, e))?;
        let read: Self = json::parse(&text).map_err(|e| JobError::in_file(file, e))?;
        Greys::new(&read.greys).ok_or_else(|| JobError::in_file(file, NotGreys))
    }
}

#[derive(Debug, thiserror::Error)]
#[error("greys: must be 128 different numbers from 0 to 255, as 'edof board calibrate read' writes them")]
struct NotGreys;
