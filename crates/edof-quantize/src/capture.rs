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
/// Scenes that are enough to measure the ranges of a network's codes on (docs/your-own-lens.md): as many as there are of the built-in pictures.
pub const FRAMES: usize = DRAWN as usize * DEPTHS * 2;

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

/// Returns how many scenes there are of N pictures: each at nine depths of the range that the network's camera is meant for and under every
/// condition that it was trained for, in its tone, without noise and with the most.
#[must_use]
pub fn scenes(pictures: usize, origin: &Origin) -> usize {
    let shots: usize = origin.conditions.iter().map(|condition| noises(condition).len()).sum();
    pictures * depths(origin.camera.psi_range).len() * shots
}

/// Captures at most so many of the [`scenes`] of pictures, spread evenly over pictures, depths, conditions and noise. `tell` hears how many pictures
/// are done. The same pictures give the same scenes.
///
/// # Errors
/// [`CaptureError`]: pictures of odd sides, or a range of depths that the camera has no PSFs for.
pub fn capture<'a>(
    pictures: &'a [(String, ColourFrame)],
    origin: &Origin,
    most: usize,
    mut tell: impl FnMut(usize),
) -> Result<Vec<Scene<'a>>, CaptureError> {
    let psis = depths(origin.camera.psi_range);
    let settings = Settings::default();
    let psfs: Vec<(f64, [Psf; 3])> = psis
        .into_iter()
        .map(|psi| Ok((psi, channel_psfs(&origin.camera, psi, &settings)?)))
        .collect::<Result<_, NoPsf>>()?;
    let wanted = spread(scenes(pictures.len(), origin), most);
    let mut place = 0;
    let mut captured = vec![];
    for (index, (name, sharp)) in pictures.iter().enumerate() {
        for condition in &origin.conditions {
            let shots_each = noises(condition).len();
            let wanted = &wanted[place..place + psfs.len() * shots_each];
            place += wanted.len();
            if !wanted.contains(&true) {
                continue;
            }
            let light = condition.tone.decoded(sharp);
            let of_depths: Vec<Vec<Scene<'a>>> = psfs
                .par_iter()
                .zip(wanted.par_chunks(shots_each))
                .filter(|(_, wanted)| wanted.contains(&true))
                .map(|((psi, psfs), wanted)| {
                    shots((name, sharp), &blur_frame(&light, psfs), *psi, condition, wanted)
                })
                .collect::<Result<_, SensorError>>()?;
            captured.extend(of_depths.into_iter().flatten());
        }
        tell(index + 1);
    }
    Ok(captured)
}

/// Which of N places to take so that at most so many are taken, evenly spread: multiples of a step near the golden section of N, without a
/// common divisor, are so far apart at every scale.
fn spread(all: usize, most: usize) -> Vec<bool> {
    if all <= most {
        return vec![true; all];
    }
    let mut taken = vec![false; all];
    let step = (618 * all / 1000..).find(|step| gcd(*step, all) == 1).unwrap_or(1);
    (0..most).for_each(|k| taken[k * step % all] = true);
    taken
}

const fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Noises of a condition's shots: none, and where there is any, the most.
fn noises(condition: &Condition) -> Vec<Noise> {
    let noisy = Some(condition.noise).filter(|noise| *noise != Noise::None);
    std::iter::once(Noise::None).chain(noisy).collect()
}

/// The wanted ones of a blurred picture's shots, one for each of [`noises`].
fn shots<'a>(
    (name, sharp): (&str, &'a ColourFrame),
    blurred: &ColourFrame,
    psi: f64,
    condition: &Condition,
    wanted: &[bool],
) -> Result<Vec<Scene<'a>>, SensorError> {
    let tone = condition.tone;
    let shot = |(seed, noise): (u64, Noise)| {
        let sensor = Sensor { depth: DEPTH, noise, seed, ..Sensor::default() };
        let raw = expose(blurred, &sensor)?;
        Ok(Scene { name: format!("{name}, {tone}, psi {psi}, noise {noise}"), raw, sharp, tone })
    };
    let shots = (1..).zip(noises(condition)).zip(wanted).filter(|(_, wanted)| **wanted);
    shots.map(|(of, _)| shot(of)).collect()
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
        let scenes = capture(&pictures, &origin, usize::MAX, |_| ()).unwrap();
        assert_eq!((scenes.len(), super::scenes(1, &origin)), (27, 27));
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
        let shots = |wanted: &[bool]| shots(("grey", &sharp), &sharp, 1.5, &condition, wanted).unwrap();
        let scenes = shots(&[true, true]);
        let exposed =
            |seed, noise| expose(&sharp, &Sensor { depth: 12, noise, seed, ..Sensor::default() }).unwrap();
        assert_eq!(scenes.len(), 2);
        assert_eq!(scenes[0].raw.values(), exposed(1, Noise::None).values());
        assert_eq!(scenes[1].raw.values(), exposed(2, condition.noise).values());
        assert_eq!(scenes[0].name, "grey, linear, psi 1.5, noise none");
        assert!(scenes.iter().all(|scene| scene.sharp == &sharp && scene.tone == Tone::Linear));
        let noisy = shots(&[false, true]);
        assert_eq!((noisy.len(), noisy[0].raw.values()), (1, scenes[1].raw.values()));
    }

    #[test]
    fn fewer_scenes_are_spread_over_pictures_depths_and_noise() {
        // As of sixteen photographs at nine depths, without and with noise.
        let (all, of_picture) = (288, 18);
        let taken = spread(all, FRAMES);
        let of =
            |is_in: &dyn Fn(usize) -> bool| (0..all).filter(|&place| taken[place] && is_in(place)).count();
        assert_eq!(of(&|_| true), FRAMES);
        let pictures: Vec<usize> = (0..16).map(|p| of(&|place| place / of_picture == p)).collect();
        assert!(pictures.iter().all(|count| (2..=5).contains(count)), "{pictures:?}");
        let depths: Vec<usize> = (0..9).map(|d| of(&|place| place % of_picture / 2 == d)).collect();
        assert!(depths.iter().all(|count| (3..=8).contains(count)), "{depths:?}");
        let noisy = of(&|place| place % 2 == 1);
        assert!((20..=28).contains(&noisy), "{noisy}");
        for (all, most) in [(3, 48), (48, 48), (54, 48), (1, 1), (1000, 999), (7, 0)] {
            let taken = spread(all, most).into_iter().filter(|taken| *taken).count();
            assert_eq!(taken, all.min(most), "{all} {most}");
        }
    }

    #[test]
    fn a_few_scenes_are_those_of_all() {
        let grey = |level: f32| ColourFrame { planes: ndarray::Array3::from_elem((3, 16, 16), level) };
        let pictures = [("dark".to_owned(), grey(0.1)), ("light".to_owned(), grey(0.8))];
        let condition =
            Condition { tone: Tone::Linear, noise: Noise::gaussian(0.01), least_noise: Noise::None };
        let camera = Camera { psi_range: [0.0, 1.0], ..Camera::resolve("clear").unwrap() };
        let origin = Origin { conditions: vec![condition], ..Origin::untrained("n", camera) };
        let all = capture(&pictures, &origin, usize::MAX, |_| ()).unwrap();
        let mut told = vec![];
        let few = capture(&pictures, &origin, 5, |done| told.push(done)).unwrap();
        assert_eq!((all.len(), few.len(), told), (36, 5, vec![1, 2]));
        for scene in &few {
            assert!(
                all.iter().any(|other| (&other.name, &other.raw) == (&scene.name, &scene.raw)),
                "{}",
                scene.name
            );
        }
        assert!(["dark", "light"].iter().all(|name| few.iter().any(|scene| scene.name.starts_with(name))));
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
        let scenes =
            capture(&pictures, &Origin::untrained("n", camera), usize::MAX, |done| told.push(done)).unwrap();
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
