//! `edof study`: experiments on photographs.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{interrupt, weights};
use clap::Subcommand;
use edof_optics::psf::Settings;
use edof_spec::weight_file::WeightFileError;
use edof_spec::{FixedNetwork, Stride};
use edof_study::kodak::{self, Conditions, KodakError};
use edof_study::nets::{self, Net};
use edof_study::photos::{self, Selection};
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
  edof study kodak --nets paper-t4,edof-t4w12,edof-t4w12-outer --psi 0,2,4,6,8 --noise 0,0.01 --stride 8 --json study.json
  edof study kodak --nets my/net.safetensors --photos train --psi 8";

#[derive(Subcommand)]
enum Experiment {
    Kodak(Kodak),
}

/// Photographs through each net's own camera, reconstructed in float, in the board's format and in fixed point
///
/// Pixel values are taken as linear light, kernels hold 99.9 % of the energy (all of it with --exact), the sensor has 16
/// bits. PSNR is over red, green and blue with peak 1, a border of 8 pixels cropped, nothing clipped. Each net makes rows
/// NAME.float (RGB), NAME.float422 (the same in the board's 4:2:2 format) and NAME.fixed; demosaic-malvar is the coded
/// frame as a plain camera would show it.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
struct Kodak {
    /// Nets by name or weight file, each behind the camera it was trained for
    #[arg(long, value_delimiter = ',', required = true, value_name = "NET,…")]
    nets: Vec<String>,

    /// Depths: the defocus parameter in radians
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,2,4,6,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<f64>,

    /// Standard deviations of the noise, in units of full scale
    #[arg(long, value_delimiter = ',', default_value = "0,0.01", value_name = "SIGMA,…")]
    noise: Vec<f64>,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    /// Folder of numbered photographs [default: $EDOF_KODAK, else shared/data/kodak beside the project]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// test (every third number), train (the others), all, or numbers such as 3,6
    #[arg(long, default_value = "test")]
    photos: String,

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
    }
}

fn kodak(args: Kodak, ui: &Ui) -> Result<(), Error> {
    let folder = args.images.clone().map_or_else(photos::default_folder, Ok)?;
    let float = args.nets.iter().filter_map(|net| weights::float_file(net));
    let fixed = args.nets.iter().filter_map(|net| weights::fixed_file(&fixed_name(net)));
    let files = Files::new(ui).reads_all(float).reads_all(fixed).reads_pictures_of(&folder);
    files.may_write("--report", args.report.as_ref()).check()?;
    let stride = Stride::new(args.stride)?;
    let optics = if args.exact { Settings::exact() } else { Settings::default() };
    let conditions = Conditions { psi: args.psi, noise: args.noise, stride: args.stride, optics };
    let mut notes = vec![];
    let mut loaded = vec![];
    for name in &args.nets {
        let (net, note) = load_net(name, stride)?;
        loaded.push(net);
        notes.extend(note);
    }
    let selection: Selection = args.photos.parse()?;
    let (photos, skipped) = photos::load(&folder, &selection)?;
    if !skipped.is_empty() {
        notes.extend(skipped.iter().map(|why| format!("photo skipped: {why}")));
        notes.push(format!("{} of {} photos skipped", skipped.len(), skipped.len() + photos.len()));
    }
    notes.iter().for_each(|note| ui.note(note));

    let benches = nets::benches(loaded, stride)?;
    let steps = benches.len() * conditions.psi.len() * photos.len();
    let progress = ui.progress(steps as u64, "photographs");
    let rows = kodak::run(&benches, &photos, &conditions, |p| {
        progress.message(format!("{} at psi {}: {}", p.camera, p.psi, p.image));
        progress.set(p.done as u64);
        if interrupt::check().is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    drop(progress);
    let rows = match rows {
        Err(KodakError::Stopped) => return Err(Error::Interrupted),
        other => other?,
    };
    let study = Study::new(rows, notes);
    if let Some(path) = &args.report {
        let command = format!("edof study kodak --nets {}", args.nets.join(","));
        study.report(&command).save(path)?;
    }
    ui.say(study.summary.to_text().trim_end())?;
    ui.json(&study)
}

/// A net with its fixed-point weights where it has some. Weights that are there but broken are an error.
fn load_net(name: &str, stride: Stride) -> Result<(Net, Option<String>), Error> {
    let float = weights::float(name)?;
    let hash = weights::float_hash(name)?;
    let fixed = fixed_if_any(&fixed_name(name))?;
    let shown = name.strip_suffix(".safetensors").unwrap_or(name).rsplit(['/', '\\']).next().unwrap_or(name);
    Ok(Net::new(shown, float, &hash, fixed, stride))
}

/// Name of the fixed net that goes with a float one.
fn fixed_name(name: &str) -> String {
    let stem = name.strip_suffix(".safetensors");
    stem.map_or_else(|| name.to_owned(), |stem| format!("{stem}.fixed.safetensors"))
}

/// A fixed net, where there is one of that name. One that is there but broken is an error.
pub(super) fn fixed_if_any(name: &str) -> Result<Option<FixedNetwork>, Error> {
    match weights::fixed(name) {
        Ok(fixed) => Ok(Some(fixed)),
        Err(Error::Failed(error)) if !error.is::<WeightFileError>() => Ok(None),
        Err(error) => Err(error),
    }
}
