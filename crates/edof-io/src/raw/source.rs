//! A raw file while it is read: once, so that it may be a pipe.

use super::error::RawError;
use crate::picture::{self, Format, PictureError};
use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

/// A file whose first bytes have been read.
#[derive(Debug)]
pub struct Source<'a> {
    /// Names the file in errors.
    pub path: &'a Path,
    file: File,
    bytes: Vec<u8>,
}

impl<'a> Source<'a> {
    /// Opens a file and reads the bytes that show its format: all of a TIFF, whose directory may be anywhere.
    ///
    /// # Errors
    /// [`RawError::Picture`].
    pub fn open(path: &'a Path) -> Result<Self, RawError> {
        let (file, bytes) = picture::open(path)?;
        let mut source = Self { path, file, bytes };
        if Format::of(&source.bytes) == Some(Format::Tiff) {
            source.read(u64::MAX)?;
        }
        Ok(source)
    }

    /// Returns the bytes read so far.
    #[must_use]
    pub fn head(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns all bytes.
    ///
    /// # Errors
    /// [`RawError::Picture`].
    pub fn all(mut self) -> Result<Vec<u8>, RawError> {
        self.read(u64::MAX)?;
        Ok(self.bytes)
    }

    /// Returns the bytes of a file that must have `expected` of them. Otherwise calls `wrong` with the number found, where it is known; a
    /// file of another length is not read.
    ///
    /// # Errors
    /// [`RawError::Picture`], or that of `wrong`.
    pub fn exactly(
        mut self,
        expected: u64,
        wrong: impl Fn(Option<u64>) -> RawError,
    ) -> Result<Vec<u8>, RawError> {
        let found = self.file.metadata().ok().filter(Metadata::is_file).map(|what| what.len());
        if found.is_some_and(|found| found != expected) {
            return Err(wrong(found));
        }
        self.read((expected + 1).saturating_sub(self.bytes.len() as u64))?;
        match self.bytes.len() as u64 {
            found if found > expected => Err(wrong(None)),
            found if found < expected => Err(wrong(Some(found))),
            _ => Ok(self.bytes),
        }
    }

    fn read(&mut self, at_most: u64) -> Result<(), RawError> {
        let read = (&mut self.file).take(at_most).read_to_end(&mut self.bytes);
        let failed = |source| PictureError::Read { path: self.path.to_owned(), source };
        Ok(read.map(drop).map_err(failed)?)
    }
}
