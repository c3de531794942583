//! Lenses that are compared: a camera without its mask, with a mask of the cubic family, with a smaller aperture, with another focus.

use edof_core::camera::{Camera, HeightMap, Mask, Zernike, etched_rad};
use ndarray::Array2;

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
/// Side in pixels of the picture of a mask's surface.
const SIDE: usize = 256;

impl Cubic {
    /// Returns the phase at a place of the aperture, −1…1 to the right and upward.
    #[must_use]
    pub fn phase_rad(self, x: f64, y: f64) -> f64 {
        self.strength * (x.powi(3) + y.powi(3)) + self.mixed * x * y * (x + y)
    }

    /// Returns the camera with this mask in place of its own.
    #[must_use]
    pub fn on(self, camera: &Camera) -> Camera {
        let place = |i: usize| (2.0 * i as f64 + 1.0) / SIDE as f64 - 1.0;
        // The corners lie outside of the aperture.
        let within = |x: f64, y: f64| {
            let shrink = (1.0 / x.hypot(y)).min(1.0);
            self.phase_rad(x * shrink, y * shrink)
        };
        let phases = Array2::from_shape_fn((SIDE, SIDE), |(r, c)| within(place(c), -place(r)));
        let low = phases.iter().copied().fold(f64::INFINITY, f64::min);
        let span = phases.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
        let white_um = span / etched_rad(1.0, GLASS, camera.reference_wavelength_nm);
        let steps = f64::from(u16::MAX);
        // As the 16-bit picture has it.
        let heights = phases.mapv(|v| (((v - low) / span * steps).round() / steps) as f32);
        let mut map =
            HeightMap { file: String::new(), white_um, cauchy: GLASS, sha256: String::new(), heights: None };
        let taken = map.take(heights, "mask.png".into(), &camera.name);
        debug_assert!(taken.is_ok());
        Camera { mask: Mask::from_iter([map]), ..without_mask(camera) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::psi_metres;
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
    fn a_cubic_mask_has_its_phase_but_for_a_constant() {
        let camera = Camera::resolve("clear-mid").unwrap();
        let cubic = Cubic { strength: 2.3, mixed: 0.2 };
        let camera = cubic.on(&camera);
        let mask = camera.mask.terms()[0].phase_at(460.0);
        let phase = |x, y| mask(Place::new(x, y));
        for (x, y) in [(0.5, 0.1), (-0.3, 0.6), (0.0, -0.9), (0.6, 0.6)] {
            let (found, expected) = (phase(x, y) - phase(0.0, 0.0), cubic.phase_rad(x, y));
            assert!((found - expected).abs() < 2e-3, "{x} {y}: {found} {expected}");
        }
    }
}
