//! The file both kinds of network live in: safetensors, with one metadata entry `edof`, JSON that holds the form, the number
//! formats, the origin and a SHA-256. The same network gives the same bytes.
//!
//! The hash covers all of it: the text of the entry `edof` with the 64 digits of `sha256` written as zeros, then of each tensor, by
//! name, its name, type, shape and bytes (the first three as in `analysis F32 [192, 144]`).

use crate::fixed_network::{FixedMatrix, FixedNetwork, FixedNetworkError, Quantized};
use crate::network::{Form, Network, NetworkError, Origin};
use edof_core::geometry::Stride;
use edof_core::number::{CHROMA_GAIN, OUTPUT_FRACTION};
use edof_core::overlap::Overlap;
use edof_core::storage::arrays::safetensors_reason;
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::digest::hexadecimal;
use edof_core::storage::{input, json};
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
    /// A float network of several exposures, of which no fixed network can be made.
    #[error("{path}: {source}", path = path.display())]
    Exposures { path: PathBuf, source: NetworkError },
    /// Changed after the file was made: a tensor, a format, or its record of origin.
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
    Ok(atomic::write(path, &network_bytes(path, network)?)?)
}

/// Returns what [`save_network`] writes; `path` names it in errors.
///
/// # Errors
/// As [`save_network`], but `Write`.
pub fn network_bytes(path: &Path, network: &Network) -> Result<Vec<u8>, WeightFileError> {
    network.check().map_err(|source| WeightFileError::Network { path: path.to_owned(), source })?;
    let mut tensors = vec![
        Tensor::matrix("analysis", &network.analysis),
        Tensor::matrix("dictionary", &network.dictionary),
    ];
    tensors.extend(network.linear_path.iter().map(|r| Tensor::matrix("linear_path", r)));
    tensors.extend(numbered("recurrent", &network.recurrent, Tensor::matrix));
    tensors.extend(numbered("threshold", &network.thresholds, Tensor::vector));
    serialized(path, tensors, network.form, network.origin.clone(), None)
}

/// Loads a float network.
///
/// # Errors
/// Any [`WeightFileError`] but `Write`; NaN in weights, foreign and truncated files among them.
pub fn load_network(path: &Path) -> Result<Network, WeightFileError> {
    parse_network(read(path)?, path)
}

/// [`load_network`] for bytes available; `path` names them in errors.
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

/// SHA-256 that a weight file available states (and has), as hexadecimal digits; what [`FixedNetwork::float_hash`] holds. `path` names
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
    Ok(atomic::write(path, &serialized(path, tensors, network.form, network.origin.clone(), Some(fixed))?)?)
}

/// Loads a fixed network.
///
/// # Errors
/// Any [`WeightFileError`] but `Write`.
pub fn load_fixed(path: &Path) -> Result<FixedNetwork, WeightFileError> {
    parse_fixed(read(path)?, path)
}

/// [`load_fixed`] for bytes available; `path` names them in errors.
///
/// # Errors
/// As [`load_fixed`].
pub fn parse_fixed(bytes: Vec<u8>, path: &Path) -> Result<FixedNetwork, WeightFileError> {
    let file = Loaded::parse(bytes, path)?;
    let Some(fixed) = file.metadata.fixed.clone() else {
        let single = file.metadata.form.check_single();
        single.map_err(|source| WeightFileError::Exposures { path: path.to_owned(), source })?;
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

fn serialized(
    path: &Path,
    tensors: Vec<Tensor>,
    form: Form,
    origin: Origin,
    fixed: Option<FixedMetadata>,
) -> Result<Vec<u8>, WeightFileError> {
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
    safetensors::serialize(views, Some(HashMap::from([(METADATA_KEY.to_owned(), text)])))
        .map_err(|e| container(e.to_string()))
}

/// The metadata's text with another hash. It is the last field, so its digits' last occurrence is meant.
fn with_hash(text: &str, old: &str, new: &str) -> String {
    match text.rsplit_once(old) {
        Some((before, after)) => [before, new, after].concat(),
        None => text.to_owned(),
    }
}

fn read(path: &Path) -> Result<Vec<u8>, WeightFileError> {
    input::read(path).map_err(|source| WeightFileError::Read { path: path.to_owned(), source })
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
            reason: safetensors_reason(&e),
        };
        let foreign = |reason: String| WeightFileError::Foreign { path: path.to_owned(), reason };
        let (_, header) = SafeTensors::read_metadata(&bytes).map_err(container)?;
        let text = header
            .metadata()
            .as_ref()
            .and_then(|m| m.get(METADATA_KEY))
            .ok_or_else(|| foreign(format!("its metadata has no entry '{METADATA_KEY}'")))?;
        let metadata: Metadata =
            json::parse(text).map_err(|e| foreign(format!("its metadata is wrong: {e}")))?;
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
                "tensor '{name}' is {} with {} dimensions, expected {} with {dimensions}",
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
mod tests;
