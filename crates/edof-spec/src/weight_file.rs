//! The file both kinds of network live in: safetensors, with one metadata entry `edof`, JSON that holds the form, the number
//! formats, the origin and a SHA-256. The same network gives the same bytes.
//!
//! The hash covers all of it: the text of the entry `edof` with the 64 digits of `sha256` written as zeros, then of each tensor, by
//! name, its name, type, shape and bytes (the first three as in `analysis F32 [192, 144]`).

use crate::atomic::{self, WriteError};
use crate::digest::hexadecimal;
use crate::fixed_network::{FixedMatrix, FixedNetwork, FixedNetworkError, Quantized};
use crate::geometry::Stride;
use crate::network::{Form, Network, NetworkError, Origin};
use crate::number::{CHROMA_GAIN, OUTPUT_FRACTION};
use crate::overlap::Overlap;
use ndarray::{Array1, Array2};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Key of the metadata entry.
const METADATA_KEY: &str = "edof";
/// Version of the metadata's layout.
const LAYOUT: u32 = 2;
/// What stands for the hash while it is taken.
const NO_HASH: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// A weight file that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum WeightFileError {
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Truncated, or not safetensors at all.
    #[error("{path}: not a whole safetensors file: {reason}", path = path.display())]
    Container { path: PathBuf, reason: String },
    /// Safetensors, but not ours.
    #[error("{path}: not an edof weight file: {reason}", path = path.display())]
    Foreign { path: PathBuf, reason: String },
    /// A float file where a fixed one was expected, or the other way round.
    #[error("{path}: holds a {found} network, expected a {expected} one", path = path.display())]
    Kind { path: PathBuf, found: &'static str, expected: &'static str },
    /// Changed after the file was made: a tensor, a format, or what it tells of its origin.
    #[error("{path}: has SHA-256 {found}, it states {stated}: it was changed after it was made", path = path.display())]
    Hash { path: PathBuf, found: String, stated: String },
    /// The float network does not fit its form.
    #[error("{path}: {source}", path = path.display())]
    Network { path: PathBuf, source: NetworkError },
    /// The fixed network cannot run.
    #[error("{path}: {source}", path = path.display())]
    FixedNetwork { path: PathBuf, source: FixedNetworkError },
}

#[derive(Serialize, Deserialize)]
struct Metadata {
    layout: u32,
    form: Form,
    origin: Origin,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fixed: Option<FixedMetadata>,
    sha256: String,
}

#[derive(Clone, Serialize, Deserialize)]
struct FixedMetadata {
    code_bits: u32,
    stride: Stride,
    overlap: Overlap,
    /// Fraction bits of b_t and z_t, t = 1…T−1.
    code_fractions: Vec<u32>,
    weight_fractions: WeightFractions,
    /// Fraction bits of F's outputs, and what its chroma is multiplied by; the same for all networks.
    output_fraction: u32,
    chroma_gain: f64,
    float_sha256: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    quantized: Option<Quantized>,
}

/// Fraction bits of the matrices, in a fixed order.
#[derive(Clone, Serialize, Deserialize)]
struct WeightFractions {
    analysis: u32,
    recurrent: Vec<u32>,
    dictionary: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    linear_path: Option<u32>,
}

/// Saves a float network.
///
/// # Errors
/// [`WeightFileError::Network`] if it does not fit its form, [`WeightFileError::Write`] if the file cannot be written.
pub fn save_network(path: &Path, network: &Network) -> Result<(), WeightFileError> {
    network.check().map_err(|source| WeightFileError::Network { path: path.to_owned(), source })?;
    let mut tensors = vec![
        Tensor::matrix("analysis", &network.analysis),
        Tensor::matrix("dictionary", &network.dictionary),
    ];
    tensors.extend(network.linear_path.iter().map(|r| Tensor::matrix("linear_path", r)));
    tensors.extend(numbered("recurrent", &network.recurrent, Tensor::matrix));
    tensors.extend(numbered("threshold", &network.thresholds, Tensor::vector));
    save(path, tensors, network.form, network.origin.clone(), None)
}

/// Loads a float network.
///
/// # Errors
/// Any [`WeightFileError`] but `Write`; NaN in weights, foreign and truncated files among them.
pub fn load_network(path: &Path) -> Result<Network, WeightFileError> {
    parse_network(read(path)?, path)
}

/// [`load_network`] for bytes at hand; `path` names them in errors.
///
/// # Errors
/// As [`load_network`].
pub fn parse_network(bytes: Vec<u8>, path: &Path) -> Result<Network, WeightFileError> {
    let file = Loaded::parse(bytes, path)?;
    if file.metadata.fixed.is_some() {
        return Err(WeightFileError::Kind { path: path.to_owned(), found: "fixed", expected: "float" });
    }
    let form = file.metadata.form;
    form.check().map_err(|source| WeightFileError::Network { path: path.to_owned(), source })?;
    let network = Network {
        form,
        analysis: file.matrix::<f32>("analysis")?,
        thresholds: file.numbered(form.shrinkages(), "threshold", Loaded::vector::<f32>)?,
        recurrent: file.numbered(form.recurrent_matrices(), "recurrent", Loaded::matrix::<f32>)?,
        dictionary: file.matrix::<f32>("dictionary")?,
        linear_path: form.linear_path.then(|| file.matrix::<f32>("linear_path")).transpose()?,
        origin: file.metadata.origin,
    };
    network.check().map_err(|source| WeightFileError::Network { path: path.to_owned(), source })?;
    Ok(network)
}

/// SHA-256 that a weight file at hand states (and has), as hexadecimal digits; what [`FixedNetwork::float_hash`] holds. `path` names
/// it in errors.
///
/// # Errors
/// As [`load_network`].
pub fn parse_hash(bytes: Vec<u8>, path: &Path) -> Result<String, WeightFileError> {
    Ok(Loaded::parse(bytes, path)?.metadata.sha256)
}

/// Saves a fixed network.
///
/// # Errors
/// [`WeightFileError::FixedNetwork`] if it could not run exactly, [`WeightFileError::Write`].
pub fn save_fixed(path: &Path, network: &FixedNetwork) -> Result<(), WeightFileError> {
    network.check().map_err(|source| WeightFileError::FixedNetwork { path: path.to_owned(), source })?;
    let mut tensors = vec![
        Tensor::matrix("analysis", &network.analysis.weights),
        Tensor::matrix("dictionary", &network.dictionary.weights),
    ];
    tensors.extend(network.linear_path.iter().map(|r| Tensor::matrix("linear_path", &r.weights)));
    tensors.extend(numbered("recurrent", &network.recurrent, |n, s| Tensor::matrix(n, &s.weights)));
    tensors.extend(numbered("threshold", &network.thresholds, Tensor::vector));
    let fixed = FixedMetadata {
        code_bits: network.code_bits,
        stride: network.stride,
        overlap: network.overlap,
        code_fractions: network.code_fractions.clone(),
        weight_fractions: WeightFractions {
            analysis: network.analysis.fraction,
            recurrent: network.recurrent.iter().map(|s| s.fraction).collect(),
            dictionary: network.dictionary.fraction,
            linear_path: network.linear_path.as_ref().map(|r| r.fraction),
        },
        output_fraction: OUTPUT_FRACTION,
        chroma_gain: CHROMA_GAIN,
        float_sha256: network.float_hash.clone(),
        quantized: network.quantized.clone(),
    };
    save(path, tensors, network.form, network.origin.clone(), Some(fixed))
}

/// Loads a fixed network.
///
/// # Errors
/// Any [`WeightFileError`] but `Write`.
pub fn load_fixed(path: &Path) -> Result<FixedNetwork, WeightFileError> {
    parse_fixed(read(path)?, path)
}

/// [`load_fixed`] for bytes at hand; `path` names them in errors.
///
/// # Errors
/// As [`load_fixed`].
pub fn parse_fixed(bytes: Vec<u8>, path: &Path) -> Result<FixedNetwork, WeightFileError> {
    let file = Loaded::parse(bytes, path)?;
    let Some(fixed) = file.metadata.fixed.clone() else {
        return Err(WeightFileError::Kind { path: path.to_owned(), found: "float", expected: "fixed" });
    };
    if (fixed.output_fraction, fixed.chroma_gain) != (OUTPUT_FRACTION, CHROMA_GAIN) {
        let reason = format!(
            "its outputs have {} fraction bits and a chroma gain of {}, the board's {OUTPUT_FRACTION} and {CHROMA_GAIN}",
            fixed.output_fraction, fixed.chroma_gain
        );
        return Err(WeightFileError::Foreign { path: path.to_owned(), reason });
    }
    let form = file.metadata.form;
    form.check().map_err(|source| WeightFileError::Network { path: path.to_owned(), source })?;
    let fractions = fixed.weight_fractions;
    let matrix = |name: &str, fraction: u32| {
        Ok::<_, WeightFileError>(FixedMatrix { weights: file.matrix::<i16>(name)?, fraction })
    };
    let recurrent = (0..form.recurrent_matrices())
        .zip(&fractions.recurrent)
        .map(|(i, &fraction)| matrix(&format!("recurrent.{i}"), fraction))
        .collect::<Result<Vec<_>, _>>()?;
    let network = FixedNetwork {
        form,
        code_bits: fixed.code_bits,
        stride: fixed.stride,
        overlap: fixed.overlap,
        analysis: matrix("analysis", fractions.analysis)?,
        thresholds: file.numbered(form.shrinkages(), "threshold", Loaded::vector::<i16>)?,
        recurrent,
        dictionary: matrix("dictionary", fractions.dictionary)?,
        linear_path: fractions.linear_path.map(|fraction| matrix("linear_path", fraction)).transpose()?,
        code_fractions: fixed.code_fractions,
        origin: file.metadata.origin.clone(),
        float_hash: fixed.float_sha256,
        quantized: fixed.quantized,
    };
    network.check().map_err(|source| WeightFileError::FixedNetwork { path: path.to_owned(), source })?;
    Ok(network)
}

/// A number type of a tensor.
trait Element: Copy {
    const DTYPE: Dtype;
    const BYTES: usize;
    fn put(self, out: &mut Vec<u8>);
    fn get(bytes: &[u8]) -> Self;
}

macro_rules! element {
    ($number:ty, $dtype:expr) => {
        impl Element for $number {
            const DTYPE: Dtype = $dtype;
            const BYTES: usize = size_of::<$number>();
            fn put(self, out: &mut Vec<u8>) {
                out.extend(self.to_le_bytes());
            }
            fn get(bytes: &[u8]) -> Self {
                let mut word = [0; size_of::<$number>()];
                word.copy_from_slice(bytes);
                Self::from_le_bytes(word)
            }
        }
    };
}
element!(f32, Dtype::F32);
element!(i16, Dtype::I16);

struct Tensor {
    name: String,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Tensor {
    fn matrix<T: Element>(name: impl Into<String>, values: &Array2<T>) -> Self {
        Self::new(name, vec![values.nrows(), values.ncols()], values.iter())
    }

    fn vector<T: Element>(name: impl Into<String>, values: &Array1<T>) -> Self {
        Self::new(name, vec![values.len()], values.iter())
    }

    fn new<'a, T: Element + 'a>(
        name: impl Into<String>,
        shape: Vec<usize>,
        values: impl Iterator<Item = &'a T>,
    ) -> Self {
        let mut bytes = Vec::with_capacity(shape.iter().product::<usize>() * T::BYTES);
        values.for_each(|v| v.put(&mut bytes));
        Self { name: name.into(), dtype: T::DTYPE, shape, bytes }
    }
}

fn numbered<'a, V>(
    what: &'a str,
    values: &'a [V],
    tensor: impl Fn(String, &V) -> Tensor + 'a,
) -> impl Iterator<Item = Tensor> + 'a {
    values.iter().enumerate().map(move |(i, v)| tensor(format!("{what}.{i}"), v))
}

/// The hash of a file whose metadata entry is `text`, in which the hash itself is [`NO_HASH`].
fn hash<'a>(text: &str, tensors: impl Iterator<Item = (&'a str, Dtype, &'a [usize], &'a [u8])>) -> String {
    let mut sorted: Vec<_> = tensors.collect();
    sorted.sort_unstable_by_key(|(name, ..)| *name);
    let mut digest = Sha256::new();
    digest.update(text);
    for (name, dtype, shape, bytes) in sorted {
        digest.update(format!("{name} {dtype:?} {shape:?}"));
        digest.update(bytes);
    }
    hexadecimal(digest.finalize().as_slice())
}

fn save(
    path: &Path,
    tensors: Vec<Tensor>,
    form: Form,
    origin: Origin,
    fixed: Option<FixedMetadata>,
) -> Result<(), WeightFileError> {
    let container = |reason: String| WeightFileError::Container { path: path.to_owned(), reason };
    let metadata = Metadata { layout: LAYOUT, form, origin, fixed, sha256: NO_HASH.to_owned() };
    let blank = serde_json::to_string(&metadata).map_err(|e| container(e.to_string()))?;
    let parts = tensors.iter().map(|t| (t.name.as_str(), t.dtype, t.shape.as_slice(), t.bytes.as_slice()));
    let text = with_hash(&blank, NO_HASH, &hash(&blank, parts));
    let views = tensors
        .iter()
        .map(|t| Ok((t.name.as_str(), TensorView::new(t.dtype, t.shape.clone(), &t.bytes)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
        .map_err(|e| container(e.to_string()))?;
    let bytes = safetensors::serialize(views, Some(HashMap::from([(METADATA_KEY.to_owned(), text)])))
        .map_err(|e| container(e.to_string()))?;
    Ok(atomic::write(path, &bytes)?)
}

/// The metadata's text with another hash. It is the last field, so its digits' last occurrence is meant.
fn with_hash(text: &str, old: &str, new: &str) -> String {
    match text.rsplit_once(old) {
        Some((before, after)) => [before, new, after].concat(),
        None => text.to_owned(),
    }
}

fn read(path: &Path) -> Result<Vec<u8>, WeightFileError> {
    std::fs::read(path).map_err(|source| WeightFileError::Read { path: path.to_owned(), source })
}

struct Loaded {
    path: PathBuf,
    bytes: Vec<u8>,
    metadata: Metadata,
}

impl Loaded {
    fn parse(bytes: Vec<u8>, path: &Path) -> Result<Self, WeightFileError> {
        let container = |e: safetensors::SafeTensorError| WeightFileError::Container {
            path: path.to_owned(),
            reason: e.to_string(),
        };
        let foreign = |reason: String| WeightFileError::Foreign { path: path.to_owned(), reason };
        let (_, header) = SafeTensors::read_metadata(&bytes).map_err(container)?;
        let text = header
            .metadata()
            .as_ref()
            .and_then(|m| m.get(METADATA_KEY))
            .ok_or_else(|| foreign(format!("its metadata has no entry '{METADATA_KEY}'")))?;
        let metadata: Metadata =
            serde_json::from_str(text).map_err(|e| foreign(format!("its metadata is wrong: {e}")))?;
        if metadata.layout != LAYOUT {
            return Err(foreign(format!("layout {}, this program reads {LAYOUT}", metadata.layout)));
        }
        let found = {
            let tensors = SafeTensors::deserialize(&bytes).map_err(container)?;
            let views = tensors.tensors();
            let parts = views.iter().map(|(name, v)| (name.as_str(), v.dtype(), v.shape(), v.data()));
            hash(&with_hash(text, &metadata.sha256, NO_HASH), parts)
        };
        if found != metadata.sha256 {
            return Err(WeightFileError::Hash { path: path.to_owned(), found, stated: metadata.sha256 });
        }
        Ok(Self { path: path.to_owned(), bytes, metadata })
    }

    fn tensor<T: Element>(
        &self,
        name: &str,
        dimensions: usize,
    ) -> Result<(Vec<usize>, Vec<T>), WeightFileError> {
        let foreign = |reason: String| WeightFileError::Foreign { path: self.path.clone(), reason };
        let tensors = SafeTensors::deserialize(&self.bytes).map_err(|e| foreign(e.to_string()))?;
        let view = tensors.tensor(name).map_err(|_| foreign(format!("tensor '{name}' is missing")))?;
        if view.dtype() != T::DTYPE || view.shape().len() != dimensions {
            return Err(foreign(format!(
                "tensor '{name}' is {:?} with {} dimensions, expected {:?} with {dimensions}",
                view.dtype(),
                view.shape().len(),
                T::DTYPE
            )));
        }
        Ok((view.shape().to_vec(), view.data().chunks_exact(T::BYTES).map(T::get).collect()))
    }

    fn matrix<T: Element>(&self, name: &str) -> Result<Array2<T>, WeightFileError> {
        let (shape, values) = self.tensor(name, 2)?;
        Array2::from_shape_vec((shape[0], shape[1]), values)
            .map_err(|e| WeightFileError::Foreign { path: self.path.clone(), reason: e.to_string() })
    }

    fn vector<T: Element>(&self, name: &str) -> Result<Array1<T>, WeightFileError> {
        Ok(Array1::from_vec(self.tensor(name, 1)?.1))
    }

    fn numbered<V>(
        &self,
        count: usize,
        what: &str,
        load: impl Fn(&Self, &str) -> Result<V, WeightFileError>,
    ) -> Result<Vec<V>, WeightFileError> {
        (0..count).map(|i| load(self, &format!("{what}.{i}"))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::fixed_network::CalibratedOn;
    use crate::geometry::Window;
    use crate::network::{Condition, Recurrence, Shrinkage};
    use crate::noise::Noise;
    use crate::provenance::Provenance;
    use crate::tone::Tone;

    fn small_network() -> Network {
        let form = Form {
            window: Window::new(8).unwrap(),
            codes: 4,
            layers: 4,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Direct,
            linear_path: true,
            tied: false,
        };
        let ramp = |h, w| Array2::from_shape_fn((h, w), |(r, c)| (r * w + c) as f32 / 100.0);
        Network {
            form,
            analysis: ramp(4, 64),
            thresholds: vec![Array1::zeros(4); 3],
            recurrent: vec![ramp(4, 4), ramp(4, 4)],
            dictionary: ramp(192, 4),
            linear_path: Some(ramp(192, 64)),
            origin: Origin::untrained("small", Camera::resolve("clear").unwrap()),
        }
    }

    fn saved(change: impl FnOnce(&mut Network)) -> (tempfile::TempDir, PathBuf, Network) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("net.safetensors");
        let mut network = small_network();
        change(&mut network);
        save_network(&path, &network).unwrap();
        (dir, path, network)
    }

    #[test]
    fn a_network_comes_back_and_the_same_network_gives_the_same_bytes() {
        let (dir, path, network) = saved(|_| ());
        assert_eq!(load_network(&path).unwrap(), network);
        let again = dir.path().join("again");
        save_network(&again, &network).unwrap();
        assert_eq!(std::fs::read(path).unwrap(), std::fs::read(again).unwrap());
    }

    fn small_fixed() -> FixedNetwork {
        let float = small_network();
        let whole = |m: &Array2<f32>| FixedMatrix { weights: m.mapv(|v| v as i16), fraction: 12 };
        FixedNetwork {
            form: float.form,
            code_bits: 16,
            stride: Stride::PATCH,
            overlap: Overlap::Hann,
            analysis: whole(&float.analysis),
            thresholds: vec![Array1::zeros(4); 3],
            recurrent: float.recurrent.iter().map(whole).collect(),
            dictionary: FixedMatrix { weights: Array2::ones((128, 4)), fraction: 12 },
            linear_path: Some(FixedMatrix { weights: Array2::ones((128, 64)), fraction: 12 }),
            code_fractions: vec![12, 11, 13],
            origin: float.origin,
            float_hash: "0".into(),
            quantized: Some(Quantized {
                headroom: 2.0,
                calibration: CalibratedOn {
                    stride: Stride::new(2).unwrap(),
                    windows: 5,
                    psis: vec![0.0, 0.1],
                    conditions: vec![Condition { tone: Tone::Srgb, noise: Noise::sensor(2.0) }],
                    depth: 12,
                },
                finetune_steps: 0,
                provenance: Provenance { command: "edof quantize small".into(), ..Provenance::default() },
            }),
        }
    }

    #[test]
    fn a_fixed_network_comes_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("net.fixed.safetensors");
        let fixed = small_fixed();
        save_fixed(&path, &fixed).unwrap();
        assert_eq!(load_fixed(&path).unwrap(), fixed);
        assert!(matches!(load_network(&path), Err(WeightFileError::Kind { found: "fixed", .. })));
    }

    /// The metadata's text of a saved file, changed and put back at the same length.
    fn with_metadata(path: &Path, change: impl Fn(&str) -> String) {
        let bytes = std::fs::read(path).unwrap();
        let header = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
        let text = String::from_utf8(bytes[8..8 + header].to_vec()).unwrap();
        let changed = change(&text);
        assert_ne!(changed, text);
        let header = (changed.len() as u64).to_le_bytes();
        std::fs::write(path, [&header[..], changed.as_bytes(), &bytes[8 + text.len()..]].concat()).unwrap();
    }

    #[test]
    fn a_changed_word_of_the_metadata_is_noticed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("net.fixed.safetensors");
        let texts = [
            ("edof quantize small", "edof quantize large"),
            (r#"\"headroom\":2.0"#, r#"\"headroom\":3.0"#),
            (r#"\"code_fractions\":[12,11,13]"#, r#"\"code_fractions\":[12,11,12]"#),
            (r#"\"name\":\"small\""#, r#"\"name\":\"other\""#),
            (r#"\"float_sha256\":\"0\""#, r#"\"float_sha256\":\"1\""#),
        ];
        for (old, new) in texts {
            save_fixed(&path, &small_fixed()).unwrap();
            with_metadata(&path, |text| text.replacen(old, new, 1));
            assert!(matches!(load_fixed(&path), Err(WeightFileError::Hash { .. })), "{old}");
        }
    }

    #[test]
    fn outputs_in_another_format_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("net.fixed.safetensors");
        let fixed = small_fixed();
        save_fixed(&path, &fixed).unwrap();
        let (hash, digits) = (parse_hash(std::fs::read(&path).unwrap(), &path).unwrap(), 64);
        assert_eq!(hash.len(), digits);
        // A file of another maker, whose hash is right.
        with_metadata(&path, |text| {
            text.replacen(r#"\"output_fraction\":14"#, r#"\"output_fraction\":13"#, 1)
        });
        let Err(WeightFileError::Hash { found, .. }) = load_fixed(&path) else { panic!("hash") };
        with_metadata(&path, |text| text.replacen(&hash, &found, 1));
        let error = load_fixed(&path).unwrap_err().to_string();
        assert!(error.contains("its outputs have 13 fraction bits"), "{error}");
    }

    #[test]
    fn fraction_bits_beyond_every_format_are_refused() {
        for change in [
            |n: &mut FixedNetwork| n.analysis.fraction = u32::MAX,
            |n: &mut FixedNetwork| n.recurrent[1].fraction = u32::MAX - 3,
            |n: &mut FixedNetwork| n.dictionary.fraction = 1 << 31,
            |n: &mut FixedNetwork| n.code_fractions[2] = u32::MAX,
            |n: &mut FixedNetwork| n.linear_path.as_mut().unwrap().fraction = 49,
        ] {
            let mut fixed = small_fixed();
            change(&mut fixed);
            assert!(matches!(fixed.check(), Err(FixedNetworkError::Fraction { .. })));
        }
    }

    #[test]
    fn a_truncated_file_is_refused_wherever_it_ends() {
        let (_dir, path, _) = saved(|_| ());
        let whole = std::fs::read(&path).unwrap();
        for kept in [0, 4, 100, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&path, &whole[..kept]).unwrap();
            assert!(matches!(load_network(&path), Err(WeightFileError::Container { .. })), "{kept} bytes");
        }
    }

    #[test]
    fn a_changed_weight_is_noticed() {
        let (_dir, path, _) = saved(|_| ());
        let mut bytes = std::fs::read(&path).unwrap();
        *bytes.last_mut().unwrap() ^= 1;
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(load_network(&path), Err(WeightFileError::Hash { .. })));
    }

    #[test]
    fn nan_in_weights_is_refused_on_saving() {
        let dir = tempfile::tempdir().unwrap();
        let mut network = small_network();
        network.recurrent[1][(0, 0)] = f32::NAN;
        let error = save_network(&dir.path().join("n"), &network).unwrap_err().to_string();
        assert!(error.ends_with("recurrent: holds NaN, every weight must be a finite number"), "{error}");
    }

    #[test]
    fn a_foreign_safetensors_file_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("foreign");
        let none: Vec<(&str, TensorView<'_>)> = vec![];
        std::fs::write(&path, safetensors::serialize(none, None).unwrap()).unwrap();
        assert!(matches!(load_network(&path), Err(WeightFileError::Foreign { .. })));
    }
}
