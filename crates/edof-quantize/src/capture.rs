//! Scenes to calibrate and judge on: sharp pictures behind the network's own camera, over its whole range of ψ and noise.

use crate::Scene;
use edof_optics::blur::blur_frame;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use edof_optics::sensor::{Sensor, SensorError, expose};
use edof_spec::network::Origin;
use edof_spec::{CfaPhase, ColourFrame, Noise};
use rayon::prelude::*;

/// Depths that scenes are captured at, evenly over the camera's range.
const DEPTHS: usize = 9;
/// Bits of the sensor.
const DEPTH: u32 = 12;

/// Captures every picture at nine depths of the range that the network's camera is meant for, without noise and with the most
/// it was trained for. `tell` hears how many pictures are done. The same pictures give the same scenes.
///
/// # Errors
/// [`SensorError`] for pictures of odd sides.
pub fn capture<'a>(
    pictures: &'a [(String, ColourFrame)],
    origin: &Origin,
    mut tell: impl FnMut(usize),
) -> Result<Vec<Scene<'a>>, SensorError> {
    let psis = depths(origin.camera.psi_range);
    let settings = Settings::default();
    let psfs: Vec<(f64, [Psf; 3])> =
        psis.into_iter().map(|psi| (psi, channel_psfs(&origin.camera, psi, &settings))).collect();
    let noises = if origin.noise > 0.0 { vec![0.0, origin.noise] } else { vec![0.0] };
    let mut scenes = Vec::with_capacity(pictures.len() * psfs.len() * noises.len());
    for (index, (name, sharp)) in pictures.iter().enumerate() {
        let captured: Vec<Vec<Scene<'a>>> = psfs
            .par_iter()
            .map(|(psi, psfs)| {
                let blurred = blur_frame(sharp, psfs);
                let shot = |(i, &gaussian): (usize, &f64)| {
                    let seed = 1 + i as u64;
                    let noise = Noise::gaussian(gaussian);
                    let sensor = Sensor { depth: DEPTH, phase: CfaPhase::Rggb, noise, seed };
                    let raw = expose(&blurred, &sensor)?;
                    Ok(Scene { name: format!("{name}, psi {psi}, noise {gaussian}"), raw, sharp })
                };
                noises.iter().enumerate().map(shot).collect::<Result<_, SensorError>>()
            })
            .collect::<Result<_, _>>()?;
        scenes.extend(captured.into_iter().flatten());
        tell(index + 1);
    }
    Ok(scenes)
}

/// Values of ψ that scenes are captured at, the ends of the range among them.
#[must_use]
pub fn depths([low, high]: [f64; 2]) -> Vec<f64> {
    if low == high {
        return vec![low];
    }
    (0..DEPTHS).map(|i| low + (high - low) * i as f64 / (DEPTHS - 1) as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::Camera;

    #[test]
    fn a_picture_is_captured_at_nine_depths_with_and_without_noise() {
        let sharp = ColourFrame { planes: ndarray::Array3::from_elem((3, 32, 48), 0.5) };
        let pictures = [("grey".to_owned(), sharp)];
        let origin = Origin {
            name: "n".into(),
            camera: Camera::resolve("ring-2018").unwrap(),
            noise: 0.01,
            command: String::new(),
            patches: 0,
            validation_db: 0.0,
        };
        let scenes = capture(&pictures, &origin, |_| ()).unwrap();
        assert_eq!(scenes.len(), 18);
        assert_eq!(scenes[17].name, "grey, psi 8, noise 0.01");
        assert!(scenes[0].raw.values().iter().all(|c| c.abs_diff(2048) <= 1));
        assert!(scenes[1].raw.values().iter().any(|c| c.abs_diff(2048) > 30));
    }
}
