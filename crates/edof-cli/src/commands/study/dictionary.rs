//! `edof study dictionary`: the sharp dictionary of the pursuits.

use super::options::Folder;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::kind::Kind;
use crate::ui::Ui;
use edof_study::methods::dictionary::{self, Recipe};
use std::path::PathBuf;

/// Learn the dictionary of 8×8 colour patches of OMP and FISTA by k-SVD
///
/// Photographs' samples are treated as linear light. Three of the atoms are one colour each and are not changed; every patch may use
/// them. The same photographs, numbers and seed give the same file.
#[derive(clap::Args)]
#[command(after_help = "\
Example: the dictionary that comes with the program
  edof study dictionary --out crates/edof-study/data/dictionary-192.safetensors")]
pub struct Args {
    /// File to write (safetensors)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Atoms, the three of one colour among them
    #[arg(long, default_value_t = 192, value_name = "N")]
    atoms: usize,

    /// Atoms that a patch may use besides those
    #[arg(long, default_value_t = 8, value_name = "N")]
    sparsity: usize,

    /// Patches to learn from, the same number from each photograph
    #[arg(long, default_value_t = 40_000, value_name = "N")]
    patches: usize,

    /// Rounds of k-SVD
    #[arg(long, default_value_t = 30, value_name = "N")]
    rounds: usize,

    /// Seed of the choice of patches
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,

    #[command(flatten)]
    folder: Folder,

    /// Photographs: train (all except every third number), test, all, or numbers as in 1,2
    #[arg(long, default_value = "train")]
    photos: String,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// Nothing found, numbers out of range, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files =
        Files::new(ui).reads_pictures_of(args.folder.path()?).writes_as(Kind::Weights, "--out", &args.out);
    files.keeps(args.force).check()?;
    let (photos, skipped) = args.folder.load(&args.photos, ui)?;
    skipped.iter().for_each(|note| ui.note(note));
    let Args { atoms, sparsity, patches, rounds, seed, .. } = args;
    let recipe = Recipe { atoms, sparsity, patches, rounds, seed };
    let progress = ui.progress(rounds as u64, "rounds");
    let (learned, error) = dictionary::learn_with(&photos, recipe, |round, error| {
        progress.message(format!("{error:.4} of a value left"));
        progress.set(round as u64);
        interrupt::flow()
    })?;
    drop(progress);
    interrupt::check()?;
    dictionary::save(&args.out, &learned, recipe, error, ui.provenance())?;
    ui.say(format!(
        "{}: {atoms} atoms from {} photographs; {sparsity} of them and a colour leave {error:.4} of a value (root mean square)",
        args.out.display(),
        photos.len()
    ))?;
    ui.json(&serde_json::json!({ "recipe": recipe, "error": error }))
}
