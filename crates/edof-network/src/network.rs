//! The float network (docs/contract.md is its integer form): its form, its matrices, where it came from.
//!
//! ```text
//! b₁      = A y                   I layer
//! z_t     = shrink_θt(b_t)        t = 1…T−1
//! b_{t+1} = b₁ + S_t z_t          M layers, t = 1…T−2        (direct)
//! b_{t+1} = b_t + S_t (z_t − z_{t−1}), z_0 = 0               (difference)
//! x       = D z_{T−1} + R y       F layer, R where the form has a linear path
//! ```
//!
//! y is a raw window. A form of several exposures sees the same window of as many raw frames: y is one after the other.

pub use crate::shrinkage::Shrinkage;
use edof_core::camera::Camera;
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::Window;
use edof_core::noise::Noise;
use edof_core::storage::provenance::Provenance;
use edof_core::tone::Tone;
use ndarray::{Array1, Array2};
use serde::{Deserialize, Serialize};

/// What an M layer adds its product to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Recurrence {
    /// To b₁.
    Direct,
    /// To the previous b, multiplying the change of z (the paper's Algorithm 1).
    Difference,
}

/// The form of a network; from it follow the shapes of all its matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    /// Side of the raw window.
    pub window: Window,
    /// Length of b and z.
    pub codes: usize,
    /// T: one I, T − 2 M, one F.
    pub layers: usize,
    /// The non-linearity.
    pub shrinkage: Shrinkage,
    /// What M layers add to.
    pub recurrence: Recurrence,
    /// Whether F also sees the raw window through R.
    pub linear_path: bool,
    /// Whether all M layers share one S.
    pub tied: bool,
    /// Raw frames of the scene that it sees, each with its share of the exposure time and its own focus. Integers have one ([`Form::check_single`]).
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub exposures: usize,
}

const fn one() -> usize {
    1
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
const fn is_one(count: &usize) -> bool {
    *count == 1
}

/// A form that no network has, or matrices that do not fit their form.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum NetworkError {
    /// T out of range.
    #[error("layers {0}: must be 2 to 10")]
    Layers(usize),
    /// More layers than a network was trained with, or fewer than two.
    #[error("layers {layers}: must be 2 to {trained}, the layers of this network")]
    Fewer { layers: usize, trained: usize },
    /// Length of the sparse code out of range.
    #[error("codes {0}: must be 1 to 1024")]
    Codes(usize),
    /// Number of raw frames out of range.
    #[error("exposures {0}: must be 1 to {MAX_EXPOSURES}")]
    Exposures(usize),
    /// Several raw frames where only one is taken.
    #[error(
        "exposures {0}: must be 1 here; a network of several raw frames is computed in floating point on the CPU alone, by 'edof reconstruct' \
         with all raw frames of a scene"
    )]
    Several(usize),
    /// Foci that are not one for each exposure.
    #[error("further_foci: {found} given, a form of exposures {exposures} has {}", exposures - 1)]
    Foci { found: usize, exposures: usize },
    /// Wrong number of matrices or thresholds.
    #[error("{what}: {found} given, this form has {expected}")]
    Count { what: &'static str, found: usize, expected: usize },
    /// A matrix of the wrong shape.
    #[error("{what}: {rows}x{columns}, this form needs {expected_rows}x{expected_columns}")]
    Shape { what: &'static str, rows: usize, columns: usize, expected_rows: usize, expected_columns: usize },
    /// NaN or infinity.
    #[error("{what}: holds {value}, every weight must be a finite number")]
    NotFinite { what: &'static str, value: f32 },
    /// A negative threshold of a shrinkage that has none.
    #[error("thresholds: holds {value}, {shrinkage} shrinkage needs thresholds of 0 or more")]
    NegativeThreshold { shrinkage: Shrinkage, value: f32 },
}

/// Most raw frames of one network.
pub const MAX_EXPOSURES: usize = 4;

impl Form {
    /// # Errors
    /// [`NetworkError::Layers`], [`NetworkError::Codes`] or [`NetworkError::Exposures`].
    pub const fn check(&self) -> Result<(), NetworkError> {
        if self.layers < 2 || self.layers > 10 {
            return Err(NetworkError::Layers(self.layers));
        }
        if self.codes == 0 || self.codes > 1024 {
            return Err(NetworkError::Codes(self.codes));
        }
        if self.exposures == 0 || self.exposures > MAX_EXPOSURES {
            return Err(NetworkError::Exposures(self.exposures));
        }
        Ok(())
    }

    /// Rejects what integers, hardware and OpenCL do not have: several raw frames.
    ///
    /// # Errors
    /// [`NetworkError::Several`].
    pub const fn check_single(&self) -> Result<(), NetworkError> {
        if self.exposures == 1 { Ok(()) } else { Err(NetworkError::Several(self.exposures)) }
    }

    /// Values that go in: the pixels of the windows of all exposures, one window after the other.
    #[must_use]
    pub const fn inputs(&self) -> usize {
        self.exposures * self.window.pixels()
    }

    /// Multiplications that one window takes if every weight is multiplied, for an F of `outputs` rows (128 in the board's 4:2:2,
    /// 192 in RGB): codes·inputs + (T − 2)·codes² + outputs·codes, + outputs·inputs where R is used.
    #[must_use]
    pub const fn dense_multiplications(&self, outputs: usize) -> u64 {
        let linear = if self.linear_path { outputs * self.inputs() } else { 0 };
        let middle = self.middle_layers() * self.codes * self.codes;
        (self.codes * self.inputs() + middle + outputs * self.codes + linear) as u64
    }

    /// M layers: T − 2.
    #[must_use]
    pub const fn middle_layers(&self) -> usize {
        self.layers - 2
    }

    /// Soft thresholds: T − 1.
    #[must_use]
    pub const fn shrinkages(&self) -> usize {
        self.layers - 1
    }

    /// Distinct S matrices: T − 2, or 1 where they are tied.
    #[must_use]
    pub const fn recurrent_matrices(&self) -> usize {
        if self.tied && self.layers > 2 { 1 } else { self.layers - 2 }
    }

    /// Which of the S matrices M layer `layer` (0 first) uses.
    #[must_use]
    pub const fn recurrent_index(&self, layer: usize) -> usize {
        if self.tied { 0 } else { layer }
    }
}

/// A trained network. All arithmetic is in f32 on raw pixels of 0…1.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// Form of the network.
    pub form: Form,
    /// A: codes × inputs.
    pub analysis: Array2<f32>,
    /// θ_t: one vector of length codes a soft threshold.
    pub thresholds: Vec<Array1<f32>>,
    /// S_t: codes × codes each.
    pub recurrent: Vec<Array2<f32>>,
    /// D: 192 × codes, RGB.
    pub dictionary: Array2<f32>,
    /// R: 192 × inputs, RGB.
    pub linear_path: Option<Array2<f32>>,
    /// How it was made.
    pub origin: Origin,
}

/// How a network was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Name, as in `edof-t4w12`.
    pub name: String,
    /// Camera it was trained for; its `psi_range` is the range of depths.
    pub camera: Camera,
    /// Foci in ψ of the exposures after the first, which has the camera's focus.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_foci: Vec<f64>,
    /// Light and noise it was trained for: each tone convention, with the most noise of it.
    pub conditions: Vec<Condition>,
    /// What the values stand for that it takes and gives: light, or light encoded in a tone. Frames hold light, so they are encoded before
    /// such a network, and its picture is decoded.
    #[serde(default = "Tone::light", skip_serializing_if = "Tone::is_light")]
    pub values: Tone,
    /// Patches seen.
    pub patches: u64,
    /// Mean PSNR in dB on validation patches held out of the training photos.
    pub validation_db: f64,
    /// Mean count of non-zeros after each shrinkage, on the busiest quarter of validation patches; empty where it was not measured.
    #[serde(default)]
    pub non_zeros: Vec<f64>,
    /// The program, command and inputs that made it.
    pub provenance: Provenance,
}

/// One kind of light that a network was trained for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// What a photograph's numbers were taken for before the lens.
    pub tone: Tone,
    /// The most noise.
    pub noise: Noise,
    /// The least noise; none unless the network is of a class of noise.
    #[serde(default, skip_serializing_if = "is_none")]
    pub least_noise: Noise,
}

fn is_none(noise: &Noise) -> bool {
    *noise == Noise::None
}

impl Origin {
    /// The most noise of its first condition; none if it has no condition.
    #[must_use]
    pub fn max_noise(&self) -> Noise {
        self.conditions.first().map_or(Noise::None, |condition| condition.noise)
    }

    /// The most Gaussian noise of its conditions: σ in units of full scale, 0 where none has any.
    #[must_use]
    pub fn max_sigma(&self) -> f64 {
        let sigma = |c: &Condition| if let Noise::Gaussian { sigma } = c.noise { sigma } else { 0.0 };
        self.conditions.iter().map(sigma).fold(0.0, f64::max)
    }

    /// Returns the camera of each exposure: they differ in their focus.
    #[must_use]
    pub fn cameras(&self) -> Vec<Camera> {
        self.camera.focused_at(&self.further_foci)
    }

    /// Record of an untrained network, random or written by hand, for linear light without noise.
    #[must_use]
    pub fn untrained(name: &str, camera: Camera) -> Self {
        Self {
            name: name.to_owned(),
            camera,
            further_foci: vec![],
            conditions: vec![Condition { tone: Tone::Linear, noise: Noise::None, least_noise: Noise::None }],
            values: Tone::Linear,
            patches: 0,
            validation_db: 0.0,
            non_zeros: vec![],
            provenance: Provenance::default(),
        }
    }
}

impl Network {
    /// Returns the same network with fewer layers: A, its first thresholds and matrices S, D and R. It was not trained so.
    ///
    /// # Errors
    /// [`NetworkError::Fewer`] for fewer layers than any network has, or more than this one.
    pub fn with_layers(mut self, layers: usize) -> Result<Self, NetworkError> {
        if !(2..=self.form.layers).contains(&layers) {
            return Err(NetworkError::Fewer { layers, trained: self.form.layers });
        }
        self.form.layers = layers;
        self.thresholds.truncate(self.form.shrinkages());
        self.recurrent.truncate(self.form.recurrent_matrices());
        Ok(self)
    }

    /// # Errors
    /// [`NetworkError`] for the first thing that does not fit the form.
    pub fn check(&self) -> Result<(), NetworkError> {
        let form = &self.form;
        form.check()?;
        let (codes, inputs) = (form.codes, form.inputs());
        let further = self.origin.further_foci.len();
        if further + 1 != form.exposures {
            return Err(NetworkError::Foci { found: further, exposures: form.exposures });
        }
        check_count("thresholds", self.thresholds.len(), form.shrinkages())?;
        check_count("recurrent", self.recurrent.len(), form.recurrent_matrices())?;
        check_count("linear_path", self.linear_path.iter().count(), usize::from(form.linear_path))?;
        check_shape("analysis", self.analysis.dim(), (codes, inputs))?;
        for theta in &self.thresholds {
            check_shape("thresholds", (theta.len(), 1), (codes, 1))?;
            check_finite("thresholds", theta.iter())?;
            let shrinkage = form.shrinkage;
            let negative = theta.iter().find(|v| **v < 0.0 && !shrinkage.allows_negative());
            if let Some(&value) = negative {
                return Err(NetworkError::NegativeThreshold { shrinkage, value });
            }
        }
        for s in &self.recurrent {
            check_shape("recurrent", s.dim(), (codes, codes))?;
            check_finite("recurrent", s.iter())?;
        }
        check_shape("dictionary", self.dictionary.dim(), (RGB_OUTPUTS, codes))?;
        if let Some(r) = &self.linear_path {
            check_shape("linear_path", r.dim(), (RGB_OUTPUTS, inputs))?;
            check_finite("linear_path", r.iter())?;
        }
        check_finite("analysis", self.analysis.iter())?;
        check_finite("dictionary", self.dictionary.iter())
    }
}

pub(crate) const fn check_count(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), NetworkError> {
    if found == expected { Ok(()) } else { Err(NetworkError::Count { what, found, expected }) }
}

pub(crate) fn check_shape(
    what: &'static str,
    found: (usize, usize),
    expected: (usize, usize),
) -> Result<(), NetworkError> {
    if found == expected {
        return Ok(());
    }
    Err(NetworkError::Shape {
        what,
        rows: found.0,
        columns: found.1,
        expected_rows: expected.0,
        expected_columns: expected.1,
    })
}

fn check_finite<'a>(
    what: &'static str,
    mut values: impl Iterator<Item = &'a f32>,
) -> Result<(), NetworkError> {
    match values.find(|v| !v.is_finite()) {
        Some(&value) => Err(NetworkError::NotFinite { what, value }),
        None => Ok(()),
    }
}
