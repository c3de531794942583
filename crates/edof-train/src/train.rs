//! A training run: random windows, Adam with a cosine schedule, validation, exact resume.

use crate::adam::Adam;
use crate::budget::SparsityController;
use crate::dataset::{Batch, Dataset};
use crate::initial::{SAMPLES, initial};
use crate::noise::Conditions;
use crate::precondition::Precondition;
use crate::recipe::{Recipe, RecipeError, SHARES, Trained, value};
use crate::structure::Held;
use crate::threads::Pool;
use crate::validation::{Validation, ValidationSets};
use crate::weighting::remember;
use edof_core::camera::Camera;
use edof_core::storage::provenance::Provenance;
use edof_core::{Noise, Tone};
use edof_network::float::parameters::{Layout, flatten, unflatten};
use edof_network::float::pass::Pass;
use edof_network::network::{Condition, Form, Network, Origin};
use edof_numerics::random::Random;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Everything that changes while training runs; what a checkpoint holds.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps taken.
    pub step: u64,
    /// Weights now, in training coordinates (see [`crate::precondition`]).
    pub weights: Vec<f32>,
    /// Running mean of the weights, in training coordinates ([`Recipe::averaging`]).
    pub average: Vec<f32>,
    /// Adam's moments.
    pub adam: Adam,
    /// Running mean of the squared error of each cell; 0 where none was seen yet.
    pub cell_errors: Vec<f32>,
    /// λ of each shrinkage, and what moves it.
    pub steering: SparsityController,
    /// The network's weights at the best validation.
    pub best_weights: Vec<f32>,
    /// The best validation.
    pub best: Best,
    /// Validations since then.
    pub stale: u32,
}

/// How good a validated network is; the one of the highest score is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Best {
    /// `db`, less what its non-zeros cost over the recipe's budget ([`crate::budget::Budget::price_db`]).
    pub score: f64,
    /// [`Validation::db`].
    pub db: f64,
    /// Whether its non-zeros keep the budget; true without a budget.
    pub within_budget: bool,
}

impl Best {
    /// Worse than every network.
    pub const NONE: Self = Self { score: f64::NEG_INFINITY, db: f64::NEG_INFINITY, within_budget: false };
}

/// What is reported after a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Steps taken.
    pub step: u64,
    /// Steps planned.
    pub steps: u64,
    /// Mean loss since the last step of a hundred or validation.
    pub loss: f64,
    /// Newest validation, if this step had one.
    pub validation: Option<Validation>,
    /// Best validation so far.
    pub best: Best,
}

/// A training run: recipe, photographs, state.
#[derive(Debug)]
pub struct Trainer<'a> {
    recipe: Recipe,
    dataset: &'a Dataset,
    rates: Vec<f32>,
    condition: Precondition,
    held: Held,
    /// The network's weights for the state's.
    weights: Vec<f32>,
    scratch: Vec<f32>,
    layout: Layout,
    pool: Pool,
    shares: Vec<Share>,
    validation: ValidationSets,
    /// What a checkpoint holds.
    pub state: State,
}

/// One part of a batch, and what became of it.
#[derive(Debug)]
struct Share {
    pass: Pass,
    batch: Batch,
    importance: Vec<f32>,
    errors: Vec<f32>,
    gradient: Vec<f32>,
    loss: f64,
    /// Windows at the noise where networks are judged, and the non-zeros of each shrinkage on them.
    judged: (u32, Vec<u32>),
}

/// Windows that training coordinates are computed from.
const WHITENING_WINDOWS: usize = 16_384;
/// Mean square below which a direction of the window counts as noise.
const WHITENING_FLOOR: f64 = 2e-5;
/// Steps over which the rate rises from 0.
const WARM_UP: u64 = 500;
/// Weights that one thread adds up at a time.
const PIECE: usize = 8192;

impl<'a> Trainer<'a> {
    /// A new run on `threads` threads; their number changes no byte.
    ///
    /// # Errors
    /// [`RecipeError`].
    pub fn new(recipe: Recipe, dataset: &'a Dataset, threads: usize) -> Result<Self, RecipeError> {
        recipe.check_with(dataset)?;
        let network = start(&recipe, dataset);
        Self::begin(recipe, dataset, threads, network)
    }

    /// A new run that begins with the weights of `network`, whatever the recipe's start.
    ///
    /// # Errors
    /// [`RecipeError`], also where the network has another form than the recipe.
    pub fn from_network(
        recipe: Recipe,
        dataset: &'a Dataset,
        threads: usize,
        network: &Network,
    ) -> Result<Self, RecipeError> {
        if network.form != recipe.form {
            return Err(value("form", format!("{:?}", network.form), "the recipe's"));
        }
        Self::from_weights(recipe, dataset, threads, flatten(network))
    }

    /// The same from a network's flat weights.
    ///
    /// # Errors
    /// [`RecipeError`].
    pub fn from_weights(
        recipe: Recipe,
        dataset: &'a Dataset,
        threads: usize,
        weights: Vec<f32>,
    ) -> Result<Self, RecipeError> {
        recipe.check_with(dataset)?;
        Self::begin(recipe, dataset, threads, weights)
    }

    fn begin(
        recipe: Recipe,
        dataset: &'a Dataset,
        threads: usize,
        mut network: Vec<f32>,
    ) -> Result<Self, RecipeError> {
        recipe.structure.held(&recipe.form, &Layout::new(&recipe.form), &network).impose(&mut network);
        let mut weights = network.clone();
        condition(&recipe, dataset).to_trained(&network, &mut weights);
        let state = State {
            step: 0,
            adam: Adam::new(weights.len()),
            cell_errors: vec![0.0; dataset.cells()],
            steering: SparsityController::new(recipe.lambdas(), recipe.budget.as_ref()),
            best_weights: network,
            best: Best::NONE,
            stale: 0,
            average: weights.clone(),
            weights,
        };
        Self::resume(recipe, dataset, threads, state)
    }

    /// A run that resumes from a state, with the same random windows as an uninterrupted run.
    ///
    /// # Errors
    /// [`RecipeError`].
    pub fn resume(
        recipe: Recipe,
        dataset: &'a Dataset,
        threads: usize,
        state: State,
    ) -> Result<Self, RecipeError> {
        recipe.check_with(dataset)?;
        let layout = Layout::new(&recipe.form);
        for (field, found, expected) in [
            ("checkpoint weights", state.weights.len(), layout.len()),
            ("checkpoint cells", state.cell_errors.len(), dataset.cells()),
            ("checkpoint lambdas", state.steering.lambdas.len(), recipe.form.shrinkages()),
        ] {
            if found != expected {
                return Err(value(field, found, format!("{expected}, as this form and these photos have")));
            }
        }
        let pool = Pool::new(threads)?;
        let condition = condition(&recipe, dataset);
        let mut weights = vec![0.0; layout.len()];
        condition.to_network(&state.weights, &mut weights);
        let held = recipe.structure.held(&recipe.form, &layout, &weights);
        Ok(Self {
            dataset,
            held,
            rates: rates(&layout, &recipe),
            scratch: weights.clone(),
            shares: (0..SHARES).map(|_| Share::new(&recipe, layout.len())).collect(),
            validation: pool.install(|| ValidationSets::new(dataset, &recipe.conditions)),
            condition,
            weights,
            layout,
            pool,
            recipe,
            state,
        })
    }

    /// The recipe.
    #[must_use]
    pub const fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// ψ at a position of [`crate::dataset::Place`].
    #[must_use]
    pub fn psi(&self, position: usize) -> f64 {
        self.dataset.psis()[position]
    }

    /// Number of ψ of the data.
    #[must_use]
    pub fn psis(&self) -> usize {
        self.dataset.psis().len()
    }

    /// Trains until the schedule ends, patience is spent, or `tell` ends it: the state can then be resumed. `tell` is called after every step.
    ///
    /// # Errors
    /// [`RecipeError::Diverged`].
    pub fn run(
        &mut self,
        mut tell: impl FnMut(&Self, &Progress) -> ControlFlow<()>,
    ) -> Result<(), RecipeError> {
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
            validation.iter().for_each(|v| self.keep_best(v));
            let loss = sum / f64::from(count);
            if due || step.is_multiple_of(100) {
                (sum, count) = (0.0, 0);
            }
            let (steps, best) = (self.recipe.steps, self.state.best);
            if tell(self, &Progress { step, steps, loss, validation, best }).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// One batch and one step of Adam. Returns the mean loss of a window.
    pub fn step(&mut self) -> f64 {
        let (recipe, dataset, state, weights) = (&self.recipe, self.dataset, &self.state, &self.weights);
        self.pool.install(|| {
            self.shares.par_iter_mut().enumerate().for_each(|(index, share)| {
                let mut random = Random::new(recipe.seed, state.step, index as u64);
                dataset.draw(&mut random, &recipe.conditions, &mut share.batch);
                share.differentiate(weights, state, recipe);
            });
        });
        let loss = self.shares.iter().map(|w| w.loss).sum::<f64>() / recipe.batch as f64;
        self.update();
        loss
    }

    /// Runs the network of the averaged weights now over the validation windows.
    #[must_use]
    pub fn validate(&self) -> Validation {
        let weights = self.averaged();
        self.pool.install(|| self.validation.measure(self.recipe.form, &weights))
    }

    /// The network's weights for the running mean.
    fn averaged(&self) -> Vec<f32> {
        let mut weights = vec![0.0; self.layout.len()];
        self.condition.to_network(&self.state.average, &mut weights);
        weights
    }

    /// Runs the network of the best validation over the validation windows once more.
    #[must_use]
    pub fn validate_best(&self) -> Validation {
        self.pool.install(|| self.validation.measure(self.recipe.form, &self.state.best_weights))
    }

    /// The network of the best validation so far.
    #[must_use]
    pub fn best(&self, name: &str, camera: &Camera, provenance: Provenance) -> Network {
        let conditions = &self.recipe.conditions;
        let tone = self.recipe.tone;
        let least_noise = match conditions.begins_with_none(tone) {
            true => Noise::None,
            false => conditions.at(tone, 0.0),
        };
        let non_zeros = self.validate_best().busy_non_zeros();
        let origin = Origin {
            name: name.to_owned(),
            camera: camera.clone(),
            further_foci: self.recipe.further_foci.clone(),
            conditions: vec![Condition { tone, noise: conditions.at(tone, 1.0), least_noise }],
            values: tone,
            patches: self.state.step * self.recipe.batch as u64,
            validation_db: (self.state.best.db * 1e4).round() / 1e4,
            non_zeros: non_zeros.iter().map(|n| (n * 1e2).round() / 1e2).collect(),
            provenance,
        };
        unflatten(self.recipe.form, &self.state.best_weights, origin)
    }

    /// Validates the weights now, and keeps them if they are the best: for a run that is ended between two validations.
    pub fn validate_last(&mut self) -> Validation {
        let validation = self.validate();
        self.keep_best(&validation);
        validation
    }

    fn keep_best(&mut self, validation: &Validation) {
        let db = validation.db();
        let mut found = Best { score: db, db, within_budget: true };
        if let Some(budget) = &self.recipe.budget {
            let non_zeros = validation.busy_non_zeros();
            found.score -= budget.price_db(&non_zeros);
            found.within_budget = budget.keeps(&non_zeros);
            self.state.steering.correct(budget, &non_zeros);
        }
        if found.score > self.state.best.score {
            self.state.best = found;
            self.state.stale = 0;
            self.state.best_weights = self.averaged();
        } else {
            self.state.stale += 1;
        }
    }

    fn update(&mut self) {
        let schedule = schedule(self.state.step, self.recipe.steps);
        let (first, others) = self.shares.split_at_mut(1);
        let gradient = &mut first[0].gradient;
        self.pool.install(|| {
            add_up(gradient, others, 1.0 / self.recipe.batch as f32);
            self.condition.pull_back(gradient, &mut self.scratch);
            let rate = self.recipe.rate * schedule;
            self.state.adam.step(&mut self.state.weights, gradient, rate, &self.rates);
            for theta in &self.layout.thresholds {
                let thresholds = self.state.weights[theta.clone()].iter_mut();
                thresholds.for_each(|t| *t = self.recipe.form.shrinkage.legal(*t));
            }
            self.held.hold(&self.condition, &mut self.state.weights, &mut self.weights);
        });
        let kept = averaging(self.recipe.averaging, self.state.step);
        let mean = self.state.average.iter_mut().zip(&self.state.weights);
        mean.for_each(|(mean, now)| *mean = *now + kept * (*mean - *now));
        for share in &self.shares {
            remember(&mut self.state.cell_errors, &share.batch.cells, &share.errors);
        }
        self.steer(schedule);
        self.state.step += 1;
    }

    /// Moves λ toward the budget by what this batch's codes were.
    fn steer(&mut self, schedule: f32) {
        let Some(budget) = &self.recipe.budget else { return };
        let windows: u32 = self.shares.iter().map(|s| s.judged.0).sum();
        if windows == 0 {
            return;
        }
        let count = |t: usize| self.shares.iter().map(|s| s.judged.1[t]).sum::<u32>() as f32;
        let all = 0..self.recipe.form.shrinkages();
        let measured: Vec<f32> = all.map(|t| count(t) / windows as f32).collect();
        self.state.steering.step(budget, &measured, schedule);
    }
}

/// The first share's gradient becomes the sum of all shares', times `scale`; each weight's in the order of the shares.
fn add_up(first: &mut [f32], others: &[Share], scale: f32) {
    first.par_chunks_mut(PIECE).enumerate().for_each(|(piece, sum)| {
        let start = piece * PIECE;
        for share in others {
            let more = &share.gradient[start..start + sum.len()];
            sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
        }
        sum.iter_mut().for_each(|s| *s *= scale);
    });
}

impl Share {
    fn new(recipe: &Recipe, weights: usize) -> Self {
        let (form, windows) = (recipe.form, recipe.batch / SHARES);
        Self {
            pass: Pass::new(form, windows),
            batch: Batch::new(form.inputs(), windows),
            importance: vec![0.0; windows],
            errors: vec![0.0; windows],
            gradient: vec![0.0; weights],
            loss: 0.0,
            judged: (0, vec![0; form.shrinkages()]),
        }
    }

    fn differentiate(&mut self, weights: &[f32], state: &State, recipe: &Recipe) {
        for (importance, &cell) in self.importance.iter_mut().zip(&self.batch.cells) {
            *importance = recipe.weighting.importance(state.cell_errors[cell as usize]);
        }
        self.gradient.fill(0.0);
        let examples = self.batch.examples(&self.importance);
        let (errors, gradient) = (&mut self.errors, &mut self.gradient);
        let loss = self.pass.gradient(weights, &examples, &state.steering.lambdas, errors, gradient);
        self.loss = loss.squared + loss.sparsity;
        if recipe.budget.is_some() {
            self.count_non_zeros(&recipe.form, recipe.tone);
        }
    }

    fn count_non_zeros(&mut self, form: &Form, tone: Tone) {
        self.judged.0 = 0;
        self.judged.1.fill(0);
        let judged = Conditions::class(Conditions::judged(tone));
        for (window, class) in self.batch.classes.iter().enumerate() {
            if usize::from(*class) != judged {
                continue;
            }
            self.judged.0 += 1;
            for (t, count) in self.judged.1.iter_mut().enumerate() {
                let z = &self.pass.z(t)[window * form.codes..][..form.codes];
                *count += z.iter().map(|z| u32::from(*z != 0.0)).sum::<u32>();
            }
        }
    }
}

/// Share of the rate at a step: a short rise, then half a cosine down to a thousandth.
fn schedule(step: u64, steps: u64) -> f32 {
    let (rise, done) = (((step + 1) as f32 / WARM_UP as f32).min(1.0), step as f32 / steps as f32);
    rise * (0.001 + 0.999 * 0.5 * (1.0 + (std::f32::consts::PI * done).cos()))
}

/// Share of the running mean that a step keeps: less at first, so that the start is soon forgotten.
fn averaging(usual: f32, step: u64) -> f32 {
    usual.min((1 + step) as f32 / (10 + step) as f32)
}

/// Starting weights from windows like those to come.
fn start(recipe: &Recipe, dataset: &Dataset) -> Vec<f32> {
    let mut random = Random::new(recipe.seed, u64::MAX, 0);
    let mut batch = Batch::new(recipe.form.inputs(), SAMPLES);
    dataset.draw(&mut random, &recipe.conditions, &mut batch);
    initial(&recipe.form, (recipe.start, recipe.structure), &batch, &mut random)
}

/// Coordinates from a batch of training windows; the same for a resumed run.
fn condition(recipe: &Recipe, dataset: &Dataset) -> Precondition {
    if recipe.structure.is_of_pixels() {
        return Precondition::of([]);
    }
    let (form, mut batch) = (&recipe.form, Batch::new(recipe.form.inputs(), WHITENING_WINDOWS));
    dataset.draw(&mut Random::new(recipe.seed, u64::MAX, 1), &recipe.conditions, &mut batch);
    Precondition::new(&Layout::new(form), &batch.inputs, form.inputs(), WHITENING_FLOOR)
}

fn rates(layout: &Layout, recipe: &Recipe) -> Vec<f32> {
    let mut rates = vec![1.0; layout.len()];
    rates[layout.dictionary.clone()].fill(recipe.output_rate);
    rates[layout.linear_path.clone()].fill(recipe.output_rate);
    if recipe.trained == Trained::Thresholds {
        rates.fill(0.0);
    }
    layout.thresholds.iter().for_each(|t| rates[t.clone()].fill(recipe.threshold_rate));
    rates
}
