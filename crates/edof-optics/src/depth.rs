//! ψ and the distance of an object, both ways (paper, equation 1).
//!
//! ψ = (πR²/λ)(1/z_o − 1/z_n), λ the camera's reference wavelength, z_o the object's distance and z_n the distance at which ψ is
//! zero. Nearer objects have larger ψ. The lens itself is focused at the camera's `focus_psi`.

use edof_core::camera::Camera;

/// ψ (radians) of an object at `object_m` metres when ψ = 0 lies at `nominal_m` metres; either may be infinite.
///
/// ```
/// use edof_optics::{distance_m, psi_at};
/// let camera = edof_core::camera::Camera::resolve("ring-2018")?;
/// let psi = psi_at(&camera, 1.5, 3.0);
/// assert!((distance_m(&camera, psi, 3.0).unwrap() - 1.5).abs() < 1e-9);
/// # Ok::<(), edof_core::camera::CameraError>(())
/// ```
#[must_use]
pub fn psi_at(camera: &Camera, object_m: f64, nominal_m: f64) -> f64 {
    psi_metres(camera) * (1.0 / object_m - 1.0 / nominal_m)
}

/// Distance in metres of an object with the given ψ; none where ψ lies beyond infinity.
#[must_use]
pub fn distance_m(camera: &Camera, psi: f64, nominal_m: f64) -> Option<f64> {
    let nearness = psi / psi_metres(camera) + 1.0 / nominal_m;
    (nearness >= 0.0).then(|| 1.0 / nearness)
}

/// πR²/λ in metres: ψ for an object at one metre when ψ = 0 lies at infinity.
#[must_use]
pub fn psi_metres(camera: &Camera) -> f64 {
    let radius_m = camera.aperture_radius_mm * 1e-3;
    std::f64::consts::PI * radius_m * radius_m / (camera.reference_wavelength_nm * 1e-9)
}

/// Diameter in micrometres of the disk that rays alone would make on the sensor, (4/π)·ψ·λ·F#, for a clear lens seeing an object
/// `psi` away from its focus.
#[must_use]
pub fn geometric_blur_um(camera: &Camera, psi: f64) -> f64 {
    let wave_um = camera.wave_um(camera.reference_wavelength_nm);
    4.0 / std::f64::consts::PI * (psi - camera.focus_psi).abs() * wave_um
}

/// A range of ψ in metres behind a comma, before a camera that knows where ψ is zero.
pub(crate) fn in_metres(camera: &Camera, [low, high]: [f64; 2]) -> String {
    let Some(nominal) = camera.nominal_m else { return String::new() };
    let metres = |psi| distance_m(camera, psi, nominal).filter(|metres| *metres > 0.0);
    match (metres(high), metres(low).filter(|metres| metres.is_finite())) {
        (Some(near), Some(far)) => format!(", {near:.3} to {far:.3} m"),
        (Some(near), None) => format!(", {near:.3} m and farther"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn equation_one_by_hand() {
        // R = 2.3 mm, λ = 460 nm: πR²/λ = 36.13 m; from 10 m to 3.109 m is ψ = 8.
        let camera = Camera::resolve("ring-2018").unwrap();
        assert!((psi_metres(&camera) - 36.128).abs() < 1e-3);
        assert!((distance_m(&camera, 8.0, 10.0).unwrap() - 3.1109).abs() < 1e-3);
    }

    #[test]
    fn infinity_is_a_distance_and_beyond_it_there_is_none() {
        let camera = Camera::resolve("clear").unwrap();
        assert_eq!(distance_m(&camera, 0.0, f64::INFINITY), Some(f64::INFINITY));
        assert_eq!(distance_m(&camera, -1.0, f64::INFINITY), None);
        assert_eq!(psi_at(&camera, f64::INFINITY, f64::INFINITY), 0.0);
    }

    #[test]
    fn the_blur_disk_is_about_five_pixels_at_psi_eight() {
        let camera = Camera::resolve("clear").unwrap();
        assert!((geometric_blur_um(&camera, 8.0) / camera.pixel_pitch_um - 5.43).abs() < 0.01);
    }

    proptest! {
        #[test]
        fn distance_and_psi_invert(object in 0.05f64..1e4, nominal in 0.05f64..1e4) {
            let camera = Camera::resolve("ring-outer").unwrap();
            let back = distance_m(&camera, psi_at(&camera, object, nominal), nominal).unwrap();
            prop_assert!((back / object - 1.0).abs() < 1e-6);
        }
    }
}
