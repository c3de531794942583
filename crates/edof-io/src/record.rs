//! What a raw frame knows of itself: a JSON file beside it, `frame.png.json` for `frame.png`.
//!
//! A mosaic looks alike in every phase and behind every lens, and a network that is given the wrong one makes a wrong picture
//! without complaint. So [`crate::raw`]'s files carry what they cannot say themselves.

use crate::levels::{Black, Levels};
use crate::raw::{Alignment, RawOptions};
use crate::rendering::{ColourMatrix, Rendering, WhiteBalance};
use edof_spec::atomic::{self, WriteError};
use edof_spec::provenance::{Input, Provenance};
use edof_spec::{Camera, CfaPhase, Noise, RawFrame, Tone};
use serde::{Deserialize, Serialize};
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
    /// The sensor's noise.
    pub noise: Noise,
    /// SHA-256 of the frame that this describes ([`edof_spec::provenance::InputKind::RawFrame`]).
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
    #[error("{path}: no record of a raw frame: {source}; mend or delete it", path = path.display())]
    Foreign { path: PathBuf, source: serde_json::Error },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The frame was replaced, or the options read it as another.
    #[error(
        "{path}: describes another frame than {raw}; delete it if the frame was replaced, else read the frame as it says: {says}",
        path = path.display(), raw = raw.display()
    )]
    OtherFrame { path: PathBuf, raw: PathBuf, says: String },
    /// An option that contradicts it.
    #[error("--{option} {given}: {path} says {recorded}; leave --{option} out", path = path.display())]
    Contradicted { path: PathBuf, option: &'static str, given: String, recorded: String },
}

/// Where the record of a raw frame lies.
#[must_use]
pub fn path_of(raw: &Path) -> PathBuf {
    let mut name = raw.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// Where values lie in a file of that name, as [`crate::raw::save`] writes it.
#[must_use]
pub fn alignment_of(raw: &Path) -> Alignment {
    let ending = raw.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if ["png", "tif", "tiff"].contains(&ending.as_str()) { Alignment::Top } else { Alignment::Bottom }
}

/// Writes the record of a raw frame beside it.
///
/// # Errors
/// [`RecordError::Write`].
pub fn save(raw: &Path, record: &RawRecord) -> Result<(), RecordError> {
    let text = serde_json::to_string_pretty(record).unwrap_or_default() + "\n";
    Ok(atomic::write(&path_of(raw), text.as_bytes())?)
}

/// The record of a raw frame, if there is one.
///
/// # Errors
/// [`RecordError::Read`] or [`RecordError::Foreign`].
pub fn load(raw: &Path) -> Result<Option<RawRecord>, RecordError> {
    let path = path_of(raw);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(source) if source.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(RecordError::Read { path, source }),
    };
    serde_json::from_str(&text).map(Some).map_err(|source| RecordError::Foreign { path, source })
}

fn agree(
    raw: &Path,
    option: &'static str,
    given: Option<String>,
    recorded: String,
) -> Result<(), RecordError> {
    match given {
        Some(given) if given != recorded => {
            Err(RecordError::Contradicted { path: path_of(raw), option, given, recorded })
        }
        _ => Ok(()),
    }
}

impl RawRecord {
    /// Options that read the frame as it was written; `given` are the user's, each of which may be left out.
    ///
    /// # Errors
    /// [`RecordError::Contradicted`] for the first that differs.
    pub fn options(
        &self,
        raw: &Path,
        given: RawOptions,
        phase: Option<CfaPhase>,
    ) -> Result<RawOptions, RecordError> {
        let agree = |option, given, recorded| agree(raw, option, given, recorded);
        agree("phase", phase.map(|p| p.to_string()), self.phase.to_string())?;
        agree("depth", given.depth.map(|d| d.to_string()), self.depth.to_string())?;
        agree("align", given.alignment.map(|a| a.to_string()), self.alignment.to_string())?;
        Ok(RawOptions {
            phase: self.phase,
            depth: Some(self.depth),
            alignment: Some(self.alignment),
            ..given
        })
    }

    /// What darkness and full light are in the frame; `given` are the user's.
    ///
    /// # Errors
    /// [`RecordError::Contradicted`] for the first that differs.
    pub fn levels(
        &self,
        raw: &Path,
        black: Option<Black>,
        white: Option<f64>,
    ) -> Result<Levels, RecordError> {
        let recorded = Levels { black: self.black_level, white: self.white_level };
        agree(raw, "black-level", black.map(|b| b.to_string()), recorded.black.to_string())?;
        let full = f64::from(1u32 << self.depth.min(16));
        agree(raw, "white-level", white.map(|w| w.to_string()), recorded.white.unwrap_or(full).to_string())?;
        Ok(recorded)
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
        let says = format!("--phase {} --depth {} --align {}", self.phase, self.depth, self.alignment);
        Err(RecordError::OtherFrame { path: path_of(raw), raw: raw.to_owned(), says })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw;
    use ndarray::Array2;

    fn taken(folder: &Path, name: &str, phase: CfaPhase) -> (PathBuf, RawFrame, RawRecord) {
        let values = Array2::from_shape_fn((4, 6), |(r, c)| (r * 600 + c * 37) as u16);
        let frame = RawFrame::from_values(values, 12, phase).unwrap();
        let path = folder.join(name);
        let record = RawRecord {
            phase,
            depth: 12,
            alignment: alignment_of(&path),
            black_level: Black::from(64),
            white_level: None,
            white_balance: Some(WhiteBalance::try_from([2.0, 1.0, 1.5]).unwrap()),
            colour_matrix: None,
            camera: Camera::resolve("clear").unwrap(),
            psi: vec![8.0],
            tone: Tone::Linear,
            noise: Noise::gaussian(0.01),
            sha256: Input::raw_frame("", &frame).sha256,
            provenance: Provenance { command: "edof capture".into(), ..Provenance::default() },
        };
        raw::save(&path, &frame).unwrap();
        save(&path, &record).unwrap();
        (path, frame, record)
    }

    #[test]
    fn a_frame_with_its_record_needs_no_option_in_any_format_or_phase() {
        let folder = tempfile::tempdir().unwrap();
        for phase in CfaPhase::ALL {
            for ending in ["png", "tif", "pgm"] {
                let (path, frame, record) = taken(folder.path(), &format!("frame.{ending}"), phase);
                let found = load(&path).unwrap().unwrap();
                assert_eq!(found, record);
                let options = found.options(&path, RawOptions::default(), None).unwrap();
                let back = raw::load(&path, &options).unwrap();
                assert_eq!(back, frame, "{ending}");
                found.check(&path, &back).unwrap();
            }
        }
    }

    #[test]
    fn a_frame_without_a_record_has_none() {
        assert!(load(Path::new("no-such-frame.png")).unwrap().is_none());
    }

    #[test]
    fn options_that_contradict_the_record_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (path, _, record) = taken(folder.path(), "frame.png", CfaPhase::Gbrg);
        let plain = RawOptions::default();
        let refused = |given, phase| record.options(&path, given, phase).unwrap_err().to_string();
        let told = refused(plain, Some(CfaPhase::Rggb));
        assert!(
            told.starts_with("--phase rggb: ") && told.ends_with(" says gbrg; leave --phase out"),
            "{told}"
        );
        assert!(refused(RawOptions { depth: Some(10), ..plain }, None).contains("says 12"));
        assert!(
            refused(RawOptions { alignment: Some(Alignment::Bottom), ..plain }, None).contains("says top")
        );
        assert!(record.options(&path, plain, Some(CfaPhase::Gbrg)).is_ok());
        let levels = |black: Option<u16>, white| record.levels(&path, black.map(Black::from), white);
        assert!(levels(Some(0), None).unwrap_err().to_string().ends_with("says 64; leave --black-level out"));
        assert!(levels(None, Some(4000.0)).unwrap_err().to_string().contains("says 4096"));
        assert_eq!(levels(Some(64), Some(4096.0)).unwrap(), Levels { black: 64.into(), white: None });
    }

    #[test]
    fn the_record_of_another_frame_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let (path, frame, record) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
        let mut values = frame.values();
        values[(2, 3)] += 1;
        let replaced = RawFrame::from_values(values, 12, CfaPhase::Rggb).unwrap();
        let error = record.check(&path, &replaced).unwrap_err();
        assert!(matches!(error, RecordError::OtherFrame { .. }));
        assert!(error.to_string().ends_with("--phase rggb --depth 12 --align top"), "{error}");
    }

    #[test]
    fn a_damaged_record_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let (path, ..) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
        std::fs::write(path_of(&path), "{").unwrap();
        assert!(matches!(load(&path), Err(RecordError::Foreign { .. })));
        std::fs::remove_file(path_of(&path)).unwrap();
        std::fs::create_dir(path_of(&path)).unwrap();
        assert!(matches!(load(&path), Err(RecordError::Read { .. })));
    }
}
