//! How far rays go: the reach of a PSF by geometric optics, from the slope of the wavefront.
//!
//! A ray through a place of the pupil meets the sensor 2·F#·|∇W| from the centre, W the optical path over the aperture of radius 1.
//! Defocus and most terms of the wavefront have slopes ([`PhaseTerm::slope_at`]). The edges of rings have none: they diffract
//! ([`Pupil::edge_strength`]). Paths are those at the reference wavelength.
//!
//! [`Pupil::edge_strength`]: crate::pupil::Pupil::edge_strength

use crate::depth::geometric_blur_um;
use edof_core::camera::{Camera, PhaseTerm, Place, Symmetry};
use std::f64::consts::TAU;

/// Parts of the pupil's radius, and directions where the wavefront is not round.
const RADII: f64 = 256.0;
const DIRECTIONS: usize = 256;

/// Rays of a pupil that is evenly lit.
#[derive(Debug)]
pub struct Rays {
    /// Distance from the centre in micrometres, descending, and the share of light.
    parts: Vec<[f64; 2]>,
}

impl Rays {
    /// The rays from an object at `psi`. Terms whose slope is not known are left out.
    pub fn new(camera: &Camera, psi: f64) -> Self {
        let nm = camera.reference_wavelength_nm;
        let slopes: Vec<_> = sloped(camera).map(|term| term.slope_at(nm)).collect();
        let is_round = sloped(camera).all(|term| term.symmetry() == Symmetry::Round);
        let directions = if is_round { 1 } else { DIRECTIONS };
        let bend = 2.0 * defocus_rad(camera, psi);
        let mut parts = vec![];
        for [from, to] in zones(camera) {
            let count = ((to - from) * RADII).ceil().max(1.0);
            for part in 0..count as usize {
                let edge = |part: usize| from + (to - from) * part as f64 / count;
                let (low, high) = (edge(part), edge(part + 1));
                let rho = 0.5 * (low + high);
                let share = (high * high - low * low) / directions as f64;
                parts.extend((0..directions).map(|direction| {
                    let at = Place::polar(rho, TAU * direction as f64 / directions as f64);
                    let [outward, around] = slopes.iter().fold([bend * rho, 0.0], |sum, slope| {
                        let [outward, around] = slope(at);
                        [sum[0] + outward, sum[1] + around]
                    });
                    [distance_um(camera, outward.hypot(around)), share]
                }));
            }
        }
        parts.sort_by(|a, b| b[0].total_cmp(&a[0]));
        Self { parts }
    }

    /// Distance in micrometres beyond which less than the given share of light goes.
    pub fn reach_um(&self, share: f64) -> f64 {
        let mut beyond = 0.0;
        let part = self.parts.iter().find(|part| {
            beyond += part[1];
            beyond > share
        });
        part.map_or(0.0, |part| part[0])
    }

    /// Share of light that goes farther than a distance in micrometres.
    pub fn beyond(&self, um: f64) -> f64 {
        self.parts.iter().take_while(|part| part[0] > um).map(|part| part[1]).sum()
    }
}

/// Distance in micrometres beyond which next to no ray goes.
pub fn reach_um(camera: &Camera, psi: f64) -> f64 {
    /// Share of light: less than a kernel's cut leaves out.
    const NEXT_TO_NONE: f64 = 1e-4;
    if sloped(camera).next().is_none() {
        return 0.5 * geometric_blur_um(camera, psi);
    }
    Rays::new(camera, psi).reach_um(NEXT_TO_NONE)
}

/// Distance in micrometres beyond which no ray goes, from the largest slopes alone.
pub fn bound_um(camera: &Camera, psi: f64) -> f64 {
    let slopes = camera.terms().filter_map(|term| term.largest_slope(camera.reference_wavelength_nm));
    distance_um(camera, 2.0 * defocus_rad(camera, psi).abs() + slopes.sum::<f64>())
}

/// Phase of the defocus at the pupil's edge at the reference wavelength.
fn defocus_rad(camera: &Camera, psi: f64) -> f64 {
    camera.defocus_sign.factor() * (psi - camera.focus_psi)
}

/// Where a ray meets the sensor that leaves a place of this slope, in radians at the reference wavelength per radius of the aperture.
fn distance_um(camera: &Camera, slope: f64) -> f64 {
    2.0 * camera.f_number() * slope * camera.reference_wavelength_nm * 1e-3 / TAU
}

/// Terms that have slopes, known ones.
fn sloped(camera: &Camera) -> impl Iterator<Item = &dyn PhaseTerm> {
    let nm = camera.reference_wavelength_nm;
    camera.terms().filter(move |term| term.largest_slope(nm).is_some_and(|slope| slope > 0.0))
}

/// Zones of the pupil, from and to, in which no slope jumps.
fn zones(camera: &Camera) -> Vec<[f64; 2]> {
    let mut edges: Vec<f64> = sloped(camera).flat_map(PhaseTerm::kinks).chain([0.0, 1.0]).collect();
    edges.sort_by(f64::total_cmp);
    edges.windows(2).map(|edge| [edge[0], edge[1]]).filter(|[from, to]| to > from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Aberration, Profile, Zernike};
    use std::f64::consts::PI;

    fn clear() -> Camera {
        Camera::resolve("clear").unwrap()
    }

    fn aberrated(noll: u32, rms_nm: f64) -> Camera {
        Camera { aberrations: Zernike(vec![Aberration { noll, rms_nm }]), ..clear() }
    }

    #[test]
    fn rays_of_defocus_fill_the_geometric_disk_evenly() {
        let rays = Rays::new(&clear(), 8.0);
        let radius = 0.5 * geometric_blur_um(&clear(), 8.0);
        assert!((rays.reach_um(0.0) / radius - 1.0).abs() < 0.005);
        assert!((rays.beyond(0.5 * radius) - 0.75).abs() < 0.01);
        assert_eq!((rays.beyond(radius), Rays::new(&clear(), 0.0).reach_um(0.0)), (0.0, 0.0));
    }

    #[test]
    fn rays_of_aberrations_follow_their_derivatives() {
        // Tilt: W = 2·rms·x, the same slope everywhere. Defocus: W = √3·rms·(2ρ² − 1). Coma: W = √8·rms·(3ρ³ − 2ρ)·cos θ.
        let edge = |noll, rms_nm| {
            Rays::new(&aberrated(noll, rms_nm), 0.0).reach_um(0.0) / (2.0 * clear().f_number())
        };
        assert!((edge(2, 500.0) - 1.0).abs() < 1e-9 && (edge(3, -500.0) - 1.0).abs() < 1e-9);
        assert!((edge(4, 1000.0) / (4.0 * 3f64.sqrt()) - 1.0).abs() < 0.005);
        assert!((edge(8, 1000.0) / (7.0 * 8f64.sqrt()) - 1.0).abs() < 0.02);
        // A defocus by the other name cancels it: Z4 = √3(2ρ² − 1), ψ of phase at the edge is 2√3·2π·rms/λ.
        let rms_nm = 3.0 * 460.0 / (2.0 * 3f64.sqrt() * TAU);
        assert!(Rays::new(&aberrated(4, rms_nm), 3.0).reach_um(0.0) < 1e-6);
    }

    #[test]
    fn rays_of_a_profile_leave_by_its_slope() {
        let profile = Profile { at_nm: 500.0, points: vec![[0.5, 0.0], [1.0, 10.0 * PI]] };
        let rays = Rays::new(&Camera { mask: [profile].into_iter().collect(), ..clear() }, 0.0);
        // The outer three quarters of the light: 20π rad per radius are 5 µm of path.
        let reach = 2.0 * clear().f_number() * 5.0;
        assert!((rays.reach_um(0.7) / reach - 1.0).abs() < 1e-9);
        assert!((rays.beyond(0.99 * reach) - 0.75).abs() < 1e-9 && rays.reach_um(0.76) == 0.0);
    }
}
