//! Cameras as data: lens, phase mask, focus and sensor, and the JSON files that describe one. `edof-optics` computes with these descriptions;
//! weight files name the camera that a network was trained for, without any optics code.
//!
//! | what | module |
//! |---|---|
//! | lens, focus, sensor | [`Camera`] |
//! | the mask: rings, profiles, height maps, … | [`Mask`], [`Term`], [`PhaseTerm`] |
//! | user-supplied PSFs in place of computed ones | [`PsfBank`] |
//!
//! ```
//! let camera = edof_core::Camera::resolve("ring-2018")?;
//! assert_eq!(camera.name, "ring-2018");
//! # Ok::<(), edof_core::camera::CameraError>(())
//! ```
//!
//! # Stability
//!
//! Stable: the fields of camera files and PSF banks; new ones are optional. Signatures may change between minor versions until 1.0.

mod centring;
mod checks;
mod file;
mod mask;
mod psf_bank;

pub use centring::centroid;
pub use mask::glass::etched_rad;
pub use mask::height_map::HeightMapError;
pub use mask::phase::{Change, Function, Parameter, PhaseTerm, Place, Symmetry, Wrong};
pub use mask::{Aberration, Delay, HeightMap, Mask, Monomial, Polynomial, Profile, Ring, Term, Zernike};
pub use psf_bank::{BankError, Kernels, KernelsError, PsfBank};

use crate::cfa::Channel;
use crate::storage::json;
use crate::storage::provenance::{Input, InputKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Most terms of a mask.
const MAX_TERMS: usize = 64;
/// Smallest F-number that there is in air.
const FASTEST: f64 = 0.5;
/// Least and most pixels that a wavelength times the F-number may be.
const CUT_OFF_PIXELS: [f64; 2] = [0.125, 64.0];
/// Largest ψ either way: far beyond any blur that is computed.
const MAX_PSI: f64 = 10_000.0;
/// Most bytes of a camera file.
const MAX_BYTES: u64 = 1 << 20;

/// Everything that decides how a point at a given depth falls on the sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "file::CameraFile", into = "file::CameraFile")]
pub struct Camera {
    /// Short name, as in `ring-2018`.
    pub name: String,
    /// Focal length in millimetres.
    pub focal_length_mm: f64,
    /// Radius R of the aperture in millimetres.
    pub aperture_radius_mm: f64,
    /// Distance between pixels in micrometres.
    pub pixel_pitch_um: f64,
    /// Light that the red, green and blue filters pass.
    pub spectra: [Spectrum; 3],
    /// Wavelength in nanometres for which ψ is stated.
    pub reference_wavelength_nm: f64,
    /// Sign of the defocus phase: which side of focus positive ψ lies on, seen by the mask.
    pub defocus_sign: Sign,
    /// ψ at which the lens is focused (the clear aperture's sharpest depth).
    pub focus_psi: f64,
    /// Distance in metres at which ψ is zero, where the camera knows it.
    pub nominal_m: Option<f64>,
    /// Range of ψ that the camera is meant for.
    pub psi_range: [f64; 2],
    /// The phase mask; without terms for a clear aperture.
    pub mask: Mask,
    /// What the lens does besides focusing.
    pub aberrations: Zernike,
    /// PSFs of the user in place of those that follow from lens and mask.
    pub psf_bank: Option<PsfBank>,
    /// Where the numbers come from and how sure we are.
    pub source: String,
}

/// One wavelength in nanometres, or several with relative weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a spectrum is a wavelength in nm, or a list of [nm, weight] pairs")]
pub enum Spectrum {
    /// A single wavelength.
    Line(f64),
    /// Pairs of wavelength and weight, wavelengths ascending; linear between them.
    Sampled(Vec<[f64; 2]>),
}

impl Spectrum {
    /// Shortest and longest wavelength, nanometres.
    fn ends(&self) -> Vec<f64> {
        match self {
            Self::Line(nm) => vec![*nm],
            Self::Sampled(pairs) => {
                [pairs.first(), pairs.last()].into_iter().flatten().map(|p| p[0]).collect()
            }
        }
    }
}

/// Sign of the defocus phase in the pupil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "i8", into = "i8")]
pub enum Sign {
    /// exp(+iψρ²).
    Plus,
    /// exp(−iψρ²).
    Minus,
}

impl Sign {
    /// +1 or −1.
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

impl TryFrom<i8> for Sign {
    type Error = String;

    fn try_from(sign: i8) -> Result<Self, String> {
        match sign {
            1 => Ok(Self::Plus),
            -1 => Ok(Self::Minus),
            _ => Err(format!("defocus_sign {sign}: must be 1 or -1")),
        }
    }
}

impl From<Sign> for i8 {
    fn from(sign: Sign) -> Self {
        sign.factor() as Self
    }
}

/// A camera that cannot be read, or could not be built.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CameraError {
    /// The file cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// The text is no camera.
    #[error("{origin}: not a camera: {source}")]
    Parse { origin: String, source: json::JsonError },
    /// What is wrong with the camera of a file.
    #[error("{origin}: {source}")]
    File { origin: String, source: Box<CameraError> },
    /// A number is out of range.
    #[error("camera {camera}: {field} is {value}, expected {expected}")]
    Value { camera: String, field: &'static str, value: String, expected: &'static str },
    /// A name that no message could show.
    #[error("name is {0}, expected {expected}", expected = crate::storage::name::TITLE)]
    Name(String),
    /// PSFs of its own that cannot be used.
    #[error(transparent)]
    Bank(#[from] BankError),
    /// Neither a preset nor a file.
    #[error("camera '{name}': no such file, and not one of the presets {presets}")]
    Unknown { name: String, presets: String },
}

macro_rules! presets {
    ($($name:literal),*) => {
        /// The cameras that come with the program: name and JSON text.
        pub const PRESETS: &[(&str, &str)] = &[$(
            ($name, include_str!(concat!("../../../../cameras/", $name, ".json")))
        ),*];
    };
}
presets!("clear", "clear-mid", "clear-closed", "ring-2015", "ring-2018", "ring-depth-2018", "ring-outer");

impl Camera {
    /// A preset by its name or a camera from a JSON file; the picture of a height map is not read.
    ///
    /// ```
    /// let camera = edof_core::camera::Camera::resolve("ring-2018")?;
    /// assert_eq!(camera.f_number().round(), 3.0);
    /// # Ok::<(), edof_core::camera::CameraError>(())
    /// ```
    ///
    /// # Errors
    /// [`CameraError`]: unknown name, unreadable file, wrong text, a number out of range, a PSF bank that cannot be used.
    pub fn resolve(name_or_path: &str) -> Result<Self, CameraError> {
        if let Some((name, text)) = PRESETS.iter().find(|(name, _)| *name == name_or_path) {
            return Self::from_json(text, name);
        }
        let path = Path::new(name_or_path);
        if !path.exists() {
            return Err(CameraError::Unknown {
                name: name_or_path.to_owned(),
                presets: PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
            });
        }
        let text = json::text(path, MAX_BYTES)
            .map_err(|source| CameraError::Read { path: path.to_owned(), source })?;
        let mut camera = Self::from_json(&text, name_or_path)?;
        let of_file =
            |e: BankError| CameraError::File { origin: name_or_path.to_owned(), source: Box::new(e.into()) };
        camera.read_bank(path.parent().unwrap_or(Path::new(""))).map_err(of_file)?;
        Ok(camera)
    }

    /// Reads the PSFs of its own, if it has any, from a folder.
    ///
    /// # Errors
    /// [`BankError`].
    pub fn read_bank(&mut self, folder: &Path) -> Result<(), BankError> {
        match &mut self.psf_bank {
            Some(bank) => bank.read(folder, &self.name, self.pixel_pitch_um),
            None => Ok(()),
        }
    }

    /// A camera from JSON text, without reading what other files it may name; `origin` names it in errors.
    ///
    /// # Errors
    /// [`CameraError::Parse`] or [`CameraError::File`].
    pub fn from_json(text: &str, origin: &str) -> Result<Self, CameraError> {
        let camera: Self =
            json::parse(text).map_err(|source| CameraError::Parse { origin: origin.to_owned(), source })?;
        let of_file = |source| CameraError::File { origin: origin.to_owned(), source: Box::new(source) };
        camera.check().map_err(of_file)?;
        Ok(camera)
    }

    /// JSON text that [`Camera::from_json`] reads back.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Returns this camera, then the same one at each further focus in ψ.
    #[must_use]
    pub fn focused_at(&self, further_foci: &[f64]) -> Vec<Self> {
        let further = further_foci.iter().map(|&focus_psi| Self { focus_psi, ..self.clone() });
        std::iter::once(self.clone()).chain(further).collect()
    }

    /// The camera as an input of a result ([`crate::storage::provenance`]): its name and the SHA-256 of its JSON.
    #[must_use]
    pub fn input(&self) -> Input {
        Input::of_bytes(InputKind::Camera, &self.name, self.to_json().as_bytes())
    }

    /// Whether a network for one serves the other, too: names, sources and ranges may differ, lens, mask and sensor may not.
    #[must_use]
    pub fn same_lens(&self, other: &Self) -> bool {
        let renamed = Self {
            name: other.name.clone(),
            source: other.source.clone(),
            psi_range: other.psi_range,
            nominal_m: other.nominal_m,
            ..self.clone()
        };
        renamed == *other
    }

    /// Whether there is no mask in the pupil; the lens may have aberrations.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.mask.terms().is_empty()
    }

    /// Returns the same lens without its mask, and without PSFs of its own, which are those of the mask.
    #[must_use]
    pub fn without_mask(&self) -> Self {
        Self { mask: Mask::default(), psf_bank: None, ..self.clone() }
    }

    /// The terms of the wavefront: those of the mask, then the lens's aberrations. Their phases add.
    pub fn terms(&self) -> impl Iterator<Item = &dyn PhaseTerm> {
        let lens = (!self.aberrations.is_empty()).then_some(&self.aberrations as &dyn PhaseTerm);
        self.mask.terms().iter().map(|term| &**term).chain(lens)
    }

    /// Returns what leaves the wavefront as it is.
    #[must_use]
    pub fn symmetry(&self) -> Symmetry {
        let is_round = self.terms().all(|term| term.symmetry() == Symmetry::Round);
        if is_round { Symmetry::Round } else { Symmetry::None }
    }

    /// Fields in which the lens, mask or sensor of two cameras differ; empty where [`Camera::same_lens`].
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let fields = |camera: &Self| match serde_json::to_value(camera) {
            Ok(serde_json::Value::Object(fields)) => fields,
            _ => serde_json::Map::new(),
        };
        let (own, others) = (fields(self), fields(other));
        let names: BTreeSet<&String> = own.keys().chain(others.keys()).collect();
        let differs = |name: &&String| own.get(*name) != others.get(*name);
        let any = |name: &&String| !["name", "source", "psi_range", "nominal_m"].contains(&name.as_str());
        names.into_iter().filter(any).filter(differs).cloned().collect()
    }

    /// Name of the camera, and the files of its PSFs or mask surface.
    #[must_use]
    pub fn in_words(&self) -> String {
        let bank = self.psf_bank.as_ref().map(|bank| format!(" with the PSFs of {}", bank.file));
        let maps: String =
            self.mask.height_maps().map(|map| format!(" with the mask of {}", map.file)).collect();
        format!("{}{}{maps}", self.name, bank.unwrap_or_default())
    }

    /// Focal length over aperture diameter.
    #[must_use]
    pub fn f_number(&self) -> f64 {
        self.focal_length_mm / (2.0 * self.aperture_radius_mm)
    }

    /// λ·F# in micrometres: the PSF's unit of length; 1/(λF#) is the cut-off frequency.
    #[must_use]
    pub fn wave_um(&self, nm: f64) -> f64 {
        nm * 1e-3 * self.f_number()
    }

    /// What a channel's filter passes.
    #[must_use]
    pub const fn spectrum(&self, channel: Channel) -> &Spectrum {
        &self.spectra[channel.plane()]
    }
}

#[cfg(test)]
mod tests;
