//! Validation: the same windows for every run, cut from the blocks that training keeps away from ([`crate::holdout`]).
//!
//! There is a set of windows for each photograph, tone, a handful of ψ, and each noise of [`Conditions::validated`].
//! The number that chooses a checkpoint is [`Validation::db`]: the mean PSNR over all sets.

use crate::dataset::{Batch, Dataset, Place};
use crate::noise::Conditions;
use edof_core::Noise;
use edof_network::float::pass::Pass;
use edof_network::network::Form;
use edof_numerics::mean;
use edof_numerics::random::Random;
use rayon::prelude::*;

/// Windows of each set.
const WINDOWS: usize = 256;
/// ψ values, spread over the dataset's.
const PSIS: usize = 5;
/// Seed of the windows: not the recipe's, so that every run is judged by the same.
const SEED: u64 = 0x5EED;

/// All sets.
#[derive(Debug)]
pub struct ValidationSets(Vec<Set>);

#[derive(Debug)]
struct Set {
    place: Place,
    noise: Noise,
    batch: Batch,
}

/// What one set measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Photograph and ψ.
    pub place: Place,
    /// The noise of its windows.
    pub noise: Noise,
    /// PSNR in dB over all windows of the set.
    pub psnr_db: f64,
    /// Mean non-zeros of each shrinkage.
    pub non_zeros: Vec<f64>,
}

/// What all sets measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation(pub Vec<Measured>);

impl ValidationSets {
    /// The sets of a dataset, with the noise of the comparisons that is within the range that is trained on.
    #[must_use]
    pub fn new(dataset: &Dataset, conditions: &Conditions) -> Self {
        let mut places = Vec::new();
        for photo in 0..dataset.photos() {
            places.extend(spread(dataset.psis().len()).into_iter().map(|psi| Place { photo, psi }));
        }
        let all = places.into_par_iter().enumerate().flat_map_iter(|(index, place)| {
            let levels = conditions.validated(dataset.tone());
            levels.into_iter().enumerate().map(move |(level, noise)| {
                let mut batch = Batch::new(dataset.inputs(), WINDOWS);
                let mut random = Random::new(SEED, index as u64, level as u64);
                dataset.draw_validation(&mut random, place, noise, &mut batch);
                Set { place, noise, batch }
            })
        });
        Self(all.collect())
    }

    /// Runs a network over all sets.
    #[must_use]
    pub fn measure(&self, form: Form, weights: &[f32]) -> Validation {
        let measure = |pass: &mut Pass, set: &Set| set.measure(pass, form, weights);
        Validation(self.0.par_iter().map_init(|| Pass::new(form, WINDOWS), measure).collect())
    }
}

impl Set {
    fn measure(&self, pass: &mut Pass, form: Form, weights: &[f32]) -> Measured {
        let outputs = pass.forward(weights, &self.batch.inputs, WINDOWS);
        let psnr_db = psnr_db(outputs, &self.batch);
        let count = |t: usize| pass.z(t)[..WINDOWS * form.codes].iter().filter(|z| **z != 0.0).count();
        Measured {
            place: self.place,
            noise: self.noise,
            psnr_db,
            non_zeros: (0..form.shrinkages()).map(|t| count(t) as f64 / WINDOWS as f64).collect(),
        }
    }
}

/// PSNR in dB over all outputs of a batch, cut to 0…1.
#[must_use]
pub fn psnr_db(outputs: &[f32], batch: &Batch) -> f64 {
    let errors = outputs.iter().zip(&batch.targets).map(|(o, x)| o.clamp(0.0, 1.0) - x);
    let squares: f64 = errors.map(|e| f64::from(e * e)).sum();
    -10.0 * (squares / outputs.len() as f64).max(1e-12).log10()
}

impl Measured {
    /// Whether its windows have noise.
    #[must_use]
    pub fn is_noisy(&self) -> bool {
        self.noise != Noise::None
    }
}

impl Validation {
    /// The number that chooses a checkpoint: the mean PSNR in dB over all photographs, ψ, without and with noise.
    #[must_use]
    pub fn db(&self) -> f64 {
        self.mean(|_| true).unwrap_or(f64::NEG_INFINITY)
    }

    /// Mean PSNR in dB over the sets that `chosen` names; none where there are none.
    #[must_use]
    pub fn mean(&self, chosen: impl Fn(&Measured) -> bool) -> Option<f64> {
        mean(self.0.iter().filter(|m| chosen(m)).map(|m| m.psnr_db))
    }

    /// The ψ and noise at which the mean over photographs is least, and that mean.
    #[must_use]
    pub fn worst(&self) -> Option<(&Measured, f64)> {
        let alike = |a: &Measured, b: &Measured| (a.place.psi, a.noise) == (b.place.psi, b.noise);
        let first = self.0.iter().filter(|m| m.place.photo == 0);
        first.filter_map(|m| Some((m, self.mean(|o| alike(m, o))?))).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Mean non-zeros of each shrinkage over the sets without noise, or with it.
    #[must_use]
    pub fn non_zeros(&self, noisy: bool) -> Vec<f64> {
        let sets: Vec<&Measured> = self.0.iter().filter(|m| m.is_noisy() == noisy).collect();
        let layers = sets.first().map_or(0, |m| m.non_zeros.len());
        (0..layers).filter_map(|t| mean(sets.iter().map(|m| m.non_zeros[t]))).collect()
    }

    /// Mean non-zeros of each shrinkage over the busiest quarter of the sets with noise, its own quarter for each shrinkage: what a
    /// board needs room for that is to keep its rate on busy photographs too.
    #[must_use]
    pub fn busy_non_zeros(&self) -> Vec<f64> {
        let layers = self.0.first().map_or(0, |m| m.non_zeros.len());
        let busy = |t: usize| {
            let noisy = self.0.iter().filter(|m| m.is_noisy());
            let mut counts: Vec<f64> = noisy.map(|m| m.non_zeros[t]).collect();
            counts.sort_by(|a, b| b.total_cmp(a));
            counts.truncate(counts.len().div_ceil(4));
            mean(counts)
        };
        (0..layers).filter_map(busy).collect()
    }
}

/// Positions of the ψ that are validated.
fn spread(psis: usize) -> Vec<usize> {
    if psis <= PSIS { (0..psis).collect() } else { (0..PSIS).map(|i| i * (psis - 1) / (PSIS - 1)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(photo: usize, psi: usize, noisy: bool, psnr_db: f64) -> Measured {
        let noise = if noisy { Noise::gaussian(0.01) } else { Noise::None };
        Measured { place: Place { photo, psi }, noise, psnr_db, non_zeros: vec![psnr_db, 1.0] }
    }

    #[test]
    fn the_worst_is_the_worst_mean_over_photographs_not_the_worst_photograph() {
        let all = Validation(vec![
            measured(0, 0, false, 30.0),
            measured(1, 0, false, 20.0),
            measured(0, 0, true, 24.0),
            measured(1, 0, true, 24.0),
        ]);
        assert!((all.db() - 24.5).abs() < 1e-9);
        let (worst, db) = all.worst().unwrap();
        assert!(worst.is_noisy() && (db - 24.0).abs() < 1e-9);
        assert_eq!(all.non_zeros(false), [25.0, 1.0]);
        assert_eq!(all.busy_non_zeros(), [24.0, 1.0]);
        assert_eq!(all.mean(|m| m.place.photo == 1), Some(22.0));
        assert_eq!(all.mean(|m| m.place.photo == 2), None);
    }

    #[test]
    fn psi_is_spread_from_end_to_end() {
        assert_eq!(spread(9), [0, 2, 4, 6, 8]);
        assert_eq!(spread(17), [0, 4, 8, 12, 16]);
        assert_eq!(spread(3), [0, 1, 2]);
    }
}
