//! Depth maps beside a photograph: shares of a range of depths, or distances.

use super::error::JobError;
use super::note::PictureNote;
use crate::presets::lens::{Depth, DepthRange};
use edof_core::camera::Camera;
use edof_io::photo;
use edof_optics::depth_map::{Filled, Unit, fill};
use edof_optics::psi_at;
use ndarray::Array2;
use std::path::{Path, PathBuf};

/// A depth map in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthMap {
    /// A grey picture.
    pub file: PathBuf,
    /// What its values stand for.
    pub meaning: Meaning,
}

/// Meaning of a depth map's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meaning {
    /// Shares of a range of depths.
    Shares(Scale),
    /// Distances.
    Steps {
        /// Length of a step.
        unit: Unit,
        /// Limits: nearer and farther pixels are taken to be there.
        limits: Option<DepthRange>,
    },
}

/// Scale of a depth map of shares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Proportional to ψ, that is to one over the distance, from black to white.
    Nearness {
        /// ψ of white.
        near: f64,
        /// ψ of black.
        far: f64,
    },
    /// Proportional to the distance in metres, from black to white.
    Distance {
        /// Distance of black.
        near: f64,
        /// Distance of white.
        far: f64,
    },
}

/// A depth map that has been read.
pub(super) enum Read {
    Shares(Array2<f32>, Scale),
    Steps(Array2<u16>, Unit, Option<DepthRange>),
}

impl DepthMap {
    pub(super) fn read(&self) -> Result<Read, JobError> {
        Ok(match self.meaning {
            Meaning::Shares(scale) => Read::Shares(photo::load_grey(&self.file)?, scale),
            Meaning::Steps { unit, limits } => Read::Steps(photo::load_integers(&self.file)?, unit, limits),
        })
    }
}

impl Read {
    pub(super) fn size(&self) -> (usize, usize) {
        match self {
            Self::Shares(map, _) => map.dim(),
            Self::Steps(map, ..) => map.dim(),
        }
    }

    /// Returns values of 0…1, as provenance has those of pictures.
    pub(super) fn shares(&self) -> Array2<f32> {
        match self {
            Self::Shares(map, _) => map.clone(),
            Self::Steps(map, ..) => map.mapv(|v| f32::from(v) / f32::from(u16::MAX)),
        }
    }

    /// Returns ψ of each pixel; pixels without a reading have the nearest one. `file` is named in errors.
    pub(super) fn psis(
        self,
        file: &Path,
        camera: &Camera,
        note: &dyn Fn(PictureNote),
    ) -> Result<Array2<f32>, JobError> {
        let nominal = camera.nominal_m.unwrap_or(f64::INFINITY);
        Ok(match self {
            Self::Shares(map, Scale::Nearness { near, far }) => {
                map.mapv(|v| (far + f64::from(v) * (near - far)) as f32)
            }
            Self::Shares(map, Scale::Distance { near, far }) => {
                map.mapv(|v| psi_at(camera, near + f64::from(v) * (far - near), nominal) as f32)
            }
            Self::Steps(map, unit, limits) => distances(map, unit, limits, file, camera, note)?,
        })
    }
}

fn distances(
    map: Array2<u16>,
    unit: Unit,
    limits: Option<DepthRange>,
    file: &Path,
    camera: &Camera,
    note: &dyn Fn(PictureNote),
) -> Result<Array2<f32>, JobError> {
    let none = "has no reading: each value is 0 or 65535, expected distances";
    let Filled { map, holes } = fill(map).ok_or_else(|| JobError::in_file(file, none))?;
    let ends = map.iter().fold([u16::MAX, 0], |[low, high], &value| [low.min(value), high.max(value)]);
    let [near, far] = ends.map(|value| Depth::Metres(unit.metres(value)));
    let in_file = |e| JobError::in_file(file, e);
    near.psi(camera).map_err(in_file)?;
    let psi = map.mapv(|value| Depth::Metres(unit.metres(value)).psi(camera).unwrap_or(f64::NAN));
    let limits = limits.unwrap_or(DepthRange { near, far });
    let [low, high] = limits.psi(camera).map_err(in_file)?;
    if holes > 0 {
        note(PictureNote::Holes { path: file.to_owned(), pixels: holes });
    }
    let outside = psi.iter().filter(|psi| !(low..=high).contains(*psi)).count();
    if outside > 0 {
        note(PictureNote::OutsideOfLimits { path: file.to_owned(), pixels: outside, limits });
    }
    Ok(psi.mapv(|psi| psi.clamp(low, high) as f32))
}
