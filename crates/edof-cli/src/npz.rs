//! Arrays as a file for NumPy.

use crate::error::Error;
use ndarray::{ArrayBase, Data, Dimension};
use ndarray_npy::{NpzWriter, WritableElement, WriteNpzError};
use std::io::Cursor;
use std::path::Path;

/// A file in the making.
pub struct Npz(NpzWriter<Cursor<Vec<u8>>>);

impl Npz {
    /// One without arrays.
    pub fn new() -> Self {
        Self(NpzWriter::new(Cursor::new(vec![])))
    }

    /// Adds an array.
    ///
    /// # Errors
    /// What the writer says, such as two arrays of one name.
    pub fn add<S, D>(&mut self, name: &str, array: &ArrayBase<S, D>) -> Result<(), WriteNpzError>
    where
        S: Data,
        S::Elem: WritableElement,
        D: Dimension,
    {
        self.0.add_array(name, array)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn save(self, path: &Path) -> Result<(), Error> {
        let bytes = self.0.finish()?.into_inner();
        Ok(edof_core::storage::atomic::write(path, &bytes)?)
    }
}
