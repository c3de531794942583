//! Blind deconvolution where the blur is known to whoever judges it: photographs blurred with drawn kernels, which the method has to
//! find. Rows go to a [`Journal`] as those of other studies.

use crate::journal::{self, Journal, JournalError, Line, Progress, Proof, Shard};
use crate::made::Made;
use crate::told::{Told, ToldError};
use edof_deblur::blind::{self, Estimate, Settings};
use edof_deblur::hyper_laplacian::hyper_laplacian;
use edof_image::ColourFrame;
use edof_io::photos::{Photo, choices};
use edof_metrics::cpu_time;
use edof_metrics::paired::Paired;
use edof_metrics::{BORDER, MetricError, Quality};
use edof_optics::blur::blur_frame;
use edof_optics::psf::Psf;
use edof_report::Report;
use edof_report::Table;
use edof_storage::provenance::Input;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::time::Instant;

/// A kernel and what it is called.
#[derive(Debug, Clone)]
pub struct Blur {
    /// As in `disc`.
    pub name: &'static str,
    /// Odd sides, sum 1.
    pub psf: Psf,
}

/// Side of the drawn kernels, and samples along and across a line of them.
const SIDE: usize = 13;
const SAMPLES: usize = 400;

/// A lens out of focus (a disc of 5 pixels), a camera that moved straight (10 pixels), and one that moved in a bow (some 12).
#[must_use]
pub fn drawn() -> [Blur; 3] {
    let blur = |name, points: Vec<[f64; 2]>| {
        let psf =
            Psf::new(splatted(&points)).unwrap_or_else(|e| unreachable!("kernels are drawn to sum 1: {e}"));
        Blur { name, psf }
    };
    let line = |at: &dyn Fn(f64) -> [f64; 2]| -> Vec<[f64; 2]> {
        (0..SAMPLES).map(|i| at((i as f64 + 0.5) / SAMPLES as f64)).collect()
    };
    // Equal areas: a spiral of golden turns.
    let disc = |t: f64| {
        let (radius, turn) = (2.5 * t.sqrt(), t * SAMPLES as f64 * 2.399_963_229_728_653);
        [radius * turn.sin(), radius * turn.cos()]
    };
    let stroke = |t: f64| {
        let (sin, cos) = 0.5f64.sin_cos();
        [10.0 * (t - 0.5) * sin, 10.0 * (t - 0.5) * cos]
    };
    let bow = |t: f64| {
        let angle = -0.4 + 2.6 * t;
        [4.5 * angle.sin() - 2.6, 4.5 * angle.cos() - 1.2]
    };
    [blur("disc", line(&disc)), blur("stroke", line(&stroke)), blur("bow", line(&bow))]
}

/// Points (row and column from the middle) shared out among their four nearest pixels.
fn splatted(points: &[[f64; 2]]) -> Array2<f32> {
    let mut kernel = Array2::<f64>::zeros((SIDE, SIDE));
    for &[row, column] in points {
        let (r, c) = (row + (SIDE / 2) as f64, column + (SIDE / 2) as f64);
        let (r0, c0) = (r.floor() as usize, c.floor() as usize);
        let (fr, fc) = (r.fract(), c.fract());
        for (dr, wr) in [(0, 1.0 - fr), (1, fr)] {
            for (dc, wc) in [(0, 1.0 - fc), (1, fc)] {
                kernel[(r0 + dr, c0 + dc)] += wr * wc;
            }
        }
    }
    let sum = kernel.sum();
    kernel.mapv(|v| (v / sum) as f32)
}

/// What the method made of one photograph and kernel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The photograph.
    pub image: String,
    /// The kernel.
    pub blur: String,
    /// Side in pixels of the kernel that was looked for.
    pub side: usize,
    /// PSNR in dB of the blurred picture.
    #[serde(with = "edof_metrics::number")]
    pub blurred_db: f64,
    /// PSNR in dB of what the method made of it.
    #[serde(with = "edof_metrics::number")]
    pub restored_db: f64,
    /// PSNR in dB of the same last step with the true kernel.
    #[serde(with = "edof_metrics::number")]
    pub known_db: f64,
    /// Correlation of the kernel that was found with the true one, at the best shift of a few pixels.
    #[serde(with = "edof_metrics::number")]
    pub correlation: f64,
    /// How often the method's step was halved.
    pub halvings: usize,
    /// Shrinkage steps that the kernel took.
    pub steps: usize,
    /// Wall-clock seconds a megapixel.
    pub seconds_per_megapixel: f64,
    /// Seconds that all threads together were on a processor, a megapixel; none where the system does not tell.
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Hashes of the photograph and of all settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    side: usize,
    image: String,
    blur: String,
    proof: Proof,
}

impl Line for Row {
    const STUDY: &'static str = "blind";
    const LAYOUT: u32 = 2;
    type Key = Key;

    fn key(&self) -> Key {
        let Self { side, image, blur, proof, .. } = self;
        Key { side: *side, image: image.clone(), blur: blur.clone(), proof: proof.clone() }
    }

    fn subject(key: &Key) -> Key {
        Key { proof: Proof::default(), ..key.clone() }
    }

    fn timeless(&self) -> Self {
        Self { seconds_per_megapixel: 0.0, cpu_seconds_per_megapixel: None, ..self.clone() }
    }
}

/// A study that cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum BlindError {
    /// A photograph.
    #[error(transparent)]
    Small(#[from] TooSmall),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
}

/// Restores every photograph blurred with every drawn kernel where the journal does not hold the row yet; `tell` hears of every row and
/// may stop the study.
///
/// # Errors
/// [`BlindError`].
pub fn run(
    photos: &[Photo],
    settings: &Settings,
    shard: Shard,
    journal: &mut Journal<Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), BlindError> {
    let mut cells = vec![];
    let blurs = drawn();
    for photo in photos {
        let sha256 = Input::photograph(&photo.name, &photo.frame).sha256;
        for blur in &blurs {
            // The kernel to its last bit: arrays shorten themselves where they are written.
            let kernel: Vec<f32> = blur.psf.kernel.iter().copied().collect();
            let proof = Proof {
                settings: Some(journal::settings(&[settings, &kernel, &STEPS, &BORDER])),
                photo: sha256.clone(),
                ..Proof::default()
            };
            let (image, blurred) = (photo.name.clone(), blur.name.to_owned());
            let key = Key { side: settings.side, image, blur: blurred, proof };
            cells.push((key, (photo, blur)));
        }
    }
    let own = shard.own(cells);
    let of = own.len();
    for (done, (key, (photo, blur))) in own.into_iter().enumerate() {
        if !journal.holds(&key) {
            journal.push(restore(photo, key.proof, blur, settings)?)?;
        }
        let last = format!("{} of {}", blur.name, photo.name);
        if tell(Progress { done: done + 1, of, last }).is_break() {
            return Err(BlindError::Stopped);
        }
    }
    Ok(journal.finish()?)
}

/// Values of a photograph's file are in steps of one 255th, and so are those of the blurred one.
const STEPS: f32 = 255.0;

/// A photograph too small to measure.
#[derive(Debug, thiserror::Error)]
#[error("{image}: {source}")]
#[allow(missing_docs, reason = "the message names the fields")]
pub struct TooSmall {
    image: String,
    source: MetricError,
}

/// Blurs a photograph, rounds it to 8 bits, finds the kernel on its grey picture, and deconvolves its colours with it.
///
/// # Errors
/// [`TooSmall`].
fn restore(photo: &Photo, proof: Proof, blur: &Blur, settings: &Settings) -> Result<Row, TooSmall> {
    let psfs = [blur.psf.clone(), blur.psf.clone(), blur.psf.clone()];
    let mut seen = blur_frame(&photo.frame, &psfs);
    seen.planes.mapv_inplace(|v| (v * STEPS).round().clamp(0.0, STEPS) / STEPS);
    let (start, cpu_start) = (Instant::now(), cpu_time::seconds());
    let grey = seen.planes.mean_axis(Axis(0)).unwrap_or_else(|| unreachable!("three colours have a mean"));
    let Estimate { kernel, halvings, steps } = blind::estimate(grey.view(), settings);
    let restored = deconvolved(&seen, kernel.view(), settings);
    let seconds = start.elapsed().as_secs_f64();
    let cpu_seconds = cpu_time::seconds().zip(cpu_start).map(|(after, before)| after - before);
    let known = deconvolved(&seen, blur.psf.kernel.view(), settings);
    let (height, width) = seen.size();
    let megapixels = (height * width) as f64 * 1e-6;
    let db = |frame: &ColourFrame| {
        let quality = Quality::of(&photo.frame, frame, BORDER);
        quality.map(|q| q.psnr_db).map_err(|source| TooSmall { image: photo.name.clone(), source })
    };
    let (shift, correlation) = best_shift(kernel.view(), blur.psf.kernel.view());
    // A kernel and a picture that are moved against each other are the same answer.
    let restored = moved(&restored, shift);
    Ok(Row {
        image: photo.name.clone(),
        blur: blur.name.into(),
        side: settings.side,
        blurred_db: db(&seen)?,
        restored_db: db(&restored)?,
        known_db: db(&known)?,
        correlation,
        halvings,
        steps,
        seconds_per_megapixel: seconds / megapixels,
        cpu_seconds_per_megapixel: cpu_seconds.map(|seconds| seconds / megapixels),
        proof,
    })
}

/// All rows, and what they say together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownBlurs {
    /// One for each photograph and kernel.
    pub rows: Vec<Row>,
    /// Mean of what the method gained, in dB.
    pub mean_gain_db: f64,
    /// The same with its standard error: the mean over photographs of the mean over a photograph's kernels.
    pub gain: Option<Paired>,
    /// Mean of what the true kernel gains in the same last step.
    pub mean_known_gain_db: f64,
    /// The least gain; what is far below 0 has diverged.
    pub least_gain_db: f64,
    /// Mean correlation of kernels.
    pub mean_correlation: f64,
    /// The least.
    pub least_correlation: f64,
    /// How many pictures have lost more than [`DIVERGED_DB`].
    pub diverged: usize,
    /// CPU and threads that times are of.
    pub machine: String,
}

/// A picture that has lost more than this many dB has diverged.
pub const DIVERGED_DB: f64 = 1.0;

const TITLE: &str = "Blind deconvolution of drawn blurs";

impl Told for KnownBlurs {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, ToldError> {
        let mean = |of: fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
        let least = |of: fn(&Row) -> f64| rows.iter().map(of).fold(f64::INFINITY, f64::min);
        let gain = |row: &Row| row.restored_db - row.blurred_db;
        let of_photo = |image: &String| {
            let own: Vec<f64> = rows.iter().filter(|row| row.image == *image).map(gain).collect();
            own.iter().sum::<f64>() / own.len() as f64
        };
        let photos: BTreeSet<&String> = rows.iter().map(|row| &row.image).collect();
        Ok(Self {
            mean_gain_db: mean(gain),
            gain: Paired::of(&photos.into_iter().map(of_photo).collect::<Vec<_>>()),
            mean_known_gain_db: mean(|row| row.known_db - row.blurred_db),
            least_gain_db: least(gain),
            mean_correlation: mean(|row| row.correlation),
            least_correlation: least(|row| row.correlation),
            diverged: rows.iter().filter(|row| gain(row) < -DIVERGED_DB).count(),
            rows: rows.to_vec(),
            machine,
        })
    }

    fn to_text(&self) -> String {
        format!("{}{}", self.table().to_text(), self.sentence())
    }

    fn to_markdown(&self, made: &Made) -> String {
        format!("# {TITLE}\n\n{made}\n\n{}\n\n{}", self.sentence(), self.table().to_markdown())
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.verdict(&self.sentence()).made_by(command);
        self.table().add_to(&mut report, &[]);
        report
    }
}

impl KnownBlurs {
    fn sentence(&self) -> String {
        format!(
            "Over {} blurred photographs: {} dB on average (with the true kernel {:+.2}), the least {:+.2} dB; kernels correlate by {:.3} on \
             average, at least by {:.3}. Lost more than {DIVERGED_DB} dB: {}. Seconds are wall-clock and of all threads together on {}.{}",
            self.rows.len(),
            self.gain.map_or_else(|| "–".to_owned(), |gain| gain.to_string()),
            self.mean_known_gain_db,
            self.least_gain_db,
            self.mean_correlation,
            self.least_correlation,
            match self.diverged {
                0 => "none".to_owned(),
                count => count.to_string(),
            },
            self.machine,
            choices(self.rows.iter().map(|row| row.image.as_str()))
        )
    }

    fn table(&self) -> Table {
        let header = [
            "photograph",
            "kernel",
            "blurred dB",
            "restored dB",
            "true kernel dB",
            "correlation",
            "seconds a megapixel",
            "CPU seconds a megapixel",
        ];
        let row = |r: &Row| {
            let db = [r.blurred_db, r.restored_db, r.known_db].map(|v| format!("{v:.2}"));
            let mut cells = vec![r.image.clone(), r.blur.clone()];
            cells.extend(db);
            cells.extend([format!("{:.3}", r.correlation), format!("{:.1}", r.seconds_per_megapixel)]);
            cells.push(r.cpu_seconds_per_megapixel.map_or_else(|| "–".to_owned(), |s| format!("{s:.1}")));
            cells
        };
        Table { header: header.map(str::to_owned).to_vec(), rows: self.rows.iter().map(row).collect() }
    }
}

fn deconvolved(seen: &ColourFrame, kernel: ArrayView2<'_, f32>, settings: &Settings) -> ColourFrame {
    let planes: Vec<Array2<f32>> = (0..3)
        .into_par_iter()
        .map(|plane| hyper_laplacian(seen.planes.index_axis(Axis(0), plane), kernel, settings.prior))
        .collect();
    let mut out = seen.clone();
    out.planes.axis_iter_mut(Axis(0)).zip(&planes).for_each(|(mut to, plane)| to.assign(plane));
    out
}

/// Pixels by which kernels may be moved against each other.
const REACH: isize = 3;

/// Rows and columns by which `found` lies beside `truth`, and their correlation there: the cosine of both.
fn best_shift(found: ArrayView2<'_, f32>, truth: ArrayView2<'_, f32>) -> ((isize, isize), f64) {
    let at = |k: &ArrayView2<'_, f32>, r: isize, c: isize| {
        let place = (r + k.nrows() as isize / 2, c + k.ncols() as isize / 2);
        let place = usize::try_from(place.0).ok().zip(usize::try_from(place.1).ok());
        place.and_then(|at| k.get(at)).map_or(0.0, |v| f64::from(*v))
    };
    let norm = |k: &ArrayView2<'_, f32>| k.iter().map(|v| f64::from(v * v)).sum::<f64>().sqrt();
    let half = (found.nrows().max(truth.nrows()) / 2) as isize + REACH;
    let cosine = |dr: isize, dc: isize| {
        let both = (-half..=half).flat_map(|r| (-half..=half).map(move |c| (r, c)));
        let product: f64 = both.map(|(r, c)| at(&found, r + dr, c + dc) * at(&truth, r, c)).sum();
        product / (norm(&found) * norm(&truth)).max(f64::MIN_POSITIVE)
    };
    let shifts = (-REACH..=REACH).flat_map(|dr| (-REACH..=REACH).map(move |dc| (dr, dc)));
    let best = shifts.map(|(dr, dc)| ((dr, dc), cosine(dr, dc))).max_by(|a, b| a.1.total_cmp(&b.1));
    best.unwrap_or(((0, 0), 0.0))
}

/// A frame moved by whole rows and columns; its border is continued.
fn moved(frame: &ColourFrame, (rows, columns): (isize, isize)) -> ColourFrame {
    let (height, width) = frame.size();
    let at = |i: usize, by: isize, n: usize| (i as isize - by).clamp(0, n as isize - 1) as usize;
    let mut out = frame.clone();
    out.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = frame.planes[(p, at(r, rows, height), at(c, columns, width))];
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{Header, Program};

    /// Cards of many greys on top of each other.
    fn cards() -> Photo {
        let scene = edof_optics::draw::draw(edof_optics::draw::Builtin::Leaves, 160, 192, &[0.0], 3);
        Photo { name: "leaves".into(), frame: scene.unwrap().sharp() }
    }

    #[test]
    fn a_drawn_blur_is_found_and_undone_and_no_row_is_measured_twice() {
        let settings = Settings { side: 15, ..Settings::default() };
        let folder = tempfile::tempdir().unwrap();
        let header = Header::of::<Row>(Program::stub("r", "a machine"));
        let go = |file: &str, shard: &str, most: usize| {
            let mut journal =
                Journal::open(&folder.path().join(file), header.clone(), Default::default()).unwrap();
            let mut told = 0;
            let tell = |_| {
                told += 1;
                if told == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            match run(&[cards()], &settings, shard.parse().unwrap(), &mut journal, tell) {
                Ok(()) | Err(BlindError::Stopped) => journal,
                Err(error) => panic!("{error}"),
            }
        };
        assert_eq!(go("parts", "1/2", 1).rows().len(), 1);
        let first = std::fs::read_to_string(folder.path().join("parts")).unwrap();
        go("parts", "1/2", usize::MAX);
        let journal = go("parts", "1/1", usize::MAX);
        let last = std::fs::read_to_string(folder.path().join("parts")).unwrap();
        assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
        let rows = journal.rows();
        assert_eq!(rows.iter().map(|row| row.blur.as_str()).collect::<Vec<_>>(), ["bow", "disc", "stroke"]);
        for row in &rows {
            assert!(row.known_db > row.blurred_db + 2.0, "the kernel is the blur's own: {row:?}");
        }
        let study = KnownBlurs::new(&rows, "a machine".into()).unwrap();
        assert!(study.mean_gain_db > 1.0 && study.mean_correlation > 0.7, "{}", study.to_text());
        assert!(study.to_markdown(&Made::by("edof study blind")).contains("| leaves | bow | "));
    }

    #[test]
    fn what_has_diverged_is_counted() {
        let row = |restored_db| Row {
            image: "a".into(),
            blur: "bow".into(),
            side: 15,
            blurred_db: 25.0,
            restored_db,
            known_db: 30.0,
            correlation: 0.9,
            halvings: 0,
            steps: 1,
            seconds_per_megapixel: 1.0,
            cpu_seconds_per_megapixel: None,
            proof: Proof::default(),
        };
        let told = |db: &[f64]| {
            KnownBlurs::new(&db.iter().map(|&db| row(db)).collect::<Vec<_>>(), "m".into()).unwrap().to_text()
        };
        assert!(told(&[24.5, 26.0]).contains("Lost more than 1 dB: none."), "{}", told(&[24.5, 26.0]));
        assert!(told(&[23.5, 26.0]).contains("Lost more than 1 dB: 1."));
    }

    #[test]
    fn drawn_kernels_are_light_that_stays_inside() {
        for Blur { name, psf } in drawn() {
            let rim =
                psf.kernel.indexed_iter().filter(|((r, c), _)| [*r, *c].iter().any(|i| i % (SIDE - 1) == 0));
            assert_eq!(rim.map(|(_, v)| *v).sum::<f32>(), 0.0, "{name}");
            assert!((psf.kernel.sum() - 1.0).abs() < 1e-5, "{name}");
        }
    }

    #[test]
    fn a_shift_of_kernels_is_found_and_undone() {
        let truth = drawn()[2].psf.kernel.clone();
        let found = Array2::from_shape_fn((15, 15), |(r, c)| {
            // One row down and two columns to the left, in a kernel larger by a pixel all around.
            truth.get((r.wrapping_sub(2), c.wrapping_add(1))).copied().unwrap_or(0.0)
        });
        let (shift, correlation) = best_shift(found.view(), truth.view());
        assert_eq!(shift, (1, -2));
        assert!(correlation > 0.999, "{correlation}");
    }
}
