//! What an experiment's rows say together: averages, worst depths, what fixed point and 4:2:2 cost.

use crate::methods::method::{Format, Method};
use crate::metrics::BORDER;
use crate::metrics::paired::Paired;
use crate::metrics::quality::{Means, Quality};
use crate::trial::{Measured, Work};
use edof_core::{Noise, Tone};
use serde::Serialize;
use std::collections::BTreeMap;

/// The whole result of an experiment, as its JSON file holds it.
#[derive(Debug, Clone, Serialize)]
pub struct Study {
    /// How its quality is measured.
    pub measure: Measure,
    /// One for each method, photograph and setting.
    pub rows: Vec<Measured>,
    /// What they say together.
    pub summary: Summary,
    /// Parts of pictures at the farthest depth.
    #[serde(skip)]
    pub crops: Vec<Crop>,
}

/// A part of a picture.
#[derive(Debug, Clone)]
pub struct Crop {
    /// The photograph.
    pub image: String,
    /// Noise of the sensor; none for the photograph itself.
    pub noise: Option<Noise>,
    /// What made it: the method and its camera.
    pub title: String,
    /// PSNR of the whole picture in dB; none of the photograph itself.
    pub psnr_db: Option<f64>,
    /// A JPEG.
    pub picture: Vec<u8>,
}

/// How quality is measured (docs/decisions/0003-metrics.md, 0010-tone-and-noise.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measure {
    /// Linear: photographs' numbers are light, the network's values are not clipped. Srgb: they are decoded to light, and the picture is encoded
    /// and clipped to 0…1 before it is compared.
    pub tone: Tone,
    /// Peak of PSNR and range of SSIM.
    pub peak: f64,
    /// Pixels cropped on each side.
    pub border: usize,
}

/// Averages over photographs and depths.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// One for each method, camera and noise level, in the rows' order.
    pub methods: Vec<MethodSummary>,
    /// One for each network, camera and noise level.
    pub nets: Vec<NetSummary>,
    /// One for each two float networks and noise level.
    pub differences: Vec<Difference>,
    /// What was left out or looks wrong, one line each.
    pub notes: Vec<String>,
}

/// One method behind one camera at one noise level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Short name of the method.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Camera of the method.
    pub camera: String,
    /// Noise of the sensor.
    pub noise: Noise,
    /// The picture over depths.
    #[serde(flatten)]
    pub picture: DepthCurve,
    /// The light over depths.
    pub light: DepthCurve,
    /// Mean seconds per megapixel.
    pub seconds_per_megapixel: f64,
    /// Mean work; saturations are added up.
    #[serde(flatten)]
    pub work: Work,
}

/// How far two float networks are apart on the same photographs, each behind its own camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// The one.
    pub first: String,
    /// The one that is subtracted from it.
    pub second: String,
    /// Noise of the sensor.
    pub noise: Noise,
    /// At the farthest depth, in dB of the picture.
    pub farthest: Paired,
    /// Averaged over depths.
    pub average: Paired,
}

/// Quality over depths, averaged over photographs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DepthCurve {
    /// Mean PSNR at each depth: pairs of ψ and dB, ψ ascending.
    pub psi_db: Vec<[f64; 2]>,
    /// Mean over depths.
    pub average_db: f64,
    /// The worst depth's mean.
    pub worst_db: f64,
    /// Which depth that is.
    pub worst_psi: f64,
    /// Standard errors over photographs of the means at the farthest depth, at the worst one and over depths; none of one photograph.
    pub standard_errors_db: [Option<f64>; 3],
    /// Means of the metrics that tables show.
    #[serde(flatten)]
    pub means: Means,
}

/// What fixed point and 4:2:2 cost a network, measured on the picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetSummary {
    /// The network in floating point.
    #[serde(flatten)]
    pub float: Method,
    /// Camera of the network.
    pub camera: String,
    /// Noise of the sensor.
    pub noise: Noise,
    /// Mean of float − float422.
    pub mean_cost_of_422_db: f64,
    /// Largest float − float422 on any row.
    pub largest_cost_of_422_db: f64,
    /// What fixed point costs, where the network has fixed rows.
    pub fixed: Option<FixedCost>,
}

/// What fixed point costs a network, and what it counted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FixedCost {
    /// Mean of float422 − fixed.
    pub mean_loss_db: f64,
    /// Largest float422 − fixed on any row.
    pub largest_loss_db: f64,
    /// Photograph of that row.
    pub largest_loss_image: String,
    /// ψ of that row.
    pub largest_loss_psi: f64,
    /// Mean work; saturations are added up.
    #[serde(flatten)]
    pub work: Work,
}

impl Study {
    /// Rows with their summary.
    #[must_use]
    pub fn of(rows: Vec<Measured>) -> Self {
        let tone = rows.first().map_or(Tone::Linear, |row| row.tone);
        let measure = Measure { tone, peak: 1.0, border: BORDER };
        let methods = methods(&rows);
        let notes = without_integers(&methods);
        let summary = Summary { methods, nets: nets(&rows), differences: differences(&rows), notes };
        Self { measure, rows, summary, crops: vec![] }
    }
}

impl Summary {
    /// Noise levels in the rows' order.
    #[must_use]
    pub fn noises(&self) -> Vec<Noise> {
        distinct(self.methods.iter().map(|m| m.noise))
    }

    /// Methods with their cameras in the rows' order.
    #[must_use]
    pub fn subjects(&self) -> Vec<(&Method, &str)> {
        distinct(self.methods.iter().map(|m| (&m.identity, m.camera.as_str())))
    }

    /// One method behind one camera at one noise level, if it was measured.
    #[must_use]
    pub fn find(&self, (method, camera): (&Method, &str), noise: Noise) -> Option<&MethodSummary> {
        self.methods.iter().find(|m| m.identity == *method && m.camera == camera && m.noise == noise)
    }
}

impl DepthCurve {
    /// The farthest depth: ψ and dB.
    #[must_use]
    pub fn farthest(&self) -> [f64; 2] {
        self.psi_db.last().copied().unwrap_or([f64::NAN; 2])
    }

    /// Means at the farthest depth, at the worst one and over depths, each with its standard error.
    #[must_use]
    pub fn cells(&self) -> [(f64, Option<f64>); 3] {
        let means = [self.farthest()[1], self.worst_db, self.average_db];
        std::array::from_fn(|place| (means[place], self.standard_errors_db[place]))
    }

    fn of(rows: &[&Measured], quality: impl Fn(&Measured) -> Quality) -> Self {
        let psi_db: Vec<[f64; 2]> = ascending(rows.iter().map(|r| r.psi))
            .into_iter()
            .map(|psi| [psi, mean(rows.iter().filter(|r| r.psi == psi).map(|r| quality(r).psnr_db()))])
            .collect();
        let worst = psi_db.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2]);
        let error_at = |psi: Option<f64>| {
            let own = rows.iter().filter(|row| psi.is_none_or(|psi| row.psi == psi));
            let by_photo = means_by_photo(own.map(|row| (row.image.as_str(), quality(row).psnr_db())));
            Paired::of(&by_photo.into_values().collect::<Vec<_>>())?.standard_error
        };
        let farthest = psi_db.last().map(|last| last[0]);
        Self {
            standard_errors_db: [farthest, Some(worst[0]), None].map(error_at),
            average_db: mean(psi_db.iter().map(|p| p[1])),
            worst_db: worst[1],
            worst_psi: worst[0],
            means: Quality::means(&rows.iter().map(|r| quality(r)).collect::<Vec<_>>()),
            psi_db,
        }
    }
}

impl Work {
    fn mean_of(rows: &[&Measured]) -> Self {
        let average = |value: fn(&Self) -> Option<f64>| {
            rows.iter().map(|r| value(&r.work)).collect::<Option<Vec<f64>>>().map(|v| mean(v.into_iter()))
        };
        let nonzeros: Option<Vec<&Vec<f64>>> =
            rows.iter().map(|r| r.work.nonzeros_a_patch.as_ref()).collect();
        Self {
            dense_multiplications_a_pixel: average(|w| w.dense_multiplications_a_pixel),
            executed_multiplications_a_pixel: average(|w| w.executed_multiplications_a_pixel),
            nonzeros_a_patch: nonzeros.map(|all| {
                let layers = all.first().map_or(0, |first| first.len());
                (0..layers).map(|t| mean(all.iter().filter_map(|n| n.get(t).copied()))).collect()
            }),
            saturations: rows.iter().map(|r| r.work.saturations).sum(),
        }
    }
}

fn methods(rows: &[Measured]) -> Vec<MethodSummary> {
    let mut summaries = vec![];
    for (identity, camera) in distinct(rows.iter().map(|r| (&r.identity, &r.camera))) {
        let subject = || rows.iter().filter(|r| r.identity == *identity && r.camera == *camera);
        for noise in distinct(subject().map(|r| r.noise)) {
            let own: Vec<&Measured> = subject().filter(|r| r.noise == noise).collect();
            summaries.push(MethodSummary {
                method: identity.to_string(),
                identity: identity.clone(),
                camera: camera.clone(),
                noise,
                picture: DepthCurve::of(&own, |r| r.picture),
                light: DepthCurve::of(&own, |r| r.light),
                seconds_per_megapixel: mean(own.iter().map(|r| r.seconds_per_megapixel)),
                work: Work::mean_of(&own),
            });
        }
    }
    summaries
}

/// Differences of every two float networks, in the rows' order.
fn differences(rows: &[Measured]) -> Vec<Difference> {
    let floats = || rows.iter().filter(|r| r.identity.format == Some(Format::Float));
    let networks = distinct(floats().map(|r| (&r.identity, &r.camera)));
    let farthest = rows.iter().map(|r| r.psi).fold(f64::NEG_INFINITY, f64::max);
    let mut all = vec![];
    for noise in distinct(floats().map(|r| r.noise)) {
        // Means over depths by photograph.
        let by_photo = |(method, camera): (&Method, &String), far: bool| {
            by_photo(rows, (method, camera), noise, far.then_some(farthest))
        };
        for (place, &first) in networks.iter().enumerate() {
            for &second in &networks[place + 1..] {
                let at = |far| Paired::between(&by_photo(first, far), &by_photo(second, far));
                all.extend(at(true).zip(at(false)).map(|(farthest, average)| Difference {
                    first: first.0.to_string(),
                    second: second.0.to_string(),
                    noise,
                    farthest,
                    average,
                }));
            }
        }
    }
    all
}

/// Mean PSNR in dB of each photograph: one method behind one camera at one noise level, at one depth or over all.
pub(crate) fn by_photo(
    rows: &[Measured],
    (method, camera): (&Method, &str),
    noise: Noise,
    psi: Option<f64>,
) -> BTreeMap<String, f64> {
    let own = |r: &&Measured| {
        (&r.identity, r.camera.as_str(), r.noise) == (method, camera, noise)
            && psi.is_none_or(|psi| r.psi == psi)
    };
    means_by_photo(rows.iter().filter(own).map(|row| (row.image.as_str(), row.picture.psnr_db())))
}

fn means_by_photo<'a>(numbers: impl Iterator<Item = (&'a str, f64)>) -> BTreeMap<String, f64> {
    let mut all: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    numbers.for_each(|(photo, db)| all.entry(photo).or_default().push(db));
    all.into_iter().map(|(photo, db)| (photo.to_owned(), mean(db.into_iter()))).collect()
}

/// A line for each network that has float rows alone.
fn without_integers(methods: &[MethodSummary]) -> Vec<String> {
    let of = |format| {
        let own = methods.iter().filter(move |m| m.identity.format == Some(format));
        distinct(own.filter_map(|m| m.identity.network.clone()))
    };
    let fixed = of(Format::Fixed);
    let missing = of(Format::Float).into_iter().filter(|name| !fixed.contains(name));
    missing
        .map(|name| {
            format!("NO {name}.fixed ROWS: it has no integers made from these weights for this stride")
        })
        .collect()
}

/// What distinguishes a row from others of its method.
type Setting = (String, String, u64, String);

fn setting(row: &Measured) -> Setting {
    (row.camera.clone(), row.image.clone(), row.psi.to_bits(), row.noise.to_string())
}

fn nets(rows: &[Measured]) -> Vec<NetSummary> {
    let found: BTreeMap<(&Method, Setting), &Measured> =
        rows.iter().map(|r| ((&r.identity, setting(r)), r)).collect();
    let floats = || rows.iter().filter(|r| r.identity.format == Some(Format::Float));
    let mut summaries = vec![];
    for (float, camera) in distinct(floats().map(|r| (&r.identity, &r.camera))) {
        let (rounded, fixed) = (float.in_format(Format::Float422), float.in_format(Format::Fixed));
        let own = || floats().filter(|r| r.identity == *float && r.camera == *camera);
        for noise in distinct(own().map(|r| r.noise)) {
            let twins: Vec<(&Measured, &Measured, Option<&Measured>)> = own()
                .filter(|r| r.noise == noise)
                .filter_map(|r| {
                    let twin = |method| found.get(&(method, setting(r))).copied();
                    Some((r, twin(&rounded)?, twin(&fixed)))
                })
                .collect();
            if twins.is_empty() {
                continue;
            }
            let cost: Vec<f64> =
                twins.iter().map(|(f, g, _)| f.picture.psnr_db() - g.picture.psnr_db()).collect();
            summaries.push(NetSummary {
                float: float.clone(),
                camera: camera.clone(),
                noise,
                mean_cost_of_422_db: mean(cost.iter().copied()),
                largest_cost_of_422_db: cost.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                fixed: FixedCost::of(&twins),
            });
        }
    }
    summaries
}

impl FixedCost {
    fn of(twins: &[(&Measured, &Measured, Option<&Measured>)]) -> Option<Self> {
        let losses: Vec<(f64, &Measured)> = twins
            .iter()
            .filter_map(|(_, rounded, fixed)| {
                fixed.map(|x| (rounded.picture.psnr_db() - x.picture.psnr_db(), x))
            })
            .collect();
        let (largest_loss_db, row) = losses.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let rows: Vec<&Measured> = losses.iter().map(|l| l.1).collect();
        Some(Self {
            mean_loss_db: mean(losses.iter().map(|l| l.0)),
            largest_loss_db: *largest_loss_db,
            largest_loss_image: row.image.clone(),
            largest_loss_psi: row.psi,
            work: Work::mean_of(&rows),
        })
    }
}

/// The mean; NaN of nothing.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    edof_numerics::mean(values).unwrap_or(f64::NAN)
}

fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Each value once, in the order of first appearance.
fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut all = vec![];
    for value in values {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

mod verdict;

#[cfg(test)]
pub(crate) mod tests;
