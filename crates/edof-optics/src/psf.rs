//! The point spread function on the sensor's grid, and what cutting it cost.
//!
//! The pupil is sampled with spacing 1/L in frequency, L the side of the support on the sensor, and transformed to the field on a
//! grid fine enough that the field's squared magnitude does not alias. The PSF's own transform, the OTF, times the footprint of a
//! square pixel, folded at the sensor's sampling frequency and transformed back, is the light that each pixel collects, exactly.

pub(crate) mod grid;
mod kernel;
mod rays;
pub(crate) mod round;
mod settings;
mod spectrum;
pub(crate) mod support;
pub(crate) mod wavefront;

pub use kernel::{Psf, PsfError};
pub use round::{otf_along_row, pixel_transfer, quarter_otf, quarter_psf};
pub use settings::{Settings, SettingsError};
pub use spectrum::wavelengths;
pub use support::{MAX_DEFOCUS, SUPPORT};
pub(crate) use wavefront::whole_psf;

use crate::bank;
use crate::depth::in_metres;
use edof_core::Channel;
use edof_core::camera::{Camera, PhaseTerm, Symmetry};
use edof_core::words::number;
use ndarray::Array2;
use rayon::prelude::*;
use spectrum::summed;
use support::{OUTSIDE, energy_beyond, rays_beyond, support};

/// PSFs that a camera has none of.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum NoPsf {
    /// Blur larger than any support, or no number.
    #[error("psi {}: must lie within {MAX_DEFOCUS} of the focus of camera {camera}, at {}{near}", number(*psi), number(*focus))]
    Focus { psi: f64, camera: String, focus: f64, near: String },
    /// Light thrown beyond the largest support, where the computation would fold it back.
    #[error(
        "psi {}: camera {camera} throws {:.0} % of the light more than {half} pixels from the centre, the farthest that is computed; use less defocus or larger pixels{helps}",
        number(*psi), 100.0 * share
    )]
    Reach { psi: f64, camera: String, share: f64, half: usize, helps: String },
    /// Beyond the ends of its PSF bank.
    #[error(
        "psi {}: the PSF bank of camera {camera}, {file}, reaches from {} to {}{near}",
        number(*psi), number(*low), number(*high)
    )]
    Bank { psi: f64, camera: String, file: String, low: f64, high: f64, near: String },
    /// A bank that was not read: it lies elsewhere.
    #[error(
        "camera {camera}: its PSFs are those of {file} (SHA-256 {sha256}), found neither beside the network nor here"
    )]
    Missing { camera: String, file: String, sha256: String },
    /// The picture of a mask that was not read: it lies elsewhere.
    #[error(
        "camera {camera}: its mask is that of {file} (SHA-256 {sha256}), found neither beside the network nor here"
    )]
    NoMask { camera: String, file: String, sha256: String },
}

/// Whether a camera has PSFs for an object at `psi`.
///
/// # Errors
/// [`NoPsf`].
pub fn check(camera: &Camera, psi: f64) -> Result<(), NoPsf> {
    let (name, focus) = (camera.name.clone(), camera.focus_psi);
    let Some(bank) = &camera.psf_bank else {
        if let Some(map) = camera.mask.height_maps().find(|map| map.heights.is_none()) {
            return Err(NoPsf::NoMask { camera: name, file: map.file.clone(), sha256: map.sha256.clone() });
        }
        let near = (psi - focus).abs() <= MAX_DEFOCUS;
        let reach = || in_metres(camera, [focus - MAX_DEFOCUS, focus + MAX_DEFOCUS]);
        return if near {
            check_reach(camera, psi)
        } else {
            Err(NoPsf::Focus { psi, camera: name, focus, near: reach() })
        };
    };
    let file = bank.file.clone();
    let Some(kernels) = &bank.kernels else {
        return Err(NoPsf::Missing { camera: name, file, sha256: bank.sha256.clone() });
    };
    let [low, high] = bank::ends(kernels);
    let inside = (low..=high).contains(&psi);
    if inside {
        return Ok(());
    }
    Err(NoPsf::Bank { psi, camera: name, file, low, high, near: in_metres(camera, [low, high]) })
}

/// Whether the rays from `psi` stay on the largest support.
fn check_reach(camera: &Camera, psi: f64) -> Result<(), NoPsf> {
    let room = |channel: &Channel| wavefront::room(camera, wavelengths(camera.spectrum(*channel), 1)[0]);
    let side = match camera.symmetry() {
        Symmetry::Round => SUPPORT,
        Symmetry::None => Channel::ALL.iter().map(room).min().unwrap_or(SUPPORT),
    };
    match rays_beyond(camera, psi, 0.5 * side as f64) {
        share if share > OUTSIDE => Err(too_far(camera, psi, share, side)),
        _ => Ok(()),
    }
}

fn too_far(camera: &Camera, psi: f64, share: f64, support: usize) -> NoPsf {
    let mut weaker: Vec<&str> = camera.terms().filter_map(PhaseTerm::weaker).collect();
    weaker.dedup();
    let helps = weaker.into_iter().map(|what| format!(", {what}")).collect();
    NoPsf::Reach { psi, camera: camera.name.clone(), share, half: support / 2, helps }
}

/// PSFs of red, green and blue for an object at `psi` (radians at the camera's reference wavelength): those of the camera's bank,
/// whole whatever the settings, if it has one; else those that follow from its lens and mask.
///
/// ```
/// use edof_optics::psf::{Settings, channel_psfs};
/// let [red, _, blue] = channel_psfs(&edof_core::camera::Camera::resolve("ring-2018")?, 1.0, &Settings::default())?;
/// let middle = |psf: &edof_optics::psf::Psf| psf.kernel()[(psf.side() / 2, psf.side() / 2)];
/// assert!(middle(&red) > middle(&blue), "red is in focus at psi 1");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NoPsf`].
pub fn channel_psfs(camera: &Camera, psi: f64, settings: &Settings) -> Result<[Psf; 3], NoPsf> {
    check(camera, psi)?;
    if let Some(kernels) = camera.psf_bank.as_ref().and_then(|bank| bank.kernels.as_ref()) {
        return Ok(bank::at(kernels, psi).map(Psf::given));
    }
    let psfs: Vec<Psf> = Channel::ALL
        .par_iter()
        .map(|&channel| of_lens(camera, channel, psi, settings))
        .collect::<Result<_, _>>()?;
    Ok(<[Psf; 3]>::try_from(psfs).unwrap_or_else(|_| unreachable!("three channels give three PSFs")))
}

/// PSF of one channel for an object at `psi`, as [`channel_psfs`] gives those of all three.
///
/// # Errors
/// As [`channel_psfs`].
pub fn psf(camera: &Camera, channel: Channel, psi: f64, settings: &Settings) -> Result<Psf, NoPsf> {
    check(camera, psi)?;
    match camera.psf_bank.as_ref().and_then(|bank| bank.kernels.as_ref()) {
        Some(kernels) => Ok(Psf::given(bank::at(kernels, psi)[channel.plane()].clone())),
        None => of_lens(camera, channel, psi, settings),
    }
}

/// PSF of a depth that was checked, as it follows from lens and mask.
///
/// # Errors
/// [`NoPsf::Reach`] where only a measurement tells how far light is thrown.
fn of_lens(camera: &Camera, channel: Channel, psi: f64, settings: &Settings) -> Result<Psf, NoPsf> {
    let spectrum = camera.spectrum(channel);
    let middle = wavelengths(spectrum, 1)[0];
    let support = support(camera, middle, psi, settings);
    if camera.symmetry() == Symmetry::None {
        let (support, outside) = wavefront::support(camera, middle, psi, support);
        if outside > 0.0 {
            return Err(too_far(camera, psi, outside, support));
        }
        let energy_beyond = energy_beyond(camera, middle, psi, support);
        let at = |nm: f64| wavefront::whole_psf(camera, nm, psi, support);
        let (whole, wavelengths_nm, wavelength_error) = summed(spectrum, settings, at, |plane| plane.sum());
        let (half, energy_kept) = cut(&wavefront::square_sums(&whole), settings);
        let offset = |i: usize| (i + support - half) % support;
        let kernel = scaled(2 * half + 1, |r, c| whole[(offset(r), offset(c))]);
        return Ok(Psf { kernel, energy_kept, support, energy_beyond, wavelengths_nm, wavelength_error });
    }
    let energy_beyond = energy_beyond(camera, middle, psi, support);
    let at = |nm: f64| quarter_psf(camera, nm, psi, support);
    let (quarter, wavelengths_nm, wavelength_error) = summed(spectrum, settings, at, whole_sum);
    let mut sums = square_sums(&quarter);
    // The last row and column of the support stand for both of its edges and belong to no square.
    sums.pop();
    let (half, energy_kept) = cut(&sums, settings);
    let kernel = scaled(2 * half + 1, |r, c| quarter[(r.abs_diff(half), c.abs_diff(half))]);
    Ok(Psf { kernel, energy_kept, support, energy_beyond, wavelengths_nm, wavelength_error })
}

/// A kernel of that side that sums to 1.
fn scaled(side: usize, light: impl Fn(usize, usize) -> f64) -> Array2<f32> {
    let kernel = Array2::from_shape_fn((side, side), |(r, c)| light(r, c));
    let sum = kernel.sum();
    kernel.mapv(|v| (v / sum) as f32)
}

/// Half side of the smallest centred square that keeps as much light as is asked for, and the share that it keeps; `sums` are those
/// over the squares of sides 1, 3, 5 ….
fn cut(sums: &[f64], settings: &Settings) -> (usize, f64) {
    let (last, total) = (sums.len() - 1, sums[sums.len() - 1]);
    if !settings.cuts_kernels() {
        return (last, 1.0);
    }
    let half = sums.iter().position(|&s| s >= settings.energy * total).unwrap_or(last);
    (half, sums[half] / total)
}

/// Sum over all four quarters of an even plane of which one, with the axes, is given.
fn whole_sum(quarter: &Array2<f64>) -> f64 {
    square_sums(quarter).last().copied().unwrap_or(0.0)
}

/// Sums over the centred squares of sides 1, 3, 5 … of an even plane.
fn square_sums(quarter: &Array2<f64>) -> Vec<f64> {
    let count = |i: usize| if i == 0 { 1.0 } else { 2.0 };
    let mut sum = 0.0;
    (0..quarter.nrows())
        .map(|h| {
            let side: f64 = (0..h).map(|i| (quarter[(h, i)] + quarter[(i, h)]) * count(i) * count(h)).sum();
            sum += side + quarter[(h, h)] * count(h) * count(h);
            sum
        })
        .collect()
}
