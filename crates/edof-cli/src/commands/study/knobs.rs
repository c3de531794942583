//! `edof study knobs`: what can be left out.

use super::nets;
use super::options::{Outputs, Photographs, Rows, measured, tell};
use crate::error::Error;
use crate::files::Files;
use crate::lens::Depth;
use crate::ui::Ui;
use edof_core::{Noise, Stride};
use edof_study::knobs::{KNOBS, Knob, Knobs, Plan, Turning};
use edof_study::methods::dictionary::Dictionary;
use std::path::PathBuf;
use std::sync::Arc;

/// Speed against error of every setting that can be reduced, one curve per knob with its default marked
///
/// Kernel energy, wavelengths and depths of a capture; stride, bits (of all words, or of one matrix) and non-zero budget of a network; layers of
/// untrained ones; atoms of OMP, steps of FISTA, their window, and the noise that a filter is prepared for. Rows are written to --rows when measured; the same command resumes a stopped study.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study knobs --rows knobs.jsonl --report knobs.html
  edof study knobs --rows knobs.jsonl --knobs stride,atoms --photos 1,4 --psi 4")]
pub struct Args {
    #[command(flatten)]
    rows: Rows,

    /// Knobs to measure: kernel-energy, wavelengths, depths, stride, bits, analysis-bits, recurrent-bits, dictionary-bits,
    /// budget, layers, atoms, steps, window, noise-class [default: all]
    #[arg(long, value_delimiter = ',', value_name = "KNOB,…")]
    knobs: Vec<&'static Knob>,

    /// Network of the knobs stride, bits and budget, by name or weight file; its camera is used for all knobs
    #[arg(long, default_value = "edof-t4w12", value_name = "NET")]
    net: String,

    /// Depth: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or a distance as in 1.5m if the camera states nominal_m
    #[arg(long, default_value = "8", allow_hyphen_values = true)]
    psi: Depth,

    /// Noise of the knobs that reconstruct
    #[arg(long, default_value = "0.01", value_name = "NOISE")]
    noise: Noise,

    /// Sharp dictionary of pursuits, as edof study dictionary writes it [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    dictionary: Option<PathBuf>,

    #[command(flatten)]
    photographs: Photographs,

    #[command(flatten)]
    outputs: Outputs,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui).reads_all(&args.dictionary), std::slice::from_ref(&args.net));
    let files = files.reads_pictures_of(args.photographs.folder.path()?).writes("--rows", &args.rows.rows);
    args.outputs.of(files).check()?;
    args.rows.check::<edof_study::knobs::Row>()?;
    let (photos, notes) = args.photographs.load(ui)?;
    let plan = args.plan(ui)?;
    notes.iter().for_each(|note| ui.note(note));
    let mut experiment = Turning::new(&plan, &photos);
    let journal = measured(&mut experiment, Some(&args.rows.rows), &args.rows.part, ui)?;
    tell::<Knobs>(&journal, &args.outputs, ui)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        let knobs = if self.knobs.is_empty() { KNOBS.iter().collect() } else { self.knobs.clone() };
        let (network, network_sha256) = nets::float(&self.net, ui)?;
        ui.used(network.origin.camera.input());
        // Quantizing takes its time: only where one of its knobs is turned.
        let mut bits: Vec<u32> = knobs.iter().flat_map(|knob| knob.bits).copied().collect();
        bits.sort_unstable();
        bits.dedup();
        let fixed = nets::quantized(&network, &network_sha256, &bits, &[Stride::PATCH], ui)?;
        Ok(Plan {
            camera: network.origin.camera.clone(),
            psi: self.psi.psi(&network.origin.camera)?,
            noise: self.noise,
            network: Arc::new(network),
            network_sha256,
            fixed,
            dictionary: Arc::new(Dictionary::load(self.dictionary.as_deref())?),
            knobs,
        })
    }
}
