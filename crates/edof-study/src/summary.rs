//! What an experiment's rows say together: averages, worst depths, what fixed point and 4:2:2 cost.

use crate::kodak::Row;
use crate::plot::{Axis, Mark, Plot, Series, side_by_side};
use crate::report::Report;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Endings of a net's three methods.
const FLOAT: &str = ".float";
const FLOAT_422: &str = ".float422";
const FIXED: &str = ".fixed";

/// The whole result of an experiment, as its JSON file holds it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Study {
    /// One for each method, photograph and setting.
    pub rows: Vec<Row>,
    /// What they say together.
    pub summary: Summary,
}

/// Averages over photographs and depths.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Summary {
    /// One for each method and noise level, in the rows' order.
    pub methods: Vec<MethodSummary>,
    /// One for each net and noise level.
    pub nets: Vec<NetSummary>,
    /// What was left out or looks wrong, one line each.
    pub notes: Vec<String>,
}

/// One method at one noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodSummary {
    /// Its name.
    pub method: String,
    /// Its camera.
    pub camera: String,
    /// σ of the noise.
    pub noise: f64,
    /// Mean PSNR over photographs at each depth: pairs of ψ and dB.
    pub psi_db: Vec<[f64; 2]>,
    /// Mean over depths.
    pub average_db: f64,
    /// The worst depth's mean.
    pub worst_db: f64,
    /// Which depth that is.
    pub worst_psi: f64,
    /// Mean SSIM.
    pub ssim: f64,
    /// Mean seconds a megapixel.
    pub seconds_per_megapixel: f64,
}

/// What fixed point and 4:2:2 cost a net.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetSummary {
    /// Its name.
    pub net: String,
    /// σ of the noise.
    pub noise: f64,
    /// Mean of float − float422.
    pub mean_cost_of_422_db: f64,
    /// Largest float − float422 on any row.
    pub largest_cost_of_422_db: f64,
    /// Mean of float422 − fixed; nothing where the net has no fixed rows.
    pub mean_fixed_loss_db: Option<f64>,
    /// Largest float422 − fixed on any row.
    pub largest_fixed_loss_db: Option<f64>,
    /// Photograph and ψ of that row.
    pub largest_fixed_loss_at: Option<(String, f64)>,
}

impl Study {
    /// Rows with their summary.
    #[must_use]
    pub fn new(rows: Vec<Row>, notes: Vec<String>) -> Self {
        let summary = Summary { methods: methods(&rows), nets: nets(&rows), notes };
        Self { rows, summary }
    }

    /// JSON text.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

impl Study {
    /// The report: PSNR against depth for each noise level, and the tables; `command` tells how to make it again.
    #[must_use]
    pub fn report(&self, command: &str) -> Report {
        let mut report = Report::new("Photographs through each net's camera");
        report.paragraph(&format!("Made by `{command}`."));
        self.summary.notes.iter().for_each(|note| {
            report.paragraph(note);
        });
        report.heading("PSNR at each depth");
        report.plot(&side_by_side(&self.summary.plots()));
        report.heading("Averages over photographs and depths");
        let header = ["method", "camera", "noise", "average dB", "worst dB", "at ψ", "SSIM", "s/megapixel"];
        let rows: Vec<Vec<String>> = self
            .summary
            .methods
            .iter()
            .map(|m| {
                let numbers =
                    [m.noise.to_string(), format!("{:.2}", m.average_db), format!("{:.2}", m.worst_db)];
                let rest = [
                    m.worst_psi.to_string(),
                    format!("{:.4}", m.ssim),
                    format!("{:.4}", m.seconds_per_megapixel),
                ];
                [m.method.clone(), m.camera.clone()].into_iter().chain(numbers).chain(rest).collect()
            })
            .collect();
        report.table(&header, &rows);
        report
    }
}

impl Summary {
    /// PSNR against ψ, one diagram for each noise level; solid lines are float, dotted ones fixed point, dashed ones the rest.
    /// `float422` is left out: it lies on the fixed line.
    #[must_use]
    pub fn plots(&self) -> Vec<Plot> {
        let noises = sorted(self.methods.iter().map(|m| m.noise));
        let lines = |noise: f64| {
            let own = self.methods.iter().filter(move |m| m.noise == noise && !m.method.ends_with(FLOAT_422));
            own.map(|m| {
                let mark = if m.method.ends_with(FLOAT) {
                    Mark::LineAndPoints
                } else if m.method.ends_with(FIXED) {
                    Mark::Dotted
                } else {
                    Mark::Dashed
                };
                Series::new(&m.method, mark, m.psi_db.iter().copied())
            })
        };
        noises
            .into_iter()
            .map(|noise| Plot {
                title: format!("noise {noise}"),
                x: Axis::linear("ψ (rad)"),
                y: Axis::linear("PSNR (dB)"),
                series: lines(noise).collect(),
            })
            .collect()
    }

    /// Tables for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        let width = self.methods.iter().map(|m| m.method.len()).max().unwrap_or(0).max("method".len());
        let farthest =
            self.methods.iter().flat_map(|m| &m.psi_db).map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        let mut text = format!(
            "{:width$}  {:>6}  {:>8}  {:>8}  {:>8}  {:>4}  {:>6}  {:>7}\n",
            "method",
            "noise",
            "average",
            format!("psi {farthest}"),
            "worst",
            "at",
            "SSIM",
            "s/MP"
        );
        for m in &self.methods {
            let far = m.psi_db.iter().find(|p| p[0] == farthest).map_or(f64::NAN, |p| p[1]);
            let _ = writeln!(
                text,
                "{:width$}  {:>6}  {:>8.3}  {far:>8.3}  {:>8.3}  {:>4}  {:>6.4}  {:>7.4}",
                m.method, m.noise, m.average_db, m.worst_db, m.worst_psi, m.ssim, m.seconds_per_megapixel
            );
        }
        if !self.nets.is_empty() {
            text.push('\n');
        }
        for n in &self.nets {
            let _ = write!(
                text,
                "{}, noise {}: 4:2:2 costs {:.3} dB (at most {:.3})",
                n.net, n.noise, n.mean_cost_of_422_db, n.largest_cost_of_422_db
            );
            if let (Some(mean), Some(largest), Some((image, psi))) =
                (n.mean_fixed_loss_db, n.largest_fixed_loss_db, &n.largest_fixed_loss_at)
            {
                let _ = write!(
                    text,
                    "; fixed point loses {mean:.4} dB in that format, at most {largest:.4} ({image}, psi {psi})"
                );
            }
            text.push('\n');
        }
        text
    }
}

/// Summaries in the order in which methods first appear, noise levels ascending.
fn methods(rows: &[Row]) -> Vec<MethodSummary> {
    let mut order: Vec<&str> = vec![];
    for row in rows {
        if !order.contains(&row.method.as_str()) {
            order.push(&row.method);
        }
    }
    let mut summaries = vec![];
    for method in order {
        for noise in sorted(rows.iter().filter(|r| r.method == method).map(|r| r.noise)) {
            let own: Vec<&Row> = rows.iter().filter(|r| r.method == method && r.noise == noise).collect();
            let psi_db: Vec<[f64; 2]> = sorted(own.iter().map(|r| r.psi))
                .into_iter()
                .map(|psi| [psi, mean(own.iter().filter(|r| r.psi == psi).map(|r| r.psnr_db))])
                .collect();
            let worst = psi_db.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2]);
            summaries.push(MethodSummary {
                method: method.to_owned(),
                camera: own[0].camera.clone(),
                noise,
                average_db: mean(psi_db.iter().map(|p| p[1])),
                worst_db: worst[1],
                worst_psi: worst[0],
                psi_db,
                ssim: mean(own.iter().map(|r| r.ssim)),
                seconds_per_megapixel: mean(own.iter().map(|r| r.seconds_per_megapixel)),
            });
        }
    }
    summaries
}

fn nets(rows: &[Row]) -> Vec<NetSummary> {
    type Key<'a> = (&'a str, &'a str, u64, u64);
    let key = |r: &'_ Row| -> (u64, u64) { (r.psi.to_bits(), r.noise.to_bits()) };
    let found: BTreeMap<Key<'_>, &Row> =
        rows.iter().map(|r| ((r.method.as_str(), r.image.as_str(), key(r).0, key(r).1), r)).collect();
    let mut names: Vec<&str> = vec![];
    for net in rows.iter().filter_map(|r| r.method.strip_suffix(FLOAT)) {
        if !names.contains(&net) {
            names.push(net);
        }
    }
    let mut summaries = vec![];
    for net in names {
        let (float, float422, fixed) =
            (format!("{net}{FLOAT}"), format!("{net}{FLOAT_422}"), format!("{net}{FIXED}"));
        for noise in sorted(rows.iter().filter(|r| r.method == float).map(|r| r.noise)) {
            let own = rows.iter().filter(|r| r.method == float && r.noise == noise);
            let pairs: Vec<(&Row, &Row, Option<&Row>)> = own
                .filter_map(|r| {
                    let twin =
                        |method: &str| found.get(&(method, r.image.as_str(), key(r).0, key(r).1)).copied();
                    Some((r, twin(&float422)?, twin(&fixed)))
                })
                .collect();
            if pairs.is_empty() {
                continue;
            }
            let cost: Vec<f64> = pairs.iter().map(|(f, g, _)| f.psnr_db - g.psnr_db).collect();
            let losses: Vec<(f64, &Row)> =
                pairs.iter().filter_map(|(_, g, x)| x.map(|x| (g.psnr_db - x.psnr_db, x))).collect();
            let largest = losses.iter().max_by(|a, b| a.0.total_cmp(&b.0));
            summaries.push(NetSummary {
                net: net.to_owned(),
                noise,
                mean_cost_of_422_db: mean(cost.iter().copied()),
                largest_cost_of_422_db: cost.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                mean_fixed_loss_db: (!losses.is_empty()).then(|| mean(losses.iter().map(|l| l.0))),
                largest_fixed_loss_db: largest.map(|l| l.0),
                largest_fixed_loss_at: largest.map(|l| (l.1.image.clone(), l.1.psi)),
            });
        }
    }
    summaries
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &str, image: &str, psi: f64, noise: f64, psnr_db: f64) -> Row {
        Row {
            method: method.into(),
            camera: "clear".into(),
            image: image.into(),
            psi,
            noise,
            stride: 8,
            psnr_db,
            ssim: 0.9,
            seconds_per_megapixel: 1.0,
            psnr_clipped_db: psnr_db,
            channel_psnr_db: [psnr_db; 3],
            luma_psnr_db: psnr_db,
            luma_ssim: 0.9,
        }
    }

    #[test]
    fn averages_run_over_photos_then_depths() {
        let study = Study::new(
            vec![
                row("a", "p1", 0.0, 0.0, 30.0),
                row("a", "p2", 0.0, 0.0, 34.0),
                row("a", "p1", 8.0, 0.0, 28.0),
                row("a", "p2", 8.0, 0.0, 30.0),
            ],
            vec![],
        );
        let m = &study.summary.methods[0];
        assert_eq!(m.psi_db, [[0.0, 32.0], [8.0, 29.0]]);
        assert_eq!((m.average_db, m.worst_db, m.worst_psi), (30.5, 29.0, 8.0));
    }

    #[test]
    fn the_largest_loss_of_fixed_point_is_that_of_a_single_row() {
        let mut rows = vec![];
        for (image, loss) in [("p1", 0.001), ("p2", 0.015), ("p3", -0.002)] {
            rows.push(row("n.float", image, 8.0, 0.01, 34.0));
            rows.push(row("n.float422", image, 8.0, 0.01, 33.5));
            rows.push(row("n.fixed", image, 8.0, 0.01, 33.5 - loss));
        }
        let n = &Study::new(rows, vec![]).summary.nets[0];
        assert!((n.largest_fixed_loss_db.unwrap() - 0.015).abs() < 1e-9);
        assert_eq!(n.largest_fixed_loss_at, Some(("p2".into(), 8.0)));
        assert!((n.mean_cost_of_422_db - 0.5).abs() < 1e-9);
    }

    #[test]
    fn a_net_without_fixed_rows_says_so() {
        let rows = vec![row("n.float", "p", 0.0, 0.0, 34.0), row("n.float422", "p", 0.0, 0.0, 33.9)];
        let study = Study::new(rows, vec!["n: no fixed file".into()]);
        assert_eq!(study.summary.nets[0].largest_fixed_loss_db, None);
        assert!(!study.summary.to_text().contains("fixed point"));
    }

    #[test]
    fn the_report_draws_one_line_a_method_and_noise() {
        let rows = vec![
            row("n.float", "p", 0.0, 0.0, 34.0),
            row("n.float422", "p", 0.0, 0.0, 34.0),
            row("n.fixed", "p", 0.0, 0.0, 34.0),
            row("n.float", "p", 0.0, 0.01, 34.0),
        ];
        let study = Study::new(rows, vec!["a note".into()]);
        let drawn: Vec<usize> = study.summary.plots().iter().map(|p| p.series.len()).collect();
        assert_eq!(drawn, [2, 1]);
        let html = study.report("edof study").to_html();
        assert!(html.contains("a note") && html.contains("edof study") && html.matches("<tr>").count() == 5);
    }

    #[test]
    fn the_json_is_an_object_with_rows_that_reads_back() {
        let study = Study::new(vec![row("a", "p", 0.0, 0.0, 30.0)], vec![]);
        let value: serde_json::Value = serde_json::from_str(&study.to_json()).unwrap();
        for field in ["method", "image", "psi", "noise", "stride", "psnr_db", "ssim", "seconds_per_megapixel"]
        {
            assert!(value["rows"][0].get(field).is_some(), "{field}");
        }
        let back: Study = serde_json::from_str(&study.to_json()).unwrap();
        assert_eq!(back.rows, study.rows);
    }
}
