//! How far a lens is from what no lens passes, over ranges of depth and lights: rows, a page, two figures.

use crate::made::Made;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series, USUAL};
use crate::report::{Report, Table};
use crate::verdict::listed;
use edof_core::Channel;
use edof_core::camera::Camera;
use edof_numerics::fft::Complex64;
use edof_optics::Statistics;
use edof_optics::bound::ceiling::{Ceiling, ceilings, limits};
use edof_optics::bound::judge::{Best, BoundError, Judge, Setting, Sides, possible};
use edof_optics::bound::lenses::{closed, without_mask};
use edof_optics::bound::transfer::{Sampling, Transfer, transfers};
use edof_optics::bound::{GRID, Light, Reached};
use serde::Serialize;

/// Stops by which the lenses are closed.
const STOPS: [f64; 6] = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5];
/// Lights of the figure, in electrons.
const LIGHTS: [f64; 7] = [30.0, 100.0, 300.0, 1000.0, 3000.0, 10_000.0, 30_000.0];
/// Depths over which the figure's contrast is averaged.
const DEPTHS: usize = 25;

/// A lens, its clear lens and the limit, for one range of depths in one light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Row {
    /// Range of ψ at the open aperture.
    pub psi_range: [f64; 2],
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// The lens without its mask.
    pub clear: Best,
    /// The lens.
    pub lens: Best,
    /// What no lens passes.
    pub ceiling: Ceiling,
}

impl Row {
    /// Returns the most that any lens has over the best clear one, with the depth known.
    #[must_use]
    pub fn any_minus_clear(&self) -> Reached {
        let limit = self.ceiling.bayer_db;
        Reached { average_db: limit, worst_db: limit }.minus(self.clear.known_peaks)
    }

    /// Returns the same from three full planes of colour.
    #[must_use]
    pub fn any_minus_clear_in_planes(&self) -> Reached {
        let limit = self.ceiling.planes_db;
        Reached { average_db: limit, worst_db: limit }.minus(self.clear.planes_peaks)
    }
}

/// A camera against the limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bound {
    /// Name of the camera.
    pub camera: String,
    /// Read noise in electrons.
    pub read_noise_e: f64,
    /// Mean light of the scene.
    pub mean_light: f64,
    /// Range by range, the least light first.
    pub rows: Vec<Row>,
}

/// Judges a camera, its clear lens and the limit over ranges of ψ, in each light.
///
/// # Errors
/// [`BoundError`].
pub fn bound(
    camera: &Camera,
    ranges: &[[f64; 2]],
    lights: &[Light],
    statistics: &Statistics,
) -> Result<Bound, BoundError> {
    let mut rows = vec![];
    for &psi_range in ranges {
        let camera = Camera { psi_range, ..camera.clone() };
        let stops = possible(&camera, &STOPS)?;
        let judge = Judge::new(lights, &stops, Sampling::Fine, statistics);
        let clear = judge.best(&without_mask(&camera), Sides::Alike);
        let lens = if !camera.is_clear() { judge.best(&camera, Sides::Differ) } else { clear.clone() };
        let ceilings = ceilings(&camera, lights, stops[0], statistics);
        let measured = lights.iter().zip(clear).zip(lens).zip(ceilings);
        rows.extend(measured.map(|(((light, clear), lens), ceiling)| Row {
            psi_range,
            electrons: light.electrons,
            clear,
            lens,
            ceiling,
        }));
    }
    let (read_noise_e, mean_light) =
        lights.first().map_or((0.0, 0.0), |light| (light.read_noise_e, light.mean));
    Ok(Bound { camera: camera.name.clone(), read_noise_e, mean_light, rows })
}

/// Contrast of lens and pixel along a row of pixels, root mean square over a range of depths, beside the limit: a plot for each colour.
#[must_use]
pub fn frequency_plots(camera: &Camera) -> Vec<Plot> {
    let [low, high] = camera.psi_range;
    let psis: Vec<f64> = (0..DEPTHS).map(|i| low + (high - low) * (i as f64 + 0.5) / DEPTHS as f64).collect();
    let clear = Camera { focus_psi: 0.5 * (low + high), ..without_mask(camera) };
    let smaller: Vec<f64> = psis.iter().map(|psi| 0.5 * psi).collect();
    let mut lenses = vec![
        ("clear lens", Mark::Line, transfers(&clear, &psis, Sampling::Fine)),
        ("clear, one stop closed", Mark::Dashed, transfers(&closed(&clear, 1.0), &smaller, Sampling::Fine)),
    ];
    if !camera.is_clear() {
        lenses.push((camera.name.as_str(), Mark::Line, transfers(camera, &psis, Sampling::Fine)));
    }
    let limit = limits(camera).mean;
    let frequency = |i: usize| i as f64 / GRID as f64;
    let plot = |channel: Channel| {
        let root = |transfers: &[Transfer], i: usize| {
            let sum: f64 = transfers.iter().map(|t| t[channel.plane()][(0, i)].norm_sqr()).sum();
            (sum / transfers.len() as f64).sqrt()
        };
        let mut series: Vec<Series> = lenses
            .iter()
            .map(|(name, mark, seen)| {
                Series::new(*name, *mark, (0..=GRID / 2).map(|i| [frequency(i), root(seen, i)]))
            })
            .collect();
        let at = |plane: &ndarray::Array2<Complex64>, i| plane[(0, i)].re;
        let points = (0..=GRID / 2).map(|i| [frequency(i), at(&limit[channel.plane()], i)]);
        series.push(Series::new("no lens passes", Mark::Dotted, points).coloured("#000000"));
        Plot {
            title: format!("Contrast over ψ {low} to {high}: {}", format!("{channel:?}").to_lowercase()),
            x: Axis::linear("cycles per pixel").from(0.0).to(0.5),
            y: Axis::linear("contrast, rms over depths").from(0.0).to(1.0),
            size: SMALL,
            series,
        }
    };
    Channel::ALL.map(plot).to_vec()
}

/// dB over light, average and worst depth: the clear lens, the lens and the limit, depth known.
///
/// # Errors
/// [`BoundError`].
pub fn light_plots(camera: &Camera, light: Light, statistics: &Statistics) -> Result<Vec<Plot>, BoundError> {
    let lights = LIGHTS.map(|electrons| Light { electrons, ..light });
    let Bound { rows, .. } = bound(camera, &[camera.psi_range], &lights, statistics)?;
    let plot = |title: &str, of: fn(Reached) -> f64| {
        let line = |name: &str, mark: Mark, value: &dyn Fn(&Row) -> f64| {
            Series::new(name, mark, rows.iter().map(|row| [row.electrons, value(row)]))
        };
        let mut series = vec![
            line("clear lens, depth known", Mark::Line, &|r| of(r.clear.known.reached)),
            line("clear lens, blind", Mark::Dashed, &|r| of(r.clear.blind.reached)),
        ];
        if !camera.is_clear() {
            series.push(line(&format!("{}, depth known", camera.name), Mark::Line, &|r| {
                of(r.lens.known.reached)
            }));
            series
                .push(line(&format!("{}, blind", camera.name), Mark::Dashed, &|r| of(r.lens.blind.reached)));
        }
        series.push(line("no lens passes", Mark::Dotted, &|r| r.ceiling.bayer_db).coloured("#000000"));
        let [low, high] = camera.psi_range;
        Plot {
            title: format!("{title}, ψ {low} to {high}"),
            x: Axis::log("electrons of a white pixel"),
            y: Axis::linear("PSNR, dB"),
            size: USUAL,
            series,
        }
    };
    Ok(vec![plot("Average over depths", |r| r.average_db), plot("Worst depth", |r| r.worst_db)])
}

const TITLE: &str = "What no lens passes, and how near to it lenses come";

const EXPLANATION: &str = "Everything here is linear: the best linear estimate of a colour picture from the sensor's samples, with the statistics of \
    photographs that `edof optics design` has, on a torus of 32 pixels. Noise is that of a pixel of mean light. Light is stated as the electrons of a \
    white pixel behind the open aperture; closing by one stop halves it. PSNR in dB, peak 1, of linear light: average over the range / worst depth. \
    Known: the estimate knows each pixel's depth. Blind: one estimate for all depths. Each lens is at the stop and the focus that are best for \
    range, light and estimate; the mask is scaled with the aperture.\n\n\
    The OTF at spatial frequency s and defocus ψ is ∫ g(t)·exp(2iψst) dt, where |g(t)| is at most the width w(t) of the pupil's overlap with its copy moved by \
    s. So for any pupil the mean of |OTF|² over a range of width Ψ is at most π·∫w²/(π²·s·Ψ), and by duality at most c·Σ d·w² for any weights d, c being the \
    largest eigenvalue of the range's kernel scaled by them. The clear lens has 99 % of it: a mask moves contrast between depths and makes none. For \
    three full planes of colour Jensen's inequality turns this into a limit in dB that is proven for Gaussian pictures. Behind a Bayer \
    mosaic frequencies alias; there the limit is a relaxed problem (every frequency, colour and depth has a transfer of its own within the limits), solved \
    numerically from two starts: believed, not proven. A lens of equal contrast at all depths needs no depth, so the limits hold for \
    blind estimates as well.";

impl Bound {
    /// The table for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        format!("{}\n{}", self.table().to_text(), self.verdicts().join("\n"))
    }

    /// A Markdown page; `figures` are names and files of its figures.
    #[must_use]
    pub fn to_markdown(&self, made: &Made, figures: &[(&str, String)]) -> String {
        let figures: String = figures.iter().map(|(name, file)| format!("![{name}]({file})\n\n")).collect();
        format!(
            "# {TITLE}\n\n{made}\n\n{}{EXPLANATION}\n\n{}\n\n{figures}## {} and the limit behind a Bayer mosaic\n\n{}\n## Three full planes of colour\n\n{}",
            listed(&self.verdicts()),
            self.light_in_words(),
            self.camera,
            self.table().to_markdown(),
            self.planes().to_markdown()
        )
    }

    /// A report with the figures.
    #[must_use]
    pub fn report(&self, command: &str, plots: &[Plot]) -> Report {
        let mut report = Report::new(TITLE);
        self.verdicts().iter().for_each(|verdict| {
            report.verdict(verdict);
        });
        report.made_by(command).method(EXPLANATION).paragraph(&self.light_in_words()).plots(plots);
        report.heading("Behind a Bayer mosaic");
        self.table().add_to(&mut report, &[]);
        report.heading("Three full planes of colour");
        self.planes().add_to(&mut report, &[]);
        report
    }

    fn light_in_words(&self) -> String {
        format!("Mean light {} of white, read noise {} electrons.", self.mean_light, self.read_noise_e)
    }

    /// A sentence for each range.
    #[must_use]
    pub fn verdicts(&self) -> Vec<String> {
        let sentence = |rows: &[Row]| {
            let [low, high] = rows[0].psi_range;
            let each: Vec<String> = rows
                .iter()
                .map(|row| {
                    let Reached { average_db, worst_db } = row.any_minus_clear();
                    format!(
                        "{average_db:.1} dB on average and {worst_db:.1} at the worst depth at {} electrons",
                        row.electrons
                    )
                })
                .collect();
            format!(
                "ψ {low} to {high}: any mask whatever gains over the best clear lens at most {}.",
                each.join(", ")
            )
        };
        self.rows.chunk_by(|a, b| a.psi_range == b.psi_range).map(sentence).collect()
    }

    fn table(&self) -> Table {
        let lens = |estimate: &str| format!("{} minus clear, {estimate}", self.camera);
        let header = [
            "ψ range".to_owned(),
            "electrons".to_owned(),
            "best clear, known (stops closed)".to_owned(),
            "best clear, blind (stops closed)".to_owned(),
            lens("known"),
            lens("blind"),
            "limit".to_owned(),
            "any mask minus clear, at most".to_owned(),
        ];
        let row = |row: &Row| {
            let clear = |Setting { stops, reached, .. }: Setting| format!("{} ({stops})", pair(reached));
            vec![
                range(row),
                row.electrons.to_string(),
                clear(row.clear.known),
                clear(row.clear.blind),
                signed(row.lens.known.reached.minus(row.clear.known.reached)),
                signed(row.lens.blind.reached.minus(row.clear.blind.reached)),
                format!("{:.2}", row.ceiling.bayer_db),
                signed(row.any_minus_clear()),
            ]
        };
        Table { header: header.to_vec(), rows: self.rows.iter().map(row).collect() }
    }

    fn planes(&self) -> Table {
        let header = ["ψ range", "electrons", "best clear, known", "limit", "any mask minus clear, at most"];
        let row = |row: &Row| {
            vec![
                range(row),
                row.electrons.to_string(),
                pair(row.clear.planes_peaks),
                format!("{:.2}", row.ceiling.planes_db),
                signed(row.any_minus_clear_in_planes()),
            ]
        };
        Table { header: header.map(str::to_owned).to_vec(), rows: self.rows.iter().map(row).collect() }
    }
}

fn range(row: &Row) -> String {
    let [low, high] = row.psi_range;
    format!("{low} to {high}")
}

fn pair(Reached { average_db, worst_db }: Reached) -> String {
    format!("{average_db:.2} / {worst_db:.2}")
}

fn signed(Reached { average_db, worst_db }: Reached) -> String {
    format!("{average_db:+.2} / {worst_db:+.2}")
}

#[cfg(test)]
mod tests;
