//! `edof study kodak`: the main experiment.

use super::nets;
use super::options::{Kernels, Outputs, Photographs, unless_interrupted};
use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Depth};
use crate::ui::Ui;
use edof_spec::{Noise, Stride, Tone};
use edof_study::csv;
use edof_study::kodak::{self, Conditions, KodakError, Progress, Row, Setup, usual_noise};
use edof_study::nets::setups;
use edof_study::photos::Photo;
use edof_study::summary::Study;

/// Photographs through each net's own camera, reconstructed in float, in the board's format and in fixed point
///
/// Kernels hold 99.9 % of the energy (all of it with --exact), the sensor has 16 bits. PSNR is over red, green and blue with
/// peak 1, a border of 8 pixels cropped. With --tone linear a photograph's values are taken as light and nothing is clipped;
/// with --tone srgb they are decoded to light, and what is measured is the picture, encoded and clipped to 0…1 as a screen
/// does, and the light beside it. Any net runs under either. Each net makes rows NAME.float (RGB), NAME.float422 (the same
/// in the board's 4:2:2 format) and NAME.fixed; demosaic-malvar is the coded frame as a plain camera would show it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study kodak --nets edof-t4w12-outer --json study.json
  edof study kodak --tone srgb --nets edof-t4w12-outer --noise none,sensor,sensor:gain=8 --markdown study.md
  edof study kodak --nets my/net.safetensors --photos train --psi 8")]
pub struct Args {
    /// Nets by name or weight file, each behind the camera it was trained for
    #[arg(long, value_delimiter = ',', required = true, value_name = "NET,…")]
    nets: Vec<String>,

    /// What photographs hold: linear, light itself (the paper's convention), or srgb, encoded light
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Depths: the defocus parameter in radians, or distances as in 1.5m before cameras that know their nominal_m
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,2,4,6,8",
        allow_hyphen_values = true,
        value_name = "PSI,…"
    )]
    psi: Vec<Depth>,

    /// Noise levels: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read
    /// noise of edof capture's reference sensor [default: none,0.01,0.02; with --tone srgb none,sensor,sensor:gain=8]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "NOISE,…")]
    noise: Vec<Noise>,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    #[command(flatten)]
    photographs: Photographs,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui), &args.nets).reads_pictures_of(args.photographs.folder.path()?);
    args.outputs.of(files).check()?;
    let stride = Stride::new(args.stride)?;
    let (mut notes, mut loaded) = (vec![], vec![]);
    for name in &args.nets {
        let (net, note) = nets::of_kodak(name, stride, ui)?;
        loaded.push(net);
        notes.extend(note);
    }
    let setups = setups(loaded, stride)?;
    let conditions = args.conditions(&setups)?;
    let (photos, skipped) = args.photographs.load(ui)?;
    notes.extend(skipped);
    notes.iter().for_each(|note| ui.note(note));

    let rows = rows(&setups, &photos, &conditions, ui)?;
    let study = Study::new(args.tone, rows, notes);
    let command = args.command_line();
    args.outputs.write(
        || study.to_markdown(&command),
        || Ok(study.report(&ui.signed(&command))),
        || csv::of(&study.rows),
    )?;
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
        unless_interrupted()
    };
    match kodak::run(setups, photos, conditions, tell) {
        Err(KodakError::Stopped) => Err(Error::Interrupted),
        other => Ok(other?),
    }
}

impl Args {
    fn noise(&self) -> Vec<Noise> {
        if self.noise.is_empty() { usual_noise(self.tone).to_vec() } else { self.noise.clone() }
    }

    fn conditions(&self, setups: &[Setup]) -> Result<Conditions, Error> {
        let (optics, psi) = (self.kernels.settings(), self.depths(setups)?);
        Ok(Conditions { tone: self.tone, psi, noise: self.noise(), optics })
    }

    /// ψ of the depths, which must be the same before all cameras: tables stand them side by side.
    fn depths(&self, setups: &[Setup]) -> Result<Vec<f64>, Error> {
        let [first, others @ ..] = setups else { return Ok(vec![]) };
        let psi = lens::psis(&self.psi, &first.camera)?;
        for Setup { camera, .. } in others {
            let own = lens::psis(&self.psi, camera)?;
            if let Some(((depth, a), b)) = self.psi.iter().zip(&psi).zip(own).find(|((_, a), b)| **a != *b) {
                return Err(Error::message(format!(
                    "--psi {depth}: is psi {a:.3} before camera {}, {b:.3} before {}: study their nets one by one",
                    first.camera.name, camera.name
                )));
            }
        }
        Ok(psi)
    }

    /// What was run, as tables and reports state it: every option that their numbers depend on.
    fn command_line(&self) -> String {
        let list = |items: Vec<String>| items.join(",");
        let psi = list(self.psi.iter().map(ToString::to_string).collect());
        let noise = list(self.noise().iter().map(ToString::to_string).collect());
        let (nets, Self { tone, stride, photographs, .. }) = (self.nets.join(","), self);
        let photos = &photographs.photos;
        let exact = if self.kernels.exact { " --exact" } else { "" };
        format!(
            "edof study kodak --tone {tone} --nets {nets} --psi {psi} --noise {noise} --stride {stride} --photos {photos}{exact}"
        )
    }
}
