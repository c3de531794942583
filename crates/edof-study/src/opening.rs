//! One scene for lenses of different apertures: the same light and time, stated for the widest of them.

use edof_core::Noise;
use edof_core::camera::Camera;
use edof_core::noise::SensorNoise;
use edof_optics::{Layer, Scene};

/// The area of a lens's aperture as a share of that of the widest lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Opening(f64);

impl Opening {
    /// Returns that of a lens among others.
    pub(crate) fn among<'a>(camera: &Camera, all: impl Iterator<Item = &'a Camera>) -> Self {
        let widest = all.map(|lens| lens.aperture_radius_mm).fold(camera.aperture_radius_mm, f64::max);
        Self((camera.aperture_radius_mm / widest).powi(2))
    }

    /// Returns ψ behind this lens.
    pub(crate) fn psi(self, of_widest: f64) -> f64 {
        self.0 * of_widest
    }

    /// Returns the noise behind this lens: the gain is raised until white fills the scale again.
    pub(crate) fn noise(self, of_widest: Noise) -> Noise {
        match of_widest {
            Noise::None => Noise::None,
            Noise::Gaussian { sigma } => Noise::Gaussian { sigma: sigma / self.0 },
            Noise::Sensor(sensor) => Noise::Sensor(SensorNoise { gain: sensor.gain / self.0, ..sensor }),
        }
    }

    /// Returns the scene with its depths as ψ of this lens.
    pub(crate) fn scene(self, of_widest: &Scene) -> Scene {
        let layer = |layer: &Layer| Layer { psi: self.psi(layer.psi), ..layer.clone() };
        Scene { name: of_widest.name.clone(), layers: of_widest.layers.iter().map(layer).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_aperture_has_less_defocus_and_more_noise_by_its_area() {
        let wide = Camera::resolve("clear").unwrap();
        let closed = Camera { aperture_radius_mm: wide.aperture_radius_mm / 2f64.sqrt(), ..wide.clone() };
        let all = [wide, closed];
        let [open, half] = all.each_ref().map(|lens| Opening::among(lens, all.iter()));
        let noises = [Noise::None, Noise::gaussian(0.01), Noise::sensor(3.0)];
        assert_eq!((open.psi(8.0), noises.map(|noise| open.noise(noise))), (8.0, noises));
        assert!((half.psi(8.0) - 4.0).abs() < 1e-12);
        assert_eq!(half.noise(Noise::None), Noise::None);
        let Noise::Gaussian { sigma } = half.noise(noises[1]) else { panic!() };
        let Noise::Sensor(sensor) = half.noise(noises[2]) else { panic!() };
        assert!((sigma - 0.02).abs() < 1e-12 && (sensor.gain - 6.0).abs() < 1e-12);
        let scene = Scene::flat("grey", edof_core::ColourFrame::zeros(8, 8), 6.0);
        assert!((half.scene(&scene).layers[0].psi - 3.0).abs() < 1e-12);
    }
}
