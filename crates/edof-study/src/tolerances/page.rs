//! What rows of errors say together: the loss of each error, and how much of it costs [`LIMIT_DB`].

use super::{Kind, Row};
use crate::made::Made;
use crate::metrics::paired::Paired;
use crate::report::plot::{Axis, Mark, PALETTE, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::tables::{noise_words, psi_words};
use edof_core::Noise;
use edof_core::words::count;
use edof_io::photos::choices;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The loss that a tolerance allows, in dB.
const LIMIT_DB: f64 = 0.1;
/// Places across the sensor at which a tilted one is looked at.
const PLACES: usize = 65;

/// What an error of one amount costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Loss {
    /// The amount.
    pub amount: f64,
    /// The same in micrometres, where it is a length.
    pub micrometres: Option<f64>,
    /// Loss in dB, averaged over depths, paired by photograph.
    pub average: Paired,
    /// Loss in dB at the worst depth, which may be another one with the error.
    pub worst_db: f64,
}

/// One kind of error at one noise level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// The kind.
    pub kind: Kind,
    /// Noise of the sensor.
    pub noise: Noise,
    /// Losses, amounts ascending, 0 among them.
    pub losses: Vec<Loss>,
    /// The smallest amount that costs 0.1 dB on average, either way; none where no measured amount does.
    pub limit: Option<f64>,
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tolerances {
    /// Name of the camera.
    pub camera: String,
    /// Name of the network.
    pub method: String,
    /// Each kind of error, at each noise.
    pub curves: Vec<Curve>,
    /// For each noise, the focus error in ψ at opposite edges of a tilted sensor that costs 0.1 dB over its whole width.
    pub tilt: Vec<(Noise, Option<f64>)>,
    #[serde(skip)]
    noises: Vec<Noise>,
    #[serde(skip)]
    images: BTreeSet<String>,
    #[serde(skip)]
    psis: Vec<f64>,
}

const TITLE: &str = "What a maker must hold: errors of the lens that cost 0.1 dB";

impl StudyReport for Tolerances {
    type Row = Row;

    fn new(rows: &[Row], _machine: String) -> Result<Self, StudyReportError> {
        let mut noises: Vec<Noise> = vec![];
        rows.iter().for_each(|row| {
            if !noises.contains(&row.noise) {
                noises.push(row.noise);
            }
        });
        let curve = |kind, noise| Curve::of(rows, kind, noise);
        let curves: Vec<Curve> = Kind::ERRORS
            .into_iter()
            .filter(|kind| rows.iter().any(|row| row.kind == *kind))
            .flat_map(|kind| noises.iter().map(move |&noise| curve(kind, noise)))
            .collect();
        let focus = curves.iter().filter(|curve| curve.kind == Kind::Focus);
        let tilt = focus.map(|curve| (curve.noise, curve.tilt_limit())).collect();
        let mut psis: Vec<f64> = rows.iter().map(|row| row.psi).collect();
        psis.sort_by(f64::total_cmp);
        psis.dedup();
        let first = |of: fn(&Row) -> &String| rows.first().map(of).cloned().unwrap_or_default();
        let images = rows.iter().map(|row| row.image.clone()).collect();
        Ok(Self {
            noises,
            camera: first(|r| &r.camera),
            method: first(|r| &r.method),
            curves,
            tilt,
            images,
            psis,
        })
    }

    fn to_text(&self) -> String {
        format!("{}\n{}", self.limits().to_text(), self.losses().to_text())
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{}\n", self.explanation());
        for (title, table) in self.tables() {
            let _ = write!(page, "\n## {title}\n\n{}", table.to_markdown());
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        for verdict in self.verdicts() {
            report.verdict(&verdict);
        }
        report.made_by(command).method(&self.explanation());
        let plots: Vec<Plot> = self.kinds().map(|kind| self.plot(kind)).collect();
        report.plots(&plots);
        for (title, table) in self.tables() {
            report.heading(&title);
            table.add_to(&mut report, &[]);
        }
        report
    }
}

impl Tolerances {
    fn explanation(&self) -> String {
        let psis: Vec<String> = self.psis.iter().copied().map(psi_words).collect();
        format!(
            "Camera {}, network {}, which knows the camera without its errors. {} at ψ = {}; each error alone, either way. A loss is in dB of RGB PSNR against \
             the camera without errors, of the same photographs, depths and noise, averaged over depths, with the standard error of the mean over photographs. \
             The limit is where the loss reaches {LIMIT_DB} dB, linear between measured amounts; the smaller one of both ways. \
             Ring radius moves the rings' edges, but not those at the aperture's rim, which are the stop's. Wavelength moves all three colours. Tilt of the sensor is \
             computed from the focus errors: the focus is off by the stated ψ at one edge, by its negative at the opposite one, and the loss is the mean across.{}",
            self.camera,
            self.method,
            count(self.images.len(), "photograph"),
            psis.join(", "),
            choices(self.images.iter().map(String::as_str))
        )
    }

    /// A sentence for each noise: what costs the limit.
    fn verdicts(&self) -> Vec<String> {
        let sentence = |noise: &Noise| {
            let own = self.curves.iter().filter(|curve| curve.noise == *noise);
            let limits: Vec<String> = own.map(Curve::stated).collect();
            format!(
                "With {}, each of these errors alone costs {LIMIT_DB} dB on average over ψ: {}.",
                noise_words(*noise),
                limits.join("; ")
            )
        };
        self.noises.iter().map(sentence).collect()
    }

    fn tables(&self) -> [(String, Table); 2] {
        [
            (format!("Errors that cost {LIMIT_DB} dB on average over ψ"), self.limits()),
            ("Loss in dB on average over ψ; at the worst ψ".to_owned(), self.losses()),
        ]
    }

    /// Kinds of error that were measured.
    fn kinds(&self) -> impl Iterator<Item = Kind> {
        Kind::ERRORS.into_iter().filter(|kind| self.of(*kind).next().is_some())
    }

    fn of(&self, kind: Kind) -> impl Iterator<Item = &Curve> {
        self.curves.iter().filter(move |curve| curve.kind == kind)
    }

    /// A line for each kind of error, a column for each noise.
    fn limits(&self) -> Table {
        let row = |kind: Kind| {
            let cells = self.of(kind).map(|curve| in_words(curve.limit, curve));
            std::iter::once(format!("{}, {}", kind.name(), kind.unit())).chain(cells).collect()
        };
        let mut rows: Vec<Vec<String>> = self.kinds().map(row).collect();
        let tilted = self.tilt.iter().zip(self.of(Kind::Focus));
        let cells = tilted.map(|((_, limit), curve)| in_words(*limit, curve));
        if !self.tilt.is_empty() {
            rows.push(
                std::iter::once("tilt of the sensor, ψ at its edges".to_owned()).chain(cells).collect(),
            );
        }
        let header = self.noises.iter().copied().map(noise_words);
        Table { header: std::iter::once("error".to_owned()).chain(header).collect(), rows }
    }

    /// A line for each error and amount, a column for each noise.
    fn losses(&self) -> Table {
        let amounts = |kind: Kind| {
            let curve = self.of(kind).next();
            let all = curve.into_iter().flat_map(|curve| curve.losses.iter().map(|loss| loss.amount));
            all.filter(|amount| *amount != 0.0).map(move |amount| (kind, amount)).collect::<Vec<_>>()
        };
        let cell = |curve: &Curve, amount: f64| {
            let loss = curve.losses.iter().find(|loss| loss.amount == amount);
            loss.map_or_else(|| "–".to_owned(), |loss| format!("{}; {:+.2}", loss.average, loss.worst_db))
        };
        let row = |(kind, amount): (Kind, f64)| {
            let cells = self.of(kind).map(|curve| cell(curve, amount));
            std::iter::once(format!("{} {amount:+} {}", kind.name(), kind.unit())).chain(cells).collect()
        };
        let header = self.noises.iter().copied().map(noise_words);
        Table {
            header: std::iter::once("error".to_owned()).chain(header).collect(),
            rows: self.kinds().flat_map(amounts).map(row).collect(),
        }
    }

    fn plot(&self, kind: Kind) -> Plot {
        let series = |(place, curve): (usize, &Curve)| {
            let points = curve.losses.iter().map(|loss| [loss.amount, loss.average.mean]);
            Series::new(noise_words(curve.noise), Mark::LineAndPoints, points.collect::<Vec<_>>())
                .coloured(PALETTE[place % PALETTE.len()])
        };
        Plot {
            title: kind.name().to_owned(),
            x: Axis::linear(format!("error ({})", kind.unit())),
            y: Axis::linear("loss, average over ψ (dB)"),
            size: SMALL,
            series: self.of(kind).enumerate().map(series).collect(),
        }
    }
}

/// A limit with its length in micrometres, or the largest amount, none of which costs so much.
fn in_words(limit: Option<f64>, curve: &Curve) -> String {
    let per_amount = curve.losses.iter().find_map(|loss| {
        loss.micrometres.filter(|_| loss.amount != 0.0).map(|micrometres| micrometres / loss.amount)
    });
    let amount = |amount: f64| {
        let length = per_amount.map(|each| format!(" ({:.1} µm)", amount * each));
        format!("{amount:.2}{}", length.unwrap_or_default())
    };
    let largest = curve.losses.iter().map(|loss| loss.amount).fold(0.0, f64::max);
    limit.map_or_else(|| format!("more than {}", amount(largest)), |limit| format!("±{}", amount(limit)))
}

impl Curve {
    /// The limit with name and unit of the error, as in `ring radius ±0.82 % of the aperture radius (18.8 µm)`.
    fn stated(&self) -> String {
        let words = in_words(self.limit, self);
        let (amount, length) = words.split_once(" (").unwrap_or((&words, ""));
        let length = if length.is_empty() { String::new() } else { format!(" ({length}") };
        format!("{} {amount} {}{length}", self.kind.name(), self.kind.unit())
    }

    fn of(rows: &[Row], kind: Kind, noise: Noise) -> Self {
        let at = |kind: Kind, amount: f64| -> Vec<&Row> {
            rows.iter().filter(|r| (r.kind, r.noise) == (kind, noise) && r.amount == amount).collect()
        };
        let right = at(Kind::None, 0.0);
        let mut amounts: Vec<f64> = rows.iter().filter(|r| r.kind == kind).map(|r| r.amount).collect();
        amounts.push(0.0);
        amounts.sort_by(f64::total_cmp);
        amounts.dedup();
        let loss = |amount: f64| {
            let wrong = if amount == 0.0 { right.clone() } else { at(kind, amount) };
            let average = Paired::between(&by_photo(&right), &by_photo(&wrong))?;
            let micrometres = wrong.first().and_then(|row| row.micrometres);
            Some(Loss { amount, micrometres, average, worst_db: worst(&right) - worst(&wrong) })
        };
        let losses: Vec<Loss> = amounts.into_iter().filter_map(loss).collect();
        let points: Vec<[f64; 2]> = losses.iter().map(|loss| [loss.amount, loss.average.mean]).collect();
        Self { kind, noise, losses, limit: limit(&points) }
    }

    /// The smallest focus error at the edges of a tilted sensor whose mean loss across is the limit.
    fn tilt_limit(&self) -> Option<f64> {
        let points: Vec<[f64; 2]> = self.losses.iter().map(|loss| [loss.amount, loss.average.mean]).collect();
        let across = |edge: f64| {
            let at = |place: usize| edge * (2.0 * place as f64 / (PLACES - 1) as f64 - 1.0);
            edof_numerics::mean((0..PLACES).map(|place| loss_at(&points, at(place)))).unwrap_or(0.0)
        };
        let edges = points.iter().map(|point| point[0]).filter(|amount| *amount >= 0.0);
        limit(&edges.map(|edge| [edge, across(edge)]).collect::<Vec<_>>())
    }
}

/// Loss at an amount, linear between points.
fn loss_at(points: &[[f64; 2]], amount: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < amount).clamp(1, points.len().max(2) - 1);
    match (points.get(after - 1), points.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (amount - x0) / (x1 - x0),
        _ => 0.0,
    }
}

/// The smallest amount of either sign whose loss is [`LIMIT_DB`], linear between points; their amounts ascend, 0 among them.
fn limit(points: &[[f64; 2]]) -> Option<f64> {
    let way = |sign: f64| {
        let mut own: Vec<[f64; 2]> =
            points.iter().map(|[x, y]| [sign * x, *y]).filter(|[x, _]| *x >= 0.0).collect();
        own.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let crossing = own.windows(2).find(|pair| pair[1][1] >= LIMIT_DB)?;
        let [[x0, y0], [x1, y1]] = [crossing[0], crossing[1]];
        Some(x0 + (x1 - x0) * (LIMIT_DB - y0) / (y1 - y0))
    };
    [1.0, -1.0].into_iter().filter_map(way).reduce(f64::min)
}

/// Mean PSNR over depths of each photograph.
fn by_photo(rows: &[&Row]) -> BTreeMap<String, f64> {
    let mut all: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    rows.iter().for_each(|row| all.entry(row.image.clone()).or_default().push(row.psnr_db));
    all.into_iter().filter_map(|(photo, db)| Some((photo, edof_numerics::mean(db)?))).collect()
}

/// Mean PSNR over photographs at the worst depth.
fn worst(rows: &[&Row]) -> f64 {
    let mut all: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    rows.iter().for_each(|row| all.entry(row.psi.to_bits()).or_default().push(row.psnr_db));
    let means = all.into_values().filter_map(edof_numerics::mean);
    means.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_the_smaller_one_of_both_ways_between_the_amounts_that_were_measured() {
        let near = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-12);
        near(limit(&[[-2.0, 0.4], [-1.0, 0.05], [0.0, 0.0], [1.0, 0.02], [2.0, 0.06]]), 1.0 + 0.05 / 0.35);
        near(limit(&[[-1.0, 0.4], [0.0, 0.0], [1.0, 0.5]]), 0.2);
        assert_eq!(limit(&[[-1.0, 0.04], [0.0, 0.0], [1.0, 0.05]]), None);
        // A little error may even help.
        near(limit(&[[0.0, 0.0], [1.0, -0.1], [2.0, 0.3]]), 1.5);
    }

    #[test]
    fn a_tilted_sensor_loses_the_mean_across() {
        let points = [[-2.0, 0.4], [0.0, 0.0], [2.0, 0.4]];
        assert!((loss_at(&points, 1.0) - 0.2).abs() < 1e-12 && (loss_at(&points, -2.0) - 0.4).abs() < 1e-12);
        let paired = |mean| Paired { mean, standard_error: None, photos: 1 };
        let loss = |[amount, mean]: [f64; 2]| Loss {
            amount,
            micrometres: None,
            average: paired(mean),
            worst_db: mean,
        };
        let losses = points.map(loss).to_vec();
        let curve = Curve { kind: Kind::Focus, noise: Noise::None, losses, limit: Some(0.5) };
        // The loss is straight from the middle on, so its mean across is half of that at the edge (at 65 places a little more).
        assert!((curve.tilt_limit().unwrap() - 1.0).abs() < 0.02, "{:?}", curve.tilt_limit());
        assert_eq!(in_words(None, &curve), "more than 2.00");
        assert_eq!(curve.stated(), "focus ±0.50 ψ");
        let mut long = Curve { limit: Some(1.0), ..curve };
        long.losses[2].micrometres = Some(14.0);
        assert_eq!(long.stated(), "focus ±1.00 ψ (7.0 µm)");
    }
}
