//! What a lens reaches over a range of depths at each stop and focus, and the best of them.

use super::lenses::closed;
use super::transfer::{Sampling, Transfer, transfers};
use super::wiener::{Bayer, Planes, View, spectra};
use super::{Light, Reached, depths};
use crate::statistics::Statistics;
use edof_core::camera::{Camera, Symmetry};
use edof_core::words::number;
use ndarray::Array2;

/// Widest range of ψ, at the aperture in use, whose blur the torus has room for.
pub const WIDEST: f64 = 48.0;
/// Foci that are tried, as halves of the distance between two depths from the middle of the range.
const FOCI: std::ops::RangeInclusive<i32> = -1..=3;

/// A stop and a focus, and what a lens reaches with them.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Setting {
    /// Stops by which the lens is closed.
    pub stops: f64,
    /// Focus as ψ of the open aperture.
    pub focus_psi: f64,
    /// What is reached.
    #[serde(flatten)]
    pub reached: Reached,
}

/// A lens at its best in one light: stop and focus are chosen for each estimate by itself.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Best {
    /// By one estimate for all depths.
    pub blind: Setting,
    /// By one that knows the depth.
    pub known: Setting,
    /// The best average by one that knows the depth, and the best worst depth, at stops of their own.
    pub known_peaks: Reached,
    /// The same from three full planes of colour.
    pub planes_peaks: Reached,
}

/// A lens that cannot be judged on the torus.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum BoundError {
    /// PSFs that stand for themselves.
    #[error("camera {0}: has a PSF bank, which has no other stop or focus; give a camera without one")]
    Bank(String),
    /// Nothing left to choose from.
    #[error("range of psi {}: wider than {} at every stop that is tried; close the aperture, or narrow the range", number(*.0), number(WIDEST))]
    Range(f64),
}

/// Returns those stops that leave a range the torus has room for.
///
/// # Errors
/// [`BoundError`]: none, or a camera with a PSF bank.
pub fn possible(camera: &Camera, stops: &[f64]) -> Result<Vec<f64>, BoundError> {
    if camera.psf_bank.is_some() {
        return Err(BoundError::Bank(camera.name.clone()));
    }
    let width = camera.psi_range[1] - camera.psi_range[0];
    let possible: Vec<f64> =
        stops.iter().copied().filter(|stops| width * (-stops).exp2() <= WIDEST).collect();
    if possible.is_empty() { Err(BoundError::Range(width)) } else { Ok(possible) }
}

/// Whether the best focus is the middle of the range: PSFs are the same at either side of it, because the phase is odd or there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// A clear lens, or an odd mask.
    Alike,
    /// Any other.
    Differ,
}

/// A judge of lenses with one range, one world and some lights.
pub struct Judge<'a> {
    /// Lights, the same for every lens.
    pub lights: &'a [Light],
    /// Stops that are tried.
    pub stops: &'a [f64],
    /// Fineness of pupils.
    pub sampling: Sampling,
    spectra: [Array2<f64>; 6],
}

impl<'a> Judge<'a> {
    /// A judge; `stops` are [`possible`].
    #[must_use]
    pub fn new(lights: &'a [Light], stops: &'a [f64], sampling: Sampling, statistics: &Statistics) -> Self {
        Self { lights, stops, sampling, spectra: spectra(statistics) }
    }

    /// Returns what a camera reaches in each light, at its best stop and focus.
    #[must_use]
    pub fn best(&self, camera: &Camera, sides: Sides) -> Vec<Best> {
        let mut best: Vec<Option<Best>> = vec![None; self.lights.len()];
        for &stops in self.stops {
            let psis: Vec<f64> = depths(camera.psi_range).iter().map(|psi| psi * (-stops).exp2()).collect();
            for (focus_psi, transfers) in self.foci(&closed(camera, stops), &psis, sides) {
                let round = camera.symmetry() == Symmetry::Round;
                let bayer = View::new::<Bayer>(&self.spectra, &transfers, round);
                let planes = View::new::<Planes>(&self.spectra, &transfers, round);
                for (best, light) in best.iter_mut().zip(self.lights) {
                    let noise = light.variance(stops);
                    let errors = bayer.errors(noise);
                    let setting = |errors: &[f64]| Setting {
                        stops,
                        focus_psi: focus_psi * stops.exp2(),
                        reached: Reached::of_errors(errors),
                    };
                    let (blind, known) = (setting(&errors.blind), setting(&errors.known));
                    let planes_peaks = Reached::of_errors(&planes.errors(noise).known);
                    let found = Best { blind, known, known_peaks: known.reached, planes_peaks };
                    *best = Some(best.map_or(found, |best| best.or(found)));
                }
            }
        }
        best.into_iter().flatten().collect()
    }

    /// Foci to be tried, as ψ of the aperture in use, with the transfers at every depth. Transfers depend on the distance from focus alone, so they
    /// are computed once for all foci.
    fn foci(&self, camera: &Camera, psis: &[f64], sides: Sides) -> Vec<(f64, Vec<Transfer>)> {
        let middle = 0.5 * (camera.psi_range[0] + camera.psi_range[1]);
        let focused = |focus_psi: f64| Camera { focus_psi, ..camera.clone() };
        if sides == Sides::Alike {
            let near = transfers(&focused(middle), &psis[..=psis.len() / 2], self.sampling);
            let far = near.iter().rev().skip(1).cloned().collect::<Vec<_>>();
            return vec![(middle, near.into_iter().chain(far).collect())];
        }
        // Half of the distance between two depths is a step of the focus.
        let step = (psis[1] - psis[0]) / 2.0;
        let (first, last) = (-*FOCI.end(), 2 * (psis.len() as i32 - 1) - *FOCI.start());
        let from_focus: Vec<f64> = (first..=last).map(|i| psis[0] + f64::from(i) * step).collect();
        let all = transfers(&focused(middle), &from_focus, self.sampling);
        FOCI.map(|moved| {
            let of = |depth: usize| all[(2 * depth as i32 - moved - first) as usize].clone();
            (middle + f64::from(moved) * step, (0..psis.len()).map(of).collect())
        })
        .collect()
    }
}

impl Best {
    fn or(self, other: Self) -> Self {
        let better = |a: Setting, b: Setting| if b.reached.score() > a.reached.score() { b } else { a };
        let peaks = |a: Reached, b: Reached| Reached {
            average_db: a.average_db.max(b.average_db),
            worst_db: a.worst_db.max(b.worst_db),
        };
        Self {
            blind: better(self.blind, other.blind),
            known: better(self.known, other.known),
            known_peaks: peaks(self.known_peaks, other.known_peaks),
            planes_peaks: peaks(self.planes_peaks, other.planes_peaks),
        }
    }
}
