//! The paper's figure 7: scenes at four depths through several lenses, and every method on what their sensors gave, depth by depth.
//!
//! The paper holds blind deconvolution behind a clear lens that is focused at the end of the range against blind deconvolution, OMP and
//! the network behind the coded one. The clear lens focused mid-range, with a network of its own, is the fairer peer: it stands beside
//! them.

use crate::demo::{self, Demo, DemoError, Lens, Picture};
use crate::report::{Layout, Report};
use crate::tables::{Table, noise_words};
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::{Noise, Tone};
use serde::Serialize;
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

/// All scenes.
#[derive(Debug, Clone, Serialize)]
pub struct MultiDepth {
    /// Each with its pictures.
    pub scenes: Vec<Demo>,
    /// CPU and threads that times are of.
    pub machine: String,
}

/// One picture, as files of rows hold it.
#[derive(Debug, Clone, Serialize)]
pub struct Row<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Noise of the sensor.
    pub noise: Noise,
    /// The paper's PSNR in dB of this column, of a scene of its own.
    pub paper_db: Option<f64>,
    /// Lens, method, quality and time.
    #[serde(flatten)]
    pub picture: &'a Picture,
}

impl<'a> Row<'a> {
    fn of(demo: &'a Demo, picture: &'a Picture) -> Self {
        let Demo { scene, tone, noise, .. } = demo;
        Self { scene, tone: *tone, noise: *noise, paper_db: paper_db(picture), picture }
    }
}

/// Shows all scenes to all lenses. `tell` hears what was done and may stop.
///
/// # Errors
/// [`DemoError`].
pub fn run(
    scenes: &[Scene],
    sensor: &Sensor,
    lenses: &[Lens<'_>],
    tone: Tone,
    machine: String,
    mut tell: impl FnMut(&str) -> ControlFlow<()>,
) -> Result<MultiDepth, DemoError> {
    let of = |scene: &Scene| demo::run(scene, sensor, lenses, tone, &mut tell);
    Ok(MultiDepth { scenes: scenes.iter().map(of).collect::<Result<_, _>>()?, machine })
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

impl MultiDepth {
    /// One for each picture.
    #[must_use]
    pub fn rows(&self) -> Vec<Row<'_>> {
        let pictures = self.scenes.iter().flat_map(|demo| demo.pictures.iter().map(move |p| (demo, p)));
        pictures.map(|(demo, picture)| Row::of(demo, picture)).collect()
    }

    /// Tables for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (title, table) in self.tables() {
            let _ = write!(text, "{title}\n{}\n", table.to_text());
        }
        text.trim_end().to_owned()
    }

    /// The same as a Markdown page; `command` tells how to make it again.
    #[must_use]
    pub fn to_markdown(&self, command: &str) -> String {
        let mut page = format!("# {TITLE}\n\nMade by `{command}`.\n\n{}\n", self.explanation());
        for (title, table) in self.tables() {
            let _ = write!(page, "\n## {title}\n\n{}", table.to_markdown());
        }
        page
    }

    /// The report: the paper's columns, then each scene with all pictures and, row by row, a part of each depth.
    ///
    /// # Errors
    /// [`DemoError::Picture`].
    pub fn report(&self, command: &str) -> Result<Report, DemoError> {
        let mut report = Report::new(TITLE);
        report.paragraph(&self.explanation());
        let (title, table) = self.columns();
        report.heading(&title);
        table.add_to(&mut report, &[]);
        for demo in &self.scenes {
            report.heading(&format!("Scene “{}”", demo.scene));
            report.verdict(&demo.verdict());
            demo.table().add_to(&mut report, &demo.best());
            demo.add_pictures(&mut report)?;
        }
        report.paragraph(&format!("Made by: {command}"));
        Ok(report)
    }

    fn explanation(&self) -> String {
        let Some(demo) = self.scenes.first() else { return String::new() };
        let measured = match demo.tone {
            Tone::Linear => "of light, nothing clipped",
            Tone::Srgb => "of the picture encoded as sRGB and clipped to 0…1, and of its light beside it",
        };
        format!(
            "Drawn scenes of {}×{} pixels with four parts, each at its own depth, through each lens onto a {}-bit sensor ({}). PSNR in dB {measured}, \
             over red, green and blue, peak 1, border 8 cropped; by depth where it is seen. The paper's figures are of a scene that is not public: \
             their order can be compared, their values cannot. Seconds are wall-clock on {}.",
            demo.width,
            demo.height,
            demo.depth,
            noise_words(demo.noise),
            self.machine
        )
    }

    /// The paper's columns, then every scene.
    fn tables(&self) -> Vec<(String, Table)> {
        let scenes = self.scenes.iter().map(|demo| (format!("Scene “{}”", demo.scene), demo.table()));
        std::iter::once(self.columns()).chain(scenes).collect()
    }

    /// PSNR of the paper's columns, and of all others, on each scene.
    fn columns(&self) -> (String, Table) {
        let mut header = vec!["PSNR in dB".to_owned(), "paper".into()];
        header.extend(self.scenes.iter().map(|demo| demo.scene.clone()));
        let count = self.scenes.first().map_or(0, |demo| demo.pictures.len());
        let row = |index: usize| {
            let all: Vec<&Picture> = self.scenes.iter().filter_map(|demo| demo.pictures.get(index)).collect();
            let first = all.first().copied()?;
            let paper = paper_db(first).map_or_else(|| "–".to_owned(), |db| format!("{db:.2}"));
            let mut cells = vec![format!("{}, {}", first.lens, first.treatment), paper];
            cells.extend(all.iter().map(|picture| format!("{:.2}", picture.picture.psnr_db)));
            Some(cells)
        };
        (
            "The paper's columns, and their peers".to_owned(),
            Table { header, rows: (0..count).filter_map(row).collect() },
        )
    }
}

const TITLE: &str = "Four depths in one scene";

impl Demo {
    /// All pictures, and a part of each depth.
    fn add_pictures(&self, report: &mut Report) -> Result<(), DemoError> {
        report.paragraph(
            "Each picture opens at a click; arrows flip between them, E shows the difference to the scene.",
        );
        report.figures(&self.figures()?, Layout::Wide);
        for psi in self.psis() {
            let figures = self.parts(psi)?;
            if !figures.is_empty() {
                report.paragraph(&format!("ψ = {psi:.1}, three times as large"));
                report.figures(&figures, Layout::Enlarged);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_deblur::Malvar;
    use edof_optics::draw::{Builtin, draw};
    use edof_spec::{Camera, Reconstructor};

    fn study(tell: impl FnMut(&str) -> ControlFlow<()>) -> Result<MultiDepth, DemoError> {
        let scene = |kind| draw(kind, 96, 128, &[0.0, 3.0, 5.0, 8.0], 1).unwrap();
        let malvar = Malvar::default();
        let lens = |title: &str, camera: &str, treatments: &[&str]| Lens {
            title: title.into(),
            about: String::new(),
            camera: Camera::resolve(camera).unwrap(),
            methods: treatments.iter().map(|&t| (t.to_owned(), &malvar as &dyn Reconstructor)).collect(),
        };
        let lenses = [
            lens(BEHIND, "clear", &[DEMOSAICED, BLIND]),
            lens(MIDDLE, "clear-mid", &[BLIND]),
            lens(CODED, "ring-2018", &[DEMOSAICED, BLIND, OMP, "network n.fixed"]),
        ];
        let scenes = [scene(Builtin::Chart), scene(Builtin::Leaves)];
        run(&scenes, &Sensor::default(), &lenses, Tone::Linear, "a machine".into(), tell)
    }

    #[test]
    fn the_papers_columns_stand_beside_ours_and_every_depth_has_its_part() {
        let study = study(|_| ControlFlow::Continue(())).unwrap();
        let page = study.to_markdown("edof study multi-depth");
        let papers = [
            ("clear lens, focused on the background, demosaiced", "–"),
            ("clear lens, focused on the background, blind deconvolution", "17.95"),
            ("clear lens, focused mid-range, blind deconvolution", "–"),
            ("coded lens, demosaiced", "–"),
            ("coded lens, blind deconvolution", "22.75"),
            ("coded lens, OMP", "24.78"),
            ("coded lens, network n.fixed", "24.83"),
        ];
        for (column, paper) in papers {
            assert!(page.contains(&format!("\n| {column} | {paper} | ")), "{column}\n{page}");
        }
        assert_eq!(study.rows().len(), 2 * papers.len());
        assert!(page.contains("| PSNR in dB | paper | chart-4 | leaves-4 |"), "{page}");
        let html = study.report("edof study multi-depth").unwrap().to_html();
        assert!(html.matches("three times as large").count() >= 6, "a depth may have no room for a part");
        assert!(html.contains("17.95") && html.contains("edof study multi-depth"));
    }

    #[test]
    fn a_study_stops_when_asked() {
        let mut told = 0;
        let stopped = study(|_| {
            told += 1;
            if told == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(matches!(stopped, Err(DemoError::Stopped)));
        assert_eq!(told, 3);
    }
}
