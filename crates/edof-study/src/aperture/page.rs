//! What rows of apertures say together: where the coded lens wins, by how much, and where it does not.

use super::{Lens, Row};
use crate::made::Made;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use serde::Serialize;
use std::fmt::Write;

/// What a lens reaches, in dB.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reached {
    /// Stops by which it is closed.
    pub stops: f64,
    /// F-number of the lens.
    pub f_number: f64,
    /// Averaged over depths.
    pub average_db: f64,
    /// At the worst depth.
    pub worst_db: f64,
}

impl Reached {
    fn of(row: &Row) -> Self {
        let Row { stops, f_number, average_db, worst_db, .. } = *row;
        Self { stops, f_number, average_db, worst_db }
    }

    const fn score(self) -> f64 {
        super::score(self.average_db, self.worst_db)
    }
}

/// Both lenses over one range of depths in one light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Far end of the range of ψ.
    pub range: f64,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// The coded lens at its full aperture.
    pub coded: Reached,
    /// The clear lens at the best of its apertures: average and worst depth have equal weight.
    pub clear: Reached,
}

impl Comparison {
    /// Coded minus clear, average and worst depth, in dB.
    fn gain(&self) -> [f64; 2] {
        [self.coded.average_db - self.clear.average_db, self.coded.worst_db - self.clear.worst_db]
    }
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Aperture {
    /// Ranges ascending, in each the brightest light first.
    pub comparisons: Vec<Comparison>,
    /// Every lens and aperture.
    #[serde(skip)]
    rows: Vec<Row>,
}

const TITLE: &str = "A coded lens against a smaller aperture";

impl StudyReport for Aperture {
    type Row = Row;

    fn new(rows: &[Row], _machine: String) -> Result<Self, StudyReportError> {
        let mut comparisons: Vec<Comparison> = vec![];
        for row in rows.iter().filter(|row| row.lens == Lens::Coded) {
            let peers = rows.iter().filter(|peer| {
                peer.lens == Lens::Clear && peer.range == row.range && peer.electrons == row.electrons
            });
            let best = peers.map(Reached::of).max_by(|a, b| a.score().total_cmp(&b.score()));
            comparisons.extend(best.map(|clear| Comparison {
                range: row.range,
                electrons: row.electrons,
                coded: Reached::of(row),
                clear,
            }));
        }
        let order = |c: &Comparison| (c.range, -c.electrons);
        comparisons.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal));
        Ok(Self { comparisons, rows: rows.to_vec() })
    }

    fn to_text(&self) -> String {
        format!("{}\n{}", self.table().to_text(), self.verdicts().join("\n"))
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{EXPLANATION}\n\n## Verdict\n\n");
        for verdict in self.verdicts() {
            let _ = writeln!(page, "- {verdict}");
        }
        let _ = write!(
            page,
            "\n## Coded lens, and clear lens at its best aperture\n\n{}",
            self.table().to_markdown()
        );
        for range in self.ranges() {
            let _ = write!(
                page,
                "\n## Every aperture, ψ 0 to {range}\n\n{}",
                self.apertures(range).to_markdown()
            );
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        for verdict in self.verdicts() {
            report.verdict(&verdict);
        }
        report.made_by(command).method(EXPLANATION);
        let plots: Vec<Plot> = self.ranges().into_iter().map(|range| self.plot(range)).collect();
        report.plots(&plots);
        report.heading("Coded lens, and clear lens at its best aperture");
        self.table().add_to(&mut report, &[]);
        for range in self.ranges() {
            report.heading(&format!("Every aperture, ψ 0 to {range}"));
            self.apertures(range).add_to(&mut report, &[]);
        }
        report
    }
}

const EXPLANATION: &str = "Both lenses look at the same scene for the same time, with the same sensor. The clear lens may be closed: each stop \
    halves its light and halves ψ of every depth. Each lens is focused where it is best for the range and the light. Light is stated as the electrons of a \
    white pixel behind the open aperture. PSNR in dB, peak 1, is that of the best linear estimate of an 8×8 colour patch from its raw window, computed in \
    closed form from the statistics of photographs; no picture is made, so the numbers have no sampling error. A trained network reaches some dB more behind every lens, and \
    may rank two lenses otherwise where they are close. The mask was designed for ψ 0 to 8 and stays the same for all ranges.";

impl Aperture {
    fn ranges(&self) -> Vec<f64> {
        let mut ranges: Vec<f64> = self.comparisons.iter().map(|c| c.range).collect();
        ranges.dedup();
        ranges
    }

    fn of_range(&self, range: f64) -> impl Iterator<Item = &Comparison> {
        self.comparisons.iter().filter(move |c| c.range == range)
    }

    /// A sentence for each range.
    fn verdicts(&self) -> Vec<String> {
        let sentence = |range: f64| {
            let of = |index: usize| -> Vec<(f64, f64)> {
                self.of_range(range).map(|c| (c.electrons, c.gain()[index])).collect()
            };
            format!(
                "ψ 0 to {range}: at the worst depth the coded lens {}; on average it {}.",
                in_words(&of(1)),
                in_words(&of(0))
            )
        };
        self.ranges().into_iter().map(sentence).collect()
    }

    fn table(&self) -> Table {
        let header = [
            "ψ range",
            "electrons",
            "coded, average",
            "coded, worst",
            "clear at",
            "clear, average",
            "clear, worst",
            "gain, average",
            "gain, worst",
        ];
        let row = |c: &Comparison| {
            let [average, worst] = c.gain();
            vec![
                format!("0 to {}", c.range),
                c.electrons.to_string(),
                format!("{:.2}", c.coded.average_db),
                format!("{:.2}", c.coded.worst_db),
                format!("F/{:.1}", c.clear.f_number),
                format!("{:.2}", c.clear.average_db),
                format!("{:.2}", c.clear.worst_db),
                format!("{average:+.2}"),
                format!("{worst:+.2}"),
            ]
        };
        Table { header: header.map(str::to_owned).to_vec(), rows: self.comparisons.iter().map(row).collect() }
    }

    /// Average and worst dB of each lens and aperture, a column for each light.
    fn apertures(&self, range: f64) -> Table {
        let lights: Vec<f64> = self.of_range(range).map(|c| c.electrons).collect();
        let mut lenses: Vec<(Lens, f64, f64)> =
            self.rows.iter().map(|r| (r.lens, r.stops, r.f_number)).collect();
        lenses.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        lenses.dedup();
        let heads = lights.iter().map(|light| format!("{light} e⁻"));
        let cell = |lens: Lens, stops: f64, light: f64| {
            let row = self
                .rows
                .iter()
                .find(|row| (row.lens, row.stops, row.range, row.electrons) == (lens, stops, range, light));
            row.map_or_else(|| "–".to_owned(), |row| format!("{:.2} / {:.2}", row.average_db, row.worst_db))
        };
        let row = |&(lens, stops, f_number): &(Lens, f64, f64)| {
            let name = match lens {
                Lens::Coded => format!("coded, F/{f_number:.1}"),
                Lens::Clear => format!("clear, F/{f_number:.1}"),
            };
            std::iter::once(name).chain(lights.iter().map(|&light| cell(lens, stops, light))).collect()
        };
        Table {
            header: std::iter::once("average / worst dB".to_owned()).chain(heads).collect(),
            rows: lenses.iter().map(row).collect(),
        }
    }

    fn plot(&self, range: f64) -> Plot {
        let series = |label: &str, mark: Mark, colour: &str, of: fn(&Comparison) -> f64| {
            Series::new(label, mark, self.of_range(range).map(|c| [c.electrons, of(c)]).collect::<Vec<_>>())
                .coloured(colour)
        };
        Plot {
            title: format!("ψ 0 to {range}"),
            x: Axis::log("electrons of a white pixel, open aperture"),
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: vec![
                series("coded, average", Mark::LineAndPoints, "#0072b2", |c| c.coded.average_db),
                series("coded, worst depth", Mark::Dashed, "#0072b2", |c| c.coded.worst_db),
                series("clear at its best aperture, average", Mark::LineAndPoints, "#d55e00", |c| {
                    c.clear.average_db
                }),
                series("clear at its best aperture, worst depth", Mark::Dashed, "#d55e00", |c| {
                    c.clear.worst_db
                }),
            ],
        }
    }
}

/// Gains by light, brightest first, as the part of a sentence: where there is a gain of 0.05 dB or more, where a loss, and the largest of each.
fn in_words(gains: &[(f64, f64)]) -> String {
    const EVEN_DB: f64 = 0.05;
    let part = |word: &str, sign: f64| {
        let own: Vec<&(f64, f64)> = gains.iter().filter(|(_, gain)| sign * gain >= EVEN_DB).collect();
        let max = own.iter().map(|(_, gain)| sign * gain).fold(0.0, f64::max);
        let lights: Vec<String> = own.iter().map(|(electrons, _)| electrons.to_string()).collect();
        (!own.is_empty()).then(|| match own.len() == gains.len() {
            true => format!("{word} up to {max:.1} dB at every light"),
            false => format!("{word} up to {max:.1} dB at {} electrons", lights.join(", ")),
        })
    };
    let parts: Vec<String> = [part("wins", 1.0), part("loses", -1.0)].into_iter().flatten().collect();
    if parts.is_empty() { "is even with the clear one".to_owned() } else { parts.join(" and ") }
}
