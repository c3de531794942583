//! What rows of lenses say together: whether a mask beats the clear lens at its best stop, and what knowing the depth is worth.

use super::{Row, ordered};
use crate::journal::Ordered;
use crate::made::Made;
use crate::metrics::paired::Paired;
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series};
use crate::report::{Report, Table};
use crate::study_report::{StudyReport, StudyReportError};
use crate::verdict::listed;
use edof_core::words::{count, number};
use edof_numerics::mean;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A mask is adopted if it loses no more than this on average in any light.
const MAX_LOSS_DB: f64 = 0.05;
/// A mask is adopted if it gains this at the worst depth in every light.
const MIN_GAIN_DB: f64 = 0.3;
/// A network that estimates the depth may be worth trying from this gain on.
const WORTH_DB: f64 = 0.5;
/// Colours of lenses in plots.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// Name of a camera, whether its networks know the depth, foci of several exposures.
type Kind<'a> = (&'a str, bool, &'a [f64]);

/// Levels of a lens in one light, in dB: means over seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lens {
    /// Name of the camera.
    pub lens: String,
    /// Whether it has no mask.
    pub clear: bool,
    /// Stops by which it is closed.
    pub stops: f64,
    /// Whether its networks know the depth.
    pub known: bool,
    /// Foci of several exposures, in ψ of the open aperture.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub foci: Vec<f64>,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// Averaged over depths and photographs.
    pub average_db: f64,
    /// At its worst depth, averaged over photographs.
    pub worst_db: f64,
    /// That depth, in ψ of the open aperture.
    pub worst_psi: f64,
    /// How many seeds.
    pub seeds: usize,
    /// Level of each depth.
    pub depths: Vec<[f64; 2]>,
    #[serde(skip)]
    average: Part,
    #[serde(skip)]
    worst: Part,
}

/// A figure by photograph, and what seeds do to its mean.
#[derive(Debug, Clone, PartialEq, Default)]
struct Part {
    photographs: BTreeMap<String, f64>,
    /// Variance of the mean over seeds; none of one seed.
    seeds: Option<f64>,
}

impl Part {
    fn of(rows: &[&Row]) -> Self {
        let images: BTreeSet<&str> = rows.iter().map(|row| row.image.as_str()).collect();
        let level = |own: &dyn Fn(&Row) -> bool| mean(rows.iter().filter(|r| own(r)).map(|r| r.psnr_db));
        let photographs =
            images.into_iter().filter_map(|i| Some((i.to_owned(), level(&|row| row.image == i)?))).collect();
        let seeds: BTreeSet<u64> = rows.iter().map(|row| row.seed).collect();
        let means: Vec<f64> = seeds.into_iter().filter_map(|seed| level(&|row| row.seed == seed)).collect();
        let seeds = Paired::of(&means).and_then(|means| means.standard_error).map(|error| error * error);
        Self { photographs, seeds }
    }

    fn mean(&self) -> f64 {
        mean(self.photographs.values().copied()).unwrap_or(f64::NAN)
    }

    /// The difference, paired by photograph; its error is that of photographs and of seeds.
    fn minus(&self, other: &Self) -> Option<Paired> {
        let paired = Paired::between(&self.photographs, &other.photographs)?;
        let seeds = self.seeds.unwrap_or(0.0) + other.seeds.unwrap_or(0.0);
        let standard_error = paired.standard_error.map(|error| (error * error + seeds).sqrt());
        Some(Paired { standard_error, ..paired })
    }
}

impl Lens {
    /// Takes the rows of one lens and light; none of no rows.
    fn of(rows: &[&Row]) -> Option<Self> {
        let Row { lens, clear, stops, known, foci, electrons, .. } = rows.first()?;
        let psis: BTreeSet<Ordered> = rows.iter().map(|row| Ordered(row.psi)).collect();
        let at = |psi: f64| -> Vec<&Row> { rows.iter().copied().filter(|row| row.psi == psi).collect() };
        let depths: Vec<[f64; 2]> = psis.iter().map(|psi| [psi.0, Part::of(&at(psi.0)).mean()]).collect();
        let [worst_psi, worst_db] = depths.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1]))?;
        let average = Part::of(rows);
        Some(Self {
            lens: lens.clone(),
            clear: *clear,
            stops: *stops,
            known: *known,
            foci: foci.clone(),
            electrons: *electrons,
            average_db: average.mean(),
            worst_db,
            worst_psi,
            seeds: rows.iter().map(|row| row.seed).collect::<BTreeSet<_>>().len(),
            depths,
            average,
            worst: Part::of(&at(worst_psi)),
        })
    }

    /// Names the foci of several exposures.
    fn exposures(&self) -> String {
        let foci: Vec<String> = self.foci.iter().copied().map(number).collect();
        if foci.is_empty() {
            String::new()
        } else {
            format!(", {} exposures at foci {}", foci.len(), foci.join(", "))
        }
    }

    /// Name, stop, exposures, and whether the depth is known.
    fn label(&self) -> String {
        let stops =
            if self.stops == 0.0 { "open".to_owned() } else { format!("closed by {} stops", self.stops) };
        let depth = if self.known { ", depth known" } else { "" };
        format!("{}, {stops}{}{depth}", self.lens, self.exposures())
    }

    /// Average and worst depth have equal weight.
    const fn score(&self) -> f64 {
        0.5 * (self.average_db + self.worst_db)
    }

    /// What distinguishes it from others in the same light.
    fn kind(&self) -> Kind<'_> {
        (&self.lens, self.known, &self.foci)
    }

    fn levels(&self) -> String {
        format!("{:.2} / {:.2}", self.average_db, self.worst_db)
    }

    /// The difference on average, and each at its own worst depth.
    fn minus(&self, other: &Self) -> Option<[Paired; 2]> {
        Some([self.average.minus(&other.average)?, self.worst.minus(&other.worst)?])
    }
}

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LensNetworks {
    /// Every lens in every light, the brightest first.
    pub lenses: Vec<Lens>,
    /// How many photographs.
    pub photographs: usize,
    /// The page's statement about the choice of the photographs.
    #[serde(skip)]
    choices: String,
}

impl StudyReport for LensNetworks {
    type Row = Row;

    fn new(rows: &[Row], _machine: String) -> Result<Self, StudyReportError> {
        let mut groups = BTreeMap::<_, Vec<&Row>>::new();
        for row in rows {
            let light = Ordered(-row.electrons);
            let group = (light, !row.clear, &row.lens, row.known, ordered(&row.foci));
            groups.entry(group).or_default().push(row);
        }
        let images: BTreeSet<&str> = rows.iter().map(|row| row.image.as_str()).collect();
        Ok(Self {
            lenses: groups.values().filter_map(|rows| Lens::of(rows)).collect(),
            photographs: images.len(),
            choices: edof_io::photos::choices(images.iter().copied()),
        })
    }

    fn to_text(&self) -> String {
        let tables = self.tables().into_iter().map(|(name, table)| format!("{name}\n{}\n", table.to_text()));
        tables.collect::<String>() + &self.verdicts().join("\n")
    }

    fn to_markdown(&self, made: &Made) -> String {
        let mut page =
            format!("# {}\n\n{made}\n\n{}{}\n", self.title(), listed(&self.verdicts()), self.explanation());
        for (heading, table) in self.tables() {
            let _ = write!(page, "\n## {heading}\n\n{}", table.to_markdown());
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(self.title());
        for verdict in self.verdicts() {
            report.verdict(&verdict);
        }
        report.made_by(command).method(&self.explanation());
        report.plots(&self.lights().into_iter().map(|light| self.plot(light)).collect::<Vec<_>>());
        for (heading, table) in self.tables() {
            report.heading(&heading);
            table.add_to(&mut report, &[]);
        }
        report
    }
}

impl LensNetworks {
    fn knows_depth(&self) -> bool {
        self.lenses.iter().any(|lens| lens.known)
    }

    fn has_exposures(&self) -> bool {
        self.lenses.iter().any(|lens| !lens.foci.is_empty())
    }

    fn title(&self) -> &'static str {
        if self.has_exposures() {
            "What several exposures are worth"
        } else if self.knows_depth() {
            "What knowing the depth is worth"
        } else {
            "Masks against the clear lens at its best stop"
        }
    }

    fn explanation(&self) -> String {
        let exposures = if self.has_exposures() {
            " Several exposures share the time of one, in equal parts: each has its own focus, its share of the electrons, read noise of its own, and a gain \
              that makes white full scale. The scene does not move. One network sees the same window of all exposures."
        } else {
            ""
        };
        let known = if self.knows_depth() {
            " Blind: one network for all depths. Known: a network for each depth alone, which meets its own depth and those with the same kernels; \
              no network can know more of the depth, so the gain is the most that a network gains which estimates it."
        } else {
            ""
        };
        format!(
            "All lenses look at the same scene for the same time, with the same sensor. Each stop by which a lens is closed halves its light and halves ψ of \
             every depth; ψ is that of the open aperture. Light is stated as the electrons of a white pixel behind the open aperture; gain makes white full scale. \
             Every lens has networks of its own by one short recipe, trained with the noise of its own light, less than the networks that come with the \
             program.{exposures}{known} {} under real light (sRGB decoded, photon and read noise), stride 8, border 8 cropped. PSNR in dB, peak 1, of the encoded \
             picture: average over depths / worst depth of each lens. The best stop of the clear lens is the one with the best sum of both in that light. \
             Numbers are means over seeds. A ± is the standard error of a difference: of photographs, paired, and, where a lens has several seeds, of seeds.{}",
            count(self.photographs, "photograph"),
            self.choices
        )
    }

    fn lights(&self) -> Vec<f64> {
        let mut lights: Vec<f64> = self.lenses.iter().map(|lens| lens.electrons).collect();
        lights.dedup();
        lights
    }

    fn in_light(&self, electrons: f64) -> impl Iterator<Item = &Lens> {
        self.lenses.iter().filter(move |lens| lens.electrons == electrons)
    }

    fn find(&self, kind: Kind<'_>, electrons: f64) -> Option<&Lens> {
        self.in_light(electrons).find(|own| own.kind() == kind)
    }

    /// The same lens and exposures, blind.
    fn blind(&self, known: &Lens) -> Option<&Lens> {
        self.find((&known.lens, false, &known.foci), known.electrons)
    }

    /// The blind lens of one exposure with the best score in a light, of those that are clear or of all.
    fn best(&self, electrons: f64, clear: bool) -> Option<&Lens> {
        let is_one = |lens: &&Lens| !lens.known && lens.foci.is_empty() && (lens.clear || !clear);
        let blind = self.in_light(electrons).filter(is_one);
        blind.max_by(|a, b| a.score().total_cmp(&b.score()))
    }

    /// Lenses in the order of the page.
    fn kinds(&self) -> Vec<Kind<'_>> {
        let mut kinds: Vec<Kind<'_>> = vec![];
        for lens in &self.lenses {
            if !kinds.contains(&lens.kind()) {
                kinds.push(lens.kind());
            }
        }
        kinds
    }

    fn verdicts(&self) -> Vec<String> {
        if self.has_exposures() {
            self.verdicts_of_exposures()
        } else if self.knows_depth() {
            self.verdicts_of_depth()
        } else {
            self.verdicts_of_masks()
        }
    }

    /// States in each light what the best lens of several exposures gains over the best clear one of one exposure, and whether that is enough.
    fn verdicts_of_exposures(&self) -> Vec<String> {
        let verdict = |light: f64| {
            let several = self.in_light(light).filter(|lens| !lens.foci.is_empty());
            let several = several.max_by(|a, b| a.score().total_cmp(&b.score()))?;
            let one = self.best(light, true)?;
            let gains @ [average, worst] = several.minus(one)?;
            let least = gains.into_iter().min_by(|a, b| a.mean.total_cmp(&b.mean))?;
            let answer = if least.mean >= WORTH_DB {
                format!("at least {WORTH_DB} dB both ways, so they pay")
            } else if least.mean > 0.0 {
                format!("a gain below {WORTH_DB} dB in one of them, so they pay little")
            } else {
                "not a gain both ways, so they do not pay".to_owned()
            };
            Some(format!(
                "{light} electrons: {} minus one exposure of the whole time, {}: {average} dB on average, {worst} at the worst depth: {answer}.",
                several.label(),
                one.label()
            ))
        };
        self.lights().into_iter().filter_map(verdict).collect()
    }

    /// States the worth of the depth to each lens, and whether that is enough.
    fn verdicts_of_depth(&self) -> Vec<String> {
        let gains = self.lenses.iter().filter(|lens| lens.known).flat_map(|known| {
            let gains = self.blind(known).and_then(|blind| known.minus(blind));
            gains
                .into_iter()
                .flatten()
                .zip(["on average", "at the worst depth"])
                .map(move |gain| (known, gain))
        });
        let most = gains.max_by(|a, b| a.1.0.mean.total_cmp(&b.1.0.mean));
        let Some((lens, (gain, place))) = most else { return vec![] };
        let (word, answer) = if gain.mean >= WORTH_DB {
            ("at least", "a network that estimates the depth may be worth trying")
        } else {
            ("less than", "a network that estimates the depth is not worth trying")
        };
        let most = format!(
            "Knowing the depth gains {gain} dB at most ({}, {place}, {} electrons): {word} {WORTH_DB} dB, so {answer}.",
            lens.lens, lens.electrons
        );
        let over_best = self.lights().into_iter().filter_map(|light| {
            let blind = self.best(light, false)?;
            let known = self.in_light(light).filter(|lens| lens.known);
            let known = known.max_by(|a, b| a.score().total_cmp(&b.score()))?;
            let [average, worst] = known.minus(blind)?;
            Some(format!(
                "{light} electrons: the best lens with the depth known, {}, minus the best blind one, {}: {average} dB on average, {worst} at the worst depth.",
                known.lens, blind.lens
            ))
        });
        std::iter::once(most).chain(over_best).collect()
    }

    /// Whether a mask meets the rule by which it would become the default, and how far each is from it.
    fn verdicts_of_masks(&self) -> Vec<String> {
        let mut masks: Vec<&str> =
            self.lenses.iter().filter(|lens| !lens.clear).map(|lens| lens.lens.as_str()).collect();
        masks.sort_unstable();
        masks.dedup();
        let mut adopted = vec![];
        let mut sentences = vec![];
        for mask in masks {
            let compared: Vec<(f64, [Paired; 2])> = self
                .lights()
                .into_iter()
                .filter_map(|light| {
                    let clear = self.best(light, true)?;
                    Some((light, self.find((mask, false, &[]), light)?.minus(clear)?))
                })
                .collect();
            let least = |of: usize| {
                compared
                    .iter()
                    .map(|(light, gains)| (gains[of], light))
                    .min_by(|a, b| a.0.mean.total_cmp(&b.0.mean))
            };
            let (Some((average, light)), Some((worst, dim))) = (least(0), least(1)) else { continue };
            let is_met = average.mean >= -MAX_LOSS_DB && worst.mean >= MIN_GAIN_DB;
            if is_met {
                adopted.push(mask);
            }
            sentences.push(format!(
                "{mask}: on average {average} dB at least ({light} electrons), at the worst depth {worst} dB at least ({dim} electrons): the rule is {}met.",
                if is_met { "" } else { "not " }
            ));
        }
        let rule = format!(
            "The rule: in no light more than {MAX_LOSS_DB} dB below the clear lens at its best stop on average, and in each at least {MIN_GAIN_DB} dB above it at the worst depth."
        );
        let verdict = match &adopted[..] {
            [] => format!("No mask becomes the default. {rule}"),
            masks => format!("{} may become the default. {rule}", masks.join(", ")),
        };
        std::iter::once(verdict).chain(sentences).collect()
    }

    fn tables(&self) -> Vec<(String, Table)> {
        let mut tables = vec![(
            "Every lens: average / worst depth, dB".to_owned(),
            self.table(|lens| Some(lens.levels())),
        )];
        let against = |lens: &Lens, other: Option<&Lens>| {
            let other = other.filter(|other| other.kind() != lens.kind())?;
            lens.minus(other).map(|[average, worst]| format!("{average} / {worst}"))
        };
        if self.knows_depth() {
            let gain = |lens: &Lens| against(lens, self.blind(lens)).filter(|_| lens.known);
            tables.push(("Depth known minus blind, the same lens".to_owned(), self.table(gain)));
        }
        let gain = |lens: &Lens| against(lens, self.best(lens.electrons, true));
        let one = if self.has_exposures() { ", one exposure" } else { "" };
        tables.push((format!("Minus the blind clear lens at its best stop{one}"), self.table(gain)));
        tables
    }

    /// A row for each lens that has a cell, a column for each light.
    fn table(&self, cell: impl Fn(&Lens) -> Option<String>) -> Table {
        let lights = self.lights();
        let row = |kind: Kind<'_>| {
            let cells: Vec<Option<String>> =
                lights.iter().map(|light| self.find(kind, *light).and_then(&cell)).collect();
            let lens = self.lenses.iter().find(|lens| lens.kind() == kind)?;
            let head = [lens.label(), count(lens.seeds, "seed")];
            let has_any = cells.iter().any(Option::is_some);
            has_any.then(|| {
                head.into_iter()
                    .chain(cells.into_iter().map(|cell| cell.unwrap_or_else(|| "–".to_owned())))
                    .collect()
            })
        };
        let heads = lights.iter().map(|light| format!("{light} e⁻"));
        Table {
            header: ["lens".to_owned(), "networks".to_owned()].into_iter().chain(heads).collect(),
            rows: self.kinds().into_iter().filter_map(row).collect(),
        }
    }

    fn plot(&self, electrons: f64) -> Plot {
        let blind: Vec<&Lens> = self.in_light(electrons).filter(|lens| !lens.known).collect();
        let series = blind.iter().zip(COLOURS.iter().cycle()).flat_map(|(lens, colour)| {
            let known = self.find((&lens.lens, true, &lens.foci), electrons);
            let line = |lens: &Lens, word: &str, mark| {
                Series::new(format!("{}{}{word}", lens.lens, lens.exposures()), mark, lens.depths.clone())
                    .coloured(*colour)
            };
            std::iter::once(line(lens, "", Mark::LineAndPoints))
                .chain(known.map(|known| line(known, ", depth known", Mark::Dashed)))
                .collect::<Vec<_>>()
        });
        Plot {
            title: format!("{electrons} electrons"),
            x: Axis::linear("ψ of the open aperture"),
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: series.collect(),
        }
    }
}
