//! The lens: its generalised pupil for a mask, a defocus and a wavelength.

use edof_core::camera::{Camera, Change, Function, PhaseTerm, Place, Symmetry};
use edof_numerics::fft::Complex64;

/// exp(i(s·(ψ − ψ_focus)·(λ_ref/λ)·ρ² + φ_λ(x, y))) inside the unit circle, nothing outside; ρ is the normalised radius and φ the sum over
/// the camera's terms.
pub struct Pupil<'a> {
    camera: &'a Camera,
    wavelength_nm: f64,
    defocus_rad: f64,
    /// Terms whose phase jumps at radii, by their place in the camera's list.
    stepped: Vec<(usize, Function<'a, f64>)>,
    /// Round terms without jumps.
    round: Vec<Function<'a, f64>>,
    /// All others.
    shaped: Vec<Function<'a, f64>>,
    /// Radii at which a zone of constant phase of the stepped terms ends, ascending, with that zone's phasor.
    zones: Vec<(f64, Complex64)>,
}

impl<'a> Pupil<'a> {
    /// The pupil of `camera` at `wavelength_nm` for an object at `psi` (radians, stated at the camera's reference wavelength).
    #[must_use]
    pub fn new(camera: &'a Camera, wavelength_nm: f64, psi: f64) -> Self {
        let scale = camera.reference_wavelength_nm / wavelength_nm;
        let defocus_rad = camera.defocus_sign.factor() * (psi - camera.focus_psi) * scale;
        let (mut stepped, mut round, mut shaped) = (vec![], vec![], vec![]);
        let mut edges = vec![1.0];
        for (index, term) in camera.terms().enumerate() {
            let (phase, jumps) = (term.phase_at(wavelength_nm), term.jumps());
            match term.symmetry() {
                Symmetry::None => shaped.push(phase),
                Symmetry::Round if jumps.is_empty() => round.push(phase),
                Symmetry::Round => stepped.push((index, phase)),
            }
            edges.extend(jumps);
        }
        edges.retain(|&e| e > 0.0);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut pupil = Self { camera, wavelength_nm, defocus_rad, stepped, round, shaped, zones: vec![] };
        let mut from = 0.0;
        let zone = |to| {
            let middle = 0.5 * (from + to);
            from = to;
            (to, Complex64::cis(pupil.step(middle, None)))
        };
        pupil.zones = edges.into_iter().map(zone).collect();
        pupil
    }

    /// Returns the phase of the stepped terms at a radius, of all or of all but one.
    fn step(&self, rho: f64, without: Option<usize>) -> f64 {
        let at = Place { x: rho, y: 0.0, rho };
        self.stepped.iter().filter(|(index, _)| Some(*index) != without).map(|(_, phase)| phase(at)).sum()
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

    /// Integral of the zones' phasors over the radius.
    fn between(&self, [low, high]: [f64; 2]) -> Complex64 {
        let mut from = f64::NEG_INFINITY;
        let mut sum = Complex64::new(0.0, 0.0);
        for &(to, phasor) in &self.zones {
            sum += phasor * (high.min(to) - low.max(from)).max(0.0);
            from = to;
        }
        sum
    }

    /// Phasor of defocus and of the round terms without jumps.
    fn carrier(&self, rho: f64) -> Complex64 {
        let at = Place { x: rho, y: 0.0, rho };
        let smooth: f64 = self.round.iter().map(|phase| phase(at)).sum();
        Complex64::cis(self.defocus_rad * rho * rho + smooth)
    }

    /// Phasor of the terms that are not round.
    fn shape(&self, at: Place) -> Complex64 {
        Complex64::cis(self.shaped.iter().map(|phase| phase(at)).sum())
    }

    /// Returns the mean of a round pupil over the radii within `width`/2 of `rho`: a sample of that width sees soft edges, so that the
    /// grid does not show in the PSF.
    #[must_use]
    pub fn sample(&self, rho: f64, width: f64) -> Complex64 {
        self.between(around(rho, width)) / width * self.carrier(rho)
    }

    /// Returns the mean of any pupil at a place, over the radii within `width`/2.
    #[must_use]
    pub fn sample_at(&self, at: Place, width: f64) -> Complex64 {
        self.sample(at.rho, width) * self.shape(at)
    }

    /// Returns the derivative of [`Pupil::sample_at`] by the ψ at which the lens is focused.
    pub fn focus_change(&self) -> impl Fn(Place, f64) -> Complex64 {
        let scale =
            self.camera.defocus_sign.factor() * self.camera.reference_wavelength_nm / self.wavelength_nm;
        move |at, width| self.sample_at(at, width) * Complex64::new(0.0, -scale * at.rho * at.rho)
    }

    /// Returns the derivative of [`Pupil::sample_at`] by a parameter of one of the camera's terms.
    ///
    /// # Panics
    /// If the camera has no such term.
    pub fn term_change(&self, term: usize, parameter: usize) -> impl Fn(Place, f64) -> Complex64 {
        let i = Complex64::new(0.0, 1.0);
        let own: &dyn PhaseTerm = self.camera.terms().nth(term).expect("a term of the camera");
        let change = own.change(parameter, self.wavelength_nm, self.camera.reference_wavelength_nm);
        move |at, width| {
            let [low, high] = around(at.rho, width);
            let steps = match &change {
                Change::Smooth(derivative) => return self.sample_at(at, width) * i * derivative(at),
                &Change::Zone { inner, outer, rad } => {
                    i * rad * self.between([low.max(inner), high.min(outer)])
                }
                &Change::Edge { radius, .. } if !(low < radius && radius <= high) => {
                    return Complex64::new(0.0, 0.0);
                }
                &Change::Edge { radius, is_inside } => {
                    let side = if is_inside { -1.0 } else { 1.0 };
                    let beside = radius + side * 1e-9;
                    let others = self.step(beside, Some(term));
                    let own = self.step(beside, None) - others;
                    -side * Complex64::cis(others) * (Complex64::cis(own) - 1.0)
                }
            };
            steps / width * self.carrier(at.rho) * self.shape(at)
        }
    }
}

/// How the squared magnitude of a number changes with it.
pub(crate) fn squared_change(v: Complex64, change: Complex64) -> f64 {
    2.0 * (v.re * change.re + v.im * change.im)
}

/// The radii that a sample of a width sees.
fn around(rho: f64, width: f64) -> [f64; 2] {
    [rho - 0.5 * width, rho + 0.5 * width]
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Delay, Profile};

    #[test]
    fn a_clear_pupil_in_focus_is_one_inside_and_soft_at_its_edge() {
        let camera = Camera::resolve("clear").unwrap();
        let pupil = Pupil::new(&camera, 535.0, 0.0);
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
        camera
            .mask
            .rings_mut()
            .for_each(|ring| ring.delay = Delay::Phase { rad: std::f64::consts::PI, at_nm: 535.0 });
        let strength = Pupil::new(&camera, 535.0, 2.0).edge_strength();
        assert!((strength - (1.0 + 4.0 * 0.68)).abs() < 1e-9);
    }

    #[test]
    fn a_parabola_of_phase_is_defocus() {
        let mut masked = Camera::resolve("clear").unwrap();
        let points = (0..=200).map(|i| f64::from(i) / 200.0).map(|rho| [rho, -3.0 * rho * rho]).collect();
        masked.mask.add(Profile { at_nm: 460.0, points });
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
