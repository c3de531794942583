//! What a study of one depth says: error and time of each method, and what the paper says of both.

use crate::kodak::Measured;
use crate::made::Made;
use crate::single_depth::Row;
use crate::tables::noise_words;
use crate::told::{Told, ToldError};
use edof_image::{Noise, Tone};
use edof_io::photos::choices;
use edof_methods::method::{Family, Format, Method};
use edof_metrics::paired::Paired;
use edof_report::Report;
use edof_report::Table;
use edof_report::plot::{Axis, Mark, PALETTE, Plot, Series, stacked};
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
    /// Mean SSIM.
    pub ssim: f64,
    /// Mean wall-clock seconds a megapixel.
    pub seconds_per_megapixel: f64,
    /// Mean seconds a megapixel that all threads together were on a processor, where all rows tell it.
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

/// A sentence of the paper, and what it is here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Claim {
    /// What is compared.
    pub of: String,
    /// What the paper reports.
    pub paper: &'static str,
    /// What was measured.
    pub here: String,
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

impl Told for Speed {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, ToldError> {
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
        for (title, tables) in self.tables() {
            for table in tables {
                let _ = write!(text, "{title}\n{}\n", table.to_text());
            }
        }
        text.trim_end().to_owned()
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page = format!("# {TITLE}\n\n{made}\n\n{}\n", self.explanation());
        for (title, tables) in self.tables() {
            let _ = write!(page, "\n## {title}\n");
            tables.iter().for_each(|table| page.push_str(&format!("\n{}", table.to_markdown())));
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.made_by(command).method(&self.explanation());
        for ((title, tables), claims) in self.tables().into_iter().zip(&self.claims) {
            report.heading(&title);
            report.plots(&[self.plot(claims)]);
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
            "Means over {photos} photographs; differences are paired by photograph, with the standard error of their mean.{} PSNR in dB over red, green and blue, peak 1, border 8 cropped: of light, the method's values not clipped, where a \
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

    /// Title, averages and claims for each depth and noise level.
    fn tables(&self) -> Vec<(String, [Table; 2])> {
        let of = |c: &Claims| {
            let own = self.points.iter().filter(|p| c.hold(p));
            (c.title(), [averages(own), claims_table(&c.claims)])
        };
        self.claims.iter().map(of).collect()
    }

    /// PSNR against time; the strides of one method are joined, and the layers of untrained networks.
    fn plot(&self, of: &Claims) -> Plot {
        let own: Vec<&Point> = self.points.iter().filter(|p| of.hold(p)).collect();
        let mut series: Vec<Series> = vec![];
        for point in &own {
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
                    series.push(new.coloured(self.colour(&point.identity)));
                }
            }
        }
        // From cheap to dear: strides come in the order of their keys.
        series.iter_mut().for_each(|s| s.points.sort_by(|a, b| a[0].total_cmp(&b[0])));
        // What nobody trained may lie so deep that nothing else could be told apart.
        let least = own.iter().filter(|p| !p.identity.is_untrained()).map(|p| p.psnr_db).reduce(f64::min);
        let axis = Axis::linear("PSNR (dB)");
        Plot {
            title: format!("Error against speed: {}", of.title()),
            x: Axis::log(if self.points.iter().any(|p| p.cpu_seconds_per_megapixel.is_some()) {
                "CPU seconds a megapixel, all threads; .board: cycles at the planned clock"
            } else {
                "seconds a megapixel"
            }),
            y: least.map_or_else(|| axis.clone(), |least| axis.clone().from((least - 2.0).floor())),
            size: [900.0, 540.0],
            series,
        }
    }

    /// One for each network, and one for each kind of other methods.
    fn colour(&self, of: &Method) -> &'static str {
        let kind = match of.family {
            Family::DemosaicMalvar | Family::DemosaicDirectional => 6,
            Family::Wiener | Family::RichardsonLucy | Family::HyperLaplacian => 3,
            Family::BlindDeconvolution => 1,
            Family::Omp | Family::OmpKnownDepth | Family::Fista | Family::FistaKnownDepth => 2,
            Family::Untrained | Family::UntrainedDcRemoved => 7,
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

impl Claims {
    /// Whether they are of the same scenes as a point.
    fn hold(&self, point: &Point) -> bool {
        (self.psi.to_bits(), self.noise, self.tone) == (point.psi.to_bits(), point.noise, point.tone)
    }

    fn title(&self) -> String {
        let tone = match self.tone {
            Tone::Linear => "",
            Tone::Srgb => ", real light",
        };
        format!("ψ = {}, {}{tone}", self.psi, noise_words(self.noise))
    }
}

impl Point {
    /// Seconds a megapixel that do not depend on what else the machine does, where they are known.
    fn cost(&self) -> f64 {
        self.cpu_seconds_per_megapixel.unwrap_or(self.seconds_per_megapixel)
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
        let mean = |value: &dyn Fn(&Row) -> f64| own.iter().map(|r| value(r)).sum::<f64>() / own.len() as f64;
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
            psnr_db: mean(&|r| r.measured.picture.psnr_db),
            photo_psnr_db: own
                .iter()
                .map(|r| (r.measured.image.clone(), r.measured.picture.psnr_db))
                .collect(),
            ssim: mean(&|r| r.measured.picture.ssim),
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

fn name(method: &Method) -> String {
    method.stride.map_or_else(|| method.to_string(), |stride| format!("{method}/s{stride}"))
}

fn averages<'a>(points: impl Iterator<Item = &'a Point>) -> Table {
    let header = [
        "method",
        "PSNR dB",
        "SSIM",
        "seconds a megapixel",
        "CPU seconds a megapixel",
        "seconds to prepare",
        "steps",
        "memory, MiB",
        "non-zeros a patch",
        "photos",
    ];
    let row = |p: &Point| {
        let nonzeros = p
            .nonzeros_a_patch
            .as_ref()
            .map(|n| n.iter().map(|n| format!("{n:.1}")).collect::<Vec<_>>().join(" / "));
        vec![
            p.method.clone(),
            format!("{:.2}", p.psnr_db),
            format!("{:.3}", p.ssim),
            format!("{:.3}", p.seconds_per_megapixel),
            or_dash(p.cpu_seconds_per_megapixel.map(|seconds| format!("{seconds:.3}"))),
            format!("{:.3}", p.prepare_seconds),
            or_dash(p.iterations.map(|steps| format!("{steps:.0}"))),
            or_dash(p.peak_memory_bytes.map(|bytes| (bytes >> 20).to_string())),
            or_dash(nonzeros),
            p.photos.to_string(),
        ]
    };
    Table { header: header.map(str::to_owned).to_vec(), rows: points.map(row).collect() }
}

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "–".to_owned())
}

fn claims_table(claims: &[Claim]) -> Table {
    let header = ["the paper's claim", "paper", "here"].map(str::to_owned).to_vec();
    let rows = claims.iter().map(|c| vec![c.of.clone(), c.paper.to_owned(), c.here.clone()]).collect();
    Table { header, rows }
}

/// The paper's comparisons of all networks and strides that there are.
fn all_claims(points: &[&Point]) -> Vec<Claim> {
    let of = |family| points.iter().copied().find(move |p| p.identity.family == family);
    let blind = of(Family::BlindDeconvolution);
    let omp = |stride| {
        points.iter().copied().find(|p| p.identity.family == Family::Omp && p.identity.stride == stride)
    };
    let mut claims = vec![];
    let mut add = |of: String, paper: &'static str, here: String| claims.push(Claim { of, paper, here });
    // Of the photographs that both were measured on.
    let db = |a: &Point, b: &Point| {
        let paired = Paired::between(&a.photo_psnr_db, &b.photo_psnr_db);
        paired.map_or_else(|| "no photograph of both".to_owned(), |paired| format!("{paired} dB"))
    };
    let times = |slow: &Point, fast: &Point| {
        let wall = format!("{:.1} times", slow.seconds_per_megapixel / fast.seconds_per_megapixel);
        match slow.cpu_seconds_per_megapixel.zip(fast.cpu_seconds_per_megapixel) {
            Some((slow, fast)) => format!("{wall}, {:.1} times in CPU time", slow / fast),
            None => wall,
        }
    };
    let trained = |p: &&Point| p.identity.format == Some(Format::Float) && !p.identity.is_untrained();
    for net in points.iter().copied().filter(trained) {
        if let Some(omp) = omp(net.identity.stride) {
            add(format!("{} less {}", net.method, omp.method), "at least 0 dB", db(net, omp));
            add(
                format!("{} is faster than {}", net.method, omp.method),
                "more than 15 times",
                times(omp, net),
            );
        }
        if let Some(blind) = blind {
            add(format!("{} less {}", net.method, blind.method), "more than 1 dB", db(net, blind));
            add(
                format!("{} is faster than {}", net.method, blind.method),
                "more than 500 times",
                times(blind, net),
            );
        }
        let board = net.identity.in_format(Format::Board);
        if let Some(board) = points.iter().copied().find(|p| p.identity == board) {
            // Of one real frame of 1920×1080: 0.5 s against 140 s and 450 to 460 s.
            let mut faster = |slow: &Point, paper| {
                add(
                    format!("{} (by its cycles) is faster than {}", board.method, slow.method),
                    paper,
                    times(slow, board),
                );
            };
            omp(net.identity.stride).into_iter().for_each(|omp| faster(omp, "280 times"));
            blind.into_iter().for_each(|blind| faster(blind, "900 times"));
        }
        let twin = net.identity.in_format(Format::Fixed);
        if let Some(fixed) = points.iter().find(|p| p.identity == twin) {
            add(format!("{} less {}", fixed.method, net.method), "the same", db(fixed, net));
        }
    }
    for omp in points.iter().copied().filter(|p| p.identity.family == Family::Omp) {
        if let Some(blind) = blind {
            add(format!("{} less {}", omp.method, blind.method), "more than 1 dB", db(omp, blind));
            add(
                format!("{} is faster than {}", omp.method, blind.method),
                "about 30 times",
                times(blind, omp),
            );
        }
    }
    let layers = |t| points.iter().copied().filter(trained).find(move |p| p.identity.layers == Some(t));
    match (layers(8), layers(10)) {
        (Some(eight), Some(ten)) => {
            add(format!("{} less {}", eight.method, ten.method), "about 0 dB", db(eight, ten))
        }
        _ => add(
            "T = 8 less T = 10".into(),
            "about 0 dB",
            "not in these rows: docs/results/layers.md has trained networks of 8 and 10 layers".into(),
        ),
    }
    for eight in points.iter().copied().filter(|p| p.identity.is_untrained() && p.identity.layers == Some(8))
    {
        let twin = Method { layers: Some(10), ..eight.identity.clone() };
        if let Some(ten) = points.iter().find(|p| p.identity == twin) {
            let of = format!("{} less {}", eight.method, ten.method);
            add(of, "about 0 dB, of trained ones", db(eight, ten));
        }
    }
    claims
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::Proof;
    use crate::summary::tests::row;

    fn timed(method: &Method, image: &str, db: f64, seconds: f64) -> Row {
        let mut measured = row(method, image, 8.0, Noise::None, db);
        measured.seconds_per_megapixel = seconds;
        Row {
            measured,
            prepare_seconds: 0.5,
            repetitions: 3,
            iterations: (method.family == Family::Omp).then_some(16.0),
            peak_memory_bytes: Some(300 << 20),
            cpu_seconds_per_megapixel: (method.family == Family::Omp).then_some(1.5 * seconds),
            seconds_range: None,
            cpu_seconds_range: None,
            proof: Proof::default(),
        }
    }

    fn speed() -> Speed {
        let float = Method::network("n", Format::Float, 8, 4);
        let rows = [
            timed(&float, "a", 31.0, 0.1),
            timed(&float, "b", 33.0, 0.3),
            timed(&float.in_format(Format::Fixed), "a", 31.99, 0.2),
            timed(&float.in_format(Format::Board), "a", 31.99, 0.01),
            timed(&Method::of_patches(Family::Omp, 8), "a", 30.0, 6.0),
            timed(&Method::of_patches(Family::Omp, 8), "b", 31.0, 6.0),
            timed(&Method::of_patches(Family::Omp, 2), "a", 31.0, 60.0),
            timed(&Method::of_frames(Family::BlindDeconvolution), "a", 29.0, 120.0),
            timed(&Method::untrained(Family::Untrained, 8, 8), "a", 27.0, 0.2),
            timed(&Method::untrained(Family::Untrained, 8, 10), "a", 27.5, 0.3),
        ];
        Speed::new(&rows, "a machine".into()).unwrap()
    }

    #[test]
    fn points_are_means_over_photographs() {
        let points = speed().points;
        let first = &points[0];
        assert_eq!((first.method.as_str(), first.photos, first.psnr_db), ("n.float/s8", 2, 32.0));
        assert!((first.seconds_per_megapixel - 0.2).abs() < 1e-12 && points.len() == 8);
    }

    #[test]
    fn each_claim_of_the_paper_stands_beside_what_was_measured() {
        let page = speed().to_markdown(&Made::by("edof study single-depth"));
        for line in [
            "| n.float/s8 less omp/s8 | at least 0 dB | +1.50 ± 0.50 dB |",
            "| n.float/s8 is faster than omp/s8 | more than 15 times | 30.0 times |",
            "| n.float/s8 less blind-deconvolution | more than 1 dB | +2.00 dB |",
            "| n.float/s8 is faster than blind-deconvolution | more than 500 times | 600.0 times |",
            "| n.fixed/s8 less n.float/s8 | the same | +0.99 dB |",
            "| n.board/s8 (by its cycles) is faster than omp/s8 | 280 times | 600.0 times |",
            "| n.board/s8 (by its cycles) is faster than blind-deconvolution | 900 times | 12000.0 times |",
            "| omp/s2 less blind-deconvolution | more than 1 dB | +2.00 dB |",
            "| omp/s2 is faster than blind-deconvolution | about 30 times | 2.0 times |",
            "| T = 8 less T = 10 | about 0 dB | not in these rows: docs/results/layers.md has trained networks of 8 and 10 layers |",
            "| untrained-t8.float/s8 less untrained-t10.float/s8 | about 0 dB, of trained ones | -0.50 dB |",
        ] {
            assert!(page.contains(line), "{line}\n{page}");
        }
        assert!(!page.contains("untrained-t8.float/s8 less omp"), "{page}");
    }

    #[test]
    fn the_diagram_joins_the_strides_of_a_method_and_tells_its_numbers() {
        let speed = speed();
        assert_eq!(
            speed.plot(&speed.claims[0]).series.iter().map(|s| s.points.len()).collect::<Vec<_>>(),
            [1, 1, 1, 2, 1, 2]
        );
        let html = speed.report("edof study single-depth").to_html();
        assert!(html.contains("<title>omp: 90, 31</title>"), "{html}");
        assert!(
            !html.contains("http://")
                || html.matches("http://").count() == html.matches("http://www.w3.org/2000/svg").count()
        );
    }
}
