//! Finding a mask and a focus: differential evolution over one ring or two, judged by the linear [`estimator`](crate::estimator).
//!
//! The first population is random within the bounds; no preset is among it.

use crate::estimator::{JudgeError, Task, Verdict, judge};
use crate::psf::MAX_DEFOCUS;
use crate::statistics::Statistics;
use edof_core::camera::Camera;
use edof_core::camera::{Delay, Ring, Sign};
use edof_core::geometry::Window;
use edof_core::words::{number, numbers};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// What to search for, and how long.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Rings of the mask, 0, 1 or 2; without any only the focus is searched.
    pub rings: usize,
    /// ψ at which the lens must be focused; none to search for that too.
    pub focus: Option<f64>,
    /// Largest phase of a ring, either way, in radians at the reference wavelength.
    pub max_phase: f64,
    /// Cameras in a generation.
    pub population: usize,
    /// Generations after the first.
    pub generations: usize,
    /// Same seed, same camera.
    pub seed: u64,
}

impl Default for Search {
    fn default() -> Self {
        Self { rings: 1, focus: None, max_phase: 10.0, population: 32, generations: 64, seed: 0 }
    }
}

/// The task that `edof optics design` sets by default: nine depths over the camera's range, without noise and with σ = 0.01, the
/// worst depth counting as much as the average, a window of 12.
#[must_use]
pub fn default_task(camera: &Camera) -> Task {
    let [low, high] = camera.psi_range;
    let window = Window::new(12).unwrap_or_else(|_| unreachable!("12 is a window"));
    Task {
        psis: (0..9).map(|i| low + (high - low) * f64::from(i) / 8.0).collect(),
        noises: vec![0.0, 0.01],
        window,
        worst_weight: 0.5,
    }
}

/// A camera that was found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Lens and sensor of the given camera, mask and focus of our own.
    pub camera: Camera,
    /// What the estimator reaches behind it.
    pub verdict: Verdict,
    /// Cameras judged in flight.
    pub judged: usize,
}

/// A search that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum DesignError {
    /// More rings than a mask of ours has, too few cameras, …
    #[error("design: {field} is {value}, expected {expected}")]
    Value { field: &'static str, value: String, expected: &'static str },
    /// A base that cannot be judged, or statistics that are none.
    #[error(transparent)]
    Judge(#[from] JudgeError),
}

/// Narrowest ring that is searched, as a share of the radius.
const NARROWEST: f64 = 0.02;

/// Searches for the mask and focus that serve `task` best with the lens and sensor of `base`; its own rings and focus are not
/// looked at. `tell(generation, best score in dB)` is called after each generation and may end the search, whose best is then returned.
///
/// # Errors
/// [`DesignError`].
pub fn search(
    base: &Camera,
    statistics: &Statistics,
    task: &Task,
    search: &Search,
    mut tell: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Result<Found, DesignError> {
    check(base, task, search)?;
    let score = |genes: &Vec<f64>| judge(&camera(base, search, genes), statistics, task).map(|v| v.score_db);
    let bounds = bounds(base, search);
    let mut generator = Pcg64::seed_from_u64(search.seed);
    let mut population: Vec<Vec<f64>> = (0..search.population)
        .map(|_| bounds.iter().map(|[low, high]| low + (high - low) * generator.random::<f64>()).collect())
        .collect();
    let mut scores = population.par_iter().map(score).collect::<Result<Vec<f64>, _>>()?;
    let mut judged = population.len();
    for generation in 0..search.generations {
        let best = best_of(&scores);
        if tell(generation, scores[best]).is_break() || bounds.is_empty() {
            break;
        }
        let trials: Vec<Vec<f64>> =
            (0..population.len()).map(|i| trial(&population, i, best, &bounds, &mut generator)).collect();
        let trial_scores = trials.par_iter().map(score).collect::<Result<Vec<f64>, _>>()?;
        judged += trials.len();
        for (i, (trial, trial_score)) in trials.into_iter().zip(trial_scores).enumerate() {
            if trial_score >= scores[i] {
                (population[i], scores[i]) = (trial, trial_score);
            }
        }
    }
    let best = best_of(&scores);
    let _ = tell(search.generations, scores[best]);
    let camera = camera(base, search, &population[best]);
    Ok(Found { verdict: judge(&camera, statistics, task)?, camera, judged })
}

/// Most cameras of a generation.
const MAX_CAMERAS: usize = 10_000;
/// Most generations of a search.
const MAX_GENERATIONS: usize = 100_000;

fn check(base: &Camera, task: &Task, search: &Search) -> Result<(), DesignError> {
    let refuse = |field, value: String, expected| Err(DesignError::Value { field, value, expected });
    if search.rings > 2 {
        return refuse("rings", search.rings.to_string(), "0, 1 or 2");
    }
    if !(4..=MAX_CAMERAS).contains(&search.population) {
        return refuse("population", search.population.to_string(), "4 to 10000 cameras");
    }
    if !(1..=MAX_GENERATIONS).contains(&search.generations) {
        return refuse("generations", search.generations.to_string(), "1 to 100000");
    }
    let mut foci = base.psi_range.into_iter().chain(search.focus);
    if foci.any(|focus| !task.psis.iter().all(|psi| (psi - focus).abs() <= MAX_DEFOCUS)) {
        let [low, high] = base.psi_range.map(number);
        let focus = search.focus.map_or(String::new(), |focus| format!(", focus {}", number(focus)));
        let found = format!("{low} to {high}{focus}");
        return refuse("psi", found, "depths within 200 of each other and of the focus");
    }
    if !(search.max_phase.is_finite() && search.max_phase > 0.0) {
        return refuse("largest phase", number(search.max_phase), "a positive number of radians");
    }
    if task.psis.is_empty() || task.psis.iter().any(|p| !p.is_finite()) {
        return refuse("psi", numbers(&task.psis), "one finite number at least");
    }
    if task.noises.is_empty() || task.noises.iter().any(|n| !(n.is_finite() && *n >= 0.0)) {
        return refuse("noise", numbers(&task.noises), "one number of 0 or more at least");
    }
    if !(0.0..=1.0).contains(&task.worst_weight) {
        return refuse("weight of the worst depth", number(task.worst_weight), "0 to 1");
    }
    Ok(())
}

/// Radii of all rings, then their phases, then the focus unless it is given.
fn bounds(base: &Camera, search: &Search) -> Vec<[f64; 2]> {
    let phase = [-search.max_phase, search.max_phase];
    let radii = std::iter::repeat_n([0.0, 1.0], 2 * search.rings);
    let phases = std::iter::repeat_n(phase, search.rings);
    radii.chain(phases).chain(search.focus.is_none().then_some(base.psi_range)).collect()
}

/// The camera that genes describe. Radii are sorted, so that any are good.
fn camera(base: &Camera, search: &Search, genes: &[f64]) -> Camera {
    let (radii, rest) = genes.split_at(2 * search.rings);
    let (phases, focus) = rest.split_at(search.rings);
    let mut radii = radii.to_vec();
    radii.sort_by(f64::total_cmp);
    let ring = |(radii, &rad): (&[f64], &f64)| {
        let inner = radii[0].min(1.0 - NARROWEST);
        let outer = radii[1].max(inner + NARROWEST);
        Ring { inner, outer, delay: Delay::Phase { rad, at_nm: base.reference_wavelength_nm } }
    };
    Camera {
        mask: radii.chunks(2).zip(phases).map(ring).collect(),
        focus_psi: focus.first().copied().or(search.focus).unwrap_or(base.focus_psi),
        defocus_sign: Sign::Plus,
        ..base.clone()
    }
}

fn best_of(scores: &[f64]) -> usize {
    (0..scores.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or(0)
}

/// A child of one camera: part of the way to the best one, and of the way between two others (current-to-best/1, binomial).
fn trial(
    population: &[Vec<f64>],
    index: usize,
    best: usize,
    bounds: &[[f64; 2]],
    generator: &mut Pcg64,
) -> Vec<f64> {
    let parent = &population[index];
    let mut other = || &population[generator.random_range(0..population.len())];
    let (a, b) = (other(), other());
    let pull = 0.3 + 0.4 * generator.random::<f64>();
    let step = 0.4 + 0.5 * generator.random::<f64>();
    let always = generator.random_range(0..bounds.len().max(1));
    (0..parent.len())
        .map(|gene| {
            if gene != always && generator.random::<f64>() > 0.9 {
                return parent[gene];
            }
            let moved =
                parent[gene] + pull * (population[best][gene] - parent[gene]) + step * (a[gene] - b[gene]);
            let [low, high] = bounds[gene];
            // A step across a bound ends half-way to it.
            if moved < low {
                0.5 * (parent[gene] + low)
            } else if moved > high {
                0.5 * (parent[gene] + high)
            } else {
                moved
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small_task() -> Task {
        let window = Window::new(8).unwrap();
        Task { psis: vec![0.0, 2.0, 4.0, 6.0, 8.0], noises: vec![0.0, 0.01], window, worst_weight: 0.5 }
    }

    #[test]
    fn a_clear_lens_is_best_focused_inside_its_range() {
        let base = Camera::resolve("clear").unwrap();
        let wanted = Search { rings: 0, population: 6, generations: 6, ..Search::default() };
        let found =
            search(&base, &Statistics::natural(), &small_task(), &wanted, |_, _| ControlFlow::Continue(()))
                .unwrap();
        assert!((3.0..5.5).contains(&found.camera.focus_psi), "{}", found.camera.focus_psi);
    }

    #[test]
    fn a_small_search_beats_the_clear_lens_and_repeats_itself() {
        let base = Camera::resolve("clear-mid").unwrap();
        let statistics = Statistics::natural();
        let wanted = Search { population: 12, generations: 8, ..Search::default() };
        let mut best = vec![];
        let found = search(&base, &statistics, &small_task(), &wanted, |_, db| {
            best.push(db);
            ControlFlow::Continue(())
        })
        .unwrap();
        assert!(best.is_sorted(), "the best never gets worse: {best:?}");
        let clear = judge(&base, &statistics, &small_task()).unwrap();
        assert!(found.verdict.score_db > clear.score_db, "{} {}", found.verdict.score_db, clear.score_db);
        found.camera.check().unwrap();
        let short = Search { population: 6, generations: 2, ..Search::default() };
        let [one, again] = [(); 2].map(|()| {
            search(&base, &statistics, &small_task(), &short, |_, _| ControlFlow::Continue(()))
                .unwrap()
                .camera
        });
        assert_eq!(one, again);
    }

    #[test]
    fn impossible_searches_are_rejected() {
        let base = Camera::resolve("clear").unwrap();
        let wanted = Search { rings: 3, ..Search::default() };
        let error =
            search(&base, &Statistics::natural(), &small_task(), &wanted, |_, _| ControlFlow::Continue(()))
                .unwrap_err();
        assert_eq!(error.to_string(), "design: rings is 3, expected 0, 1 or 2");
    }
}
