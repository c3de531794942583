//! The file of a correction: safetensors, with one metadata entry `edof_sensor`, JSON that holds size, phase, bit depth and black
//! (docs/sensor.md). The same correction gives the same bytes.

use super::correction::{Correction, Defects, SensorError, Tables};
use crate::raw::Size;
use edof_core::CfaPhase;
use edof_core::storage::arrays::safetensors_reason;
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::provenance::{Input, InputKind, Provenance};
use edof_core::storage::{input, json};
use ndarray::{Array2, Array3};
use safetensors::SafeTensorError;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Key of the metadata entry.
pub const METADATA_KEY: &str = "edof_sensor";
/// Version of the file.
const LAYOUT: u32 = 1;

/// A file of a correction that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum SensorFileError {
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Truncated, or not safetensors at all.
    #[error("{path}: not a whole safetensors file: {reason}", path = path.display())]
    Container { path: PathBuf, reason: String },
    /// Safetensors of another meaning.
    #[error("{path}: not a sensor file of edof: {reason}; make one by 'edof sensor'", path = path.display())]
    Foreign { path: PathBuf, reason: String },
    /// Tables that do not fit their frames.
    #[error("{path}: {source}", path = path.display())]
    Tables { path: PathBuf, source: SensorError },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    layout: u32,
    size: Size,
    phase: CfaPhase,
    bit_depth: u32,
    /// Whether frames hold light, as DNGs do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    light: Option<bool>,
    /// Raw pixel words of no light.
    black: [u16; 4],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    provenance: Option<Provenance>,
}

/// Writes a correction, and how it was made.
///
/// # Errors
/// [`SensorFileError::Container`] or [`SensorFileError::Write`].
pub fn save(
    path: &Path,
    correction: &Correction,
    provenance: Option<Provenance>,
) -> Result<(), SensorFileError> {
    let Tables { size, phase, depth, is_light, black, columns, rows, pixels, gains, defects } =
        correction.tables();
    let header = Header {
        layout: LAYOUT,
        size: *size,
        phase: *phase,
        bit_depth: *depth,
        light: *is_light,
        black: *black,
        provenance,
    };
    let container = |reason: String| SensorFileError::Container { path: path.to_owned(), reason };
    let text = serde_json::to_string(&header).map_err(|e| container(e.to_string()))?;
    let signed =
        |values: &mut dyn Iterator<Item = &i16>| values.flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
    let whole =
        |values: &mut dyn Iterator<Item = &u32>| values.flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
    let mut tensors = vec![
        ("columns", Dtype::I16, vec![columns.len()], signed(&mut columns.iter())),
        ("rows", Dtype::I16, vec![rows.len()], signed(&mut rows.iter())),
        ("gains", Dtype::U16, gains.shape().to_vec(), gains.iter().flat_map(|v| v.to_le_bytes()).collect()),
        (
            "defective_pixels",
            Dtype::U32,
            vec![defects.pixels.len(), 2],
            whole(&mut defects.pixels.as_flattened().iter()),
        ),
        ("defective_columns", Dtype::U32, vec![defects.columns.len()], whole(&mut defects.columns.iter())),
        ("defective_rows", Dtype::U32, vec![defects.rows.len()], whole(&mut defects.rows.iter())),
    ];
    if let Some(pixels) = pixels {
        tensors.push(("pixels", Dtype::I16, pixels.shape().to_vec(), signed(&mut pixels.iter())));
    }
    let views = tensors
        .iter()
        .map(|(name, dtype, shape, bytes)| Ok((*name, TensorView::new(*dtype, shape.clone(), bytes)?)))
        .collect::<Result<Vec<_>, SafeTensorError>>()
        .map_err(|e| container(e.to_string()))?;
    let metadata = HashMap::from([(METADATA_KEY.to_owned(), text)]);
    let bytes = safetensors::serialize(views, Some(metadata)).map_err(|e| container(e.to_string()))?;
    Ok(atomic::write(path, &bytes)?)
}

/// Reads a correction, and returns it with the file as an input of results.
///
/// # Errors
/// Any [`SensorFileError`] but `Write`.
pub fn load(path: &Path) -> Result<(Correction, Input), SensorFileError> {
    let bytes =
        input::read(path).map_err(|source| SensorFileError::Read { path: path.to_owned(), source })?;
    let correction = Correction::new(tables(&bytes, path)?)
        .map_err(|source| SensorFileError::Tables { path: path.to_owned(), source })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok((correction, Input::of_bytes(InputKind::Sensor, &name, &bytes)))
}

fn tables(bytes: &[u8], path: &Path) -> Result<Tables, SensorFileError> {
    let container = |e: SafeTensorError| SensorFileError::Container {
        path: path.to_owned(),
        reason: safetensors_reason(&e),
    };
    let foreign = |reason: String| SensorFileError::Foreign { path: path.to_owned(), reason };
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(container)?;
    let text = metadata.metadata().as_ref().and_then(|entries| entries.get(METADATA_KEY));
    let text = text.ok_or_else(|| foreign(format!("its metadata has no entry '{METADATA_KEY}'")))?;
    let Header { layout, size, phase, bit_depth, light, black, .. } =
        json::parse(text).map_err(|e| foreign(format!("its metadata is wrong: {e}")))?;
    if layout != LAYOUT {
        return Err(foreign(format!("layout {layout}, this program reads {LAYOUT}")));
    }
    let arrays = Arrays(SafeTensors::deserialize(bytes).map_err(container)?);
    let read = || {
        let (gains_shape, gains) = arrays.get("gains", Dtype::U16, u16::from_le_bytes)?;
        let (_, pairs) = arrays.get("defective_pixels", Dtype::U32, u32::from_le_bytes)?;
        Ok(Tables {
            size,
            phase,
            depth: bit_depth,
            is_light: light,
            black,
            columns: arrays.get("columns", Dtype::I16, i16::from_le_bytes)?.1,
            rows: arrays.get("rows", Dtype::I16, i16::from_le_bytes)?.1,
            pixels: match arrays.0.tensor("pixels") {
                Ok(_) => {
                    let (shape, values) = arrays.get("pixels", Dtype::I16, i16::from_le_bytes)?;
                    let shape = <[usize; 2]>::try_from(shape).map_err(|_| dimensions("pixels", 2))?;
                    Some(Array2::from_shape_vec(shape, values).map_err(|e| e.to_string())?)
                }
                Err(_) => None,
            },
            gains: {
                let shape = <[usize; 3]>::try_from(gains_shape).map_err(|_| dimensions("gains", 3))?;
                Array3::from_shape_vec(shape, gains).map_err(|e| e.to_string())?
            },
            defects: Defects {
                pixels: match pairs.as_chunks() {
                    (pairs, []) => pairs.to_vec(),
                    _ => return Err("tensor 'defective_pixels' has no rows and columns in pairs".to_owned()),
                },
                columns: arrays.get("defective_columns", Dtype::U32, u32::from_le_bytes)?.1,
                rows: arrays.get("defective_rows", Dtype::U32, u32::from_le_bytes)?.1,
            },
        })
    };
    read().map_err(foreign)
}

fn dimensions(name: &str, expected: usize) -> String {
    format!("tensor '{name}' has another number of dimensions than {expected}")
}

/// The arrays of a file.
struct Arrays<'a>(SafeTensors<'a>);

impl Arrays<'_> {
    /// Returns shape and numbers of an array of that type.
    fn get<T, const N: usize>(
        &self,
        name: &str,
        dtype: Dtype,
        number: impl Fn([u8; N]) -> T,
    ) -> Result<(Vec<usize>, Vec<T>), String> {
        let view = self.0.tensor(name).map_err(|_| format!("tensor '{name}' is missing"))?;
        if view.dtype() != dtype {
            return Err(format!("tensor '{name}' is {}, expected {dtype}", view.dtype()));
        }
        Ok((view.shape().to_vec(), view.data().as_chunks().0.iter().map(|bytes| number(*bytes)).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 48, height: 32 };

    fn correction() -> Correction {
        let mut tables = Tables::plain(SIZE, CfaPhase::Gbrg, 12, [1024.0, 1030.0, 1020.0, 1024.0], 65000.0);
        (tables.columns[7], tables.rows[9]) = (-300, 40);
        tables.pixels = Some(Array2::from_shape_fn((32, 48), |(r, c)| (r * 48 + c) as i16 - 700));
        tables.gains[(2, 1, 1)] = 40_000;
        tables.defects = Defects { pixels: vec![[3, 4], [31, 47]], columns: vec![20], rows: vec![] };
        Correction::new(tables).unwrap()
    }

    #[test]
    fn a_file_gives_back_its_correction_and_the_same_bytes_again() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        save(&at("a"), &correction(), None).unwrap();
        let (read, input) = load(&at("a")).unwrap();
        assert_eq!((&read, input.kind), (&correction(), InputKind::Sensor));
        save(&at("b"), &read, None).unwrap();
        assert_eq!(std::fs::read(at("a")).unwrap(), std::fs::read(at("b")).unwrap());
        let plain = Correction::new(Tables::plain(SIZE, CfaPhase::Rggb, 8, [0.0; 4], 65536.0)).unwrap();
        let light = plain.clone().of_light(Some(true));
        for correction in [plain, light] {
            save(&at("c"), &correction, Some(Provenance::default())).unwrap();
            assert_eq!(load(&at("c")).unwrap().0, correction);
        }
    }

    #[test]
    fn files_that_are_none_are_rejected_by_what_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            load(&path).unwrap_err().to_string()
        };
        save(&path, &correction(), None).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let changed = |from: &str, to: &str| {
            let at = bytes.windows(from.len()).position(|part| part == from.as_bytes()).unwrap();
            let mut bytes = bytes.clone();
            bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
            bytes
        };
        for (bytes, words) in [
            (bytes[..bytes.len() - 1].to_vec(), "not a whole safetensors file"),
            (changed("edof_sensor", "edof_sensed"), "its metadata has no entry 'edof_sensor'"),
            (changed("\\\"layout\\\":1", "\\\"layout\\\":9"), "layout 9, this program reads 1; make one by"),
            (changed("48x32", "46x32"), "columns: 48, expected 46 for frames of 46x32"),
            (changed("gbrg", "gray"), "its metadata is wrong: phase: unknown value `gray`"),
            (changed("\"gains\"", "\"pains\""), "tensor 'gains' is missing"),
        ] {
            let told = refused(&bytes);
            assert!(told.contains(words), "{told}");
        }
    }
}
