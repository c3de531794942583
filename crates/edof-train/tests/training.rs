//! Training as a whole: it learns, it repeats, it goes on where it was stopped.

use edof_optics::psf::Settings;
use edof_spec::network::{Form, Recurrence, Shrinkage};
use edof_spec::{Camera, ColourFrame, Window};
use edof_train::checkpoint::{self, CheckpointError, Run};
use edof_train::initial::Start;
use edof_train::patches::{Bank, Random};
use edof_train::train::{Continue, Recipe, RecipeError, State, Trainer};

const PSIS: [f64; 2] = [0.0, 4.0];

fn bank(window: usize) -> Bank {
    // Overlapping discs of random colours: edges at every place and angle.
    let mut random = Random::new(11, 0, 0);
    let mut photo = ColourFrame::zeros(256, 256);
    for _ in 0..400 {
        let at = [random.unit() * 256.0, random.unit() * 256.0];
        let (radius, colour) = (3.0 + 20.0 * random.unit(), [random.unit(), random.unit(), random.unit()]);
        for ((plane, row, column), v) in photo.planes.indexed_iter_mut() {
            if (row as f32 - at[0]).hypot(column as f32 - at[1]) < radius {
                *v = colour[plane];
            }
        }
    }
    let camera = Camera::resolve("clear").unwrap();
    let window = Window::new(window).unwrap();
    Bank::new(&[photo], &camera, &PSIS, &Settings::default(), window, |_, _| true).unwrap().unwrap()
}

fn recipe(shrinkage: Shrinkage, threads: usize) -> Recipe {
    let form = Form {
        window: Window::new(8).unwrap(),
        codes: 48,
        layers: 4,
        shrinkage,
        recurrence: Recurrence::Direct,
        linear_path: shrinkage == Shrinkage::OneSided,
        tied: false,
    };
    Recipe { batch: 256, steps: 600, validate_every: 200, threads, ..Recipe::new(form) }
}

fn run_to(trainer: &mut Trainer<'_>, step: u64) -> State {
    trainer.run(|t, _| if t.state.step >= step { Continue::No } else { Continue::Yes }).unwrap();
    trainer.state.clone()
}

#[test]
fn training_gains_over_its_start_for_both_shrinkages_and_both_starts() {
    let bank = bank(8);
    let longer = |recipe| Recipe { steps: 1500, rate: 5e-3, validate_every: 500, ..recipe };
    for shrinkage in [Shrinkage::OneSided, Shrinkage::TwoSided] {
        for start in [Start::Whitened, Start::Dictionary] {
            let mut trainer = Trainer::new(longer(Recipe { start, ..recipe(shrinkage, 2) }), &bank).unwrap();
            let before = trainer.validate().0;
            run_to(&mut trainer, 1500);
            let gain = trainer.state.best_db - before;
            assert!(gain > 0.2, "{shrinkage:?} {start:?}: {before} dB grew by {gain}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_and_a_resumed_run_ends_like_an_unbroken_one() {
    let bank = bank(8);
    let recipe = recipe(Shrinkage::OneSided, 2);
    let whole = run_to(&mut Trainer::new(recipe.clone(), &bank).unwrap(), 400);
    let half = run_to(&mut Trainer::new(recipe.clone(), &bank).unwrap(), 200);
    let run = Run {
        recipe: recipe.clone(),
        camera: "clear".into(),
        photos: vec!["discs".into()],
        psis: PSIS.to_vec(),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    checkpoint::save(&path, &run, &half).unwrap();
    let loaded = checkpoint::load(&path, &run).unwrap();
    assert_eq!(loaded, half);
    let resumed = run_to(&mut Trainer::resume(recipe, &bank, loaded).unwrap(), 400);
    assert_eq!(resumed, whole);
}

#[test]
fn a_checkpoint_of_another_run_is_refused_naming_what_differs() {
    let bank = bank(8);
    let recipe = recipe(Shrinkage::OneSided, 1);
    let state = Trainer::new(recipe.clone(), &bank).unwrap().state;
    let run = Run { recipe, camera: "a".into(), photos: vec!["x".into()], psis: vec![0.0] };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    checkpoint::save(&path, &run, &state).unwrap();
    let other = Run { photos: vec!["y".into()], ..run.clone() };
    let error = checkpoint::load(&path, &other).unwrap_err().to_string();
    assert!(error.ends_with(r#"made with photos ["x"], asked to go on with ["y"]"#), "{error}");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert!(matches!(checkpoint::load(&path, &run), Err(CheckpointError::Foreign { .. })));
}

#[test]
fn recipes_that_cannot_be_followed_are_refused() {
    let bank = bank(8);
    let refuse = |change: &dyn Fn(&mut Recipe)| {
        let mut recipe = recipe(Shrinkage::OneSided, 2);
        change(&mut recipe);
        Trainer::new(recipe, &bank).unwrap_err().to_string()
    };
    assert_eq!(refuse(&|r| r.batch = 255), "batch 255: must be a positive multiple of the threads");
    assert_eq!(refuse(&|r| r.threads = 0), "threads 0: must be 1 to 256");
    assert_eq!(refuse(&|r| r.rate = f32::NAN), "rate NaN: must be a positive number");
    assert_eq!(refuse(&|r| r.form.layers = 11), "layers 11: must be 2 to 10");
    let other = refuse(&|r| r.form.window = Window::new(12).unwrap());
    assert_eq!(other, "window 12: must be the window that the photos were cut for");
}

#[test]
fn a_rate_far_too_high_is_reported_as_divergence() {
    let bank = bank(8);
    let recipe = Recipe { rate: 1e30, ..recipe(Shrinkage::OneSided, 1) };
    let error = Trainer::new(recipe, &bank).unwrap().run(|_, _| Continue::Yes).unwrap_err();
    assert!(matches!(error, RecipeError::Diverged { .. }), "{error}");
}
