//! Which network behind which camera is better, at each noise level.

use super::{MethodSummary, Study, by_photo};
use crate::methods::method::{Family, Format, Method};
use crate::metrics::paired::Paired;
use crate::pictures::capitalised;
use crate::tables::{noise_words, psi_words};
use crate::verdict::{compared, is_ahead};
use edof_core::camera::{Camera, PRESETS};
use edof_core::{Noise, Tone};

type Subject<'a> = (&'a Method, &'a str);

impl Study {
    /// The best network against the best one behind another camera, at every noise level; where there is one camera, against
    /// demosaicing alone.
    #[must_use]
    pub fn verdict(&self) -> Option<String> {
        let noises = self.summary.noises();
        let first = *noises.first()?;
        let own = self.best(first, |_| true)?;
        let subject = (&own.identity, own.camera.as_str());
        let rival = self.best(first, |m| m.camera != own.camera).or_else(|| {
            let all = self.summary.methods.iter().filter(|m| m.noise == first && m.camera == own.camera);
            all.into_iter().find(|m| m.identity.family == Family::DemosaicMalvar)
        })?;
        let other = (&rival.identity, rival.camera.as_str());
        let each: Vec<String> =
            noises.iter().filter_map(|&noise| self.sentence(subject, other, noise)).collect();
        let each = each.join(" ");
        if rival.identity.format.is_none() {
            let (own, lens, other) = (&own.identity, lens(&own.camera), &rival.identity);
            return Some(format!("{own} behind {lens}, compared with {other} of the same frames. {each}"));
        }
        Some(format!(
            "{} with {}, compared with {} with {}, the best network behind another lens. {each}{}",
            capitalised(&lens(&own.camera)),
            own.identity,
            lens(&rival.camera),
            rival.identity,
            other_tone(self.measure.tone)
        ))
    }

    /// The network in floating point that is best on average over depths.
    fn best(&self, noise: Noise, which: impl Fn(&MethodSummary) -> bool) -> Option<&MethodSummary> {
        let floats = self.summary.methods.iter().filter(|m| m.identity.format == Some(Format::Float));
        let own = floats.filter(|m| m.noise == noise && which(m));
        own.max_by(|a, b| a.picture.average_db.total_cmp(&b.picture.average_db))
    }

    /// How the first compares with the second: on average over depths, and where that differs or not, at the farthest depth.
    fn sentence(&self, own: Subject<'_>, other: Subject<'_>, noise: Noise) -> Option<String> {
        let far = self.rows.iter().map(|row| row.psi).fold(f64::NEG_INFINITY, f64::max);
        let at = |psi| {
            let of = |subject| by_photo(&self.rows, subject, noise, psi);
            Paired::between(&of(own), &of(other))
        };
        let (average, farthest) = (at(None)?, at(Some(far))?);
        let joint = if is_ahead(&average) == is_ahead(&farthest) { "and" } else { "but" };
        Some(format!(
            "{}: it is {} on average over ψ, {joint} {} at ψ = {}.",
            condition(noise),
            compared(&average),
            compared(&farthest),
            psi_words(far)
        ))
    }
}

/// What may make a comparison of networks unfair, and is in no row (docs/decisions/0041-one-tone.md).
const fn other_tone(tone: Tone) -> &'static str {
    match tone {
        Tone::Srgb => {
            " The rows do not state the tone that a network was trained for: one that was trained for linear light loses about 1 dB \
             here ('edof weights NAME' prints it)."
        }
        Tone::Linear => {
            " The rows do not state the tone that a network was trained for: one that was trained for sRGB loses 1.5 to 4 dB here \
             ('edof weights NAME' prints it)."
        }
    }
}

/// A camera by its name, and for a preset whether it has a mask.
fn lens(camera: &str) -> String {
    let preset = PRESETS.iter().find(|(name, _)| *name == camera);
    match preset.and_then(|(name, text)| Camera::from_json(text, name).ok()) {
        Some(known) if known.is_clear() => format!("the clear lens {camera}"),
        Some(_) => format!("the coded lens {camera}"),
        None => format!("camera {camera}"),
    }
}

/// The beginning of a sentence about a noise level.
fn condition(noise: Noise) -> String {
    match noise {
        Noise::None => "Without noise".to_owned(),
        Noise::Sensor(_) => format!("With {}", noise_words(noise).replacen("sensor", "sensor noise", 1)),
        noise => format!("At {}", noise_words(noise)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::row;
    use super::*;
    use crate::trial::Measured;

    /// Rows of two networks behind two lenses on two photographs: dB of the coded one, the clear one has 34.
    fn study(coded: &[(Noise, f64, f64)]) -> Study {
        let network = |name: &str| Method::network(name, Format::Float, 8, 4);
        let mut rows = vec![];
        for &(noise, near, far) in coded {
            for (image, luck) in [("p1", 0.1), ("p2", -0.1)] {
                let of = |name: &str, camera: &str, psi: f64, db: f64| Measured {
                    camera: camera.into(),
                    ..row(&network(name), image, psi, noise, db)
                };
                rows.push(of("coded-net", "ring-outer", 0.0, near + luck));
                rows.push(of("coded-net", "ring-outer", 8.0, far + luck));
                rows.push(of("clear-net", "clear", 0.0, 34.0));
                rows.push(of("clear-net", "clear", 8.0, 34.0));
            }
        }
        Study::of(rows)
    }

    #[test]
    fn the_better_lens_is_named_with_its_standard_errors() {
        let verdict = study(&[(Noise::None, 35.0, 36.0)]).verdict().unwrap();
        assert_eq!(
            verdict,
            "The coded lens ring-outer with coded-net.float, compared with the clear lens clear with clear-net.float, the best network \
             behind another lens. Without noise: it is better by 1.50 ± 0.10 dB on average over ψ, and better by 2.00 ± 0.10 dB at ψ = 8. \
             The rows do not state the tone that a network was trained for: one that was trained for linear light loses about 1 dB here \
             ('edof weights NAME' prints it)."
        );
    }

    #[test]
    fn where_it_loses_is_stated_as_plainly() {
        let noise = Noise::gaussian(0.02);
        let verdict = study(&[(Noise::None, 35.0, 36.0), (noise, 31.0, 34.04)]).verdict().unwrap();
        assert!(
            verdict.contains(
                "At σ = 0.02: it is worse by 1.48 ± 0.10 dB on average over ψ, but equally good within the error (+0.04 ± 0.10 \
                 dB) at ψ = 8."
            ),
            "{verdict}"
        );
        let verdict = study(&[(Noise::None, 33.0, 32.0)]).verdict().unwrap();
        assert!(
            verdict.starts_with(
                "The clear lens clear with clear-net.float, compared with the coded lens ring-outer"
            ),
            "{verdict}"
        );
        assert!(
            verdict.contains("better by 1.50 ± 0.10 dB on average over ψ, and better by 2.00"),
            "{verdict}"
        );
    }

    #[test]
    fn one_camera_is_compared_with_demosaicing() {
        let rows = vec![
            row(&Method::demosaic(), "p", 0.0, Noise::None, 36.0),
            row(&Method::network("n", Format::Float, 8, 4), "p", 0.0, Noise::None, 34.5),
        ];
        let verdict = Study::of(rows).verdict().unwrap();
        assert_eq!(
            verdict,
            "n.float behind the clear lens clear, compared with demosaic-malvar of the same frames. Without noise: it is worse by \
             1.50 dB on average over ψ, and worse by 1.50 dB at ψ = 0."
        );
        assert_eq!(Study::of(vec![]).verdict(), None);
    }
}
