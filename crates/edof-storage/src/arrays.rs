//! Named arrays of numbers in files of other programs: NPZ as `numpy.savez` writes it, and safetensors.
//!
//! Whatever a file claims, no more is allocated than it holds.

use ndarray::{ArrayD, IxDyn, ShapeBuilder};
use safetensors::tensor::{Dtype, SafeTensors};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// Most bytes of a file.
const MOST_BYTES: u64 = 1 << 30;

/// A file whose arrays cannot be had.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ArraysError {
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// A device, a folder, or far too long.
    #[error("{path}: is no file of at most 1 GiB", path = path.display())]
    Size { path: PathBuf },
    /// Neither of the formats, or damaged.
    #[error("{path}: not a whole NPZ or safetensors file: {reason}", path = path.display())]
    Container { path: PathBuf, reason: String },
}

/// The arrays of a file by name, `name.npy` as `name`. Arrays of anything but real numbers are left out.
///
/// # Errors
/// [`ArraysError`].
pub fn read(path: &Path) -> Result<BTreeMap<String, ArrayD<f64>>, ArraysError> {
    let failed = |source| ArraysError::Read { path: path.to_owned(), source };
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() || about.len() > MOST_BYTES {
        return Err(ArraysError::Size { path: path.to_owned() });
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    let arrays = if bytes.starts_with(b"PK") { of_npz(&bytes) } else { of_safetensors(&bytes) };
    arrays.map_err(|reason| ArraysError::Container { path: path.to_owned(), reason })
}

type Arrays = BTreeMap<String, ArrayD<f64>>;

fn of_npz(bytes: &[u8]) -> Result<Arrays, String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| e.to_string())?;
    let mut arrays = Arrays::new();
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|e| match e {
            zip::result::ZipError::UnsupportedArchive(_) => {
                "it is compressed; write it by numpy.savez".to_owned()
            }
            other => other.to_string(),
        })?;
        let name = entry.name().strip_suffix(".npy").unwrap_or(entry.name()).to_owned();
        let mut content = vec![];
        entry.take(bytes.len() as u64).read_to_end(&mut content).map_err(|e| format!("{name}: {e}"))?;
        if let Some(array) = npy(&content).map_err(|reason| format!("{name}: {reason}"))? {
            arrays.insert(name, array);
        }
    }
    Ok(arrays)
}

fn of_safetensors(bytes: &[u8]) -> Result<Arrays, String> {
    let file = SafeTensors::deserialize(bytes).map_err(|e| e.to_string())?;
    let array = |(name, view): (String, safetensors::tensor::TensorView<'_>)| {
        let number = Number::of_dtype(view.dtype())?;
        Some(number.array(view.shape(), false, view.data()).map(|array| (name, array)))
    };
    file.tensors().into_iter().filter_map(array).collect()
}

/// One array as NumPy's format 1 to 3 has it; none where its elements are no numbers.
fn npy(bytes: &[u8]) -> Result<Option<ArrayD<f64>>, String> {
    let damaged = || "no whole NPY array".to_owned();
    let length = |n: usize| {
        let field = bytes.get(8..8 + n)?;
        Some((8 + n, field.iter().rev().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte))))
    };
    let (start, length) = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, ..] => length(2),
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, ..] => length(4),
        _ => None,
    }
    .ok_or_else(damaged)?;
    let end = start.checked_add(length).ok_or_else(damaged)?;
    let header = bytes.get(start..end).and_then(|text| std::str::from_utf8(text).ok()).ok_or_else(damaged)?;
    let field = |key: &str| Some(header.split_once(&format!("'{key}':"))?.1.trim_start());
    let quoted = |text: &str| Some(text.strip_prefix('\'')?.split_once('\'')?.0.to_owned());
    let Some(kind) = field("descr").and_then(quoted) else { return Ok(None) };
    let Some(number) = Number::of_descriptor(&kind) else { return Ok(None) };
    let inside = |text: &str| Some(text.strip_prefix('(')?.split_once(')')?.0.to_owned());
    let shape = field("shape").and_then(inside).ok_or_else(damaged)?;
    let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: Vec<usize> = sides.map(str::parse).collect::<Result<_, _>>().map_err(|_| damaged())?;
    let fortran = field("fortran_order").is_some_and(|text| text.starts_with("True"));
    number.array(&shape, fortran, &bytes[end..]).map(Some)
}

/// How a number is written.
#[derive(Debug, Clone, Copy)]
struct Number {
    kind: Kind,
    bytes: usize,
    big_endian: bool,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

impl Number {
    /// Of NumPy's word for it, as in `<f4`.
    fn of_descriptor(text: &str) -> Option<Self> {
        let (order, rest) = text.split_at_checked(1)?;
        let (kind, bytes) = rest.split_at_checked(1)?;
        let kind = match kind {
            "f" => Kind::Float,
            "i" => Kind::Signed,
            "u" => Kind::Unsigned,
            _ => return None,
        };
        Self { kind, bytes: bytes.parse().ok()?, big_endian: order == ">" }.known()
    }

    fn of_dtype(dtype: Dtype) -> Option<Self> {
        let (kind, bytes) = match dtype {
            Dtype::F32 => (Kind::Float, 4),
            Dtype::F64 => (Kind::Float, 8),
            Dtype::I8 => (Kind::Signed, 1),
            Dtype::I16 => (Kind::Signed, 2),
            Dtype::I32 => (Kind::Signed, 4),
            Dtype::I64 => (Kind::Signed, 8),
            Dtype::U8 => (Kind::Unsigned, 1),
            Dtype::U16 => (Kind::Unsigned, 2),
            Dtype::U32 => (Kind::Unsigned, 4),
            Dtype::U64 => (Kind::Unsigned, 8),
            _ => return None,
        };
        Some(Self { kind, bytes, big_endian: false })
    }

    fn known(self) -> Option<Self> {
        let sizes: &[usize] = if matches!(self.kind, Kind::Float) { &[4, 8] } else { &[1, 2, 4, 8] };
        sizes.contains(&self.bytes).then_some(self)
    }

    fn value(self, raw: &[u8]) -> f64 {
        let mut little = [0; 8];
        little[..raw.len()].copy_from_slice(raw);
        if self.big_endian {
            little[..raw.len()].reverse();
        }
        let word = u64::from_le_bytes(little);
        let unused = 64 - 8 * self.bytes as u32;
        match (self.kind, self.bytes) {
            (Kind::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (Kind::Float, _) => f64::from_bits(word),
            (Kind::Signed, _) => ((word << unused) as i64 >> unused) as f64,
            (Kind::Unsigned, _) => word as f64,
        }
    }

    /// An array of just so many bytes.
    fn array(self, shape: &[usize], fortran: bool, bytes: &[u8]) -> Result<ArrayD<f64>, String> {
        let count = shape.iter().try_fold(1usize, |product, side| product.checked_mul(*side));
        let expected = count.and_then(|count| count.checked_mul(self.bytes));
        if expected != Some(bytes.len()) {
            return Err(format!(
                "{} bytes of data do not make {shape:?} numbers of {} bytes",
                bytes.len(),
                self.bytes
            ));
        }
        let values = bytes.chunks_exact(self.bytes).map(|raw| self.value(raw)).collect();
        ArrayD::from_shape_vec(IxDyn(shape).set_f(fortran), values).map_err(|e| e.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn npz(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = zip::ZipWriter::new(Cursor::new(vec![]));
        for (name, content) in entries {
            let options =
                zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            archive.start_file(*name, options).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap().into_inner()
    }

    fn array(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn loaded(bytes: &[u8]) -> Result<Arrays, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npz");
        std::fs::write(&path, bytes).unwrap();
        read(&path).map_err(|e| e.to_string())
    }

    #[test]
    fn numbers_of_every_kind_and_order_are_read() {
        let one = |header: &str, data: &[u8]| {
            let arrays = loaded(&npz(&[("a.npy", &array(header, data))])).unwrap();
            arrays["a"].iter().copied().collect::<Vec<_>>()
        };
        let header = |kind: &str| format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2,), }}\n");
        assert_eq!(one(&header("<f4"), &[0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]), [1.0, -2.0]);
        assert_eq!(one(&header(">f4"), &[0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0]), [1.0, -2.0]);
        assert_eq!(one(&header("<i2"), &[1, 0, 0xfe, 0xff]), [1.0, -2.0]);
        assert_eq!(one(&header("|u1"), &[7, 255]), [7.0, 255.0]);
        assert_eq!(
            one(&header("<f8"), &[1.5f64.to_le_bytes(), (-0.5f64).to_le_bytes()].concat()),
            [1.5, -0.5]
        );
    }

    #[test]
    fn columns_may_come_first() {
        let header = "{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }";
        let arrays = loaded(&npz(&[("a.npy", &array(header, &[1, 4, 2, 5, 3, 6]))])).unwrap();
        assert_eq!(
            arrays["a"].rows().into_iter().map(|r| r.to_vec()).collect::<Vec<_>>(),
            [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
        );
    }

    #[test]
    fn safetensors_are_read_and_what_is_no_number_is_left_out() {
        let view = |dtype, data| safetensors::tensor::TensorView::new(dtype, vec![2], data).unwrap();
        let floats = [1.0f32.to_le_bytes(), 2.0f32.to_le_bytes()].concat();
        let bytes = safetensors::serialize(
            [("a", view(Dtype::F32, &floats)), ("b", view(Dtype::BOOL, &[0, 1]))],
            None,
        );
        let arrays = loaded(&bytes.unwrap()).unwrap();
        assert_eq!((arrays.len(), arrays["a"].sum()), (1, 3.0));
    }

    #[test]
    fn claims_that_the_file_does_not_hold_are_refused() {
        let shape = |text: &str| {
            array(&format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {text}, }}"), &[0; 16])
        };
        for text in ["(3,)", "(1000000000000,)", "(18446744073709551615, 2)", "(4294967296, 4294967296)"] {
            let error = loaded(&npz(&[("a.npy", &shape(text))])).unwrap_err();
            assert!(error.contains("a: 16 bytes of data do not make"), "{error}");
        }
        for content in [&b""[..], b"\x93NUMPY", b"\x93NUMPY\x01\x00\xff\xff{", b"text"] {
            assert!(loaded(&npz(&[("a.npy", content)])).unwrap_err().contains("a: no whole NPY array"));
        }
        for bytes in [&b""[..], b"PK", b"PK\x03\x04 and no more", b"words"] {
            assert!(loaded(bytes).unwrap_err().contains("not a whole NPZ or safetensors file"));
        }
        assert!(read(Path::new("/dev/zero")).unwrap_err().to_string().contains("is no file"));
    }
}
