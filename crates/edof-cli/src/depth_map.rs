//! Depth maps beside a photograph: shares of a range of depths, or distances.

use crate::error::Error;
use crate::lens::{Depth, DepthRange};
use crate::said;
use crate::ui::Ui;
use edof_core::camera::Camera;
use edof_core::words::count;
use edof_io::photo;
use edof_optics::depth_map::{Filled, Unit, fill};
use edof_optics::psi_at;
use ndarray::Array2;
use std::path::Path;

/// What the values of a depth map are proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum MapOf {
    /// One over the distance, white nearest.
    Nearness,
    /// The distance, white farthest.
    Distance,
}

/// A depth map and the meaning of its values.
pub enum DepthMap {
    /// Shares 0…1 of a range.
    Shares(Array2<f32>, MapOf, DepthRange),
    /// Distances in steps of a unit, and their limits.
    Distances(Array2<u16>, Unit, Option<DepthRange>),
}

impl DepthMap {
    /// # Errors
    /// A file that is not a grey picture.
    pub fn load(
        file: &Path,
        of: MapOf,
        unit: Option<Unit>,
        range: Option<DepthRange>,
    ) -> Result<Self, Error> {
        Ok(match (unit, range) {
            (Some(unit), limits) => Self::Distances(photo::load_integers(file)?, unit, limits),
            (None, Some(range)) => Self::Shares(photo::load_grey(file)?, of, range),
            (None, None) => return Err(Error::message("--depth-map: add --range or --map-unit")),
        })
    }

    /// Rows and columns.
    pub fn dim(&self) -> (usize, usize) {
        match self {
            Self::Shares(map, ..) => map.dim(),
            Self::Distances(map, ..) => map.dim(),
        }
    }

    /// Values 0…1, as provenance has those of pictures.
    pub fn shares(&self) -> Array2<f32> {
        match self {
            Self::Shares(map, ..) => map.clone(),
            Self::Distances(map, ..) => map.mapv(|v| f32::from(v) / f32::from(u16::MAX)),
        }
    }

    /// ψ of each pixel; pixels without a reading have the nearest one.
    ///
    /// # Errors
    /// A map without a reading, depths that the camera has no PSFs for.
    pub fn psis(self, file: &Path, camera: &Camera, ui: &Ui) -> Result<Array2<f32>, Error> {
        match self {
            Self::Shares(map, of, range) => of.psis(&map, range, camera),
            Self::Distances(map, unit, limits) => distances(map, unit, limits, file, camera, ui),
        }
    }
}

/// ψ of distances. Notes state the pixels without a reading, and those outside of the limits.
fn distances(
    map: Array2<u16>,
    unit: Unit,
    limits: Option<DepthRange>,
    file: &Path,
    camera: &Camera,
    ui: &Ui,
) -> Result<Array2<f32>, Error> {
    let none = "has no reading: each value is 0 or 65535, expected distances";
    let Filled { map, holes } = fill(map).ok_or_else(|| said::of_file(file, none))?;
    let ends = map.iter().fold([u16::MAX, 0], |[low, high], &value| [low.min(value), high.max(value)]);
    let [near, far] = ends.map(|value| Depth::Metres(unit.metres(value)));
    let of_file = |e| said::of_file(file, e);
    near.psi(camera).map_err(of_file)?;
    let psi = map.mapv(|value| Depth::Metres(unit.metres(value)).psi(camera).unwrap_or(f64::NAN));
    let range = limits.unwrap_or(DepthRange { near, far });
    let of_range = |e| match limits {
        Some(_) => Error::message(format!("--range {e}")),
        None => of_file(e),
    };
    let [a, b] = range.ends(camera).map_err(of_range)?;
    let (low, high) = (a.min(b), a.max(b));
    let shown = file.display();
    if holes > 0 {
        let holes = count(holes, "pixel");
        ui.note(format!("{shown}: {holes} without a reading (0 or 65535), filled with the nearest one"));
    }
    let outside = psi.iter().filter(|psi| !(low..=high).contains(*psi)).count();
    if outside > 0 {
        let outside = count(outside, "pixel");
        ui.note(format!("{shown}: {outside} outside of --range {range}, taken to be at its ends"));
    }
    Ok(psi.mapv(|psi| psi.clamp(low, high) as f32))
}

impl MapOf {
    /// ψ of each pixel from a map of 0…1.
    fn psis(self, map: &Array2<f32>, range: DepthRange, camera: &Camera) -> Result<Array2<f32>, Error> {
        let [near, far] = range.ends(camera).map_err(|e| Error::message(format!("--range {e}")))?;
        match (self, range.near, range.far) {
            (Self::Nearness, ..) => Ok(map.mapv(|v| (far + f64::from(v) * (near - far)) as f32)),
            (Self::Distance, Depth::Metres(first), Depth::Metres(last)) if last.is_finite() => {
                Ok(map.mapv(|v| {
                    let metres = first + f64::from(v) * (last - first);
                    psi_at(camera, metres, camera.nominal_m.unwrap_or(f64::INFINITY)) as f32
                }))
            }
            _ => Err(Error::message("--map-of distance: --range must be two distances, as in 0.7m:3m")),
        }
    }
}
