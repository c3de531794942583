//! Speed against error on scenes of one depth, the paper's figure 5: every method on every photograph, prepared for its case first.
//!
//! Rows go to a file of JSON lines as they come ([`Journal`]), so an interrupted study goes on where it was; what is there already is not
//! measured again, and several machines may share a study ([`Shard`]). Noise depends on photograph, ψ and noise level alone, as in
//! [`kodak`](crate::kodak), and all methods see the same captures.

use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Proof, Shard, settings};
use crate::kodak::{Conditions, KodakError, Measured, Trial, sensor};
use edof_camera::Camera;
use edof_image::{Noise, RawFrame, Tone};
use edof_io::photos::Photo;
use edof_methods::method::{Format, Method};
use edof_methods::spec::{MethodSpec, PrepareError, Ready};
use edof_metrics::BORDER;
use edof_metrics::timing::{Range, Timed, timed};
use edof_optics::psf::{Settings, channel_psfs};
use edof_storage::digest::sha256;
use edof_storage::provenance::Input;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// What is measured.
pub struct Plan {
    /// The camera that all methods stand behind.
    pub camera: Camera,
    /// What photographs' numbers are taken for.
    pub tone: Tone,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// Methods.
    pub methods: Vec<MethodSpec>,
    /// How exactly kernels are computed.
    pub optics: Settings,
    /// Which of its rows.
    pub shard: Shard,
}

/// One method on one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Quality, time and work.
    #[serde(flatten)]
    pub measured: Measured,
    /// Least and most of the runs' wall-clock seconds a megapixel; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Wall-clock seconds of preparing for the case, once for all photographs.
    pub prepare_seconds: f64,
    /// Runs whose median the time is.
    pub repetitions: usize,
    /// Seconds that all threads together were on a processor, a megapixel, median of the same runs; none where nothing was measured, and
    /// in rows from before it was.
    #[serde(default)]
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Least and most of those.
    #[serde(default)]
    pub cpu_seconds_range: Option<Range>,
    /// Steps of an iterative method, mean over patches or colours; none for methods without, and in rows from before they were counted.
    #[serde(default)]
    pub iterations: Option<f64>,
    /// Most bytes of memory that the process held while the method ran, photographs and other methods included; none where the system
    /// does not tell, and in rows from before it was asked.
    #[serde(default)]
    pub peak_memory_bytes: Option<u64>,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a row is of. Rows of one method follow each other, so that shards of a study get equal shares of slow and of fast ones.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    method: Method,
    camera: String,
    tone: Tone,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
    proof: Proof,
}

impl Line for Row {
    const STUDY: &'static str = "single-depth";
    const LAYOUT: u32 = 2;
    type Key = Key;

    fn key(&self) -> Key {
        let Measured { identity, camera, tone, psi, noise, image, .. } = &self.measured;
        Key {
            method: identity.clone(),
            camera: camera.clone(),
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
        (row.measured.seconds_per_megapixel, row.prepare_seconds, row.repetitions) = (0.0, 0.0, 0);
        (row.cpu_seconds_per_megapixel, row.peak_memory_bytes) = (None, None);
        (row.seconds_range, row.cpu_seconds_range) = (None, None);
        row
    }
}

/// A study that cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// As in the main experiment.
    #[error(transparent)]
    Trial(#[from] KodakError),
    /// A method.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// A row to be measured, by places in the plan and the list of photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    psi: usize,
    photo: usize,
    noise: usize,
    method: usize,
}

impl Plan {
    /// Its shard's rows.
    fn cells(&self, photos: &[Photo]) -> Vec<(Key, Cell)> {
        let mut cells = vec![];
        let camera_sha256 = sha256(self.camera.to_json().as_bytes());
        for (photo, of) in photos.iter().enumerate() {
            let photo_sha256 = Input::photograph(&of.name, &of.frame).sha256;
            for (psi, &depth) in self.psi.iter().enumerate() {
                for (noise, &level) in self.noise.iter().enumerate() {
                    let sensor = sensor(&of.name, depth, level);
                    for (method, spec) in self.methods.iter().enumerate() {
                        let key = Key {
                            method: spec.method(),
                            camera: self.camera.name.clone(),
                            tone: self.tone,
                            psi: Ordered(depth),
                            noise: Ordered::of_noise(level),
                            image: of.name.clone(),
                            proof: Proof {
                                settings: Some(settings(&[&spec.settings(), &self.optics, &sensor, &BORDER])),
                                weights: spec.weights().map(str::to_owned),
                                photo: photo_sha256.clone(),
                                camera: Some(camera_sha256.clone()),
                            },
                        };
                        cells.push((key, Cell { psi, photo, noise, method }));
                    }
                }
            }
        }
        self.shard.own(cells)
    }
}

/// Measures what the journal does not hold yet, and puts its rows into their order. `tell` hears of every row and may stop the study;
/// what was measured stays.
///
/// # Errors
/// [`StudyError`].
pub fn run(
    plan: &Plan,
    photos: &[Photo],
    journal: &mut Journal<Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), StudyError> {
    let own = plan.cells(photos);
    let of = own.len();
    let mut missing: Vec<(Cell, Proof)> =
        own.into_iter().filter(|(key, _)| !journal.holds(key)).map(|(key, cell)| (cell, key.proof)).collect();
    missing.sort();
    let mut done = of - missing.len();
    for at_depth in missing.chunk_by(|(a, _), (b, _)| a.psi == b.psi) {
        let psi = plan.psi[at_depth[0].0.psi];
        let psfs = channel_psfs(&plan.camera, psi, &plan.optics).map_err(KodakError::from)?;
        let conditions =
            Conditions { tone: plan.tone, psi: vec![psi], noise: plan.noise.clone(), optics: plan.optics };
        let mut ready = Ready::new(&plan.camera, &plan.methods, psi, plan.optics);
        for of_photo in at_depth.chunk_by(|(a, _), (b, _)| a.photo == b.photo) {
            let photo = &photos[of_photo[0].0.photo];
            let trial = Trial::new(&plan.camera, photo, psi, &conditions);
            let shots = trial.shots(&psfs)?;
            for (cell, proof) in of_photo {
                let row = trial.timed_row(&shots[cell.noise], cell.method, proof, &mut ready)?;
                let last = format!("{} on {} at psi {psi}", row.measured.method, photo.name);
                journal.push(row)?;
                done += 1;
                if tell(Progress { done, of, last }).is_break() {
                    return Err(KodakError::Stopped.into());
                }
            }
        }
    }
    Ok(journal.finish()?)
}

impl Trial<'_> {
    /// What a method makes of a shot, and its times.
    fn timed_row(
        &self,
        (noise, raw): &(Noise, RawFrame),
        method: usize,
        proof: &Proof,
        ready: &mut Ready<'_>,
    ) -> Result<Row, StudyError> {
        let identity = ready.identity(method);
        let prepared = ready.method(*noise, method)?;
        // A computed time does not vary.
        let is_measured = identity.format != Some(Format::Board);
        let run = prepared.reconstructor;
        let Timed { result, range, cpu_seconds, cpu_range, peak_memory_bytes, repetitions } =
            if is_measured { timed(run, raw) } else { run.reconstruct(raw).map(Timed::not) }
                .map_err(|source| KodakError::Reconstruct { image: self.image(), source })?;
        let (height, width) = raw.size();
        let megapixels = (height * width) as f64 * 1e-6;
        Ok(Row {
            measured: self.row(*noise, &identity, &result)?,
            seconds_range: Some(range.over(megapixels)),
            prepare_seconds: prepared.seconds,
            repetitions,
            iterations: result.iterations,
            peak_memory_bytes,
            cpu_seconds_per_megapixel: cpu_seconds.map(|seconds| seconds / megapixels),
            cpu_seconds_range: cpu_range.map(|range| range.over(megapixels)),
            proof: proof.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{Header, Program};
    use edof_image::{ColourFrame, Stride};
    use edof_methods::dictionary::Dictionary;
    use edof_methods::method::Family;
    use edof_methods::settings::Pursuit;
    use std::path::{Path, PathBuf};
    use std::sync::Arc;

    fn photos() -> Vec<Photo> {
        let photo = |name: &str, step: usize| {
            let mut frame = ColourFrame::zeros(40, 48);
            frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
                *v = 0.5 + 0.3 * ((r / (step + p)) as f32).sin() * ((c / 4) as f32).cos();
            });
            Photo { name: name.into(), frame }
        };
        vec![photo("p1", 3), photo("p2", 5)]
    }

    fn plan(names: &[&str]) -> Plan {
        let dictionary = Arc::new(Dictionary::load(None).unwrap());
        let methods =
            names.iter().flat_map(|name| MethodSpec::named(name, &[Stride::PATCH], &dictionary).unwrap());
        Plan {
            camera: Camera::resolve("ring-2018").unwrap(),
            psi: vec![8.0],
            noise: vec![Noise::None, Noise::gaussian(0.01)],
            methods: methods.collect(),
            optics: Settings { energy: 0.95, ..Settings::default() },
            tone: Tone::Linear,
            shard: Shard::WHOLE,
        }
    }

    fn header() -> Header {
        Header::of::<Row>(Program::stub("r", "a machine"))
    }

    fn go(plan: &Plan, path: &Path, rows: usize) -> Result<Journal<Row>, StudyError> {
        let mut journal = Journal::open(path, header(), Default::default())?;
        let mut left = rows;
        let result = run(plan, &photos(), &mut journal, |_| {
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        match result {
            Err(StudyError::Trial(KodakError::Stopped)) | Ok(()) => Ok(journal),
            Err(error) => Err(error),
        }
    }

    /// The file without its times.
    fn timeless(path: &Path) -> Vec<Row> {
        Journal::<Row>::open(path, header(), Default::default())
            .unwrap()
            .rows()
            .iter()
            .map(Line::timeless)
            .collect()
    }

    #[test]
    fn an_interrupted_study_goes_on_where_it_was_and_gives_the_same_rows() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(&["malvar", "wiener", "omp"]);
        let all = folder.path().join("whole.jsonl");
        assert_eq!(go(&plan, &all, usize::MAX).unwrap().rows().len(), 2 * 2 * 3);
        let parts = folder.path().join("parts.jsonl");
        assert_eq!(go(&plan, &parts, 5).unwrap().rows().len(), 5);
        let first = std::fs::read_to_string(&parts).unwrap();
        go(&plan, &parts, usize::MAX).unwrap();
        let last = std::fs::read_to_string(&parts).unwrap();
        assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
        assert_eq!(timeless(&parts), timeless(&all));
    }

    #[test]
    fn shards_of_a_study_have_equal_shares_of_every_method_and_make_it_whole() {
        let folder = tempfile::tempdir().unwrap();
        let whole = folder.path().join("whole.jsonl");
        go(&plan(&["malvar", "wiener"]), &whole, usize::MAX).unwrap();
        let files: Vec<PathBuf> = ["1/2", "2/2"]
            .map(|shard| {
                let path = folder.path().join(shard.replace('/', "-"));
                let plan = Plan { shard: shard.parse().unwrap(), ..plan(&["wiener", "malvar"]) };
                let rows = go(&plan, &path, usize::MAX).unwrap();
                let wiener = rows.rows().iter().filter(|r| r.measured.method == "wiener").count();
                assert_eq!((wiener, rows.rows().len()), (2, 4));
                path
            })
            .to_vec();
        let merged = folder.path().join("merged.jsonl");
        Journal::<Row>::merged(&merged, &files, Default::default()).unwrap().finish().unwrap();
        assert_eq!(timeless(&merged), timeless(&whole));
    }

    #[test]
    fn another_method_or_depth_adds_rows_and_measures_no_other_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        go(&plan(&["malvar"]), &path, usize::MAX).unwrap();
        let first = std::fs::read_to_string(&path).unwrap();
        let more = go(&plan(&["malvar", "directional"]), &path, usize::MAX).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
        assert_eq!(more.rows().len(), 8);
    }

    #[test]
    fn a_changed_constant_of_omp_makes_its_rows_be_measured_anew_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        let mut plan = Plan { noise: vec![Noise::None], ..plan(&["malvar", "omp-known"]) };
        let before = go(&plan, &path, usize::MAX).unwrap().rows();
        let MethodSpec::Pursuit { settings, .. } = &mut plan.methods[1] else { panic!("a pursuit") };
        assert_eq!(settings.pursuit, Pursuit::OMP);
        settings.pursuit = Pursuit::Omp { atoms: 15 };
        let mut measured = 0;
        let mut journal = Journal::open(&path, header(), Default::default()).unwrap();
        run(&plan, &photos(), &mut journal, |_| {
            measured += 1;
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(measured, 2, "one for each photograph");
        let after = Journal::<Row>::open(&path, header(), Default::default()).unwrap().rows();
        // Pages call both alike, so the old ones are gone.
        assert_eq!(after.len(), before.len());
        for (old, new) in before.iter().zip(&after) {
            let is_omp = old.measured.identity.family == Family::OmpKnownDepth;
            assert_eq!(old == new, !is_omp, "{}", old.measured.method);
            assert_eq!(old.proof.settings == new.proof.settings, !is_omp);
        }
    }

    #[test]
    fn every_method_reconstructs_a_frame_of_its_size() {
        let mut plan = Plan { noise: vec![Noise::gaussian(0.01)], ..plan(&MethodSpec::names()) };
        plan.methods.retain(|m| m.method().layers.is_none_or(|t| t == 10));
        let folder = tempfile::tempdir().unwrap();
        let journal = go(&plan, &folder.path().join("rows.jsonl"), usize::MAX).unwrap();
        assert_eq!(journal.rows().len(), 2 * MethodSpec::names().len());
        for row in journal.rows() {
            let range = row.seconds_range.unwrap();
            let median = row.measured.seconds_per_megapixel;
            assert!(range.least <= median && median <= range.most && range.least > 0.0, "{range:?} {median}");
            let Measured { method, identity, picture, .. } = &row.measured;
            // Nine steps do not reach the mean where it is one atom among all.
            let least = if identity.family == Family::Untrained { 5.0 } else { 10.0 };
            assert!(picture.psnr_db > least, "{method}: {}", picture.psnr_db);
        }
    }

    #[test]
    fn a_method_that_nobody_knows_is_named() {
        let dictionary = Arc::new(Dictionary::load(None).unwrap());
        let error = MethodSpec::named("magic", &[], &dictionary).unwrap_err().to_string();
        assert!(error.starts_with("method 'magic': must be one of malvar, directional, "), "{error}");
    }
}
