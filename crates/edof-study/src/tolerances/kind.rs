//! Kinds of errors that a maker makes, and what each does to a camera.

use edof_core::camera::Camera;
use edof_core::camera::{Ring, Spectrum};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// What is wrong with a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Nothing.
    None,
    /// Radii of the mask's rings, in percent of the aperture's radius. Edges at the centre and at the aperture's rim stay.
    Radius,
    /// Depth of the mask, in percent of itself.
    Depth,
    /// Wavelengths of all three colours, in nanometres.
    Wavelength,
    /// Focus, in ψ.
    Focus,
}

impl Kind {
    /// All errors.
    pub const ERRORS: [Self; 4] = [Self::Radius, Self::Depth, Self::Wavelength, Self::Focus];

    /// Amounts that are measured, each with both signs.
    #[must_use]
    pub const fn amounts(self) -> &'static [f64] {
        match self {
            Self::None => &[],
            Self::Radius => &[0.25, 0.5, 1.0, 2.0, 4.0],
            Self::Depth | Self::Wavelength => &[2.5, 5.0, 10.0, 20.0],
            Self::Focus => &[0.1, 0.2, 0.4, 0.8],
        }
    }

    /// Name of the error.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Radius => "ring radius",
            Self::Depth => "ring depth",
            Self::Wavelength => "wavelength",
            Self::Focus => "focus",
        }
    }

    /// Unit of the amounts.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Radius => "% of the aperture radius",
            Self::Depth => "% of the depth",
            Self::Wavelength => "nm",
            Self::Focus => "ψ",
        }
    }

    /// A camera with the error; the network still knows the one without.
    #[must_use]
    pub fn applied(self, amount: f64, camera: &Camera) -> Camera {
        let mut camera = camera.clone();
        match self {
            Self::None => {}
            Self::Radius => camera.mask.rings_mut().for_each(|ring| moved(ring, amount / 100.0)),
            Self::Depth => camera.mask.terms_mut().iter_mut().for_each(|t| t.scale(1.0 + amount / 100.0)),
            Self::Wavelength => {
                camera.spectra = camera.spectra.map(|spectrum| match spectrum {
                    Spectrum::Line(nm) => Spectrum::Line(nm + amount),
                    Spectrum::Sampled(pairs) => Spectrum::Sampled(
                        pairs.into_iter().map(|[nm, weight]| [nm + amount, weight]).collect(),
                    ),
                });
            }
            Self::Focus => camera.focus_psi += amount,
        }
        camera
    }

    /// Whether the error changes a camera: a mask without rings has no radii.
    #[must_use]
    pub fn changes(self, camera: &Camera) -> bool {
        self.amounts().iter().any(|amount| self.applied(*amount, camera) != *camera)
    }

    /// The amount in micrometres: of a radius on the mask, or of the sensor's distance from the lens.
    #[must_use]
    pub fn micrometres(self, amount: f64, camera: &Camera) -> Option<f64> {
        let Camera { focal_length_mm, aperture_radius_mm, reference_wavelength_nm, .. } = *camera;
        match self {
            Self::Radius => Some(amount * 10.0 * aperture_radius_mm),
            // ψ = (πR²/λ)·Δ/f².
            Self::Focus => {
                let ratio = focal_length_mm / aperture_radius_mm;
                Some(amount * reference_wavelength_nm * 1e-3 * ratio * ratio / PI)
            }
            Self::None | Self::Depth | Self::Wavelength => None,
        }
    }
}

fn moved(ring: &mut Ring, by: f64) {
    for edge in [&mut ring.inner, &mut ring.outer] {
        if *edge > 0.0 && *edge < 1.0 {
            *edge = (*edge + by).clamp(0.0, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_error_changes_its_own_part_of_the_camera() {
        let camera = Camera::resolve("ring-outer").unwrap();
        assert_eq!(Kind::None.applied(1.0, &camera), camera);
        let ring = |camera: &Camera| *camera.mask.rings().next().unwrap();
        let deeper = ring(&Kind::Depth.applied(10.0, &camera)).delay;
        let ring = ring(&Kind::Radius.applied(-1.0, &camera));
        assert!((ring.inner - 0.8665).abs() < 1e-12);
        assert!((ring.outer - 1.0).abs() < 1e-12, "the rim is the aperture's");
        assert!((deeper.phase_rad(460.0) - 1.1 * -3.78).abs() < 1e-9);
        assert_eq!(Kind::Wavelength.applied(5.0, &camera).spectra[0], Spectrum::Line(615.0));
        assert!((Kind::Focus.applied(0.4, &camera).focus_psi - 4.84).abs() < 1e-12);
        assert!(Kind::ERRORS.iter().all(|kind| kind.changes(&camera)));
        let clear = camera.without_mask();
        assert_eq!(Kind::ERRORS.map(|kind| kind.changes(&clear)), [false, false, true, true]);
    }

    #[test]
    fn amounts_are_stated_in_micrometres_where_they_are_lengths() {
        let camera = Camera::resolve("ring-outer").unwrap();
        assert!((Kind::Radius.micrometres(1.0, &camera).unwrap() - 23.0).abs() < 1e-9);
        assert!((Kind::Focus.micrometres(1.0, &camera).unwrap() - 7.086).abs() < 1e-3);
        assert_eq!(Kind::Depth.micrometres(1.0, &camera), None);
    }
}
