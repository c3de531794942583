//! `edof study kodak`: the main experiment.

use super::nets;
use super::options::{Externals, Kernels, MayKeepRows, Outputs, Photographs, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::lens::Depth;
use crate::said;
use crate::ui::Ui;
use edof_core::{Noise, Tone};
use edof_study::kodak::{Conditions, Kodak, Plan};
use edof_study::setup::{Setup, setups};
use edof_study::study_report::StudyReport;
use edof_study::summary::Study;
use edof_study::trial::usual_noise;
use std::path::PathBuf;

/// PSNR and SSIM on photographs, captured by each network's camera, reconstructed in float, in the board's format and in fixed point
///
/// Kernels hold 99.9 % of the energy (all of it with --exact), the sensor has 16 bits. PSNR is over red, green and blue with
/// peak 1, a border of 8 pixels cropped. With --tone linear a photograph's samples are treated as linear light, and results are not clipped.
/// With --tone srgb they are decoded to light; the picture is measured after encoding and clipping to 0…1, as a screen
/// does, and also as light. Each network runs under both tones and makes rows NAME.float (RGB), NAME.float422 (the same
/// in the board's 4:2:2 format) and NAME.fixed. demosaic-malvar is the coded frame as an ordinary camera would show it.
/// A network of several exposures has rows behind its camera at all foci, which share the exposure time: each has its share of the electrons and
/// noise of its own. Gaussian noise has no electrons to share, so such a network has no rows there.
/// With --rows FILE rows are written when measured; the same command resumes a stopped study.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study kodak --nets edof-t4w12-outer --json study.json
  edof study kodak --tone srgb --nets edof-t4w12-outer --noise sensor,sensor:gain=8 --markdown s.md
  edof study kodak --nets my-low+my-mid+my-high --markdown s.md
  edof study kodak --nets my/net.safetensors --photos train --psi 8
  edof study kodak --nets edof-t4w12-outer --rows rows.jsonl --markdown study.md
  edof study kodak --nets edof-t4w12-outer --rows rows.jsonl --latex table.tex")]
pub struct Args {
    #[command(flatten)]
    rows: MayKeepRows,

    /// Networks by name or weight file, each with the camera that it was trained for. LOW+MID+HIGH is one method of several networks: each
    /// frame is reconstructed by the one that was trained for its noise; its rows are NAME-by-noise, where NAME is what the names share
    #[arg(long, value_delimiter = ',', required = true, value_name = "NET,…")]
    nets: Vec<String>,

    /// Encoding of the photographs: linear (the paper's convention: samples are linear light), or srgb
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    tone: Tone,

    /// Depths: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera states nominal_m
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
    externals: Externals,

    /// Also write the table as LaTeX (package booktabs), with standard errors over photographs
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    kernels: Kernels,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui), &args.nets).reads_pictures_of(args.photographs.folder.path()?);
    args.rows.of(args.outputs.of(files).may_write("--latex", args.latex.as_ref())).check()?;
    let stride = said::stride(args.stride)?;
    let (mut notes, mut loaded) = (vec![], vec![]);
    for name in &args.nets {
        let (net, missing) = nets::of_kodak(name, stride, ui)?;
        loaded.push(net);
        notes.extend(missing);
    }
    notes.extend(nets::of_other_tone(&args.nets, args.tone)?);
    let externals = args.externals.methods()?;
    let mut setups = setups(loaded)?;
    // Programs of others take one raw frame.
    for setup in setups.iter_mut().filter(|setup| setup.further_foci.is_empty()) {
        setup.methods.extend(externals.iter().cloned());
    }
    let conditions = args.conditions(&setups)?;
    let (photos, skipped) = args.photographs.load(ui)?;
    notes.into_iter().chain(skipped).for_each(|note| ui.note(note));

    let plan = Plan { setups, conditions };
    let mut experiment = Kodak::new(&plan, &photos);
    let journal = measured(&mut experiment, args.rows.rows.as_ref(), &args.rows.part, ui)?;
    if let Some(path) = &args.latex {
        let study = Study::new(&journal.rows(), String::new())?;
        let made = ui.made(journal.makers(), journal.file());
        edof_core::storage::atomic::write(path, study.to_latex(&made).as_bytes())?;
    }
    tell::<Study>(&journal, &args.outputs, ui)
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
        let psi = said::psis(&self.psi, &first.camera)?;
        for Setup { camera, .. } in others {
            let own = said::psis(&self.psi, camera)?;
            if let Some(((depth, a), b)) = self.psi.iter().zip(&psi).zip(own).find(|((_, a), b)| **a != *b) {
                return Err(Error::message(format!(
                    "--psi {depth}: is psi {a:.3} before camera {}, {b:.3} before {}: study their nets one by one",
                    first.camera.name, camera.name
                )));
            }
        }
        Ok(psi)
    }
}
