//! `edof study tolerances`: what a maker must hold.

use super::nets;
use super::options::{Kernels, MayKeepRows, Outputs, Photographs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::lens::Depth;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use edof_core::{Noise, Stride, Tone};
use edof_study::tolerances::{Kind, Plan, Row, Tolerances, Tolerating};

/// Errors of the lens (ring radius, ring depth, wavelength, focus, tilt of the sensor) that cost 0.1 dB
///
/// Each photograph is captured by the camera as designed and by cameras with one error each, either way, and reconstructed by the network that was
/// trained for the camera as designed. The page has the loss of every error and the amount that costs 0.1 dB. The network computes in floating point.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study tolerances --report tolerances.html
  edof study tolerances --net my-low+my-high --rows rows.jsonl --markdown tolerances.md")]
pub struct Args {
    /// Network by name or weight file, behind the camera that it was trained for, whose mask has rings; LOW+HIGH picks by the noise
    #[arg(long, default_value = weights::default_for(Tone::Linear), value_name = "NET")]
    net: String,

    /// Encoding of the photographs: linear (the paper's convention: samples are linear light), or srgb
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Depths: ψ, the defocus in radians, or distances as in 1.5m if the camera states nominal_m
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,2,4,6,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<Depth>,

    /// Noise levels: none, the standard deviation of Gaussian noise in units of full scale, or sensor
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "none,0.01",
        allow_hyphen_values = true,
        value_name = "NOISE,…"
    )]
    noise: Vec<Noise>,

    /// Errors to measure: radius, depth, wavelength, focus; tilt follows from focus
    #[arg(long, value_delimiter = ',', default_value = "radius,depth,wavelength,focus", value_parser = kind, value_name = "ERROR,…")]
    errors: Vec<Kind>,

    #[command(flatten)]
    photographs: Photographs,

    #[command(flatten)]
    rows: MayKeepRows,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

fn kind(name: &str) -> Result<Kind, String> {
    match name {
        "radius" => Ok(Kind::Radius),
        "depth" => Ok(Kind::Depth),
        "wavelength" => Ok(Kind::Wavelength),
        "focus" => Ok(Kind::Focus),
        _ => Err("must be radius, depth, wavelength or focus".into()),
    }
}

/// # Errors
/// Nothing found, a file that is broken, a lens without rings, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui), std::slice::from_ref(&args.net));
    let files = files.reads_pictures_of(args.photographs.folder.path()?);
    args.rows.of(args.outputs.of(files)).check()?;
    args.rows.check::<Row>()?;
    let plan = args.plan(ui)?;
    let (photos, skipped) = args.photographs.load(ui)?;
    skipped.into_iter().for_each(|note| ui.note(note));
    let mut experiment = Tolerating::new(&plan, &photos);
    let journal = measured(&mut experiment, args.rows.rows.as_ref(), &args.rows.part, ui)?;
    tell::<Tolerances>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        let (entry, _) = nets::of_one_frame(&self.net, Stride::PATCH, ui)?;
        let camera = entry.camera;
        if camera.is_clear() {
            return Err(Error::message(format!(
                "--net {}: was trained for the camera {}, which has no mask; name a network for a coded lens, such as {}",
                self.net,
                camera.name,
                weights::default_for(Tone::Linear)
            )));
        }
        let Some(method) = entry.methods.into_iter().next() else {
            return Err(Error::message(format!("--net {}: has no format", self.net)));
        };
        let psi = said::psis(&self.psi, &camera)?;
        let (tone, noise, optics) = (self.tone, self.noise.clone(), self.kernels.settings());
        let (kinds, without): (Vec<Kind>, Vec<Kind>) =
            self.errors.iter().partition(|kind| kind.changes(&camera));
        for kind in without {
            ui.note(format!("{}: changes nothing in the camera {}, left out", kind.name(), camera.name));
        }
        if kinds.is_empty() {
            return Err(Error::message(format!(
                "--errors: none of them changes the camera {}; expected depth, wavelength or focus",
                camera.name
            )));
        }
        Ok(Plan { camera, method, tone, psi, noise, kinds, optics })
    }
}
