//! A study's tables, for a terminal, as Markdown and as a report with plots.

use crate::kodak::Row;
use crate::made::Made;
use crate::methods::method::{Family, Format, Method};
use crate::metrics::metric::Place;
use crate::metrics::paired::with_error;
use crate::metrics::quality::{cell, columns};
use crate::report::picture::Encoded;
use crate::report::plot::{Axis, Mark, PALETTE, Plot, SMALL, Series};
use crate::report::{Figure, Layout, Report, Table, csv};
use crate::study_report::{StudyReport, StudyReportError};
use crate::summary::{self, Crop, DepthCurve, MethodSummary, Study, Summary};
use crate::trial::{Measured, Work};
use crate::verdict::listed;
use edof_core::noise::SensorNoise;
use edof_core::words::count;
use edof_core::{Noise, Tone};
use edof_io::photos::choices;
use std::collections::BTreeSet;
use std::fmt::Write;

impl StudyReport for Study {
    type Row = Row;

    fn new(rows: &[Row], _: String) -> Result<Self, StudyReportError> {
        let mut rows: Vec<&Row> = rows.iter().collect();
        // Cameras and methods in the order of the command, the rest as in the file.
        rows.sort_by_key(|row| row.place);
        let crops = rows.iter().flat_map(|row| crops(row)).collect();
        let measured: Vec<Measured> = rows.into_iter().map(|row| row.measured.clone()).collect();
        Ok(Self { crops, ..Self::of(measured) })
    }

    /// Without pictures.
    fn csv(rows: &[Row]) -> String {
        let plain = |row: &Row| Row { crop: None, photograph_crop: None, ..row.clone() };
        csv::of(&rows.iter().map(plain).collect::<Vec<_>>())
    }

    fn to_text(&self) -> String {
        let mut text = self.verdict().map_or_else(String::new, |verdict| format!("{verdict}\n\n"));
        for (title, table) in self.tables().into_iter().chain([("Time".to_owned(), self.time())]) {
            let _ = write!(text, "{title}\n{}\n", table.to_text());
        }
        text.trim_end().to_owned()
    }

    /// The same rows give the same page: it holds no times.
    fn to_markdown(&self, made: &Made) -> String {
        let verdict = listed(self.verdict().as_slice());
        let mut page = format!("# {}\n\n{made}\n\n{verdict}{}\n", self.title(), self.explanation());
        for (title, table) in self.tables() {
            let _ = write!(page, "\n## {title}\n\n{}", table.to_markdown());
        }
        for note in &self.summary.notes {
            let _ = write!(page, "\n{note}\n");
        }
        page
    }

    /// PSNR against depth for each noise level, and the tables.
    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(self.title());
        self.verdict().iter().for_each(|verdict| {
            report.verdict(verdict);
        });
        report.made_by(command);
        report.paragraph(&self.explanation());
        self.summary.notes.iter().for_each(|note| {
            report.paragraph(note);
        });
        report.heading("PSNR at each depth");
        report.plots(&self.summary.plots());
        for (title, table) in self.tables().into_iter().chain([("Time".to_owned(), self.time())]) {
            report.heading(&title);
            table.add_to(&mut report, &[]);
        }
        report.heading("Photograph by photograph");
        for (title, table) in self.photographs() {
            report.subheading(&title);
            table.add_to(&mut report, &[]);
        }
        self.add_crops(&mut report);
        report
    }
}

/// The photograph's part, and the method's.
fn crops(row: &Row) -> Vec<Crop> {
    let Measured { image, noise, method, camera, picture, identity, .. } = &row.measured;
    let crop = |noise, title: String, psnr_db, picture: &Encoded| Crop {
        image: image.clone(),
        noise,
        title,
        psnr_db,
        picture: picture.0.clone(),
    };
    let photograph = row.photograph_crop.as_ref().map(|part| crop(None, "photograph".into(), None, part));
    let own = row.crop.as_ref().filter(|_| identity.format != Some(Format::Float422));
    let own =
        own.map(|part| crop(Some(*noise), format!("{method}, {camera}"), Some(picture.psnr_db()), part));
    photograph.into_iter().chain(own).collect()
}

impl Study {
    fn title(&self) -> String {
        let convention = match self.measure.tone {
            Tone::Linear => "photographs' numbers taken as linear light, the paper's convention",
            Tone::Srgb => "photographs decoded from sRGB to light, pictures encoded",
        };
        format!("Photographs through each network's camera: {convention}")
    }

    fn explanation(&self) -> String {
        let measured = match self.measure.tone {
            Tone::Linear => "the network's values are not clipped, the sensor's are",
            Tone::Srgb => "measured on the encoded picture, clipped to 0…1 as a screen does",
        };
        format!(
            "Means over {}. PSNR in dB over red, green and blue, peak {}, border {} cropped, {measured}; SSIM is the mean of \
             the colours. Each cell: at ψ = {} / at the worst ψ / average over ψ, each ± its standard error over photographs; SSIM over all.{}",
            count(self.rows.iter().map(|r| &r.image).collect::<BTreeSet<_>>().len(), "photograph"),
            self.measure.peak,
            self.measure.border,
            self.far(),
            choices(self.rows.iter().map(|r| r.image.as_str()))
        )
    }

    /// The farthest depth, in words.
    fn far(&self) -> String {
        psi_words(self.summary.methods.first().map_or(f64::NAN, |m| m.picture.farthest()[0]))
    }

    /// Title and table of the picture, of the light where that differs, and of what networks cost.
    fn tables(&self) -> Vec<(String, Table)> {
        let quality = |course: fn(&MethodSummary) -> &DepthCurve| self.summary.quality(course);
        let mut tables = match self.measure.tone {
            Tone::Linear => vec![("Picture".to_owned(), quality(|m| &m.picture))],
            Tone::Srgb => vec![
                ("Encoded picture".to_owned(), quality(|m| &m.picture)),
                ("Light, not clipped".to_owned(), quality(|m| &m.light)),
            ],
        };
        let further = self.summary.further(|m| &m.picture);
        tables.extend(
            further.map(|table| ("Further metrics of the picture, means over all".to_owned(), table)),
        );
        if !self.summary.differences.is_empty() {
            let title =
                "Differences of networks in dB of the picture, paired by photograph, with standard errors";
            tables.push((title.to_owned(), self.differences()));
        }
        if !self.summary.nets.is_empty() {
            tables.push((
                "What 4:2:2 and fixed point cost, and what the integers count".to_owned(),
                self.costs(),
            ));
        }
        tables
    }

    /// One line for every two networks, one column for each noise: at the farthest depth / average over depths.
    fn differences(&self) -> Table {
        let noises = self.summary.noises();
        let all = &self.summary.differences;
        let mut pairs: Vec<(&str, &str)> = vec![];
        for difference in all {
            let pair = (difference.first.as_str(), difference.second.as_str());
            if !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
        let row = |(first, second): (&str, &str)| {
            let cell = |noise: &Noise| {
                let own = all.iter().find(|d| (&*d.first, &*d.second, d.noise) == (first, second, *noise));
                own.map_or_else(|| "–".to_owned(), |d| format!("{} / {}", d.farthest, d.average))
            };
            std::iter::once(format!("{first} minus {second}")).chain(noises.iter().map(cell)).collect()
        };
        let header = std::iter::once(format!("ψ = {} / average over ψ", self.far()));
        Table {
            header: header.chain(noises.iter().copied().map(noise_words)).collect(),
            rows: pairs.into_iter().map(row).collect(),
        }
    }

    /// PSNR of every photograph, one table for each noise level: at the farthest depth / average over depths.
    fn photographs(&self) -> Vec<(String, Table)> {
        let far = self.summary.methods.first().map_or(f64::NAN, |m| m.picture.farthest()[0]);
        let subjects: Vec<_> = self.summary.subjects();
        let shown = || subjects.iter().filter(|s| s.0.format != Some(Format::Float422));
        let images: BTreeSet<&String> = self.rows.iter().map(|row| &row.image).collect();
        let table = |noise: Noise| {
            let header = std::iter::once("photograph".to_owned());
            let header =
                header.chain(shown().map(|(method, camera)| format!("{method}, {camera}"))).collect();
            let cell = |image: &str, (method, camera): &(&Method, &str)| {
                let own = self.rows.iter().filter(|row| {
                    row.image == image
                        && row.noise == noise
                        && row.identity == **method
                        && row.camera == *camera
                });
                let db: Vec<f64> = own.clone().map(|row| row.picture.psnr_db()).collect();
                let at_far = own.filter(|row| row.psi == far).map(|row| row.picture.psnr_db());
                if db.is_empty() {
                    return "–".to_owned();
                }
                format!("{:.2} / {:.2}", summary::mean(at_far), summary::mean(db.into_iter()))
            };
            let row = |image: &&String| {
                std::iter::once((*image).clone()).chain(shown().map(|subject| cell(image, subject))).collect()
            };
            let title =
                format!("{}: PSNR in dB at ψ = {} / average over ψ", noise_words(noise), psi_words(far));
            (title, Table { header, rows: images.iter().map(row).collect() })
        };
        self.summary.noises().into_iter().map(table).collect()
    }

    /// Parts of every photograph at the farthest depth, under the first noise level.
    fn add_crops(&self, report: &mut Report) {
        let Some(&noise) = self.summary.noises().first() else { return };
        let far = self.far();
        let images: BTreeSet<&String> = self.crops.iter().map(|crop| &crop.image).collect();
        for image in images {
            let mut has_photograph = false;
            let own = self.crops.iter().filter(|crop| crop.image == *image);
            let shown = own.filter(|crop| match crop.noise {
                None => !std::mem::replace(&mut has_photograph, true),
                Some(own) => own == noise,
            });
            let figure = |crop: &Crop| Figure {
                title: crop.title.clone(),
                note: crop
                    .psnr_db
                    .map_or_else(|| "as it is".to_owned(), |db| format!("{db:.2} dB, whole picture")),
                picture: crop.picture.clone(),
            };
            let figures: Vec<Figure> = shown.map(figure).collect();
            report.subheading(&format!("{image} at ψ = {far}, {}: its busiest part", noise_words(noise)));
            report.figures(&figures, Layout::Enlarged);
        }
    }

    fn costs(&self) -> Table {
        let header = [
            "network",
            "camera",
            "noise",
            "4:2:2 costs dB (most)",
            "fixed point loses dB (most)",
            "non-zeros after each shrinkage",
            "saturations",
            "multiplications per pixel, dense",
            "executed",
        ];
        let row = |n: &crate::summary::NetSummary| {
            let mut cells = vec![
                n.float.network.clone().unwrap_or_default(),
                n.camera.clone(),
                noise_words(n.noise),
                format!("{:.3} ({:.3})", n.mean_cost_of_422_db, n.largest_cost_of_422_db),
            ];
            match &n.fixed {
                Some(fixed) => {
                    cells.push(format!("{:.4} ({:.4})", fixed.mean_loss_db, fixed.largest_loss_db));
                    cells.extend(work_cells(&fixed.work));
                }
                None => cells.extend(std::iter::repeat_n("–".to_owned(), 5)),
            }
            cells
        };
        let rows = self.summary.nets.iter().map(row).collect();
        Table { header: header.map(str::to_owned).to_vec(), rows }
    }

    fn time(&self) -> Table {
        let rows = self.summary.subjects().into_iter().map(|subject| {
            let own = self.summary.noises().into_iter().filter_map(|noise| self.summary.find(subject, noise));
            let seconds: Vec<f64> = own.map(|m| m.seconds_per_megapixel).collect();
            let mean = summary::mean(seconds.into_iter());
            vec![subject.0.to_string(), subject.1.to_owned(), format!("{mean:.4}")]
        });
        let header = ["method", "camera", "seconds per megapixel"].map(str::to_owned).to_vec();
        Table { header, rows: rows.collect() }
    }
}

/// What has a colour of its own: a method, or a network in all formats, behind a camera.
type Kind<'a> = (Family, Option<&'a str>, &'a str);

/// Places in the palette: networks take all but the first one in turn, so that seven of them differ; the dashed lines of all others take the
/// first one and then those from the end.
fn places(kinds: &[Kind<'_>]) -> Vec<usize> {
    let place = |index: usize| {
        let is_network = kinds[index].1.is_some();
        let before = kinds[..index].iter().filter(|kind| kind.1.is_some() == is_network).count();
        let place = if is_network { before + 1 } else { PALETTE.len() - before % PALETTE.len() };
        place % PALETTE.len()
    };
    (0..kinds.len()).map(place).collect()
}

impl Summary {
    /// PSNR and the metrics of every table.
    fn quality(&self, course: impl Fn(&MethodSummary) -> &DepthCurve) -> Table {
        let metrics = columns(std::iter::empty());
        let titles = || metrics.iter().map(|metric| metric.heading());
        let psnr =
            |course: &DepthCurve| course.cells().map(|(mean, error)| with_error(mean, error)).join(" / ");
        let cells = |course: &DepthCurve| {
            let means = metrics.iter().map(|metric| cell(&course.means, metric));
            std::iter::once(psnr(course)).chain(means).collect()
        };
        self.by_noise(course, |noise| std::iter::once(noise_words(noise)).chain(titles()).collect(), cells)
    }

    /// Means of the metrics that newer rows hold besides; nothing if these hold none.
    fn further(&self, course: impl Fn(&MethodSummary) -> &DepthCurve) -> Option<Table> {
        let mut metrics = columns(self.methods.iter().map(|m| &course(m).means));
        metrics.retain(|metric| metric.place == Place::Further);
        let titles = |noise: Noise| {
            metrics.iter().map(|metric| format!("{}, {}", metric.heading(), noise_words(noise))).collect()
        };
        let cells = |course: &DepthCurve| metrics.iter().map(|metric| cell(&course.means, metric)).collect();
        (!metrics.is_empty()).then(|| self.by_noise(course, titles, cells))
    }

    /// One line for each method and camera, a group of columns for each noise level. `float422` is left out: it lies on the fixed line.
    fn by_noise(
        &self,
        course: impl Fn(&MethodSummary) -> &DepthCurve,
        titles: impl Fn(Noise) -> Vec<String>,
        cells: impl Fn(&DepthCurve) -> Vec<String>,
    ) -> Table {
        let noises = self.noises();
        let mut header = vec!["method".to_owned(), "camera".into()];
        header.extend(noises.iter().flat_map(|&noise| titles(noise)));
        let shown = self.subjects().into_iter().filter(|s| s.0.format != Some(Format::Float422));
        let rows = shown.map(|subject| {
            let own = |&noise: &Noise| match self.find(subject, noise) {
                Some(summary) => cells(course(summary)),
                None => vec!["–".to_owned(); titles(noise).len()],
            };
            let names = [subject.0.to_string(), subject.1.to_owned()];
            names.into_iter().chain(noises.iter().flat_map(own)).collect()
        });
        Table { header, rows: rows.collect() }
    }

    /// PSNR against ψ, one diagram for each noise level; solid lines are float, dotted ones fixed point in the colour of their float, dashed
    /// ones the rest.
    /// `float422` is left out: it lies on the fixed line.
    #[must_use]
    pub fn plots(&self) -> Vec<Plot> {
        let mut kinds: Vec<Kind<'_>> = vec![];
        for (method, camera) in self.subjects() {
            let kind = (method.family, method.network.as_deref(), camera);
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        let places = places(&kinds);
        let line = |m: &MethodSummary| {
            let kind: Kind<'_> = (m.identity.family, m.identity.network.as_deref(), &m.camera);
            let place = kinds.iter().position(|known| *known == kind).map_or(0, |index| places[index]);
            let mark = match m.identity.format {
                Some(Format::Float422) => return None,
                Some(Format::Float | Format::FloatGpu) => Mark::LineAndPoints,
                Some(Format::Fixed | Format::Board | Format::FixedGpu) => Mark::Dotted,
                None => Mark::Dashed,
            };
            let series =
                Series::new(format!("{}, {}", m.method, m.camera), mark, m.picture.psi_db.iter().copied());
            Some(series.coloured(PALETTE[place]))
        };
        let plot = |noise: Noise| Plot {
            title: noise_words(noise),
            x: Axis::linear("ψ (rad)"),
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: self.methods.iter().filter(|m| m.noise == noise).filter_map(line).collect(),
        };
        self.noises().into_iter().map(plot).collect()
    }
}

fn work_cells(work: &Work) -> [String; 4] {
    let dash = || "–".to_owned();
    let number = |value: Option<f64>| value.map_or_else(dash, |v| format!("{v:.0}"));
    let nonzeros = work
        .nonzeros_a_patch
        .as_ref()
        .map_or_else(dash, |layers| layers.iter().map(|n| format!("{n:.1}")).collect::<Vec<_>>().join(" / "));
    [
        nonzeros,
        work.saturations.map_or_else(dash, |n| n.to_string()),
        number(work.dense_multiplications_a_pixel),
        number(work.executed_multiplications_a_pixel),
    ]
}

/// What tables call a depth: ψ with two decimals at most.
pub(crate) fn psi_words(psi: f64) -> String {
    // Adding 0 leaves no −0.
    ((100.0 * psi).round() / 100.0 + 0.0).to_string()
}

/// What tables call a noise.
pub(crate) fn noise_words(noise: Noise) -> String {
    match noise {
        Noise::None => "no noise".to_owned(),
        Noise::Gaussian { sigma } => format!("σ = {sigma}"),
        Noise::Sensor(sensor) if sensor == (SensorNoise { gain: sensor.gain, ..SensorNoise::default() }) => {
            format!("sensor, gain {}", sensor.gain)
        }
        Noise::Sensor(_) => noise.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::tests::{net, row};

    fn study(tone: Tone) -> Study {
        let noisy = Noise::sensor(8.0);
        let rows = vec![
            row(&Method::demosaic(), "p", 0.0, Noise::None, 29.0),
            row(&net(Format::Float), "p", 0.0, Noise::None, 34.5),
            row(&net(Format::Float), "p", 8.0, Noise::None, 33.5),
            row(&net(Format::Float422), "p", 8.0, Noise::None, 33.25),
            row(&net(Format::Fixed), "p", 8.0, Noise::None, 33.0),
            row(&net(Format::Float), "p", 8.0, noisy, 30.0),
        ];
        Study::of(rows.into_iter().map(|row| Measured { tone, ..row }).collect())
    }

    #[test]
    fn a_cell_has_the_standard_errors_over_photographs() {
        let at = |image: &str, psi: f64, db: f64| row(&net(Format::Float), image, psi, Noise::None, db);
        // At psi 0: 30 and 31 dB, at psi 8: 28 and 32 dB, averages over depths 29 and 31.5 dB. The error of two is half of their difference.
        let study =
            Study::of(vec![at("p", 0.0, 30.0), at("q", 0.0, 31.0), at("p", 8.0, 28.0), at("q", 8.0, 32.0)]);
        let page = study.to_markdown(&Made::by(""));
        assert!(
            page.contains("| n.float | clear | 30.00 ± 2.00 / 30.00 ± 2.00 / 30.25 ± 1.25 | 0.900 |"),
            "{page}"
        );
    }

    #[test]
    fn a_cell_says_the_farthest_depth_the_worst_and_the_average() {
        let page = study(Tone::Linear).to_markdown(&Made::by("edof study kodak"));
        let table = "| method | camera | no noise | SSIM | sensor, gain 8 | SSIM |\n\
                     |---|---|---|---|---|---|\n\
                     | demosaic-malvar | clear | 29.00 / 29.00 / 29.00 | 0.900 | – | – |\n\
                     | n.float | clear | 33.50 / 33.50 / 34.00 | 0.900 | 30.00 / 30.00 / 30.00 | 0.900 |\n\
                     | n.fixed | clear | 33.00 / 33.00 / 33.00 | 0.900 | – | – |\n";
        assert!(page.contains(table), "{page}");
        assert!(page.contains("`edof study kodak`"));
    }

    #[test]
    fn light_has_a_table_of_its_own_under_srgb_alone() {
        let light = "| n.float | clear | 35.50 / 35.50 / 36.00 |";
        assert!(study(Tone::Srgb).to_markdown(&Made::by("")).contains(light));
        assert!(!study(Tone::Linear).to_markdown(&Made::by("")).contains(light));
    }

    #[test]
    fn what_a_network_did_not_count_is_a_dash() {
        let page = study(Tone::Linear).to_markdown(&Made::by(""));
        assert!(
            page.contains("| n | clear | no noise | 0.250 (0.250) | 0.2500 (0.2500) | – | – | – | – |"),
            "{page}"
        );
    }

    #[test]
    fn a_network_has_one_colour_whatever_its_format() {
        let plots = study(Tone::Linear).summary.plots();
        let colours: Vec<&str> = plots[0].series.iter().map(|s| s.colour.as_deref().unwrap()).collect();
        assert_eq!(colours, [PALETTE[0], PALETTE[1], PALETTE[1]], "{:?}", plots[0].series);
        assert_eq!(plots[0].series[2].mark, Mark::Dotted);
    }

    #[test]
    fn seven_networks_behind_three_cameras_have_colours_of_their_own() {
        let family = study(Tone::Linear).summary.methods[0].identity.family;
        let cameras = [("a", 3), ("b", 2), ("c", 2)];
        let names = ["1", "2", "3", "4", "5", "6", "7"];
        let mut next = names.iter();
        let mut kinds: Vec<Kind<'_>> = vec![];
        for (camera, networks) in cameras {
            kinds.push((family, None, camera));
            kinds.extend(next.by_ref().take(networks).map(|name| (family, Some(*name), camera)));
        }
        assert_eq!(places(&kinds), [0, 1, 2, 3, 7, 4, 5, 6, 6, 7]);
    }

    #[test]
    fn the_report_draws_one_line_a_method_and_noise() {
        let study = study(Tone::Srgb);
        let drawn: Vec<usize> = study.summary.plots().iter().map(|p| p.series.len()).collect();
        assert_eq!(drawn, [3, 1]);
        let html = study.report("edof study").to_html();
        assert!(html.contains("edof study") && html.contains("Light, not clipped"));
    }
}
