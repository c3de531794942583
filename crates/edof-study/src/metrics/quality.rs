//! What a reconstruction is worth: every metric of a picture, with the conventions that every number of this project follows
//! (docs/decisions/0003-metrics.md).
//!
//! Peak 1. A border of [`BORDER`] pixels is cropped first. Estimates are *not* clipped to 0…1 unless a name says so. Sums
//! run in f64 in a fixed order. What is compared is the picture ([`shown`](crate::metrics::shown)), under sRGB also the linear light.

use crate::metrics::comparable::{MetricError, compared};
use crate::metrics::metric::{Metric, Place, Score};
use crate::metrics::registry::{METRICS, place};
use crate::metrics::{psnr, ssim};
use edof_core::{ColourFrame, Tone};
use rayon::prelude::*;
use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

/// Pixels that studies crop on each side before they measure.
pub const BORDER: usize = 8;
/// Smallest side in pixels, inside the border, of a picture that is measured; some metrics need more.
const MIN_SIDE: usize = ssim::ALL.min_side;

/// Quality of a picture: a map from metrics to their scores, which always holds PSNR. A metric that was not measured, because the
/// picture is too small for it or the row older than the metric, is absent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality([Option<Score>; METRICS.len()]);

impl Quality {
    /// Compares `estimate` with `truth` inside a border of `border` pixels, by every metric that the picture is large enough for.
    /// `tone` is the encoding of both.
    ///
    /// # Errors
    /// [`MetricError`] for frames of different sizes or smaller than the border and SSIM's window.
    pub fn of(
        truth: &ColourFrame,
        estimate: &ColourFrame,
        border: usize,
        tone: Tone,
    ) -> Result<Self, MetricError> {
        let pair = compared(truth, estimate, border, MIN_SIDE, tone)?;
        let (height, width) = pair.truth.size();
        let fits = |metric: &Metric| height.min(width) >= metric.min_side;
        let mut scores = [None; METRICS.len()];
        scores
            .par_iter_mut()
            .zip(METRICS)
            .for_each(|(score, metric)| *score = fits(metric).then(|| (metric.measure)(&pair)));
        Ok(Self(scores))
    }

    /// Returns a quality of one PSNR in dB over all colours.
    #[must_use]
    pub fn of_psnr(psnr_db: f64) -> Self {
        Self([None; METRICS.len()]).with(psnr::ALL.name, psnr_db)
    }

    /// Returns the same quality with one number replaced or added; an unknown name changes nothing.
    #[must_use]
    pub fn with(mut self, name: &str, value: f64) -> Self {
        if let Some(place) = place(name) {
            self.0[place] = Some(Score::One(value));
        }
        self
    }

    /// Returns PSNR in dB over all three colours.
    #[must_use]
    pub fn psnr_db(&self) -> f64 {
        self.number(psnr::ALL.name).unwrap_or_else(|| unreachable!("every quality holds PSNR"))
    }

    /// Returns the score of a metric, if it was measured.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Score> {
        place(name).and_then(|place| self.0[place])
    }

    /// Returns the number of a metric, if it was measured and is one number.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name).and_then(Score::one)
    }

    /// Returns every metric that was measured, with its score, in the order of [`METRICS`].
    pub fn scores(&self) -> impl Iterator<Item = (&'static Metric, Score)> {
        METRICS.iter().zip(self.0).filter_map(|(metric, score)| Some((metric, score?)))
    }

    /// Returns the mean of each number that all of these hold and tables show.
    #[must_use]
    pub fn means(all: &[Self]) -> Means {
        let mean = |metric: &'static Metric| {
            let numbers: Option<Vec<f64>> = all.iter().map(|quality| quality.number(metric.name)).collect();
            Some((metric.name, edof_numerics::mean(numbers?)?))
        };
        METRICS.iter().filter(|metric| metric.place != Place::Rows).filter_map(mean).collect()
    }
}

/// Means by the names of their metrics.
pub type Means = BTreeMap<&'static str, f64>;

/// Returns the metrics that a table of these means has a column for: those of every table, then those that any of the means hold.
#[must_use]
pub fn columns<'a>(all: impl Iterator<Item = &'a Means> + Clone) -> Vec<&'static Metric> {
    let is_shown = |metric: &&Metric| match metric.place {
        Place::Rows => false,
        Place::Tables => true,
        Place::Further => all.clone().any(|means| means.contains_key(metric.name)),
    };
    METRICS.iter().filter(is_shown).collect()
}

/// Returns the cell of a metric's column; a dash where the metric was not measured.
#[must_use]
pub fn cell(means: &Means, metric: &Metric) -> String {
    means.get(metric.name).map_or_else(|| "–".to_owned(), |mean| metric.digits(*mean))
}

impl Serialize for Quality {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.scores().map(|(metric, score)| (metric.name, score)))
    }
}

impl<'de> Deserialize<'de> for Quality {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_map(Reader)
    }
}

/// Takes the fields that are metrics and leaves all others to whom they belong.
struct Reader;

impl<'de> Visitor<'de> for Reader {
    type Value = Quality;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("metrics by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Quality, A::Error> {
        let mut scores = [None; METRICS.len()];
        while let Some(name) = fields.next_key::<String>()? {
            match place(&name) {
                Some(place) => {
                    let score = fields.next_value().map_err(|e| Error::custom(format!("{name}: {e}")))?;
                    scores[place] = Some(score);
                }
                None => drop(fields.next_value::<IgnoredAny>()?),
            }
        }
        let quality = Quality(scores);
        quality.number(psnr::ALL.name).ok_or_else(|| Error::missing_field(psnr::ALL.name))?;
        Ok(quality)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{psnr, shown, ssim};
    use ndarray::{Array2, Array3, Axis};

    const LIGHT: Tone = Tone::Linear;

    fn pattern(height: usize, width: usize) -> ColourFrame {
        ColourFrame {
            planes: Array3::from_shape_fn((3, height, width), |(p, r, c)| {
                0.5 + 0.4 * ((r as f32 * 0.31 + p as f32).sin() * (c as f32 * 0.17).cos())
            }),
        }
    }

    #[test]
    fn an_error_of_a_hundredth_is_40_db_in_every_colour_and_luma() {
        let truth = pattern(40, 44);
        let mut estimate = truth.clone();
        estimate.planes += 0.01;
        let q = Quality::of(&truth, &estimate, 8, LIGHT).unwrap();
        let Some(Score::Colours([red, _, blue])) = q.get("channel_psnr_db") else { panic!("{q:?}") };
        for value in [q.psnr_db(), q.number("luma_psnr_db").unwrap(), red, blue] {
            assert!((value - 40.0).abs() < 1e-3, "{q:?}");
        }
    }

    #[test]
    fn what_a_screen_cannot_show_counts_on_light_alone() {
        let black = ColourFrame::zeros(40, 40);
        let mut light = black.clone();
        light.planes.fill(-0.1);
        assert_eq!(shown(&light, Tone::Srgb), black);
        assert_eq!(shown(&light, Tone::Linear), light);
        light.planes.fill(0.214_041);
        assert!(shown(&light, Tone::Srgb).planes.iter().all(|v| (v - 0.5).abs() < 1e-5));
    }

    #[test]
    fn colours_are_averaged_as_errors_not_as_decibels() {
        let truth = ColourFrame::zeros(40, 40);
        let mut estimate = truth.clone();
        estimate.planes.index_axis_mut(Axis(0), 0).fill(0.1);
        let q = Quality::of(&truth, &estimate, 8, LIGHT).unwrap();
        assert!((q.psnr_db() - 10.0 * (300f64).log10()).abs() < 1e-4);
        assert!(
            matches!(q.get("channel_psnr_db"), Some(Score::Colours([_, green, _])) if green.is_infinite())
        );
    }

    #[test]
    fn what_lies_in_the_border_does_not_count() {
        let truth = pattern(40, 40);
        let mut estimate = truth.clone();
        estimate.planes[(0, 7, 20)] += 1.0;
        estimate.planes[(2, 20, 32)] += 1.0;
        assert!(psnr(&truth, &estimate, 8).unwrap().is_infinite());
        assert!(psnr(&truth, &estimate, 7).unwrap().is_finite());
    }

    #[test]
    fn clipping_forgives_what_lies_beyond_white() {
        let mut truth = ColourFrame::zeros(40, 40);
        truth.planes.fill(1.0);
        let mut estimate = truth.clone();
        estimate.planes.fill(1.1);
        let q = Quality::of(&truth, &estimate, 8, LIGHT).unwrap();
        assert!((q.psnr_db() - 20.0).abs() < 1e-4 && q.number("psnr_clipped_db").unwrap().is_infinite());
    }

    #[test]
    fn equal_frames_have_ssim_one_and_any_error_less() {
        let truth = pattern(40, 40);
        let ssim = |estimate: &ColourFrame, name: &str| {
            Quality::of(&truth, estimate, 8, LIGHT).unwrap().number(name).unwrap()
        };
        assert!(
            (ssim(&truth, "ssim") - 1.0).abs() < 1e-12 && (ssim(&truth, "luma_ssim") - 1.0).abs() < 1e-12
        );
        let mut estimate = truth.clone();
        estimate.planes.indexed_iter_mut().for_each(|((_, r, c), v)| *v += 0.1 * ((r + c) % 2) as f32);
        assert!(ssim(&estimate, "ssim") < 0.95);
    }

    #[test]
    fn metrics_of_unequal_or_small_frames_are_rejected_not_computed() {
        let psnr = |a: (usize, usize), b: (usize, usize), border: usize| {
            psnr(&ColourFrame::zeros(a.0, a.1), &ColourFrame::zeros(b.0, b.1), border)
                .map_err(|e| e.to_string())
        };
        let unequal = "frames of 40x40 and 42x40 pixels: must be equally large";
        assert_eq!(psnr((40, 40), (40, 42), 8).unwrap_err(), unequal);
        assert_eq!(psnr((40, 40), (40, 42), 0).unwrap_err(), unequal);
        let small = "frame of 20x16 pixels: must be at least 17x17 to crop 8 pixels and compare";
        assert_eq!(psnr((16, 20), (16, 20), 8).unwrap_err(), small);
        assert!(psnr((16, 20), (16, 20), usize::MAX).unwrap_err().starts_with("frame of 20x16 pixels: "));
        assert_eq!(psnr((17, 17), (17, 17), 8), Ok(f64::INFINITY));
        let ssim = |a: (usize, usize), b: (usize, usize)| {
            let planes = [Array2::<f32>::zeros(a), Array2::<f32>::zeros(b)];
            ssim(planes[0].view(), planes[1].view()).map_err(|e| e.to_string())
        };
        let small = "frame of 11x10 pixels: must be at least 11x11 to crop 0 pixels and compare";
        assert_eq!(ssim((10, 11), (10, 11)).unwrap_err(), small);
        assert_eq!(ssim((0, 0), (0, 0)).unwrap_err().split(':').next(), Some("frame of 0x0 pixels"));
        assert_eq!(
            ssim((20, 11), (11, 20)).unwrap_err(),
            "frames of 11x20 and 20x11 pixels: must be equally large"
        );
        assert_eq!(ssim((11, 11), (11, 11)), Ok(1.0));
    }

    #[test]
    fn frames_that_cannot_be_compared_are_rejected() {
        let error = |a: (usize, usize), b: (usize, usize)| {
            let frames = (ColourFrame::zeros(a.0, a.1), ColourFrame::zeros(b.0, b.1));
            Quality::of(&frames.0, &frames.1, 8, LIGHT).unwrap_err().to_string()
        };
        assert_eq!(error((40, 50), (40, 52)), "frames of 50x40 and 52x40 pixels: must be equally large");
        assert!(error((20, 50), (20, 50)).starts_with("frame of 50x20 pixels: must be at least 27x27"));
    }

    #[test]
    fn names_of_metrics_are_unique_and_every_metric_measures_the_smallest_picture_that_it_states() {
        for metric in METRICS {
            assert_eq!(
                METRICS.iter().filter(|other| other.name == metric.name).count(),
                1,
                "{}",
                metric.name
            );
            let (truth, mut estimate) = (pattern(metric.min_side, metric.min_side), pattern(1, 1));
            estimate.clone_from(&truth);
            estimate.planes[(0, 0, 0)] += 0.25;
            let measured = (metric.measure)(&compared(&truth, &estimate, 0, metric.min_side, LIGHT).unwrap());
            let numbers = match measured {
                Score::One(number) => vec![number],
                Score::Colours(numbers) => numbers.to_vec(),
            };
            assert!(numbers.iter().all(|number| !number.is_nan()), "{}: {numbers:?}", metric.name);
        }
    }

    /// A row as programs before the map of metrics wrote it.
    const OLD: &str =
        r#"{"image":"p","psnr_db":"inf","channel_psnr_db":[1.5,"inf",2.5],"ssim":0.5,"place":7}"#;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        image: String,
        #[serde(flatten)]
        picture: Quality,
        place: usize,
    }

    #[test]
    fn a_metric_that_a_row_does_not_hold_is_absent_and_unknown_ones_are_left_alone() {
        let row: Row = serde_json::from_str(OLD).unwrap();
        let held: Vec<&str> = row.picture.scores().map(|(metric, _)| metric.name).collect();
        assert_eq!(held, ["psnr_db", "channel_psnr_db", "ssim"]);
        assert_eq!((row.picture.psnr_db(), row.picture.number("luma_ssim")), (f64::INFINITY, None));
        assert_eq!(serde_json::to_string(&row).unwrap(), OLD);
        let newer = OLD.replace("\"place\"", "\"metric_of_next_year\":0.25,\"place\"");
        assert_eq!(serde_json::from_str::<Row>(&newer).unwrap(), row);
        let error = |text: &str| serde_json::from_str::<Row>(text).unwrap_err().to_string();
        assert!(error(r#"{"image":"p","ssim":0.5,"place":7}"#).starts_with("missing field `psnr_db`"));
        let much = error(&OLD.replace("0.5", "\"much\""));
        assert!(much.starts_with("ssim: expected a number, \"inf\""), "{much}");
    }

    #[test]
    fn a_mean_is_of_a_metric_that_all_hold() {
        let all = [Quality::of_psnr(30.0).with("ssim", 0.5), Quality::of_psnr(40.0).with("ssim", 0.75)];
        assert_eq!(Quality::means(&all).get("ssim"), Some(&0.625));
        assert_eq!(Quality::means(&[all[0], Quality::of_psnr(1.0)]), Means::new());
    }
}
