//! What lenses and methods made of one scene of several depths: how near each picture comes to the scene, in a table and in words.

use crate::metrics::quality::{Means, columns};
use crate::metrics::{BORDER, Better, METRICS, Metric, MetricError, Quality, decibel, luma, shown};
use crate::report::Table;
use edof_core::{ColourFrame, Tone};
use edof_optics::Scene;
use ndarray::{Array2, ArrayView2, s};
use serde::{Deserialize, Serialize};

/// A picture of a scene and how near it comes to the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Which lens, as in `coded lens`.
    pub lens: String,
    /// Name of the camera.
    pub camera: String,
    /// What was done.
    pub treatment: String,
    /// Name of the method.
    pub method: String,
    /// Quality of the picture as it is looked at.
    #[serde(flatten)]
    pub picture: Quality,
    /// Quality of the light; the same where light is what is measured.
    pub light: Quality,
    /// PSNR of the picture where each depth is seen: pairs of ψ and dB, ψ ascending.
    #[serde(with = "crate::metrics::number::pairs")]
    pub psi_db: Vec<[f64; 2]>,
    /// Seconds that the method took.
    pub seconds: f64,
}

/// What a picture is called: whose it is, and what was done.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a> {
    /// See [`Picture::lens`].
    pub lens: &'a str,
    /// See [`Picture::camera`].
    pub camera: &'a str,
    /// See [`Picture::treatment`].
    pub treatment: &'a str,
    /// See [`Picture::method`].
    pub method: &'a str,
}

impl Picture {
    /// Lens and treatment, as tables and figures call it.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}, {}", self.lens, self.treatment)
    }

    /// Whether both belong to one network behind one lens, in different formats.
    fn is_of_the_network_of(&self, other: &Self) -> bool {
        let network = |p: &'_ Self| p.method.split_once('.').map(|(network, _)| network.to_owned());
        self.lens == other.lens && network(self).is_some() && network(self) == network(other)
    }

    /// PSNR in dB where a depth is seen.
    #[must_use]
    pub fn db_at(&self, psi: f64) -> Option<f64> {
        // What was read from a file may differ in the last bit.
        self.psi_db.iter().find(|d| (d[0] - psi).abs() < 1e-6).map(|d| d[1])
    }
}

/// The scene without blur, as light and as it is looked at, and where each depth is seen.
pub struct Truth {
    /// Linear light of the scene.
    pub light: ColourFrame,
    shown: ColourFrame,
    depths: Array2<f32>,
    tone: Tone,
}

/// Sides in pixels of the enlarged parts, largest first: the first that a depth has room for.
const SIDES: [usize; 3] = [80, 48, 24];
/// The same of those that are shown first.
const LARGE_SIDES: [usize; 3] = [104, 48, 24];
/// Pixels from one place that is looked at to the next.
const STEP: usize = 8;

/// A square part of a scene that lies at one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// ψ.
    pub psi: f64,
    row: usize,
    column: usize,
    side: usize,
}

impl Part {
    /// The crop alone, of the scene or of a picture of the scene.
    #[must_use]
    pub fn of(&self, frame: &ColourFrame) -> ColourFrame {
        frame.crop(self.row, self.column, self.side, self.side)
    }
}

impl Truth {
    /// Of a scene, under what is measured: light or its encoding.
    #[must_use]
    pub fn of(scene: &Scene, tone: Tone) -> Self {
        let light = scene.sharp();
        Self { shown: shown(&light, tone), light, depths: scene.psi_map(), tone }
    }

    /// What a picture of the scene is worth.
    ///
    /// # Errors
    /// [`MetricError`]: a scene too small to measure.
    pub fn judge(&self, names: Names<'_>, frame: &ColourFrame, seconds: f64) -> Result<Picture, MetricError> {
        let picture = shown(frame, self.tone);
        Ok(Picture {
            lens: names.lens.to_owned(),
            camera: names.camera.to_owned(),
            treatment: names.treatment.to_owned(),
            method: names.method.to_owned(),
            picture: Quality::of(&self.shown, &picture, BORDER, self.tone)?,
            light: Quality::of(&self.light, frame, BORDER, Tone::light())?,
            psi_db: psnr_by_depth(&self.shown, &picture, &self.depths),
            seconds,
        })
    }

    /// The busiest part of each depth, ψ ascending; depths without room for one are left out.
    #[must_use]
    pub fn parts(&self) -> Vec<Part> {
        self.parts_of(SIDES)
    }

    /// The same, larger.
    #[must_use]
    pub fn large_parts(&self) -> Vec<Part> {
        self.parts_of(LARGE_SIDES)
    }

    fn parts_of(&self, sides: [usize; 3]) -> Vec<Part> {
        let mut psis: Vec<f32> = vec![];
        for &psi in &self.depths {
            if !psis.contains(&psi) {
                psis.push(psi);
            }
        }
        psis.sort_by(f32::total_cmp);
        let busy = luma(&self.light);
        let part = |psi: f32| {
            let found = sides.iter().find_map(|&side| Some((busiest(&busy, &self.depths, psi, side)?, side)));
            found.map(|((row, column), side)| Part { psi: f64::from(psi), row, column, side })
        };
        psis.into_iter().filter_map(part).collect()
    }
}

/// PSNR over the pixels of each depth inside the border, ψ ascending.
fn psnr_by_depth(truth: &ColourFrame, estimate: &ColourFrame, depths: &Array2<f32>) -> Vec<[f64; 2]> {
    let (height, width) = truth.size();
    let mut sums: Vec<(f32, f64, f64)> = vec![];
    for row in BORDER..height - BORDER {
        for column in BORDER..width - BORDER {
            let psi = depths[(row, column)];
            let error = |p| {
                (f64::from(truth.planes[(p, row, column)]) - f64::from(estimate.planes[(p, row, column)]))
                    .powi(2)
            };
            let square = error(0) + error(1) + error(2);
            match sums.iter_mut().find(|s| s.0 == psi) {
                Some(sum) => {
                    sum.1 += square;
                    sum.2 += 3.0;
                }
                None => sums.push((psi, square, 3.0)),
            }
        }
    }
    sums.sort_by(|a, b| a.0.total_cmp(&b.0));
    sums.into_iter().map(|(psi, sum, count)| [f64::from(psi), decibel(sum / count)]).collect()
}

/// Row and column of the square of that side, all at `psi`, in which neighbours differ most.
fn busiest(light: &Array2<f32>, depths: &Array2<f32>, psi: f32, side: usize) -> Option<(usize, usize)> {
    busiest_where(light, side, |row, column| {
        depths.slice(s![row..row + side, column..column + side]).iter().all(|depth| *depth == psi)
    })
}

/// Row and column of the square of that side in which neighbours differ most; none where no square has room, borders cropped.
#[must_use]
pub fn busiest_part(light: &Array2<f32>, side: usize) -> Option<(usize, usize)> {
    busiest_where(light, side, |_, _| true)
}

/// The same among those that may be.
fn busiest_where(
    light: &Array2<f32>,
    side: usize,
    may_be: impl Fn(usize, usize) -> bool,
) -> Option<(usize, usize)> {
    let (height, width) = light.dim();
    let starts = |length: usize| (BORDER..(length + 1).saturating_sub(side + BORDER)).step_by(STEP);
    let places = starts(height).flat_map(|row| starts(width).map(move |column| (row, column)));
    let square = |(row, column): (usize, usize)| s![row..row + side, column..column + side];
    let inside = places.filter(|&(row, column)| may_be(row, column));
    let busy = |at: &(usize, usize)| change(light.slice(square(*at)));
    inside.max_by(|a, b| busy(a).total_cmp(&busy(b)))
}

fn change(part: ArrayView2<'_, f32>) -> f64 {
    let step = |pair: ndarray::ArrayView1<'_, f32>| f64::from((pair[1] - pair[0]).powi(2));
    part.rows().into_iter().flat_map(|row| row.windows(2).into_iter().map(step).collect::<Vec<_>>()).sum()
}

/// PSNRs, further metrics and seconds of all pictures.
#[must_use]
pub fn table(pictures: &[Picture]) -> Table {
    let means: Vec<Means> = pictures.iter().map(|p| Quality::means(&[p.picture])).collect();
    let metrics = columns(means.iter());
    let psis = pictures.first().map(|p| p.psi_db.as_slice()).unwrap_or_default();
    let mut header = vec!["PSNR in dB".to_owned(), "all".into()];
    header.extend(psis.iter().map(|[psi, _]| format!("ψ = {psi:.1}")));
    header.extend(metrics.iter().map(|metric| metric.heading()));
    header.extend(["light".to_owned(), "seconds".into()]);
    // A picture's own number has a digit more than a mean.
    let digits = |value: Option<f64>, metric: &Metric| {
        value.map_or_else(|| "–".to_owned(), |v| format!("{v:.*}", metric.decimals + 1))
    };
    let row = |p: &Picture| {
        let mut cells = vec![p.name(), format!("{:.2}", p.picture.psnr_db())];
        cells.extend(p.psi_db.iter().map(|d| format!("{:.2}", d[1])));
        cells.extend(metrics.iter().map(|metric| digits(p.picture.number(metric.name), metric)));
        cells.extend([format!("{:.2}", p.light.psnr_db()), format!("{:.3}", p.seconds)]);
        cells
    };
    Table { header, rows: pictures.iter().map(row).collect() }
}

/// Row and column of the best number of each of the table's columns but the last, which is time.
#[must_use]
pub fn best(pictures: &[Picture]) -> Vec<(usize, usize)> {
    let table = table(pictures);
    let is_lower_better = |column: usize| {
        METRICS
            .iter()
            .any(|metric| metric.better == Better::Lower && metric.heading() == table.header[column])
    };
    let number = |row: usize, column: usize| {
        let sign = if is_lower_better(column) { -1.0 } else { 1.0 };
        table.rows[row][column].parse::<f64>().map_or(f64::NEG_INFINITY, |number| sign * number)
    };
    let column = |c: usize| {
        let row = (0..table.rows.len()).max_by(|&a, &b| number(a, c).total_cmp(&number(b, c)))?;
        Some((row, c))
    };
    (1..table.header.len() - 1).filter_map(column).collect()
}

/// Depths where another is better by less than this many dB are no loss.
const TIE_DB: f64 = 0.05;

/// Differences below this many dB decide nothing.
const MATTERS_DB: f64 = 0.3;

/// Returns whether the network and the mask of the last picture are worth having for such a scene: the network against demosaicing behind the same
/// lens, the mask against the best picture behind another lens.
#[must_use]
pub fn answer(pictures: &[Picture]) -> String {
    let Some((ours, others)) = pictures.split_last() else { return String::new() };
    let db = |p: &Picture| p.picture.psnr_db();
    let best = |wanted: &dyn Fn(&Picture) -> bool| {
        others.iter().filter(|p| wanted(p)).max_by(|a, b| db(a).total_cmp(&db(b)))
    };
    let rival = best(&|p| p.lens != ours.lens);
    let plain = rival.and_then(|rival| best(&|p| p.lens == rival.lens && p.treatment != rival.treatment));
    let network = plain.zip(rival).map(|(plain, rival)| {
        let gain = db(rival) - db(plain);
        let word = if gain > MATTERS_DB { "Use the network" } else { "No network is needed" };
        format!("{word}: {gain:+.1} dB against {} behind the {}. ", plain.treatment, plain.lens)
    });
    let mask = rival.map(|rival| {
        let worst = |p: &Picture| p.psi_db.iter().map(|d| d[1]).fold(f64::INFINITY, f64::min);
        let (average, worst) = (db(ours) - db(rival), worst(ours) - worst(rival));
        let word = match (average > -MATTERS_DB, worst > MATTERS_DB) {
            (true, true) => "ahead",
            (false, true) => "ahead only if the worst depth counts",
            (_, false) if average > MATTERS_DB => "ahead only if the average counts",
            (_, false) => "not ahead",
        };
        format!(
            "The mask, in this scene and light: {word}, {average:+.1} dB on average and {worst:+.1} dB at the worst depth against the {}, {}. \
             Other scenes and light decide anew: edof optics advise. ",
            rival.lens, rival.treatment
        )
    });
    match (network, mask) {
        (network, Some(mask)) => network.unwrap_or_default() + &mask,
        _ => String::new(),
    }
}

/// The last picture, which is ours, against the best of the others, and where it loses, in words.
#[must_use]
pub fn verdict(pictures: &[Picture]) -> String {
    let Some((ours, others)) = pictures.split_last() else { return String::new() };
    let better = |a: &&Picture, b: &&Picture| a.picture.psnr_db().total_cmp(&b.picture.psnr_db());
    // Another format of the same network is no rival.
    let others: Vec<&Picture> = others.iter().filter(|other| !ours.is_of_the_network_of(other)).collect();
    let Some(&rival) = others.iter().max_by(|a, b| better(a, b)) else { return String::new() };
    let worst =
        |p: &Picture| p.psi_db.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or_default();
    let ([our_psi, our_worst], [its_psi, its_worst]) = (worst(ours), worst(rival));
    let losses: Vec<Loss> = (0..ours.psi_db.len()).filter_map(|depth| loss(ours, &others, depth)).collect();
    // Who is ahead at several depths is named once.
    let to_one = |all: &[Loss]| {
        let each = all.iter().map(|one| format!("at ψ = {:.1} by {:.1} dB", one.psi, one.by));
        format!("{} ({})", each.collect::<Vec<_>>().join(", "), all[0].who)
    };
    let losses: Vec<String> = losses.chunk_by(|a, b| a.who == b.who).map(to_one).collect();
    let losses = match losses[..] {
        [] => "At no depth is any of the others better.".to_owned(),
        _ => format!("{} loses {}.", capitalised(&ours.name()), losses.join(", and ")),
    };
    let by = ours.picture.psnr_db() - rival.picture.psnr_db();
    format!(
        "{} is {:.1} dB {} over the whole picture than the best of the others, {}: {:.1} against {:.1} dB. At its worst depth it has \
         {our_worst:.1} dB (ψ = {our_psi:.1}), the other {its_worst:.1} (ψ = {its_psi:.1}). {losses}",
        capitalised(&ours.name()),
        by.abs(),
        if by < 0.0 { "worse" } else { "better" },
        rival.name(),
        ours.picture.psnr_db(),
        rival.picture.psnr_db(),
    )
}

/// Who is ahead at a depth, and by how many dB.
struct Loss {
    psi: f64,
    by: f64,
    who: String,
}

/// How far the best of the others is ahead at one depth, if it is.
fn loss(ours: &Picture, others: &[&Picture], depth: usize) -> Option<Loss> {
    let [psi, db] = *ours.psi_db.get(depth)?;
    let ahead = |p: &Picture| Some((p.psi_db.get(depth)?[1] - db, p.name()));
    let (by, who) = others.iter().copied().filter_map(ahead).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (by > TIE_DB).then_some(Loss { psi, by, who })
}

/// With a capital first letter.
#[must_use]
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::tests::demo;

    #[test]
    fn the_verdict_says_where_we_lose() {
        let mut pictures = demo().pictures;
        for (picture, db) in pictures.iter_mut().zip([30.0, 31.0]) {
            picture.psi_db.iter_mut().for_each(|d| d[1] = db);
            picture.picture = picture.picture.with("psnr_db", db);
        }
        assert!(verdict(&pictures).contains("At no depth"), "{}", verdict(&pictures));
        pictures[0].psi_db[1][1] = 32.5;
        let once = verdict(&pictures);
        assert!(once.ends_with(" loses at ψ = 3.0 by 1.5 dB (clear, demosaiced)."), "{once}");
        pictures[0].psi_db[0][1] = 32.0;
        let twice = verdict(&pictures);
        assert!(twice.ends_with(" by 1.0 dB, at ψ = 3.0 by 1.5 dB (clear, demosaiced)."), "{twice}");
    }

    #[test]
    fn the_answer_is_yes_only_where_it_pays() {
        let mut pictures = demo().pictures;
        let mut restored = pictures[0].clone();
        restored.treatment = "reconstructed".into();
        pictures.insert(1, restored);
        let mut told = |plain: f64, clear: f64, coded: f64, worst: f64| {
            for (picture, db) in pictures.iter_mut().zip([plain, clear, coded]) {
                picture.psi_db.iter_mut().for_each(|d| d[1] = db);
                picture.picture = picture.picture.with("psnr_db", db);
            }
            pictures[2].psi_db[3][1] = worst;
            answer(&pictures)
        };
        let yes = told(30.0, 34.0, 34.1, 35.0);
        assert!(yes.starts_with("Use the network: +4.0 dB against demosaiced behind the clear. "), "{yes}");
        let mask = |told: String| {
            let (_, mask) = told.split_once("The mask, in this scene and light: ").unwrap();
            mask.split_once(", +").map(|(word, _)| word.to_owned())
        };
        assert_eq!(mask(told(30.0, 34.0, 34.5, 34.4)).as_deref(), Some("ahead"));
        assert_eq!(mask(told(30.0, 34.0, 34.5, 34.1)).as_deref(), Some("ahead only if the average counts"));
        let no = told(34.0, 34.1, 33.0, 32.0);
        assert!(
            no.starts_with("No network is needed: +0.1 dB")
                && no.contains("light: not ahead, -1.1 dB on average and -2.1 dB at"),
            "{no}"
        );
    }

    #[test]
    fn the_busiest_part_lies_at_its_depth() {
        let light =
            Array2::from_shape_fn(
                (60, 80),
                |(r, c)| if (30..50).contains(&c) { ((r + c) % 2) as f32 } else { 0.5 },
            );
        let depths = Array2::from_shape_fn((60, 80), |(_, c)| if c < 60 { 1.0 } else { 5.0 });
        let (_, column) = busiest(&light, &depths, 1.0, 24).unwrap();
        assert!((24..=32).contains(&column), "{column}");
        assert_eq!(busiest(&light, &depths, 5.0, 24), None);
    }
}
