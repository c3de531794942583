//! The words at every stage boundary as a file for NumPy; the layout is stated in docs/contract.md, section 8.

use crate::error::Error;
use edof_golden::Picture;
use edof_golden::words::Boundary;
use edof_spec::Frame422;
use ndarray::{ArrayBase, Data, Dimension};
use ndarray_npy::{NpzWriter, WritableElement, WriteNpzError};
use std::io::Cursor;
use std::path::Path;

/// Makes the folder if there is none: before all work, so that a wrong one costs none.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::message(format!("{}: cannot make this folder: {e}", folder.display())))
}

/// Writes `folder`/words.npz.
///
/// # Errors
/// When the file cannot be written.
pub fn save(folder: &Path, boundaries: &[Boundary], frame: &Frame422, codes: &Picture) -> Result<(), Error> {
    let path = folder.join("words.npz");
    let failed = |e: WriteNpzError| Error::message(format!("{}: cannot write: {e}", path.display()));
    let bytes = npz(boundaries, frame, codes).map_err(failed)?;
    Ok(edof_spec::atomic::write_with(&path, |file| file.write_all(&bytes))?)
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
