//! What foldings of networks are worth: dB against cycles, multipliers and frames per second, and which of them are Pareto-optimal.

use crate::made::Made;
use crate::report::Report;
use crate::report::Table;
use crate::report::plot::{Axis, Mark, PALETTE, Plot, SMALL, Series};
use crate::verdict::listed;
use serde::Serialize;

/// A folding of a network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Folding {
    /// Network of the design.
    pub network: String,
    /// The network's camera.
    pub camera: String,
    /// Mean PSNR in dB of the network's pictures.
    pub psnr_db: f64,
    /// Lanes times rows of each stage.
    pub stages: String,
    /// Mean cycles per patch.
    pub cycles_per_patch: f64,
    /// Those of the busiest picture.
    pub worst_picture_cycles_per_patch: f64,
    /// Frames per second at the planned clock.
    pub frames_per_second: f64,
    /// Multipliers.
    #[serde(rename = "dsp48e1")]
    pub multipliers: usize,
    /// Block memories; halves count half.
    #[serde(rename = "ramb36")]
    pub memories: f64,
    /// Whether no other folding of any network is as good in dB, cycles, multipliers and block RAM and better in one.
    pub on_front: bool,
}

/// All foldings that nothing of their own network beats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Foldings {
    /// Network by network, cheapest first.
    pub foldings: Vec<Folding>,
    /// Design that gives clock and picture, and what the clock is.
    pub design: String,
    /// Clock in MHz: planned, not measured.
    pub clock_mhz: f64,
    /// Frames per second that a verdict asks of a folding.
    pub required_frames_per_second: f64,
    /// Device that all of them fit.
    pub device: String,
    /// What its multipliers and block memories are called.
    #[serde(skip)]
    pub cells: [&'static str; 2],
    /// What they were measured on.
    pub pictures: String,
}

const TITLE: &str = "Networks that fit the board: dB against cycles, multipliers and frames per second";

impl Foldings {
    /// The front for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        format!("{}\n\n{}", self.verdict(), self.front().to_text().trim_end())
    }

    /// The same as a Markdown page; `command` is the command that makes it again.
    #[must_use]
    pub fn to_markdown(&self, made: &Made) -> String {
        let verdict = listed(&[self.verdict()]);
        format!("# {TITLE}\n\n{made}\n\n{verdict}{}\n\n{}", self.explanation(), self.front().to_markdown())
    }

    /// A report with a diagram for each figure.
    #[must_use]
    pub fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.verdict(&self.verdict()).paragraph(&self.explanation()).made_by(command);
        report.plots(&[
            self.plot("cycles per patch", |f| f.cycles_per_patch),
            self.plot(&self.multipliers(), |f| f.multipliers as f64),
            self.plot("frames per second", |f| f.frames_per_second),
            self.trade(),
        ]);
        report.heading("The front");
        self.front().add_to(&mut report, &[]);
        report
    }

    /// The best network that is fast enough, its cheapest folding, and how far all others get.
    #[must_use]
    pub fn verdict(&self) -> String {
        let required = self.required_frames_per_second;
        let fast = self.foldings.iter().filter(|f| f.frames_per_second >= required);
        let better = |a: &&Folding, b: &&Folding| {
            a.psnr_db
                .total_cmp(&b.psnr_db)
                .then(b.multipliers.cmp(&a.multipliers))
                .then(b.memories.total_cmp(&a.memories))
        };
        let best = fast.clone().max_by(better);
        let one = |f: &Folding| {
            format!(
                "{} (camera {}), has {:.2} dB at {:.1} frames per second with {} {}",
                f.network,
                f.camera,
                f.psnr_db,
                f.frames_per_second,
                f.multipliers,
                self.multipliers()
            )
        };
        let clock = format!("at the planned {} MHz", self.clock_mhz);
        let Some(best) = best else {
            let fastest =
                self.foldings.iter().max_by(|a, b| a.frames_per_second.total_cmp(&b.frames_per_second));
            return fastest.map_or_else(String::new, |fastest| {
                format!(
                    "No network reaches {required} frames per second {clock}. The fastest one, {}.",
                    one(fastest)
                )
            });
        };
        let others: Vec<String> = self
            .networks()
            .into_iter()
            .filter(|name| *name != best.network)
            .filter_map(|name| {
                let own = || self.foldings.iter().filter(|f| f.network == name);
                let cheapest = own().filter(|f| f.frames_per_second >= required).max_by(better);
                let fastest = own().map(|f| f.frames_per_second).reduce(f64::max)?;
                Some(cheapest.map_or_else(
                    || format!("{name} reaches {fastest:.1} frames per second at most"),
                    |f| {
                        let less = best.psnr_db - f.psnr_db;
                        format!("{name} has {less:.2} dB less, with {} multipliers", f.multipliers)
                    },
                ))
            })
            .collect();
        let others =
            if others.is_empty() { String::new() } else { format!(" Others: {}.", others.join("; ")) };
        format!(
            "Of the networks that reach {required} frames per second {clock}, the best one, {}.{others}",
            one(best)
        )
    }

    fn explanation(&self) -> String {
        format!(
            "Every folding that fits the {}, by the cycle model on {}, with the picture and the clock of design {} ({} MHz, planned). Frames \
             per second are cycles at that clock: computed, not measured on a board; multipliers and block RAM are exact. PSNR is that of each network behind its \
             own camera, so networks of different cameras are different lenses too. The front holds what no other folding of any network beats in dB, cycles, multipliers and block RAM at once.",
            self.device, self.pictures, self.design, self.clock_mhz
        )
    }

    fn front(&self) -> Table {
        let header = [
            "network",
            "camera",
            "PSNR dB",
            "cycles per patch",
            "worst picture",
            "frames per second",
            self.cells[0],
            self.cells[1],
            "lanes×rows",
        ];
        let row = |f: &Folding| {
            vec![
                f.network.clone(),
                f.camera.clone(),
                format!("{:.2}", f.psnr_db),
                format!("{:.1}", f.cycles_per_patch),
                format!("{:.1}", f.worst_picture_cycles_per_patch),
                format!("{:.1}", f.frames_per_second),
                f.multipliers.to_string(),
                format!("{:.1}", f.memories),
                f.stages.clone(),
            ]
        };
        let rows = self.foldings.iter().filter(|f| f.on_front).map(row).collect();
        Table { header: header.map(str::to_owned).to_vec(), rows }
    }

    fn multipliers(&self) -> String {
        format!("multipliers ({})", self.cells[0])
    }

    fn networks(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.foldings.iter().map(|f| f.network.as_str()).collect();
        names.dedup();
        names
    }

    /// dB against one figure, a series for each network; rings around dots would say no more than the table does.
    fn plot(&self, label: &str, figure: impl Fn(&Folding) -> f64) -> Plot {
        let series = |(place, name): (usize, &&str)| {
            let own = self.foldings.iter().filter(|f| f.network == **name && f.on_front);
            let points: Vec<[f64; 2]> = own.map(|f| [figure(f), f.psnr_db]).collect();
            // Without points there is no entry in the legend. The colour is that of all diagrams.
            let colour = PALETTE[place % PALETTE.len()];
            (!points.is_empty()).then(|| Series::new(*name, Mark::Points, points).coloured(colour))
        };
        Plot {
            // The axis states units and parts: a longer title would be cut.
            title: format!("dB against {}: the front", label.split(" (").next().unwrap_or(label)),
            x: Axis::log(label),
            y: Axis::linear("PSNR (dB)").from((self.min_db() - 0.5).floor()),
            size: SMALL,
            series: self.networks().iter().enumerate().filter_map(series).collect(),
        }
    }

    fn min_db(&self) -> f64 {
        self.foldings.iter().map(|f| f.psnr_db).fold(f64::INFINITY, f64::min)
    }

    /// What frames per second cost in multipliers.
    fn trade(&self) -> Plot {
        let series = |name: &&str| {
            let own = self.foldings.iter().filter(|f| f.network == **name);
            let points = own.map(|f| [f.multipliers as f64, f.frames_per_second]).collect::<Vec<_>>();
            Series::new(*name, Mark::LineAndPoints, points)
        };
        Plot {
            title: "Frames per second against multipliers".into(),
            x: Axis::log(self.multipliers()),
            y: Axis::linear(format!("frames per second at {} MHz", self.clock_mhz)).from(0.0),
            size: SMALL,
            series: self.networks().iter().map(series).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folding(network: &str, db: f64, cycles: f64, dsps: usize, on_front: bool) -> Folding {
        Folding {
            network: network.into(),
            camera: "c".into(),
            psnr_db: db,
            stages: "8x1 8x1".into(),
            cycles_per_patch: cycles,
            worst_picture_cycles_per_patch: cycles + 1.0,
            frames_per_second: 6000.0 / cycles,
            multipliers: dsps,
            memories: 10.5,
            on_front,
        }
    }

    fn study(foldings: Vec<Folding>) -> Foldings {
        Foldings {
            foldings,
            design: "kc705".into(),
            clock_mhz: 200.0,
            required_frames_per_second: 60.0,
            device: "xc7k325t".into(),
            cells: ["DSP48E1", "RAMB36E1"],
            pictures: "a picture".into(),
        }
    }

    #[test]
    fn the_best_network_that_is_fast_enough_is_named_with_its_cheapest_folding() {
        let study = study(vec![
            folding("slow", 33.0, 200.0, 100, true),
            folding("good", 31.0, 80.0, 800, true),
            folding("good", 31.0, 100.0, 700, true),
            folding("good", 31.0, 300.0, 90, true),
            folding("plain", 30.0, 100.0, 400, true),
        ]);
        assert_eq!(
            study.verdict(),
            "Of the networks that reach 60 frames per second at the planned 200 MHz, the best one, good (camera c), has 31.00 dB at \
             60.0 frames per second with 700 multipliers (DSP48E1). Others: slow reaches 30.0 frames per second at most; plain has \
             1.00 dB less, with 400 multipliers."
        );
        assert!(study.report("edof").to_html().contains("class=\"verdict\""));
    }

    #[test]
    fn where_no_network_is_fast_enough_the_verdict_says_so() {
        let study = study(vec![folding("a", 30.0, 200.0, 100, true), folding("a", 30.0, 150.0, 200, true)]);
        assert_eq!(
            study.verdict(),
            "No network reaches 60 frames per second at the planned 200 MHz. The fastest one, a (camera c), has 30.00 dB at 40.0 frames \
             per second with 200 multipliers (DSP48E1)."
        );
    }

    #[test]
    fn the_table_holds_the_front_and_the_diagrams_every_network() {
        let study = study(vec![
            folding("a", 30.0, 200.0, 100, true),
            folding("a", 30.0, 100.0, 400, true),
            folding("b", 29.0, 150.0, 500, false),
        ]);
        let page = study.to_markdown(&Made::by("edof study design"));
        assert!(page.contains("| a | c | 30.00 | 200.0 | 201.0 | 30.0 | 100 | 10.5 | 8x1 8x1 |"), "{page}");
        assert!(!page.contains("| b |"), "{page}");
        let html = study.report("edof study design").to_html();
        assert_eq!(html.matches("class=\"plot\"").count(), 4);
        assert!(html.contains("b: 500, 40"), "{html}");
        assert_eq!(
            html.matches("</svg>b</li>").count(),
            1,
            "where nothing of it is drawn, the legend is silent"
        );
    }
}
