//! What a raw frame knows of itself: a JSON file beside it, `frame.png.json` for `frame.png`.
//!
//! A mosaic looks the same in every phase and behind every lens, and a network that is given the wrong one makes a wrong picture
//! without complaint. So [`crate::raw`]'s files carry what they cannot say themselves.
//!
//! Other programs put JSON beside frames, too. A file is taken for a record if its JSON has the field `phase` and one of `sha256` and
//! `provenance`, or a word as `phase` and the field `alignment`. Text that is not valid JSON is taken for one if it names these fields, or begins with `phase` as a
//! truncated record does. Any other file is passed over.

mod exposure;

pub use exposure::Exposure;

use crate::levels::{Black, Levels};
use crate::packing::Packing;
use crate::raw::{Alignment, RawOptions, Size};
use crate::rendering::{ColourMatrix, Rendering, WhiteBalance};
use edof_core::camera::Camera;
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::json;
use edof_core::storage::provenance::{Input, Provenance};
use edof_core::words::number;
use edof_core::{CfaPhase, Noise, RawFrame, Tone};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// How a raw frame was taken, and how its file is to be read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawRecord {
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of the sensor, 8…16.
    pub depth: u32,
    /// Where in the file's words values of fewer than 16 bits lie.
    pub alignment: Alignment,
    /// Columns and rows, where the file is video for a playout card ([`Packing::Video`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub video: Option<Size>,
    /// Columns and rows, where the file is words without a header.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Size>,
    /// Sensor value of no light.
    pub black_level: Black,
    /// Sensor value of full light, where that is not the end of its bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub white_level: Option<f64>,
    /// What makes white of what the sensor sees of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub white_balance: Option<WhiteBalance>,
    /// From balanced colours of the sensor to linear sRGB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour_matrix: Option<ColourMatrix>,
    /// The camera.
    pub camera: Camera,
    /// Defocus of each layer of the scene, at the camera's reference wavelength.
    pub psi: Vec<f64>,
    /// What the scene's numbers were taken for on their way to light.
    pub tone: Tone,
    /// What the file's words stand for: light, or light that the camera encoded.
    #[serde(default = "Tone::light", skip_serializing_if = "Tone::is_light")]
    pub values: Tone,
    /// The sensor's noise.
    pub noise: Noise,
    /// Its place among the exposures that share the exposure time, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Exposure>,
    /// SHA-256 of the frame that this describes ([`edof_core::storage::provenance::InputKind::RawFrame`]).
    pub sha256: String,
    /// How the frame was made.
    pub provenance: Provenance,
}

/// A record that cannot be read, written or believed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum RecordError {
    /// The file itself.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Not a record.
    #[error("{path}: invalid raw-frame record: {source}; correct the file, or move it elsewhere", path = path.display())]
    Invalid { path: PathBuf, source: json::JsonError },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The frame was replaced, or is read as another.
    #[error(
        "{path}: describes another frame than {raw}; move it elsewhere if the frame was replaced, else read the frame as it states: phase {phase}, bit depth {depth}, alignment {alignment}",
        path = path.display(), raw = raw.display()
    )]
    OtherFrame { path: PathBuf, raw: PathBuf, phase: CfaPhase, depth: u32, alignment: Alignment },
}

/// Something that is stated otherwise than it is recorded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field} {given}: {path} states {recorded}", path = path.display())]
pub struct Contradiction {
    /// The record.
    pub path: PathBuf,
    /// What is stated otherwise.
    pub field: Field,
    /// The value stated.
    pub given: String,
    /// The value recorded.
    pub recorded: String,
}

/// What may be stated of a raw frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "as in Stated")]
pub enum Field {
    Phase,
    BitDepth,
    Alignment,
    Size,
    Packing,
    Order,
    BlackLevel,
    WhiteLevel,
    Tone,
    Camera,
    Gain,
}

impl std::fmt::Display for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Phase => "phase",
            Self::BitDepth => "bit depth",
            Self::Alignment => "alignment",
            Self::Size => "size",
            Self::Packing => "packing",
            Self::Order => "byte order",
            Self::BlackLevel => "black level",
            Self::WhiteLevel => "white level",
            Self::Tone => "tone",
            Self::Camera => "camera",
            Self::Gain => "gain",
        })
    }
}

/// Where the record of a raw frame lies.
#[must_use]
pub fn path_of(raw: &Path) -> PathBuf {
    let mut name = raw.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// Most bytes of a record.
const MAX_BYTES: u64 = 1 << 20;

/// Writes the record of a raw frame beside it.
///
/// # Errors
/// [`RecordError::Write`].
pub fn save(raw: &Path, record: &RawRecord) -> Result<(), RecordError> {
    let text = serde_json::to_string_pretty(record).unwrap_or_default() + "\n";
    Ok(atomic::write(&path_of(raw), text.as_bytes())?)
}

/// What is beside a raw frame under the name of its record.
#[derive(Debug, Clone, PartialEq)]
pub enum Sidecar {
    /// No file.
    Absent,
    /// A file of another program.
    Foreign(PathBuf),
    /// The record of the frame.
    Record(Box<RawRecord>),
}

impl Sidecar {
    /// Returns the record, if there is one.
    #[must_use]
    pub fn record(self) -> Option<RawRecord> {
        match self {
            Self::Record(record) => Some(*record),
            Self::Absent | Self::Foreign(_) => None,
        }
    }
}

/// Reads what is beside a raw frame.
///
/// # Errors
/// [`RecordError::Read`], or [`RecordError::Invalid`] for a record that cannot be used.
pub fn load(raw: &Path) -> Result<Sidecar, RecordError> {
    let path = path_of(raw);
    let text = match json::text(&path, MAX_BYTES) {
        Ok(text) if is_record(&text) => text,
        Ok(_) => return Ok(Sidecar::Foreign(path)),
        // Larger than any record, or no text.
        Err(source) if source.kind() == ErrorKind::InvalidData => return Ok(Sidecar::Foreign(path)),
        Err(source) if source.kind() == ErrorKind::NotFound => return Ok(Sidecar::Absent),
        Err(source) => return Err(RecordError::Read { path, source }),
    };
    json::parse(&text)
        .map(|record| Sidecar::Record(Box::new(record)))
        .map_err(|source| RecordError::Invalid { path, source })
}

/// Returns whether a frame has a record, valid or not.
#[must_use]
pub fn is_beside(raw: &Path) -> bool {
    is_record_file(&path_of(raw))
}

/// Returns whether a file is a record, valid or not.
#[must_use]
pub fn is_record_file(path: &Path) -> bool {
    json::text(path, MAX_BYTES).is_ok_and(|text| is_record(&text))
}

/// Whether a text is meant as a record.
fn is_record(text: &str) -> bool {
    let names_record = |has: &dyn Fn(&str) -> bool| {
        has("phase") && ["sha256", "alignment", "provenance"].into_iter().any(has)
    };
    match json::parse::<BTreeMap<String, Value>>(text) {
        Ok(mut fields) => {
            if !fields.get("phase").is_some_and(Value::is_string) {
                fields.remove("alignment");
            }
            names_record(&|name| fields.contains_key(name))
        }
        Err(_) => {
            let text = text.trim_start_matches(|c: char| c == '\u{feff}' || c.is_whitespace());
            let begins = |text: &str| text.trim_start().starts_with("\"phase\"");
            let contains = |name: &str| text.contains(&format!("\"{name}\""));
            text.strip_prefix('{').is_some_and(|rest| begins(rest) || names_record(&contains))
        }
    }
}

/// What a user states of a frame, each of which may be left out.
#[derive(Debug, Clone, Default)]
pub struct Stated {
    /// Colour filter of the first pixel.
    pub phase: Option<CfaPhase>,
    /// Bits of the sensor.
    pub depth: Option<u32>,
    /// Where in the file's words values lie.
    pub alignment: Option<Alignment>,
    /// Columns and rows of a file of video.
    pub size: Option<Size>,
    /// How its pixels are packed.
    pub packing: Option<Packing>,
    /// Sensor value of no light.
    pub black_level: Option<Black>,
    /// Sensor value of full light.
    pub white_level: Option<f64>,
    /// What the scene's numbers were taken for.
    pub tone: Option<Tone>,
    /// The camera.
    pub camera: Option<Camera>,
    /// Gain of the reference sensor that would have the frame's noise.
    pub gain: Option<f64>,
}

impl Stated {
    /// Returns the noise that is stated.
    #[must_use]
    pub fn noise(&self) -> Option<Noise> {
        self.gain.map(Noise::of_gain)
    }
}

/// Share of a gain by which a stated one may differ from the recorded one: people round.
const GAIN_TOLERANCE: f64 = 0.01;

/// Whether a noise is that of a gain of the reference sensor.
fn has_gain(noise: Noise, gain: f64) -> bool {
    match noise {
        Noise::Sensor(sensor) => (sensor.reference_gain() / gain - 1.0).abs() <= GAIN_TOLERANCE,
        Noise::None | Noise::Gaussian { .. } => false,
    }
}

impl RawRecord {
    /// Returns everything that is stated otherwise than it is recorded.
    #[must_use]
    pub fn contradictions(&self, raw: &Path, stated: &Stated) -> Vec<Contradiction> {
        fn differ<T: PartialEq + ToString>(given: Option<&T>, recorded: &T) -> Option<(String, String)> {
            given.filter(|given| *given != recorded).map(|given| (given.to_string(), recorded.to_string()))
        }
        let white = self.white_level.unwrap_or(f64::from(1u32 << self.depth.min(16)));
        let camera = stated.camera.as_ref().map(|camera| (camera, camera.differences(&self.camera)));
        let camera = camera.filter(|(_, fields)| !fields.is_empty()).map(|(camera, fields)| {
            let recorded = format!("{} (they differ in {})", self.camera.in_words(), fields.join(", "));
            (camera.in_words(), recorded)
        });
        let gain = stated.gain.filter(|gain| !has_gain(self.noise, *gain));
        let gain = gain.map(|gain| (number(gain), self.noise.to_string()));
        let name = |packing: &Packing| packing.name().to_owned();
        let headerless = self.headerless();
        let size = headerless.and_then(|(size, _)| differ(stated.size.as_ref(), &size));
        let packing =
            headerless.and_then(|(_, own)| differ(stated.packing.as_ref().map(name).as_ref(), &name(&own)));
        let found = [
            (Field::Phase, differ(stated.phase.as_ref(), &self.phase)),
            (Field::BitDepth, differ(stated.depth.as_ref(), &self.depth)),
            (Field::Alignment, differ(stated.alignment.as_ref(), &self.alignment)),
            (Field::Size, size),
            (Field::Packing, packing),
            (Field::BlackLevel, differ(stated.black_level.as_ref(), &self.black_level)),
            (Field::WhiteLevel, differ(stated.white_level.as_ref(), &white)),
            (Field::Tone, differ(stated.tone.as_ref(), &self.tone)),
            (Field::Camera, camera),
            (Field::Gain, gain),
        ];
        let contradiction = |(field, differ): (Field, Option<(String, String)>)| {
            let (given, recorded) = differ?;
            Some(Contradiction { path: path_of(raw), field, given, recorded })
        };
        found.into_iter().filter_map(contradiction).collect()
    }

    /// The record with what is stated in place of what was recorded.
    #[must_use]
    pub fn with(self, stated: Stated) -> Self {
        Self {
            phase: stated.phase.unwrap_or(self.phase),
            depth: stated.depth.unwrap_or(self.depth),
            alignment: stated.alignment.unwrap_or(self.alignment),
            video: self.video.map(|size| stated.size.unwrap_or(size)),
            size: self.size.map(|size| stated.size.unwrap_or(size)),
            black_level: stated.black_level.unwrap_or(self.black_level),
            white_level: stated.white_level.or(self.white_level),
            tone: stated.tone.unwrap_or(self.tone),
            noise: stated.noise().unwrap_or(self.noise),
            camera: stated.camera.unwrap_or(self.camera),
            ..self
        }
    }

    /// Options that read the frame as it was written; `given` has what no record says.
    #[must_use]
    pub fn options(&self, given: RawOptions) -> RawOptions {
        RawOptions {
            phase: self.phase,
            depth: Some(self.depth),
            alignment: Some(self.alignment),
            size: self.headerless().map(|(size, _)| size).or(given.size),
            packing: self.headerless().map_or(given.packing, |(_, packing)| packing),
            ..given
        }
    }

    /// Size and packing of a file without a header.
    fn headerless(&self) -> Option<(Size, Packing)> {
        self.video.map(|size| (size, Packing::Video)).or(self.size.map(|size| (size, Packing::Words)))
    }

    /// What darkness and full light are in the frame.
    #[must_use]
    pub const fn levels(&self) -> Levels {
        Levels { black: self.black_level, white: self.white_level }
    }

    /// What is to be done with the picture's colours.
    #[must_use]
    pub const fn rendering(&self) -> Rendering {
        Rendering { white_balance: self.white_balance, matrix: self.colour_matrix }
    }

    /// # Errors
    /// [`RecordError::OtherFrame`] if this is not the record of that frame.
    pub fn check(&self, raw: &Path, frame: &RawFrame) -> Result<(), RecordError> {
        if Input::raw_frame("", frame).sha256 == self.sha256 {
            return Ok(());
        }
        Err(RecordError::OtherFrame {
            path: path_of(raw),
            raw: raw.to_owned(),
            phase: self.phase,
            depth: self.depth,
            alignment: self.alignment,
        })
    }
}

#[cfg(test)]
mod tests;
