//! The training recipe: random windows, Adam with a cosine schedule, validation, checkpoints, exact resume.
//!
//! The squared error of a window is weighed by the running mean error of its cell (its photo, ψ and noise class): see
//! [`Balance`].

use crate::adam::Adam;
use crate::initial::{self, Start};
use crate::parameters::{Layout, unflatten};
use crate::pass::Pass;
use crate::patches::{Bank, Batch, Random};
use crate::precondition::Precondition;
use edof_spec::Camera;
use edof_spec::colour::RGB_OUTPUTS;
use edof_spec::network::{Form, Network, Origin, Shrinkage};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How much windows of easy and of hard cells weigh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Balance {
    /// By 1 over the cell's mean error: the sum falls as the mean of log MSE does, so the mean PSNR is what is trained, and the
    /// hard cells (largest ψ, with noise) pay for easy ones.
    Psnr,
    /// By 1 over the root of it: between the two.
    Root,
    /// All alike: busy photos at the far end of the range outweigh all else.
    Mse,
}

impl Balance {
    /// Weight of a window whose cell's mean error is `running`. A cell at `reference` weighs the same in all three, which gives
    /// λ its unit.
    fn importance(self, running: f32, reference: f32) -> f32 {
        match self {
            Self::Psnr => 1.0 / running,
            Self::Root => 1.0 / (running * reference).sqrt(),
            Self::Mse => 1.0 / reference,
        }
    }
}

/// Everything that decides a training run, besides photos and camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The network's form.
    pub form: Form,
    /// Largest noise σ, in units of full scale.
    pub noise: f32,
    /// One window in so many has no noise at all.
    pub noiseless: usize,
    /// How much windows of easy and of hard cells weigh.
    pub balance: Balance,
    /// Windows a step.
    pub batch: usize,
    /// Steps of the whole schedule.
    pub steps: u64,
    /// Adam's largest rate.
    pub rate: f32,
    /// Rate of D and R, relative to `rate`.
    pub output_rate: f32,
    /// Rate of θ, relative to `rate`.
    pub threshold_rate: f32,
    /// λ: how much a unit of |z|·‖column‖ costs.
    pub lambda: f32,
    /// Where to start from.
    pub start: Start,
    /// Seed of everything random.
    pub seed: u64,
    /// Workers; the same number gives the same bytes.
    pub threads: usize,
    /// Steps between validations.
    pub validate_every: u64,
    /// Validations without a better one after which training stops early.
    pub patience: u32,
}

impl Recipe {
    /// What worked best for a form (see `docs/decisions/`).
    #[must_use]
    pub const fn new(form: Form) -> Self {
        Self {
            form,
            noise: 0.015,
            noiseless: 8,
            balance: Balance::Root,
            batch: 1024,
            steps: 100_000,
            rate: match form.shrinkage {
                Shrinkage::OneSided => 1.5e-3,
                Shrinkage::TwoSided => 2e-3,
            },
            output_rate: 0.2,
            threshold_rate: 0.15,
            lambda: 3e-5,
            start: Start::Whitened,
            seed: 1,
            threads: 2,
            validate_every: 2_000,
            patience: 30,
        }
    }
}

/// A recipe that cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum RecipeError {
    /// The form is none.
    #[error(transparent)]
    Form(#[from] edof_spec::network::NetworkError),
    /// A number out of range.
    #[error("{field} {value}: must be {expected}")]
    Value { field: &'static str, value: String, expected: &'static str },
    /// Weights became NaN or infinite.
    #[error("training diverged at step {step}: the loss is {loss}; lower --rate (now {rate})")]
    Diverged { step: u64, loss: f64, rate: f32 },
}

/// Everything that changes while training runs; what a checkpoint holds.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps taken.
    pub step: u64,
    /// Weights now, in training coordinates (see [`crate::precondition`]).
    pub weights: Vec<f32>,
    /// Adam's moments.
    pub adam: Adam,
    /// Running mean of the squared error of each cell; 0 where none was seen yet.
    pub cell_errors: Vec<f32>,
    /// The network's weights at the best validation.
    pub best_weights: Vec<f32>,
    /// PSNR in dB of the best validation.
    pub best_db: f64,
    /// Validations since then.
    pub stale: u32,
}

/// What is told after each step that is worth telling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Progress {
    /// Steps taken.
    pub step: u64,
    /// Steps planned.
    pub steps: u64,
    /// Mean loss since the last report.
    pub loss: f64,
    /// Newest validation in dB, if this step had one.
    pub validation_db: Option<f64>,
    /// Best validation so far.
    pub best_db: f64,
    /// Mean count of non-zero codes over all layers, with a validation.
    pub non_zeros: Option<f64>,
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continue {
    /// Go on.
    Yes,
    /// Stop here; the state can be resumed.
    No,
}

/// A training run: recipe, photos, state.
#[derive(Debug)]
pub struct Trainer<'a> {
    recipe: Recipe,
    bank: &'a Bank,
    rates: Vec<f32>,
    condition: Precondition,
    /// The network's weights for the state's.
    weights: Vec<f32>,
    scratch: Vec<f32>,
    layout: Layout,
    pool: rayon::ThreadPool,
    workers: Vec<Worker>,
    validation: Vec<ValidationSet>,
    /// What a checkpoint holds.
    pub state: State,
}

#[derive(Debug)]
struct Worker {
    pass: Pass,
    batch: Batch,
    importance: Vec<f32>,
    errors: Vec<f32>,
    gradient: Vec<f32>,
    loss: f64,
}

#[derive(Debug)]
struct ValidationSet {
    batch: Batch,
}

/// Windows of each validation set; there is one set for each photo, ψ and σ.
const VALIDATION_WINDOWS: usize = 256;
/// ψ values of a validation, spread over the bank's.
const VALIDATION_PSIS: usize = 5;
/// σ of the validation sets, as shares of the recipe's largest.
const VALIDATION_NOISE: [f32; 2] = [0.0, 2.0 / 3.0];
/// Windows that training coordinates are computed from.
const WHITENING_WINDOWS: usize = 16_384;
/// Mean square below which a direction of the window counts as noise.
const WHITENING_FLOOR: f64 = 2e-5;
/// Steps over which the rate rises from 0.
const WARM_UP: u64 = 500;
/// Mean square error (36 dB) of a cell that weighs the same whatever the balance.
const REFERENCE_ERROR: f32 = 2.5e-4;
/// How much of a cell's running error one window replaces.
const CELL_RATE: f32 = 0.02;

impl<'a> Trainer<'a> {
    /// A new run.
    ///
    /// # Errors
    /// [`RecipeError`].
    pub fn new(recipe: Recipe, bank: &'a Bank) -> Result<Self, RecipeError> {
        check(&recipe, bank)?;
        let network = first_network(&recipe, bank);
        let mut weights = network.clone();
        condition(&recipe, bank).to_trained(&network, &mut weights);
        let state = State {
            step: 0,
            adam: Adam::new(weights.len()),
            cell_errors: vec![0.0; bank.cells()],
            best_weights: network,
            best_db: f64::NEG_INFINITY,
            stale: 0,
            weights,
        };
        Self::resume(recipe, bank, state)
    }

    /// A run that goes on from a state; it draws the windows that it would have drawn without the break.
    ///
    /// # Errors
    /// [`RecipeError`].
    pub fn resume(recipe: Recipe, bank: &'a Bank, state: State) -> Result<Self, RecipeError> {
        check(&recipe, bank)?;
        let layout = Layout::new(&recipe.form);
        for (field, found, expected) in [
            ("checkpoint weights", state.weights.len(), layout.len()),
            ("checkpoint cells", state.cell_errors.len(), bank.cells()),
        ] {
            if found != expected {
                return Err(value(field, found, "as many as this form and these photos have"));
            }
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(recipe.threads).build().map_err(|e| {
            value("threads", format!("{} ({e})", recipe.threads), "a number the system can start")
        })?;
        let share = recipe.batch / recipe.threads;
        let workers = (0..recipe.threads).map(|_| Worker::new(&recipe.form, share, layout.len())).collect();
        let validation = validation_sets(bank, &recipe);
        let rates = rates(&layout, &recipe);
        let condition = condition(&recipe, bank);
        let mut weights = vec![0.0; layout.len()];
        condition.to_network(&state.weights, &mut weights);
        let scratch = weights.clone();
        Ok(Self {
            recipe,
            bank,
            rates,
            condition,
            weights,
            scratch,
            layout,
            pool,
            workers,
            validation,
            state,
        })
    }

    /// The recipe.
    #[must_use]
    pub const fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Trains until the schedule ends, patience is spent, or `tell` says no. `tell` is called after every step of a hundred and
    /// every validation.
    ///
    /// # Errors
    /// [`RecipeError::Diverged`].
    pub fn run(&mut self, mut tell: impl FnMut(&Self, &Progress) -> Continue) -> Result<(), RecipeError> {
        let (mut sum, mut count) = (0.0, 0u32);
        while self.state.step < self.recipe.steps && self.state.stale < self.recipe.patience {
            let loss = self.step();
            sum += loss;
            count += 1;
            if !loss.is_finite() {
                return Err(RecipeError::Diverged { step: self.state.step, loss, rate: self.recipe.rate });
            }
            let step = self.state.step;
            let due = step.is_multiple_of(self.recipe.validate_every) || step == self.recipe.steps;
            let validation = due.then(|| self.validate());
            if let Some((db, _)) = validation {
                self.keep_best(db);
            }
            if due || step.is_multiple_of(100) {
                let progress = Progress {
                    step,
                    steps: self.recipe.steps,
                    loss: sum / f64::from(count),
                    validation_db: validation.map(|v| v.0),
                    best_db: self.state.best_db,
                    non_zeros: validation.map(|v| v.1),
                };
                (sum, count) = (0.0, 0);
                if tell(self, &progress) == Continue::No {
                    break;
                }
            }
        }
        Ok(())
    }

    /// One batch and one step of Adam. Returns the mean loss of a window.
    pub fn step(&mut self) -> f64 {
        let (recipe, bank, state, weights) = (&self.recipe, self.bank, &self.state, &self.weights);
        self.pool.install(|| {
            self.workers.par_iter_mut().enumerate().for_each(|(index, worker)| {
                let mut random = Random::new(recipe.seed, state.step, index as u64);
                bank.draw(&mut random, recipe.noise, recipe.noiseless, &mut worker.batch);
                worker.differentiate(weights, state, recipe);
            });
        });
        let loss = self.workers.iter().map(|w| w.loss).sum::<f64>() / recipe.batch as f64;
        self.update();
        loss
    }

    /// Mean PSNR in dB over photos, ψ and σ on validation windows, and the mean count of non-zero codes a layer.
    pub fn validate(&mut self) -> (f64, f64) {
        let (weights, form) = (&self.weights, self.recipe.form);
        let measured: Vec<(f64, f64)> = self.pool.install(|| {
            self.validation
                .par_iter()
                .map_init(
                    || Pass::new(form, VALIDATION_WINDOWS),
                    |pass, set| set.measure(pass, weights, &form),
                )
                .collect()
        });
        let mean =
            |pick: fn(&(f64, f64)) -> f64| measured.iter().map(pick).sum::<f64>() / measured.len() as f64;
        (mean(|m| m.0), mean(|m| m.1))
    }

    /// The network of the best validation so far.
    #[must_use]
    pub fn best(&self, name: &str, camera: &Camera, command: &str) -> Network {
        let origin = Origin {
            name: name.to_owned(),
            camera: camera.clone(),
            noise: f64::from(self.recipe.noise),
            command: command.to_owned(),
            patches: self.state.step * self.recipe.batch as u64,
            validation_db: (self.state.best_db * 1e4).round() / 1e4,
        };
        unflatten(self.recipe.form, &self.state.best_weights, origin)
    }

    fn keep_best(&mut self, db: f64) {
        if db > self.state.best_db {
            self.state.best_db = db;
            self.state.stale = 0;
            self.state.best_weights.clone_from(&self.weights);
        } else {
            self.state.stale += 1;
        }
    }

    fn update(&mut self) {
        let (first, others) = self.workers.split_at_mut(1);
        let gradient = &mut first[0].gradient;
        for worker in others.iter() {
            gradient.iter_mut().zip(&worker.gradient).for_each(|(g, w)| *g += w);
        }
        let scale = 1.0 / self.recipe.batch as f32;
        gradient.iter_mut().for_each(|g| *g *= scale);
        self.condition.pull_back(gradient, &mut self.scratch);
        let rate = self.recipe.rate * schedule(self.state.step, self.recipe.steps);
        self.state.adam.step(&mut self.state.weights, gradient, rate, &self.rates);
        if self.recipe.form.shrinkage == Shrinkage::TwoSided {
            for theta in &self.layout.thresholds {
                self.state.weights[theta.clone()].iter_mut().for_each(|t| *t = t.max(0.0));
            }
        }
        self.condition.to_network(&self.state.weights, &mut self.weights);
        for worker in &self.workers {
            for (&cell, &error) in worker.batch.cells.iter().zip(&worker.errors) {
                let running = &mut self.state.cell_errors[cell as usize];
                *running = if *running == 0.0 { error } else { *running + CELL_RATE * (error - *running) };
            }
        }
        self.state.step += 1;
    }
}

impl Worker {
    fn new(form: &Form, windows: usize, weights: usize) -> Self {
        Self {
            pass: Pass::new(*form, windows),
            batch: Batch::new(form.window, windows),
            importance: vec![0.0; windows],
            errors: vec![0.0; windows],
            gradient: vec![0.0; weights],
            loss: 0.0,
        }
    }

    fn differentiate(&mut self, weights: &[f32], state: &State, recipe: &Recipe) {
        // A window's error may not weigh more than if its cell were at 60 dB.
        let least = RGB_OUTPUTS as f32 * 1e-6;
        let reference = RGB_OUTPUTS as f32 * REFERENCE_ERROR;
        for (importance, &cell) in self.importance.iter_mut().zip(&self.batch.cells) {
            let running = state.cell_errors[cell as usize];
            *importance =
                if running == 0.0 { 1.0 } else { recipe.balance.importance(running.max(least), reference) };
        }
        self.gradient.fill(0.0);
        let loss = self.pass.gradient(
            weights,
            &self.batch.inputs,
            &self.batch.targets,
            &self.importance,
            recipe.lambda,
            &mut self.errors,
            &mut self.gradient,
        );
        self.loss = loss.squared + loss.sparsity;
    }
}

impl ValidationSet {
    fn measure(&self, pass: &mut Pass, weights: &[f32], form: &Form) -> (f64, f64) {
        let windows = self.batch.cells.len();
        let outputs = pass.forward(weights, &self.batch.inputs, windows);
        let squared: f64 = outputs
            .iter()
            .zip(&self.batch.targets)
            .map(|(o, x)| f64::from(o.clamp(0.0, 1.0) - x).powi(2))
            .sum();
        let mse = (squared / outputs.len() as f64).max(1e-12);
        let used = windows * form.codes;
        let non_zeros = (0..form.shrinkages())
            .map(|t| pass.z(t)[..used].iter().filter(|z| **z != 0.0).count())
            .sum::<usize>();
        (-10.0 * mse.log10(), non_zeros as f64 / (windows * form.shrinkages()) as f64)
    }
}

/// Share of the rate at a step: a short rise, then half a cosine down to a thousandth.
fn schedule(step: u64, steps: u64) -> f32 {
    let rise = ((step + 1) as f32 / WARM_UP as f32).min(1.0);
    let done = step as f32 / steps as f32;
    rise * (0.001 + 0.999 * 0.5 * (1.0 + (std::f32::consts::PI * done).cos()))
}

/// Where training starts: the same recipe gives the same weights.
fn first_network(recipe: &Recipe, bank: &Bank) -> Vec<f32> {
    let mut random = Random::new(recipe.seed, u64::MAX, 0);
    let mut batch = Batch::new(recipe.form.window, initial::SAMPLES);
    bank.draw(&mut random, recipe.noise, recipe.noiseless, &mut batch);
    initial::initial(&recipe.form, recipe.start, &batch, &mut random)
}

/// Coordinates from a batch of training windows; the same for a resumed run.
fn condition(recipe: &Recipe, bank: &Bank) -> Precondition {
    let mut batch = Batch::new(recipe.form.window, WHITENING_WINDOWS);
    bank.draw(&mut Random::new(recipe.seed, u64::MAX, 1), recipe.noise, recipe.noiseless, &mut batch);
    Precondition::new(&Layout::new(&recipe.form), &batch.inputs, recipe.form.window.pixels(), WHITENING_FLOOR)
}

fn rates(layout: &Layout, recipe: &Recipe) -> Vec<f32> {
    let mut rates = vec![1.0; layout.len()];
    rates[layout.dictionary.clone()].fill(recipe.output_rate);
    rates[layout.linear_path.clone()].fill(recipe.output_rate);
    layout.thresholds.iter().for_each(|t| rates[t.clone()].fill(recipe.threshold_rate));
    rates
}

fn validation_sets(bank: &Bank, recipe: &Recipe) -> Vec<ValidationSet> {
    let psis = bank.psis().len();
    let spread: Vec<usize> = if psis <= VALIDATION_PSIS {
        (0..psis).collect()
    } else {
        (0..VALIDATION_PSIS).map(|i| i * (psis - 1) / (VALIDATION_PSIS - 1)).collect()
    };
    let mut sets = Vec::new();
    for photo in 0..bank.photos() {
        for &psi in &spread {
            for share in VALIDATION_NOISE {
                let mut batch = Batch::new(bank.window(), VALIDATION_WINDOWS);
                // Not the recipe's seed: every run is judged by the same windows.
                let mut random = Random::new(0x5EED, sets.len() as u64, 0);
                bank.draw_validation(&mut random, photo, psi, share * recipe.noise, &mut batch);
                sets.push(ValidationSet { batch });
            }
        }
    }
    sets
}

fn value(field: &'static str, found: impl ToString, expected: &'static str) -> RecipeError {
    RecipeError::Value { field, value: found.to_string(), expected }
}

fn check(recipe: &Recipe, bank: &Bank) -> Result<(), RecipeError> {
    recipe.form.check()?;
    if recipe.form.window != bank.window() {
        return Err(value("window", recipe.form.window.side(), "the window that the photos were cut for"));
    }
    if recipe.threads == 0 || recipe.threads > 256 {
        return Err(value("threads", recipe.threads, "1 to 256"));
    }
    if recipe.batch == 0 || !recipe.batch.is_multiple_of(recipe.threads) {
        return Err(value("batch", recipe.batch, "a positive multiple of the threads"));
    }
    if recipe.noiseless == 0 {
        return Err(value("noiseless", 0, "1 or more"));
    }
    if recipe.steps == 0 || recipe.validate_every == 0 {
        return Err(value("steps", recipe.steps.min(recipe.validate_every), "1 or more"));
    }
    let numbers = [
        ("rate", recipe.rate),
        ("output_rate", recipe.output_rate),
        ("threshold_rate", recipe.threshold_rate),
    ];
    for (field, number) in numbers {
        if !(number.is_finite() && number > 0.0) {
            return Err(value(field, number, "a positive number"));
        }
    }
    for (field, number) in [("lambda", recipe.lambda), ("noise", recipe.noise)] {
        if !(number.is_finite() && (0.0..=1.0).contains(&number)) {
            return Err(value(field, number, "0 to 1"));
        }
    }
    Ok(())
}
