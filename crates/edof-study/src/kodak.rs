//! The main experiment: every method behind its camera, on every photograph, depth and noise level.
//!
//! A photograph is light under the tone asked for: its numbers as they are (the paper's convention), or decoded from sRGB. It
//! is blurred by the camera's kernels at each ψ, exposed with 16 bits and noise, and reconstructed; the result is compared
//! with the photograph as a picture and as light. The noise depends on photograph, ψ and noise level alone, so that all
//! cameras and methods meet the same. Methods run one after the other, each on all threads, so that their times can be
//! compared; all else runs side by side.

use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Proof, Shard, settings};
use crate::setup::Setup;
use edof_camera::Camera;
use edof_image::reconstructor::Multiplications;
use edof_image::{ColourFrame, Noise, RawFrame, ReconstructError, Reconstruction, Tone};
use edof_io::photos::Photo;
use edof_methods::method::Method;
use edof_methods::spec::{PrepareError, Ready};
use edof_metrics::{BORDER, MetricError, Quality, shown};
use edof_optics::blur::blur_frame;
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_optics::sensor::{Sensor, SensorError, expose};
use edof_storage::digest::sha256;
use edof_storage::provenance::Input;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Bits of the simulated sensor.
const DEPTH: u32 = 16;

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

/// What one method made of one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
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

/// The same with what it was measured from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Quality, time and work.
    #[serde(flatten)]
    pub measured: Measured,
    /// Place of camera and method among those of the command that measured it: tables keep it.
    pub place: usize,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    camera: String,
    method: Method,
    tone: Tone,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
    proof: Proof,
}

impl Line for Row {
    const STUDY: &'static str = "kodak";
    const LAYOUT: u32 = 2;
    type Key = Key;

    fn key(&self) -> Key {
        let Measured { identity, camera, tone, psi, noise, image, .. } = &self.measured;
        Key {
            camera: camera.clone(),
            method: identity.clone(),
            tone: *tone,
            psi: Ordered(*psi),
            noise: Ordered::of_noise(*noise),
            image: image.clone(),
            proof: self.proof.clone(),
        }
    }

    fn subject(key: &Key) -> Key {
        Key { proof: Proof::default(), ..key.clone() }
    }

    fn timeless(&self) -> Self {
        let mut row = self.clone();
        (row.measured.seconds_per_megapixel, row.place) = (0.0, 0);
        row
    }
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
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
    /// A photograph too small to measure.
    #[error("{image}: {source}")]
    Metric { image: String, source: MetricError },
}

/// What is measured.
pub struct Plan {
    /// Cameras and their methods, in the order of tables.
    pub setups: Vec<Setup>,
    /// Depths, noise levels, tone, kernels.
    pub conditions: Conditions,
    /// Which of its rows.
    pub shard: Shard,
}

/// A row to be measured, by places in the plan and the list of photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    setup: usize,
    psi: usize,
    photo: usize,
    noise: usize,
    method: usize,
    place: usize,
}

/// Measures what the journal does not hold yet, and puts its rows into their order. `tell` hears of every photograph and may stop the
/// study; what was measured stays.
///
/// # Errors
/// [`KodakError`] naming the first photograph that a method or metric cannot take, or `Stopped`.
pub fn run(
    plan: &Plan,
    photos: &[Photo],
    journal: &mut Journal<Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), KodakError> {
    let own = plan.shard.own(plan.cells(photos));
    let of = own.len();
    let mut missing: Vec<(Cell, Proof)> =
        own.into_iter().filter(|(key, _)| !journal.holds(key)).map(|(key, cell)| (cell, key.proof)).collect();
    missing.sort();
    let mut done = of - missing.len();
    for at_depth in missing.chunk_by(|(a, _), (b, _)| (a.setup, a.psi) == (b.setup, b.psi)) {
        let (setup, psi) = (&plan.setups[at_depth[0].0.setup], plan.conditions.psi[at_depth[0].0.psi]);
        let psfs = channel_psfs(&setup.camera, psi, &plan.conditions.optics)?;
        let mut ready = Ready::new(&setup.camera, &setup.methods, psi, plan.conditions.optics);
        for of_photo in at_depth.chunk_by(|(a, _), (b, _)| a.photo == b.photo) {
            let photo = &photos[of_photo[0].0.photo];
            for row in
                Trial::new(&setup.camera, photo, psi, &plan.conditions).rows(&psfs, of_photo, &mut ready)?
            {
                journal.push(row)?;
                done += 1;
            }
            let last = format!("{} at psi {psi}: {}", setup.camera.name, photo.name);
            if tell(Progress { done, of, last }).is_break() {
                return Err(KodakError::Stopped);
            }
        }
    }
    Ok(journal.finish()?)
}

impl Plan {
    fn cells(&self, photos: &[Photo]) -> Vec<(Key, Cell)> {
        let Conditions { tone, psi: depths, noise: levels, optics } = &self.conditions;
        let hashes: Vec<String> =
            photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
        let (mut cells, mut first) = (vec![], 0);
        for (setup, Setup { camera, methods }) in self.setups.iter().enumerate() {
            let camera_sha256 = sha256(camera.to_json().as_bytes());
            for (psi, &depth) in depths.iter().enumerate() {
                for (photo, of) in photos.iter().enumerate() {
                    for (noise, &level) in levels.iter().enumerate() {
                        let sensor = sensor(&of.name, depth, level);
                        for (method, spec) in methods.iter().enumerate() {
                            let key = Key {
                                camera: camera.name.clone(),
                                method: spec.method(),
                                tone: *tone,
                                psi: Ordered(depth),
                                noise: Ordered::of_noise(level),
                                image: of.name.clone(),
                                proof: Proof {
                                    settings: Some(settings(&[&spec.settings(), optics, &sensor, &BORDER])),
                                    weights: spec.weights().map(str::to_owned),
                                    photo: hashes[photo].clone(),
                                    camera: Some(camera_sha256.clone()),
                                },
                            };
                            cells.push((
                                key,
                                Cell { setup, psi, photo, noise, method, place: first + method },
                            ));
                        }
                    }
                }
            }
            first += methods.len();
        }
        cells
    }
}

/// One photograph at one depth behind one camera.
pub(crate) struct Trial<'a> {
    camera: &'a Camera,
    photo: &'a Photo,
    psi: f64,
    conditions: &'a Conditions,
    /// The photograph's light.
    light: ColourFrame,
}

impl<'a> Trial<'a> {
    pub(crate) fn new(camera: &'a Camera, photo: &'a Photo, psi: f64, conditions: &'a Conditions) -> Self {
        Self { camera, photo, psi, conditions, light: conditions.tone.decoded(&photo.frame) }
    }

    /// Rows of one photograph: reconstructed in turn, compared side by side.
    fn rows(
        &self,
        psfs: &[Psf; 3],
        cells: &[(Cell, Proof)],
        ready: &mut Ready<'_>,
    ) -> Result<Vec<Row>, KodakError> {
        let shots = self.shots(psfs)?;
        let mut done = vec![];
        for (cell, proof) in cells {
            let (noise, raw) = &shots[cell.noise];
            let method = ready.method(*noise, cell.method)?.reconstructor;
            let result = method
                .reconstruct(raw)
                .map_err(|source| KodakError::Reconstruct { image: self.image(), source })?;
            done.push((*noise, ready.identity(cell.method), result, cell.place, proof.clone()));
        }
        done.into_par_iter()
            .map(|(noise, method, result, place, proof)| {
                Ok(Row { measured: self.row(noise, &method, &result)?, place, proof })
            })
            .collect()
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
    ) -> Result<Measured, KodakError> {
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
        Ok(Measured {
            method: method.to_string(),
            identity: method.clone(),
            camera: self.camera.name.clone(),
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

    pub(crate) fn image(&self) -> String {
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
    use crate::journal::{Header, Program};
    use edof_methods::spec::MethodSpec;

    fn setup(camera: &str) -> Setup {
        Setup { camera: Camera::resolve(camera).unwrap(), methods: vec![MethodSpec::Malvar] }
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

    fn journal() -> Journal<Row> {
        Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")))
    }

    fn plan(cameras: &[&str], conditions: Conditions) -> Plan {
        Plan { setups: cameras.iter().map(|camera| setup(camera)).collect(), conditions, shard: Shard::WHOLE }
    }

    fn go(camera: &str, photos: &[Photo], conditions: Conditions) -> Result<Vec<Measured>, KodakError> {
        let mut journal = journal();
        run(&plan(&[camera], conditions), photos, &mut journal, |_| ControlFlow::Continue(()))?;
        Ok(journal.rows().into_iter().map(|row| row.measured).collect())
    }

    #[test]
    fn every_photo_depth_noise_and_method_has_one_row_and_a_place() {
        let plan = plan(&["clear", "ring-outer"], conditions(&[0.0, 8.0], &[0.0, 0.01]));
        let photos = [photo("p1"), photo("p2")];
        let (mut told, mut journal) = (vec![], journal());
        run(&plan, &photos, &mut journal, |p| {
            told.push((p.done, p.of));
            ControlFlow::Continue(())
        })
        .unwrap();
        let rows = journal.rows();
        assert_eq!(rows.len(), 2 * 2 * 2 * 2);
        assert_eq!(told.last(), Some(&(16, 16)));
        let settings: std::collections::BTreeSet<_> = rows.iter().map(|r| r.proof.settings.clone()).collect();
        assert_eq!(settings.len(), 8, "noise and its seed are settings of photograph, depth and level");
        assert!(rows.iter().all(|r| r.place == usize::from(r.measured.camera == "ring-outer")));
        // Nothing is measured twice.
        run(&plan, &photos, &mut journal, |_| panic!("there is nothing to measure")).unwrap();
    }

    #[test]
    fn the_same_experiment_gives_the_same_numbers() {
        let once = || {
            let rows = go("ring-2018", &[photo("p")], conditions(&[3.0], &[0.02])).unwrap();
            (rows[0].picture, rows[0].light)
        };
        assert_eq!(once(), once());
    }

    #[test]
    fn noise_and_defocus_cost_quality() {
        let rows = go("clear", &[photo("p")], conditions(&[0.0, 8.0], &[0.0, 0.05])).unwrap();
        let db = |psi: f64, noise: f64| {
            let row = rows.iter().find(|r| r.psi == psi && r.noise == Noise::gaussian(noise)).unwrap();
            row.picture.psnr_db
        };
        let sharp = db(0.0, 0.0);
        assert!(sharp > db(0.0, 0.05) + 1.0 && sharp > db(8.0, 0.0) + 1.0, "{rows:?}");
    }

    #[test]
    fn the_papers_convention_measures_one_picture_and_srgb_two() {
        let mut grey = photo("grey");
        grey.frame.planes.fill(0.2);
        let measured = |tone| {
            let conditions = Conditions { tone, ..conditions(&[0.0], &[0.001]) };
            let row = go("clear", std::slice::from_ref(&grey), conditions).unwrap().remove(0);
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
        assert!(edof_metrics::psnr(&photo.frame, &back, BORDER) > 130.0);
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
        let (photos, mut journal) = ([photo("p1"), photo("p2")], journal());
        let plan = plan(&["clear"], conditions(&[0.0], &[0.0]));
        let stopped = run(&plan, &photos, &mut journal, |_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(KodakError::Stopped)));
        assert_eq!(journal.rows().len(), 1, "what was measured stays");
    }

    #[test]
    fn a_black_photograph_has_a_row_that_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows");
        let header = || Header::of::<Row>(Program::stub("r", "m"));
        let mut black = photo("black");
        black.frame.planes.fill(0.0);
        let plan = plan(&["clear"], conditions(&[0.0], &[0.0]));
        let mut rows = Journal::open(&path, header(), Default::default()).unwrap();
        run(&plan, &[black], &mut rows, |_| ControlFlow::Continue(())).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().contains("\"psnr_db\":\"inf\""));
        let again = Journal::<Row>::open(&path, header(), Default::default()).unwrap();
        assert_eq!(again.rows(), rows.rows());
        assert_eq!(again.rows()[0].measured.picture.psnr_db, f64::INFINITY);
    }

    #[test]
    fn depths_and_noises_that_cannot_be_are_refused() {
        let refused =
            |psi, noise| go("clear", &[photo("p")], conditions(&[psi], &[noise])).unwrap_err().to_string();
        assert_eq!(refused(f64::NAN, 0.0), "psi NaN: must lie within 200 of the focus of camera clear, at 0");
        assert_eq!(
            refused(0.0, -1.0),
            "p: noise: the standard deviation is -1, expected 0 to 1, where full scale is 1"
        );
    }

    #[test]
    fn a_photo_too_small_to_measure_is_named() {
        let small = Photo { name: "tiny".into(), frame: ColourFrame::zeros(20, 20) };
        let error = go("clear", &[small], conditions(&[0.0], &[0.0])).unwrap_err();
        assert!(
            error.to_string().starts_with("tiny: frame of 20x20 pixels: must be at least 27x27"),
            "{error}"
        );
    }
}
