//! The point spread function on the sensor's grid, and what cutting it cost.
//!
//! The pupil is sampled with spacing 1/L in frequency, L the side of the support on the sensor, and transformed to the field on a
//! grid fine enough that the field's squared magnitude does not alias. The PSF's own transform, the OTF, times the footprint of a
//! square pixel, folded at the sensor's sampling frequency and transformed back, is the light that each pixel collects, exactly.

mod grid;
mod rays;
mod round;
mod spectrum;
mod wavefront;

pub use round::{otf_along_row, pixel_transfer, quarter_otf, quarter_psf};
pub use spectrum::wavelengths;
pub(crate) use wavefront::whole_psf;

use crate::bank;
use crate::depth::in_metres;
use crate::pupil::Pupil;
use edof_core::Channel;
use edof_core::camera::Camera;
use edof_core::words::number;
use ndarray::{Array2, s};
use rayon::prelude::*;
use spectrum::summed;

/// Side in pixels of the support computed when nothing is cut; a cut kernel's is smaller where the asked energy allows it.
pub const SUPPORT: usize = 1024;
/// The farthest from focus that is computed, in radians at the reference wavelength.
pub const MAX_DEFOCUS: f64 = 200.0;

/// Most light that may be thrown beyond the largest support; with more, there is no PSF ([`NoPsf::Reach`]).
pub(crate) const OUTSIDE: f64 = 0.02;

/// How exactly PSFs are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Share of the energy that a cut kernel keeps, 0…1; at 1 nothing is cut.
    pub energy: f64,
    /// Share of the energy that may lie wrong because a spectrum is sampled at few wavelengths; at 0 it is sampled at the most.
    pub wavelength_tolerance: f64,
    /// Nothing left out: the whole computed support, and as many wavelengths as the program ever takes.
    pub exact: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { energy: 0.999, wavelength_tolerance: 0.01, exact: false }
    }
}

/// Settings that no PSF is computed by.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// No share.
    #[error("energy {}: must be more than 0 and at most 1", number(*.0))]
    Energy(f64),
    /// Negative, or more than all.
    #[error("wavelength-tolerance {}: must be 0 or more", number(*.0))]
    Wavelengths(f64),
    /// More than all of the energy.
    #[error("wavelength-tolerance {}: a share, must be 0 to 1", number(*.0))]
    Share(f64),
    /// Of a capture: negative, or no number.
    #[error("depth-tolerance {}: must be 0 or more", number(*.0))]
    Depths(f64),
}

impl Settings {
    /// # Errors
    /// [`SettingsError`] for shares outside of 0…1.
    pub fn check(&self) -> Result<(), SettingsError> {
        if !(self.energy > 0.0 && self.energy <= 1.0) {
            return Err(SettingsError::Energy(self.energy));
        }
        match self.wavelength_tolerance {
            share if !(share.is_finite() && share >= 0.0) => Err(SettingsError::Wavelengths(share)),
            share if share > 1.0 => Err(SettingsError::Share(share)),
            _ => Ok(()),
        }
    }

    /// Nothing left out.
    #[must_use]
    pub fn exact() -> Self {
        Self { exact: true, ..Self::default() }
    }

    fn cuts_kernels(&self) -> bool {
        !self.exact && self.energy < 1.0
    }

    fn cuts_wavelengths(&self) -> bool {
        !self.exact && self.wavelength_tolerance > 0.0
    }
}

/// Light that a point gives to the pixels around its own. Those of a lens and its mask are even about their centre along rows and
/// along columns; others ([`mod@bank`]) need not be.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Psf {
    /// Odd side, sum 1: no other is given out, and nobody can change it.
    kernel: Array2<f32>,
    /// Share of the computed energy that the kernel held before it was scaled to sum 1.
    pub energy_kept: f64,
    /// Side of the computed support in pixels.
    pub support: usize,
    /// Estimated share of the energy that falls beyond the support, from where diffraction at the mask's edges and rays throw it;
    /// the computation folds it back in.
    pub energy_beyond: f64,
    /// Wavelengths in nanometres that were summed, equally weighted.
    pub wavelengths_nm: Vec<f64>,
    /// Share of the energy that the last refinement of the wavelengths moved; 0 for a single line.
    pub wavelength_error: f64,
}

/// A kernel that is not a PSF.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PsfError {
    /// No centre pixel.
    #[error("kernel {height}x{width}: must be square with an odd side")]
    Shape { height: usize, width: usize },
    /// Light that cannot be.
    #[error(
        "kernel: row {row}, column {column} is {value}, light is finite and never negative; set noise below 0 to 0"
    )]
    Light { row: usize, column: usize, value: f32 },
    /// Creates or loses light.
    #[error("kernel: sums to {0}, must sum to 1")]
    Sum(f32),
}

impl Psf {
    /// A PSF from a kernel of the user.
    ///
    /// # Errors
    /// [`PsfError`] if the kernel has no centre, has a weight that is negative or not finite, or does not sum to 1 within 10⁻³.
    pub fn new(kernel: Array2<f32>) -> Result<Self, PsfError> {
        let (height, width) = kernel.dim();
        if height != width || height % 2 == 0 {
            return Err(PsfError::Shape { height, width });
        }
        let light = |value: f32| value.is_finite() && value >= 0.0;
        if let Some(((row, column), &value)) = kernel.indexed_iter().find(|(_, value)| !light(**value)) {
            return Err(PsfError::Light { row, column, value });
        }
        let sum = kernel.sum();
        if (sum - 1.0).abs() > 1e-3 {
            return Err(PsfError::Sum(sum));
        }
        Ok(Self::given(kernel))
    }

    /// The kernel: of odd side, summing to 1, the point on the centre of the middle pixel.
    #[must_use]
    pub const fn kernel(&self) -> &Array2<f32> {
        &self.kernel
    }

    /// The same to keep.
    #[must_use]
    pub fn into_kernel(self) -> Array2<f32> {
        self.kernel
    }

    /// Pixels along one side of the kernel.
    #[must_use]
    pub fn side(&self) -> usize {
        self.kernel.nrows()
    }

    /// Share of this kernel's energy inside the centred square of `side` pixels, odd.
    #[must_use]
    pub fn energy_within(&self, side: usize) -> f64 {
        let half = self.side() / 2;
        let reach = (side / 2).min(half);
        let part = self.kernel.slice(s![half - reach..=half + reach, half - reach..=half + reach]);
        part.iter().map(|&v| f64::from(v)).sum::<f64>()
            / self.kernel.iter().map(|&v| f64::from(v)).sum::<f64>()
    }

    /// A kernel that sums to 1, of odd side: it is what it is.
    fn given(kernel: Array2<f32>) -> Self {
        Self {
            support: kernel.nrows(),
            kernel,
            energy_kept: 1.0,
            energy_beyond: 0.0,
            wavelengths_nm: vec![],
            wavelength_error: 0.0,
        }
    }

    /// Whether the kernel is its own mirror image upside down, left to right, and about the diagonal, to 10⁻⁴ of its peak.
    #[must_use]
    pub fn symmetries(&self) -> [bool; 3] {
        let (kernel, last) = (&self.kernel, self.side() - 1);
        let peak = kernel.iter().fold(0.0f32, |peak, v| peak.max(*v));
        let same = |other: &dyn Fn(usize, usize) -> (usize, usize)| {
            kernel.indexed_iter().all(|((r, c), v)| (kernel[other(r, c)] - v).abs() <= 1e-4 * peak)
        };
        [same(&|r, c| (last - r, c)), same(&|r, c| (r, last - c)), same(&|r, c| (c, r))]
    }
}

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
        if let Some(map) = camera.height_map.as_ref().filter(|map| map.heights.is_none()) {
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
    let side = match camera.is_round() {
        true => SUPPORT,
        false => Channel::ALL.iter().map(room).min().unwrap_or(SUPPORT),
    };
    match rays_beyond(camera, psi, 0.5 * side as f64) {
        share if share > OUTSIDE => Err(too_far(camera, psi, share, side)),
        _ => Ok(()),
    }
}

fn too_far(camera: &Camera, psi: f64, share: f64, support: usize) -> NoPsf {
    let parts = [
        (camera.profile.is_some(), "a weaker profile"),
        (!camera.aberrations.is_empty(), "weaker aberrations"),
        (camera.height_map.is_some(), "a smoother height map"),
    ];
    let helps = parts.iter().filter(|(there, _)| *there).map(|(_, what)| format!(", {what}")).collect();
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
/// [`NoPsf::Reach`] of a height map.
fn of_lens(camera: &Camera, channel: Channel, psi: f64, settings: &Settings) -> Result<Psf, NoPsf> {
    let spectrum = camera.spectrum(channel);
    let middle = wavelengths(spectrum, 1)[0];
    let support = support(camera, middle, psi, settings);
    if !camera.is_round() {
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

/// Side of the support in pixels.
fn support(camera: &Camera, wavelength_nm: f64, psi: f64, settings: &Settings) -> usize {
    let wanted = if settings.cuts_kernels() {
        (8.0 * diffracted_beyond(camera, wavelength_nm, psi, 1.0) / (1.0 - settings.energy)).min(512.0)
    } else {
        1024.0
    };
    roomy(wanted, reach(camera, psi))
}

/// Side in pixels of a support for the OTF at `psi`: the samples of the pupil follow its phase.
pub(crate) fn otf_support(camera: &Camera, psi: f64) -> usize {
    roomy(256.0, reach(camera, psi))
}

/// Side in pixels: at least `wanted` and four times the blur, as far as there is room.
fn roomy(wanted: f64, reach: f64) -> usize {
    (wanted.max(8.0 * reach).min(SUPPORT as f64) as usize).next_power_of_two().clamp(256, SUPPORT)
}

/// Pixels from the centre that next to no ray passes.
fn reach(camera: &Camera, psi: f64) -> f64 {
    rays::reach_um(camera, psi) / camera.pixel_pitch_um
}

/// Share of the rays that go more than `half` pixels from the centre.
pub(crate) fn rays_beyond(camera: &Camera, psi: f64, half: f64) -> f64 {
    if reach(camera, psi) <= half {
        return 0.0;
    }
    rays::Rays::new(camera, psi).beyond(half * camera.pixel_pitch_um)
}

/// Share of energy estimated beyond a support.
fn energy_beyond(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> f64 {
    let half = 0.5 * support as f64;
    (diffracted_beyond(camera, wavelength_nm, psi, half) + rays_beyond(camera, psi, half)).min(1.0)
}

/// Share of energy that the edges of the mask throw beyond the square of half a side in pixels.
///
/// Far from the centre only the pupil's edges send light: a circle of radius ρ at which the pupil jumps by Δ sends the share
/// 2λF#·ρ|Δ|²/(π²r) beyond the radius r, and 0.9 of that beyond the square around it.
fn diffracted_beyond(camera: &Camera, wavelength_nm: f64, psi: f64, half: f64) -> f64 {
    let wave = wave_um(camera, wavelength_nm) / camera.pixel_pitch_um;
    let edges = Pupil::new(camera, wavelength_nm, psi).edge_strength();
    0.9 * 2.0 * wave * edges / (std::f64::consts::PI.powi(2) * half)
}

/// λ·F# in micrometres: the PSF's unit of length; 1/(λF#) is the cut-off frequency.
#[must_use]
pub fn wave_um(camera: &Camera, wavelength_nm: f64) -> f64 {
    wavelength_nm * 1e-3 * camera.f_number()
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
