//! What rows of knobs say together: a curve for each.

use super::{KNOBS, Knob, Row};
use crate::made::Made;
use crate::metrics::paired::Paired;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::summary;
use crate::verdict::listed;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// One value of a knob, averaged over photographs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Which knob.
    pub knob: &'static Knob,
    /// Where it stands.
    pub value: f64,
    /// Whether that is its default.
    pub is_default: bool,
    /// Photographs.
    pub photos: usize,
    /// Mean PSNR in dB.
    pub psnr_db: f64,
    /// That less the default's, on the photographs of both; none where the default was not measured.
    pub to_default: Option<Paired>,
    /// Mean seconds per megapixel.
    pub seconds_per_megapixel: f64,
    /// Sides in pixels of the smallest and the largest kernel, where the knob is one of capturing.
    pub kernel_sides: Option<[usize; 2]>,
}

/// All curves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Knobs {
    /// Knob by knob, values ascending.
    pub points: Vec<Point>,
    /// CPU and threads that all times are of.
    pub machine: String,
}

/// PSNR of each photograph's row.
fn by_photo(rows: &[Row], own: impl Fn(&Row) -> bool) -> BTreeMap<String, f64> {
    rows.iter().filter(|row| own(row)).map(|row| (row.image.clone(), row.psnr_db)).collect()
}

/// The smallest and the largest of both.
fn widest(a: [usize; 2], b: [usize; 2]) -> [usize; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

const TITLE: &str = "What can be left out: speed against error";

impl StudyReport for Knobs {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, StudyReportError> {
        let mut points: Vec<Point> = vec![];
        for row in rows {
            let same = |other: &&Row| other.knob == row.knob && other.value == row.value;
            if points.iter().any(|p| p.knob == row.knob && p.value == row.value) {
                continue;
            }
            let own: Vec<&Row> = rows.iter().filter(same).collect();
            let mean = |of: fn(&Row) -> f64| summary::mean(own.iter().map(|row| of(row)));
            points.push(Point {
                knob: row.knob,
                value: row.value,
                is_default: row.is_default,
                photos: own.len(),
                psnr_db: mean(|row| row.psnr_db),
                to_default: Paired::between(
                    &by_photo(rows, |other| other.knob == row.knob && other.value == row.value),
                    &by_photo(rows, |other| other.knob == row.knob && other.is_default),
                ),
                seconds_per_megapixel: mean(|row| row.seconds_per_megapixel),
                kernel_sides: own.iter().filter_map(|row| row.kernel_sides).reduce(widest),
            });
        }
        Ok(Self { points, machine })
    }

    fn to_text(&self) -> String {
        let mut text = String::new();
        self.verdict().iter().for_each(|verdict| text += &format!("{verdict}\n"));
        text.push('\n');
        for (knob, table) in self.tables() {
            let _ = write!(text, "{}\n{}\n", knob.name, table.to_text());
        }
        text.trim_end().to_owned()
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{}{}\n", listed(&self.verdict()), self.explanation());
        for (knob, table) in self.tables() {
            let _ = write!(page, "\n## {}\n\n{}\n\n{}", knob.name, knob.why, table.to_markdown());
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        self.verdict().iter().for_each(|verdict| {
            report.verdict(verdict);
        });
        report.paragraph(&self.explanation()).made_by(command);
        for (knob, table) in self.tables() {
            report.heading(knob.name).paragraph(knob.why).plots(&[self.plot(knob)]);
            table.add_to(&mut report, &[]);
        }
        report
    }
}

impl Knobs {
    fn explanation(&self) -> String {
        format!(
            "Each curve turns one knob and leaves all others where they stand; its default is marked, and the text says why it is there. Photographs' numbers are \
             taken for light. PSNR over red, green and blue, peak 1, border 8 cropped: of the light on the sensor against an exact computation for knobs of \
             capturing, of the picture against the photograph for all others; differences to the default are paired by photograph, with the standard error of their \
             mean. Time is wall-clock on {}, for kernels and blur or for reconstruction.",
            self.machine
        )
    }

    fn tables(&self) -> Vec<(&'static Knob, Table)> {
        let of = |knob: &'static Knob| {
            let own = || self.points.iter().filter(move |p| *p.knob == *knob);
            let has_kernels = own().any(|p| p.kernel_sides.is_some());
            let row = |p: &Point| {
                let mark = if p.is_default { "default" } else { "" };
                let value = p.value.to_string();
                let mut cells = vec![
                    value,
                    mark.into(),
                    format!("{:.2}", p.psnr_db),
                    match p.to_default {
                        Some(paired) if !p.is_default => paired.to_string(),
                        _ => "–".to_owned(),
                    },
                    format!("{:.4}", p.seconds_per_megapixel),
                    p.photos.to_string(),
                ];
                let sides = p.kernel_sides.map(|[min, max]| format!("{min} to {max}"));
                cells.extend(has_kernels.then(|| sides.unwrap_or_else(|| "–".to_owned())));
                cells
            };
            let header = [knob.unit, "", "PSNR dB", "to the default", "seconds per megapixel", "photos"];
            let kernels = has_kernels.then_some("kernels, pixels");
            let header = header.into_iter().chain(kernels).map(str::to_owned).collect();
            (knob, Table { header, rows: own().map(row).collect() })
        };
        KNOBS.iter().map(of).filter(|(_, table)| !table.rows.is_empty()).collect()
    }

    /// PSNR against time, or against the knob where it does not change the time: the curve, and its default.
    fn plot(&self, knob: &Knob) -> Plot {
        let own = || self.points.iter().filter(move |p| *p.knob == *knob);
        // The time of one photograph is one measurement: no curve.
        let has_time = knob.takes_time && own().any(|p| p.photos > 1);
        let at = |p: &Point| [if has_time { p.seconds_per_megapixel } else { p.value }, p.psnr_db];
        let each = own().map(|p| {
            let label = format!("{} {}", p.value, if p.is_default { "(default)" } else { "" });
            let series = Series::new(label.trim(), Mark::Points, [at(p)]).named_at_points();
            if p.is_default { series.coloured("#d55e00") } else { series.coloured("#0072b2") }
        });
        let curve = Series::new("", Mark::Line, own().map(at)).coloured("#999999");
        Plot {
            title: knob.unit.into(),
            x: if has_time { Axis::log("seconds per megapixel") } else { Axis::linear(knob.unit) },
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: std::iter::once(curve).chain(each).collect(),
        }
    }
}
