//! What rows of photographs say together: where the coded lens wins with its network, by how much, and where it does not.

use super::{Lens, Row};
use crate::made::Made;
use crate::metrics::paired::Paired;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::verdict::is_ahead;
use edof_core::words::count;
use edof_numerics::mean;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// What one lens reaches with its network over one range of depths in one light, in dB.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reached {
    /// Which lens.
    pub lens: Lens,
    /// Stops by which it is closed.
    pub stops: f64,
    /// F-number of the lens.
    pub f_number: f64,
    /// Averaged over depths and photographs.
    pub average_db: f64,
    /// At its worst depth, averaged over photographs.
    pub worst_db: f64,
    /// That depth, in ψ of the open aperture.
    pub worst_psi: f64,
    /// What the closed-form estimator expects: average, worst depth.
    pub estimated_db: [f64; 2],
    /// Averages over depths by photograph.
    #[serde(skip)]
    averages: BTreeMap<String, f64>,
    /// Values at the worst depth by photograph.
    #[serde(skip)]
    worsts: BTreeMap<String, f64>,
}

impl Reached {
    /// Of rows of one lens, range and light; none of none.
    fn of(rows: &[&Row]) -> Option<Self> {
        let first = rows.first()?;
        let mut depths: Vec<f64> = rows.iter().map(|row| row.psi).collect();
        depths.sort_by(f64::total_cmp);
        depths.dedup();
        let at = |psi: f64| rows.iter().filter(move |row| row.psi == psi);
        let level = |psi: f64| mean(at(psi).map(|row| row.psnr_db)).unwrap_or(f64::NAN);
        let worst_psi = depths.into_iter().min_by(|a, b| level(*a).total_cmp(&level(*b)))?;
        let images: BTreeSet<&str> = rows.iter().map(|row| row.image.as_str()).collect();
        let average = |image: &str| {
            let own = rows.iter().filter(|row| row.image == image).map(|row| row.psnr_db);
            Some((image.to_owned(), mean(own)?))
        };
        let averages: BTreeMap<String, f64> = images.into_iter().filter_map(average).collect();
        Some(Self {
            lens: first.lens,
            stops: first.stops,
            f_number: first.f_number,
            average_db: mean(averages.values().copied())?,
            worst_db: level(worst_psi),
            worst_psi,
            estimated_db: [first.estimated_average_db, first.estimated_worst_db],
            worsts: at(worst_psi).map(|row| (row.image.clone(), row.psnr_db)).collect(),
            averages,
        })
    }

    fn name(&self) -> String {
        let lens = if self.lens == Lens::Coded { "coded" } else { "clear" };
        format!("{lens}, F/{:.1}", self.f_number)
    }

    fn levels(&self) -> String {
        format!("{:.2} / {:.2}", self.average_db, self.worst_db)
    }

    fn estimates(&self) -> String {
        let [average, worst] = self.estimated_db;
        format!("{average:.2} / {worst:.2}")
    }
}

/// One range of depths in one light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Peers {
    /// Far end of the range of ψ.
    pub range: f64,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// The coded lens.
    pub coded: Reached,
    /// The clear lens at every aperture that has a network, the open one first.
    pub clear: Vec<Reached>,
}

/// The coded lens against the clear lens at one aperture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Coded minus clear in dB, averaged over depths, paired by photograph.
    pub average: Paired,
    /// The same, each at its own worst depth.
    pub worst: Paired,
}

impl Peers {
    /// The aperture that the closed-form estimator prefers among those with a network: average and worst depth have equal weight.
    fn chosen(&self) -> Option<&Reached> {
        let score = |reached: &Reached| reached.estimated_db.iter().sum::<f64>();
        self.clear.iter().max_by(|a, b| score(a).total_cmp(&score(b)))
    }

    /// Of the coded lens with one of the clear ones.
    fn with(&self, clear: &Reached) -> Option<Comparison> {
        Some(Comparison {
            average: Paired::between(&self.coded.averages, &clear.averages)?,
            worst: Paired::between(&self.coded.worsts, &clear.worsts)?,
        })
    }
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ApertureNetworks {
    /// Ranges ascending, in each the brightest light first.
    pub peers: Vec<Peers>,
    /// How many photographs.
    pub photographs: usize,
    /// Windows that a network was trained on: the fewest, the most.
    pub windows: [u64; 2],
    /// What the page states about the choice of the photographs.
    #[serde(skip)]
    choices: String,
}

const TITLE: &str = "A coded lens against a smaller aperture, each with its own network";

impl StudyReport for ApertureNetworks {
    type Row = Row;

    fn new(rows: &[Row], _machine: String) -> Result<Self, StudyReportError> {
        let mut places: Vec<(f64, f64)> = rows.iter().map(|row| (row.range, row.electrons)).collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        places.dedup();
        let peers = places.into_iter().filter_map(|(range, electrons)| {
            let own: Vec<&Row> =
                rows.iter().filter(|row| (row.range, row.electrons) == (range, electrons)).collect();
            let mut stops: Vec<f64> = own.iter().map(|row| row.stops).collect();
            stops.sort_by(f64::total_cmp);
            stops.dedup();
            let of = |lens: Lens, stops: f64| {
                let rows: Vec<&Row> =
                    own.iter().copied().filter(|row| (row.lens, row.stops) == (lens, stops)).collect();
                Reached::of(&rows)
            };
            let clear: Vec<Reached> = stops.iter().filter_map(|stops| of(Lens::Clear, *stops)).collect();
            Some(Peers { range, electrons, coded: of(Lens::Coded, 0.0)?, clear })
        });
        let images: BTreeSet<&str> = rows.iter().map(|row| row.image.as_str()).collect();
        let windows = || rows.iter().map(|row| row.windows);
        Ok(Self {
            peers: peers.filter(|peers| !peers.clear.is_empty()).collect(),
            photographs: images.len(),
            windows: [windows().min().unwrap_or(0), windows().max().unwrap_or(0)],
            choices: edof_io::photos::choices(images.iter().copied()),
        })
    }

    fn to_text(&self) -> String {
        format!("{}\n{}", self.table().to_text(), self.verdicts().join("\n"))
    }

    fn to_markdown(&self, made: &Made) -> String {
        let explanation = self.explanation("[aperture.md](aperture.md)");
        let mut page = format!("# {TITLE}\n\n{made}\n\n{explanation}\n\n## Verdict\n\n");
        for verdict in self.verdicts() {
            let _ = writeln!(page, "- {verdict}");
        }
        for (heading, table) in self.tables() {
            let _ = write!(page, "\n## {heading}\n\n{}", table.to_markdown());
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        for verdict in self.verdicts() {
            report.verdict(&verdict);
        }
        report.made_by(command).method(&self.explanation("edof study aperture"));
        let plots: Vec<Plot> = self.ranges().into_iter().map(|range| self.plot(range)).collect();
        report.plots(&plots);
        for (heading, table) in self.tables() {
            report.heading(&heading);
            table.add_to(&mut report, &[]);
        }
        report
    }
}

impl ApertureNetworks {
    fn explanation(&self, estimator: &str) -> String {
        let windows = match self.windows {
            [fewest, most] if fewest == most => fewest.to_string(),
            [fewest, most] => format!("{fewest} to {most}"),
        };
        format!(
            "Both lenses look at the same scene for the same time, with the same sensor. The clear lens may be closed: each stop halves its light and \
             halves ψ of every depth. Light is stated as the electrons of a white pixel behind the open aperture; gain makes white full scale. \
             Every lens, aperture and range of depths has networks of its own by one short recipe, each trained on {windows} windows with its own noise. \
             They are trained less than the networks that come with the program. \
             Ranges, lights and apertures without a network are left out; scripts/results.sh aperture-networks trains those that are missing. \
             {} under real light (sRGB decoded, photon and read noise), at five depths of each range. PSNR in dB, peak 1, of the encoded picture; the average \
             over depths, and the worst depth of each lens. The closed-form estimator of {estimator} chose each lens's focus and the \
             clear lens's aperture in the verdict, without these photographs. A ± is the standard error of the difference, paired by photograph; a difference counts from twice \
             that on. The mask was designed for ψ 0 to 8 and stays the same for all ranges.{}",
            count(self.photographs, "photograph"),
            self.choices
        )
    }

    fn ranges(&self) -> Vec<f64> {
        let mut ranges: Vec<f64> = self.peers.iter().map(|peers| peers.range).collect();
        ranges.dedup();
        ranges
    }

    fn of_range(&self, range: f64) -> impl Iterator<Item = &Peers> {
        self.peers.iter().filter(move |peers| peers.range == range)
    }

    /// All lights of all ranges against the aperture that the estimator prefers.
    fn compared(&self) -> Vec<(&Peers, &Reached, Comparison)> {
        let one = |peers| {
            let clear = Peers::chosen(peers)?;
            Some((peers, clear, peers.with(clear)?))
        };
        self.peers.iter().filter_map(one).collect()
    }

    /// How often the coded lens is ahead, then a sentence for each range of depths.
    fn verdicts(&self) -> Vec<String> {
        let all = self.compared();
        let tally = |of: fn(&Comparison) -> Paired| {
            let ahead = |way: Option<bool>| all.iter().filter(|(.., c)| is_ahead(&of(c)) == way).count();
            format!(
                "better in {}, worse in {}, equal within the error in {}",
                ahead(Some(true)),
                ahead(Some(false)),
                ahead(None)
            )
        };
        let sum = format!(
            "Of {} of range and light, the coded lens is at the worst depth {}. On average over depths it is {}.",
            count(all.len(), "pair"),
            tally(|c| c.worst),
            tally(|c| c.average)
        );
        let sentence = |range: f64| {
            let gains = |of: fn(&Comparison) -> Paired| -> Vec<(f64, Paired)> {
                let own = all.iter().filter(|(peers, ..)| peers.range == range);
                own.map(|(peers, _, comparison)| (peers.electrons, of(comparison))).collect()
            };
            let [worst, average] = [gains(|c| c.worst), gains(|c| c.average)].map(|gains| in_words(&gains));
            format!(
                "ψ 0 to {range}: at the worst depth the coded lens is {worst}. On average it is {average}."
            )
        };
        std::iter::once(sum).chain(self.ranges().into_iter().map(sentence)).collect()
    }

    fn tables(&self) -> Vec<(String, Table)> {
        let mut all =
            vec![("Coded lens, and clear lens at the aperture of the estimate".to_owned(), self.table())];
        for range in self.ranges() {
            let add = |what: &str| format!("{what}, ψ 0 to {range}: average / worst depth, dB");
            all.push((add("Every aperture"), self.apertures(range, |_, r| r.levels())));
            let gain = |peers: &Peers, reached: &Reached| match reached.lens {
                Lens::Coded => "–".to_owned(),
                Lens::Clear => peers
                    .with(reached)
                    .map_or_else(|| "–".to_owned(), |c| format!("{} / {}", c.average, c.worst)),
            };
            all.push((add("Coded lens minus every aperture"), self.apertures(range, gain)));
            all.push((add("The closed-form estimate"), self.apertures(range, |_, r| r.estimates())));
        }
        all
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
        let row = |(peers, clear, comparison): &(&Peers, &Reached, Comparison)| {
            vec![
                format!("0 to {}", peers.range),
                peers.electrons.to_string(),
                format!("{:.2}", peers.coded.average_db),
                format!("{:.2}", peers.coded.worst_db),
                format!("F/{:.1}", clear.f_number),
                format!("{:.2}", clear.average_db),
                format!("{:.2}", clear.worst_db),
                comparison.average.to_string(),
                comparison.worst.to_string(),
            ]
        };
        Table { header: header.map(str::to_owned).to_vec(), rows: self.compared().iter().map(row).collect() }
    }

    /// A cell for each lens and aperture, a column for each light.
    fn apertures(&self, range: f64, cell: impl Fn(&Peers, &Reached) -> String) -> Table {
        let peers: Vec<&Peers> = self.of_range(range).collect();
        let heads = peers.iter().map(|peers| format!("{} e⁻", peers.electrons));
        let lenses = peers.iter().flat_map(|peers| std::iter::once(&peers.coded).chain(&peers.clear));
        let mut lenses: Vec<&Reached> = lenses.collect();
        lenses.sort_by(|a, b| a.lens.cmp(&b.lens).then(a.stops.total_cmp(&b.stops)));
        lenses.dedup_by(|a, b| (a.lens, a.stops) == (b.lens, b.stops));
        let of = |peers: &Peers, lens: &Reached| {
            let mut own = std::iter::once(&peers.coded).chain(&peers.clear);
            let own = own.find(|own| (own.lens, own.stops) == (lens.lens, lens.stops));
            own.map_or_else(|| "–".to_owned(), |own| cell(peers, own))
        };
        let row = |lens: &&Reached| {
            std::iter::once(lens.name()).chain(peers.iter().map(|peers| of(peers, lens))).collect()
        };
        Table {
            header: std::iter::once("lens".to_owned()).chain(heads).collect(),
            rows: lenses.iter().map(row).collect(),
        }
    }

    fn plot(&self, range: f64) -> Plot {
        let points = |of: fn(&Peers, &Reached) -> f64| -> Vec<[f64; 2]> {
            let all = self.compared().into_iter().filter(|(peers, ..)| peers.range == range);
            all.map(|(peers, clear, _)| [peers.electrons, of(peers, clear)]).collect()
        };
        let series = |label: &str, mark: Mark, colour: &str, of: fn(&Peers, &Reached) -> f64| {
            Series::new(label, mark, points(of)).coloured(colour)
        };
        Plot {
            title: format!("ψ 0 to {range}"),
            x: Axis::log("electrons of a white pixel, open aperture"),
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: vec![
                series("coded, average", Mark::LineAndPoints, "#0072b2", |p, _| p.coded.average_db),
                series("coded, worst depth", Mark::Dashed, "#0072b2", |p, _| p.coded.worst_db),
                series(
                    "clear at the estimate's aperture, average",
                    Mark::LineAndPoints,
                    "#d55e00",
                    |_, c| c.average_db,
                ),
                series("the same, worst depth", Mark::Dashed, "#d55e00", |_, c| c.worst_db),
            ],
        }
    }
}

/// Where the coded lens is ahead, by how much at most, and where it is not, of lights with their gains.
pub(super) fn in_words(gains: &[(f64, Paired)]) -> String {
    let part = |(way, word): (Option<bool>, &str)| {
        let own: Vec<&(f64, Paired)> = gains.iter().filter(|(_, gain)| is_ahead(gain) == way).collect();
        let most = own.iter().map(|(_, gain)| gain.mean.abs()).max_by(f64::total_cmp)?;
        let by = if way.is_some() { format!(" by up to {most:.2} dB") } else { String::new() };
        let lights: Vec<String> = own.iter().map(|(electrons, _)| electrons.to_string()).collect();
        let all = own.len() == gains.len();
        let place =
            if all { "at every light".to_owned() } else { format!("at {} electrons", lights.join(", ")) };
        Some(format!("{word}{by} {place}"))
    };
    let ways = [(Some(true), "better"), (Some(false), "worse"), (None, "equally good within the error")];
    ways.into_iter().filter_map(part).collect::<Vec<_>>().join(", ")
}
