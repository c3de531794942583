//! Arrays as a file for NumPy.

use super::JobError;
use ndarray::{ArrayBase, Data, Dimension};
use ndarray_npy::{NpzWriter, WritableElement};
use std::io::Cursor;
use std::path::Path;

/// A file in the making.
pub struct Npz(NpzWriter<Cursor<Vec<u8>>>);

impl Default for Npz {
    fn default() -> Self {
        Self::new()
    }
}

impl Npz {
    /// Returns a file without arrays.
    #[must_use]
    pub fn new() -> Self {
        Self(NpzWriter::new(Cursor::new(vec![])))
    }

    /// Adds an array.
    ///
    /// # Errors
    /// [`JobError::Npz`], as for two arrays of one name.
    pub fn add<S, D>(&mut self, name: &str, array: &ArrayBase<S, D>) -> Result<(), JobError>
    where
        S: Data,
        S::Elem: WritableElement,
        D: Dimension,
    {
        Ok(self.0.add_array(name, array)?)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`JobError::Npz`] or [`JobError::Write`].
    pub fn save(self, path: &Path) -> Result<(), JobError> {
        let bytes = self.0.finish()?.into_inner();
        Ok(edof_core::storage::atomic::write(path, &bytes)?)
    }
}
