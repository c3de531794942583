//! Quantization-aware fine-tuning: weights go on being trained while the network computes with the words that the board will
//! hold. Below 12 bits this wins back most of what rounding costs. Formats stay as the quantizer chose them.

use super::fold::{self, Folded};
use super::simulated::{Formats, Places, Simulated, rgb_map};
use super::{QuantizeError, formats};
use crate::adam::Adam;
use crate::patches::{Bank, Batch, Random};
use edof_spec::FixedNetwork;
use edof_spec::colour::RGB_OUTPUTS;
use rayon::prelude::*;

/// Parts of a batch that are computed side by side and added in order: the result does not depend on the threads.
const PARTS: usize = 4;
/// Validation windows of each photo and ψ.
const VALIDATION_WINDOWS: usize = 64;
/// Steps between validations.
const VALIDATE_EVERY: u64 = 100;
/// How much of a cell's running error one window replaces.
const CELL_RATE: f32 = 0.02;

/// How to fine-tune.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinetuneOptions {
    /// Steps of Adam.
    pub steps: u64,
    /// Windows a step.
    pub batch: usize,
    /// Largest move of a weight in one step, in units of its last bit.
    pub rate: f32,
    /// Seed of the windows drawn.
    pub seed: u64,
}

impl Default for FinetuneOptions {
    fn default() -> Self {
        Self { steps: 2000, batch: 512, rate: 0.05, seed: 1 }
    }
}

/// What is told at each validation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinetuneProgress {
    /// Steps taken.
    pub step: u64,
    /// PSNR in dB on validation windows, mean over photos, ψ and noise.
    pub validation_db: f64,
    /// The best of these so far; its weights are what comes out.
    pub best_db: f64,
}

/// Fine-tunes the weights and thresholds of `fixed` on the bank's windows. `tell`
/// hears every validation, the first before any step, and stops the work by returning false. The best validated weights come
/// out, so the result is never worse than the start on the validation windows.
///
/// # Errors
/// [`QuantizeError::Fixed`] if the tuned weights could overflow an accumulator.
pub fn finetune(
    fixed: &FixedNetwork,
    bank: &Bank,
    tuning: &FinetuneOptions,
    mut tell: impl FnMut(&FinetuneProgress) -> bool,
) -> Result<FixedNetwork, QuantizeError> {
    let mut tuner = Tuner::new(fixed, bank, tuning);
    let mut best = (tuner.validate(), tuner.weights.clone());
    let mut go_on = tell(&FinetuneProgress { step: 0, validation_db: best.0, best_db: best.0 });
    for step in 1..=tuning.steps {
        if !go_on {
            break;
        }
        tuner.step(step);
        if step.is_multiple_of(VALIDATE_EVERY) || step == tuning.steps {
            let db = tuner.validate();
            if db > best.0 {
                best = (db, tuner.weights.clone());
            }
            go_on = tell(&FinetuneProgress { step, validation_db: db, best_db: best.0 });
        }
    }
    let tuned = tuner.places.unflatten(&fixed.form, &best.1);
    formats::rounded_to(&tuned, fixed)
}

struct Tuner<'a> {
    bank: &'a Bank,
    tuning: &'a FinetuneOptions,
    noise: f32,
    places: Places,
    formats: Formats,
    weights: Vec<f32>,
    steps: Vec<f32>,
    adam: Adam,
    cell_errors: Vec<f32>,
    parts: Vec<Part>,
    validation: Vec<Batch>,
}

struct Part {
    pass: Simulated,
    batch: Batch,
    importance: Vec<f32>,
    errors: Vec<f32>,
    gradient: Vec<f32>,
}

impl<'a> Tuner<'a> {
    fn new(fixed: &FixedNetwork, bank: &'a Bank, tuning: &'a FinetuneOptions) -> Self {
        let form = fixed.form;
        let places = Places::new(&form);
        let formats = Formats::of(fixed, &places);
        let weights = Places::flatten(&Folded::of(fixed));
        let to_rgb = rgb_map(&fold::output_weights(fixed.stride, fixed.overlap));
        let share = tuning.batch.div_ceil(PARTS);
        let part = |_| Part {
            pass: Simulated::new(form, &formats.codes, &to_rgb, share.max(VALIDATION_WINDOWS)),
            batch: Batch::new(form.window, share),
            importance: vec![0.0; share],
            errors: vec![0.0; share],
            gradient: vec![0.0; weights.len()],
        };
        let noise = fixed.origin.noise as f32;
        Self {
            bank,
            tuning,
            noise,
            steps: formats.steps(weights.len()),
            adam: Adam::new(weights.len()),
            cell_errors: vec![0.0; bank.cells()],
            parts: (0..PARTS).map(part).collect(),
            validation: validation(bank, noise),
            weights,
            formats,
            places,
        }
    }

    /// One batch and one step of Adam; the rate falls along a cosine.
    fn step(&mut self, step: u64) {
        let rounded = self.formats.rounded(&self.weights);
        let (bank, noise, seed, cells) = (self.bank, self.noise, self.tuning.seed, &self.cell_errors);
        self.parts.par_iter_mut().enumerate().for_each(|(index, part)| {
            let mut random = Random::new(seed, step, index as u64);
            bank.draw(&mut random, noise, 8, &mut part.batch);
            for (importance, &cell) in part.importance.iter_mut().zip(&part.batch.cells) {
                // A cell not seen yet counts as much as an error of 30 dB.
                let error = cells[cell as usize];
                *importance = 1.0 / if error > 0.0 { error } else { RGB_OUTPUTS as f32 * 1e-3 };
            }
            part.gradient.fill(0.0);
            let Batch { inputs, targets, .. } = &part.batch;
            part.pass.gradient(
                &rounded,
                inputs,
                targets,
                &part.importance,
                &mut part.errors,
                &mut part.gradient,
            );
        });
        let (first, others) = self.parts.split_at_mut(1);
        let gradient = &mut first[0].gradient;
        for other in &*others {
            gradient.iter_mut().zip(&other.gradient).for_each(|(sum, g)| *sum += g);
        }
        let progress = step as f32 / self.tuning.steps.max(1) as f32;
        let rate = self.tuning.rate * 0.5 * (1.0 + (std::f32::consts::PI * progress).cos());
        self.adam.step(&mut self.weights, gradient, rate, &self.steps);
        for part in &self.parts {
            for (&cell, &error) in part.batch.cells.iter().zip(&part.errors) {
                let mean = &mut self.cell_errors[cell as usize];
                *mean = if *mean == 0.0 { error } else { *mean + CELL_RATE * (error - *mean) };
            }
        }
    }

    /// Mean PSNR in dB over the validation sets.
    fn validate(&mut self) -> f64 {
        let rounded = self.formats.rounded(&self.weights);
        let parts = self.validation.len().div_ceil(PARTS);
        let sums: Vec<f64> = self
            .parts
            .par_iter_mut()
            .zip(self.validation.par_chunks(parts))
            .map(|(part, sets)| {
                let db = |set: &Batch| {
                    let rgb = part.pass.forward(&rounded, &set.inputs, VALIDATION_WINDOWS);
                    let squares: f64 =
                        rgb.iter().zip(&set.targets).map(|(a, b)| f64::from(a - b).powi(2)).sum();
                    -10.0 * (squares / set.targets.len() as f64).log10()
                };
                sets.iter().map(db).sum()
            })
            .collect();
        sums.iter().sum::<f64>() / self.validation.len() as f64
    }
}

/// One set for each photo, ψ, and noise of none and two thirds of the most.
fn validation(bank: &Bank, noise: f32) -> Vec<Batch> {
    let cells = (0..bank.photos()).flat_map(|photo| (0..bank.psis().len()).map(move |psi| (photo, psi)));
    cells
        .flat_map(|(photo, psi)| [0.0, noise * 2.0 / 3.0].map(|sigma| (photo, psi, sigma)))
        .enumerate()
        .map(|(index, (photo, psi, sigma))| {
            let mut batch = Batch::new(bank.window(), VALIDATION_WINDOWS);
            // Validation windows have a stream that no training step has.
            let mut random = Random::new(0, u64::MAX, index as u64);
            bank.draw_validation(&mut random, photo, psi, sigma, &mut batch);
            batch
        })
        .collect()
}
