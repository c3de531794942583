//! Scenes to calibrate and judge on: sharp pictures behind the network's own camera, over its whole range of ψ and noise.

use crate::Scene;
use edof_core::{ColourFrame, Noise, Stride};
use edof_network::fixed_network::CalibratedOn;
use edof_network::network::{Condition, Origin};
use edof_optics::blur_frame;
use edof_optics::capture::CaptureError;
use edof_optics::draw::{Builtin, DrawError, draw};
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_optics::{Sensor, SensorError, expose};
use rayon::prelude::*;

/// Depths that scenes are captured at, evenly over the camera's range.
const DEPTHS: usize = 9;
/// Bits of the sensor.
pub const DEPTH: u32 = 12;

/// Built-in scenes to calibrate on where there are no photographs, and their size.
const DRAWN: u64 = 3;
const DRAWN_SIZE: (usize, usize) = (384, 512);

/// Pictures to calibrate on where nobody gives photographs: dead leaves.
///
/// # Errors
/// [`DrawError`], if there is no such scene.
pub fn drawn() -> Result<Vec<(String, ColourFrame)>, DrawError> {
    let (height, width) = DRAWN_SIZE;
    let picture = |seed| {
        let scene = draw(Builtin::Leaves, height, width, &[0.0], seed)?;
        Ok((format!("leaves-{seed}"), scene.sharp()))
    };
    (0..DRAWN).map(picture).collect()
}

/// How a network was calibrated: on N windows of what [`capture`] gives.
#[must_use]
pub fn calibrated_on(origin: &Origin, windows: u64) -> CalibratedOn {
    CalibratedOn {
        stride: Stride::FINEST,
        windows,
        psis: depths(origin.camera.psi_range),
        conditions: origin.conditions.clone(),
        depth: DEPTH,
    }
}

/// Captures every picture at nine depths of the range that the network's camera is meant for and under every condition that it was
/// trained for: each tone, without noise and with the most. `tell` hears how many pictures are done. The same pictures give the
/// same scenes.
///
/// # Errors
/// [`CaptureError`]: pictures of odd sides, or a range of depths that the camera has no PSFs for.
pub fn capture<'a>(
    pictures: &'a [(String, ColourFrame)],
    origin: &Origin,
    mut tell: impl FnMut(usize),
) -> Result<Vec<Scene<'a>>, CaptureError> {
    let psis = depths(origin.camera.psi_range);
    let settings = Settings::default();
    let psfs: Vec<(f64, [Psf; 3])> = psis
        .into_iter()
        .map(|psi| Ok((psi, channel_psfs(&origin.camera, psi, &settings)?)))
        .collect::<Result<_, NoPsf>>()?;
    let mut scenes = vec![];
    for (index, (name, sharp)) in pictures.iter().enumerate() {
        for condition in &origin.conditions {
            let light = condition.tone.decoded(sharp);
            let captured: Vec<Vec<Scene<'a>>> = psfs
                .par_iter()
                .map(|(psi, psfs)| shots(name, sharp, &blur_frame(&light, psfs), *psi, condition))
                .collect::<Result<_, SensorError>>()?;
            scenes.extend(captured.into_iter().flatten());
        }
        tell(index + 1);
    }
    Ok(scenes)
}

/// A blurred picture without noise and, where there is any, with the most of a condition.
fn shots<'a>(
    name: &str,
    sharp: &'a ColourFrame,
    blurred: &ColourFrame,
    psi: f64,
    condition: &Condition,
) -> Result<Vec<Scene<'a>>, SensorError> {
    let tone = condition.tone;
    let noisy = Some(condition.noise).filter(|noise| *noise != Noise::None);
    let shot = |(seed, noise): (u64, Noise)| {
        let sensor = Sensor { depth: DEPTH, noise, seed, ..Sensor::default() };
        let raw = expose(blurred, &sensor)?;
        Ok(Scene { name: format!("{name}, {tone}, psi {psi}, noise {noise}"), raw, sharp, tone })
    };
    (1..).zip(std::iter::once(Noise::None).chain(noisy)).map(shot).collect()
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
    use edof_core::Tone;
    use edof_core::camera::Camera;

    #[test]
    fn a_picture_is_captured_at_nine_depths_under_every_condition() {
        let sharp = ColourFrame { planes: ndarray::Array3::from_elem((3, 32, 48), 0.5) };
        let pictures = [("grey".to_owned(), sharp)];
        let camera = Camera::resolve("ring-2018").unwrap();
        let conditions = [(Tone::Linear, Noise::gaussian(0.01)), (Tone::Srgb, Noise::None)];
        let conditions =
            conditions.map(|(tone, noise)| Condition { tone, noise, least_noise: Noise::None }).to_vec();
        let origin = Origin { conditions, ..Origin::untrained("n", camera) };
        let scenes = capture(&pictures, &origin, |_| ()).unwrap();
        assert_eq!(scenes.len(), 27);
        assert_eq!(scenes[17].name, "grey, linear, psi 8, noise 0.01");
        assert_eq!(scenes[26].name, "grey, srgb, psi 8, noise none");
        // Half of the codes is a fifth of the light.
        assert!(scenes[26].raw.values().iter().all(|c| c.abs_diff(877) <= 1));
        assert!(scenes[0].raw.values().iter().all(|c| c.abs_diff(2048) <= 1));
        assert!(scenes[1].raw.values().iter().any(|c| c.abs_diff(2048) > 30));
    }

    #[test]
    fn shots_are_exposed_without_noise_and_then_with_the_most_each_with_its_own_seed() {
        let sharp = ColourFrame { planes: ndarray::Array3::from_elem((3, 16, 16), 0.5) };
        let condition =
            Condition { tone: Tone::Linear, noise: Noise::gaussian(0.02), least_noise: Noise::None };
        let scenes = shots("grey", &sharp, &sharp, 1.5, &condition).unwrap();
        let exposed =
            |seed, noise| expose(&sharp, &Sensor { depth: 12, noise, seed, ..Sensor::default() }).unwrap();
        assert_eq!(scenes.len(), 2);
        assert_eq!(scenes[0].raw.values(), exposed(1, Noise::None).values());
        assert_eq!(scenes[1].raw.values(), exposed(2, condition.noise).values());
        assert_eq!(scenes[0].name, "grey, linear, psi 1.5, noise none");
        assert!(scenes.iter().all(|scene| scene.sharp == &sharp && scene.tone == Tone::Linear));
    }

    #[test]
    fn depths_lie_evenly_from_end_to_end() {
        assert_eq!(depths([1.0, 3.0]), [1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0]);
        assert_eq!(depths([-4.0, 4.0])[..2], [-4.0, -3.0]);
        assert_eq!(depths([2.0, 2.0]), [2.0]);
    }

    #[test]
    fn the_calibration_states_its_depths_conditions_and_windows() {
        let origin = Origin::untrained("n", Camera::resolve("ring-2018").unwrap());
        let stated = calibrated_on(&origin, 77);
        assert_eq!((stated.stride, stated.windows, stated.depth), (Stride::FINEST, 77, 12));
        assert_eq!(stated.psis, depths(origin.camera.psi_range));
        assert_eq!(stated.conditions, origin.conditions);
    }

    #[test]
    fn progress_counts_pictures_that_are_done() {
        let grey = |name: &str| {
            (name.to_owned(), ColourFrame { planes: ndarray::Array3::from_elem((3, 16, 16), 0.5) })
        };
        let mut camera = Camera::resolve("clear").unwrap();
        camera.psi_range = [0.0, 0.0];
        let mut told = vec![];
        let pictures = [grey("a"), grey("b")];
        let scenes = capture(&pictures, &Origin::untrained("n", camera), |done| told.push(done)).unwrap();
        assert_eq!((told, scenes.len()), (vec![1, 2], 2));
    }

    #[test]
    fn three_different_pictures_of_leaves_stand_in_for_photographs() {
        let pictures = drawn().unwrap();
        assert_eq!(
            pictures.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["leaves-0", "leaves-1", "leaves-2"]
        );
        assert!(pictures.iter().all(|(_, picture)| picture.size() == (384, 512)));
        assert!(pictures[0].1 != pictures[1].1 && pictures[1].1 != pictures[2].1);
    }
}
