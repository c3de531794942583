//! Named arrays of numbers in files of other programs: NPZ as `numpy.savez` and `numpy.savez_compressed` write it, NPY as
//! `numpy.save` does, and safetensors.
//!
//! Whatever a file claims, no more is allocated than it holds; of compressed arrays no more than [`MAX_BYTES`] are unpacked.

use crate::storage::{input, json};
use crate::words::sides;
use flate2::Crc;
use flate2::read::DeflateDecoder;
use ndarray::{ArrayD, IxDyn, ShapeBuilder};
use safetensors::SafeTensorError;
use safetensors::tensor::{Dtype, SafeTensors};
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use zip::{CompressionMethod, ZipArchive};

/// Most bytes of a file, and of its arrays unpacked.
pub const MAX_BYTES: u64 = 1 << 30;

/// A file whose arrays cannot be had.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ArraysError {
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Far too long.
    #[error("{path}: {found} bytes, at most {} are read", json::size(MAX_BYTES), path = path.display())]
    Size { path: PathBuf, found: u64 },
    /// None of the formats, or damaged.
    #[error("{path}: not a whole NPZ, NPY or safetensors file: {reason}", path = path.display())]
    Container { path: PathBuf, reason: String },
}

/// The arrays of a file by name, `name.npy` of an NPZ file as `name`, the one of an NPY file as the file is named. Arrays of anything but
/// real numbers are left out.
///
/// # Errors
/// [`ArraysError`].
pub fn read(path: &Path) -> Result<BTreeMap<String, ArrayD<f64>>, ArraysError> {
    let failed = |source| ArraysError::Read { path: path.to_owned(), source };
    let mut file = input::open(path).map_err(failed)?;
    let found = file.metadata().map_err(failed)?.len();
    if found > MAX_BYTES {
        return Err(ArraysError::Size { path: path.to_owned(), found });
    }
    let mut bytes = vec![];
    file.read_to_end(&mut bytes).map_err(failed)?;
    let arrays = if bytes.starts_with(b"PK") {
        of_npz(&bytes)
    } else if is_npy(&bytes) {
        of_npy(&bytes, path)
    } else {
        of_safetensors(&bytes)
    };
    arrays.map_err(|reason| ArraysError::Container { path: path.to_owned(), reason })
}

type Arrays = BTreeMap<String, ArrayD<f64>>;

/// How an NPY file begins.
const NPY: &[u8] = b"\x93NUMPY";
const CUT: &str = "its list of arrays is missing, which is at its end: the file is cut; copy it again";

fn of_npy(bytes: &[u8], path: &Path) -> Result<Arrays, String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(npy(bytes)?.map(|array| (name, array.values)).into_iter().collect())
}

fn of_npz(bytes: &[u8]) -> Result<Arrays, String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))
        .map_err(|e| entries(bytes).map_or(CUT.to_owned(), |_| e.to_string()))?;
    // The archive keeps the last of several entries of one name.
    if entries(bytes).is_some_and(|stated| stated != archive.len()) {
        return Err("several of its arrays have the same name".to_owned());
    }
    let (mut arrays, mut names, mut room) = (Arrays::new(), BTreeSet::new(), MAX_BYTES);
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(|e| e.to_string())?;
        let name = entry.name().strip_suffix(".npy").unwrap_or(entry.name()).to_owned();
        check_name(&name, index)?;
        if !names.insert(name.clone()) {
            return Err(format!("two of its arrays have the name {name}"));
        }
        let content = unpacked(entry, &mut room).map_err(|reason| format!("{name}: {reason}"))?;
        if let Some(array) = npy(&content).map_err(|reason| format!("{name}: {reason}"))? {
            arrays.insert(name, array.values);
        }
    }
    Ok(arrays)
}

/// How many entries the end of an archive states, where that is known; those of more than 65534 are not counted there.
fn entries(bytes: &[u8]) -> Option<usize> {
    let end = bytes.windows(4).rposition(|word| word == b"PK\x05\x06")?;
    let count = bytes.get(end + 10..end + 12)?;
    Some(usize::from(u16::from_le_bytes([count[0], count[1]]))).filter(|count| *count != 0xffff)
}

/// A name that a terminal shows as it is.
fn check_name(name: &str, index: usize) -> Result<(), String> {
    match name.chars().any(char::is_control) {
        true => Err(format!("the name of its array {} holds a control character", index + 1)),
        false => Ok(()),
    }
}

/// The content of an entry, stored or deflated; `room` is how many bytes may still be unpacked.
fn unpacked<R: Read>(mut entry: zip::read::ZipFile<'_, R>, room: &mut u64) -> Result<Vec<u8>, String> {
    let (method, stated, crc) = (entry.compression(), entry.size(), entry.crc32());
    if stated > *room {
        let max = json::size(MAX_BYTES);
        return Err(format!("{stated} bytes when unpacked, at most {max} are read of a file"));
    }
    let mut content = vec![];
    let max = stated + 1;
    match method {
        CompressionMethod::Stored => entry.by_ref().take(max).read_to_end(&mut content),
        CompressionMethod::DEFLATE => DeflateDecoder::new(&mut entry).take(max).read_to_end(&mut content),
        other => {
            let name = other.to_string().replace("Unsupported(", "method ").replace(')', " of ZIP");
            return Err(format!("compressed by {name}; write it by numpy.savez_compressed or numpy.savez"));
        }
    }
    .map_err(|e| e.to_string())?;
    if content.len() as u64 != stated {
        let more = if content.len() as u64 > stated { "more than " } else { "" };
        return Err(format!("{more}{} bytes, it states {stated}", content.len().min(stated as usize)));
    }
    let mut sum = Crc::new();
    sum.update(&content);
    if sum.sum() != crc {
        return Err("its checksum is wrong: the file was changed or damaged".to_owned());
    }
    *room -= stated;
    Ok(content)
}

/// What is wrong with a safetensors file.
#[must_use]
pub fn safetensors_reason(error: &SafeTensorError) -> String {
    match error {
        SafeTensorError::InvalidHeaderDeserialization(error) => format!("its header: {}", json::words(error)),
        error => error.to_string(),
    }
}

/// The keys of a JSON object, as often as they are there.
struct Keys(Vec<String>);

impl<'de> Deserialize<'de> for Keys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfMap;
        impl<'de> Visitor<'de> for OfMap {
            type Value = Keys;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Keys, A::Error> {
                let mut keys = vec![];
                while let Some((key, IgnoredAny)) = map.next_entry()? {
                    keys.push(key);
                }
                Ok(Keys(keys))
            }
        }
        deserializer.deserialize_map(OfMap)
    }
}

/// Rejects duplicate names, because a reader of JSON keeps only the last one, and names that a terminal does not show.
fn check_tensors(bytes: &[u8]) -> Result<(), String> {
    let (length, rest) = bytes.split_first_chunk::<8>().ok_or("header too small")?;
    let header = usize::try_from(u64::from_le_bytes(*length)).ok().and_then(|n| rest.get(..n));
    let Some(Ok(Keys(keys))) = header.map(serde_json::from_slice) else { return Ok(()) };
    let mut names = BTreeSet::new();
    for (index, name) in keys.iter().enumerate() {
        check_name(name, index)?;
        if !names.insert(name) {
            return Err(format!("two of its arrays have the name {name}"));
        }
    }
    Ok(())
}

fn of_safetensors(bytes: &[u8]) -> Result<Arrays, String> {
    check_tensors(bytes)?;
    let file = SafeTensors::deserialize(bytes).map_err(|e| safetensors_reason(&e))?;
    let array = |(name, view): (String, safetensors::tensor::TensorView<'_>)| {
        let number = Number::of_dtype(view.dtype())?;
        Some(number.array(view.shape(), false, view.data()).map(|array| (name, array)))
    };
    file.tensors().into_iter().filter_map(array).collect()
}

/// The array of an NPY file.
#[derive(Debug, Clone, PartialEq)]
pub struct Npy {
    /// Its numbers.
    pub values: ArrayD<f64>,
    /// Bytes of a number in the file.
    pub bytes: usize,
}

/// Returns whether bytes begin as an NPY file does.
#[must_use]
pub fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(NPY)
}

/// Reads an array in NumPy's format 1 to 3. Returns `None` if its elements are not real numbers.
///
/// # Errors
/// What is damaged.
pub fn npy(bytes: &[u8]) -> Result<Option<Npy>, String> {
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
    let values = number.array(&shape, fortran, &bytes[end..])?;
    Ok(Some(Npy { values, bytes: number.bytes }))
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
    /// The upper half of an `f32`.
    Brain,
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
            Dtype::F16 => (Kind::Float, 2),
            Dtype::BF16 => (Kind::Brain, 2),
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
        let sizes: &[usize] = if matches!(self.kind, Kind::Float) { &[2, 4, 8] } else { &[1, 2, 4, 8] };
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
            (Kind::Float, 2) => half(word as u16),
            (Kind::Brain, _) => f64::from(f32::from_bits((word as u32) << 16)),
            (Kind::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (Kind::Float, _) => f64::from_bits(word),
            (Kind::Signed, _) => ((word << unused) as i64 >> unused) as f64,
            (Kind::Unsigned, _) => word as f64,
        }
    }

    /// An array of just N bytes.
    fn array(self, shape: &[usize], fortran: bool, bytes: &[u8]) -> Result<ArrayD<f64>, String> {
        let count = shape.iter().try_fold(1usize, |product, side| product.checked_mul(*side));
        let expected = count.and_then(|count| count.checked_mul(self.bytes));
        if expected != Some(bytes.len()) {
            return Err(format!(
                "{} bytes of data do not make {} numbers of {} bytes",
                bytes.len(),
                sides(shape),
                self.bytes
            ));
        }
        let values = bytes.chunks_exact(self.bytes).map(|raw| self.value(raw)).collect();
        ArrayD::from_shape_vec(IxDyn(shape).set_f(fortran), values).map_err(|e| e.to_string())
    }
}

/// A number of 16 bits (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let (sign, exponent, fraction) = (bits >> 15, (bits >> 10) & 0x1f, f64::from(bits & 0x3ff));
    let size = match exponent {
        0 => fraction * 2f64.powi(-24),
        0x1f if fraction == 0.0 => f64::INFINITY,
        0x1f => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(i32::from(exponent) - 25),
    };
    if sign == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// An NPZ file of deflated entries, by hand: the archive's writer here only stores.
    fn deflated(entries: &[(&str, &[u8])], stated: impl Fn(usize) -> u32) -> Vec<u8> {
        let (mut bytes, mut directory): (Vec<u8>, Vec<u8>) = (vec![], vec![]);
        for (name, content) in entries {
            let mut packed = flate2::write::DeflateEncoder::new(vec![], flate2::Compression::default());
            packed.write_all(content).unwrap();
            let packed = packed.finish().unwrap();
            let mut sum = Crc::new();
            sum.update(content);
            let start = bytes.len() as u32;
            let sizes = [sum.sum(), packed.len() as u32, stated(content.len())];
            let fields = [20u16.to_le_bytes(), [0, 0], [8, 0], [0, 0], [0, 0]].concat();
            let sizes: Vec<u8> = sizes.iter().flat_map(|size| size.to_le_bytes()).collect();
            let names = [(name.len() as u16).to_le_bytes(), [0, 0]].concat();
            for part in [b"PK\x03\x04", &fields[..], &sizes, &names, name.as_bytes(), &packed] {
                bytes.extend(part);
            }
            let rest = [&[0; 10][..], &start.to_le_bytes()].concat();
            for part in [b"PK\x01\x02\x14\x00", &fields[..], &sizes, &names, &rest, name.as_bytes()] {
                directory.extend(part);
            }
        }
        let (count, start) = ((entries.len() as u16).to_le_bytes(), bytes.len() as u32);
        let length = (directory.len() as u32).to_le_bytes();
        bytes.extend(directory);
        for part in [b"PK\x05\x06\0\0\0\0", &count[..], &count, &length, &start.to_le_bytes(), &[0, 0]] {
            bytes.extend(part);
        }
        bytes
    }

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
    fn a_compressed_array_is_unpacked_up_to_what_it_states() {
        let header = "{'descr': '<f2', 'fortran_order': False, 'shape': (3,), }";
        let content = array(header, &[0x00, 0x3c, 0x00, 0xc0, 0x01, 0x00]);
        let arrays = loaded(&deflated(&[("a.npy", &content)], |n| n as u32)).unwrap();
        assert_eq!(arrays["a"].iter().copied().collect::<Vec<_>>(), [1.0, -2.0, 2f64.powi(-24)]);
        let refused =
            |stated: fn(usize) -> u32| loaded(&deflated(&[("a.npy", &content)], stated)).unwrap_err();
        assert!(refused(|n| n as u32 - 1).contains("a: more than"), "{}", refused(|n| n as u32 - 1));
        assert!(refused(|n| n as u32 + 1).contains("bytes, it states"));
        assert!(refused(|_| u32::MAX - 1).contains("4294967294 bytes when unpacked, at most 1 GiB are read"));
        let mut damaged = deflated(&[("a.npy", &content)], |n| n as u32);
        damaged[14] ^= 1;
        // The directory's checksum counts, and it is the same twice.
        let at = damaged.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
        damaged[at + 16] ^= 1;
        assert!(loaded(&damaged).unwrap_err().contains("a: its checksum is wrong"));
    }

    #[test]
    fn two_arrays_of_one_name_and_names_that_no_terminal_shows_are_rejected() {
        let content = array("{'descr': '|u1', 'fortran_order': False, 'shape': (1,), }", &[1]);
        for names in [["a.npy", "a.npy"], ["a.npy", "a"]] {
            let file = deflated(&names.map(|name| (name, &content[..])), |n| n as u32);
            let told = loaded(&file).unwrap_err();
            assert!(told.contains("the same name") || told.contains("have the name a"), "{told}");
        }
        let told = loaded(&npz(&[("a\x1b[31m.npy", &content)])).unwrap_err();
        assert!(told.contains("the name of its array 1 holds a control character"), "{told}");
        let header = br#"{"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}}"#;
        let file = [&(header.len() as u64).to_le_bytes()[..], header, &[7]].concat();
        assert!(loaded(&file).unwrap_err().contains("two of its arrays have the name a"));
    }

    #[test]
    fn an_npy_file_holds_one_array_of_its_own_name() {
        let content = array("{'descr': '<f4', 'fortran_order': False, 'shape': (), }", &1.5f32.to_le_bytes());
        assert_eq!(loaded(&content).unwrap()["x"].sum(), 1.5);
    }

    #[test]
    fn halves_are_what_they_stand_for() {
        let all = [0x0000, 0x8000, 0x3c00, 0x3555, 0x7bff, 0x0400, 0x03ff].map(half);
        let expected = [0.0, -0.0, 1.0, 0.333_251_953_125, 65504.0, 2f64.powi(-14), 1023.0 * 2f64.powi(-24)];
        assert_eq!(all, expected);
        assert!(half(0x7c00).is_infinite() && half(0xfe00).is_nan());
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
    fn claims_that_the_file_does_not_hold_are_rejected() {
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
            assert!(loaded(bytes).unwrap_err().contains("not a whole NPZ, NPY or safetensors file"));
        }
        assert!(
            read(Path::new("/dev/zero"))
                .unwrap_err()
                .to_string()
                .contains("a device, expected a regular file")
        );
    }
}
