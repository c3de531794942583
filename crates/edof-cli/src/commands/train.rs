//! `edof train`: a float network from photographs.

use crate::error::Error;
use crate::files::{Files, Force};
use crate::lens::{self, Depth, DepthRange, Lens};
use crate::ui::Ui;
use crate::{form, interrupt, memory, said, weights};
use edof_camera::Camera;
use edof_image::words::count;
use edof_image::{ColourFrame, Tone};
use edof_io::photo;
use edof_network::network::{Form, Network};
use edof_network::weight_file;
use edof_storage::provenance::{Input, Provenance};
use edof_study::photos::{self, Selection};
use edof_train::budget::Budget;
use edof_train::checkpoint::{self, Run};
use edof_train::dataset::Dataset;
use edof_train::initial::Start;
use edof_train::recipe::Recipe;
use edof_train::train::{Best, Continue, Progress, Trainer, check_threads};
use edof_train::validation::Validation;
use edof_train::weighting::Weighting;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A checkpoint comes this often.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);
/// Name that the photographs of the study's test set begin with; they are never trained on unless asked for.
const STUDY_PREFIX: &str = "kodim";

/// Train a float network on photographs seen through a camera
///
/// Without options this is the one recipe by which scripts/weights.sh makes the program's networks. A block of a quarter of
/// each side of every photograph is kept for validation, and training stays as far away from it as the blur reaches. A
/// checkpoint is written beside OUT every minute and when Ctrl-C stops the run; --resume goes on from it and ends with the
/// same bytes as a run that was never stopped. The same seed and options give the same bytes, whatever --threads.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof train --form edof-t4w12 --camera ring-outer --images photos/ --out weights/mine.safetensors
  edof train --form two-sided,w8,t4 --camera ring-2018 --images photos/ --steps 8000 --out quick.safetensors
  edof train --form edof-t4w12 --camera ring-outer --tone both --non-zeros 65,65,58 --seed 1,2,3 --out mine.safetensors
  edof train --form edof-t4w12 --camera ring-outer --images photos/ --out weights/mine.safetensors --resume
  edof train --from edof-t4w12-outer --camera my-lens.json --steps 10000 --out weights/mine.safetensors")]
pub struct Args {
    /// The network's form: paper-t4, edof-t4w12, or words as in one-sided,w12,t4,c192,r
    #[arg(long, value_parser = form::parse, long_help = form::HELP, required_unless_present = "from")]
    form: Option<Form>,

    /// Camera: a preset such as ring-outer, or a JSON file
    #[arg(long)]
    camera: String,

    /// PSFs of one's own in place of the camera's: an NPZ or safetensors file with the arrays psi and psf (docs/your-own-lens.md)
    #[arg(long, value_name = "FILE")]
    psf_bank: Option<PathBuf>,

    /// Folder of photographs; may be given several times [default: $EDOF_KODAK and $EDOF_MORE, else the study's and those
    /// in shared/data/more beside it]
    #[arg(long, value_name = "DIR")]
    images: Vec<PathBuf>,

    /// Which of them: train, all, or numbers as in 1,2 [default: all but the study's test photos]
    #[arg(long)]
    photos: Option<Selection>,

    /// Photographs to leave out of these, by file name without ending; networks can then be judged on them
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    leave_out: Vec<String>,

    /// Weight file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Name of the network [default: OUT without its ending]
    #[arg(long)]
    name: Option<String>,

    /// Values of ψ, spread evenly over the camera's range
    #[arg(long, default_value_t = 9)]
    depths: usize,

    /// Range of ψ, where it is not the camera's, as in 0:8; or distances as in 0.7m:3m before a camera that knows its nominal_m
    #[arg(long, value_name = "LOW:HIGH", value_parser = depths, allow_hyphen_values = true)]
    psi: Option<DepthRange>,

    /// What a photograph's values are: linear (the paper's: light itself), srgb (codes of light, noise as a sensor has it,
    /// errors measured on codes), or both, half of the windows each
    #[arg(long, value_parser = ["linear", "srgb", "both"])]
    tone: Option<String>,

    /// Largest noise σ of linear windows, in units of full scale; what has seen none loses 6 to 11 dB to σ 0.01 (docs/stability.md)
    #[arg(long)]
    noise: Option<f32>,

    /// Largest gain of the sensor behind srgb windows; 1 is base sensitivity
    #[arg(long)]
    gain: Option<f32>,

    /// One window in so many has no noise at all
    #[arg(long)]
    noiseless: Option<usize>,

    /// Factor on the light of each window, least and most; 1:1 leaves it as it is
    #[arg(long, value_name = "LOW:HIGH", value_parser = range)]
    exposure: Option<[f64; 2]>,

    /// Pictures of each photograph: itself, and others of drawn saturation, hue and scale; 1 for itself alone
    #[arg(long)]
    variants: Option<usize>,

    /// Saturation of the drawn pictures, least and most; 1:1 leaves it as it is
    #[arg(long, value_name = "LOW:HIGH", value_parser = range)]
    saturation: Option<[f64; 2]>,

    /// Hue of the drawn pictures is turned by up to so many degrees; 0 leaves it as it is
    #[arg(long, value_name = "DEGREES")]
    hue: Option<f32>,

    /// Smallest of the drawn pictures, as a share of the photograph's sides; 1 leaves them as they are
    #[arg(long)]
    scale: Option<f32>,

    /// What easy and hard windows weigh: psnr trains the mean PSNR, mse the mean square error, root lies between
    #[arg(long, value_parser = ["psnr", "root", "mse"])]
    weighting: Option<String>,

    /// Steps of the whole schedule
    #[arg(long)]
    steps: Option<u64>,

    /// Stop after so many minutes, wherever the schedule is
    #[arg(long, value_parser = minutes)]
    minutes: Option<Duration>,

    /// Windows a step; a multiple of 8
    #[arg(long)]
    batch: Option<usize>,

    /// Adam's largest rate
    #[arg(long)]
    rate: Option<f32>,

    /// Rate of D and R, relative to --rate
    #[arg(long)]
    output_rate: Option<f32>,

    /// Rate of the thresholds, relative to --rate
    #[arg(long)]
    threshold_rate: Option<f32>,

    /// What a unit of |z| costs, one number or one for each shrinkage as in 3e-4,3e-4,1e-3: larger gives fewer non-zeros
    #[arg(long, value_delimiter = ',')]
    lambda: Vec<f32>,

    /// Mean non-zeros of each shrinkage on busy windows that λ, now only where it starts, is moved to reach, as in 65,65,58;
    /// none: λ stays
    #[arg(long, value_name = "N,N,…|none")]
    non_zeros: Option<String>,

    /// How fast λ moves toward --non-zeros: at most this share of itself a step
    #[arg(long)]
    budget_rate: Option<f32>,

    /// Go on from a trained network's weights, by name or file, with a new schedule; its form is taken where --form is not given
    #[arg(long, value_name = "NETWORK", conflicts_with = "start")]
    from: Option<String>,

    /// Where to start: whitened inputs, or the paper's ISTA with a learned dictionary
    #[arg(long, value_parser = ["whitened", "dictionary"])]
    start: Option<String>,

    /// Seed of everything random; of several, as in 1,2,3, the network that validates best is written
    #[arg(long, value_delimiter = ',')]
    seed: Vec<u64>,

    /// Threads [default: one for each core, 8 at most: more are of no use]
    #[arg(long)]
    threads: Option<usize>,

    /// Steps between validations
    #[arg(long)]
    validate_every: Option<u64>,

    /// Validations without a better one after which training stops
    #[arg(long)]
    patience: Option<u32>,

    /// Go on from the checkpoints beside OUT, of which there must be one
    #[arg(long)]
    resume: bool,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// Photographs, options or a checkpoint that cannot be used, a file that cannot be written, or Ctrl-C.
pub fn run(args: &Args, ui: &Ui) -> Result<(), Error> {
    let from = args.from.as_deref().map(Beginning::load).transpose()?;
    let recipes = recipes(args, from.as_ref())?;
    let seeds: Vec<(Recipe, PathBuf)> =
        recipes.into_iter().map(|recipe| (recipe.clone(), checkpoint_file(args, recipe.seed))).collect();
    let Lens { mut camera, files } = lens::resolve(&args.camera, args.psf_bank.as_deref())?;
    let files = Files::new(ui).reads_all(files).reads_all(args.from.as_deref().and_then(weights::float_file));
    let files = args.images.iter().fold(files, Files::reads_pictures_of).writes("--out", &args.out);
    checkpoints(args, &seeds)?;
    let files = files.keeps(args.force);
    seeds.iter().fold(files, |files, (_, file)| files.writes("checkpoint", file)).check()?;
    camera.psi_range = args.psi.map_or(Ok(camera.psi_range), |range| range.psi(&camera))?;
    ui.used(camera.input());
    from.iter().for_each(|from| ui.used(from.input.clone()));
    let recipe = &seeds[0].0;
    recipe.check().map_err(said::recipe)?;
    check_threads(threads(args)).map_err(said::recipe)?;
    memory::check(&format!("--batch {}", recipe.batch), recipe.batch as f64 * bytes_a_window(&recipe.form))?;
    let psis = spread(camera.psi_range, args.depths)?;
    let mut photographs = photographs(&args.images, args.photos.as_ref(), ui)?;
    leave_out(&mut photographs, &args.leave_out)?;
    let photos: Vec<Input> = photographs.iter().map(|p| Input::photograph(&p.name(), &p.frame)).collect();
    photos.iter().for_each(|photo| ui.used(photo.clone()));
    let dataset = dataset(&photographs, &camera, recipe, &psis, ui)?;
    let mut results = Vec::new();
    for (recipe, file) in &seeds {
        let run = Run {
            recipe: recipe.clone(),
            camera: camera.to_json(),
            photos: photos.clone(),
            psis: psis.clone(),
            from: from.as_ref().map(|from| from.input.clone()),
        };
        results.push(one_seed(&dataset, &run, from.as_ref(), file, args, ui)?);
    }
    let [first, others @ ..] = &mut results[..] else { unreachable!("one seed at least") };
    let chosen = others
        .iter_mut()
        .fold(first, |best, other| if other.best().score > best.best().score { other } else { best });
    let made = provenance(args, chosen.trainer.recipe(), ui);
    let network = chosen.trainer.best(&name(args), &camera, made);
    weight_file::save_network(&args.out, &network)?;
    for (_, file) in &seeds {
        let _ = std::fs::remove_file(file);
    }
    let seed = chosen.trainer.recipe().seed;
    tell(&network, &results, seed, &photographs, args, ui)
}

/// Refuses to begin over what an unfinished run left, and to go on where none left anything.
fn checkpoints(args: &Args, seeds: &[(Recipe, PathBuf)]) -> Result<(), Error> {
    let left = seeds.iter().map(|(_, file)| file).find(|file| file.exists());
    match (left, args.resume) {
        (Some(file), false) => Err(Error::message(format!(
            "{}: left by an earlier run; go on with it by --resume, or delete it",
            file.display()
        ))),
        (None, true) => Err(Error::message(format!(
            "--resume: there is no checkpoint {} to go on from{}",
            seeds[0].1.display(),
            instead(args)
        ))),
        _ => Ok(()),
    }
}

/// What there is where a checkpoint was expected, and what to do.
fn instead(args: &Args) -> String {
    let out = args.out.display();
    let begins = |name: &Path| {
        name.as_os_str().as_encoded_bytes().starts_with(args.out.as_os_str().as_encoded_bytes())
    };
    let folder = args.out.parent().filter(|folder| !folder.as_os_str().is_empty());
    let beside = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten().flatten();
    let mut others: Vec<String> = beside
        .map(|entry| folder.map_or_else(|| entry.file_name().into(), |folder| folder.join(entry.file_name())))
        .filter(|file: &PathBuf| {
            begins(file) && file.extension().is_some_and(|ending| ending == "checkpoint")
        })
        .map(|file| file.display().to_string())
        .collect();
    others.sort();
    if !others.is_empty() {
        return format!("; there is {}, of other seeds: give the --seed of that run", others.join(", "));
    }
    match weights::in_words(&args.out) {
        Some(network) => {
            format!(
                "; {out} is finished, {network}: leave --resume out and name another --out, or give --force to train anew"
            )
        }
        None => "; leave --resume out to begin".to_owned(),
    }
}

/// A trained network that has not been written yet.
struct Trained<'a> {
    trainer: Trainer<'a>,
    seconds: f64,
    /// Steps of this run; a resumed one counts its own only.
    steps: u64,
    history: Vec<Value>,
}

impl Trained<'_> {
    fn best(&self) -> Best {
        self.trainer.state.best
    }
}

/// A trained network to go on from.
struct Beginning {
    network: Network,
    input: Input,
}

impl Beginning {
    fn load(name: &str) -> Result<Self, Error> {
        Ok(Self { network: weights::float(name)?, input: weights::float_input(name)? })
    }
}

/// Threads that training is divided among at most.
const OF_USE: usize = 8;

fn threads(args: &Args) -> usize {
    args.threads
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |cores| cores.get().min(OF_USE)))
}

fn one_seed<'a>(
    dataset: &'a Dataset,
    run: &Run,
    from: Option<&Beginning>,
    file: &Path,
    args: &Args,
    ui: &Ui,
) -> Result<Trained<'a>, Error> {
    let threads = threads(args);
    let recipe = run.recipe.clone();
    let mut trainer = match from {
        _ if file.exists() => Trainer::resume(recipe, dataset, threads, checkpoint::load(file, run)?)?,
        Some(from) => Trainer::from_network(recipe, dataset, threads, &from.network)?,
        None => Trainer::new(recipe, dataset, threads)?,
    };
    checkpoint::save(file, run, &trainer.state)?;
    let (begun, first, mut history) = (Instant::now(), trainer.state.step, vec![]);
    if let Err(error) = train(&mut trainer, args, file, run, &mut history, ui) {
        if matches!(error, Error::Interrupted) {
            let step = trainer.state.step;
            ui.note(format!("{}: checkpoint at step {step}; --resume goes on", file.display()));
        }
        return Err(error);
    }
    // A seed that is done waits for the others; --resume passes over it.
    checkpoint::save(file, run, &trainer.state)?;
    let steps = trainer.state.step - first;
    Ok(Trained { trainer, seconds: begun.elapsed().as_secs_f64(), steps, history })
}

/// Memory that a step takes for each of its windows: inputs, targets, and what the gradient needs of every layer.
fn bytes_a_window(form: &Form) -> f64 {
    let words = form.window.pixels() + 3 * 192 + 4 * form.codes * form.layers;
    (words * size_of::<f32>()) as f64
}

fn train(
    trainer: &mut Trainer<'_>,
    args: &Args,
    file: &Path,
    run: &Run,
    history: &mut Vec<Value>,
    ui: &Ui,
) -> Result<(), Error> {
    let bar = ui.progress(trainer.recipe().steps, format!("train, seed {}", trainer.recipe().seed));
    let limit = args.minutes;
    let (start, mut saved) = (Instant::now(), Instant::now());
    let mut failed = None;
    trainer.run(|trainer, progress: &Progress| {
        bar.set(progress.step);
        if let Some(validation) = &progress.validation {
            bar.message(summary(validation, progress.best));
            history.push(moment(trainer, validation, progress));
        }
        let stop = interrupt::flag().load(Ordering::SeqCst);
        let out_of_time = limit.is_some_and(|limit| start.elapsed() >= limit);
        if stop || out_of_time || saved.elapsed() >= CHECKPOINT_EVERY {
            saved = Instant::now();
            failed = checkpoint::save(file, run, &trainer.state).err();
        }
        if stop || out_of_time || failed.is_some() { Continue::No } else { Continue::Yes }
    })?;
    if let Some(error) = failed {
        return Err(error.into());
    }
    interrupt::check()?;
    if trainer.state.best == Best::NONE {
        return Err(Error::message("train: stopped before the first validation; lower --validate-every"));
    }
    Ok(())
}

/// One validation in a line.
fn summary(validation: &Validation, best: Best) -> String {
    let worst = validation.worst().map_or(f64::NAN, |w| w.1);
    let non_zeros = |noisy| numbers(&validation.non_zeros(noisy), 0);
    let kept = if best.within_budget { "" } else { ", over budget" };
    format!(
        "best {:.2} dB{kept}; now {:.2}, worst {worst:.2}, non-zeros {} busy, {} noisy, {} clean",
        best.db,
        validation.db(),
        numbers(&validation.busy_non_zeros(), 0),
        non_zeros(true),
        non_zeros(false)
    )
}

fn moment(trainer: &Trainer<'_>, validation: &Validation, progress: &Progress) -> Value {
    json!({
        "step": progress.step,
        "loss": progress.loss,
        "validation_db": validation.db(),
        "worst_db": validation.worst().map(|w| w.1),
        "non_zeros_busy": validation.busy_non_zeros(),
        "non_zeros_noisy": validation.non_zeros(true),
        "non_zeros_clean": validation.non_zeros(false),
        "lambda": trainer.state.steering.lambdas,
    })
}

/// One recipe for each seed.
fn recipes(args: &Args, from: Option<&Beginning>) -> Result<Vec<Recipe>, Error> {
    let form = match (args.form, from.map(|from| from.network.form)) {
        (Some(form), Some(found)) if form != found => {
            let name = args.from.as_deref().unwrap_or_default();
            return Err(Error::message(format!(
                "--from {name}: its form is {}, that of --form {}; leave --form out, or train without --from",
                form::words(&found),
                form::words(&form)
            )));
        }
        (form, found) => form.or(found).unwrap_or_else(|| unreachable!("the options ask for one of them")),
    };
    let mut recipe = Recipe::new(form);
    set(&mut recipe.conditions.noise, args.noise);
    set(&mut recipe.conditions.gain, args.gain);
    set(&mut recipe.conditions.noiseless, args.noiseless);
    set(&mut recipe.conditions.exposure, args.exposure.map(narrow));
    set(&mut recipe.augmentation.variants, args.variants);
    set(&mut recipe.augmentation.saturation, args.saturation.map(narrow));
    set(&mut recipe.augmentation.hue, args.hue);
    set(&mut recipe.augmentation.scale, args.scale);
    set(&mut recipe.batch, args.batch);
    set(&mut recipe.steps, args.steps);
    set(&mut recipe.rate, args.rate);
    set(&mut recipe.output_rate, args.output_rate);
    set(&mut recipe.threshold_rate, args.threshold_rate);
    set(&mut recipe.validate_every, args.validate_every);
    set(&mut recipe.patience, args.patience);
    set(&mut recipe.lambda, Some(args.lambda.clone()).filter(|l| !l.is_empty()));
    match args.tone.as_deref() {
        Some("both") => recipe.tones = Tone::ALL.to_vec(),
        Some(tone) => recipe.tones = vec![tone.parse()?],
        None => (),
    }
    match args.weighting.as_deref() {
        Some("psnr") => recipe.weighting = Weighting::Psnr,
        Some("mse") => recipe.weighting = Weighting::Mse,
        Some(_) => recipe.weighting = Weighting::Root,
        None => (),
    }
    match args.start.as_deref() {
        Some("dictionary") => recipe.start = Start::Dictionary,
        Some(_) => recipe.start = Start::Whitened,
        None => (),
    }
    recipe.budget = budget(args, recipe.budget.take())?;
    let mut seeds: Vec<u64> = args.seed.clone();
    if seeds.is_empty() {
        seeds.push(recipe.seed);
    }
    if let Some(twice) = seeds.iter().enumerate().find(|(i, s)| seeds[..*i].contains(s)) {
        return Err(Error::message(format!("--seed: {} is given twice", twice.1)));
    }
    Ok(seeds.into_iter().map(|seed| Recipe { seed, ..recipe.clone() }).collect())
}

fn budget(args: &Args, usual: Option<Budget>) -> Result<Option<Budget>, Error> {
    let mut budget = match args.non_zeros.as_deref() {
        None => usual,
        Some("none") => None,
        Some(text) => {
            let numbers = text.split(',').map(|n| n.trim().parse()).collect::<Result<Vec<f32>, _>>();
            let non_zeros = numbers.map_err(|_| {
                Error::message(format!("--non-zeros {text}: expected numbers as in 65,65,58, or none"))
            })?;
            Some(Budget { non_zeros, rate: usual.map_or(Budget::RATE, |b| b.rate) })
        }
    };
    match (&mut budget, args.budget_rate) {
        (Some(budget), rate) => set(&mut budget.rate, rate),
        (None, Some(_)) => {
            return Err(Error::message("--budget-rate: there is no budget; give --non-zeros too"));
        }
        (None, None) => (),
    }
    Ok(budget)
}

fn set<T>(field: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *field = value;
    }
}

fn narrow(range: [f64; 2]) -> [f32; 2] {
    range.map(|v| v as f32)
}

/// A photograph to learn from.
pub struct Photograph {
    /// Name of its folder.
    pub folder: String,
    /// Name of its file, without the ending.
    pub stem: String,
    /// Its file.
    pub file: PathBuf,
    /// Its values, 0…1; sides even.
    pub frame: ColourFrame,
}

impl Photograph {
    fn name(&self) -> String {
        format!("{}/{}", self.folder, self.stem)
    }
}

/// Takes photographs out of those to learn from.
///
/// # Errors
/// A name that none of them has: a slip of the pen would train on what is to be held back.
fn leave_out(photographs: &mut Vec<Photograph>, names: &[String]) -> Result<(), Error> {
    for name in names {
        let before = photographs.len();
        photographs.retain(|photograph| photograph.stem != *name);
        if photographs.len() == before {
            return Err(Error::message(format!(
                "--leave-out {name}: none of the photographs to learn from has this name"
            )));
        }
    }
    if photographs.is_empty() {
        return Err(Error::message("--leave-out: leaves no photograph to learn from"));
    }
    Ok(())
}

/// The photographs to learn from, and a remark for each that had to be skipped. Without a folder they are the study's and, where
/// they are, those that came besides; without a choice, all but the study's test photos.
///
/// # Errors
/// A folder that cannot be read, or nothing to learn from.
pub fn photographs(
    folders: &[PathBuf],
    choice: Option<&Selection>,
    ui: &Ui,
) -> Result<Vec<Photograph>, Error> {
    let folders = if folders.is_empty() {
        std::iter::once(photos::default_folder()?).chain(photos::more_folder()).collect()
    } else {
        folders.to_vec()
    };
    let (mut photographs, mut found) = (vec![], 0);
    for folder in &folders {
        let (named, skipped) = photo::load_folder(folder)?;
        for error in &skipped {
            ui.note(format!("skipped {error}"));
        }
        if !skipped.is_empty() {
            ui.note(format!(
                "{} of {} skipped",
                skipped.len(),
                count(skipped.len() + named.len(), "photograph")
            ));
        }
        found += named.len();
        let files = edof_io::picture::of_folder(folder).unwrap_or_default();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let wanted = named.into_iter().filter(|(stem, _)| match choice {
            Some(selection) => selection.holds(stem),
            None => !(stem.starts_with(STUDY_PREFIX) && Selection::Test.holds(stem)),
        });
        photographs.extend(wanted.map(|(stem, frame)| {
            // Whole Bayer cells.
            let (height, width) = frame.size();
            let frame = frame.crop(0, 0, height & !1, width & !1);
            let file = files.iter().find(|file| file.file_stem().is_some_and(|own| *own == *stem));
            let file = file.cloned().unwrap_or_else(|| folder.join(&stem));
            Photograph { folder: name.clone(), stem, file, frame }
        }));
    }
    if photographs.is_empty() {
        let folders: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
        return Err(Error::message(format!(
            "{}: {}, none to be trained on; choose with --photos, as in --photos all",
            folders.join(", "),
            count(found, "photograph")
        )));
    }
    Ok(photographs)
}

/// Names of the folders, in order, each once.
fn folders(photographs: &[Photograph]) -> Vec<&str> {
    let mut seen = BTreeSet::new();
    photographs.iter().map(|p| p.folder.as_str()).filter(|folder| seen.insert(*folder)).collect()
}

fn tell_photographs(photographs: &[Photograph], ui: &Ui) -> Result<(), Error> {
    for folder in folders(photographs) {
        let stems: Vec<&str> =
            photographs.iter().filter(|p| p.folder == folder).map(|p| p.stem.as_str()).collect();
        ui.say(format!("{} of {folder}: {}", count(stems.len(), "photograph"), stems.join(" ")))?;
    }
    Ok(())
}

/// What photographs are made into.
fn dataset(
    photographs: &[Photograph],
    camera: &Camera,
    recipe: &Recipe,
    psis: &[f64],
    ui: &Ui,
) -> Result<Dataset, Error> {
    let frames: Vec<ColourFrame> = photographs.iter().map(|p| p.frame.clone()).collect();
    let words: usize = frames.iter().map(|f| f.planes.len() * size_of::<u16>()).sum();
    let pictures = recipe.tones.len() as f64 * recipe.augmentation.variants as f64 * (psis.len() + 1) as f64;
    memory::check("photographs (fewer --variants, --depths or --images take less)", words as f64 * pictures)?;
    let bar = ui.progress(frames.len() as u64, "blur");
    let tell = |done: usize, _| {
        bar.set(done as u64);
        interrupt::check().is_ok()
    };
    let name = |index: usize| photographs[index].file.display().to_string();
    let made = Dataset::new(&frames, camera, recipe.dataset(psis), tell);
    made.map_err(|error| said::dataset(error, name))?.ok_or(Error::Interrupted)
}

fn spread([low, high]: [f64; 2], count: usize) -> Result<Vec<f64>, Error> {
    match count {
        0 | 1001.. => Err(Error::message(format!("--depths {count}: must be 1 to 1000"))),
        1 => Ok(vec![0.5 * (low + high)]),
        _ => Ok((0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()),
    }
}

fn minutes(text: &str) -> Result<Duration, String> {
    let minutes = text.parse::<f64>().ok().filter(|minutes| *minutes > 0.0);
    let time = minutes.and_then(|minutes| Duration::try_from_secs_f64(60.0 * minutes).ok());
    time.ok_or_else(|| "expected a number of minutes above 0".to_owned())
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let number = |word: &str| word.parse::<f64>().ok().filter(|v| v.is_finite());
    let ends = text.split_once(':').and_then(|(low, high)| Some([number(low)?, number(high)?]));
    ends.filter(|[low, high]| low <= high).ok_or_else(|| "expected LOW:HIGH, as in 0:8".to_owned())
}

/// A range of ψ from its lower end on, or of distances.
fn depths(text: &str) -> Result<DepthRange, String> {
    let depths: DepthRange = text.parse()?;
    match (depths.near, depths.far) {
        (Depth::Psi(_), Depth::Psi(_)) => range(text).map(|_| depths),
        _ => Ok(depths),
    }
}

fn checkpoint_file(args: &Args, seed: u64) -> PathBuf {
    let mut name = args.out.as_os_str().to_owned();
    if args.seed.len() > 1 {
        name.push(format!(".{seed}"));
    }
    name.push(".checkpoint");
    name.into()
}

fn name(args: &Args) -> String {
    let stem = || args.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    args.name.clone().unwrap_or_else(stem)
}

fn provenance(args: &Args, recipe: &Recipe, ui: &Ui) -> Provenance {
    Provenance { command: command(args, recipe), seed: Some(recipe.seed), ..ui.provenance().for_file() }
}

/// The command that makes this network, with everything that its bytes depend on and nothing else, so that a resumed run
/// writes the same bytes as an unbroken one.
fn command(args: &Args, r: &Recipe) -> String {
    let weighting = match r.weighting {
        Weighting::Psnr => "psnr",
        Weighting::Root => "root",
        Weighting::Mse => "mse",
    };
    let start = match &args.from {
        Some(from) => format!("--from {}", Path::new(from).file_name().unwrap_or_default().display()),
        None if r.start == Start::Dictionary => "--start dictionary".to_owned(),
        None => "--start whitened".to_owned(),
    };
    let tone = match r.tones[..] {
        [tone] => tone.to_string(),
        _ => "both".to_owned(),
    };
    let photos = args.photos.as_ref().map(|p| format!(" --photos {p}")).unwrap_or_default();
    let left_out = match &args.leave_out[..] {
        [] => String::new(),
        names => format!(" --leave-out {}", names.join(",")),
    };
    let bank = args.psf_bank.as_deref().and_then(Path::file_name);
    let bank = bank.map(|file| format!(" --psf-bank {}", file.display())).unwrap_or_default();
    let psi = args.psi.map(|range| format!(" --psi {range}")).unwrap_or_default();
    let budget = match &r.budget {
        Some(b) => format!("{} --budget-rate {}", joined(&b.non_zeros), b.rate),
        None => "none".to_owned(),
    };
    let seeds = if args.seed.is_empty() { r.seed.to_string() } else { joined(&args.seed) };
    let (c, a) = (&r.conditions, &r.augmentation);
    let pair = |[low, high]: [f32; 2]| format!("{low}:{high}");
    let words = [
        format!(
            "edof train --form {} --camera {}{bank}{psi}{photos}{left_out}",
            form::words(&r.form),
            args.camera
        ),
        format!("--depths {} --tone {tone} --noise {} --gain {}", args.depths, c.noise, c.gain),
        format!("--noiseless {} --exposure {}", c.noiseless, pair(c.exposure)),
        format!("--variants {} --saturation {}", a.variants, pair(a.saturation)),
        format!("--hue {} --scale {} --weighting {weighting}", a.hue, a.scale),
        format!("--steps {} --batch {} --rate {}", r.steps, r.batch, r.rate),
        format!("--output-rate {} --threshold-rate {}", r.output_rate, r.threshold_rate),
        format!("--lambda {} --non-zeros {budget} {start}", joined(&r.lambda)),
        format!("--seed {seeds} --validate-every {} --patience {}", r.validate_every, r.patience),
        format!("--out {}.safetensors", name(args)),
    ];
    words.join(" ")
}

fn joined<T: ToString>(values: &[T]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

fn numbers(values: &[f64], digits: usize) -> String {
    values.iter().map(|v| format!("{v:.digits$}")).collect::<Vec<_>>().join(" ")
}

fn tell(
    network: &Network,
    results: &[Trained<'_>],
    seed: u64,
    photographs: &[Photograph],
    args: &Args,
    ui: &Ui,
) -> Result<(), Error> {
    let Some(chosen) = results.iter().find(|r| r.trainer.recipe().seed == seed) else { return Ok(()) };
    let validation = chosen.trainer.validate_best();
    let windows: u64 = results.iter().map(|r| r.steps * r.trainer.recipe().batch as u64).sum();
    let seconds: f64 = results.iter().map(|r| r.seconds).sum();
    tell_photographs(photographs, ui)?;
    tell_validation(&validation, &chosen.trainer, photographs, ui)?;
    for result in results.iter().filter(|_| results.len() > 1) {
        let best = result.best();
        let kept = if best.within_budget { "" } else { ", over budget" };
        ui.say(format!("seed {}: {:.3} dB{kept}", result.trainer.recipe().seed, best.db))?;
    }
    ui.say(format!(
        "{}: {:.2} dB on validation windows (mean over photographs, tones, ψ, without and with noise) after {} steps \
         ({:.0} windows a second); written to {}",
        network.origin.name,
        network.origin.validation_db,
        chosen.trainer.state.step,
        windows as f64 / seconds,
        args.out.display()
    ))?;
    let seeds: Vec<Value> = results
        .iter()
        .map(|r| {
            let best = r.best();
            let seed = r.trainer.recipe().seed;
            json!({ "seed": seed, "validation_db": best.db, "within_budget": best.within_budget, "history": r.history })
        })
        .collect();
    ui.json(&json!({
        "name": network.origin.name,
        "form": network.form,
        "camera": network.origin.camera.name,
        "photographs": photographs.iter().map(Photograph::name).collect::<Vec<_>>(),
        "steps": chosen.trainer.state.step,
        "windows": network.origin.patches,
        "seed": seed,
        "validation_db": network.origin.validation_db,
        "validation": table(&validation, &chosen.trainer, photographs),
        "lambda": chosen.trainer.state.steering.lambdas,
        "seeds": seeds,
        "seconds": seconds,
        "windows_per_second": windows as f64 / seconds,
        "weights": args.out.display().to_string(),
    }))
}

/// Mean dB by folder and tone, without and with noise, then the worst ψ and noise and the non-zeros.
fn tell_validation(
    validation: &Validation,
    trainer: &Trainer<'_>,
    photographs: &[Photograph],
    ui: &Ui,
) -> Result<(), Error> {
    ui.say("validation  tone    no noise   noisy  (dB)")?;
    for row in rows(validation, trainer, photographs) {
        let cell = |db: Option<f64>| db.map_or("-".to_owned(), |db| format!("{db:.2}"));
        ui.say(format!(
            "{:10}  {:6}  {:>8}  {:>6}",
            row.folder,
            row.tone,
            cell(row.clean_db),
            cell(row.noisy_db)
        ))?;
    }
    if let Some((at, db)) = validation.worst() {
        let noise = if at.noisy { "with noise" } else { "without noise" };
        let (psi, tone) = (trainer.psi(at.place.psi), trainer.recipe().tones[at.place.tone]);
        ui.say(format!("worst: {db:.2} dB at psi {psi}, {noise}, {tone} (mean over photographs)"))?;
    }
    let (clean, noisy) = (validation.non_zeros(false), validation.non_zeros(true));
    ui.say(format!(
        "non-zeros after each shrinkage: {} where scenes are busiest, {} without noise, {} with",
        numbers(&validation.busy_non_zeros(), 1),
        numbers(&clean, 1),
        numbers(&noisy, 1)
    ))
}

/// One line of the validation's table.
struct Row<'a> {
    folder: &'a str,
    tone: Tone,
    clean_db: Option<f64>,
    noisy_db: Option<f64>,
}

fn rows<'a>(validation: &Validation, trainer: &Trainer<'_>, photographs: &'a [Photograph]) -> Vec<Row<'a>> {
    let mut rows = vec![];
    for folder in folders(photographs) {
        for (index, &tone) in trainer.recipe().tones.iter().enumerate() {
            let db = |noisy| {
                validation.mean(|m| {
                    photographs[m.place.photo].folder == folder && m.place.tone == index && m.noisy == noisy
                })
            };
            rows.push(Row { folder, tone, clean_db: db(false), noisy_db: db(true) });
        }
    }
    rows
}

fn table(validation: &Validation, trainer: &Trainer<'_>, photographs: &[Photograph]) -> Value {
    let row = |r: Row<'_>| json!({ "folder": r.folder, "tone": r.tone, "clean_db": r.clean_db, "noisy_db": r.noisy_db });
    let worst = validation.worst().map(|(at, db)| {
        json!({ "psi": trainer.psi(at.place.psi), "tone": trainer.recipe().tones[at.place.tone], "noisy": at.noisy, "db": db })
    });
    json!({
        "means": rows(validation, trainer, photographs).into_iter().map(row).collect::<Vec<_>>(),
        "worst": worst,
        "non_zeros_busy": validation.busy_non_zeros(),
        "non_zeros_noisy": validation.non_zeros(true),
        "non_zeros_clean": validation.non_zeros(false),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_spread_over_the_whole_range() {
        assert_eq!(spread([0.0, 8.0], 5).unwrap(), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(spread([0.0, 8.0], 1).unwrap(), [4.0]);
        assert!(spread([0.0, 8.0], 0).is_err());
    }

    #[test]
    fn a_range_has_two_ends_in_order() {
        assert_eq!(range("-4:4.5"), Ok([-4.0, 4.5]));
        assert!(depths("0.7m:3m").is_ok() && depths("-4:4.5").is_ok() && depths("8:0").is_err());
        assert!(range("4").is_err() && range("8:0").is_err() && range("a:b").is_err());
    }
}
