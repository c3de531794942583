//! Everything that decides a training run, besides photographs and camera.

use crate::augment::Augmentation;
use crate::budget::Budget;
use crate::dataset::{Dataset, DatasetOptions};
use crate::initial::Start;
use crate::noise::Conditions;
use crate::structure::Structure;
use crate::weighting::Weighting;
use edof_core::Tone;
use edof_core::words;
use edof_network::network::{Form, NetworkError};
use edof_optics::psf::Settings;
use serde::{Deserialize, Serialize};

/// Parts of a batch that are made and differentiated in parallel; their gradients are added in order, so the bytes do not depend on
/// how many threads there are.
pub const SHARES: usize = 8;

/// Steps of the recipe, and windows of each step.
pub(crate) const STEPS: u64 = 40_000;
pub(crate) const BATCH: usize = 512;

/// Everything that decides a training run, besides photographs and camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The network's form.
    pub form: Form,
    /// What the photographs' values are taken for, and what the network takes and gives.
    pub tone: Tone,
    /// Foci in ψ of the exposures after the first, which has the camera's focus.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_foci: Vec<f64>,
    /// Light and noise of each window.
    pub conditions: Conditions,
    /// Looks of each photograph.
    pub augmentation: Augmentation,
    /// How much windows of easy and of hard cells weigh.
    pub weighting: Weighting,
    /// Windows a step; a multiple of [`SHARES`].
    pub batch: usize,
    /// Steps of the whole schedule.
    pub steps: u64,
    /// Adam's largest rate.
    pub rate: f32,
    /// Rate of D and R, relative to `rate`.
    pub output_rate: f32,
    /// Rate of θ, relative to `rate`.
    pub threshold_rate: f32,
    /// λ, what a unit of |z|·‖column‖ costs: one for each shrinkage, or one for all. With a budget, where λ starts.
    pub lambda: Vec<f32>,
    /// Non-zeros that λ is moved to reach; none where λ stands still.
    pub budget: Option<Budget>,
    /// Where to start from.
    pub start: Start,
    /// Share of the running mean of the weights that each step keeps; it is what is validated and written. 0: the weights themselves.
    pub averaging: f32,
    /// What training changes.
    pub trained: Trained,
    /// What weights keep to.
    pub structure: Structure,
    /// Seed of everything random.
    pub seed: u64,
    /// Steps between validations.
    pub validate_every: u64,
    /// Validations without improvement after which training stops early.
    pub patience: u32,
}

/// What training changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trained {
    /// Every weight.
    All,
    /// Thresholds alone: a network for another class of noise that differs in a few hundred words.
    Thresholds,
}

impl Recipe {
    /// What worked best for a form (see `docs/decisions/`).
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self {
            form,
            // What photographs are, and what `edof capture` takes them for (docs/decisions/0041-one-tone.md).
            tone: Tone::Srgb,
            further_foci: vec![],
            conditions: Conditions::plain(0.03),
            // No looks but the photograph's own; these are what --variants draws.
            augmentation: Augmentation { variants: 1, saturation: [0.8, 1.8], hue: 20.0, scale: 0.6 },
            weighting: Weighting::Root,
            batch: BATCH,
            steps: STEPS,
            rate: form.shrinkage.training().rate,
            output_rate: 0.2,
            threshold_rate: 0.15,
            lambda: lambdas(&form),
            budget: Budget::of_the_board(&form),
            start: Start::Whitened,
            averaging: 0.0,
            trained: Trained::All,
            structure: Structure::Free,
            seed: 1,
            validate_every: 2_000,
            patience: 30,
        }
    }

    /// λ of each shrinkage at the start.
    #[must_use]
    pub fn lambdas(&self) -> Vec<f32> {
        match self.lambda[..] {
            [one] => vec![one; self.form.shrinkages()],
            _ => self.lambda.clone(),
        }
    }

    /// What the photographs are made into for this recipe.
    #[must_use]
    pub fn dataset(&self, psis: &[f64]) -> DatasetOptions {
        DatasetOptions {
            psis: psis.to_vec(),
            settings: Settings::default(),
            window: self.form.window,
            tone: self.tone,
            augmentation: self.augmentation,
            further_foci: self.further_foci.clone(),
        }
    }

    /// Whether the recipe can be followed with these data.
    ///
    /// # Errors
    /// As [`Recipe::check`].
    pub fn check_with(&self, dataset: &Dataset) -> Result<(), RecipeError> {
        self.check()?;
        if self.form.window != dataset.window() {
            return Err(value("window", self.form.window.side(), "the window that the photos were cut for"));
        }
        if self.form.exposures != dataset.exposures() {
            return Err(value("exposures", self.form.exposures, "those that the photos were blurred for"));
        }
        if self.tone != dataset.tone() {
            return Err(value("tone", self.tone, "the tone that the photos were read in"));
        }
        if self.structure == Structure::Symmetric && !dataset.is_transposable() {
            let expected = "free or blocks:SHARE behind a lens whose PSFs are not their own transposes";
            return Err(value("structure", self.structure, expected));
        }
        Ok(())
    }

    /// Whether the recipe can be followed with any data.
    ///
    /// # Errors
    /// [`RecipeError::Form`] or [`RecipeError::Value`].
    pub fn check(&self) -> Result<(), RecipeError> {
        self.form.check()?;
        if self.further_foci.len() + 1 != self.form.exposures {
            let found = self.further_foci.len();
            return Err(NetworkError::Foci { found, exposures: self.form.exposures }.into());
        }
        if let Some(expected) = self.structure.objection(&self.form) {
            return Err(value("structure", self.structure, expected));
        }
        if self.batch == 0 || !self.batch.is_multiple_of(SHARES) {
            return Err(value("batch", self.batch, "a positive multiple of 8"));
        }
        let counts = [
            ("steps", self.steps),
            ("validate every", self.validate_every),
            ("patience", self.patience.into()),
        ];
        for (field, number) in counts {
            if number == 0 {
                return Err(value(field, number, "1 or more"));
            }
        }
        let rates =
            [("rate", self.rate), ("output rate", self.output_rate), ("threshold rate", self.threshold_rate)];
        for (field, number) in rates {
            positive(field, number)?;
        }
        if !(0.0..1.0).contains(&self.averaging) {
            return Err(value("averaging", self.averaging, "0 or more, less than 1"));
        }
        self.check_conditions()?;
        self.check_sparsity()
    }

    fn check_conditions(&self) -> Result<(), RecipeError> {
        let Conditions { noise, gain, noiseless, exposure: [min, max], .. } = self.conditions;
        if noiseless == 0 {
            return Err(value("noiseless", 0, "1 or more"));
        }
        range("noise", noise, 0.0..=1.0, "0 to 1")?;
        range("gain", gain, 1.0..=4096.0, "1 to 4096")?;
        if !(min > 0.0 && min <= max && max <= 16.0) {
            return Err(value(
                "exposure",
                format!("{}:{}", words::number(min.into()), words::number(max.into())),
                "two factors in order, above 0 and up to 16",
            ));
        }
        Ok(())
    }

    fn check_sparsity(&self) -> Result<(), RecipeError> {
        let layers = self.form.shrinkages();
        let count = |field, found: usize| {
            Err(value(
                field,
                format!("with {}", words::count(found, "value")),
                format!("one for each of {}", words::count(layers, "shrinkage")),
            ))
        };
        if self.lambda.len() != 1 && self.lambda.len() != layers {
            return count("lambda", self.lambda.len());
        }
        if let Some(wrong) = self.lambda.iter().find(|l| !(0.0..=1.0).contains(*l)) {
            return Err(value("lambda", wrong, "0 to 1"));
        }
        let Some(Budget { non_zeros, rate }) = &self.budget else { return Ok(()) };
        if non_zeros.len() != layers {
            return count("non-zeros", non_zeros.len());
        }
        if let Some(wrong) = non_zeros.iter().find(|n| !(1.0..=self.form.codes as f32).contains(*n)) {
            return Err(value("non-zeros", wrong, format!("1 to {}", self.form.codes)));
        }
        positive("budget rate", *rate)
    }
}

/// Where λ of each shrinkage starts: near where budgets of networks with a linear path end (there the last shrinkage leaves little
/// more than detail, and must be charged more to leave less). Without a budget, as little as keeps codes from growing.
fn lambdas(form: &Form) -> Vec<f32> {
    if Budget::of_the_board(form).is_none() {
        return vec![1e-5];
    }
    let last = form.shrinkages() - 1;
    let of = |t| match t {
        _ if t == last => 9e-3,
        0 => 5e-5,
        _ => 2e-4,
    };
    (0..=last).map(of).collect()
}

/// A recipe that cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum RecipeError {
    /// The form is none.
    #[error(transparent)]
    Form(#[from] NetworkError),
    /// A number out of range.
    #[error("{field} {value}: must be {expected}")]
    Value { field: &'static str, value: String, expected: String },
    /// Weights became NaN or infinite.
    #[error("training diverged at step {step}: the loss is {loss}; lower --rate (now {rate})")]
    Diverged { step: u64, loss: f64, rate: f32 },
}

pub(crate) fn value(field: &'static str, found: impl ToString, expected: impl ToString) -> RecipeError {
    RecipeError::Value { field, value: found.to_string(), expected: expected.to_string() }
}

fn range(
    field: &'static str,
    [low, high]: [f32; 2],
    limits: std::ops::RangeInclusive<f32>,
    expected: &str,
) -> Result<(), RecipeError> {
    if let Some(wrong) = [low, high].into_iter().find(|end| !limits.contains::<f32>(end)) {
        return Err(value(field, wrong, expected));
    }
    if low > high { Err(value(field, format!("{low}:{high}"), "the lower end first")) } else { Ok(()) }
}

fn positive(field: &'static str, number: f32) -> Result<(), RecipeError> {
    if number.is_finite() && number > 0.0 { Ok(()) } else { Err(value(field, number, "a positive number")) }
}
