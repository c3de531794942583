//! From a scene to a raw frame, modelling only what the scene needs, and what that saved and cost.

use crate::psf::{self, NoPsf, Psf, Settings, SettingsError, channel_psfs};
use crate::scene::{Scene, SceneError};
use crate::sensor::{Sensor, SensorError, expose};
use edof_core::camera::{Camera, centroid};
use edof_core::{ColourFrame, RawFrame};
use serde::Serialize;
use std::time::Instant;

/// How far the computation is shortened. By default: by nothing that could be seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Approximation {
    /// Where kernels end and how many wavelengths are summed.
    pub psf: Settings,
    /// Layers whose ψ differ by no more than this share one PSF.
    pub depth_tolerance: f64,
}

impl Approximation {
    /// # Errors
    /// [`SettingsError`] for shares or tolerances out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        self.psf.check()?;
        let depths = self.depth_tolerance;
        if depths.is_finite() && depths >= 0.0 { Ok(()) } else { Err(SettingsError::Depths(depths)) }
    }

    /// None at all.
    #[must_use]
    pub fn exact() -> Self {
        Self { psf: Settings::exact(), depth_tolerance: 0.0 }
    }
}

/// A scene seen by a camera; without a lens it would be [`Scene::sharp`].
#[derive(Debug, Clone)]
pub struct Capture {
    /// The light on the sensor.
    pub light: ColourFrame,
    /// What the sensor gave.
    pub raw: RawFrame,
    /// Depths that were computed.
    pub depths: Vec<Depth>,
    /// Wall-clock seconds for PSFs and blur.
    pub seconds: f64,
}

/// One depth of a scene and what it needed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Depth {
    /// ψ of the PSFs, in radians at the camera's reference wavelength.
    pub psi: f64,
    /// Layers that share them.
    pub layers: usize,
    /// Red, green and blue.
    pub channels: [Kernel; 3],
}

/// What cutting one PSF left.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Kernel {
    /// Side in pixels.
    pub side: usize,
    /// Side in pixels of the support it was cut from.
    pub support: usize,
    /// Share of the support's energy inside.
    pub energy_kept: f64,
    /// Estimated share of the energy beyond the support.
    pub energy_beyond: f64,
    /// Wavelengths summed.
    pub wavelengths: usize,
    /// Share of the energy that the last refinement of the wavelengths moved.
    pub wavelength_error: f64,
    /// Pixels to the right of the middle pixel, and down from it, by which the blur moves the picture.
    pub centroid: [f64; 2],
}

/// What one approximation changes of the light on the sensor, and the time it saves; each against an exact computation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ApproximationCost {
    /// `kernels`, `wavelengths`, `depths` or `all`.
    pub approximation: &'static str,
    /// Root mean square difference of the light, full scale 1.
    pub rms_error: f64,
    /// Largest difference.
    pub max_error: f64,
    /// Seconds with this approximation alone.
    pub seconds: f64,
    /// Seconds of the exact computation.
    pub exact_seconds: f64,
}

/// A scene that cannot be captured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CaptureError {
    /// The layers make no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The sensor cannot be, or does not fit the scene.
    #[error(transparent)]
    Sensor(#[from] SensorError),
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
}

/// Captures a scene.
///
/// ```
/// use edof_optics::{capture::{Approximation, capture}, draw::{Builtin, draw, four_depths}, Sensor};
/// let camera = edof_core::camera::Camera::resolve("ring-outer")?;
/// let scene = draw(Builtin::Chart, 64, 96, &four_depths(camera.psi_range), 0)?;
/// let shot = capture(&scene, &camera, &Sensor::default(), &Approximation::default())?;
/// assert_eq!((shot.raw.size(), shot.depths.len()), ((64, 96), 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CaptureError`]: layers that make no scene, an impossible sensor, depths too far from focus.
pub fn capture(
    scene: &Scene,
    camera: &Camera,
    sensor: &Sensor,
    approximation: &Approximation,
) -> Result<Capture, CaptureError> {
    capture_told(scene, camera, sensor, approximation, |_, _, _| ())
}

/// The same, with a call before each step: how many are done, of how many, and which is next.
///
/// # Errors
/// As [`capture`].
pub fn capture_told(
    scene: &Scene,
    camera: &Camera,
    sensor: &Sensor,
    approximation: &Approximation,
    told: impl FnMut(usize, usize, &str),
) -> Result<Capture, CaptureError> {
    check(scene, camera)?;
    sensor.check()?;
    let start = Instant::now();
    let (light, depths) = light_on_sensor(scene, camera, approximation, told)?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(Capture { raw: expose(&light, sensor)?, light, depths, seconds })
}

/// Measures what each part of an approximation changes and saves on this scene, alone and together, against an exact
/// computation.
///
/// # Errors
/// As [`capture`].
pub fn measure_approximation(
    scene: &Scene,
    camera: &Camera,
    approximation: &Approximation,
) -> Result<Vec<ApproximationCost>, CaptureError> {
    measure_approximation_told(scene, camera, approximation, |_, _, _| ())
}

/// The same, with a call before each step, as in [`capture_told`].
///
/// # Errors
/// As [`capture`].
pub fn measure_approximation_told(
    scene: &Scene,
    camera: &Camera,
    approximation: &Approximation,
    mut told: impl FnMut(usize, usize, &str),
) -> Result<Vec<ApproximationCost>, CaptureError> {
    check(scene, camera)?;
    let timed = |approximation: Approximation| {
        let start = Instant::now();
        let (light, _) = light_on_sensor(scene, camera, &approximation, |_, _, _| ())?;
        Ok::<_, CaptureError>((light, start.elapsed().as_secs_f64()))
    };
    told(0, 5, "exact");
    let (exact, exact_seconds) = timed(Approximation::exact())?;
    let whole = Settings { energy: 1.0, wavelength_tolerance: 0.0, exact: false };
    let off = Approximation { psf: whole, depth_tolerance: 0.0 };
    let kernels = Approximation { psf: Settings { energy: approximation.psf.energy, ..whole }, ..off };
    let wavelength_tolerance = approximation.psf.wavelength_tolerance;
    let wavelengths = Approximation { psf: Settings { wavelength_tolerance, ..whole }, ..off };
    let depths = Approximation { depth_tolerance: approximation.depth_tolerance, ..off };
    let cost = |(place, (name, part)): (usize, (&'static str, Approximation))| {
        told(1 + place, 5, name);
        let (light, seconds) = timed(part)?;
        let difference = || light.planes.iter().zip(&exact.planes).map(|(a, b)| f64::from(a - b));
        let rms_error = (difference().map(|d| d * d).sum::<f64>() / light.planes.len() as f64).sqrt();
        let max_error = difference().map(f64::abs).fold(0.0, f64::max);
        Ok(ApproximationCost { approximation: name, rms_error, max_error, seconds, exact_seconds })
    };
    let all =
        [("kernels", kernels), ("wavelengths", wavelengths), ("depths", depths), ("all", *approximation)];
    all.into_iter().enumerate().map(cost).collect()
}

/// Depths of a scene, each once: ascending, those within `tolerance` of the first of a group represented by the group's middle.
#[must_use]
pub fn distinct_depths(scene: &Scene, tolerance: f64) -> Vec<f64> {
    let mut psis: Vec<f64> = scene.layers.iter().map(|layer| layer.psi).collect();
    psis.sort_by(f64::total_cmp);
    let mut groups: Vec<[f64; 2]> = vec![];
    for psi in psis {
        match groups.last_mut() {
            Some([low, high]) if psi - *low <= tolerance => *high = psi,
            _ => groups.push([psi, psi]),
        }
    }
    groups.into_iter().map(|[low, high]| 0.5 * (low + high)).collect()
}

fn check(scene: &Scene, camera: &Camera) -> Result<(), CaptureError> {
    scene.check()?;
    Ok(scene.layers.iter().try_for_each(|layer| psf::check(camera, layer.psi))?)
}

fn light_on_sensor(
    scene: &Scene,
    camera: &Camera,
    approximation: &Approximation,
    mut told: impl FnMut(usize, usize, &str),
) -> Result<(ColourFrame, Vec<Depth>), NoPsf> {
    let psis = distinct_depths(scene, approximation.depth_tolerance);
    let steps = psis.len() + 1;
    let kernels = |(place, &psi): (usize, &f64)| {
        told(place, steps, &format!("kernels at psi {psi:.2}"));
        channel_psfs(camera, psi, &approximation.psf)
    };
    let psfs: Vec<[Psf; 3]> = psis.iter().enumerate().map(kernels).collect::<Result<_, _>>()?;
    told(psis.len(), steps, "blur");
    let nearest = |psi: f64| {
        let distance = |i: &usize| (psis[*i] - psi).abs();
        (0..psis.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    let light = scene.blurred(|psi| &psfs[nearest(psi)]);
    let depth = |(index, (&psi, channels)): (usize, (&f64, &[Psf; 3]))| {
        let layers = scene.layers.iter().filter(|layer| nearest(layer.psi) == index).count();
        Depth { psi, layers, channels: channels.each_ref().map(kernel) }
    };
    Ok((light, psis.iter().zip(&psfs).enumerate().map(depth).collect()))
}

fn kernel(psf: &Psf) -> Kernel {
    Kernel {
        side: psf.side(),
        support: psf.support,
        energy_kept: psf.energy_kept,
        energy_beyond: psf.energy_beyond,
        wavelengths: psf.wavelengths_nm.len(),
        wavelength_error: psf.wavelength_error,
        centroid: centroid(psf.kernel().view()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Builtin, draw, four_depths};

    fn chart() -> Scene {
        draw(Builtin::Chart, 64, 96, &four_depths([0.0, 8.0]), 0).unwrap()
    }

    #[test]
    fn only_the_depths_present_are_computed() {
        let camera = Camera::resolve("ring-2018").unwrap();
        let shot = capture(&chart(), &camera, &Sensor::default(), &Approximation::default()).unwrap();
        assert_eq!(
            shot.depths.iter().map(|d| (d.psi, d.layers)).collect::<Vec<_>>(),
            [(0.0, 1), (8.0 / 3.0, 1), (16.0 / 3.0, 1), (8.0, 1)]
        );
        let flat = draw(Builtin::Chart, 64, 96, &[3.0], 0).unwrap();
        assert_eq!(
            capture(&flat, &camera, &Sensor::default(), &Approximation::default()).unwrap().depths.len(),
            1
        );
    }

    #[test]
    fn depths_within_the_tolerance_share_a_psf() {
        assert_eq!(distinct_depths(&chart(), 3.0).len(), 2);
        assert_eq!(distinct_depths(&chart(), 8.0), [4.0]);
    }

    #[test]
    fn each_approximation_is_charged_its_own_error() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let approximation =
            Approximation { psf: Settings { energy: 0.99, ..Settings::default() }, depth_tolerance: 3.0 };
        let scene = Scene { layers: chart().layers[..2].to_vec(), ..chart() };
        let costs = measure_approximation(&scene, &camera, &approximation).unwrap();
        let [kernels, wavelengths, depths, all] = ["kernels", "wavelengths", "depths", "all"]
            .map(|name| costs.iter().find(|c| c.approximation == name).unwrap());
        assert!(kernels.rms_error > 1e-5 && kernels.rms_error < 3e-3, "{kernels:?}");
        assert_eq!(wavelengths.rms_error, 0.0, "single lines");
        assert!(depths.rms_error > kernels.rms_error, "{depths:?}");
        assert!(all.rms_error >= 0.9 * depths.rms_error && all.rms_error <= all.max_error);
    }

    #[test]
    fn a_depth_that_no_support_could_hold_is_rejected() {
        let camera = Camera::resolve("clear-mid").unwrap();
        let far = draw(Builtin::Chart, 64, 96, &[300.0], 0).unwrap();
        let error = capture(&far, &camera, &Sensor::default(), &Approximation::default()).unwrap_err();
        assert_eq!(error.to_string(), "psi 300: must lie within 200 of the focus of camera clear-mid, at 4");
    }
}
