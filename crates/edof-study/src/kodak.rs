//! The main experiment: every method behind its camera, on every photograph, depth and noise level.
//!
//! A photograph is light under the tone asked for: its numbers as they are (the paper's convention), or decoded from sRGB. It
//! is blurred by the camera's kernels at each ψ, exposed with 16 bits and noise, and reconstructed; the result is compared
//! with the photograph as a picture and as light. The noise depends on photograph, ψ and noise level alone, so that all
//! cameras and methods meet the same. Methods run one after the other, each on all threads, so that their times can be
//! compared; all else runs side by side.

use crate::method::{Entry, Method};
use crate::metrics::{BORDER, MetricError, Quality, shown};
use crate::photos::Photo;
use edof_optics::blur::blur_frame;
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_optics::sensor::{Sensor, SensorError, expose};
use edof_spec::reconstructor::Multiplications;
use edof_spec::{Camera, ColourFrame, Noise, RawFrame, ReconstructError, Reconstruction, Tone};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Bits of the simulated sensor.
const DEPTH: u32 = 16;

/// A camera and the methods that stand behind it.
pub struct Setup {
    /// The camera.
    pub camera: Camera,
    /// Methods.
    pub entries: Vec<Entry>,
}

/// Settings of an experiment.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// Whether photographs hold light or sRGB's encoding of it.
    pub tone: Tone,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// The three noise levels that tables show under a tone, if none are asked for.
#[must_use]
pub fn usual_noise(tone: Tone) -> [Noise; 3] {
    match tone {
        Tone::Linear => [Noise::None, Noise::gaussian(0.01), Noise::gaussian(0.02)],
        Tone::Srgb => [Noise::None, Noise::sensor(1.0), Noise::sensor(8.0)],
    }
}

/// One method on one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Short name of the method, made from its identity.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Name of the camera.
    pub camera: String,
    /// Name of the photograph.
    pub image: String,
    /// Depth.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What the photograph's numbers were taken for.
    pub tone: Tone,
    /// Quality of the picture as it is looked at.
    #[serde(flatten)]
    pub picture: Quality,
    /// Quality of the light; the same where picture and light are the same numbers.
    pub light: Quality,
    /// Wall-clock seconds a megapixel.
    pub seconds_per_megapixel: f64,
    /// What it took.
    #[serde(flatten)]
    pub work: Work,
}

/// What a method counted; nothing where it does not count.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Work {
    /// Multiplications for each pixel if every weight is multiplied.
    pub dense_multiplications_a_pixel: Option<f64>,
    /// Multiplications for each pixel that were carried out.
    pub executed_multiplications_a_pixel: Option<f64>,
    /// Words that were not zero after each shrinkage, mean over patches.
    pub nonzeros_a_patch: Option<Vec<f64>>,
    /// Words of all stages and sums that did not fit.
    pub saturations: Option<u64>,
}

/// An experiment that cannot go on.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum KodakError {
    /// A method refused a frame.
    #[error("{image}: {source}")]
    Reconstruct { image: String, source: ReconstructError },
    /// The photograph cannot be exposed, or the noise is impossible.
    #[error("{image}: {source}")]
    Sensor { image: String, source: SensorError },
    /// A depth that a camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
    /// A photograph too small to measure.
    #[error("{image}: {source}")]
    Metric { image: String, source: MetricError },
}

/// How far an experiment is.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Photographs done, over all cameras and depths.
    pub done: usize,
    /// How many there are.
    pub of: usize,
    /// Camera at work.
    pub camera: &'a str,
    /// Depth at work.
    pub psi: f64,
    /// Photograph just done.
    pub image: &'a str,
}

/// Runs the experiment; rows come by setup, ψ, photograph, noise, method. `tell` hears of every photograph and may stop it.
///
/// # Errors
/// [`KodakError`] naming the first photograph that a method or metric cannot take, or `Stopped`.
pub fn run(
    setups: &[Setup],
    photos: &[Photo],
    conditions: &Conditions,
    mut tell: impl FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Vec<Row>, KodakError> {
    let of = setups.len() * conditions.psi.len() * photos.len();
    let (mut rows, mut done) = (vec![], 0);
    for setup in setups {
        for &psi in &conditions.psi {
            let psfs = channel_psfs(&setup.camera, psi, &conditions.optics)?;
            for photo in photos {
                rows.extend(Trial::new(setup, photo, psi, conditions).rows(&psfs)?);
                done += 1;
                let progress = Progress { done, of, camera: &setup.camera.name, psi, image: &photo.name };
                if tell(progress).is_break() {
                    return Err(KodakError::Stopped);
                }
            }
        }
    }
    Ok(rows)
}

/// One photograph at one depth behind one camera.
pub(crate) struct Trial<'a> {
    setup: &'a Setup,
    photo: &'a Photo,
    psi: f64,
    conditions: &'a Conditions,
    /// The photograph's light.
    light: ColourFrame,
}

impl<'a> Trial<'a> {
    pub(crate) fn new(setup: &'a Setup, photo: &'a Photo, psi: f64, conditions: &'a Conditions) -> Self {
        Self { setup, photo, psi, conditions, light: conditions.tone.decoded(&photo.frame) }
    }

    /// All methods on all noise levels: reconstructed in turn, compared side by side.
    fn rows(&self, psfs: &[Psf; 3]) -> Result<Vec<Row>, KodakError> {
        let mut done: Vec<(Noise, &Method, Reconstruction)> = vec![];
        for (noise, raw) in self.shots(psfs)? {
            for entry in &self.setup.entries {
                let result = entry
                    .reconstructor
                    .reconstruct(&raw)
                    .map_err(|source| KodakError::Reconstruct { image: self.image(), source })?;
                done.push((noise, &entry.method, result));
            }
        }
        done.into_par_iter().map(|(noise, method, result)| self.row(noise, method, &result)).collect()
    }

    /// What the sensor gives at each noise level.
    pub(crate) fn shots(&self, psfs: &[Psf; 3]) -> Result<Vec<(Noise, RawFrame)>, KodakError> {
        let blurred = blur_frame(&self.light, psfs);
        self.conditions
            .noise
            .par_iter()
            .map(|&noise| Ok((noise, expose(&blurred, &sensor(&self.photo.name, self.psi, noise))?)))
            .collect::<Result<_, _>>()
            .map_err(|source| KodakError::Sensor { image: self.image(), source })
    }

    /// What a reconstruction is worth.
    pub(crate) fn row(
        &self,
        noise: Noise,
        method: &Method,
        result: &Reconstruction,
    ) -> Result<Row, KodakError> {
        let tone = self.conditions.tone;
        let compared = |truth: &ColourFrame, estimate: &ColourFrame| {
            Quality::of(truth, estimate, BORDER)
                .map_err(|source| KodakError::Metric { image: self.image(), source })
        };
        let light = compared(&self.light, &result.frame)?;
        let picture = match tone {
            Tone::Linear => light,
            Tone::Srgb => compared(&self.photo.frame, &shown(&result.frame, tone))?,
        };
        let (height, width) = self.light.size();
        let pixels = (height * width) as f64;
        Ok(Row {
            method: method.to_string(),
            identity: method.clone(),
            camera: self.setup.camera.name.clone(),
            image: self.image(),
            psi: self.psi,
            noise,
            tone,
            picture,
            light,
            seconds_per_megapixel: result.seconds / (pixels * 1e-6),
            work: Work::of(result, pixels),
        })
    }

    fn image(&self) -> String {
        self.photo.name.clone()
    }
}

impl Work {
    fn of(result: &Reconstruction, pixels: f64) -> Self {
        let multiplications = |count: fn(&Multiplications) -> u64| {
            result.multiplications.as_ref().map(|m| count(m) as f64 / pixels)
        };
        let counters = result.counters.as_ref();
        Self {
            dense_multiplications_a_pixel: multiplications(|m| m.dense),
            executed_multiplications_a_pixel: multiplications(|m| m.executed),
            nonzeros_a_patch: counters
                .map(|c| c.nonzeros.iter().map(|&n| n as f64 / c.patches as f64).collect()),
            saturations: counters.map(|c| c.saturations),
        }
    }
}

/// The sensor for one photograph, ψ and noise: its seed depends on these three and nothing else.
#[must_use]
pub fn sensor(image: &str, psi: f64, noise: Noise) -> Sensor {
    let level = match noise {
        Noise::None => vec![0.0],
        Noise::Gaussian { sigma } => vec![sigma],
        Noise::Sensor(s) => vec![s.full_well_e, s.read_noise_e, s.gain],
    };
    let words = image.bytes().map(u64::from).chain([psi.to_bits()]).chain(level.iter().map(|v| v.to_bits()));
    // FNV-1a over whole words.
    let seed = words
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3));
    Sensor { depth: DEPTH, noise, seed, ..Sensor::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_deblur::Malvar;

    fn setup(camera: &str) -> Setup {
        let entry = Entry { method: Method::demosaic(), reconstructor: Box::new(Malvar::default()) };
        Setup { camera: Camera::resolve(camera).unwrap(), entries: vec![entry] }
    }

    fn photo(name: &str) -> Photo {
        let mut frame = ColourFrame::zeros(64, 80);
        frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
            *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos()
        });
        Photo { name: name.into(), frame }
    }

    fn conditions(psi: &[f64], noise: &[f64]) -> Conditions {
        let noise = noise.iter().map(|&sigma| Noise::gaussian(sigma)).collect();
        Conditions { tone: Tone::Linear, psi: psi.to_vec(), noise, optics: Settings::default() }
    }

    fn go(setups: &[Setup], photos: &[Photo], conditions: &Conditions) -> Result<Vec<Row>, KodakError> {
        run(setups, photos, conditions, |_| ControlFlow::Continue(()))
    }

    #[test]
    fn every_photo_depth_noise_and_method_has_one_row_in_order() {
        let setups = [setup("clear"), setup("ring-outer")];
        let photos = [photo("p1"), photo("p2")];
        let mut told = vec![];
        let rows = run(&setups, &photos, &conditions(&[0.0, 8.0], &[0.0, 0.01]), |p| {
            told.push((p.done, p.of));
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(rows.len(), 2 * 2 * 2 * 2);
        assert_eq!(told.last(), Some(&(8, 8)));
        let key = |r: &Row| (r.camera.clone(), r.psi as u32, r.image.clone(), r.noise != Noise::None);
        assert!(rows.iter().map(key).collect::<Vec<_>>().is_sorted());
    }

    #[test]
    fn the_same_experiment_gives_the_same_numbers() {
        let once = || {
            let rows = go(&[setup("ring-2018")], &[photo("p")], &conditions(&[3.0], &[0.02])).unwrap();
            (rows[0].picture, rows[0].light)
        };
        assert_eq!(once(), once());
    }

    #[test]
    fn noise_and_defocus_cost_quality() {
        let rows = go(&[setup("clear")], &[photo("p")], &conditions(&[0.0, 8.0], &[0.0, 0.05])).unwrap();
        let db: Vec<f64> = rows.iter().map(|r| r.picture.psnr_db).collect();
        assert!(db[0] > db[1] + 1.0 && db[0] > db[2] + 1.0, "{db:?}");
    }

    #[test]
    fn the_papers_convention_measures_one_picture_and_srgb_two() {
        let mut grey = photo("grey");
        grey.frame.planes.fill(0.2);
        let measured = |tone| {
            let conditions = Conditions { tone, ..conditions(&[0.0], &[0.001]) };
            let row = go(&[setup("clear")], std::slice::from_ref(&grey), &conditions).unwrap().remove(0);
            assert_eq!(row.tone, tone);
            (row.picture, row.light)
        };
        let (picture, light) = measured(Tone::Linear);
        assert_eq!(picture, light);
        let (picture, light) = measured(Tone::Srgb);
        // Small noise on light is as many times larger on the picture as the curve is steep there.
        let steep = f64::from(Tone::Srgb.slope(Tone::Srgb.decode(0.2)));
        let lost = light.psnr_db - picture.psnr_db;
        assert!((lost - 20.0 * steep.log10()).abs() < 0.1 && lost > 9.0, "{lost} dB");
        assert_eq!(picture.psnr_db, picture.psnr_clipped_db, "sRGB codes end at black and white");
    }

    #[test]
    fn what_is_encoded_as_it_was_decoded_is_the_photograph_itself() {
        let photo = photo("p");
        let light = Tone::Srgb.decoded(&photo.frame);
        let back = shown(&light, Tone::Srgb);
        assert!(crate::metrics::psnr(&photo.frame, &back, BORDER) > 130.0);
    }

    #[test]
    fn other_photos_depths_and_noises_have_other_noise() {
        let (low, high) = (Noise::gaussian(0.01), Noise::gaussian(0.02));
        let (base, fast) = (Noise::sensor(1.0), Noise::sensor(8.0));
        let seeds = [
            ("a", 0.0, low),
            ("b", 0.0, low),
            ("a", 2.0, low),
            ("a", 0.0, high),
            ("a", 0.0, base),
            ("a", 0.0, fast),
        ]
        .map(|(image, psi, noise)| sensor(image, psi, noise).seed);
        for (i, seed) in seeds.iter().enumerate() {
            assert!(!seeds[..i].contains(seed));
        }
    }

    #[test]
    fn an_experiment_stops_when_asked() {
        let photos = [photo("p1"), photo("p2")];
        let stopped =
            run(&[setup("clear")], &photos, &conditions(&[0.0], &[0.0]), |_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(KodakError::Stopped)));
    }

    #[test]
    fn depths_and_noises_that_cannot_be_are_refused() {
        let refused = |psi, noise| {
            go(&[setup("clear")], &[photo("p")], &conditions(&[psi], &[noise])).unwrap_err().to_string()
        };
        assert_eq!(refused(f64::NAN, 0.0), "psi NaN: must lie within 200 of the focus of camera clear, at 0");
        assert_eq!(
            refused(0.0, -1.0),
            "p: noise: the standard deviation is -1, expected 0 to 1, where full scale is 1"
        );
    }

    #[test]
    fn a_photo_too_small_to_measure_is_named() {
        let small = Photo { name: "tiny".into(), frame: ColourFrame::zeros(20, 20) };
        let error = go(&[setup("clear")], &[small], &conditions(&[0.0], &[0.0])).unwrap_err();
        assert!(
            error.to_string().starts_with("tiny: frame of 20x20 pixels: must be at least 27x27"),
            "{error}"
        );
    }
}
