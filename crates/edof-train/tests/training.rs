//! Training as a whole: it learns, it is reproducible, it resumes, with any number of threads.

use edof_core::camera::Camera;
use edof_core::storage::provenance::{Input, Provenance};
use edof_core::{ColourFrame, Tone, Window};
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_numerics::random::Random;
use edof_train::augment::Augmentation;
use edof_train::budget::Budget;
use edof_train::checkpoint::{self, CheckpointError, Run};
use edof_train::dataset::Dataset;
use edof_train::initial::Start;
use edof_train::noise::Conditions;
use edof_train::recipe::{Recipe, RecipeError, Trained};
use edof_train::train::{State, Trainer};
use ndarray::{Array2, s};
use std::ops::ControlFlow;

const PSIS: [f64; 2] = [0.0, 4.0];

/// Overlapping discs of random colours: edges at every place and angle.
fn discs() -> ColourFrame {
    drawn(11)
}

fn drawn(seed: u64) -> ColourFrame {
    let mut random = Random::new(seed, 0, 0);
    let mut photo = ColourFrame::zeros(256, 256);
    for _ in 0..400 {
        let at = [random.unit() * 256.0, random.unit() * 256.0];
        let (radius, colour) = (3.0 + 20.0 * random.unit(), [random.unit(), random.unit(), random.unit()]);
        let near = at.map(|at| (at - radius).max(0.0) as usize..((at + radius) as usize + 2).min(256));
        for ((plane, row, column), v) in
            photo.planes.slice_mut(s![.., near[0].clone(), near[1].clone()]).indexed_iter_mut()
        {
            if ((row + near[0].start) as f32 - at[0]).hypot((column + near[1].start) as f32 - at[1]) < radius
            {
                *v = colour[plane];
            }
        }
    }
    photo
}

fn dataset(recipe: &Recipe) -> Dataset {
    of(&[discs()], recipe)
}

fn of(photos: &[ColourFrame], recipe: &Recipe) -> Dataset {
    let camera = Camera::resolve("clear").unwrap();
    Dataset::new(photos, &camera, recipe.dataset(&PSIS), |_, _| ControlFlow::Continue(())).unwrap().unwrap()
}

fn recipe(shrinkage: Shrinkage) -> Recipe {
    let form = Form {
        window: Window::new(8).unwrap(),
        codes: 48,
        layers: 4,
        shrinkage,
        recurrence: Recurrence::Direct,
        linear_path: shrinkage == Shrinkage::OneSided,
        tied: false,
        exposures: 1,
    };
    let augmentation = Augmentation { variants: 2, saturation: [0.8, 1.2], hue: 20.0, scale: 0.9 };
    let (lambda, budget) = (vec![3e-5], None);
    Recipe {
        batch: 256,
        steps: 600,
        validate_every: 200,
        augmentation,
        lambda,
        budget,
        tone: Tone::Linear,
        ..Recipe::new(form)
    }
}

fn run_to(trainer: &mut Trainer<'_>, step: u64) -> State {
    trainer
        .run(|t, _| if t.state.step >= step { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        .unwrap();
    trainer.state.clone()
}

/// Steps enough to gain in.
const GAINS: u64 = 1000;

/// A schedule of as many, on the photograph as it is.
fn long(recipe: Recipe) -> Recipe {
    let (conditions, augmentation) = (Conditions::plain(0.015), Augmentation::NONE);
    Recipe {
        steps: GAINS,
        batch: 128,
        rate: 5e-3,
        validate_every: GAINS / 2,
        conditions,
        augmentation,
        ..recipe
    }
}

/// Gain in dB over the start, on windows that training has not seen, of photographs enough not to learn by heart.
fn gain(recipe: Recipe) -> f64 {
    let dataset = &of(&[1, 2, 3, 4].map(drawn), &recipe);
    let mut trainer = Trainer::new(recipe, dataset, 2).unwrap();
    let before = trainer.validate().db();
    run_to(&mut trainer, GAINS);
    trainer.state.best.db - before
}

#[test]
fn training_gains_over_its_start_for_both_shrinkages_and_both_starts() {
    let (one, two) = (Shrinkage::OneSided, Shrinkage::TwoSided);
    for (shrinkage, start) in [(one, Start::Whitened), (two, Start::Dictionary)] {
        let gain = gain(Recipe { start, ..long(recipe(shrinkage)) });
        assert!(gain > 0.05, "{shrinkage:?} {start:?}: grew by {gain} dB");
    }
}

/// A recipe for two exposures, the second at a focus of its own.
fn double() -> Recipe {
    let single = long(recipe(Shrinkage::OneSided));
    Recipe { form: Form { exposures: 2, ..single.form }, further_foci: vec![4.0], ..single }
}

#[test]
fn a_network_of_two_exposures_learns_from_both_and_states_its_foci() {
    let recipe = double();
    let dataset = &of(&[1, 2, 3, 4].map(drawn), &recipe);
    let mut trainer = Trainer::new(recipe.clone(), dataset, 2).unwrap();
    run_to(&mut trainer, GAINS);
    let single =
        Recipe { form: Form { exposures: 1, ..recipe.form }, further_foci: vec![], ..recipe.clone() };
    let blurred = &of(&[1, 2, 3, 4].map(drawn), &single);
    let mut alone = Trainer::new(single.clone(), blurred, 2).unwrap();
    run_to(&mut alone, GAINS);
    // Without the noise of shorter times, a second frame that is sharp where the first is not must help.
    let gain = trainer.state.best.db - alone.state.best.db;
    assert!(gain > 0.2, "two exposures gain {gain} dB over one");
    let network = trainer.best("double", &Camera::resolve("clear").unwrap(), Provenance::default());
    network.check().unwrap();
    assert_eq!(network.origin.further_foci, [4.0]);
    let told = |recipe: Recipe, dataset| Trainer::new(recipe, dataset, 2).unwrap_err().to_string();
    assert_eq!(told(recipe, blurred), "exposures 2: must be those that the photos were blurred for");
    let unfocused = Recipe { form: Form { exposures: 2, ..single.form }, ..single };
    assert_eq!(told(unfocused, blurred), "further_foci: 0 given, a form of exposures 2 has 1");
}

#[test]
fn a_run_from_a_network_begins_as_good_as_that_network_and_gets_better() {
    let recipe = Recipe { budget: None, ..long(recipe(Shrinkage::OneSided)) };
    let dataset = &of(&[1, 2, 3, 4].map(drawn), &recipe);
    let mut first = Trainer::new(recipe.clone(), dataset, 2).unwrap();
    run_to(&mut first, GAINS);
    let camera = Camera::resolve("clear").unwrap();
    let network = first.best("first", &camera, Provenance::default());
    let mut second = Trainer::from_network(recipe.clone(), dataset, 2, &network).unwrap();
    // Training coordinates and back are float arithmetic.
    assert!((second.validate().db() - first.state.best.db).abs() < 1e-3);
    run_to(&mut second, GAINS);
    let gain = second.state.best.db - first.state.best.db;
    assert!(gain > 0.05, "grew by {gain} dB");
    let other = Recipe { form: Form { codes: 32, ..recipe.form }, ..recipe };
    let refused = Trainer::from_network(other, dataset, 2, &network).unwrap_err().to_string();
    assert!(refused.starts_with("form ") && refused.ends_with("must be the recipe's"), "{refused}");
}

#[test]
fn thresholds_alone_are_trained_for_another_noise_and_every_other_weight_stays() {
    let first_recipe = Recipe { budget: None, ..long(recipe(Shrinkage::OneSided)) };
    let dataset = &of(&[1, 2, 3, 4].map(drawn), &first_recipe);
    let mut first = Trainer::new(first_recipe.clone(), dataset, 2).unwrap();
    run_to(&mut first, GAINS);
    let camera = Camera::resolve("clear").unwrap();
    let network = first.best("first", &camera, Provenance::default());
    let conditions = Conditions { noise: [0.04, 0.06], ..first_recipe.conditions };
    let recipe = Recipe { trained: Trained::Thresholds, conditions, threshold_rate: 1.0, ..first_recipe };
    let mut second = Trainer::from_network(recipe, dataset, 2, &network).unwrap();
    let before = second.validate().db();
    run_to(&mut second, GAINS);
    let cheap = second.best("second", &camera, Provenance::default());
    assert!(second.state.best.db > before, "{before} dB to {} dB", second.state.best.db);
    assert_ne!(cheap.thresholds, network.thresholds);
    let bits = |matrix: &Array2<f32>| matrix.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    // Training coordinates and back are float arithmetic, so that A and R may differ by rounding.
    let near = |a: &Array2<f32>, b: &Array2<f32>| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
    assert_eq!(bits(&cheap.dictionary), bits(&network.dictionary));
    assert_eq!(bits(&cheap.recurrent[0]), bits(&network.recurrent[0]));
    assert!(near(&cheap.analysis, &network.analysis));
}

#[test]
fn the_running_mean_of_the_weights_is_smoother_than_the_weights_and_no_worse() {
    let of = |averaging| gain(Recipe { averaging, ..long(recipe(Shrinkage::OneSided)) });
    let (mean, last) = (of(0.98), of(0.0));
    assert!(mean > last - 0.05, "{mean} dB, {last} dB without averaging");
    assert_ne!(mean.to_bits(), last.to_bits());
}

#[test]
fn training_gains_in_either_tone() {
    for tone in Tone::ALL {
        let recipe = Recipe {
            tone,
            steps: GAINS,
            batch: 128,
            rate: 5e-3,
            validate_every: GAINS / 2,
            ..recipe(Shrinkage::OneSided)
        };
        let gain = gain(recipe);
        assert!(gain > 0.05, "{tone}: grew by {gain} dB");
    }
}

#[test]
fn lambda_moves_until_the_budget_is_nearly_met() {
    const TARGET: f64 = 18.0;
    let budget = Some(Budget { non_zeros: vec![TARGET as f32; 3], rate: 0.02 });
    let conditions = Conditions::plain(0.015);
    let recipe =
        Recipe { steps: 2000, validate_every: 2000, budget, conditions, ..recipe(Shrinkage::OneSided) };
    let dataset = dataset(&recipe);
    let mut trainer = Trainer::new(recipe, &dataset, 2).unwrap();
    let excess =
        |trainer: &Trainer<'_>| trainer.validate().busy_non_zeros().into_iter().map(|n| n - TARGET).collect();
    let before: Vec<f64> = excess(&trainer);
    run_to(&mut trainer, 2000);
    let after: Vec<f64> = excess(&trainer);
    for (after, before) in after.iter().zip(before) {
        assert!(before > 3.0 && after.abs() < 0.5 * before, "{before} over the target became {after}");
    }
}

fn run_of(recipe: &Recipe, photo: &ColourFrame, name: &str) -> Run {
    let photos = vec![Input::photograph(name, photo)];
    Run { recipe: recipe.clone(), camera: "clear".into(), photos, psis: PSIS.to_vec(), from: None }
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads_and_after_a_break() {
    let budget = Some(Budget { non_zeros: vec![10.0; 3], rate: 0.01 });
    let recipe = Recipe { budget, tone: Tone::Srgb, ..recipe(Shrinkage::OneSided) };
    let dataset = dataset(&recipe);
    let whole = run_to(&mut Trainer::new(recipe.clone(), &dataset, 1).unwrap(), 400);
    let half = run_to(&mut Trainer::new(recipe.clone(), &dataset, 3).unwrap(), 200);
    let run = run_of(&recipe, &discs(), "discs");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    checkpoint::save(&path, &run, &half).unwrap();
    let loaded = checkpoint::load(&path, &run).unwrap();
    assert_eq!(loaded, half);
    let resumed = run_to(&mut Trainer::resume(recipe, &dataset, 8, loaded).unwrap(), 400);
    assert_eq!(resumed, whole);
    assert_ne!(whole.steering.lambdas, half.steering.lambdas);
}

#[test]
fn a_checkpoint_of_another_run_is_rejected_naming_what_differs() {
    let recipe = recipe(Shrinkage::OneSided);
    let state = Trainer::new(recipe.clone(), &dataset(&recipe), 1).unwrap().state;
    let mut photo = discs();
    let run = run_of(&recipe, &photo, "x");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    checkpoint::save(&path, &run, &state).unwrap();
    let refused = |run: &Run| checkpoint::load(&path, run).unwrap_err().to_string();
    let told = refused(&run_of(&recipe, &photo, "y"));
    assert!(told.contains(r#"made with photos[0].name "x", cannot be resumed with "y""#), "{told}");
    photo.planes[(0, 5, 5)] += 0.01;
    assert!(
        refused(&run_of(&recipe, &photo, "x")).contains("made with photos[0].sha256 \""),
        "another photo of that name"
    );
    let longer = Recipe { steps: 700, ..recipe };
    let told = refused(&Run { recipe: longer, ..run.clone() });
    assert!(told.ends_with(
        "made with steps 600, cannot be resumed with 700; give the options of that run, or begin anew with another --out"
    ), "{told}");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert!(matches!(checkpoint::load(&path, &run), Err(CheckpointError::Foreign { .. })));
}

#[test]
fn recipes_that_cannot_be_followed_are_rejected() {
    let dataset = dataset(&recipe(Shrinkage::OneSided));
    let refuse = |change: &dyn Fn(&mut Recipe)| {
        let mut recipe = recipe(Shrinkage::OneSided);
        change(&mut recipe);
        Trainer::new(recipe, &dataset, 2).unwrap_err().to_string()
    };
    assert_eq!(refuse(&|r| r.batch = 255), "batch 255: must be a positive multiple of 8");
    assert_eq!(refuse(&|r| r.rate = f32::NAN), "rate NaN: must be a positive number");
    assert_eq!(refuse(&|r| r.form.layers = 11), "layers 11: must be 2 to 10");
    assert_eq!(
        refuse(&|r| r.conditions.exposure = [0.0, 1.0]),
        "exposure 0:1: must be two factors in order, above 0 and up to 16"
    );
    assert_eq!(refuse(&|r| r.conditions.gain = [0.5, 2.0]), "gain 0.5: must be 1 to 4096");
    assert_eq!(refuse(&|r| r.conditions.noise = [0.0, 1.5]), "noise 1.5: must be 0 to 1");
    assert_eq!(
        refuse(&|r| r.conditions.noise = [0.02, 0.01]),
        "noise 0.02:0.01: must be the lower end first"
    );
    assert_eq!(refuse(&|r| r.averaging = 1.0), "averaging 1: must be 0 or more, less than 1");
    assert_eq!(
        refuse(&|r| r.lambda = vec![0.0; 2]),
        "lambda with 2 values: must be one for each of 3 shrinkages"
    );
    let budget = |non_zeros: &[f32]| Some(Budget { non_zeros: non_zeros.to_vec(), rate: 1.0 });
    assert_eq!(refuse(&|r| r.budget = budget(&[9.0, 9.0, 0.0])), "non-zeros 0: must be 1 to 48");
    assert_eq!(refuse(&|r| r.tone = Tone::Srgb), "tone srgb: must be the tone that the photos were read in");
    let other = refuse(&|r| r.form.window = Window::new(12).unwrap());
    assert_eq!(other, "window 12: must be the window that the photos were cut for");
    let threads = Trainer::new(recipe(Shrinkage::OneSided), &dataset, 0).unwrap_err();
    assert_eq!(threads.to_string(), "threads 0: must be 1 to 256");
}

#[test]
fn a_rate_far_too_high_is_reported_as_divergence() {
    let recipe = Recipe { rate: 1e30, ..recipe(Shrinkage::OneSided) };
    let dataset = dataset(&recipe);
    let error = Trainer::new(recipe, &dataset, 1).unwrap().run(|_, _| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(error, RecipeError::Diverged { .. }), "{error}");
}
