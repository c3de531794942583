//! Lens and network together: rounds of training for the lens as it is, then a step of the lens along the network's own gradient.
//!
//! At the network's optimum the derivative of the loss by the lens is that with the network held. So each round trains the network a little
//! for its lens, then carries the gradient of the PSNR back through network, mosaic and blur to the PSFs ([`Dataset::psf_gradient`]), and
//! from there to radii, phases and focus ([`mod@edof_optics::gradient`]).

use crate::dataset::{Batch, Dataset, DatasetError, DatasetOptions, Place};
use crate::recipe::{Recipe, RecipeError, value};
use crate::train::Trainer;
use edof_core::camera::Camera;
use edof_core::camera::{self, Delay, Ring, Sign};
use edof_core::colour::RGB_OUTPUTS;
use edof_core::{ColourFrame, Noise, Tone};
use edof_network::float::parameters::{Layout, flatten};
use edof_network::float::pass::{Pass, weighted_errors};
use edof_network::network::Network;
use edof_numerics::random::Random;
use edof_optics::gradient::{GradientError, parameters, psf_gradient};
use edof_optics::psf::{Settings, channel_psfs};
use ndarray::Array2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Narrowest ring, and narrowest gap between two, as shares of the radius.
const NARROWEST: f64 = 0.02;
/// Most rings that are that wide and that far apart.
const MAX_RINGS: usize = 25;
/// Largest steps of a radius, of a phase and of the focus at the start.
const STEPS: [f64; 3] = [0.012, 0.25, 0.2];
/// What a step is multiplied by after a lens that is better, and after one that is worse.
const LONGER: f64 = 1.2;
const SHORTER: f64 = 0.4;
/// dB by which a lens may be worse and count as better: its network has had one round.
const TOLERANCE: f64 = 0.02;
/// How PSFs are computed while a lens moves: smaller kernels than a network's data have, so that rounds are short.
const SETTINGS: Settings = Settings { energy: 0.99, wavelength_tolerance: 0.01, exact: false };
/// The first round's training, in rounds: the network comes from another lens.
const FIRST: u64 = 5;

/// How lens and network are searched together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Training of a round: its steps are the recipe's.
    pub recipe: Recipe,
    /// ψ of the search, spread over the camera's range.
    pub psis: Vec<f64>,
    /// Standard deviations of the noise at which the lens is judged.
    pub noises: Vec<f64>,
    /// Weight of the worst depth against the average over depths, 0…1.
    pub worst_weight: f64,
    /// Largest phase of a ring either way, in radians at the reference wavelength.
    pub max_phase: f64,
    /// Rounds.
    pub rounds: u32,
    /// Windows of each photograph, ψ and noise by which a round judges its lens.
    pub windows: usize,
    /// Threads.
    pub threads: usize,
}

/// Everything that changes while a search runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// Rounds done.
    pub round: u32,
    /// The lens of the next round.
    pub camera: Camera,
    /// The best lens so far; the next one is a step from it.
    pub best: Camera,
    /// Score of the best lens in dB.
    pub best_db: Option<f64>,
    /// The step from it for each parameter, at a length of 1.
    pub direction: Vec<f64>,
    /// Length of the next step.
    pub length: f64,
    /// The network's weights as they are.
    pub weights: Vec<f32>,
    /// Running means of the gradient and of its square, for each parameter.
    pub moments: Vec<[f64; 2]>,
    /// What was judged in each round, before its step.
    pub history: Vec<Judged>,
}

/// A lens of a search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Mean over noises of the score: dB on training windows, average over ψ and worst ψ weighed.
    pub score_db: f64,
    /// dB for each noise and ψ.
    pub psnr_db: Vec<Vec<f64>>,
    /// Values of the parameters, in the order of [`parameters`].
    pub lens: Vec<f64>,
    /// Derivatives of the score by them.
    pub gradient: Vec<f64>,
}

/// A search that cannot be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JointError {
    /// A recipe or number out of range.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Photographs that nothing can be learned from.
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    /// A lens without derivatives.
    #[error(transparent)]
    Lens(#[from] GradientError),
    /// More rings than are narrow enough.
    #[error(
        "camera {camera}: has {rings} rings, a search takes {MAX_RINGS} at most: it keeps rings and gaps {NARROWEST} of the radius wide or wider"
    )]
    Rings { camera: String, rings: usize },
}

impl Joint {
    /// # Errors
    /// [`JointError::Recipe`], naming the number that is out of range.
    pub fn check(&self) -> Result<(), JointError> {
        self.recipe.check()?;
        self.recipe.form.check_single().map_err(RecipeError::from)?;
        if self.recipe.tone != Tone::Linear {
            return Err(value(
                "tone",
                self.recipe.tone,
                "linear: the derivative by the lens is that of light",
            )
            .into());
        }
        let wrong = |field, found: f64, expected| Err(value(field, found, expected).into());
        if !(1..=10_000).contains(&self.rounds) {
            return wrong("rounds", self.rounds.into(), "1 to 10000");
        }
        if !(1..=10_000).contains(&self.windows) {
            return wrong("windows", self.windows as f64, "1 to 10000");
        }
        if !(0.0..=1.0).contains(&self.worst_weight) {
            return wrong("worst weight", self.worst_weight, "0 to 1");
        }
        if !(self.max_phase.is_finite() && self.max_phase > 0.0) {
            return wrong("max phase", self.max_phase, "a positive number of radians");
        }
        match self.noises.iter().find(|noise| !(0.0..=1.0).contains(*noise)) {
            Some(noise) => wrong("noise", *noise, "0 to 1"),
            None if self.noises.is_empty() => wrong("noise", f64::NAN, "one value at least"),
            None => Ok(()),
        }
    }

    /// A search that begins with this lens and network. The rings of its lenses are in the order of their radii.
    ///
    /// # Errors
    /// [`JointError`].
    pub fn begin(&self, camera: &Camera, network: &Network) -> Result<JointState, JointError> {
        self.check()?;
        edof_optics::gradient::check(camera)?;
        let rings = camera.mask.rings().count();
        if rings > MAX_RINGS {
            return Err(JointError::Rings { camera: camera.name.clone(), rings });
        }
        let camera = in_order(camera);
        if network.form != self.recipe.form {
            return Err(value("form", format!("{:?}", network.form), "the recipe's").into());
        }
        if network.origin.values != self.recipe.tone {
            return Err(value("values", network.origin.values, "linear: a network that takes light").into());
        }
        let count = parameters(&camera).len();
        Ok(JointState {
            round: 0,
            camera: camera.clone(),
            best: camera,
            best_db: None,
            direction: vec![0.0; count],
            length: 1.0,
            weights: flatten(network),
            moments: vec![[0.0; 2]; count],
            history: vec![],
        })
    }

    /// One round: blurs the photographs for the lens, trains the network, judges the lens and moves it. Nothing changes where `tell` ends
    /// the work; false then.
    ///
    /// # Errors
    /// [`JointError`].
    pub fn round(
        &self,
        photos: &[ColourFrame],
        state: &mut JointState,
        mut tell: impl FnMut() -> ControlFlow<()>,
    ) -> Result<bool, JointError> {
        let options = DatasetOptions { settings: SETTINGS, ..self.recipe.dataset(&self.psis) };
        let Some(dataset) = Dataset::new(photos, &state.camera, options, |_, _| tell())? else {
            return Ok(false);
        };
        let steps = self.recipe.steps * if state.round == 0 { FIRST } else { 1 };
        let seed = self.recipe.seed + u64::from(state.round);
        let recipe = Recipe { steps, seed, validate_every: steps, ..self.recipe.clone() };
        let mut trainer = Trainer::from_weights(recipe, &dataset, self.threads, state.weights.clone())?;
        let mut stopped = false;
        trainer.run(|_, _| {
            let flow = tell();
            stopped |= flow.is_break();
            flow
        })?;
        if stopped {
            return Ok(false);
        }
        let weights = trainer.state.best_weights;
        let judged = self.judge(&dataset, &state.camera, &weights)?;
        self.step(state, &judged);
        state.weights = weights;
        state.history.push(judged);
        state.round += 1;
        Ok(true)
    }

    /// Score of a lens through a network, and its derivatives.
    ///
    /// # Errors
    /// [`JointError`].
    pub fn judge(&self, dataset: &Dataset, camera: &Camera, weights: &[f32]) -> Result<Judged, JointError> {
        let side = |&psi: &f64| channel_psfs(camera, psi, &SETTINGS).map(|psfs| psfs.map(|psf| psf.side()));
        let sides: Vec<[usize; 3]> =
            self.psis.par_iter().map(side).collect::<Result<_, _>>().map_err(GradientError::from)?;
        let cells: Vec<(usize, usize)> =
            (0..self.noises.len()).flat_map(|n| (0..self.psis.len()).map(move |p| (n, p))).collect();
        let parts: Vec<Part> = cells
            .par_iter()
            .map(|&(noise, psi)| self.part(dataset, weights, noise, psi, sides[psi]))
            .collect();
        let psnr_db: Vec<Vec<f64>> =
            parts.chunks(self.psis.len()).map(|line| line.iter().map(|part| part.db).collect()).collect();
        let kernels: Vec<Vec<[Array2<f64>; 3]>> =
            self.psis.iter().map(|&psi| psf_gradient(camera, psi, &SETTINGS)).collect::<Result<_, _>>()?;
        let (mut score_db, mut gradient) = (0.0, vec![0.0; parameters(camera).len()]);
        for ((&(noise, psi), part), share) in cells.iter().zip(&parts).zip(self.shares(&psnr_db)) {
            debug_assert!(psnr_db[noise][psi] == part.db);
            score_db += share * part.db;
            for (sum, planes) in gradient.iter_mut().zip(&kernels[psi]) {
                let dots = planes
                    .iter()
                    .zip(&part.gradient)
                    .map(|(plane, by)| plane.iter().zip(by).map(|(p, g)| p * f64::from(*g)).sum::<f64>());
                *sum += share * dots.sum::<f64>();
            }
        }
        Ok(Judged { score_db, psnr_db, lens: values(camera), gradient })
    }

    /// What the dB of each noise and ψ weigh in the score.
    fn shares(&self, psnr_db: &[Vec<f64>]) -> Vec<f64> {
        let of_noise = |line: &Vec<f64>| {
            let worst = (0..line.len()).min_by(|&a, &b| line[a].total_cmp(&line[b]));
            let share = |psi: usize| {
                let worst = if Some(psi) == worst { self.worst_weight } else { 0.0 };
                ((1.0 - self.worst_weight) / line.len() as f64 + worst) / psnr_db.len() as f64
            };
            (0..line.len()).map(share).collect::<Vec<_>>()
        };
        psnr_db.iter().flat_map(of_noise).collect()
    }

    /// Mean dB over photographs at one noise and ψ, and its gradient for the three kernels.
    fn part(&self, dataset: &Dataset, weights: &[f32], noise: usize, psi: usize, sides: [usize; 3]) -> Part {
        let (form, windows) = (self.recipe.form, self.windows);
        let pixels = form.window.pixels();
        let mut part = Part { db: 0.0, gradient: sides.map(|side| vec![0.0; side * side]) };
        let (mut pass, mut batch) = (Pass::new(form, windows), Batch::new(form.inputs(), windows));
        let mut unused = vec![0.0; Layout::new(&form).len()];
        let mut inputs = vec![0.0; windows * pixels];
        let (mut errors, importance) = (vec![0.0; windows], vec![1.0; windows]);
        for photo in 0..dataset.photos() {
            let place = Place { photo, psi };
            // The same windows in every round.
            let mut random =
                Random::new(self.recipe.seed, u64::MAX - 2, ((photo << 16) | (noise << 8) | psi) as u64);
            let corners = dataset.draw_located(&mut random, place, noise_of(self.noises[noise]), &mut batch);
            pass.forward(weights, &batch.inputs, windows);
            let squared =
                2.0 * weighted_errors(pass.outputs_mut(), &batch.examples(&importance), &mut errors);
            let squared = squared.max(1e-12);
            part.db -= 10.0 * (squared / (windows * RGB_OUTPUTS) as f64).log10() / dataset.photos() as f64;
            // The gradient of half the squared error becomes that of dB.
            let scale = -20.0 / std::f64::consts::LN_10 / squared / dataset.photos() as f64;
            pass.backward(weights, &batch.inputs, windows, &[], &mut unused);
            pass.input_gradient(weights, windows, &mut inputs);
            for (input, gradient) in batch.inputs.iter().zip(&mut inputs) {
                // What a sensor clips does not move.
                *gradient *= if (0.0..=1.0).contains(input) && *input != 0.0 && *input != 1.0 {
                    scale as f32
                } else {
                    0.0
                };
            }
            for (corner, gradient) in corners.into_iter().zip(inputs.chunks_exact(pixels)) {
                dataset.psf_gradient(place, corner, gradient, sides, &mut part.gradient);
            }
        }
        part
    }

    /// Takes a lens that is better as the best one, else goes back to the best; then moves up that one's gradient. A parameter's step is in
    /// proportion to the running mean of its gradient over that of its size.
    fn step(&self, state: &mut JointState, judged: &Judged) {
        if state.best_db.is_none_or(|best| judged.score_db >= best - TOLERANCE) {
            if state.best_db.is_some() {
                state.length = (state.length * LONGER).min(1.0);
            }
            (state.best, state.best_db) = (state.camera.clone(), Some(judged.score_db));
            let accepted = state.moments.iter_mut().zip(&mut state.direction);
            for (((moments, step), largest), gradient) in
                accepted.zip(largest_steps(&state.best)).zip(&judged.gradient)
            {
                *step = largest * share(moments, *gradient);
            }
        } else {
            state.length *= SHORTER;
        }
        let moved = values(&state.best).into_iter().zip(&state.direction);
        let moved: Vec<f64> = moved.map(|(value, step)| value + state.length * step).collect();
        state.camera = with(&state.best, &moved, self.max_phase);
    }
}

/// Largest step of each parameter, in their order.
fn largest_steps(camera: &Camera) -> impl Iterator<Item = f64> {
    let step = |parameter| match parameter {
        camera::Parameter::Radius(_) => STEPS[0],
        camera::Parameter::Phase(_) => STEPS[1],
    };
    of_mask(camera).map(step).chain([STEPS[2]])
}

/// The parameters of the mask's terms, in their order. The focus follows.
fn of_mask(camera: &Camera) -> impl Iterator<Item = camera::Parameter> {
    camera.mask.terms().iter().flat_map(|term| term.parameters(camera.reference_wavelength_nm))
}

/// Takes a gradient into its running means, and returns its mean over its size, −1…1.
fn share([mean, square]: &mut [f64; 2], gradient: f64) -> f64 {
    if *square == 0.0 {
        (*mean, *square) = (gradient, gradient * gradient);
    }
    *mean = 0.5 * *mean + 0.5 * gradient;
    *square = 0.8 * *square + 0.2 * gradient * gradient;
    (*mean / square.sqrt().max(1e-9)).clamp(-1.0, 1.0)
}

/// dB at one noise and ψ, and its gradient for the kernels of red, green and blue.
struct Part {
    db: f64,
    gradient: [Vec<f32>; 3],
}

fn noise_of(sigma: f64) -> Noise {
    if sigma == 0.0 { Noise::None } else { Noise::gaussian(sigma) }
}

/// Values of a camera's parameters, in their order.
#[must_use]
pub fn values(camera: &Camera) -> Vec<f64> {
    of_mask(camera).map(camera::Parameter::value).chain([camera.focus_psi]).collect()
}

/// Returns the camera whose parameters have these values.
#[must_use]
pub fn with_values(camera: &Camera, mut values: &[f64]) -> Camera {
    let (mut camera, nm) = (camera.clone(), camera.reference_wavelength_nm);
    for term in camera.mask.terms_mut() {
        let (own, others) = values.split_at(term.parameters(nm).len());
        term.set(own, nm);
        values = others;
    }
    Camera { focus_psi: values[0], ..camera }
}

/// The same camera, its rings in the order of their radii: phases add, so the order of rings changes no light.
fn in_order(camera: &Camera) -> Camera {
    let (mut camera, nm) = (camera.clone(), camera.reference_wavelength_nm);
    let mut rings: Vec<Ring> = camera.mask.rings().copied().collect();
    rings.sort_by(|a, b| {
        let radii = a.inner.total_cmp(&b.inner).then(a.outer.total_cmp(&b.outer));
        radii.then(a.delay.phase_rad(nm).total_cmp(&b.delay.phase_rad(nm)))
    });
    camera.mask.rings_mut().zip(rings).for_each(|(to, ring)| *to = ring);
    camera
}

/// The camera of these values: radii apart, phases and focus within their ranges. Rings keep their order, so that each keeps the running
/// means of its gradients, and their kind of delay.
fn with(camera: &Camera, values: &[f64], max_phase: f64) -> Camera {
    let mut values = values.to_vec();
    for (value, parameter) in values.iter_mut().zip(of_mask(camera)) {
        if matches!(parameter, camera::Parameter::Phase(_)) {
            *value = value.clamp(-max_phase, max_phase);
        }
    }
    if let Some(focus) = values.last_mut() {
        *focus = focus.clamp(camera.psi_range[0], camera.psi_range[1]);
    }
    let mut from = 0.0f64;
    // Rings are the first terms of a mask.
    for (left, ring) in (0..camera.mask.rings().count()).rev().zip(values.chunks_exact_mut(3)) {
        let room = 2.0 * NARROWEST * left as f64;
        // Rounding may put the lower bound above the upper one: the ring is then as narrow as it may be.
        ring[0] = ring[0].min(1.0 - room - NARROWEST).max(from);
        ring[1] = ring[1].min(1.0 - room).max(ring[0] + NARROWEST).min(1.0);
        from = ring[1] + NARROWEST;
    }
    with_values(camera, &values)
}

/// A random start: N rings between radii and phases at random, and a focus within the range.
#[must_use]
pub fn random_lens(base: &Camera, rings: usize, max_phase: f64, seed: u64) -> Camera {
    let mut random = Random::new(seed, u64::MAX - 3, 0);
    let mut unit = || f64::from(random.unit());
    let mut radii: Vec<f64> = (0..2 * rings).map(|_| unit()).collect();
    radii.sort_by(f64::total_cmp);
    let mut values: Vec<f64> =
        radii.chunks(2).flat_map(|r| [r[0], r[1], max_phase * (2.0 * unit() - 1.0)]).collect();
    let [low, high] = base.psi_range;
    values.push(low + (high - low) * unit());
    let none = Ring { inner: 0.0, outer: 1.0, delay: Delay::Phase { rad: 0.0, at_nm: 1.0 } };
    let mask = vec![none; rings].into_iter().collect();
    let shape = Camera { mask, defocus_sign: Sign::Plus, ..base.clone() };
    with(&shape, &values, max_phase)
}
