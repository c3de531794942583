//! How far rays go: the reach of a PSF by geometric optics, from the slope of the wavefront.
//!
//! A ray through a place of the pupil meets the sensor 2·F#·|∇W| from the centre, W the optical path over the aperture of radius 1.
//! Defocus, profile and aberrations have slopes. The edges of rings have none: they diffract ([`Pupil::edge_strength`]).
//!
//! [`Pupil::edge_strength`]: crate::pupil::Pupil::edge_strength

use super::wavefront::Term;
use crate::depth::geometric_blur_um;
use edof_core::camera::Camera;
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
    /// The rays from an object at `psi`. Heights of a height map are left out.
    pub fn new(camera: &Camera, psi: f64) -> Self {
        let terms: Vec<Term> = camera.aberrations.iter().map(Term::new).collect();
        let directions = if terms.is_empty() { 1 } else { DIRECTIONS };
        // Optical paths in micrometres for each radian.
        let path_um = |nm: f64| nm * 1e-3 / TAU;
        let defocus = camera.defocus_sign.factor() * (psi - camera.focus_psi);
        let bend = 2.0 * defocus * path_um(camera.reference_wavelength_nm);
        let mut parts = vec![];
        for [from, to, slope] in zones(camera) {
            let tilt = slope * path_um(camera.profile.as_ref().map_or(0.0, |profile| profile.at_nm));
            let count = ((to - from) * RADII).ceil().max(1.0);
            for part in 0..count as usize {
                let edge = |part: usize| from + (to - from) * part as f64 / count;
                let (low, high) = (edge(part), edge(part + 1));
                let rho = 0.5 * (low + high);
                let share = (high * high - low * low) / directions as f64;
                parts.extend((0..directions).map(|direction| {
                    let angle = TAU * direction as f64 / directions as f64;
                    let (outward, around) = terms.iter().fold((bend * rho + tilt, 0.0), |sum, term| {
                        let (outward, around) = term.slope(rho, angle);
                        (sum.0 + outward * 1e-3, sum.1 + around * 1e-3)
                    });
                    [2.0 * camera.f_number() * outward.hypot(around), share]
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
    if camera.profile.is_none() && camera.aberrations.is_empty() {
        return 0.5 * geometric_blur_um(camera, psi);
    }
    Rays::new(camera, psi).reach_um(NEXT_TO_NONE)
}

/// Zones of the pupil in which the profile has one slope: from, to, radians per radius of the aperture.
fn zones(camera: &Camera) -> Vec<[f64; 3]> {
    let points = camera.profile.as_ref().map_or(&[][..], |profile| &profile.points);
    let ends = points.first().zip(points.last());
    let sloped = points.windows(2).map(|pair| {
        let ([from, a], [to, b]) = (pair[0], pair[1]);
        [from, to, (b - a) / (to - from)]
    });
    let (first, last) = ends.map_or((1.0, 1.0), |(first, last)| (first[0], last[0]));
    let flat = [[0.0, first, 0.0], [last, 1.0, 0.0]].into_iter();
    flat.chain(sloped).filter(|[from, to, _]| to > from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Aberration, Profile};
    use std::f64::consts::PI;

    fn clear() -> Camera {
        Camera::resolve("clear").unwrap()
    }

    fn aberrated(noll: u32, rms_nm: f64) -> Camera {
        Camera { aberrations: vec![Aberration { noll, rms_nm }], ..clear() }
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
        let rays = Rays::new(&Camera { profile: Some(profile), ..clear() }, 0.0);
        // The outer three quarters of the light: 20π rad per radius are 5 µm of path.
        let reach = 2.0 * clear().f_number() * 5.0;
        assert!((rays.reach_um(0.7) / reach - 1.0).abs() < 1e-9);
        assert!((rays.beyond(0.99 * reach) - 0.75).abs() < 1e-9 && rays.reach_um(0.76) == 0.0);
    }
}
