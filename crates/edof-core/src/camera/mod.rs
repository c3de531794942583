//! Cameras as data: lens, phase mask, focus and sensor, and the JSON files that describe one. `edof-optics` computes with these descriptions;
//! weight files name the camera that a network was trained for, without any optics code.
//!
//! | what | module |
//! |---|---|
//! | user-supplied PSFs in place of computed ones | [`psf_bank`] |
//! | a mask given by the height of its surface | [`height_map`] |
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

mod checks;
pub mod height_map;
pub mod psf_bank;
mod words;

use crate::camera::height_map::{HeightMap, etched_rad};
use crate::camera::psf_bank::{BankError, PsfBank};
use crate::cfa::Channel;
use crate::storage::json;
use crate::storage::provenance::{Input, InputKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Most rings of a mask.
const MAX_RINGS: usize = 64;
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
#[serde(deny_unknown_fields)]
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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal_m: Option<f64>,
    /// Range of ψ that the camera is meant for.
    pub psi_range: [f64; 2],
    /// Rings of the phase mask; none for a clear aperture.
    pub rings: Vec<Ring>,
    /// A phase of the mask that changes smoothly with the radius, besides its rings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// A mask of any shape, besides its rings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_map: Option<HeightMap>,
    /// What the lens does besides focusing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aberrations: Vec<Aberration>,
    /// PSFs of the user in place of those that follow from lens and mask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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

/// A ring of the mask between two normalised pupil radii.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Inner radius, 0…1.
    pub inner: f64,
    /// Outer radius, 0…1.
    pub outer: f64,
    /// What the ring does to the phase.
    pub delay: Delay,
}

/// Phase delay of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delay {
    /// Stated as a phase: at λ it is `rad`·`at_nm`/λ.
    Phase {
        /// Radians.
        rad: f64,
        /// Wavelength in nanometres for which they are stated.
        at_nm: f64,
    },
    /// Etched height: the phase is 2π·height·(n(λ) − 1)/λ.
    Etched {
        /// Height in micrometres.
        height_um: f64,
        /// n(λ) = `cauchy[0]` + `cauchy[1]`/λ² with λ in micrometres.
        cauchy: [f64; 2],
    },
}

impl Delay {
    /// Phase in radians at `wavelength_nm`.
    #[must_use]
    pub fn phase_rad(self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Phase { rad, at_nm } => rad * at_nm / wavelength_nm,
            Self::Etched { height_um, cauchy } => etched_rad(height_um, cauchy, wavelength_nm),
        }
    }
}

/// Phase of a rotationally symmetric mask over the normalised pupil radius, linear between its points and constant beyond them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Wavelength in nanometres for which the phase is stated; at λ it is `at_nm`/λ of it.
    pub at_nm: f64,
    /// Pairs of radius 0…1, ascending, and radians.
    pub points: Vec<[f64; 2]>,
}

impl Profile {
    /// Phase in radians at a radius, at `wavelength_nm`.
    #[must_use]
    pub fn phase_rad(&self, rho: f64, wavelength_nm: f64) -> f64 {
        let after = self.points.partition_point(|point| point[0] < rho);
        let rad = match (after.checked_sub(1).map(|i| self.points[i]), self.points.get(after)) {
            (Some([r0, a]), Some(&[r1, b])) => a + (b - a) * (rho - r0) / (r1 - r0),
            (Some([_, end]), None) | (None, Some(&[_, end])) => end,
            (None, None) => 0.0,
        };
        rad * self.at_nm / wavelength_nm
    }
}

/// A Zernike term of the wavefront in Noll's order and normalisation (Noll 1976), over the aperture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aberration {
    /// Noll's index: 2 and 3 tilt, 4 defocus, 5 and 6 astigmatism, 7 and 8 coma, 9 and 10 trefoil, 11 spherical, ….
    pub noll: u32,
    /// Root mean square of the optical path in nanometres; its sign is the term's.
    pub rms_nm: f64,
}

/// The largest of Noll's indices that is taken, and the largest path in nanometres.
const MAX_NOLL: u32 = 66;
const MAX_RMS_NM: f64 = 10_000.0;
/// The highest mask, micrometres.
pub const MAX_HEIGHT_UM: f64 = 100.0;
/// Most points of a profile.
const MAX_POINTS: usize = 4096;

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
presets!("clear", "clear-mid", "ring-2015", "ring-2018", "ring-depth-2018", "ring-outer");

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

    /// Whether there is a mask in its pupil.
    #[must_use]
    pub const fn has_mask(&self) -> bool {
        !self.rings.is_empty() || self.profile.is_some() || self.height_map.is_some()
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
        let map = self.height_map.as_ref().map(|map| format!(" with the mask of {}", map.file));
        format!("{}{}{}", self.name, bank.unwrap_or_default(), map.unwrap_or_default())
    }

    /// Whether the pupil looks the same whichever way it is turned, so that all PSFs are even.
    #[must_use]
    pub const fn is_round(&self) -> bool {
        self.aberrations.is_empty() && self.height_map.is_none()
    }

    /// Focal length over aperture diameter.
    #[must_use]
    pub fn f_number(&self) -> f64 {
        self.focal_length_mm / (2.0 * self.aperture_radius_mm)
    }

    /// What a channel's filter passes.
    #[must_use]
    pub const fn spectrum(&self, channel: Channel) -> &Spectrum {
        &self.spectra[channel.plane()]
    }
}

#[cfg(test)]
mod tests;
