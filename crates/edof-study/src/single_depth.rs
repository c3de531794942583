//! Speed against error on scenes of one depth, the paper's figure 5: every method on every photograph, prepared for its case first.
//!
//! Rows go to a file of JSON lines as they come, so an interrupted study goes on where it was; what is there already is not measured
//! again. Noise depends on photograph, ψ and noise level alone, as in [`kodak`](crate::kodak), and all methods see the same captures.

use crate::kodak::{Conditions, KodakError, Row as Measured, Setup, Trial};
use crate::method::Method;
use crate::photos::Photo;
use crate::spec::{Case, MethodSpec, PrepareError};
use edof_optics::psf::{Settings, channel_psfs};
use edof_spec::atomic::{self, WriteError};
use edof_spec::digest::sha256;
use edof_spec::provenance::Input;
use edof_spec::{Camera, Noise, RawFrame, ReconstructError, Reconstruction, Reconstructor, Tone};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::Read;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is measured.
pub struct Plan {
    /// The camera that all methods stand behind.
    pub camera: Camera,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// Methods.
    pub methods: Vec<MethodSpec>,
    /// How exactly kernels are computed.
    pub optics: Settings,
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
    /// SHA-256 of the weights or dictionary, the photograph's values and the camera: what tells this row from another of the same names.
    pub weights_sha256: Option<String>,
    /// See `weights_sha256`.
    pub photo_sha256: String,
    /// See `weights_sha256`.
    pub camera_sha256: String,
}

/// What all rows of a file have in common: its first line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// `single-depth`.
    pub study: String,
    /// Version of the rows' layout.
    pub layout: u32,
    /// Whole kernels.
    pub exact: bool,
    /// CPU and threads, without which times say nothing.
    pub machine: String,
}

impl Header {
    /// The first line of a study on this machine.
    #[must_use]
    pub fn new(exact: bool, machine: String) -> Self {
        Self { study: "single-depth".into(), layout: 1, exact, machine }
    }
}

/// A study that cannot go on.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum StudyError {
    /// As in the main experiment.
    #[error(transparent)]
    Trial(#[from] KodakError),
    /// A method.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The file of rows cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It cannot be read.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Another file.
    #[error("{path}: line {line}: {reason}", path = path.display())]
    Line { path: PathBuf, line: usize, reason: String },
    /// Rows that cannot stand beside new ones.
    #[error("{path}: its rows are of {found}, this study is of {wanted}: name another file", path = path.display())]
    Other { path: PathBuf, found: String, wanted: String },
}

/// More than any file of rows has.
const MOST_BYTES: u64 = 256 << 20;

/// The rows that there are, in their file.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// What the file holds: a line that is there stays as it is, to the last digit.
    text: String,
    rows: Vec<Row>,
}

impl Journal {
    /// Opens a file of rows, or begins one.
    ///
    /// # Errors
    /// [`StudyError::Read`], [`StudyError::Line`] or [`StudyError::Other`].
    pub fn open(path: &Path, header: Header) -> Result<Self, StudyError> {
        let mut text = String::new();
        // Devices may never end.
        let read = std::fs::File::open(path).and_then(|file| file.take(MOST_BYTES).read_to_string(&mut text));
        match read {
            Ok(_) => {}
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
            Err(source) => return Err(StudyError::Read { path: path.to_owned(), source }),
        }
        let wrong = |line: usize, error: serde_json::Error| StudyError::Line {
            path: path.to_owned(),
            line: line + 1,
            reason: error.to_string(),
        };
        let mut lines = text.lines().enumerate();
        if let Some((line, first)) = lines.next() {
            let found: Header = serde_json::from_str(first).map_err(|e| wrong(line, e))?;
            if found != header {
                let words = |h: &Header| {
                    format!(
                        "{} {} ({}, {})",
                        h.study,
                        h.layout,
                        if h.exact { "exact" } else { "cut kernels" },
                        h.machine
                    )
                };
                return Err(StudyError::Other {
                    path: path.to_owned(),
                    found: words(&found),
                    wanted: words(&header),
                });
            }
        }
        let rows = lines.map(|(line, text)| serde_json::from_str(text).map_err(|e| wrong(line, e)));
        let rows = rows.collect::<Result<_, _>>()?;
        let text = if text.is_empty() { line(&header) } else { text };
        Ok(Self { path: path.to_owned(), text, rows })
    }

    /// All rows, in the order in which they were measured.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Adds a row. The file holds it, or is as it was.
    fn push(&mut self, row: Row) -> Result<(), StudyError> {
        self.text.push_str(&line(&row));
        self.rows.push(row);
        Ok(atomic::write(&self.path, self.text.as_bytes())?)
    }

    fn holds(&self, key: &Key<'_>) -> bool {
        self.rows.iter().any(|row| key.is_of(row))
    }
}

fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_else(|e| unreachable!("rows are plain data: {e}")) + "\n"
}

/// What a row is of.
struct Key<'a> {
    method: Method,
    weights: Option<&'a str>,
    photo: &'a str,
    camera: &'a str,
    psi: f64,
    noise: Noise,
}

impl Key<'_> {
    fn is_of(&self, row: &Row) -> bool {
        row.measured.identity == self.method
            && row.weights_sha256.as_deref() == self.weights
            && row.photo_sha256 == self.photo
            && row.camera_sha256 == self.camera
            && row.measured.psi.to_bits() == self.psi.to_bits()
            && row.measured.noise == self.noise
    }
}

/// How far a study is.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Rows done, those that were there included.
    pub done: usize,
    /// How many there will be.
    pub of: usize,
    /// What was measured last.
    pub last: String,
}

/// Runs of a fast method, after one that warms up; what takes longer than [`FAST`] seconds runs once.
const RUNS: usize = 3;
const FAST: f64 = 0.5;

/// Measures what the journal does not hold yet. `tell` hears of every row and may stop the study; what was measured stays.
///
/// # Errors
/// [`StudyError`].
pub fn run(
    plan: &Plan,
    photos: &[Photo],
    journal: &mut Journal,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), StudyError> {
    let camera_sha256 = sha256(plan.camera.to_json().as_bytes());
    let hashes: Vec<String> = photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
    let of = plan.psi.len() * plan.noise.len() * photos.len() * plan.methods.len();
    let setup = Setup { camera: plan.camera.clone(), entries: vec![] };
    let mut done = 0;
    for &psi in &plan.psi {
        let conditions =
            Conditions { tone: Tone::Linear, psi: vec![psi], noise: plan.noise.clone(), optics: plan.optics };
        let psfs = channel_psfs(&plan.camera, psi, &plan.optics).map_err(KodakError::from)?;
        let mut prepared: HashMap<(usize, usize), (Box<dyn Reconstructor>, f64)> = HashMap::new();
        for (photo, hash) in photos.iter().zip(&hashes) {
            let is_missing = |&(n, m): &(usize, usize)| {
                let (spec, noise) = (&plan.methods[m], plan.noise[n]);
                let (method, weights) = (spec.method(), spec.weights());
                !journal.holds(&Key { method, weights, photo: hash, camera: &camera_sha256, psi, noise })
            };
            let all = (0..plan.noise.len()).flat_map(|n| (0..plan.methods.len()).map(move |m| (n, m)));
            let missing: Vec<(usize, usize)> = all.filter(is_missing).collect();
            done += plan.noise.len() * plan.methods.len() - missing.len();
            if missing.is_empty() {
                continue;
            }
            let trial = Trial::new(&setup, photo, psi, &conditions);
            let shots = trial.shots(&psfs)?;
            for (n, m) in missing {
                let (noise, raw) = &shots[n];
                let spec = &plan.methods[m];
                let (method, prepare_seconds) = match prepared.entry((n, m)) {
                    std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
                    std::collections::hash_map::Entry::Vacant(entry) => {
                        let case = Case { camera: &plan.camera, psi, noise: *noise, optics: plan.optics };
                        let start = Instant::now();
                        let method = spec.prepare(&case)?;
                        entry.insert((method, start.elapsed().as_secs_f64()))
                    }
                };
                let (result, repetitions) = timed(method.as_ref(), raw)
                    .map_err(|source| KodakError::Reconstruct { image: photo.name.clone(), source })?;
                let measured = trial.row(*noise, &spec.method(), &result)?;
                let last = format!("{} on {} at psi {psi}", measured.method, photo.name);
                journal.push(Row {
                    measured,
                    prepare_seconds: *prepare_seconds,
                    repetitions,
                    weights_sha256: spec.weights().map(str::to_owned),
                    photo_sha256: hash.clone(),
                    camera_sha256: camera_sha256.clone(),
                })?;
                done += 1;
                if tell(Progress { done, of, last }).is_break() {
                    return Err(KodakError::Stopped.into());
                }
            }
        }
    }
    Ok(())
}

/// A reconstruction, its time the median of several where that costs little, and of how many.
fn timed(method: &dyn Reconstructor, raw: &RawFrame) -> Result<(Reconstruction, usize), ReconstructError> {
    let mut result = method.reconstruct(raw)?;
    if result.seconds > FAST {
        return Ok((result, 1));
    }
    let mut seconds = vec![];
    for _ in 0..RUNS {
        seconds.push(method.reconstruct(raw)?.seconds);
    }
    seconds.sort_by(f64::total_cmp);
    result.seconds = seconds[RUNS / 2];
    Ok((result, RUNS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dictionary;
    use edof_spec::{ColourFrame, Stride};
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
        }
    }

    fn header() -> Header {
        Header::new(false, "a machine".into())
    }

    fn go(plan: &Plan, path: &Path, rows: usize) -> Result<Journal, StudyError> {
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

    /// A row without its times, which are never the same.
    fn timeless(row: &Row) -> Row {
        let mut row = row.clone();
        (row.measured.seconds_per_megapixel, row.prepare_seconds, row.repetitions) = (0.0, 0.0, 0);
        row
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
        assert!(std::fs::read_to_string(&parts).unwrap().starts_with(&first), "what is there stays");
        let rows = |path: &Path| -> Vec<Row> {
            Journal::open(path, header()).unwrap().rows().iter().map(timeless).collect()
        };
        assert_eq!(rows(&parts), rows(&all));
    }

    #[test]
    fn another_method_or_depth_adds_rows_and_measures_no_other_again() {
        let path = tempfile::tempdir().unwrap().keep().join("rows.jsonl");
        go(&plan(&["malvar"]), &path, usize::MAX).unwrap();
        let first = std::fs::read_to_string(&path).unwrap();
        let more = go(&plan(&["malvar", "directional"]), &path, usize::MAX).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
        assert_eq!(more.rows().len(), 8);
        std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
    }

    #[test]
    fn every_method_reconstructs_a_frame_of_its_size() {
        let plan = Plan { noise: vec![Noise::gaussian(0.01)], ..plan(&MethodSpec::names()) };
        let folder = tempfile::tempdir().unwrap();
        let journal = go(&plan, &folder.path().join("rows.jsonl"), usize::MAX).unwrap();
        assert_eq!(journal.rows().len(), 2 * MethodSpec::names().len());
        for row in journal.rows() {
            assert!(
                row.measured.picture.psnr_db > 10.0,
                "{}: {}",
                row.measured.method,
                row.measured.picture.psnr_db
            );
        }
    }

    #[test]
    fn rows_of_another_machine_or_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        go(&plan(&["malvar"]), &path, usize::MAX).unwrap();
        let error = Journal::open(&path, Header::new(true, "a machine".into())).unwrap_err().to_string();
        assert!(
            error.ends_with(
                "its rows are of single-depth 1 (cut kernels, a machine), this study is of single-depth 1 (exact, a \
                 machine): name another file"
            ),
            "{error}"
        );
        std::fs::write(&path, line(&header()) + "{\"method\":").unwrap();
        let error = Journal::open(&path, header()).unwrap_err().to_string();
        assert!(error.contains("rows.jsonl: line 2: "), "{error}");
        std::fs::write(&path, "a text").unwrap();
        assert!(matches!(Journal::open(&path, header()), Err(StudyError::Line { line: 1, .. })));
        assert!(matches!(Journal::open(folder.path(), header()), Err(StudyError::Read { .. })));
    }

    #[test]
    fn a_method_that_nobody_knows_is_named() {
        let dictionary = Arc::new(Dictionary::load(None).unwrap());
        let error = MethodSpec::named("magic", &[], &dictionary).unwrap_err().to_string();
        assert!(error.starts_with("method 'magic': must be one of malvar, directional, "), "{error}");
    }
}
