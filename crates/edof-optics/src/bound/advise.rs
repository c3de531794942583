//! The lens, stop and focus that a range of depths and a light need, what every other choice costs, and how far the limit is.
//!
//! Lenses are ranked by a mixture of the blind estimate and the one that knows the depth. The mixture, and the line that leads from it to the
//! dB of trained networks, are a fit to the rows of `docs/results/aperture-networks.jsonl`; a test of `edof-study` makes the fit again. A mask
//! costs money and must be made, so it is advised only where it is ahead by more than the ranking can err.

use super::ceiling::{Ceiling, ceilings};
use super::judge::{Best, BoundError, Judge, Setting, Sides, possible};
use super::lenses::{Cubic, closed, without_mask};
use super::transfer::Sampling;
use super::{Light, Reached};
use crate::statistics::Statistics;
use edof_core::camera::Camera;

/// Share of the estimate that knows the depth in the mixture by which lenses are ranked.
pub const KNOWN_SHARE: f64 = 0.25;
/// dB of trained networks on photographs: factor and summand of the mixture's dB.
pub const NETWORK_DB: [f64; 2] = [1.116, -0.94];
/// Root mean square by which a network's dB differs from it.
pub const NETWORK_ERROR_DB: f64 = 0.4;
/// Root mean square by which the difference of two lenses in one scene differs from that of their networks.
pub const RANKING_ERROR_DB: f64 = 0.3;

/// Stops that are tried.
pub const STOPS: [f64; 9] = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];
/// How many of the first possible stops are tried with a mask.
const MASKED_STOPS: usize = 4;
/// Strengths of cubic masks in radians for each unit of ψ that the range is wide, and the mixed term as a share.
const STRENGTHS: [f64; 4] = [0.12, 0.2, 0.29, 0.44];
const MIXED: f64 = 0.09;

/// A lens that is compared.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// No mask.
    Clear,
    /// The mask that the camera came with.
    Own,
    /// A cubic mask.
    Cubic(Cubic),
}

/// A lens at a stop, with its best focus.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The mask.
    pub kind: Kind,
    /// Stops by which the lens is closed.
    pub stops: f64,
    /// Focus as ψ of the open aperture.
    pub focus_psi: f64,
    /// By the mixture of linear estimates.
    pub estimate: Reached,
    /// By the estimate that knows the depth.
    pub known: Reached,
    /// The lens as a camera, closed and focused.
    pub camera: Camera,
}

impl Choice {
    /// Returns the dB to be expected of a trained network on photographs, within [`NETWORK_ERROR_DB`].
    #[must_use]
    pub fn expected(&self) -> Reached {
        network(self.estimate)
    }
}

/// The dB of a trained network for a mixture of estimates.
fn network(Reached { average_db, worst_db }: Reached) -> Reached {
    let [factor, summand] = NETWORK_DB;
    Reached { average_db: factor * average_db + summand, worst_db: factor * worst_db + summand }
}

/// What a scene needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The lens to take.
    pub advised: Choice,
    /// All others, the best first: the clear lens at other stops, and each kind of mask at its best.
    pub others: Vec<Choice>,
    /// What no lens passes.
    pub ceiling: Ceiling,
    /// The best average and worst depth of a clear lens that knows the depth, at stops of their own.
    clear_peaks: Reached,
}

impl Advice {
    /// Returns the most that any mask could gain over the best clear lens, with the depth known: average and worst depth.
    #[must_use]
    pub fn any_mask_gains(&self) -> Reached {
        let limit = self.ceiling.bayer_db;
        Reached { average_db: limit, worst_db: limit }.minus(self.clear_peaks)
    }

    /// Returns the expected dB that a choice has less than the advised one.
    #[must_use]
    pub fn cost(&self, other: &Choice) -> Reached {
        self.advised.expected().minus(other.expected())
    }
}

/// Advises a lens for the camera's range of ψ, aperture, pixels and colours in a light. The camera's own mask is one of the choices.
///
/// # Errors
/// [`BoundError`]: a range too wide at every stop, or a camera with a PSF bank.
pub fn advise(camera: &Camera, light: Light, statistics: &Statistics) -> Result<Advice, BoundError> {
    let stops = possible(camera, &STOPS)?;
    let judged =
        |at: f64, camera: &Camera, sides, sampling| judged(at, camera, sides, sampling, light, statistics);
    let clear = without_mask(camera);
    let mut clear_peaks = Reached { average_db: f64::NEG_INFINITY, worst_db: f64::NEG_INFINITY };
    let mut choices = vec![];
    for &at in &stops {
        let Some(best) = judged(at, &clear, Sides::Alike, Sampling::Fine) else { continue };
        clear_peaks.average_db = clear_peaks.average_db.max(best.known.reached.average_db);
        clear_peaks.worst_db = clear_peaks.worst_db.max(best.known.reached.worst_db);
        choices.push(choice(Kind::Clear, &clear, best));
    }
    let masked = &stops[..stops.len().min(MASKED_STOPS)];
    let best_of = |all: Vec<Choice>| all.into_iter().max_by(|a, b| by_score(b, a));
    if !camera.is_clear() {
        let own = masked.iter().filter_map(|at| judged(*at, camera, Sides::Differ, Sampling::Fine));
        choices.extend(best_of(own.map(|best| choice(Kind::Own, camera, best)).collect()));
    }
    let cubic = |at: f64, per_psi: f64| {
        let strength = per_psi * (camera.psi_range[1] - camera.psi_range[0]) * (-at).exp2();
        Cubic { strength: round(strength), mixed: round(MIXED * strength) }
    };
    let cubics = masked.iter().flat_map(|&at| STRENGTHS.map(|per_psi| (at, cubic(at, per_psi))));
    let coarse = cubics.filter_map(|(at, cubic)| {
        let lens = cubic.on(&clear);
        judged(at, &lens, Sides::Alike, Sampling::Coarse).map(|best| choice(Kind::Cubic(cubic), &lens, best))
    });
    if let Some(Choice { kind: kind @ Kind::Cubic(cubic), stops, .. }) = best_of(coarse.collect()) {
        let lens = cubic.on(&clear);
        choices
            .extend(judged(stops, &lens, Sides::Alike, Sampling::Fine).map(|best| choice(kind, &lens, best)));
    }
    let ceiling = ceilings(camera, &[light], stops[0], statistics)[0];
    choices.sort_by(by_score);
    let first_clear = choices.iter().position(|c| c.kind == Kind::Clear).unwrap_or(0);
    let ahead = choices[0].expected().score() - choices[first_clear].expected().score();
    let advised = choices.remove(if ahead > RANKING_ERROR_DB { 0 } else { first_clear });
    Ok(Advice { advised, others: choices, ceiling, clear_peaks })
}

/// Returns the clear lens that is ahead of a camera as it is by more than the ranking can err, with the dB by which it is. Takes a fraction of
/// what [`advise`] does.
///
/// # Errors
/// [`BoundError`], as [`advise`].
pub fn better_clear(
    camera: &Camera,
    light: Light,
    statistics: &Statistics,
) -> Result<Option<(Choice, Reached)>, BoundError> {
    let stops = possible(camera, &STOPS)?;
    let (clear, sides) = (without_mask(camera), if camera.is_clear() { Sides::Alike } else { Sides::Differ });
    let judged =
        |at: f64, camera: &Camera, sides| judged(at, camera, sides, Sampling::Fine, light, statistics);
    let Some(own) = judged(0.0, camera, sides).map(|best| choice(Kind::Own, camera, best)) else {
        return Ok(None);
    };
    let clears = stops.iter().take(MASKED_STOPS).filter_map(|&at| judged(at, &clear, Sides::Alike));
    let best = clears.map(|best| choice(Kind::Clear, &clear, best)).min_by(by_score);
    let ahead = best.map(|best| (best.expected().minus(own.expected()), best));
    Ok(ahead.filter(|(by, _)| by.score() > RANKING_ERROR_DB).map(|(by, best)| (best, by)))
}

/// What a lens reaches at one stop.
fn judged(
    at: f64,
    camera: &Camera,
    sides: Sides,
    sampling: Sampling,
    light: Light,
    statistics: &Statistics,
) -> Option<Best> {
    Judge::new(&[light], &[at], sampling, statistics).best(camera, sides).into_iter().next()
}

/// The best first.
fn by_score(a: &Choice, b: &Choice) -> std::cmp::Ordering {
    b.estimate.score().total_cmp(&a.estimate.score())
}

/// Two digits, as a maker would have it.
fn round(strength: f64) -> f64 {
    (20.0 * strength).round() / 20.0
}

fn choice(kind: Kind, camera: &Camera, best: Best) -> Choice {
    let Setting { stops, focus_psi, reached } = best.blind;
    let mut camera = closed(&Camera { focus_psi, ..camera.clone() }, stops);
    camera.aperture_radius_mm = (1e4 * camera.aperture_radius_mm).round() / 1e4;
    let estimate = reached.mixed(best.known.reached, KNOWN_SHARE);
    Choice { kind, stops, focus_psi, estimate, known: best.known.reached, camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn advice(range: f64, electrons: f64) -> Advice {
        let camera = Camera { psi_range: [0.0, range], ..Camera::resolve("ring-outer").unwrap() };
        let light = Light { electrons, read_noise_e: 2.5, mean: Light::MEAN };
        advise(&camera, light, &Statistics::natural()).unwrap()
    }

    #[test]
    fn a_narrow_range_in_little_light_needs_no_mask() {
        let advice = advice(8.0, 1000.0);
        assert_eq!((advice.advised.kind, advice.advised.stops), (Kind::Clear, 0.0));
        assert!((advice.advised.focus_psi - 4.0).abs() < 1e-9);
        let kinds: Vec<Kind> = advice.others.iter().map(|c| c.kind).collect();
        assert!(kinds.contains(&Kind::Own) && kinds.iter().any(|kind| matches!(kind, Kind::Cubic(_))));
        assert!(advice.others.iter().all(|other| advice.cost(other).score() > -RANKING_ERROR_DB));
        let gain = advice.any_mask_gains();
        assert!(gain.average_db > 0.5 && gain.average_db < 1.0, "{gain:?}");
    }

    #[test]
    fn a_clear_lens_is_ahead_of_a_mask_as_the_whole_advice_says_and_of_none_that_is_advised() {
        let light = Light { electrons: 2500.0, read_noise_e: 2.5, mean: Light::MEAN };
        let natural = Statistics::natural();
        let ring = Camera::resolve("ring-outer").unwrap();
        let (better, by) = better_clear(&ring, light, &natural).unwrap().unwrap();
        let advice = advise(&ring, light, &natural).unwrap();
        assert_eq!(better, advice.advised);
        let own = advice.others.iter().find(|other| other.kind == Kind::Own).unwrap();
        assert_eq!((own.stops, by), (0.0, advice.cost(own)));
        let open = Light { electrons: 1000.0, ..light };
        assert_eq!(better_clear(&Camera::resolve("clear-mid").unwrap(), open, &natural), Ok(None));
    }

    #[test]
    fn more_light_over_more_depth_closes_the_lens() {
        let [little, much] = [1000.0, 10_000.0].map(|electrons| advice(8.0, electrons).advised);
        assert!(much.stops > little.stops, "{} {}", much.stops, little.stops);
        // The camera that is written: closed and focused.
        let ratio = much.camera.aperture_radius_mm / little.camera.aperture_radius_mm;
        assert!((ratio - (-0.5 * (much.stops - little.stops)).exp2()).abs() < 1e-3);
        assert!((much.camera.focus_psi - much.focus_psi * (-much.stops).exp2()).abs() < 1e-9);
    }

    #[test]
    fn a_range_wider_than_any_blur_is_rejected_in_words() {
        let camera = Camera { psi_range: [0.0, 5000.0], ..Camera::resolve("clear").unwrap() };
        let light = Light { electrons: 1e4, read_noise_e: 2.5, mean: Light::MEAN };
        let error = advise(&camera, light, &Statistics::natural()).unwrap_err().to_string();
        assert!(error.starts_with("range of psi 5000: wider than 48 at every stop"), "{error}");
    }
}
