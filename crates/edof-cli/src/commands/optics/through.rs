//! `edof optics design --through`: lens and network searched together.

use super::Design;
use crate::commands::train::photographs::{Photograph, leave_out, photographs};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{interrupt, said, weights};
use edof_core::camera::Camera;
use edof_core::storage::provenance::Input;
use edof_core::words::number;
use edof_core::{ColourFrame, Tone};
use edof_io::photos::Selection;
use edof_train::joint::{Joint, JointError, JointState, random_lens, with_values};
use edof_train::recipe::Recipe;
use edof_train::threads::check_threads;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Depths of the search, spread over the camera's range.
const DEPTHS: usize = 5;
/// λ of the rounds' training: without a budget, which short rounds could not follow.
const LAMBDA: f32 = 3e-5;

/// Options of `edof optics design` that only --through reads.
#[derive(clap::Args)]
#[command(next_help_heading = "Options of --through")]
pub(super) struct Options {
    /// Move mask and focus along the gradient of this network's PSNR, and train it on in each round: a preset such as edof-t4w12-outer or a weight file; --images and --photos name the photographs
    #[arg(long, value_name = "NETWORK", conflicts_with_all = ["population", "generations", "focus", "window"])]
    pub(super) through: Option<String>,

    /// Begin with --rings random rings and a random focus, by --seed [default: begin with --camera's mask and focus]
    #[arg(long, requires = "through")]
    random: bool,

    /// Rounds of training the network and moving the lens
    #[arg(long, default_value_t = 16, value_name = "N", requires = "through")]
    rounds: u32,

    /// Steps of training per round; the first round has five times as many
    #[arg(long, default_value_t = 300, value_name = "N", requires = "through")]
    steps: u64,

    /// Windows per photograph, depth and noise by which a round computes the gradient
    #[arg(long, default_value_t = 64, value_name = "N", requires = "through")]
    windows: usize,

    /// Photographs of the folder to use: train, all, or numbers as in 1,2 [default: all except the study's test photographs]
    #[arg(long, requires = "through")]
    photos: Option<Selection>,

    /// Photographs to exclude, by file name without extension
    #[arg(long, value_delimiter = ',', value_name = "NAME,…", requires = "through")]
    leave_out: Vec<String>,

    /// Threads of the training [default: all cores]
    #[arg(long, value_name = "N", requires = "through")]
    threads: Option<usize>,

    /// Continue from the checkpoint beside OUT that an interrupted search left
    #[arg(long, requires = "through")]
    resume: bool,
}

/// What a search depends on; a checkpoint of another one is rejected.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Run {
    joint: Joint,
    start: Camera,
    network: Input,
    photos: Vec<Input>,
}

#[derive(Serialize, Deserialize)]
struct Checkpoint {
    run: Run,
    state: JointState,
}

/// # Errors
/// A camera, network, photographs or options that cannot be used, a file that cannot be written, Ctrl-C.
pub(super) fn design(args: &Design, name: &str, ui: &Ui) -> Result<(), Error> {
    let options = &args.through;
    let file = checkpoint(&args.out);
    let files = Files::new(ui).reads(&args.camera).reads_all(weights::float_file(name));
    let files = args.images.iter().fold(files, Files::reads_pictures_of);
    files.writes("--out", &args.out).keeps(args.force).writes("checkpoint", &file).check()?;
    check_checkpoint(&file, options.resume)?;
    let start = args.start()?;
    ui.used(start.input());
    let network = weights::float(name)?;
    let recipe = Recipe::new(network.form);
    let recipe = Recipe {
        tone: Tone::Linear,
        budget: None,
        lambda: vec![LAMBDA],
        steps: options.steps,
        seed: args.seed,
        ..recipe
    };
    let joint = args.joint(recipe, start.psi_range);
    check_threads(joint.threads).map_err(said::recipe)?;
    let mut state = joint.begin(&start, &network).map_err(|error| words(error, &[]))?;
    let folders: Vec<PathBuf> = args.images.iter().cloned().collect();
    let mut chosen = photographs(&folders, options.photos.as_ref(), &|line| ui.note(line))?;
    leave_out(&mut chosen, &options.leave_out)?;
    let photos: Vec<Input> = chosen.iter().map(|p| Input::photograph(&p.name(), &p.frame)).collect();
    photos.iter().for_each(|photo| ui.used(photo.clone()));
    let run = Run { joint, start, network: weights::float_input(name)?, photos };
    if options.resume {
        state = load(&file, &run)?;
        keeps(&file, &state);
    }
    let begun = std::time::Instant::now();
    search(&run, &mut state, &chosen, &file, ui)?;
    let mut camera = state.best.clone();
    camera.name = args.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    camera.source = args.through_source(name, &run.start);
    edof_core::storage::atomic::write(&args.out, camera.to_json().as_bytes())?;
    let _ = std::fs::remove_file(&file);
    interrupt::keeps(None);
    tell(&camera, &run, &state, begun.elapsed().as_secs_f64(), args, ui)
}

/// Rounds until all are done, each with a checkpoint.
fn search(
    run: &Run,
    state: &mut JointState,
    chosen: &[Photograph],
    file: &Path,
    ui: &Ui,
) -> Result<(), Error> {
    let frames: Vec<ColourFrame> = chosen.iter().map(|p| p.frame.clone()).collect();
    let bar = ui.progress(run.joint.rounds.into(), "rounds");
    bar.set(state.round.into());
    while state.round < run.joint.rounds {
        let whole = run.joint.round(&frames, state, interrupt::flow).map_err(|error| words(error, chosen))?;
        if !whole {
            return Err(Error::Interrupted);
        }
        save(file, run, state)?;
        keeps(file, state);
        bar.set(state.round.into());
        if let Some(judged) = state.history.last() {
            let lens = lens_words(&with_values(&state.best, &judged.lens));
            bar.message(format!("{:.3} dB, lens {lens}", judged.score_db));
        }
    }
    Ok(())
}

fn keeps(file: &Path, state: &JointState) {
    let name = file.display();
    interrupt::keeps(Some(format!("{name}: checkpoint after round {}; continue with --resume", state.round)));
}

fn tell(
    camera: &Camera,
    run: &Run,
    state: &JointState,
    seconds: f64,
    args: &Design,
    ui: &Ui,
) -> Result<(), Error> {
    let first = state.history.first().map(|judged| judged.score_db);
    let [first, best] = [first, state.best_db].map(|db| db.unwrap_or(f64::NAN));
    ui.say(format!(
        "{} rounds in {seconds:.0} s: score {first:.2} dB in the first, {best:.2} dB in the best; the lens is in {}",
        state.round,
        args.out.display()
    ))?;
    ui.say(format!("  start {}", lens_words(&run.start)))?;
    ui.say(format!("  end   {}", lens_words(camera)))?;
    ui.json(&json!({
        "camera": camera,
        "start": run.start,
        "psi": run.joint.psis,
        "noise": run.joint.noises,
        "rounds": state.round,
        "score_db": state.best_db,
        "history": state.history,
        "photographs": run.photos,
        "seconds": seconds,
    }))
}

/// The terms that a search moves, then the focus.
fn lens_words(camera: &Camera) -> String {
    let nm = camera.reference_wavelength_nm;
    let moved = camera.mask.terms().iter().filter(|term| !term.parameters(nm).is_empty());
    let focus = format!("focus {:.3}", camera.focus_psi);
    moved.map(|term| term.summary(nm)).chain([focus]).collect::<Vec<_>>().join(", ")
}

fn words(error: JointError, chosen: &[Photograph]) -> Error {
    match error {
        JointError::Recipe(error) => said::recipe(error),
        JointError::Dataset(error) => said::dataset(error, |i| {
            chosen.get(i).map_or_else(String::new, |photo| photo.file.display().to_string())
        }),
        error @ (JointError::Lens(_) | JointError::Rings { .. }) => error.into(),
    }
}

fn checkpoint(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".search");
    name.into()
}

fn check_checkpoint(file: &Path, resume: bool) -> Result<(), Error> {
    match (file.exists(), resume) {
        (true, false) => Err(Error::message(format!(
            "{}: checkpoint of an unfinished search; continue it with --resume, or delete the file",
            file.display()
        ))),
        (false, true) => Err(Error::message(format!(
            "--resume: there is no checkpoint {}; leave --resume out to begin",
            file.display()
        ))),
        _ => Ok(()),
    }
}

fn save(file: &Path, run: &Run, state: &JointState) -> Result<(), Error> {
    let checkpoint = Checkpoint { run: run.clone(), state: state.clone() };
    let text = serde_json::to_string(&checkpoint).map_err(|error| said::of_file(file, error))?;
    Ok(edof_core::storage::atomic::write(file, text.as_bytes())?)
}

fn load(file: &Path, run: &Run) -> Result<JointState, Error> {
    let text = std::fs::read_to_string(file).map_err(|error| said::of_file(file, error))?;
    let found: Checkpoint = serde_json::from_str(&text).map_err(|error| {
        said::of_file(file, format!("not a checkpoint of a search ({error}); delete it to begin anew"))
    })?;
    let same = Run { joint: Joint { threads: run.joint.threads, ..found.run.joint.clone() }, ..found.run };
    if same == *run {
        return Ok(found.state);
    }
    Err(said::of_file(
        file,
        "checkpoint of another search; give the options, camera, network and photographs of that one, or delete it",
    ))
}

impl Design {
    /// The lens that the search begins with.
    fn start(&self) -> Result<Camera, Error> {
        let base = self.base()?;
        if !self.through.random {
            return Ok(base);
        }
        if self.rings > 3 {
            return Err(Error::message(format!("--rings {}: must be 0 to 3 with --through", self.rings)));
        }
        Ok(random_lens(&base, self.rings, self.max_phase, self.seed))
    }

    fn joint(&self, recipe: Recipe, [low, high]: [f64; 2]) -> Joint {
        let at = |i: usize| low + (high - low) * i as f64 / (DEPTHS - 1) as f64;
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Joint {
            recipe,
            psis: (0..DEPTHS).map(at).collect(),
            noises: self.noise.clone(),
            worst_weight: self.worst_weight,
            max_phase: self.max_phase,
            rounds: self.through.rounds,
            windows: self.through.windows,
            threads: self.through.threads.unwrap_or_else(cores),
        }
    }

    fn through_source(&self, network: &str, start: &Camera) -> String {
        let noise = self.noise.iter().map(|sigma| number(*sigma)).collect::<Vec<_>>().join(",");
        let random =
            if self.through.random { format!(" --random --rings {}", self.rings) } else { String::new() };
        format!(
            "edof optics design --through {network} --camera {}{random} --rounds {} --steps {} --worst-weight {} --noise {noise} --seed {}: \
             from {}, along the network's gradient",
            self.camera,
            self.through.rounds,
            self.through.steps,
            self.worst_weight,
            self.seed,
            lens_words(start)
        )
    }
}
