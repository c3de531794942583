//! The words at every stage boundary as a file for NumPy; the layout is stated in docs/contract.md, section 8.

use crate::error::Error;
use edof_golden::Picture;
use edof_golden::words::Boundary;
use edof_spec::Frame422;
use ndarray::{ArrayBase, Data, Dimension};
use ndarray_npy::{NpzWriter, WritableElement, WriteNpzError};
use std::io::Cursor;
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
    let path = file(folder);
    let failed = |e: WriteNpzError| Error::message(format!("{}: cannot write: {e}", path.display()));
    let bytes = npz(boundaries, frame, codes).map_err(failed)?;
    Ok(edof_spec::atomic::write(&path, &bytes)?)
}

fn npz(boundaries: &[Boundary], frame: &Frame422, codes: &Picture) -> Result<Vec<u8>, WriteNpzError> {
    let mut file = NpzWriter::new(Cursor::new(vec![]));
    for boundary in boundaries {
        add(&mut file, &boundary.name, &boundary.words)?;
    }
    add(&mut file, "luma", &frame.luma)?;
    add(&mut file, "cb", &frame.chroma[0])?;
    add(&mut file, "cr", &frame.chroma[1])?;
    add(&mut file, "y_code", &codes.luma)?;
    add(&mut file, "cb_code", &codes.chroma[0])?;
    add(&mut file, "cr_code", &codes.chroma[1])?;
    Ok(file.finish()?.into_inner())
}

fn add<S, D>(
    file: &mut NpzWriter<Cursor<Vec<u8>>>,
    name: &str,
    array: &ArrayBase<S, D>,
) -> Result<(), WriteNpzError>
where
    S: Data,
    S::Elem: WritableElement,
    D: Dimension,
{
    file.add_array(name, array)
}
