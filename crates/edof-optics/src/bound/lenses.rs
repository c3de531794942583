//! Lenses that are compared: a camera without its mask, with a mask of the cubic family, with a smaller aperture, with another focus.

use edof_core::camera::{Camera, Monomial, Polynomial, Zernike};

/// Returns the camera closed by `stops`: each halves the aperture's area, and so every ψ. The mask is scaled with the aperture.
#[must_use]
pub fn closed(camera: &Camera, stops: f64) -> Camera {
    let smaller = (-stops).exp2();
    Camera {
        aperture_radius_mm: camera.aperture_radius_mm * smaller.sqrt(),
        focus_psi: camera.focus_psi * smaller,
        psi_range: camera.psi_range.map(|psi| psi * smaller),
        ..camera.clone()
    }
}

/// Returns the camera without its mask and aberrations.
#[must_use]
pub fn without_mask(camera: &Camera) -> Camera {
    Camera { aberrations: Zernike::default(), ..camera.without_mask() }
}

/// A mask of phase `strength`·(x³ + y³) + `mixed`·(x²y + xy²) over the aperture's radius, symmetric in x and y.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Cubic {
    /// Radians at the camera's reference wavelength.
    pub strength: f64,
    /// Radians at the camera's reference wavelength.
    pub mixed: f64,
}

/// Refractive index of the glass of masks (fused silica), n(λ) = a + b/λ² with λ in micrometres.
pub const GLASS: [f64; 2] = [1.458, 0.00354];

impl Cubic {
    /// Returns the camera with this mask in place of its own.
    #[must_use]
    pub fn on(self, camera: &Camera) -> Camera {
        let Self { strength, mixed } = self;
        let terms = [(3, 0, strength), (0, 3, strength), (2, 1, mixed), (1, 2, mixed)];
        let mut masked = without_mask(camera);
        masked.mask.add(Polynomial {
            at_nm: camera.reference_wavelength_nm,
            cauchy: Some(GLASS),
            terms: terms.map(|(x, y, rad)| Monomial { x, y, rad }).into(),
        });
        masked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::psi_metres;
    use edof_core::camera::Place;

    #[test]
    fn a_stop_halves_light_and_defocus() {
        let camera = Camera::resolve("clear-mid").unwrap();
        let smaller = closed(&camera, 1.0);
        assert!((smaller.f_number() / camera.f_number() - std::f64::consts::SQRT_2).abs() < 1e-12);
        assert!((psi_metres(&smaller) / psi_metres(&camera) - 0.5).abs() < 1e-12);
        assert_eq!((smaller.focus_psi, smaller.psi_range), (2.0, [0.0, 4.0]));
    }

    #[test]
    fn a_cubic_mask_has_its_phase() {
        let camera = Camera::resolve("clear-mid").unwrap();
        let lens = Cubic { strength: 2.3, mixed: 0.2 }.on(&camera);
        for (x, y) in [(0.5_f64, 0.1_f64), (-0.3, 0.6), (0.0, -0.9), (0.6, 0.6)] {
            let expected = 2.3 * (x.powi(3) + y.powi(3)) + 0.2 * x * y * (x + y);
            let found: f64 = lens
                .terms()
                .map(|term| term.phase_at(camera.reference_wavelength_nm)(Place::new(x, y)))
                .sum();
            assert!((found - expected).abs() < 1e-12, "{x} {y}: {found} {expected}");
        }
    }
}
