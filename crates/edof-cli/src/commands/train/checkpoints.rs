//! What an unfinished run of `edof train` left beside OUT.

use super::options::Args;
use crate::error::Error;
use crate::weights;
use edof_train::recipe::Recipe;
use std::path::{Path, PathBuf};

/// Rejects a new run where an unfinished one left a checkpoint, and `--resume` without a checkpoint.
///
/// # Errors
/// Either of these.
pub(super) fn check(args: &Args, seeds: &[(Recipe, PathBuf)]) -> Result<(), Error> {
    let left = seeds.iter().map(|(_, file)| file).find(|file| file.exists());
    match (left, args.resume) {
        (Some(file), false) => Err(Error::message(format!(
            "{}: checkpoint of an unfinished run; continue it with --resume, or delete the file",
            file.display()
        ))),
        (None, true) => Err(Error::message(format!(
            "--resume: there is no checkpoint {}{}",
            seeds[0].1.display(),
            instead(args)
        ))),
        _ => Ok(()),
    }
}

/// What there is where a checkpoint was expected, and what to do.
fn instead(args: &Args) -> String {
    let out = args.out.display();
    let begins = |name: &Path| {
        name.as_os_str().as_encoded_bytes().starts_with(args.out.as_os_str().as_encoded_bytes())
    };
    let folder = args.out.parent().filter(|folder| !folder.as_os_str().is_empty());
    let beside = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten().flatten();
    let mut others: Vec<String> = beside
        .map(|entry| folder.map_or_else(|| entry.file_name().into(), |folder| folder.join(entry.file_name())))
        .filter(|file: &PathBuf| {
            begins(file) && file.extension().is_some_and(|ending| ending == "checkpoint")
        })
        .map(|file| file.display().to_string())
        .collect();
    others.sort();
    if !others.is_empty() {
        return format!("; there is {}, of other seeds: give the --seed of that run", others.join(", "));
    }
    match weights::in_words(&args.out) {
        Some(network) => {
            format!(
                "; {out} is finished, {network}: leave --resume out and name another --out, or give --force to train anew"
            )
        }
        None => "; leave --resume out to begin".to_owned(),
    }
}
