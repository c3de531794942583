//! NumPy's arrays (`numpy.save`): rows × columns of sensor values, whole numbers of any type. The file states size and byte order; options
//! state phase, depth and levels as for headerless files.

use crate::picture::PictureError;
use crate::raw::error::{OF_LIGHT, RawError};
use crate::raw::format::{RawFormat, Read, Recognised, Values, Write};
use crate::raw::options::{Alignment, RawOptions, Size};
use crate::raw::source::Source;
use edof_core::RawFrame;
use edof_core::storage::arrays::{Npy, is_npy, npy};
use edof_core::words::sides;
use ndarray::{Array2, Ix2};
use std::path::Path;

/// NPY. 16-bit words with values at the bottom are written.
pub const NPY: RawFormat = RawFormat {
    name: "NPY",
    noun: "a NumPy array",
    endings: &["npy"],
    recognise: |bytes| if is_npy(bytes) { Recognised::Yes } else { Recognised::No },
    read: Read::Values(values),
    write: Some(Write {
        alignment: Alignment::Bottom,
        note: "(an array of sensor values)",
        encode: |frame, _| Ok(encoded(frame)),
    }),
};

fn values(source: Source<'_>, options: &RawOptions) -> Result<Values, RawError> {
    let path = source.path;
    let bytes = source.all()?;
    let damaged = |reason: String| PictureError::Decode { path: path.to_owned(), reason };
    let Npy { values, bytes } = npy(&bytes)
        .and_then(|array| array.ok_or_else(|| "its elements are not real numbers".to_owned()))
        .map_err(damaged)?;
    let shape = sides(values.shape());
    let values = values
        .into_dimensionality::<Ix2>()
        .map_err(|_| damaged(format!("an array of {shape}, expected rows x columns of sensor values")))?;
    let (height, width) = values.dim();
    RawError::check_size(Size { width, height }, options.size, path)?;
    let words = words(&values, path)?;
    let found = if bytes == 1 { 8 } else { 16 };
    Ok(Values { words, depth: options.depth.unwrap_or(found), alignment: Alignment::Bottom, notes: vec![] })
}

/// Rejects a number that is no sensor value.
fn words(values: &Array2<f64>, path: &Path) -> Result<Array2<u16>, RawError> {
    let is_word = |value: f64| (0.0..=65535.0).contains(&value) && value.fract() == 0.0;
    match values.indexed_iter().find(|(_, value)| !is_word(**value)) {
        Some(((row, column), &value)) => {
            let is_light = value.is_finite() && value.fract() != 0.0;
            let hint = if is_light { format!("; {OF_LIGHT}") } else { String::new() };
            Err(RawError::Number { path: path.to_owned(), row, column, value, hint })
        }
        None => Ok(values.mapv(|value| value as u16)),
    }
}

fn encoded(frame: &RawFrame) -> Vec<u8> {
    let (height, width) = frame.size();
    let header = format!("{{'descr': '<u2', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    // Magic, version and length are 10 bytes; the data begins at a multiple of 64.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:length$}", length = length - 1).bytes());
    bytes.push(b'\n');
    bytes.extend(frame.values().iter().flat_map(|value| value.to_le_bytes()));
    bytes
}
