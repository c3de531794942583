//! Why not close the aperture? A coded lens against its own clear lens at smaller apertures: same scene, same light, same exposure time,
//! same sensor.
//!
//! Closing a lens by `s` stops divides its area by 2^s: each pixel gets 2^s times fewer electrons, and ψ of every depth is 2^s times smaller
//! (ψ is proportional to the square of the aperture radius). Both lenses are focused where they are best for the range of depths and the
//! light. They are compared by the closed-form linear estimator ([`edof_optics::estimator`]), which needs no training: the estimator sees
//! one noise level for each light, that of a pixel of mean light.

mod cameras;
pub mod networks;
mod page;

pub use page::{Aperture, Comparison, Reached};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use edof_core::camera::Camera;
use edof_core::geometry::Window;
use edof_core::noise::{Noise, SensorNoise};
use edof_core::storage::digest::sha256;
use edof_optics::Statistics;
use edof_optics::estimator::{JudgeError, Task, Verdict, judge};
use serde::{Deserialize, Serialize};

/// Depths at which a range of ψ is sampled.
const DEPTHS: usize = 9;
/// Focus settings that are tried over a range of ψ.
const FOCUS_STEPS: usize = 13;

/// What is compared.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The coded lens. The clear one is the same without rings.
    pub coded: Camera,
    /// Far ends of the ranges of ψ, which begin at 0. ψ is that of the open aperture.
    pub ranges: Vec<f64>,
    /// Stops by which the clear lens is closed.
    pub stops: Vec<f64>,
    /// Light levels: electrons of a white pixel behind the open aperture.
    pub electrons: Vec<f64>,
    /// Read noise in electrons, standard deviation.
    pub read_noise_e: f64,
    /// Mean light of the scene, full scale 1.
    pub mean_light: f64,
    /// Raw pixels that the estimator sees.
    pub window: Window,
    /// Statistics of photographs.
    pub statistics: Statistics,
}

/// A lens of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lens {
    /// With the phase mask, at its full aperture.
    Coded,
    /// Without the mask.
    Clear,
}

impl Lens {
    /// Returns the lens of a coded camera.
    fn of(self, coded: &Camera) -> Camera {
        if self == Self::Coded { coded.clone() } else { coded.without_mask() }
    }
}

/// What the estimator reaches behind one lens at one aperture, range of depths and light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which lens.
    pub lens: Lens,
    /// Stops by which it is closed.
    pub stops: f64,
    /// F-number of the lens at that aperture.
    pub f_number: f64,
    /// Far end of the range of ψ, at the open aperture.
    pub range: f64,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// Standard deviation of the noise at mean light, full scale 1.
    pub sigma: f64,
    /// The best focus, in ψ of the open aperture.
    pub focus_psi: f64,
    /// PSNR in dB (peak 1), averaged over the range.
    pub average_db: f64,
    /// PSNR in dB at the worst depth of the range.
    pub worst_db: f64,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
pub type Subject = (Lens, Ordered, Ordered, Ordered);

impl Line for Row {
    const STUDY: &'static str = "aperture";
    const LAYOUT: u32 = 1;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        (self.lens, Ordered(self.stops), Ordered(self.range), Ordered(self.electrons))
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        self.clone()
    }
}

/// The experiment.
pub struct Comparing<'a> {
    plan: &'a Plan,
}

/// A row to be computed, by places in the plan's lists. Rows of one lens, aperture and range are computed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    lens: Lens,
    stops: usize,
    range: usize,
    light: usize,
}

impl<'a> Comparing<'a> {
    /// A plan's lenses and lights.
    #[must_use]
    pub const fn new(plan: &'a Plan) -> Self {
        Self { plan }
    }
}

impl Experiment for Comparing<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = JudgeError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let proof = plan.proof();
        let apertures = plan.stops.iter().enumerate().map(|(index, stops)| (Lens::Clear, index, *stops));
        let lenses: Vec<_> = std::iter::once((Lens::Coded, 0, 0.0)).chain(apertures).collect();
        let mut cells = vec![];
        for &(lens, stops, closed) in &lenses {
            for (range, far) in plan.ranges.iter().enumerate() {
                for (light, electrons) in plan.electrons.iter().enumerate() {
                    let subject = (lens, Ordered(closed), Ordered(*far), Ordered(*electrons));
                    cells.push((Key { subject, proof: proof.clone() }, Cell { lens, stops, range, light }));
                }
            }
        }
        cells
    }

    fn belongs_to(&self, before: &Cell, cell: &Cell) -> bool {
        (before.lens, before.stops, before.range) == (cell.lens, cell.stops, cell.range)
    }

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, JudgeError> {
        let plan = self.plan;
        let Cell { lens, stops, range, .. } = cells[0].0;
        let stops = if lens == Lens::Coded { 0.0 } else { plan.stops[stops] };
        let lights: Vec<f64> = cells.iter().map(|(cell, _)| plan.electrons[cell.light]).collect();
        let best = plan.best(lens, stops, plan.ranges[range], &lights)?;
        let f_number = plan.closed(lens, stops).f_number();
        let row = |((best, electrons), (_, proof)): ((Best, &f64), &(Cell, Proof))| Row {
            lens,
            stops,
            f_number,
            range: plan.ranges[range],
            electrons: *electrons,
            sigma: plan.sigma(*electrons, stops),
            focus_psi: best.focus_psi,
            average_db: best.average_db,
            worst_db: best.worst_db,
            proof: proof.clone(),
        };
        Ok(best.into_iter().zip(&lights).zip(cells).map(row).collect())
    }

    fn describe(&self, cell: &Cell) -> String {
        let range = self.plan.ranges[cell.range];
        match cell.lens {
            Lens::Coded => format!("coded lens, psi 0 to {range}"),
            Lens::Clear => format!("clear lens, {} stops, psi 0 to {range}", self.plan.stops[cell.stops]),
        }
    }
}

/// The best focus of a lens for one light, and what it reaches.
#[derive(Debug, Clone, Copy)]
struct Best {
    focus_psi: f64,
    average_db: f64,
    worst_db: f64,
}

impl Best {
    const fn score(self) -> f64 {
        score(self.average_db, self.worst_db)
    }
}

/// The figure by which focus and aperture are chosen, in dB: the average over depths and the worst depth have equal weight.
const fn score(average_db: f64, worst_db: f64) -> f64 {
    0.5 * (average_db + worst_db)
}

impl Plan {
    fn proof(&self) -> Proof {
        let numbers = (self.read_noise_e, self.mean_light, self.window.side(), DEPTHS, FOCUS_STEPS);
        Proof {
            settings: Some(settings(&[&numbers])),
            weights: None,
            photo: sha256(format!("{:?}", self.statistics.spectra).as_bytes()),
            camera: Some(sha256(self.coded.to_json().as_bytes())),
            ..Proof::default()
        }
    }

    /// A lens of the comparison, closed by some stops.
    fn closed(&self, lens: Lens, stops: f64) -> Camera {
        let aperture_radius_mm = self.coded.aperture_radius_mm * (-0.5 * stops).exp2();
        Camera { aperture_radius_mm, ..lens.of(&self.coded) }
    }

    /// Standard deviation of photon and read noise at mean light, full scale 1: the gain is raised until white fills the scale again.
    fn sigma(&self, electrons: f64, stops: f64) -> f64 {
        let full_well_e = electrons * (-stops).exp2();
        let sensor = SensorNoise { full_well_e, read_noise_e: self.read_noise_e, gain: 1.0 };
        Noise::Sensor(sensor).variance(self.mean_light).sqrt()
    }

    /// For each light the best focus of a lens over a range of depths.
    fn best(&self, lens: Lens, stops: f64, range: f64, lights: &[f64]) -> Result<Vec<Best>, JudgeError> {
        let mut best: Vec<Option<Best>> = vec![None; lights.len()];
        for focus_psi in along(range, FOCUS_STEPS) {
            let camera = self.focused(lens, stops, focus_psi);
            for (best, found) in best.iter_mut().zip(self.judged(&camera, stops, range, lights)?) {
                if best.is_none_or(|best| found.score() > best.score()) {
                    *best = Some(found);
                }
            }
        }
        Ok(best.into_iter().flatten().collect())
    }

    /// A lens of the comparison with a focus in ψ of the open aperture.
    fn focused(&self, lens: Lens, stops: f64, focus_psi: f64) -> Camera {
        Camera { focus_psi: focus_psi * (-stops).exp2(), ..self.closed(lens, stops) }
    }

    /// For each light what a lens, closed by some stops, reaches with its own focus over a range of depths.
    fn judged(
        &self,
        camera: &Camera,
        stops: f64,
        range: f64,
        lights: &[f64],
    ) -> Result<Vec<Best>, JudgeError> {
        let smaller = (-stops).exp2();
        let task = Task {
            psis: along(range, DEPTHS).map(|psi| psi * smaller).collect(),
            noises: lights.iter().map(|electrons| self.sigma(*electrons, stops)).collect(),
            window: self.window,
            worst_weight: 0.5,
        };
        let Verdict { psnr_db, .. } = judge(camera, &self.statistics, &task)?;
        let reached = |db: &Vec<f64>| Best {
            focus_psi: camera.focus_psi / smaller,
            average_db: db.iter().sum::<f64>() / db.len() as f64,
            worst_db: db.iter().copied().fold(f64::INFINITY, f64::min),
        };
        Ok(psnr_db.iter().map(reached).collect())
    }
}

/// Evenly spread from 0 to the end of a range of ψ, both included.
fn along(range: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| range * i as f64 / (count - 1) as f64)
}

#[cfg(test)]
mod tests;
