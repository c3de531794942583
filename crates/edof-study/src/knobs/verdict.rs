//! Which defaults cost quality, and which settings would be better or faster, in sentences.

use super::page::{Knobs, Point};
use crate::verdict::{compared, is_ahead, speed};
use edof_core::words::count;

/// Knobs whose dB are the accuracy of a simulated frame, not the quality of a picture.
pub(super) const CAPTURING: [&str; 3] = ["kernel-energy", "wavelengths", "depths"];

impl Knobs {
    /// One sentence for each knob of reconstruction that has a better value than its default; one for all others; one for the
    /// accuracy of captures.
    #[must_use]
    pub fn verdict(&self) -> Vec<String> {
        let defaults = || self.points.iter().filter(|p| p.is_default);
        let of_pictures = || defaults().filter(|p| !CAPTURING.contains(&p.knob.name));
        let mut all: Vec<String> = of_pictures().filter_map(|default| self.better(default)).collect();
        let as_good = of_pictures().count() - all.len();
        if as_good > 0 {
            let which = match (all.is_empty(), as_good) {
                (true, _) => count(as_good, "knob"),
                (false, 1) => "the other knob".to_owned(),
                (false, _) => format!("the other {}", count(as_good, "knob")),
            };
            all.push(format!(
                "At {which} of reconstruction no measured value is better than the default by more than 0.05 dB and twice its standard \
                 error."
            ));
        }
        let captures: Vec<String> = defaults()
            .filter(|p| CAPTURING.contains(&p.knob.name))
            .map(|p| format!("{} {:.1} dB", p.knob.name, p.psnr_db))
            .collect();
        if !captures.is_empty() {
            all.push(format!(
                "A simulated frame at the defaults differs from an exact one by so little (PSNR of the light): {}.",
                captures.join(", ")
            ));
        }
        all
    }

    /// The best value of the default's knob, if it is better.
    fn better(&self, default: &Point) -> Option<String> {
        let others = self.points.iter().filter(|p| *p.knob == *default.knob && !p.is_default);
        let (best, gain) = others
            .filter_map(|p| Some((p, p.to_default?)))
            .filter(|(_, gain)| is_ahead(gain) == Some(true))
            .max_by(|a, b| a.1.mean.total_cmp(&b.1.mean))?;
        let time = match default.knob.takes_time && best.photos > 1 {
            true => format!(", and {}", speed(best.seconds_per_megapixel, default.seconds_per_megapixel)),
            false => String::new(),
        };
        let by = compared(&gain).trim_start_matches("better by ").to_owned();
        let (name, unit) = (default.knob.name, default.knob.unit);
        let unit = if unit == name { String::new() } else { format!(" ({unit})") };
        Some(format!(
            "{name}{unit}: {} is better than the default, {}, by {by}{time}.",
            best.value, default.value
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Knob, Row};
    use super::*;
    use crate::journal::Proof;
    use crate::study_report::StudyReport;
    use edof_core::Noise;

    /// A knob's value on two photographs.
    fn rows(knob: &str, value: f64, is_default: bool, db: [f64; 2], seconds: f64) -> Vec<Row> {
        let knob: &'static Knob = knob.parse().unwrap();
        let row = |(image, psnr_db): (&str, f64)| Row {
            knob,
            value,
            is_default,
            image: image.into(),
            psi: 8.0,
            noise: Noise::None,
            psnr_db,
            seconds_per_megapixel: seconds,
            seconds_range: None,
            kernel_sides: None,
            proof: Proof::default(),
        };
        ["a", "b"].into_iter().zip(db).map(row).collect()
    }

    fn verdict(rows: &[Vec<Row>]) -> Vec<String> {
        Knobs::new(&rows.concat(), "m".into()).unwrap().verdict()
    }

    #[test]
    fn a_better_value_is_named_with_its_gain_and_its_time() {
        let all = verdict(&[
            rows("stride", 8.0, true, [28.0, 29.0], 0.2),
            rows("stride", 4.0, false, [28.2, 29.2], 0.6),
            rows("stride", 2.0, false, [28.3, 29.4], 2.0),
            rows("atoms", 16.0, true, [28.0, 29.0], 1.0),
            rows("atoms", 4.0, false, [27.0, 28.0], 0.1),
            rows("depths", 16.0, true, [48.7, 48.7], 1.0),
        ]);
        assert_eq!(
            all,
            [
                "stride (pixels): 2 is better than the default, 8, by 0.35 ± 0.05 dB, and 10 times as slow.",
                "At the other knob of reconstruction no measured value is better than the default by more than 0.05 dB and twice \
                 its standard error.",
                "A simulated frame at the defaults differs from an exact one by so little (PSNR of the light): depths 48.7 dB.",
            ]
        );
    }

    #[test]
    fn a_gain_that_may_be_chance_is_none() {
        let all = verdict(&[
            rows("stride", 8.0, true, [28.0, 29.0], 0.2),
            rows("stride", 4.0, false, [28.9, 28.9], 0.6),
        ]);
        assert_eq!(all.len(), 1);
        assert!(all[0].starts_with("At 1 knob of reconstruction no measured value is better"), "{all:?}");
    }
}
