//! `edof train`: a float network from photographs.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{form, interrupt, memory};
use edof_io::photo;
use edof_optics::psf::Settings;
use edof_spec::network::{Form, Network};
use edof_spec::{Camera, ColourFrame, weight_file};
use edof_study::photos::{self, Selection};
use edof_train::checkpoint::{self, Run};
use edof_train::initial::Start;
use edof_train::patches::Bank;
use edof_train::train::{Balance, Continue, Progress, Recipe, Trainer};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A checkpoint comes this often.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);
/// Name that the photographs of the study's test set begin with; they are never trained on unless asked for.
const STUDY_PREFIX: &str = "kodim";

/// Train a float network on photographs seen through a camera
///
/// A checkpoint is written beside OUT every minute and when Ctrl-C stops the run; --resume goes on from it and ends with the
/// same bytes as a run that was never stopped. The same seed, options and threads give the same bytes.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof train --form edof-t4w12 --camera ring-outer --images photos/ --out weights/mine.safetensors
  edof train --form two-sided,w8,t4 --camera ring-2018 --images photos/ --steps 8000 --out quick.safetensors
  edof train --form edof-t4w12 --camera ring-outer --images photos/ --out weights/mine.safetensors --resume")]
pub struct Args {
    /// The network's form: paper-t4, edof-t4w12, or words as in one-sided,w12,t4,c192,r
    #[arg(long, value_parser = form::parse, long_help = form::HELP)]
    form: Form,

    /// Camera: a preset such as ring-outer, or a JSON file
    #[arg(long)]
    camera: String,

    /// Folder of photographs [default: $EDOF_KODAK, else the study's]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// Which of them: train, all, or numbers as in 1,2 [default: all but the study's test photos]
    #[arg(long)]
    photos: Option<Selection>,

    /// Weight file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Name of the network [default: OUT without its ending]
    #[arg(long)]
    name: Option<String>,

    /// Values of ψ, spread evenly over the camera's range
    #[arg(long, default_value_t = 17)]
    depths: usize,

    /// Range of ψ as LOW:HIGH, where it is not the camera's
    #[arg(long, value_name = "LOW:HIGH", value_parser = range, allow_hyphen_values = true)]
    psi: Option<[f64; 2]>,

    /// Largest noise σ, in units of full scale
    #[arg(long)]
    noise: Option<f32>,

    /// One window in so many has no noise at all
    #[arg(long)]
    noiseless: Option<usize>,

    /// What easy and hard windows weigh: psnr trains the mean PSNR, mse the mean square error, root lies between
    #[arg(long, value_parser = ["psnr", "root", "mse"])]
    balance: Option<String>,

    /// Steps of the whole schedule
    #[arg(long)]
    steps: Option<u64>,

    /// Stop after so many minutes, wherever the schedule is
    #[arg(long, value_parser = minutes)]
    minutes: Option<Duration>,

    /// Windows a step; a multiple of the threads
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

    /// What a unit of |z| costs: larger gives fewer non-zeros
    #[arg(long)]
    lambda: Option<f32>,

    /// Where to start: whitened inputs, or the paper's ISTA with a learned dictionary
    #[arg(long, value_parser = ["whitened", "dictionary"])]
    start: Option<String>,

    /// Seed of everything random
    #[arg(long)]
    seed: Option<u64>,

    /// Workers
    #[arg(long)]
    threads: Option<usize>,

    /// Steps between validations
    #[arg(long)]
    validate_every: Option<u64>,

    /// Validations without a better one after which training stops
    #[arg(long)]
    patience: Option<u32>,

    /// Go on from the checkpoint beside OUT, if there is one
    #[arg(long)]
    resume: bool,
}

/// # Errors
/// Photographs, options or a checkpoint that cannot be used, a file that cannot be written, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let file = checkpoint_file(&args.out);
    let files = Files::new(ui).reads(&args.camera);
    let files = args.images.iter().fold(files, Files::reads_pictures_of);
    files.writes("--out", &args.out).writes("checkpoint", &file).check()?;
    let mut camera = Camera::resolve(&args.camera)?;
    camera.psi_range = args.psi.unwrap_or(camera.psi_range);
    let recipe = recipe(&args);
    memory::check(&format!("--batch {}", recipe.batch), recipe.batch as f64 * bytes_a_window(&recipe.form))?;
    let psis = spread(camera.psi_range, args.depths)?;
    let photographs = photographs(args.images.as_deref(), args.photos.as_ref(), ui)?;
    let (names, frames): (Vec<_>, Vec<_>) = photographs.into_iter().unzip();
    let run = Run { recipe: recipe.clone(), camera: camera.to_json(), photos: names, psis: psis.clone() };
    if file.exists() && !args.resume {
        return Err(Error::message(format!(
            "{}: left by an earlier run; go on with it by --resume, or delete it",
            file.display()
        )));
    }
    let bank = bank(&frames, &camera, &psis, &args, ui)?;
    let mut trainer = if file.exists() {
        Trainer::resume(recipe, &bank, checkpoint::load(&file, &run)?)?
    } else {
        Trainer::new(recipe, &bank)?
    };
    checkpoint::save(&file, &run, &trainer.state)?;
    let begun = Begun { time: Instant::now(), step: trainer.state.step };
    if let Err(error) = train(&mut trainer, &args, &file, &run, ui) {
        if !matches!(error, Error::Interrupted) {
            return Err(error);
        }
        ui.note(format!("{}: checkpoint at step {}; --resume goes on", file.display(), trainer.state.step));
        return Err(error);
    }
    let network = trainer.best(&name(&args), &camera, &command(&args, &trainer));
    weight_file::save_network(&args.out, &network)?;
    let _ = std::fs::remove_file(&file);
    tell(&network, &trainer, &args, &begun, ui)
}

/// Memory that a step takes for each of its windows: inputs, targets, and what the gradient needs of every layer.
fn bytes_a_window(form: &Form) -> f64 {
    let words = form.window.pixels() + 3 * 192 + 4 * form.codes * form.layers;
    (words * size_of::<f32>()) as f64
}

/// Where this run began; a resumed one counts its own steps only.
struct Begun {
    time: Instant,
    step: u64,
}

fn train(trainer: &mut Trainer<'_>, args: &Args, file: &Path, run: &Run, ui: &Ui) -> Result<(), Error> {
    let bar = ui.progress(trainer.recipe().steps, "train");
    let limit = args.minutes;
    let (start, mut saved) = (Instant::now(), Instant::now());
    let mut failed = None;
    trainer.run(|trainer, progress: &Progress| {
        bar.set(progress.step);
        if progress.validation_db.is_some() {
            bar.message(format!("best {:.2} dB", progress.best_db));
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
    if trainer.state.best_db == f64::NEG_INFINITY {
        return Err(Error::message("train: stopped before the first validation; lower --validate-every"));
    }
    Ok(())
}

fn recipe(args: &Args) -> Recipe {
    let usual = Recipe::new(args.form);
    Recipe {
        form: args.form,
        noise: args.noise.unwrap_or(usual.noise),
        noiseless: args.noiseless.unwrap_or(usual.noiseless),
        balance: match args.balance.as_deref() {
            Some("psnr") => Balance::Psnr,
            Some("root") => Balance::Root,
            Some(_) => Balance::Mse,
            None => usual.balance,
        },
        batch: args.batch.unwrap_or(usual.batch),
        steps: args.steps.unwrap_or(usual.steps),
        rate: args.rate.unwrap_or(usual.rate),
        output_rate: args.output_rate.unwrap_or(usual.output_rate),
        threshold_rate: args.threshold_rate.unwrap_or(usual.threshold_rate),
        lambda: args.lambda.unwrap_or(usual.lambda),
        start: match args.start.as_deref() {
            Some("dictionary") => Start::Dictionary,
            Some(_) => Start::Whitened,
            None => usual.start,
        },
        seed: args.seed.unwrap_or(usual.seed),
        threads: args.threads.unwrap_or(usual.threads),
        validate_every: args.validate_every.unwrap_or(usual.validate_every),
        patience: args.patience.unwrap_or(usual.patience),
    }
}

/// Names and frames of the photographs to learn from, and a remark for each that had to be skipped. Without a folder they are the
/// study's; without a choice, all but the study's test photos.
///
/// # Errors
/// A folder that cannot be read or holds none.
pub fn photographs(
    folder: Option<&Path>,
    choice: Option<&Selection>,
    ui: &Ui,
) -> Result<Vec<(String, ColourFrame)>, Error> {
    let folder = match folder {
        Some(folder) => folder.to_owned(),
        None => photos::default_folder()?,
    };
    let (mut named, skipped) = photo::load_folder(&folder)?;
    for error in &skipped {
        ui.note(format!("skipped {error}"));
    }
    if !skipped.is_empty() {
        ui.note(format!("{} of {} photographs skipped", skipped.len(), skipped.len() + named.len()));
    }
    let found = named.len();
    named.retain(|(name, _)| match choice {
        Some(selection) => selection.holds(name),
        None => !(name.starts_with(STUDY_PREFIX) && Selection::Test.holds(name)),
    });
    if named.is_empty() {
        return Err(Error::message(format!(
            "{}: none of its {found} photographs is to be trained on; choose with --photos",
            folder.display()
        )));
    }
    // Whole Bayer cells.
    Ok(named
        .into_iter()
        .map(|(name, frame)| {
            let (height, width) = frame.size();
            (name, frame.crop(0, 0, height & !1, width & !1))
        })
        .collect())
}

fn bank(frames: &[ColourFrame], camera: &Camera, psis: &[f64], args: &Args, ui: &Ui) -> Result<Bank, Error> {
    let bar = ui.progress(frames.len() as u64, "blur");
    let tell = |done: usize, _| {
        bar.set(done as u64);
        interrupt::check().is_ok()
    };
    Bank::new(frames, camera, psis, &Settings::default(), args.form.window, tell)?.ok_or(Error::Interrupted)
}

fn spread([low, high]: [f64; 2], count: usize) -> Result<Vec<f64>, Error> {
    match count {
        0 => Err(Error::message("--depths 0: must be 1 or more")),
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

fn checkpoint_file(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".checkpoint");
    name.into()
}

fn name(args: &Args) -> String {
    let stem = || args.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    args.name.clone().unwrap_or_else(stem)
}

/// The command that makes this network, with everything that its bytes depend on and nothing else, so that a resumed run
/// writes the same bytes as an unbroken one.
fn command(args: &Args, trainer: &Trainer<'_>) -> String {
    let r = trainer.recipe();
    let balance = match r.balance {
        Balance::Psnr => "psnr",
        Balance::Root => "root",
        Balance::Mse => "mse",
    };
    let start = if r.start == Start::Dictionary { "dictionary" } else { "whitened" };
    let photos = args.photos.as_ref().map(|p| format!(" --photos {p}")).unwrap_or_default();
    let psi = args.psi.map(|[low, high]| format!(" --psi {low}:{high}")).unwrap_or_default();
    format!(
        "edof train --form {} --camera {}{psi}{photos} --depths {} --noise {} --noiseless {} --balance {balance} --steps {} --batch {} --rate {} \
         --output-rate {} --threshold-rate {} --lambda {} --start {start} --seed {} --threads {} --validate-every {} \
         --patience {} --out {}.safetensors",
        form::words(&r.form),
        args.camera,
        args.depths,
        r.noise,
        r.noiseless,
        r.steps,
        r.batch,
        r.rate,
        r.output_rate,
        r.threshold_rate,
        r.lambda,
        r.seed,
        r.threads,
        r.validate_every,
        r.patience,
        name(args),
    )
}

fn tell(network: &Network, trainer: &Trainer<'_>, args: &Args, begun: &Begun, ui: &Ui) -> Result<(), Error> {
    let seconds = begun.time.elapsed().as_secs_f64();
    let patches = (trainer.state.step - begun.step) * trainer.recipe().batch as u64;
    ui.say(format!(
        "{}: {:.2} dB on validation windows after {} steps ({:.0} windows a second); written to {}",
        network.origin.name,
        network.origin.validation_db,
        trainer.state.step,
        patches as f64 / seconds,
        args.out.display()
    ))?;
    ui.json(&json!({
        "name": network.origin.name,
        "form": network.form,
        "camera": network.origin.camera.name,
        "steps": trainer.state.step,
        "windows": network.origin.patches,
        "validation_db": network.origin.validation_db,
        "seconds": seconds,
        "windows_per_second": patches as f64 / seconds,
        "weights": args.out.display().to_string(),
    }))
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
        assert!(range("4").is_err() && range("8:0").is_err() && range("a:b").is_err());
    }
}
