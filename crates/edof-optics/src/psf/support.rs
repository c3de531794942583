//! How large a support must be, and what falls beyond it.

use super::rays;
use super::settings::Settings;
use crate::pupil::Pupil;
use edof_core::camera::Camera;

/// Side in pixels of the support computed when nothing is cut; a cut kernel's is smaller where the asked energy allows it.
pub const SUPPORT: usize = 1024;
/// The farthest from focus that is computed, in radians at the reference wavelength.
pub const MAX_DEFOCUS: f64 = 200.0;

/// Most light that may be thrown beyond the largest support; with more, there is no PSF ([`NoPsf::Reach`](super::NoPsf::Reach)).
pub const OUTSIDE: f64 = 0.02;

/// Side of the support in pixels.
pub fn support(camera: &Camera, wavelength_nm: f64, psi: f64, settings: &Settings) -> usize {
    let wanted = if settings.cuts_kernels() {
        (8.0 * diffracted_beyond(camera, wavelength_nm, psi, 1.0) / (1.0 - settings.energy)).min(512.0)
    } else {
        1024.0
    };
    roomy(wanted, reach(camera, psi))
}

/// Side in pixels of a support for the OTF at `psi`: the samples of the pupil follow its phase.
pub fn otf_support(camera: &Camera, psi: f64) -> usize {
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
pub fn rays_beyond(camera: &Camera, psi: f64, half: f64) -> f64 {
    let half_um = half * camera.pixel_pitch_um;
    if rays::bound_um(camera, psi) <= half_um || reach(camera, psi) <= half {
        return 0.0;
    }
    rays::Rays::new(camera, psi).beyond(half_um)
}

/// Share of energy estimated beyond a support.
pub fn energy_beyond(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> f64 {
    let half = 0.5 * support as f64;
    (diffracted_beyond(camera, wavelength_nm, psi, half) + rays_beyond(camera, psi, half)).min(1.0)
}

/// Share of energy that the edges of the mask throw beyond the square of half a side in pixels.
///
/// Far from the centre only the pupil's edges send light: a circle of radius ρ at which the pupil jumps by Δ sends the share
/// 2λF#·ρ|Δ|²/(π²r) beyond the radius r, and 0.9 of that beyond the square around it.
fn diffracted_beyond(camera: &Camera, wavelength_nm: f64, psi: f64, half: f64) -> f64 {
    let wave = camera.wave_um(wavelength_nm) / camera.pixel_pitch_um;
    let edges = Pupil::new(camera, wavelength_nm, psi).edge_strength();
    0.9 * 2.0 * wave * edges / (std::f64::consts::PI.powi(2) * half)
}
