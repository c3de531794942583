//! The paper's figure 7: scenes at four depths through several lenses, and every method on what their sensors gave, depth by depth.
//!
//! The paper holds blind deconvolution behind a clear lens that is focused at the end of the range against blind deconvolution, OMP and
//! the network behind the coded one. The clear lens focused mid-range, with a network of its own, is the fairer peer: it stands beside
//! them. Rows go to a [`Journal`] with their pictures, so that a report can be made from the file alone.

use crate::demo_report::{figure, figure_at, figure_of_scene};
use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Proof, Shard, settings};
use crate::made::Made;
use crate::pictures::{self, Names, Part, Picture, Truth};
use crate::tables::noise_words;
use crate::told::{Told, ToldError};
use edof_camera::Camera;
use edof_image::{Noise, RawFrame, ReconstructError, Tone};
use edof_methods::method::Method;
use edof_methods::spec::{Case, MethodSpec, PrepareError};
use edof_metrics::timing::{Range, Timed, timed};
use edof_metrics::{BORDER, MetricError};
use edof_optics::capture::{Approximation, CaptureError, capture};
use edof_optics::draw::{DrawError, draw, parse_name};
use edof_optics::psf::Settings;
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_report::Table;
use edof_report::csv;
use edof_report::picture::{Encoded, jpeg, png};
use edof_report::{Figure, Layout, Report};
use edof_storage::digest::sha256;
use edof_storage::provenance::Input;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::Write;
use std::ops::ControlFlow;

/// What tables call the clear lens focused at the end of the range.
pub const BEHIND: &str = "clear lens, focused on the background";
/// The clear lens focused mid-range.
pub const MIDDLE: &str = "clear lens, focused mid-range";
/// The coded lens.
pub const CODED: &str = "coded lens";
/// What tables call demosaicing alone, blind deconvolution and OMP.
pub const DEMOSAICED: &str = "demosaiced";
/// See [`DEMOSAICED`].
pub const BLIND: &str = "blind deconvolution";
/// See [`DEMOSAICED`].
pub const OMP: &str = "OMP";

/// A drawn scene, by what it is drawn from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Its name, as in `chart-4`.
    pub scene: String,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// ψ of its parts, from back to front.
    pub psi: Vec<f64>,
    /// Of the scene and of the sensor's noise.
    pub seed: u64,
}

impl Drawn {
    /// The scene.
    ///
    /// # Errors
    /// [`DrawError`]: a name that nothing is drawn for, sides out of range.
    pub fn draw(&self) -> Result<Scene, DrawError> {
        draw(parse_name(&self.scene)?.0, self.height, self.width, &self.psi, self.seed)
    }
}

/// A lens and what is done with the frames behind it.
pub struct Lens {
    /// What it is called in tables.
    pub title: &'static str,
    /// The lens.
    pub camera: Camera,
    /// Methods, and what each is called in tables.
    pub methods: Vec<(String, MethodSpec)>,
}

/// What is measured.
pub struct Plan {
    /// Scenes.
    pub scenes: Vec<Drawn>,
    /// Bits of the sensor.
    pub depth: u32,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Lenses; ours, the coded one, last, and its best method last of all.
    pub lenses: Vec<Lens>,
    /// How exactly kernels are computed.
    pub optics: Settings,
    /// Which of its rows.
    pub shard: Shard,
}

/// One picture: what a method made of a scene behind a lens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The scene.
    #[serde(flatten)]
    pub drawn: Drawn,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Noise of the sensor.
    pub noise: Noise,
    /// Bits of the sensor.
    pub depth: u32,
    /// Lens, method, quality and wall-clock seconds.
    #[serde(flatten)]
    pub picture: Picture,
    /// The method.
    pub identity: Method,
    /// Least and most of the runs' wall-clock seconds; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Seconds that all threads together were on a processor.
    pub cpu_seconds: Option<f64>,
    /// Least and most of those.
    #[serde(default)]
    pub cpu_seconds_range: Option<Range>,
    /// Runs whose median the times are.
    pub repetitions: usize,
    /// Steps of an iterative method, mean over patches or colours.
    pub iterations: Option<f64>,
    /// Most bytes of memory that the process held while the method ran.
    pub peak_memory_bytes: Option<u64>,
    /// Place among the rows of the command that measured it: tables keep it.
    pub place: usize,
    /// Hashes of inputs and settings; its photograph is the scene's light and depths.
    #[serde(flatten)]
    pub proof: Proof,
    /// The picture as it is looked at, a JPEG.
    pub shown: Encoded,
    /// A busy part of it at each depth, PNGs in the order of [`Truth::parts`].
    pub parts: Vec<Encoded>,
}

/// What a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    scene: String,
    sides: (usize, usize),
    seed: u64,
    tone: Tone,
    noise: Vec<Ordered>,
    depth: u32,
    lens: String,
    method: Method,
    proof: Proof,
}

impl Line for Row {
    const STUDY: &'static str = "multi-depth";
    const LAYOUT: u32 = 2;
    type Key = Key;

    fn key(&self) -> Key {
        Key {
            scene: self.drawn.scene.clone(),
            sides: (self.drawn.height, self.drawn.width),
            seed: self.drawn.seed,
            tone: self.tone,
            noise: Ordered::of_noise(self.noise),
            depth: self.depth,
            lens: self.picture.lens.clone(),
            method: self.identity.clone(),
            proof: self.proof.clone(),
        }
    }

    fn subject(key: &Key) -> Key {
        Key { proof: Proof::default(), ..key.clone() }
    }

    fn timeless(&self) -> Self {
        let mut row = self.clone();
        (row.picture.seconds, row.cpu_seconds, row.repetitions) = (0.0, None, 0);
        (row.peak_memory_bytes, row.place) = (None, 0);
        (row.seconds_range, row.cpu_seconds_range) = (None, None);
        row
    }
}

/// A study that cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum MultiDepthError {
    /// A scene that nothing draws.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// The scene, the sensor, or depths too far out of focus.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A method refused the frame.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// A scene too small to measure.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A picture that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
}

/// A row to be measured, by places in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    scene: usize,
    lens: usize,
    method: usize,
    place: usize,
}

/// Shows all scenes to all lenses, where the journal does not hold the row yet, and puts its rows into their order. `tell` hears of every
/// row and may stop the study; what was measured stays.
///
/// # Errors
/// [`MultiDepthError`].
pub fn run(
    plan: &Plan,
    journal: &mut Journal<Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), MultiDepthError> {
    let scenes = plan.scenes.iter().map(Drawn::draw).collect::<Result<Vec<_>, _>>()?;
    let hashes: Vec<String> = scenes.iter().map(hash).collect();
    let own = plan.shard.own(plan.cells(&hashes));
    let of = own.len();
    let mut missing: Vec<(Cell, Proof)> =
        own.into_iter().filter(|(key, _)| !journal.holds(key)).map(|(key, cell)| (cell, key.proof)).collect();
    missing.sort();
    let mut done = of - missing.len();
    let mut ready = HashMap::new();
    for of_scene in missing.chunk_by(|(a, _), (b, _)| a.scene == b.scene) {
        let at = of_scene[0].0.scene;
        let (drawn, truth) = (&plan.scenes[at], Truth::of(&scenes[at], plan.tone));
        for of_lens in of_scene.chunk_by(|(a, _), (b, _)| a.lens == b.lens) {
            let lens = &plan.lenses[of_lens[0].0.lens];
            let raw = plan.shot(drawn, &scenes[at], lens)?;
            for (cell, proof) in of_lens {
                let (treatment, spec) = &lens.methods[cell.method];
                let method = match ready.entry((cell.lens, cell.method)) {
                    Entry::Occupied(entry) => entry.into_mut(),
                    Entry::Vacant(entry) => entry.insert(spec.prepare(&plan.case(lens))?),
                };
                let timed = timed(method.as_ref(), &raw)?;
                journal.push(plan.row(*cell, &truth, proof, timed)?)?;
                done += 1;
                let last = format!("{}: {}, {treatment}", drawn.scene, lens.title);
                if tell(Progress { done, of, last }).is_break() {
                    return Err(MultiDepthError::Stopped);
                }
            }
        }
    }
    Ok(journal.finish()?)
}

/// SHA-256 of a scene's light and depths.
fn hash(scene: &Scene) -> String {
    let light = Input::photograph(&scene.name, &scene.sharp()).sha256;
    let depths: Vec<u8> = scene.psi_map().iter().flat_map(|psi| psi.to_le_bytes()).collect();
    sha256(format!("{light}\n{}", sha256(&depths)).as_bytes())
}

impl Plan {
    fn cells(&self, hashes: &[String]) -> Vec<(Key, Cell)> {
        let mut cells = vec![];
        for (scene, drawn) in self.scenes.iter().enumerate() {
            for (lens, Lens { title, camera, methods }) in self.lenses.iter().enumerate() {
                let camera = sha256(camera.to_json().as_bytes());
                for (method, (_, spec)) in methods.iter().enumerate() {
                    let (sensor, approximation) = self.sensor(drawn);
                    let key = Key {
                        scene: drawn.scene.clone(),
                        sides: (drawn.height, drawn.width),
                        seed: drawn.seed,
                        tone: self.tone,
                        noise: Ordered::of_noise(self.noise),
                        depth: self.depth,
                        lens: (*title).to_owned(),
                        method: spec.method(),
                        proof: Proof {
                            settings: Some(settings(&[&spec.settings(), &approximation, &sensor, &BORDER])),
                            weights: spec.weights().map(str::to_owned),
                            photo: hashes[scene].clone(),
                            camera: Some(camera.clone()),
                        },
                    };
                    cells.push((key, Cell { scene, lens, method, place: cells.len() }));
                }
            }
        }
        cells
    }

    /// The sensor, and how exactly its light is computed.
    fn sensor(&self, drawn: &Drawn) -> (Sensor, Approximation) {
        let sensor = Sensor { depth: self.depth, noise: self.noise, seed: drawn.seed, ..Sensor::default() };
        (sensor, Approximation { psf: self.optics, ..Approximation::default() })
    }

    /// What a sensor behind a lens gives.
    fn shot(&self, drawn: &Drawn, scene: &Scene, lens: &Lens) -> Result<RawFrame, CaptureError> {
        let (sensor, approximation) = self.sensor(drawn);
        Ok(capture(scene, &lens.camera, &sensor, &approximation)?.raw)
    }

    /// Blind methods take no depth from their case, and there is no one depth here.
    const fn case<'a>(&self, lens: &'a Lens) -> Case<'a> {
        Case { camera: &lens.camera, psi: 0.0, noise: self.noise, optics: self.optics }
    }

    fn row(&self, cell: Cell, truth: &Truth, proof: &Proof, timed: Timed) -> Result<Row, MultiDepthError> {
        let lens = &self.lenses[cell.lens];
        let (treatment, spec) = &lens.methods[cell.method];
        let Timed { result, range, cpu_seconds, cpu_range, peak_memory_bytes, repetitions } = timed;
        let identity = spec.method();
        let names =
            Names { lens: lens.title, camera: &lens.camera.name, treatment, method: &identity.to_string() };
        let part = |part: &Part| png(&part.of(&result.frame), Tone::Srgb).map(Encoded);
        Ok(Row {
            drawn: self.scenes[cell.scene].clone(),
            tone: self.tone,
            noise: self.noise,
            depth: self.depth,
            picture: truth.judge(names, &result.frame, result.seconds)?,
            identity,
            seconds_range: Some(range),
            cpu_seconds,
            cpu_seconds_range: cpu_range,
            repetitions,
            iterations: result.iterations,
            peak_memory_bytes,
            place: cell.place,
            proof: proof.clone(),
            shown: Encoded(jpeg(&result.frame, Tone::Srgb)?),
            parts: truth.parts().iter().map(part).collect::<Result<_, _>>()?,
        })
    }
}

/// What the paper reports below a column of its figure; a method that is none of the others is the network.
fn paper_db(picture: &Picture) -> Option<f64> {
    match (picture.lens.as_str(), picture.treatment.as_str()) {
        (BEHIND, BLIND) => Some(17.95),
        (CODED, BLIND) => Some(22.75),
        (CODED, OMP) => Some(24.78),
        (CODED, DEMOSAICED) => None,
        (CODED, _) => Some(24.83),
        _ => None,
    }
}

/// All scenes.
#[derive(Debug, Clone, Serialize)]
pub struct MultiDepth {
    /// Each with its pictures.
    pub scenes: Vec<Shown>,
    /// CPU and threads that times are of.
    pub machine: String,
}

/// A scene with its pictures.
#[derive(Debug, Clone, Serialize)]
pub struct Shown {
    /// The scene.
    #[serde(flatten)]
    pub drawn: Drawn,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Bits of the sensor.
    pub depth: u32,
    /// All pictures, lens by lens.
    pub pictures: Vec<Picture>,
    /// The scene and all pictures, whole.
    #[serde(skip)]
    figures: Vec<Figure>,
    /// The same of a part at each ψ.
    #[serde(skip)]
    parts: Vec<(f64, Vec<Figure>)>,
}

impl Shown {
    /// Rows of one scene under one noise and tone, at least one, in the order of tables.
    fn new(first: &Row, rows: &[&Row]) -> Result<Self, ToldError> {
        let Row { drawn, noise, tone, depth, .. } = first;
        let truth = Truth::of(&drawn.draw()?, *tone);
        let mut figures = vec![figure_of_scene("no blur, no noise", png(&truth.light, Tone::Srgb)?)];
        figures.extend(rows.iter().map(|row| figure(&row.picture, row.shown.0.clone())));
        let mut parts = vec![];
        for (place, part) in truth.parts().iter().enumerate() {
            let mut all = vec![figure_of_scene("", png(&part.of(&truth.light), Tone::Srgb)?)];
            let shown = rows.iter().filter_map(|row| Some((row, row.parts.get(place)?)));
            all.extend(shown.map(|(row, shown)| figure_at(&row.picture, part.psi, shown.0.clone())));
            parts.push((part.psi, all));
        }
        let pictures = rows.iter().map(|row| row.picture.clone()).collect();
        let (drawn, noise, tone, depth) = (drawn.clone(), *noise, *tone, *depth);
        Ok(Self { drawn, noise, tone, depth, pictures, figures, parts })
    }

    fn title(&self) -> String {
        format!("Scene “{}”", self.drawn.scene)
    }
}

/// A row as spreadsheets hold it: no pictures.
#[derive(Serialize)]
struct Sheet<'a> {
    scene: &'a str,
    tone: Tone,
    noise: Noise,
    paper_db: Option<f64>,
    #[serde(flatten)]
    picture: &'a Picture,
    cpu_seconds: Option<f64>,
    repetitions: usize,
    iterations: Option<f64>,
    peak_memory_bytes: Option<u64>,
}

impl<'a> Sheet<'a> {
    fn of(row: &'a Row) -> Self {
        Self {
            scene: &row.drawn.scene,
            tone: row.tone,
            noise: row.noise,
            paper_db: paper_db(&row.picture),
            picture: &row.picture,
            cpu_seconds: row.cpu_seconds,
            repetitions: row.repetitions,
            iterations: row.iterations,
            peak_memory_bytes: row.peak_memory_bytes,
        }
    }
}

impl Told for MultiDepth {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, ToldError> {
        let mut rows: Vec<&Row> = rows.iter().collect();
        rows.sort_by_key(|row| row.place);
        let like =
            |a: &Row, b: &Row| (&a.drawn, a.tone, a.noise, a.depth) == (&b.drawn, b.tone, b.noise, b.depth);
        let mut groups: Vec<Vec<&Row>> = vec![];
        for row in rows {
            match groups.iter_mut().find(|group| like(group[0], row)) {
                Some(group) => group.push(row),
                None => groups.push(vec![row]),
            }
        }
        let scenes = groups.iter().map(|group| Shown::new(group[0], group)).collect::<Result<_, _>>()?;
        Ok(Self { scenes, machine })
    }

    fn to_text(&self) -> String {
        let mut text = String::new();
        for (title, table) in self.tables() {
            let _ = write!(text, "{title}\n{}\n", table.to_text());
        }
        text.trim_end().to_owned()
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{}\n", self.explanation());
        for (title, table) in self.tables() {
            let _ = write!(page, "\n## {title}\n\n{}", table.to_markdown());
        }
        page
    }

    /// The paper's columns, then each scene with all pictures and, row by row, a part of each depth.
    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.made_by(command).method(&self.explanation());
        let (title, table) = self.columns();
        report.heading(&title);
        table.add_to(&mut report, &[]);
        for shown in &self.scenes {
            report.heading(&shown.title());
            report.verdict(&pictures::verdict(&shown.pictures));
            pictures::table(&shown.pictures).add_to(&mut report, &pictures::best(&shown.pictures));
            report.paragraph(
                "Each picture opens at a click; arrows flip between them, E shows the difference to the scene.",
            );
            report.figures(&shown.figures, Layout::Wide);
            for (psi, figures) in &shown.parts {
                report.paragraph(&format!("ψ = {psi:.1}, three times as large"));
                report.figures(figures, Layout::Enlarged);
            }
        }
        report
    }

    fn csv(rows: &[Row]) -> String {
        csv::of(&rows.iter().map(Sheet::of).collect::<Vec<_>>())
    }
}

impl MultiDepth {
    fn explanation(&self) -> String {
        let Some(Shown { drawn, noise, tone, depth, .. }) = self.scenes.first() else {
            return "No rows.".to_owned();
        };
        let measured = match tone {
            Tone::Linear => "of light, the method's values not clipped",
            Tone::Srgb => "of the picture encoded as sRGB and clipped to 0…1, and of its light beside it",
        };
        format!(
            "Drawn scenes of {}×{} pixels with four parts, each at its own depth, through each lens onto a {depth}-bit sensor ({}). PSNR in dB {measured}, \
             over red, green and blue, peak 1, border 8 cropped; by depth where it is seen. The paper's figures are of a scene that is not public: \
             their order can be compared, their values cannot. Seconds are wall-clock on {}.",
            drawn.width,
            drawn.height,
            noise_words(*noise),
            self.machine
        )
    }

    /// The paper's columns, then every scene.
    fn tables(&self) -> Vec<(String, Table)> {
        let scenes = self.scenes.iter().map(|shown| (shown.title(), pictures::table(&shown.pictures)));
        std::iter::once(self.columns()).chain(scenes).collect()
    }

    /// PSNR of the paper's columns, and of all others, on each scene.
    fn columns(&self) -> (String, Table) {
        let mut header = vec!["PSNR in dB".to_owned(), "paper".into()];
        header.extend(self.scenes.iter().map(|shown| shown.drawn.scene.clone()));
        let mut columns: Vec<&Picture> = vec![];
        for picture in self.scenes.iter().flat_map(|shown| &shown.pictures) {
            if !columns.iter().any(|known| known.name() == picture.name()) {
                columns.push(picture);
            }
        }
        let or_dash = |db: Option<f64>| db.map_or_else(|| "–".to_owned(), |db| format!("{db:.2}"));
        let row = |column: &&Picture| {
            let of = |shown: &Shown| {
                let own = shown.pictures.iter().find(|picture| picture.name() == column.name());
                or_dash(own.map(|picture| picture.picture.psnr_db))
            };
            let mut cells = vec![column.name(), or_dash(paper_db(column))];
            cells.extend(self.scenes.iter().map(of));
            cells
        };
        (
            "The paper's columns, and their peers".to_owned(),
            Table { header, rows: columns.iter().map(row).collect() },
        )
    }
}

const TITLE: &str = "Four depths in one scene";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{Header, Program};
    use edof_image::Stride;
    use edof_methods::dictionary::Dictionary;
    use std::path::Path;
    use std::sync::Arc;

    fn plan(shard: &str) -> Plan {
        let dictionary = Arc::new(Dictionary::load(None).unwrap());
        let spec = |name: &str| MethodSpec::named(name, &[Stride::PATCH], &dictionary).unwrap().remove(0);
        let lens = |title, camera: &str, methods: &[(&str, &str)]| Lens {
            title,
            camera: Camera::resolve(camera).unwrap(),
            methods: methods.iter().map(|&(title, name)| (title.to_owned(), spec(name))).collect(),
        };
        let drawn = |scene: &str| Drawn {
            scene: scene.into(),
            height: 96,
            width: 128,
            psi: vec![0.0, 8.0 / 3.0, 5.0, 8.0],
            seed: 1,
        };
        Plan {
            scenes: vec![drawn("leaves-4"), drawn("chart-4")],
            depth: 12,
            noise: Noise::None,
            tone: Tone::Linear,
            lenses: vec![
                lens(BEHIND, "clear", &[(DEMOSAICED, "malvar"), (BLIND, "wiener")]),
                lens(MIDDLE, "clear-mid", &[(BLIND, "wiener")]),
                lens(CODED, "ring-2018", &[(DEMOSAICED, "malvar"), (OMP, "omp"), ("n.fixed", "directional")]),
            ],
            optics: Settings { energy: 0.9, ..Settings::default() },
            shard: shard.parse().unwrap(),
        }
    }

    fn header() -> Header {
        Header::of::<Row>(Program::stub("r", "a machine"))
    }

    fn go(shard: &str, path: &Path, most: usize) -> Journal<Row> {
        let mut journal = Journal::open(path, header(), Default::default()).unwrap();
        let mut told = 0;
        let tell = |_| {
            told += 1;
            if told == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        match run(&plan(shard), &mut journal, tell) {
            Ok(()) | Err(MultiDepthError::Stopped) => journal,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn the_papers_columns_stand_beside_ours_and_every_depth_has_its_part() {
        let mut journal = Journal::in_memory(header());
        run(&plan("1/1"), &mut journal, |_| ControlFlow::Continue(())).unwrap();
        let study = MultiDepth::new(&journal.rows(), "a machine".into()).unwrap();
        let page = study.to_markdown(&Made::by("edof study multi-depth"));
        let papers = [
            ("clear lens, focused on the background, demosaiced", "–"),
            ("clear lens, focused on the background, blind deconvolution", "17.95"),
            ("clear lens, focused mid-range, blind deconvolution", "–"),
            ("coded lens, demosaiced", "–"),
            ("coded lens, OMP", "24.78"),
            ("coded lens, n.fixed", "24.83"),
        ];
        let columns: Vec<&str> =
            page.lines().skip_while(|line| !line.contains("| paper |")).skip(2).take(papers.len()).collect();
        for ((column, paper), line) in papers.into_iter().zip(columns) {
            assert!(line.starts_with(&format!("| {column} | {paper} | ")), "{column}\n{page}");
        }
        assert_eq!(journal.rows().len(), 2 * papers.len());
        assert!(page.contains("| PSNR in dB | paper | leaves-4 | chart-4 |"), "{page}");
        let html = study.report("edof study multi-depth").to_html();
        let parts: usize = study.scenes.iter().map(|shown| shown.parts.len()).sum();
        // A depth may have no room for a part.
        assert!(parts >= 6 && html.matches("three times as large").count() == parts);
        assert_eq!(html.matches("dB at this depth").count(), parts * papers.len());
        assert!(html.contains("17.95") && html.contains("edof study multi-depth"));
        let csv = MultiDepth::csv(&journal.rows());
        assert!(csv.starts_with("scene,tone,noise,paper_db,lens,") && !csv.contains("shown"), "{csv}");
    }

    #[test]
    fn a_study_that_was_stopped_and_shared_out_is_the_one_of_a_whole_run() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two, both, whole] = ["one", "two", "both", "whole"].map(|name| folder.path().join(name));
        assert_eq!(go("1/2", &one, 2).rows().len(), 2);
        let first = std::fs::read_to_string(&one).unwrap();
        assert_eq!(go("1/2", &one, usize::MAX).rows().len(), 6);
        let last = std::fs::read_to_string(&one).unwrap();
        assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
        go("2/2", &two, usize::MAX);
        Journal::<Row>::merged(&both, &[two, one], Default::default()).unwrap().finish().unwrap();
        go("1/1", &whole, usize::MAX);
        let rows =
            |path: &Path| Journal::<Row>::open(path, header(), Default::default()).unwrap().rows().to_vec();
        let timeless = |path: &Path| -> Vec<Row> { rows(path).iter().map(Line::timeless).collect() };
        assert_eq!(timeless(&both), timeless(&whole));
        let columns = |path: &Path| MultiDepth::new(&rows(path), "m".into()).unwrap().columns();
        assert_eq!(columns(&both), columns(&whole));
    }

    #[test]
    fn rows_of_a_scene_that_nothing_draws_are_refused() {
        let mut journal = Journal::in_memory(header());
        run(&plan("1/12"), &mut journal, |_| ControlFlow::Continue(())).unwrap();
        let mut rows = journal.rows().to_vec();
        rows[0].drawn.scene = "sea".into();
        let error = MultiDepth::new(&rows, "m".into()).unwrap_err().to_string();
        assert_eq!(error, "rows of scene 'sea': must be chart, chart-4, leaves or leaves-4");
    }
}
