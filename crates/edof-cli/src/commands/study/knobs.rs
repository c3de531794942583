//! `edof study knobs`: what can be left out.

use super::nets;
use super::options::{Outputs, Photographs, machine, unless_interrupted};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use edof_spec::provenance::Input;
use edof_spec::{Noise, Stride};
use edof_study::dictionary::Dictionary;
use edof_study::journal::{Header, Journal, Shard};
use edof_study::knobs::{self, Knob, Knobs, KnobsError, Plan, Row};
use edof_study::kodak::KodakError;
use std::path::PathBuf;
use std::sync::Arc;

/// Speed against error of everything that can be left out, each knob a curve with its default marked
///
/// Kernel energy, wavelengths and depths of a capture; stride and bits of a network; atoms of OMP, steps of FISTA, their window, and the
/// noise that a filter is prepared for. Rows are written to --rows as they come; the same command goes on where it was stopped.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study knobs --rows knobs.jsonl --report knobs.html
  edof study knobs --rows knobs.jsonl --knobs stride,atoms --photos 1,4 --psi 4")]
pub struct Args {
    /// File of rows, JSON lines; gone on with if it is there
    #[arg(long, value_name = "FILE")]
    rows: PathBuf,

    /// Which knobs: kernel-energy, wavelengths, depths, stride, bits, atoms, steps, window, noise-class [default: all]
    #[arg(long, value_delimiter = ',', value_name = "KNOB,…")]
    knobs: Vec<Knob>,

    /// Net of the knobs stride and bits, by name or weight file; its camera is that of all knobs
    #[arg(long, default_value = "edof-t4w12", value_name = "NET")]
    net: String,

    /// Depth: the defocus parameter in radians
    #[arg(long, default_value_t = 8.0, allow_hyphen_values = true)]
    psi: f64,

    /// Noise, where something is reconstructed
    #[arg(long, default_value = "0.01", value_name = "NOISE")]
    noise: Noise,

    /// Sharp dictionary of pursuits, as edof study dictionary writes it [default: the one inside the program]
    #[arg(long, value_name = "FILE")]
    dictionary: Option<PathBuf>,

    #[command(flatten)]
    photographs: Photographs,

    /// A part of the study, such as 2/8 for the second of eight; edof study merge puts their files together
    #[arg(long, default_value_t = Shard::WHOLE, value_name = "I/N")]
    shard: Shard,

    #[command(flatten)]
    outputs: Outputs,
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = nets::read(Files::new(ui).reads_all(&args.dictionary), std::slice::from_ref(&args.net));
    let files = files.reads_pictures_of(args.photographs.folder.path()?).writes("--rows", &args.rows);
    args.outputs.of(files).check()?;
    let (photos, notes) = args.photographs.load(ui)?;
    let plan = args.plan(ui)?;
    notes.iter().for_each(|note| ui.note(note));
    let mut journal = Journal::open(&args.rows, Header::of::<Row>(false, machine(ui)))?;
    let progress = ui.progress(1, "rows");
    let tell = |done: usize, of: usize, row: &Row| {
        progress.message(format!("{} {} on {}", row.knob.name(), row.value, row.image));
        progress.of(done as u64, of as u64);
        unless_interrupted()
    };
    match knobs::run(&plan, &photos, &mut journal, tell) {
        Err(KnobsError::Trial(KodakError::Stopped)) => return Err(Error::Interrupted),
        other => other?,
    }
    drop(progress);
    tell_rows(&journal, &args.outputs, ui)
}

/// Tables, reports and data of a file of rows.
///
/// # Errors
/// A file that cannot be written.
pub fn tell_rows(journal: &Journal<Row>, outputs: &Outputs, ui: &Ui) -> Result<(), Error> {
    let knobs = Knobs::new(journal.rows(), journal.header().machine.clone());
    let command = ui.provenance().command;
    let report = || Ok(knobs.report(&ui.signed(&command)));
    outputs.write(|| knobs.to_markdown(&command), report, journal.rows())?;
    ui.say(knobs.to_text())?;
    ui.json(&knobs)
}

impl Args {
    fn plan(&self, ui: &Ui) -> Result<Plan, Error> {
        let knobs = if self.knobs.is_empty() { Knob::ALL.to_vec() } else { self.knobs.clone() };
        let (network, network_sha256) = nets::float(&self.net, ui)?;
        ui.used(Input::camera(&network.origin.camera));
        // Quantizing takes its time: only where its knob is turned.
        let bits = if knobs.contains(&Knob::Bits) { Knob::Bits.values() } else { &[] };
        let bits: Vec<u32> = bits.iter().map(|&bits| bits as u32).collect();
        let fixed = nets::quantized(&network, &network_sha256, &bits, &[Stride::PATCH], ui)?;
        Ok(Plan {
            camera: network.origin.camera.clone(),
            psi: self.psi,
            noise: self.noise,
            network: Arc::new(network),
            network_sha256,
            fixed,
            dictionary: Arc::new(Dictionary::load(self.dictionary.as_deref())?),
            knobs,
            shard: self.shard,
        })
    }
}
