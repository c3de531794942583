//! The lens: its generalised pupil for a mask, a defocus and a wavelength.

use edof_core::camera::{Camera, Profile};
use edof_numerics::fft::Complex64;

/// exp(i(s·(ψ − ψ_focus)·(λ_ref/λ)·ρ² + φ_λ(ρ))) inside the unit circle, nothing outside; ρ is the normalised radius.
#[derive(Debug, Clone)]
pub struct Pupil {
    defocus_rad: f64,
    wavelength_nm: f64,
    /// What of the mask changes smoothly.
    profile: Option<Profile>,
    /// Radii at which a zone of constant mask phase ends, ascending, with that zone's phasor.
    zones: Vec<(f64, Complex64)>,
}

impl Pupil {
    /// The pupil of `camera` at `wavelength_nm` for an object at `psi` (radians, stated at the camera's reference wavelength).
    /// Where rings overlap their phases add.
    #[must_use]
    pub fn new(camera: &Camera, wavelength_nm: f64, psi: f64) -> Self {
        let scale = camera.reference_wavelength_nm / wavelength_nm;
        let mut edges: Vec<f64> = camera.rings.iter().flat_map(|r| [r.inner, r.outer]).chain([1.0]).collect();
        edges.retain(|&e| e > 0.0);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut from = 0.0;
        let zones = edges
            .into_iter()
            .map(|to| {
                let middle = 0.5 * (from + to);
                from = to;
                let inside = camera.rings.iter().filter(|r| r.inner < middle && middle < r.outer);
                let phase: f64 = inside.map(|r| r.delay.phase_rad(wavelength_nm)).sum();
                (to, Complex64::cis(phase))
            })
            .collect();
        let defocus_rad = camera.defocus_sign.factor() * (psi - camera.focus_psi) * scale;
        Self { defocus_rad, wavelength_nm, profile: camera.profile.clone(), zones }
    }

    /// Phase of the defocus at the pupil's edge, in radians at this wavelength, with its sign.
    #[must_use]
    pub const fn defocus_rad(&self) -> f64 {
        self.defocus_rad
    }

    /// Σ ρ|Δ|² over the circles at which the pupil jumps, the aperture's edge among them: how much light diffraction throws far.
    #[must_use]
    pub fn edge_strength(&self) -> f64 {
        let next = self.zones.iter().skip(1).map(|(_, phasor)| *phasor).chain([Complex64::new(0.0, 0.0)]);
        self.zones.iter().zip(next).map(|((rho, phasor), next)| rho * (next - phasor).norm_sqr()).sum()
    }

    /// Mean of the pupil over the radii within `width`/2 of `rho`: a sample of that width sees soft edges, so that the grid does
    /// not show in the PSF.
    #[must_use]
    pub fn sample(&self, rho: f64, width: f64) -> Complex64 {
        let (low, high) = (rho - 0.5 * width, rho + 0.5 * width);
        let mut from = f64::NEG_INFINITY;
        let mut mask = Complex64::new(0.0, 0.0);
        for &(to, phasor) in &self.zones {
            mask += phasor * (high.min(to) - low.max(from)).max(0.0);
            from = to;
        }
        let smooth = self.profile.as_ref().map_or(0.0, |profile| profile.phase_rad(rho, self.wavelength_nm));
        mask / width * Complex64::cis(self.defocus_rad * rho * rho + smooth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::Delay;

    #[test]
    fn a_clear_pupil_in_focus_is_one_inside_and_soft_at_its_edge() {
        let pupil = Pupil::new(&Camera::resolve("clear").unwrap(), 535.0, 0.0);
        assert!((pupil.sample(0.5, 0.01) - 1.0).norm() < 1e-12);
        assert!((pupil.sample(1.0, 0.01).norm() - 0.5).abs() < 1e-12);
        assert_eq!(pupil.sample(1.1, 0.01).norm(), 0.0);
    }

    #[test]
    fn psi_is_the_phase_at_the_edge_and_scales_with_wavelength() {
        let camera = Camera::resolve("ring-2018").unwrap();
        assert!((Pupil::new(&camera, 460.0, 6.0).defocus_rad() + 6.0).abs() < 1e-12);
        assert!((Pupil::new(&camera, 920.0, 6.0).defocus_rad() + 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_ring_delays_its_zone_only() {
        let camera = Camera::resolve("ring-2018").unwrap();
        let pupil = Pupil::new(&camera, 455.0, 0.0);
        assert!(pupil.sample(0.6, 1e-6).arg().abs() < 1e-9);
        let phase = 9.079_203_f64.rem_euclid(std::f64::consts::TAU);
        assert!((pupil.sample(0.8, 1e-6).arg().rem_euclid(std::f64::consts::TAU) - phase).abs() < 1e-9);
    }

    #[test]
    fn a_phase_step_of_pi_throws_four_times_the_light_of_an_opaque_edge() {
        let mut camera = Camera::resolve("ring-2018").unwrap();
        assert_eq!(Pupil::new(&Camera::resolve("clear").unwrap(), 535.0, 2.0).edge_strength(), 1.0);
        camera.rings[0].delay = Delay::Phase { rad: std::f64::consts::PI, at_nm: 535.0 };
        let strength = Pupil::new(&camera, 535.0, 2.0).edge_strength();
        assert!((strength - (1.0 + 4.0 * 0.68)).abs() < 1e-9);
    }

    #[test]
    fn a_parabola_of_phase_is_defocus() {
        let mut masked = Camera::resolve("clear").unwrap();
        let points = (0..=200).map(|i| f64::from(i) / 200.0).map(|rho| [rho, -3.0 * rho * rho]).collect();
        masked.profile = Some(Profile { at_nm: 460.0, points });
        let clear = Camera::resolve("clear").unwrap();
        for nm in [460.0, 610.0] {
            let [a, b] = [(&masked, 0.0), (&clear, 3.0)].map(|(camera, psi)| Pupil::new(camera, nm, psi));
            assert!(
                [0.1, 0.53, 0.9]
                    .iter()
                    .all(|rho| (a.sample(*rho, 1e-6) - b.sample(*rho, 1e-6)).norm() < 1e-3)
            );
        }
    }

    #[test]
    fn a_focused_clear_lens_has_no_defocus_at_its_focus() {
        let camera = Camera::resolve("clear-mid").unwrap();
        assert_eq!(Pupil::new(&camera, 535.0, 4.0).defocus_rad(), 0.0);
    }
}
