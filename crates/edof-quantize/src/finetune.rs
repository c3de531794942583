//! Quantization-aware fine-tuning: training of the weights continues while the network computes with the words that the board will
//! hold. Formats stay as the quantizer chose them.
//!
//! The weights that are trained are kept in floating point; each step rounds them as [`crate::rounding`] does and looks through
//! the rounding for the gradient. To nearest would not do: windows are so smooth that, with 8 bits, it costs 10 dB, and
//! steps that move single words undo what the quantizer's rounding had hidden. They are trained in the coordinates in which
//! what each matrix multiplies is white (see [`edof_train::precondition`]).
//!
//! A layer's rounding errors can only be learned by the layers behind it once they stand still. So the steps are shared out:
//! A settles first, then each S in turn, and in the last share only D and R move. Thresholds move throughout.

use crate::fold::{self, Folded};
use crate::simulated::{Simulated, code_formats, rgb_map};
use crate::{Calibration, formats, rounding::Rounding};
use edof_core::Noise;
use edof_core::colour::{OUTPUTS_422, RGB_OUTPUTS};
use edof_network::FixedNetwork;
use edof_network::float::parameters::Layout;
use edof_network::network::Form;
use edof_numerics::random::Random;
use edof_train::adam::Adam;
use edof_train::dataset::{Batch, Dataset, Place};
use edof_train::noise::Conditions;
use edof_train::precondition::Precondition;
use edof_train::validation::psnr_db;
use edof_train::weighting::remember;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Parts of a batch that are computed side by side and added in order: the result does not depend on the threads.
const PARTS: usize = 4;
/// Validation windows of each photo and ψ.
const VALIDATION_WINDOWS: usize = 64;
/// Steps between validations.
const VALIDATE_EVERY: u64 = 100;
/// Batches of a step's size from which the moments of what is multiplied are taken.
const MOMENT_BATCHES: u64 = 16;

/// How to fine-tune.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinetuneOptions {
    /// Steps of Adam.
    pub steps: u64,
    /// Windows a step.
    pub batch: usize,
    /// Largest move of a weight in one step, for inputs of variance one and in units of a code's last bit.
    pub rate: f32,
    /// Seed of the random windows.
    pub seed: u64,
}

impl Default for FinetuneOptions {
    fn default() -> Self {
        Self { steps: 2000, batch: 512, rate: 0.05, seed: 1 }
    }
}

/// What is reported at each validation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinetuneProgress {
    /// Steps taken.
    pub step: u64,
    /// PSNR in dB on validation windows, mean over photos, ψ and noise.
    pub validation_db: f64,
    /// The best of these so far; its weights are what comes out.
    pub best_db: f64,
}

/// Fine-tunes the weights and thresholds of `fixed` on the dataset's windows. `tell`
/// hears every validation, the first before any step, and may end the work. The best validated words come
/// out, so the result is never worse than the start on the validation windows.
#[must_use]
pub fn finetune(
    fixed: &FixedNetwork,
    dataset: &Dataset,
    tuning: &FinetuneOptions,
    mut tell: impl FnMut(&FinetuneProgress) -> ControlFlow<()>,
) -> FixedNetwork {
    let mut tuner = Tuner::new(fixed, dataset, tuning);
    let mut best = (tuner.validate(), fixed.clone());
    let mut flow = tell(&FinetuneProgress { step: 0, validation_db: best.0, best_db: best.0 });
    for step in 1..=tuning.steps {
        if flow.is_break() {
            break;
        }
        tuner.step(step);
        if step.is_multiple_of(VALIDATE_EVERY) || step == tuning.steps {
            let db = tuner.validate();
            // Words whose sums could overflow are no network.
            if db > best.0 && tuner.words.check().is_ok() {
                best = (db, tuner.words.clone());
            }
            flow = tell(&FinetuneProgress { step, validation_db: db, best_db: best.0 });
        }
    }
    best.1
}

struct Tuner<'a> {
    dataset: &'a Dataset,
    tuning: &'a FinetuneOptions,
    conditions: Conditions,
    layout: Layout,
    rounding: Rounding,
    condition: Precondition,
    /// What is trained, in the coordinates of `condition`.
    weights: Vec<f32>,
    /// The words that it stands for, and their values.
    words: FixedNetwork,
    values: Vec<f32>,
    scratch: Vec<f32>,
    /// A code's last bit, for each weight.
    rates: Vec<f32>,
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
    fn new(fixed: &FixedNetwork, dataset: &'a Dataset, tuning: &'a FinetuneOptions) -> Self {
        let form = fixed.form;
        let layout = Layout::giving(&form, OUTPUTS_422);
        let values = Folded::of(fixed).flatten();
        let to_rgb = rgb_map(&fold::output_weights(fixed.stride, fixed.overlap));
        let share = tuning.batch.div_ceil(PARTS);
        let part = |_| Part {
            pass: Simulated::new(form, &code_formats(fixed), &to_rgb, share.max(VALIDATION_WINDOWS)),
            batch: Batch::new(form.inputs(), share),
            importance: vec![0.0; share],
            errors: vec![0.0; share],
            gradient: vec![0.0; values.len()],
        };
        let conditions = Conditions::plain(fixed.origin.max_sigma() as f32);
        let mut parts: Vec<Part> = (0..PARTS).map(part).collect();
        let rounding = parts[0].moments(&form, &values, dataset, &conditions, tuning.seed);
        let condition = Precondition::of(rounding.factors(&layout));
        let mut weights = values.clone();
        condition.to_trained(&values, &mut weights);
        Self {
            dataset,
            tuning,
            conditions,
            rates: vec![(1.0 - fixed.code_bits as f32).exp2(); values.len()],
            adam: Adam::new(values.len()),
            cell_errors: vec![0.0; dataset.cells()],
            validation: validation(dataset, &conditions),
            words: fixed.clone(),
            scratch: values.clone(),
            layout,
            rounding,
            condition,
            weights,
            values,
            parts,
        }
    }

    /// One batch and one step of Adam; in each share of the steps the rate falls along a cosine.
    fn step(&mut self, step: u64) {
        let (dataset, conditions, cells) = (self.dataset, self.conditions, &self.cell_errors);
        let seed = self.tuning.seed;
        let values = &self.values;
        self.parts.par_iter_mut().enumerate().for_each(|(index, part)| {
            let mut random = Random::new(seed, step, index as u64);
            dataset.draw(&mut random, &conditions, &mut part.batch);
            for (importance, &cell) in part.importance.iter_mut().zip(&part.batch.cells) {
                // A cell not seen yet counts as much as an error of 30 dB.
                let error = cells[cell as usize];
                *importance = 1.0 / if error > 0.0 { error } else { RGB_OUTPUTS as f32 * 1e-3 };
            }
            part.gradient.fill(0.0);
            let examples = part.batch.examples(&part.importance);
            part.pass.gradient(values, &examples, &mut part.errors, &mut part.gradient);
        });
        let (first, others) = self.parts.split_at_mut(1);
        let gradient = &mut first[0].gradient;
        for other in &*others {
            gradient.iter_mut().zip(&other.gradient).for_each(|(sum, g)| *sum += g);
        }
        // One share of the steps for A, one for each S, one for F.
        let shares = (self.words.recurrent.len() + 2) as f32;
        let progress = shares * (step - 1) as f32 / self.tuning.steps.max(1) as f32;
        let rate = self.tuning.rate * 0.5 * (1.0 + (std::f32::consts::PI * progress.fract()).cos());
        self.condition.pull_back(gradient, &mut self.scratch);
        self.adam.step(&mut self.weights, gradient, rate, &self.rates);
        self.round(progress as usize);
        for part in &self.parts {
            remember(&mut self.cell_errors, &part.batch.cells, &part.errors);
        }
    }

    /// The words for the weights now, except for the first `settled` of A and all S.
    fn round(&mut self, settled: usize) {
        let shrinkage = self.words.form.shrinkage;
        for theta in &self.layout.thresholds {
            self.weights[theta.clone()].iter_mut().for_each(|t| *t = shrinkage.legal(*t));
        }
        self.condition.to_network(&self.weights, &mut self.scratch);
        let folded = Folded::unflatten(&self.words.form, &self.scratch);
        self.words = formats::rounded_to(&folded, &self.words, &self.rounding, settled);
        self.values = Folded::of(&self.words).flatten();
    }

    /// Mean PSNR in dB over the validation sets.
    fn validate(&mut self) -> f64 {
        let values = &self.values;
        let parts = self.validation.len().div_ceil(PARTS);
        let sums: Vec<f64> = self
            .parts
            .par_iter_mut()
            .zip(self.validation.par_chunks(parts))
            .map(|(part, sets)| {
                sets.iter()
                    .map(|set| psnr_db(part.pass.forward(values, &set.inputs, VALIDATION_WINDOWS), set))
                    .sum()
            })
            .collect();
        sums.iter().sum::<f64>() / self.validation.len() as f64
    }
}

impl Part {
    /// How what the matrices multiply goes together, on windows that no step draws.
    fn moments(
        &mut self,
        form: &Form,
        values: &[f32],
        dataset: &Dataset,
        conditions: &Conditions,
        seed: u64,
    ) -> Rounding {
        let mut seen = Calibration::new(form);
        for index in 0..MOMENT_BATCHES {
            dataset.draw(&mut Random::new(seed, u64::MAX, index), conditions, &mut self.batch);
            self.pass.forward(values, &self.batch.inputs, self.batch.cells.len());
            seen.observe_moments(&self.pass.pass, &self.batch.inputs, *form);
        }
        Rounding::new(&seen, &vec![1.0; form.codes], form)
    }
}

/// One set for each photo, ψ, without noise and with the noise where networks are judged.
fn validation(dataset: &Dataset, conditions: &Conditions) -> Vec<Batch> {
    let (mut sets, tone) = (Vec::new(), dataset.tone());
    for photo in 0..dataset.photos() {
        for psi in 0..dataset.psis().len() {
            for noise in [Noise::None, conditions.at(tone, Conditions::judged(tone))] {
                let mut batch = Batch::new(dataset.inputs(), VALIDATION_WINDOWS);
                // Validation windows have a stream that no training step has.
                let mut random = Random::new(0, u64::MAX, sets.len() as u64);
                dataset.draw_validation(&mut random, Place { photo, psi }, noise, &mut batch);
                sets.push(batch);
            }
        }
    }
    sets
}

#[cfg(test)]
mod tests;
