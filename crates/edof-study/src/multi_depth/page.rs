//! What the rows say: the paper's columns, and every scene with its pictures.

use super::{BEHIND, BLIND, CODED, Drawn, OMP, Row};
use crate::demo_report::{figure, figure_at, figure_of_scene};
use crate::made::Made;
use crate::pictures::{self, Picture, Truth};
use crate::report::picture::png;
use crate::report::{Figure, Layout, Report, Table, csv};
use crate::study_report::{StudyReport, StudyReportError};
use crate::tables::noise_words;
use edof_core::{Noise, Tone};
use serde::Serialize;
use std::fmt::Write;

/// What the paper reports below a column of its figure; its network is the one of the paper's form.
fn paper_db(picture: &Picture) -> Option<f64> {
    match (picture.lens.as_str(), picture.treatment.as_str()) {
        (BEHIND, BLIND) => Some(17.95),
        (CODED, BLIND) => Some(22.75),
        (CODED, OMP) => Some(24.78),
        (CODED, network) if network.starts_with(PAPERS) => Some(24.83),
        _ => None,
    }
}

/// What names of networks of the paper's form begin with.
const PAPERS: &str = "paper-";

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
    pub(super) parts: Vec<(f64, Vec<Figure>)>,
}

impl Shown {
    /// Rows of one scene under one noise and tone, at least one, in the order of tables.
    fn new(first: &Row, rows: &[&Row]) -> Result<Self, StudyReportError> {
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

impl StudyReport for MultiDepth {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, StudyReportError> {
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
        for shown in &self.scenes {
            report.verdict(&format!("{}: {}", shown.title(), pictures::verdict(&shown.pictures)));
        }
        report.made_by(command).method(&self.explanation());
        let (title, table) = self.columns();
        report.heading(&title);
        table.add_to(&mut report, &[]);
        for shown in &self.scenes {
            report.heading(&shown.title());
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
    pub(super) fn columns(&self) -> (String, Table) {
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
                or_dash(own.map(|picture| picture.picture.psnr_db()))
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
