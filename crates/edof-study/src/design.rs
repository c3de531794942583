//! What foldings of networks are worth: dB against cycles, multipliers and frames per second, and which of them are Pareto-optimal.

use crate::made::Made;
use edof_report::Report;
use edof_report::Table;
use edof_report::plot::{Axis, Mark, PALETTE, Plot, SMALL, Series};
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
    pub dsp48e1: usize,
    /// Block RAMs of 36 kbit; halves count half.
    pub ramb36: f64,
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
    /// Device that all of them fit.
    pub device: String,
    /// What they were measured on.
    pub pictures: String,
}

const TITLE: &str = "Networks that fit the board: dB against cycles, multipliers and frames a second";

impl Foldings {
    /// The front for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        self.front().to_text().trim_end().to_owned()
    }

    /// The same as a Markdown page; `command` is the command that makes it again.
    #[must_use]
    pub fn to_markdown(&self, made: &Made) -> String {
        format!("# {TITLE}\n\n{made}\n\n{}\n\n{}", self.explanation(), self.front().to_markdown())
    }

    /// A report with a diagram for each figure.
    #[must_use]
    pub fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.paragraph(&self.explanation()).made_by(command);
        report.plots(&[
            self.plot("cycles per patch", |f| f.cycles_per_patch),
            self.plot("multipliers (DSP48E1)", |f| f.dsp48e1 as f64),
            self.plot("frames per second", |f| f.frames_per_second),
            self.trade(),
        ]);
        report.heading("The front");
        self.front().add_to(&mut report, &[]);
        report
    }

    fn explanation(&self) -> String {
        format!(
            "Every folding that fits a {}, by the cycle model on {}, with the picture and the clock of design {} ({} MHz, planned). Frames \
             a second are cycles at that clock: computed, measured on no board; multipliers and block RAM are exact. PSNR is that of each network behind its \
             own camera, so networks of different cameras are different lenses too. The front holds what no other folding of any network beats in dB, cycles, multipliers and block RAM at once.",
            self.device, self.pictures, self.design, self.clock_mhz
        )
    }

    fn front(&self) -> Table {
        let header = [
            "network",
            "camera",
            "PSNR dB",
            "cycles a patch",
            "worst picture",
            "frames a second",
            "DSP48E1",
            "RAMB36E1",
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
                f.dsp48e1.to_string(),
                format!("{:.1}", f.ramb36),
                f.stages.clone(),
            ]
        };
        let rows = self.foldings.iter().filter(|f| f.on_front).map(row).collect();
        Table { header: header.map(str::to_owned).to_vec(), rows }
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
            title: format!("dB against {label}: the front"),
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
            let points = own.map(|f| [f.dsp48e1 as f64, f.frames_per_second]).collect::<Vec<_>>();
            Series::new(*name, Mark::LineAndPoints, points)
        };
        Plot {
            title: "Frames a second against multipliers".into(),
            x: Axis::log("multipliers (DSP48E1)"),
            y: Axis::linear(format!("frames a second at {} MHz", self.clock_mhz)).from(0.0),
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
            dsp48e1: dsps,
            ramb36: 10.5,
            on_front,
        }
    }

    #[test]
    fn the_table_holds_the_front_and_the_diagrams_every_network() {
        let study = Foldings {
            foldings: vec![
                folding("a", 30.0, 200.0, 100, true),
                folding("a", 30.0, 100.0, 400, true),
                folding("b", 29.0, 150.0, 500, false),
            ],
            design: "kc705".into(),
            clock_mhz: 200.0,
            device: "xc7k325t".into(),
            pictures: "a picture".into(),
        };
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
