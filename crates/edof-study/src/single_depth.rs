//! Speed against error on scenes of one depth, the paper's figure 5: every method on every photograph, prepared for its case first.
//!
//! Rows go to a file of JSON lines as they come ([`Journal`]), so an interrupted study goes on where it was; what is there already is not
//! measured again, and several machines may share a study ([`Shard`]). Noise depends on photograph, ψ and noise level alone, as in
//! [`kodak`](crate::kodak), and all methods see the same captures.

use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Shard};
use crate::kodak::{Conditions, KodakError, Row as Measured, Setup, Trial};
use crate::method::{Format, Method};
use crate::photos::Photo;
use crate::spec::{Case, MethodSpec, PrepareError};
use crate::timing::{Timed, timed};
use edof_optics::psf::{Settings, channel_psfs};
use edof_spec::digest::sha256;
use edof_spec::provenance::Input;
use edof_spec::{Camera, Noise, Reconstructor, Tone};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::time::Instant;

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
    /// Wall-clock seconds of preparing for the case, once for all photographs.
    pub prepare_seconds: f64,
    /// Runs whose median the time is.
    pub repetitions: usize,
    /// Seconds that all threads together were on a processor, a megapixel, median of the same runs; none where nothing was measured, and
    /// in rows from before it was.
    #[serde(default)]
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Steps of an iterative method, mean over patches or colours; none for methods without, and in rows from before they were counted.
    #[serde(default)]
    pub iterations: Option<f64>,
    /// Most bytes of memory that the process held while the method ran, photographs and other methods included; none where the system
    /// does not tell, and in rows from before it was asked.
    #[serde(default)]
    pub peak_memory_bytes: Option<u64>,
    /// SHA-256 of the weights or dictionary, the photograph's values and the camera: what tells this row from another of the same names.
    pub weights_sha256: Option<String>,
    /// See `weights_sha256`.
    pub photo_sha256: String,
    /// See `weights_sha256`.
    pub camera_sha256: String,
}

/// What a row is of. Rows of one method follow each other, so that shards of a study get equal shares of slow and of fast ones.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    method: Method,
    weights: Option<String>,
    camera: String,
    tone: String,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
    photo: String,
}

impl Line for Row {
    const STUDY: &'static str = "single-depth";
    const LAYOUT: u32 = 1;
    type Key = Key;

    fn key(&self) -> Key {
        Key {
            method: self.measured.identity.clone(),
            weights: self.weights_sha256.clone(),
            camera: self.camera_sha256.clone(),
            tone: self.measured.tone.to_string(),
            psi: Ordered(self.measured.psi),
            noise: Ordered::of_noise(self.measured.noise),
            image: self.measured.image.clone(),
            photo: self.photo_sha256.clone(),
        }
    }

    fn timeless(&self) -> Self {
        let mut row = self.clone();
        (row.measured.seconds_per_megapixel, row.prepare_seconds, row.repetitions) = (0.0, 0.0, 0);
        (row.cpu_seconds_per_megapixel, row.peak_memory_bytes) = (None, None);
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
    fn cells(&self, photos: &[Photo], hashes: &[String], camera_sha256: &str) -> Vec<(Key, Cell)> {
        let mut cells = vec![];
        for (psi, &depth) in self.psi.iter().enumerate() {
            for (photo, of) in photos.iter().enumerate() {
                for (noise, &level) in self.noise.iter().enumerate() {
                    for (method, spec) in self.methods.iter().enumerate() {
                        let key = Key {
                            method: spec.method(),
                            weights: spec.weights().map(str::to_owned),
                            camera: camera_sha256.to_owned(),
                            tone: self.tone.to_string(),
                            psi: Ordered(depth),
                            noise: Ordered::of_noise(level),
                            image: of.name.clone(),
                            photo: hashes[photo].clone(),
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
    let camera_sha256 = sha256(plan.camera.to_json().as_bytes());
    let hashes: Vec<String> = photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
    let cells = plan.cells(photos, &hashes, &camera_sha256);
    let of = cells.len();
    let mut missing: Vec<Cell> =
        cells.into_iter().filter(|(key, _)| !journal.holds(key)).map(|(_, cell)| cell).collect();
    missing.sort();
    let mut done = of - missing.len();
    let setup = Setup { camera: plan.camera.clone(), entries: vec![] };
    for at_depth in missing.chunk_by(|a, b| a.psi == b.psi) {
        let psi = plan.psi[at_depth[0].psi];
        let psfs = channel_psfs(&plan.camera, psi, &plan.optics).map_err(KodakError::from)?;
        let conditions =
            Conditions { tone: plan.tone, psi: vec![psi], noise: plan.noise.clone(), optics: plan.optics };
        let mut ready = Ready { plan, psi, methods: HashMap::new() };
        for of_photo in at_depth.chunk_by(|a, b| a.photo == b.photo) {
            let photo = &photos[of_photo[0].photo];
            let trial = Trial::new(&setup, photo, psi, &conditions);
            let shots = trial.shots(&psfs)?;
            for cell in of_photo {
                let (noise, raw) = &shots[cell.noise];
                let spec = &plan.methods[cell.method];
                let (method, prepare_seconds) = ready.method(cell.noise, cell.method)?;
                // A computed time does not vary.
                let is_measured = spec.method().format != Some(Format::Board);
                let Timed { result, cpu_seconds, peak_memory_bytes, repetitions } =
                    if is_measured { timed(method, raw) } else { method.reconstruct(raw).map(Timed::not) }
                        .map_err(|source| KodakError::Reconstruct { image: photo.name.clone(), source })?;
                let (height, width) = photo.frame.size();
                let measured = trial.row(*noise, &spec.method(), &result)?;
                let last = format!("{} on {} at psi {psi}", measured.method, photo.name);
                journal.push(Row {
                    measured,
                    prepare_seconds,
                    repetitions,
                    iterations: result.iterations,
                    peak_memory_bytes,
                    cpu_seconds_per_megapixel: cpu_seconds.map(|s| s / ((height * width) as f64 * 1e-6)),
                    weights_sha256: spec.weights().map(str::to_owned),
                    photo_sha256: hashes[cell.photo].clone(),
                    camera_sha256: camera_sha256.clone(),
                })?;
                done += 1;
                if tell(Progress { done, of, last }).is_break() {
                    return Err(KodakError::Stopped.into());
                }
            }
        }
    }
    Ok(journal.finish()?)
}

/// Methods prepared for a depth, by places of noise and method in the plan, and the seconds that took.
struct Ready<'a> {
    plan: &'a Plan,
    psi: f64,
    methods: HashMap<(usize, usize), (Box<dyn Reconstructor>, f64)>,
}

impl Ready<'_> {
    /// A method for a noise level, prepared where it is not yet.
    fn method(&mut self, noise: usize, method: usize) -> Result<(&dyn Reconstructor, f64), PrepareError> {
        let entry = match self.methods.entry((noise, method)) {
            std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
            std::collections::hash_map::Entry::Vacant(entry) => {
                let Plan { camera, optics, .. } = self.plan;
                let case = Case { camera, psi: self.psi, noise: self.plan.noise[noise], optics: *optics };
                let start = Instant::now();
                let prepared = self.plan.methods[method].prepare(&case)?;
                entry.insert((prepared, start.elapsed().as_secs_f64()))
            }
        };
        Ok((entry.0.as_ref(), entry.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dictionary;
    use crate::journal::Header;
    use crate::method::Family;
    use edof_spec::{ColourFrame, Stride};
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
        Header::of::<Row>(false, "a machine".into())
    }

    fn go(plan: &Plan, path: &Path, rows: usize) -> Result<Journal<Row>, StudyError> {
        let mut journal = Journal::open(path, header())?;
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
        Journal::<Row>::open(path, header()).unwrap().rows().iter().map(Line::timeless).collect()
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
        Journal::<Row>::merged(&merged, &files, false).unwrap().finish().unwrap();
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
    fn every_method_reconstructs_a_frame_of_its_size() {
        let mut plan = Plan { noise: vec![Noise::gaussian(0.01)], ..plan(&MethodSpec::names()) };
        plan.methods.retain(|m| m.method().layers.is_none_or(|t| t == 10));
        let folder = tempfile::tempdir().unwrap();
        let journal = go(&plan, &folder.path().join("rows.jsonl"), usize::MAX).unwrap();
        assert_eq!(journal.rows().len(), 2 * MethodSpec::names().len());
        for row in journal.rows() {
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
