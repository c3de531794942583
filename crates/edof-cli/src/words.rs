//! The words at every stage boundary as a file for NumPy; the layout is stated in docs/contract.md, section 8.

use crate::error::Error;
use crate::npz::Npz;
use edof_core::Frame422;
use edof_golden::Picture;
use edof_golden::words::Boundary;
use std::path::{Path, PathBuf};

/// The file in a folder.
pub fn file(folder: &Path) -> PathBuf {
    folder.join("words.npz")
}

/// Writes `folder`/words.npz.
///
/// # Errors
/// When the file cannot be written.
pub fn save(folder: &Path, boundaries: &[Boundary], frame: &Frame422, codes: &Picture) -> Result<(), Error> {
    let mut npz = Npz::new();
    for boundary in boundaries {
        npz.add(&boundary.name, &boundary.words)?;
    }
    for (name, plane) in ["luma", "cb", "cr"].into_iter().zip(frame.bits()) {
        npz.add(name, &plane)?;
    }
    npz.add("y_code", &codes.luma)?;
    npz.add("cb_code", &codes.chroma[0])?;
    npz.add("cr_code", &codes.chroma[1])?;
    npz.save(&file(folder))
}
