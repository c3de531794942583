//! Remarks of a job on its inputs, as values: a program words them by its own options.

use crate::presets::lens::DepthRange;
use edof_core::camera::Camera;
use edof_core::{CfaPhase, Noise, Tone};
use edof_io::gamut::Gamut;
use edof_io::raw::Size;
use edof_io::record::Contradiction;
use edof_io::transfer::Transfer;
use edof_network::network::Condition;
use std::path::PathBuf;

/// Remark on a photograph or a depth map.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the variants name the fields")]
pub enum PictureNote {
    /// The tone that was asked for contradicts the photograph's file.
    ToneOverridden { path: PathBuf, given: Tone, stated: Transfer },
    /// The photograph's file states linear light.
    Linear { path: PathBuf, stated: Transfer },
    /// The photograph's file states a curve that is neither of the known tones.
    CurveNotApplied { path: PathBuf, stated: Transfer, tone: Tone },
    /// The photograph's file states other primaries than sRGB's.
    GamutNotApplied { path: PathBuf, stated: Gamut },
    /// The file has further pictures, which are not read.
    FirstOfSeveral { path: PathBuf },
    /// An odd last row or column is left out.
    Cropped { path: PathBuf, from: Size, to: Size },
    /// Pixels of a depth map have no reading and get the nearest one.
    Holes { path: PathBuf, pixels: usize },
    /// Pixels of a depth map are nearer or farther than its limits.
    OutsideOfLimits { path: PathBuf, pixels: usize, limits: DepthRange },
}

/// Remark on a raw frame, or on the network for it.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the variants name the fields")]
pub enum FrameNote {
    /// A file with the name of a record is one of another program.
    ForeignRecord { path: PathBuf },
    /// An option takes the place of what the record states.
    Overruled(Contradiction),
    /// A remark of a raw frame's reader.
    RawFile { path: PathBuf, text: String },
    /// A frame without a record is dark, as it is where values of fewer than 16 bits are at the bottom of each word; or
    /// its file states the levels of its light.
    Dim { path: PathBuf, brightest: u16, is_light: bool },
    /// The values of a frame seem to have so many bits, at the top of 16, and its black level seems to be of as many.
    FewerBits { path: PathBuf, bits: u32, black: f64 },
    /// Greens of a frame without a record differ as red and blue do.
    OtherPhase { path: PathBuf, phase: CfaPhase },
    /// The network was trained for another lens than took the frame, and is used.
    OtherLens(Box<OtherLens>),
    /// The network was trained for another lens without a mask.
    OtherClearLens(Box<OtherLens>),
    /// The network was trained on pictures of another tone.
    OtherTone { path: PathBuf, network: String, camera: Box<Camera>, trained: Tone, tone: Tone },
    /// The frame's noise is outside of the range that the network was trained for; a better one comes with the program, or none does.
    OtherNoise {
        path: PathBuf,
        network: String,
        trained: Vec<Condition>,
        noise: Noise,
        better: Option<String>,
    },
    /// The picture's file has no place to state its curve, which is not sRGB's.
    CurveNotStated { path: PathBuf },
    /// The board leaves out what the frame's file, its record or the user asks for.
    NotFinished { path: PathBuf, left_out: Vec<&'static str> },
}

/// A network for another lens or mask than that of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherLens {
    /// The raw frame.
    pub path: PathBuf,
    /// Name or file of the network.
    pub network: String,
    /// Camera that the network was trained for.
    pub trained: Camera,
    /// Camera that took the frame.
    pub camera: Camera,
    /// Whether the frame's record states that camera; else the user does.
    pub is_recorded: bool,
    /// Tone of the picture.
    pub tone: Tone,
}

/// Returns the largest defocus of a camera over its range, in radians.
pub(super) fn largest_defocus(camera: &Camera) -> f64 {
    camera.psi_range.iter().map(|psi| (psi - camera.focus_psi).abs()).fold(0.0, f64::max)
}

impl OtherLens {
    /// Returns how many times as large the largest blur in pixels is as that of the lens that the network was trained for. A blur grows with ψ·λ·F/pitch.
    #[must_use]
    pub fn blur_ratio(&self) -> f64 {
        let blur = |camera: &Camera| {
            largest_defocus(camera) * camera.wave_um(camera.reference_wavelength_nm) / camera.pixel_pitch_um
        };
        blur(&self.camera) / blur(&self.trained)
    }

    /// States the network and how the two lenses differ; `option` is what states the camera where no record does.
    #[must_use]
    pub fn in_words(&self, option: &str) -> String {
        let Self { path, network, trained, camera, is_recorded, .. } = self;
        let (fields, by) = (trained.differences(camera).join(", "), camera.in_words());
        let taken_by = match is_recorded {
            true => format!("{} was taken by {by}", path.display()),
            false => format!("{option} is {by}"),
        };
        let trained = trained.in_words();
        format!(
            "{network}: trained for the camera {trained}, but {taken_by}, another lens or mask (they differ in {fields})"
        )
    }
}
