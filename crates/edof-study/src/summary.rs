//! What an experiment's rows say together: averages, worst depths, what fixed point and 4:2:2 cost.

use crate::kodak::{Measured, Work};
use edof_image::{Noise, Tone};
use edof_methods::method::{Format, Method};
use edof_metrics::paired::Paired;
use edof_metrics::{BORDER, Quality};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The whole result of an experiment, as its JSON file holds it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Study {
    /// How its quality is measured.
    pub measure: Measure,
    /// One for each method, photograph and setting.
    pub rows: Vec<Measured>,
    /// What they say together.
    pub summary: Summary,
}

/// How quality is measured (docs/decisions/0003-metrics.md, 0010-tone-and-noise.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Summary {
    /// One for each method, camera and noise level, in the rows' order.
    pub methods: Vec<MethodSummary>,
    /// One for each network, camera and noise level.
    pub nets: Vec<NetSummary>,
    /// One for each two float networks and noise level.
    #[serde(skip_deserializing)]
    pub differences: Vec<Difference>,
    /// What was left out or looks wrong, one line each.
    pub notes: Vec<String>,
}

/// One method behind one camera at one noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MethodSummary {
    /// Short name of the method.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Its camera.
    pub camera: String,
    /// Noise of the sensor.
    pub noise: Noise,
    /// The picture over depths.
    #[serde(flatten)]
    pub picture: Course,
    /// The light over depths.
    pub light: Course,
    /// Mean seconds a megapixel.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Mean PSNR at each depth: pairs of ψ and dB, ψ ascending.
    pub psi_db: Vec<[f64; 2]>,
    /// Mean over depths.
    pub average_db: f64,
    /// The worst depth's mean.
    pub worst_db: f64,
    /// Which depth that is.
    pub worst_psi: f64,
    /// Mean SSIM.
    pub ssim: f64,
}

/// What fixed point and 4:2:2 cost a network, measured on the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetSummary {
    /// The network in floating point.
    #[serde(flatten)]
    pub float: Method,
    /// Its camera.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
        Self { measure, rows, summary }
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

impl Course {
    /// The farthest depth: ψ and dB.
    #[must_use]
    pub fn farthest(&self) -> [f64; 2] {
        self.psi_db.last().copied().unwrap_or([f64::NAN; 2])
    }

    fn of(rows: &[&Measured], quality: impl Fn(&Measured) -> Quality) -> Self {
        let psi_db: Vec<[f64; 2]> = ascending(rows.iter().map(|r| r.psi))
            .into_iter()
            .map(|psi| [psi, mean(rows.iter().filter(|r| r.psi == psi).map(|r| quality(r).psnr_db))])
            .collect();
        let worst = psi_db.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2]);
        Self {
            average_db: mean(psi_db.iter().map(|p| p[1])),
            worst_db: worst[1],
            worst_psi: worst[0],
            ssim: mean(rows.iter().map(|r| quality(r).ssim)),
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
                picture: Course::of(&own, |r| r.picture),
                light: Course::of(&own, |r| r.light),
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
        let by_photo = |(method, camera): (&Method, &String), far: bool| -> BTreeMap<String, f64> {
            let own = |r: &&Measured| {
                (&r.identity, &r.camera, r.noise) == (method, camera, noise) && (!far || r.psi == farthest)
            };
            let photos = distinct(floats().filter(own).map(|r| &r.image));
            let db = |photo: &String| {
                mean(floats().filter(own).filter(|r| r.image == *photo).map(|r| r.picture.psnr_db))
            };
            photos.into_iter().map(|photo| (photo.clone(), db(photo))).collect()
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

/// What tells a row from others of its method.
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
                twins.iter().map(|(f, g, _)| f.picture.psnr_db - g.picture.psnr_db).collect();
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
            .filter_map(|(_, rounded, fixed)| fixed.map(|x| (rounded.picture.psnr_db - x.picture.psnr_db, x)))
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

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A row that says little but its PSNR.
    pub(crate) fn row(method: &Method, image: &str, psi: f64, noise: Noise, psnr_db: f64) -> Measured {
        let quality = Quality {
            psnr_db,
            psnr_clipped_db: psnr_db,
            channel_psnr_db: [psnr_db; 3],
            luma_psnr_db: psnr_db,
            ssim: 0.9,
            luma_ssim: 0.9,
        };
        Measured {
            method: method.to_string(),
            identity: method.clone(),
            camera: "clear".into(),
            image: image.into(),
            psi,
            noise,
            tone: Tone::Srgb,
            picture: quality,
            light: Quality { psnr_db: psnr_db + 2.0, ..quality },
            seconds_per_megapixel: 1.0,
            work: Work::default(),
        }
    }

    pub(crate) fn net(format: Format) -> Method {
        Method::network("n", format, 8, 4)
    }

    #[test]
    fn averages_run_over_photos_then_depths() {
        let method = Method::demosaic();
        let at = |image, psi, db| row(&method, image, psi, Noise::None, db);
        let rows = vec![at("p1", 0.0, 30.0), at("p2", 0.0, 34.0), at("p1", 8.0, 28.0), at("p2", 8.0, 30.0)];
        let study = Study::of(rows);
        let m = &study.summary.methods[0];
        assert_eq!(m.picture.psi_db, [[0.0, 32.0], [8.0, 29.0]]);
        assert_eq!((m.picture.average_db, m.picture.worst_db, m.picture.worst_psi), (30.5, 29.0, 8.0));
        assert_eq!((m.light.average_db, m.light.farthest()), (32.5, [8.0, 31.0]));
    }

    #[test]
    fn one_method_behind_two_cameras_has_two_summaries() {
        let mut rows = vec![row(&Method::demosaic(), "p", 0.0, Noise::None, 30.0); 2];
        rows[1].camera = "ring-outer".into();
        let study = Study::of(rows);
        assert_eq!(study.summary.methods.len(), 2);
        assert_eq!(study.summary.subjects()[1].1, "ring-outer");
    }

    #[test]
    fn the_largest_loss_of_fixed_point_is_that_of_a_single_row() {
        let noise = Noise::gaussian(0.01);
        let mut rows = vec![];
        for (image, loss) in [("p1", 0.001), ("p2", 0.015), ("p3", -0.002)] {
            rows.push(row(&net(Format::Float), image, 8.0, noise, 34.0));
            rows.push(row(&net(Format::Float422), image, 8.0, noise, 33.5));
            let work = Work {
                nonzeros_a_patch: Some(vec![60.0, 50.0 + 300.0 * loss]),
                saturations: Some(2),
                ..Work::default()
            };
            rows.push(Measured { work, ..row(&net(Format::Fixed), image, 8.0, noise, 33.5 - loss) });
        }
        let n = &Study::of(rows).summary.nets[0];
        let fixed = n.fixed.as_ref().unwrap();
        assert!((fixed.largest_loss_db - 0.015).abs() < 1e-9);
        assert_eq!((fixed.largest_loss_image.as_str(), fixed.largest_loss_psi), ("p2", 8.0));
        assert!((n.mean_cost_of_422_db - 0.5).abs() < 1e-9);
        assert_eq!(fixed.work.saturations, Some(6));
        let nonzeros = fixed.work.nonzeros_a_patch.as_ref().unwrap();
        assert!((nonzeros[0] - 60.0).abs() < 1e-9 && (nonzeros[1] - 51.4).abs() < 1e-9, "{nonzeros:?}");
    }

    #[test]
    fn two_networks_are_compared_photograph_by_photograph() {
        let other = Method::network("m", Format::Float, 8, 4);
        let mut rows = vec![];
        for (image, gain) in [("p1", 1.0), ("p2", 2.0), ("p3", 3.0)] {
            for (psi, further) in [(0.0, 0.0), (8.0, 1.0)] {
                rows.push(row(&net(Format::Float), image, psi, Noise::None, 30.0 + gain + further));
                rows.push(row(&other, image, psi, Noise::None, 30.0));
            }
        }
        let differences = Study::of(rows).summary.differences;
        let [one] = &differences[..] else { panic!("{differences:?}") };
        assert_eq!((one.first.as_str(), one.second.as_str()), ("n.float", "m.float"));
        // 1, 2 and 3 have a standard deviation of 1, their mean one of 1/√3.
        assert_eq!(
            (one.average.to_string(), one.farthest.to_string()),
            ("+2.50 ± 0.58".into(), "+3.00 ± 0.58".into())
        );
    }

    #[test]
    fn a_net_without_fixed_rows_has_no_cost_of_fixed_point() {
        let rows = [Format::Float, Format::Float422].map(|f| row(&net(f), "p", 0.0, Noise::None, 34.0));
        let study = Study::of(rows.to_vec());
        assert_eq!(study.summary.nets[0].fixed, None);
        let note = "NO n.fixed ROWS: it has no integers made from these weights for this stride";
        assert_eq!(study.summary.notes, [note]);
    }

    #[test]
    fn the_json_is_an_object_with_rows_that_reads_back() {
        let study = Study::of(vec![row(&net(Format::Fixed), "p", 0.0, Noise::sensor(8.0), 30.0)]);
        let text = serde_json::to_string(&study).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let fields = [
            "method",
            "family",
            "network",
            "format",
            "stride",
            "layers",
            "camera",
            "image",
            "psi",
            "noise",
            "tone",
            "psnr_db",
            "ssim",
            "light",
            "seconds_per_megapixel",
        ];
        for field in fields {
            assert!(value["rows"][0].get(field).is_some(), "{field}");
        }
        assert_eq!(value["rows"][0]["noise"], "sensor:gain=8");
        let back: Study = serde_json::from_str(&text).unwrap();
        assert_eq!((back.rows, back.measure), (study.rows, study.measure));
    }
}
