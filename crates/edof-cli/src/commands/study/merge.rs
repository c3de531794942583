//! `edof study merge`: the parts of a study that several machines measured.

use super::options::{Outputs, tell};
use crate::error::Error;
use crate::files::{Files, Force};
use crate::ui::Ui;
use edof_study::aperture::Aperture;
use edof_study::aperture::networks::ApertureNetworks;
use edof_study::codes::Codes;
use edof_study::journal::{Header, Journal, Line, Mixing};
use edof_study::knobs::Knobs;
use edof_study::known_blurs::KnownBlurs;
use edof_study::lens_networks::LensNetworks;
use edof_study::multi_depth::MultiDepth;
use edof_study::speed::Speed;
use edof_study::study_report::StudyReport;
use edof_study::summary::Study;
use edof_study::tolerances::Tolerances;
use std::path::PathBuf;

/// Merge the result files of one study, as if one run had measured all rows
///
/// Rows have keys (hashes of photographs, weights and camera, and settings), so files may overlap. Rows with the same key
/// must be equal except for times. The merged file equals that of an uninterrupted study, except for times.
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  for i in 1 2 3; do edof study single-depth --shard $i/3 --rows part-$i.jsonl & done; wait
  edof study merge --out rows.jsonl part-1.jsonl part-2.jsonl part-3.jsonl --report speed.html")]
pub struct Args {
    /// Files of rows, as --rows of kodak, single-depth, multi-depth, blind, codes, knobs, aperture, aperture-networks, lens-networks or tolerances
    /// wrote them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// File of rows to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Accept rows of different machines, whose times cannot be compared; the tables name all machines
    #[arg(long)]
    any_machine: bool,

    /// Accept rows measured by different revisions or compilers; the tables name all of them
    #[arg(long)]
    any_revision: bool,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// Files that are none of rows, of different studies, or that contradict each other.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads_all(&args.files).writes("--out", &args.out);
    args.outputs.of(files.keeps(args.force)).check()?;
    // The first file says of what study they all are.
    let study = args.files.first().map(|file| Header::read(file)).transpose()?.map(|header| header.study);
    match study.as_deref() {
        Some(study) if study == study_of::<Aperture>() => merged::<Aperture>(&args, ui),
        Some(study) if study == study_of::<ApertureNetworks>() => merged::<ApertureNetworks>(&args, ui),
        Some(study) if study == study_of::<Codes>() => merged::<Codes>(&args, ui),
        Some(study) if study == study_of::<Knobs>() => merged::<Knobs>(&args, ui),
        Some(study) if study == study_of::<LensNetworks>() => merged::<LensNetworks>(&args, ui),
        Some(study) if study == study_of::<MultiDepth>() => merged::<MultiDepth>(&args, ui),
        Some(study) if study == study_of::<KnownBlurs>() => merged::<KnownBlurs>(&args, ui),
        Some(study) if study == study_of::<Study>() => merged::<Study>(&args, ui),
        Some(study) if study == study_of::<Tolerances>() => merged::<Tolerances>(&args, ui),
        _ => merged::<Speed>(&args, ui),
    }
}

/// What a study's files call it.
const fn study_of<T: StudyReport>() -> &'static str {
    <T::Row as Line>::STUDY
}

/// All rows, in a file of their own, and what they say.
fn merged<T: StudyReport>(args: &Args, ui: &Ui) -> Result<(), Error> {
    let mixing = Mixing { any_machine: args.any_machine, any_revision: args.any_revision };
    let mut journal = Journal::merged(&args.out, &args.files, mixing)?;
    journal.notes().iter().for_each(|note| ui.note(note));
    journal.finish()?;
    tell::<T>(&journal, &args.outputs, ui)
}
