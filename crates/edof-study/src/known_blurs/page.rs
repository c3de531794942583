//! What the rows say.

use super::Row;
use crate::made::Made;
use crate::metrics::paired::Paired;
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::summary;
use edof_core::words::count;
use edof_io::photos::choices;
use serde::Serialize;
use std::collections::BTreeSet;

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
    #[serde(rename = "least_gain_db")]
    pub min_gain_db: f64,
    /// Mean correlation of kernels.
    pub mean_correlation: f64,
    /// The least.
    #[serde(rename = "least_correlation")]
    pub min_correlation: f64,
    /// How many pictures have lost more than [`DIVERGED_DB`].
    pub diverged: usize,
    /// CPU and threads that times are of.
    pub machine: String,
}

/// A picture that has lost more than this many dB has diverged.
pub const DIVERGED_DB: f64 = 1.0;

const TITLE: &str = "Blind deconvolution of synthetic blurs";

impl StudyReport for KnownBlurs {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, StudyReportError> {
        let mean = |of: fn(&Row) -> f64| summary::mean(rows.iter().map(of));
        let min = |of: fn(&Row) -> f64| rows.iter().map(of).fold(f64::INFINITY, f64::min);
        let gain = |row: &Row| row.restored_db - row.blurred_db;
        let of_photo =
            |image: &String| summary::mean(rows.iter().filter(|row| row.image == *image).map(gain));
        let photos: BTreeSet<&String> = rows.iter().map(|row| &row.image).collect();
        Ok(Self {
            mean_gain_db: mean(gain),
            gain: Paired::of(&photos.into_iter().map(of_photo).collect::<Vec<_>>()),
            mean_known_gain_db: mean(|row| row.known_db - row.blurred_db),
            min_gain_db: min(gain),
            mean_correlation: mean(|row| row.correlation),
            min_correlation: min(|row| row.correlation),
            diverged: rows.iter().filter(|row| gain(row) < -DIVERGED_DB).count(),
            rows: rows.to_vec(),
            machine,
        })
    }

    fn to_text(&self) -> String {
        format!("{}{} {}", self.table().to_text(), self.verdict(), self.method())
    }

    fn to_markdown(&self, made: &Made) -> String {
        let (verdict, method) = (self.verdict(), self.method());
        format!("# {TITLE}\n\n{made}\n\n{verdict} {method}\n\n{}", self.table().to_markdown())
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.verdict(&self.verdict()).made_by(command).method(&self.method());
        self.table().add_to(&mut report, &[]);
        report
    }
}

impl KnownBlurs {
    fn verdict(&self) -> String {
        format!(
            "Over {} of {}: {} dB on average (with the true kernel {:+.2}), the least {:+.2} dB; kernels correlate by {:.3} on \
             average, at least by {:.3}. Lost more than {DIVERGED_DB} dB: {}.",
            count(self.rows.len(), "synthetic blur"),
            count(self.rows.iter().map(|row| &row.image).collect::<BTreeSet<_>>().len(), "photograph"),
            self.gain.map_or_else(|| "–".to_owned(), |gain| gain.to_string()),
            self.mean_known_gain_db,
            self.min_gain_db,
            self.mean_correlation,
            self.min_correlation,
            match self.diverged {
                0 => "none".to_owned(),
                count => count.to_string(),
            },
        )
    }

    fn method(&self) -> String {
        format!(
            "Seconds are wall-clock and of all threads together on {}.{}",
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
            "seconds per megapixel",
            "CPU seconds per megapixel",
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
