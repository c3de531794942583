//! What rows of codes say: over which depths a method keeps codes readable.

use super::{Reader, Row, Symbology};
use crate::made::Made;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::tables::{noise_words, psi_words};
use edof_core::Noise;
use serde::Serialize;

/// The share of codes from which a depth counts as readable.
const READABLE: f64 = 0.95;
const TITLE: &str = "Codes that can be read";

/// One method behind one lens on codes of one kind and size in one light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reached {
    /// Name of the camera.
    pub camera: String,
    /// Name of the method.
    pub method: String,
    /// Kind of code.
    pub symbology: Symbology,
    /// Side of a module in pixels.
    pub module_px: f64,
    /// Noise behind the widest lens.
    pub noise: Noise,
    /// The program that reads.
    pub reader: Reader,
    /// The longest run of depths at each of which 95 % or more are read, from its first ψ to its last.
    pub psi_range: Option<[f64; 2]>,
    /// Share of all codes that are read.
    pub rate: f64,
    /// Its binomial standard error.
    pub rate_error: f64,
    /// Share that is read at each ψ.
    pub by_psi: Vec<[f64; 2]>,
    #[serde(skip)]
    place: usize,
}

impl Reached {
    /// Sums up rows of one method, kind, size, light and reader.
    fn of(rows: &[&Row]) -> Self {
        let mut rows = rows.to_vec();
        rows.sort_by(|a, b| a.psi.total_cmp(&b.psi));
        let first = rows[0];
        let [read, of] =
            [rows.iter().map(|row| row.read).sum::<usize>(), rows.iter().map(|row| row.of).sum()];
        let rate = read as f64 / of as f64;
        let by_psi: Vec<[f64; 2]> =
            rows.iter().map(|row| [row.psi, row.read as f64 / row.of as f64]).collect();
        Self {
            camera: first.camera.clone(),
            method: first.method.clone(),
            symbology: first.symbology,
            module_px: first.module_px,
            noise: first.noise,
            reader: first.reader,
            psi_range: longest_run(&by_psi),
            rate,
            rate_error: (rate * (1.0 - rate) / of as f64).sqrt(),
            by_psi,
            place: first.place,
        }
    }

    /// Width of the readable range; 0 where none or one depth is readable.
    fn width(&self) -> f64 {
        self.psi_range.map_or(0.0, |[first, last]| last - first)
    }
}

/// Returns the widest run of neighbouring depths that are all readable.
fn longest_run(by_psi: &[[f64; 2]]) -> Option<[f64; 2]> {
    let runs = by_psi.chunk_by(|a, b| (a[1] >= READABLE) == (b[1] >= READABLE));
    let readable = runs.filter(|run| run[0][1] >= READABLE).map(|run| [run[0][0], run[run.len() - 1][0]]);
    readable.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Codes {
    /// What each method reaches, in the order of the command.
    pub reached: Vec<Reached>,
}

/// Rows of one table.
type Group = (String, f64, Reader);

impl StudyReport for Codes {
    type Row = Row;

    fn new(rows: &[Row], _machine: String) -> Result<Self, StudyReportError> {
        let key = |row: &Row| {
            (
                row.place,
                row.camera.clone(),
                row.symbology,
                row.module_px.to_bits(),
                row.noise.to_string(),
                row.reader,
            )
        };
        let mut sorted: Vec<&Row> = rows.iter().collect();
        sorted.sort_by_key(|row| key(row));
        let mut reached: Vec<Reached> = sorted.chunk_by(|a, b| key(a) == key(b)).map(Reached::of).collect();
        reached.sort_by(|a, b| {
            let of = |r: &Reached| (r.reader, r.place, r.symbology);
            a.module_px.total_cmp(&b.module_px).then(of(a).cmp(&of(b)))
        });
        Ok(Self { reached })
    }

    fn to_text(&self) -> String {
        let tables = self
            .groups()
            .into_iter()
            .map(|group| format!("{}\n{}", heading(&group), self.table(&group).to_text()));
        format!("{}\n{}", tables.collect::<Vec<_>>().join("\n"), self.verdicts().join("\n"))
    }

    fn to_markdown(&self, made: &Made) -> String {
        let verdicts: String = self.verdicts().iter().map(|verdict| format!("- {verdict}\n")).collect();
        let tables: String = self
            .groups()
            .into_iter()
            .map(|group| format!("\n## {}\n\n{}", heading(&group), self.table(&group).to_markdown()))
            .collect();
        format!("# {TITLE}\n\n{made}\n\n{EXPLANATION}\n\n## Verdict\n\n{verdicts}{tables}")
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        self.verdicts().iter().for_each(|verdict| {
            report.verdict(verdict);
        });
        report.made_by(command).method(EXPLANATION);
        for group in self.groups() {
            report.heading(&heading(&group));
            report.plots(&self.plots(&group));
            self.table(&group).add_to(&mut report, &[]);
        }
        report
    }
}

const EXPLANATION: &str = "Sheets of random codes of linear light 0.8 and 0.04, each code at its own place to a 64th of a pixel, are blurred \
    by each lens at one depth, exposed with 16 bits and noise, and reconstructed. A program that is not ours looks for one code in the cell of \
    each, in the luma of the picture encoded as sRGB. A code counts if its text is right. Modules have the same size in pixels at every \
    depth. All lenses see the same scene for the same time: ψ and noise are those of the widest lens, and a smaller aperture has less of both \
    light and ψ. A range is the widest run of depths at each of which 95 % or more of the codes are read; ± is the binomial standard error. Text \
    for human readers is not measured.";

/// Returns the title of a table.
fn heading((noise, module_px, reader): &Group) -> String {
    format!("{noise}, modules of {module_px} pixels, read by {reader}")
}

impl Codes {
    fn groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = vec![];
        for reached in &self.reached {
            let group = group_of(reached);
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        groups
    }

    /// What is reached in a group by each method: a list for each, one item for each kind of code.
    fn methods(&self, group: &Group) -> Vec<Vec<&Reached>> {
        let mut own: Vec<&Reached> =
            self.reached.iter().filter(|reached| group_of(reached) == *group).collect();
        own.sort_by_key(|reached| (reached.place, reached.symbology));
        own.chunk_by(|a, b| a.place == b.place).map(<[_]>::to_vec).collect()
    }

    fn table(&self, group: &Group) -> Table {
        let methods = self.methods(group);
        let kinds = methods.first().into_iter().flatten().map(|reached| reached.symbology.to_string());
        let header = ["lens", "method"].map(str::to_owned).into_iter().chain(kinds);
        let range = |reached: &&Reached| match reached.psi_range {
            Some([first, last]) if first < last => format!("ψ {} to {}", psi_words(first), psi_words(last)),
            Some([only, _]) => format!("ψ {}", psi_words(only)),
            None => "none".to_owned(),
        };
        let row = |own: &Vec<&Reached>| {
            let mut cells = vec![own[0].camera.clone(), own[0].method.clone()];
            cells.extend(own.iter().map(|reached| {
                format!(
                    "{}; {:.0} ± {:.0} %",
                    range(reached),
                    100.0 * reached.rate,
                    100.0 * reached.rate_error
                )
            }));
            cells.push(format!("{:.1}", mean_width(own)));
            cells
        };
        Table {
            header: header.chain(["mean width".to_owned()]).collect(),
            rows: methods.iter().map(row).collect(),
        }
    }

    /// A sentence for each table: who keeps codes readable over the widest range, and the best that needs no network.
    fn verdicts(&self) -> Vec<String> {
        let sentence = |group: &Group| {
            let methods = self.methods(group);
            let widest = |methods: &mut dyn Iterator<Item = &Vec<&Reached>>| {
                let best = methods.fold(None, |best: Option<&Vec<&Reached>>, own| match best {
                    Some(best) if score(best) >= score(own) => Some(best),
                    _ => Some(own),
                });
                best.map(|own| {
                    let [width, rate] = [mean_width(own), 100.0 * mean_rate(own)];
                    format!(
                        "{} behind {}, ψ {width:.1} wide ({rate:.0} % of all codes)",
                        own[0].method, own[0].camera
                    )
                })
            };
            let best = widest(&mut methods.iter()).unwrap_or_default();
            let plain = widest(&mut methods.iter().filter(|own| own[0].method.starts_with("demosaic")));
            let plain = plain.map(|plain| format!("; without a network {plain}")).unwrap_or_default();
            format!("{}: the widest is {best}{plain}.", heading(group))
        };
        self.groups().iter().map(sentence).collect()
    }

    /// The rate over depth of each method: the mean over kinds of codes.
    fn plots(&self, group: &Group) -> Vec<Plot> {
        let curve = |own: &Vec<&Reached>| {
            let points = own[0].by_psi.iter().enumerate().map(|(place, [psi, _])| {
                [*psi, own.iter().map(|reached| reached.by_psi[place][1]).sum::<f64>() / own.len() as f64]
            });
            Series::new(format!("{}, {}", own[0].camera, own[0].method), Mark::LineAndPoints, points)
        };
        vec![Plot {
            title: "codes that are read".to_owned(),
            x: Axis::linear("ψ (radians)"),
            y: Axis::linear("share, all kinds").from(0.0).to(1.0),
            size: SMALL,
            series: self.methods(group).iter().map(curve).collect(),
        }]
    }
}

fn group_of(reached: &Reached) -> Group {
    (noise_words(reached.noise), reached.module_px, reached.reader)
}

fn mean_width(own: &[&Reached]) -> f64 {
    own.iter().map(|reached| reached.width()).sum::<f64>() / own.len() as f64
}

fn mean_rate(own: &[&Reached]) -> f64 {
    own.iter().map(|reached| reached.rate).sum::<f64>() / own.len() as f64
}

/// Ranges first, then all codes.
fn score(own: &[&Reached]) -> (f64, f64) {
    (mean_width(own), mean_rate(own))
}
