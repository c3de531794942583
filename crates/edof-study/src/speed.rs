//! What a study of one depth says: error and time of each method, and what the paper says of both.

mod claims;
mod latex;
mod verdict;

pub use claims::Claim;

use crate::made::Made;
use crate::methods::method::{Family, Format, Method};
use crate::metrics::paired::{Paired, with_error};
use crate::metrics::quality::{Means, Quality, cell, columns};
use crate::report::plot::{Axis, Mark, PALETTE, Plot, Series, Shape, stacked};
use crate::report::{Report, Table};
use crate::single_depth::Row;
use crate::study_report::{StudyReport, StudyReportError};
use crate::summary;
use crate::tables::{noise_words, psi_words};
use crate::trial::Measured;
use crate::verdict::listed;
use claims::all_claims;
use edof_core::{Noise, Tone};
use edof_io::photos::choices;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// One method at one depth and noise level, averaged over photographs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Short name of the method, with its stride.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Depth.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What photographs' numbers were taken for.
    pub tone: Tone,
    /// Photographs.
    pub photos: usize,
    /// Mean PSNR in dB.
    pub psnr_db: f64,
    /// The same of each photograph.
    pub photo_psnr_db: BTreeMap<String, f64>,
    /// Means of the metrics that tables show.
    #[serde(flatten)]
    pub means: Means,
    /// Mean wall-clock seconds per megapixel.
    pub seconds_per_megapixel: f64,
    /// Mean seconds per megapixel that all threads together were on a processor, where all rows tell it.
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Mean steps of an iterative method, where all rows tell them.
    pub iterations: Option<f64>,
    /// Most bytes that the process held while it ran, over all photographs, where rows tell it.
    pub peak_memory_bytes: Option<u64>,
    /// Seconds of preparation for the case.
    pub prepare_seconds: f64,
    /// Mean non-zeros of a patch, after each shrinkage or of its code.
    pub nonzeros_a_patch: Option<Vec<f64>>,
}

/// The points of a study, and how they were made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Speed {
    /// Averages, in the rows' order.
    pub points: Vec<Point>,
    /// One list for each depth and noise level.
    pub claims: Vec<Claims>,
    /// CPU and threads that all times are of.
    pub machine: String,
}

/// The paper's claims at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claims {
    /// Depth.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What photographs' numbers were taken for.
    pub tone: Tone,
    /// One each.
    pub claims: Vec<Claim>,
}

impl StudyReport for Speed {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, StudyReportError> {
        let mut points: Vec<Point> = vec![];
        for row in rows {
            if !points.iter().any(|point| point.is_of(row)) {
                points.push(Point::of(rows, row));
            }
        }
        let mut claims: Vec<Claims> = vec![];
        for point in &points {
            if !claims.iter().any(|c| c.hold(point)) {
                let Point { psi, noise, tone, .. } = *point;
                let mut all = Claims { psi, noise, tone, claims: vec![] };
                all.claims = all_claims(&points.iter().filter(|p| all.hold(p)).collect::<Vec<_>>());
                claims.push(all);
            }
        }
        Ok(Self { points, claims, machine })
    }

    fn to_text(&self) -> String {
        let mut text = String::new();
        self.verdict().iter().for_each(|verdict| text += &format!("{verdict}\n\n"));
        for (title, tables) in self.tables() {
            for table in tables {
                let _ = write!(text, "{title}\n{}\n", table.to_text());
            }
        }
        text.trim_end().to_owned()
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{}{}\n", listed(&self.verdict()), self.explanation());
        for (title, tables) in self.tables() {
            let _ = write!(page, "\n## {title}\n");
            tables.iter().for_each(|table| page.push_str(&format!("\n{}", table.to_markdown())));
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        self.verdict().iter().for_each(|verdict| {
            report.verdict(verdict);
        });
        report.made_by(command).method(&self.explanation());
        for ((title, tables), claims) in self.tables().into_iter().zip(&self.claims) {
            report.heading(&title);
            report.plots(&[self.plot(claims)]);
            if let Some(note) = self.left_out(claims) {
                report.paragraph(&note);
            }
            tables.iter().for_each(|table| table.add_to(&mut report, &[]));
        }
        report
    }
}

impl Speed {
    /// The diagrams of all depths and noise levels, below each other in one SVG.
    #[must_use]
    pub fn diagrams(&self) -> String {
        stacked(&self.claims.iter().map(|claims| self.plot(claims)).collect::<Vec<_>>())
    }

    fn explanation(&self) -> String {
        let photos = self.points.iter().map(|p| p.photos).max().unwrap_or(0);
        format!(
            "Means over {photos} photographs, of PSNR with the standard error; differences are paired by photograph, with that of their mean.{} PSNR in dB over red, green and blue, peak 1, border 8 cropped: of light, the method's values not clipped, where a \
             photograph's numbers are taken for it; of the encoded picture, clipped to 0…1, where they are decoded (“real light”). Time is wall-clock on {}, all threads, without preparation, which is done once for a camera, a depth \
             and a noise level and stands beside it: kernels, dictionaries and what follows from them. CPU seconds are those that all threads together \
             were on a processor: what else the machine did is not in them. Steps are those of iterative methods, mean over patches or colours. Memory is the most that \
             the process held, photographs and the other methods included. NAME/s4 is a method of patches at \
             stride 4; a network's fixed rows are the board's integers in software. untrained-tT is what the paper trains from: ISTA in the pursuits' \
             dictionary, all depths in one, cut off after T − 1 shrinkages. NAME.board is \
             the board: cycles of these very frames by the cycle model at the clock that is planned for it, which is no measured time.",
            choices(self.points.iter().flat_map(|p| p.photo_psnr_db.keys()).map(String::as_str)),
            self.machine
        )
    }

    /// Title, averages and what there is of claims, for each depth and noise level.
    fn tables(&self) -> Vec<(String, Vec<Table>)> {
        let of = |c: &Claims| {
            let own = self.points.iter().filter(|p| c.hold(p));
            let claims = (!c.claims.is_empty()).then(|| claims_table(&c.claims));
            (c.title(), std::iter::once(averages(own)).chain(claims).collect())
        };
        self.claims.iter().map(of).collect()
    }

    /// PSNR against time; the strides of one method are joined, and the layers of untrained networks.
    fn plot(&self, of: &Claims) -> Plot {
        let min = self.floor(of);
        let shown = |p: &&Point| of.hold(p) && min.is_none_or(|min| p.psnr_db >= min);
        let mut series: Vec<Series> = vec![];
        for point in self.points.iter().filter(shown) {
            let label = if point.identity.is_untrained() {
                name(&Method { layers: None, ..point.identity.clone() })
            } else {
                point.identity.to_string()
            };
            let at = [point.cost(), point.psnr_db];
            match series.iter_mut().find(|s| s.label == label) {
                Some(series) => series.points.push(at),
                None => {
                    let new = Series::new(label, Mark::LineAndPoints, [at]).named_at_points();
                    let new = new.coloured(self.colour(&point.identity));
                    series.push(new.shaped(shape(&point.identity)));
                }
            }
        }
        // From cheap to dear: strides come in the order of their keys.
        series.iter_mut().for_each(|s| s.points.sort_by(|a, b| a[0].total_cmp(&b[0])));
        let axis = Axis::linear("PSNR (dB)");
        Plot {
            title: format!("Error against speed: {}", of.title()),
            x: Axis::log(self.cost_in_words()),
            y: min.map_or_else(|| axis.clone(), |min| axis.clone().from(min)),
            size: [900.0, 540.0],
            series,
        }
    }

    /// Whether CPU seconds are known of any method.
    fn has_cpu_seconds(&self) -> bool {
        self.points.iter().any(|p| p.cpu_seconds_per_megapixel.is_some())
    }

    /// What [`Point::cost`] is.
    fn cost_in_words(&self) -> &'static str {
        if self.has_cpu_seconds() {
            "CPU seconds per megapixel, all threads; .board: cycles at the planned clock"
        } else {
            "seconds per megapixel"
        }
    }

    /// PSNR at which a diagram begins. Untrained networks may be so far below that all others would be one point.
    fn floor(&self, of: &Claims) -> Option<f64> {
        let own = || self.points.iter().filter(|p| of.hold(p));
        let of_trained = own().filter(|p| !p.identity.is_untrained()).map(|p| p.psnr_db).reduce(f64::min)?;
        let near = own().map(|p| p.psnr_db).filter(|db| *db >= of_trained - FAR_BELOW_DB);
        near.reduce(f64::min).map(|min| (min - 0.5).floor())
    }

    /// What a diagram does not show, in a sentence.
    fn left_out(&self, of: &Claims) -> Option<String> {
        let floor = self.floor(of)?;
        let own = self.points.iter().filter(|p| of.hold(p) && p.psnr_db < floor);
        let each: Vec<String> = own.map(|p| format!("{} ({:.1} dB)", p.method, p.psnr_db)).collect();
        (!each.is_empty())
            .then(|| format!("Not in the diagram, which begins at {floor} dB: {}.", each.join(", ")))
    }

    /// One for each network, and one for each kind of other methods.
    fn colour(&self, of: &Method) -> &'static str {
        let kind = match of.family {
            Family::DemosaicMalvar | Family::DemosaicDirectional => 6,
            Family::Wiener | Family::RichardsonLucy | Family::HyperLaplacian => 3,
            Family::BlindDeconvolution => 1,
            Family::Omp | Family::OmpKnownDepth | Family::Fista | Family::FistaKnownDepth => 2,
            Family::Untrained | Family::UntrainedDcRemoved => 7,
            Family::External => 5,
            Family::Network => {
                let networks = self.points.iter().filter_map(|p| p.identity.network.as_ref());
                let first = networks.take_while(|name| of.network.as_ref() != Some(name));
                let before: BTreeSet<&String> = first.collect();
                [0, 4, 5][before.len() % 3]
            }
        };
        PALETTE[kind]
    }
}

const TITLE: &str = "Speed against error at one depth";
/// Untrained networks are left out of a diagram where they are this many dB below all others.
const FAR_BELOW_DB: f64 = 6.0;

impl Claims {
    /// Whether the times are of the same scenes as a point.
    fn hold(&self, point: &Point) -> bool {
        (self.psi.to_bits(), self.noise, self.tone) == (point.psi.to_bits(), point.noise, point.tone)
    }

    fn title(&self) -> String {
        let tone = match self.tone {
            Tone::Linear => "",
            Tone::Srgb => ", real light",
        };
        format!("ψ = {}, {}{tone}", psi_words(self.psi), noise_words(self.noise))
    }
}

impl Point {
    /// CPU seconds per megapixel, independent of other work on the machine, where they are known.
    fn cost(&self) -> f64 {
        self.cpu_seconds_per_megapixel.unwrap_or(self.seconds_per_megapixel)
    }

    /// Whether its cost is wall-clock time, as that of a program of somebody else; the board's is cycles.
    fn is_wall_clock(&self) -> bool {
        self.cpu_seconds_per_megapixel.is_none() && self.identity.format != Some(Format::Board)
    }

    /// Of the PSNR's mean over photographs.
    fn standard_error(&self) -> Option<f64> {
        let each: Vec<f64> = self.photo_psnr_db.values().copied().collect();
        Paired::of(&each)?.standard_error
    }

    fn is_of(&self, row: &Row) -> bool {
        let Measured { identity, psi, noise, tone, .. } = &row.measured;
        (&self.identity, self.psi.to_bits(), self.noise, self.tone)
            == (identity, psi.to_bits(), *noise, *tone)
    }

    fn of(rows: &[Row], like: &Row) -> Self {
        let same = |r: &&Row| {
            let of = |m: &Measured| (m.psi.to_bits(), m.noise, m.tone);
            r.measured.identity == like.measured.identity && of(&r.measured) == of(&like.measured)
        };
        let own: Vec<&Row> = rows.iter().filter(same).collect();
        let mean = |value: &dyn Fn(&Row) -> f64| summary::mean(own.iter().map(|r| value(r)));
        let identity = like.measured.identity.clone();
        let nonzeros = like.measured.work.nonzeros_a_patch.as_ref().map(|layers| {
            let layer = |t: usize| {
                mean(&|r| {
                    r.measured
                        .work
                        .nonzeros_a_patch
                        .as_ref()
                        .and_then(|n| n.get(t))
                        .copied()
                        .unwrap_or(f64::NAN)
                })
            };
            (0..layers.len()).map(layer).collect()
        });
        Self {
            method: name(&identity),
            psi: like.measured.psi,
            noise: like.measured.noise,
            tone: like.measured.tone,
            photos: own.len(),
            psnr_db: mean(&|r| r.measured.picture.psnr_db()),
            photo_psnr_db: own
                .iter()
                .map(|r| (r.measured.image.clone(), r.measured.picture.psnr_db()))
                .collect(),
            means: Quality::means(&own.iter().map(|r| r.measured.picture).collect::<Vec<_>>()),
            seconds_per_megapixel: mean(&|r| r.measured.seconds_per_megapixel),
            cpu_seconds_per_megapixel: Some(mean(&|r| r.cpu_seconds_per_megapixel.unwrap_or(f64::NAN)))
                .filter(|seconds| seconds.is_finite()),
            iterations: Some(mean(&|r| r.iterations.unwrap_or(f64::NAN))).filter(|steps| steps.is_finite()),
            peak_memory_bytes: own.iter().filter_map(|r| r.peak_memory_bytes).max(),
            prepare_seconds: mean(&|r| r.prepare_seconds),
            nonzeros_a_patch: nonzeros,
            identity,
        }
    }
}

/// Formats of one network differ by their points.
const fn shape(method: &Method) -> Shape {
    match method.format {
        Some(Format::Fixed | Format::FixedGpu) => Shape::Square,
        Some(Format::Board) => Shape::Diamond,
        _ => Shape::Disc,
    }
}

fn name(method: &Method) -> String {
    method.stride.map_or_else(|| method.to_string(), |stride| format!("{method}/s{stride}"))
}

fn averages<'a>(points: impl Iterator<Item = &'a Point>) -> Table {
    let points: Vec<&Point> = points.collect();
    let metrics = columns(points.iter().map(|p| &p.means));
    let mut header: Vec<String> = ["method", "PSNR dB"].map(str::to_owned).to_vec();
    header.extend(metrics.iter().map(|metric| metric.heading()));
    header.extend(
        [
            "seconds per megapixel",
            "CPU seconds per megapixel",
            "seconds to prepare",
            "steps",
            "memory, MiB",
            "non-zeros per patch",
            "photos",
        ]
        .map(str::to_owned),
    );
    let row = |p: &&Point| {
        let nonzeros = p
            .nonzeros_a_patch
            .as_ref()
            .map(|n| n.iter().map(|n| format!("{n:.1}")).collect::<Vec<_>>().join(" / "));
        let mut cells = vec![p.method.clone(), with_error(p.psnr_db, p.standard_error())];
        cells.extend(metrics.iter().map(|metric| cell(&p.means, metric)));
        cells.extend([
            format!("{:.3}", p.seconds_per_megapixel),
            or_dash(p.cpu_seconds_per_megapixel.map(|seconds| format!("{seconds:.3}"))),
            format!("{:.3}", p.prepare_seconds),
            or_dash(p.iterations.map(|steps| format!("{steps:.0}"))),
            or_dash(p.peak_memory_bytes.map(|bytes| (bytes >> 20).to_string())),
            or_dash(nonzeros),
            p.photos.to_string(),
        ]);
        cells
    };
    Table { header, rows: points.iter().map(row).collect() }
}

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "–".to_owned())
}

fn claims_table(claims: &[Claim]) -> Table {
    let header = ["the paper's claim", "paper", "here"].map(str::to_owned).to_vec();
    let rows = claims.iter().map(|c| vec![c.of.clone(), c.paper.to_owned(), c.here.clone()]).collect();
    Table { header, rows }
}

#[cfg(test)]
mod tests;
