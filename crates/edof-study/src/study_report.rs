//! Reports of a file of rows, in the same formats for every study.

use crate::journal::Line;
use crate::made::Made;
use crate::report::Report;
use crate::report::csv;
use edof_optics::draw::DrawError;
use serde::Serialize;

/// A study made from its rows.
pub trait StudyReport: Serialize + Sized {
    /// What it is made from.
    type Row: Line;

    /// What rows say; `machine` names the CPU and threads that times are of.
    ///
    /// # Errors
    /// [`StudyReportError`]: rows that no study gave.
    fn new(rows: &[Self::Row], machine: String) -> Result<Self, StudyReportError>;

    /// Tables for a terminal.
    fn to_text(&self) -> String;

    /// The same as a Markdown page that states how it was made.
    fn to_markdown(&self, made: &Made) -> String;

    /// The same as a report, with plots or pictures.
    fn report(&self, command: &str) -> Report;

    /// Every row for a spreadsheet.
    fn csv(rows: &[Self::Row]) -> String {
        csv::of(rows)
    }
}

/// Rows that no study gave.
#[derive(Debug, thiserror::Error)]
pub enum StudyReportError {
    /// A scene that nothing draws.
    #[error("rows of {0}")]
    Scene(#[from] DrawError),
    /// A scene that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
}
