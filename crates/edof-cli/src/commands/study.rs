//! `edof study`: experiments on photographs.

mod dictionary;
mod single_depth;

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{interrupt, weights};
use clap::Subcommand;
use edof_optics::psf::Settings;
use edof_spec::provenance::Input;
use edof_spec::weight_file::WeightFileError;
use edof_spec::{FixedNetwork, Noise, Stride, Tone};
use edof_study::kodak::{self, Conditions, KodakError, Progress, Row, Setup, usual_noise};
use edof_study::nets::{self, Net};
use edof_study::photos::{self, Photo, Selection};
use edof_study::summary::Study;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Measure methods on photographs, depths and noise levels
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(subcommand)]
    experiment: Experiment,
}

const EXAMPLES: &str = "\
Examples:
  edof study kodak --nets edof-t4w12-outer --json study.json
  edof study kodak --tone srgb --nets edof-t4w12-outer --noise none,sensor,sensor:gain=8 --markdown study.md
  edof study kodak --nets my/net.safetensors --photos train --psi 8
  edof study single-depth --rows rows.jsonl --report speed.html";

#[derive(Subcommand)]
enum Experiment {
    Kodak(Kodak),
    SingleDepth(single_depth::Args),
    Dictionary(dictionary::Args),
}

/// Photographs through each net's own camera, reconstructed in float, in the board's format and in fixed point
///
/// Kernels hold 99.9 % of the energy (all of it with --exact), the sensor has 16 bits. PSNR is over red, green and blue with
/// peak 1, a border of 8 pixels cropped. With --tone linear a photograph's values are taken as light and nothing is clipped;
/// with --tone srgb they are decoded to light, and what is measured is the picture, encoded and clipped to 0…1 as a screen
/// does, and the light beside it. Any net runs under either. Each net makes rows NAME.float (RGB), NAME.float422 (the same
/// in the board's 4:2:2 format) and NAME.fixed; demosaic-malvar is the coded frame as a plain camera would show it.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
struct Kodak {
    /// Nets by name or weight file, each behind the camera it was trained for
    #[arg(long, value_delimiter = ',', required = true, value_name = "NET,…")]
    nets: Vec<String>,

    /// What photographs hold: linear, light itself (the paper's convention), or srgb, encoded light
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Depths: the defocus parameter in radians
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,2,4,6,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<f64>,

    /// Noise levels: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read
    /// noise of edof capture's reference sensor [default: none,0.01,0.02; with --tone srgb none,sensor,sensor:gain=8]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "NOISE,…")]
    noise: Vec<Noise>,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    /// Folder of numbered photographs [default: $EDOF_KODAK, else shared/data/kodak beside the project]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// test (every third number), train (the others), all, or numbers such as 3,6
    #[arg(long, default_value = "test")]
    photos: String,

    /// Also write the tables as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,

    /// Also write an HTML report with plots
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Whole kernels: no cut by energy
    #[arg(long)]
    exact: bool,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    match args.experiment {
        Experiment::Kodak(args) => kodak(args, ui),
        Experiment::SingleDepth(args) => single_depth::run(args, ui),
        Experiment::Dictionary(args) => dictionary::run(args, ui),
    }
}

fn kodak(args: Kodak, ui: &Ui) -> Result<(), Error> {
    let folder = args.images.clone().map_or_else(photos::default_folder, Ok)?;
    let float = args.nets.iter().filter_map(|net| weights::float_file(net));
    let fixed = args.nets.iter().filter_map(|net| weights::fixed_file(&fixed_name(net)));
    let files = Files::new(ui).reads_all(float).reads_all(fixed).reads_pictures_of(&folder);
    let files = files.may_write("--report", args.report.as_ref());
    files.may_write("--markdown", args.markdown.as_ref()).check()?;
    let stride = Stride::new(args.stride)?;
    let (mut notes, mut loaded) = (vec![], vec![]);
    for name in &args.nets {
        let (net, note) = load_net(name, stride, ui)?;
        loaded.push(net);
        notes.extend(note);
    }
    let selection: Selection = args.photos.parse()?;
    let (photos, skipped) = photos::load(&folder, &selection)?;
    photos.iter().for_each(|photo| ui.used(Input::photograph(&photo.name, &photo.frame)));
    if !skipped.is_empty() {
        notes.extend(skipped.iter().map(|why| format!("photo skipped: {why}")));
        notes.push(format!("{} of {} photos skipped", skipped.len(), skipped.len() + photos.len()));
    }
    notes.iter().for_each(|note| ui.note(note));

    let rows = rows(&nets::setups(loaded, stride)?, &photos, &args.conditions(), ui)?;
    let study = Study::new(args.tone, rows, notes);
    if let Some(path) = &args.markdown {
        edof_spec::atomic::write(path, study.to_markdown(&args.command_line()).as_bytes())?;
    }
    if let Some(path) = &args.report {
        study.report(&ui.signed(&args.command_line())).save(path)?;
    }
    ui.say(study.to_text())?;
    ui.json(&study)
}

/// The experiment's rows; Ctrl-C ends it after a photograph.
fn rows(setups: &[Setup], photos: &[Photo], conditions: &Conditions, ui: &Ui) -> Result<Vec<Row>, Error> {
    let steps = setups.len() * conditions.psi.len() * photos.len();
    let progress = ui.progress(steps as u64, "photographs");
    let tell = |p: Progress<'_>| {
        progress.message(format!("{} at psi {}: {}", p.camera, p.psi, p.image));
        progress.set(p.done as u64);
        if interrupt::check().is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    match kodak::run(setups, photos, conditions, tell) {
        Err(KodakError::Stopped) => Err(Error::Interrupted),
        other => Ok(other?),
    }
}

impl Kodak {
    fn noise(&self) -> Vec<Noise> {
        if self.noise.is_empty() { usual_noise(self.tone).to_vec() } else { self.noise.clone() }
    }

    fn conditions(&self) -> Conditions {
        let optics = if self.exact { Settings::exact() } else { Settings::default() };
        Conditions { tone: self.tone, psi: self.psi.clone(), noise: self.noise(), optics }
    }

    /// What was run, as tables and reports state it: every option that their numbers depend on.
    fn command_line(&self) -> String {
        let list = |items: Vec<String>| items.join(",");
        let psi = list(self.psi.iter().map(ToString::to_string).collect());
        let noise = list(self.noise().iter().map(ToString::to_string).collect());
        let (nets, Self { tone, stride, photos, .. }) = (self.nets.join(","), self);
        let exact = if self.exact { " --exact" } else { "" };
        format!(
            "edof study kodak --tone {tone} --nets {nets} --psi {psi} --noise {noise} --stride {stride} --photos {photos}{exact}"
        )
    }
}

/// A net with its fixed-point weights where it has some. Weights that are there but broken are an error.
fn load_net(name: &str, stride: Stride, ui: &Ui) -> Result<(Net, Option<String>), Error> {
    let float = weights::float(name)?;
    let file = weights::float_input(name)?;
    let hash = file.sha256.clone();
    ui.used(file);
    let fixed = fixed_if_any(&fixed_name(name))?;
    if fixed.is_some() {
        ui.used(weights::fixed_input(&fixed_name(name))?);
    }
    Ok(Net::new(shown_name(name), float, &hash, fixed, stride))
}

/// What reports call a net.
fn shown_name(name: &str) -> &str {
    name.strip_suffix(".safetensors").unwrap_or(name).rsplit(['/', '\\']).next().unwrap_or(name)
}

/// Name of the fixed net that goes with a float one.
fn fixed_name(name: &str) -> String {
    let stem = name.strip_suffix(".safetensors");
    stem.map_or_else(|| name.to_owned(), |stem| format!("{stem}.fixed.safetensors"))
}

/// A fixed net, where there is one of that name. One that is there but broken is an error.
fn fixed_if_any(name: &str) -> Result<Option<FixedNetwork>, Error> {
    match weights::fixed(name) {
        Ok(fixed) => Ok(Some(fixed)),
        Err(Error::Failed(error)) if !error.is::<WeightFileError>() => Ok(None),
        Err(error) => Err(error),
    }
}
