//! Which layer's bits matter: dB lost against the bits of one stage, of all, and the fewest that lose next to nothing.

use crate::made::Made;
use crate::metrics::{BORDER, MetricError, psnr};
use crate::report::Report;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::table::{markdown_row, markdown_rule};
use edof_core::ColourFrame;
use edof_network::FixedNetwork;
use edof_network::fixed_network::layer_names;
use edof_optics::draw::{Builtin, DrawError, draw};
use edof_quantize::stage_bits::{MIN, StageBitsError, fewest, mean_db, with_stage_bits};
use edof_quantize::{Scene, capture};
use serde::Serialize;
use std::fmt::Write;

/// Synthetic scenes, and their size.
const SCENES: u64 = 2;
const SIZE: (usize, usize) = (160, 240);
/// Of their captures, at nine depths with and without noise, one in N is judged.
const EVERY: usize = 5;

/// Losses up to this many dB are in the diagram of gains.
const SMALL_DB: f64 = 0.02;

/// What bits are worth to one network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bits {
    /// Name of the network.
    pub network: String,
    /// Stages: I, M1, …, F.
    pub stages: Vec<String>,
    /// One stage with fewer bits, and all of them.
    pub points: Vec<Point>,
    /// Bits of each stage that lose no more than was allowed together.
    pub fewest: Vec<u32>,
    /// dB that they lose.
    pub fewest_lost_db: f64,
    /// dB that were allowed.
    pub allowed_db: f64,
    /// Frames judged.
    pub frames: usize,
}

/// One measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The stage that has fewer bits; none where all have.
    pub stage: Option<String>,
    /// Bits of its weights and results.
    pub bits: u32,
    /// dB below the network as it is.
    pub lost_db: f64,
}

/// A network that cannot be judged.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum BitsError {
    /// Synthetic scenes.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// Scenes behind its camera.
    #[error(transparent)]
    Capture(#[from] edof_optics::capture::CaptureError),
    /// Scenes and pictures that cannot be compared.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The bits of the network.
    #[error("net {network}: {source}")]
    Bits { network: String, source: StageBitsError },
}

/// A choice of bits without a PSNR.
enum Unjudged {
    Metric(MetricError),
    Bits(StageBitsError),
}

impl From<StageBitsError> for Unjudged {
    fn from(source: StageBitsError) -> Self {
        Self::Bits(source)
    }
}

/// Measures one network on synthetic scenes behind its own camera.
///
/// # Errors
/// [`BitsError`]; networks of the difference form, whose codes share a format, among them.
pub fn of(network: &str, fixed: &FixedNetwork, allowed_db: f64) -> Result<Bits, BitsError> {
    let pictures: Vec<(String, ColourFrame)> = (0..SCENES)
        .map(|seed| {
            Ok((format!("leaves-{seed}"), draw(Builtin::Leaves, SIZE.0, SIZE.1, &[0.0], seed)?.sharp()))
        })
        .collect::<Result<_, DrawError>>()?;
    let scenes: Vec<Scene<'_>> =
        capture(&pictures, &fixed.origin, usize::MAX, |_| ())?.into_iter().step_by(EVERY).collect();
    let judge =
        |sharp: &ColourFrame, picture: &ColourFrame| psnr(sharp, picture, BORDER).map_err(Unjudged::Metric);
    let db = |bits: &[u32]| mean_db(with_stage_bits(fixed, bits)?, &scenes, judge);
    let named = |unjudged| match unjudged {
        Unjudged::Metric(source) => BitsError::Metric(source),
        Unjudged::Bits(source) => BitsError::Bits { network: network.to_owned(), source },
    };
    let names = layer_names(fixed.form.layers).enumerate();
    let stages: Vec<String> =
        names.map(|(i, n)| if n == "M" { format!("M{i}") } else { n.to_owned() }).collect();
    let all = vec![fixed.code_bits; stages.len()];
    let whole = db(&all).map_err(named)?;
    let mut points = vec![];
    for bits in MIN..=fixed.code_bits {
        for (index, stage) in stages.iter().enumerate() {
            let mut own = all.clone();
            own[index] = bits;
            let lost_db = whole - db(&own).map_err(named)?;
            points.push(Point { stage: Some(stage.clone()), bits, lost_db });
        }
        let lost_db = whole - db(&vec![bits; stages.len()]).map_err(named)?;
        points.push(Point { stage: None, bits, lost_db });
    }
    let (fewest, fewest_lost_db) = fewest(fixed.code_bits, stages.len(), allowed_db, db).map_err(named)?;
    let frames = scenes.len();
    Ok(Bits { network: network.to_owned(), stages, points, fewest, fewest_lost_db, allowed_db, frames })
}

impl Bits {
    fn lost(&self, stage: Option<&str>, bits: u32) -> f64 {
        let found = self.points.iter().find(|p| p.stage.as_deref() == stage && p.bits == bits);
        found.map_or(f64::NAN, |point| point.lost_db)
    }

    fn max_bits(&self) -> u32 {
        self.points.iter().map(|point| point.bits).max().unwrap_or(0)
    }

    /// The fewest bits, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let each: Vec<String> =
            self.stages.iter().zip(&self.fewest).map(|(s, b)| format!("{s} {b}")).collect();
        format!(
            "{}: {} bits lose {:.4} dB together, of {} allowed ({} frames)",
            self.network,
            each.join(", "),
            self.fewest_lost_db,
            self.allowed_db,
            self.frames
        )
    }

    /// The fewest bits, as a row of a table.
    fn fewest_row(&self) -> Vec<String> {
        let bits = self.fewest.iter().map(u32::to_string);
        let ends = [format!("{:.4}", self.fewest_lost_db), self.frames.to_string()];
        std::iter::once(self.network.clone()).chain(bits).chain(ends).collect()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        (MIN..=self.max_bits())
            .rev()
            .map(|bits| {
                let each = self.stages.iter().map(|stage| self.lost(Some(stage), bits));
                let losses = each.chain([self.lost(None, bits)]).map(|db| format!("{db:.4}"));
                std::iter::once(bits.to_string()).chain(losses).collect()
            })
            .collect()
    }

    fn header(&self) -> Vec<String> {
        let stages = self.stages.iter().map(|stage| format!("{stage} alone"));
        std::iter::once("bits".to_owned()).chain(stages).chain(["all".to_owned()]).collect()
    }

    /// Stage by stage and for all, the points that `shown` takes.
    fn series(&self, shown: impl Fn(f64) -> bool) -> Vec<Series> {
        let line = |label: &str, stage: Option<&str>| {
            let points = (MIN..=self.max_bits()).map(|bits| [f64::from(bits), self.lost(stage, bits)]);
            Series::new(label, Mark::LineAndPoints, points.filter(|[_, db]| shown(*db)))
        };
        let stages = self.stages.iter().map(|stage| line(stage, Some(stage)));
        stages.chain([line("all", None)]).collect()
    }

    /// Losses in decades, and what is next to nothing, gains among it, on a linear scale.
    fn plots(&self) -> [Plot; 2] {
        let whole = Plot {
            title: self.network.clone(),
            x: Axis::linear("bits of weights and results"),
            y: Axis::log("dB lost"),
            size: SMALL,
            // Below a ten-thousandth of a dB rounding goes either way.
            series: self.series(|db| db >= 1e-4),
        };
        let near = Plot {
            title: format!("{}: gains, and losses up to {SMALL_DB} dB", self.network),
            x: Axis::linear("bits of weights and results"),
            y: Axis::linear("dB lost; below 0 gained"),
            size: SMALL,
            series: self.series(|db| db <= SMALL_DB),
        };
        [whole, near]
    }

    /// Where fewer bits gain, in words.
    fn gains(&self) -> Option<String> {
        let own = self.points.iter().filter(|point| point.lost_db < 0.0);
        let worst = own.clone().min_by(|a, b| a.lost_db.total_cmp(&b.lost_db))?;
        let who = worst.stage.as_deref().unwrap_or("all");
        Some(format!(
            "{}: {} of {} points gain, which the second diagram alone shows; the most is {:.4} dB, {who} at {} bits.",
            self.network,
            own.count(),
            self.points.len(),
            -worst.lost_db,
            worst.bits
        ))
    }
}

/// Networks of the same stages and the same allowed loss, the first ones first.
fn alike(all: &[Bits]) -> Vec<Vec<&Bits>> {
    let mut groups: Vec<Vec<&Bits>> = vec![];
    for bits in all {
        let same = |group: &&mut Vec<&Bits>| {
            (&group[0].stages, group[0].allowed_db) == (&bits.stages, bits.allowed_db)
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(bits),
            None => groups.push(vec![bits]),
        }
    }
    groups
}

/// A sentence for all networks of the same stages: the bits that each stage needs.
fn summary(all: &[Bits]) -> Vec<String> {
    let sentence = |group: Vec<&Bits>| {
        let stage = |(index, stage): (usize, &String)| {
            let needed = || group.iter().filter_map(|bits| bits.fewest.get(index));
            let (min, max) = (needed().min().unwrap_or(&0), needed().max().unwrap_or(&0));
            if min == max { format!("{stage} {min}") } else { format!("{stage} {min} to {max}") }
        };
        let stages: Vec<String> = group[0].stages.iter().enumerate().map(stage).collect();
        format!(
            "With {} dB allowed, {} these bits: {}.",
            group[0].allowed_db,
            if group.len() == 1 {
                format!("{} needs", group[0].network)
            } else {
                format!("{} networks need", group.len())
            },
            stages.join(", ")
        )
    };
    alike(all).into_iter().map(sentence).collect()
}

/// Tables of all networks.
#[must_use]
pub fn to_markdown(all: &[Bits], made: &Made) -> String {
    let mut text =
        format!("# Bits of single stages\n\n{made}\n\ndB lost where a stage, or all, have fewer bits.\n");
    for bits in all {
        let header = bits.header();
        let _ =
            write!(text, "\n{}.\n\n{}{}", bits.verdict(), markdown_row(&header), markdown_rule(header.len()));
        bits.rows().iter().for_each(|row| text.push_str(&markdown_row(row)));
    }
    text
}

/// A page of all networks.
#[must_use]
pub fn report(all: &[Bits], command: &str) -> Report {
    let mut report = Report::new("Which layer's bits matter");
    summary(all).iter().for_each(|sentence| {
        report.verdict(sentence);
    });
    report.made_by(command).paragraph(
        "Weights of a stage are multiples of a power of two, and its results have as many bits fewer, in the range that they had; F's \
         results keep their 16. Synthetic scenes behind each network's own camera.",
    );
    report.heading("The fewest bits of each network");
    for own in alike(all) {
        let header = own[0].stages.iter().map(String::as_str);
        let header: Vec<&str> =
            ["network"].into_iter().chain(header).chain(["dB lost together", "frames"]).collect();
        report.table(&header, &own.iter().map(|bits| bits.fewest_row()).collect::<Vec<_>>(), &[]);
    }
    report.plots(&all.iter().flat_map(Bits::plots).collect::<Vec<_>>());
    all.iter().filter_map(Bits::gains).for_each(|gains| {
        report.paragraph(&gains);
    });
    for bits in all {
        let header = bits.header();
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        report.heading(&bits.network).table(&header, &bits.rows(), &[]);
    }
    report
}
