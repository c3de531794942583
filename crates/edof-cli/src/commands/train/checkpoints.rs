//! What an unfinished run of `edof train` left beside OUT.

use super::options::Args;
use crate::error::Error;
use crate::weights;
use edof_core::storage::digest::sha256;
use edof_train::recipe::Recipe;
use std::fs::{File, TryLockError};
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

/// Keeps other trainings from the file that this one is going to write, until the value is dropped. None where the system has no place for it.
///
/// # Errors
/// Another training that is running writes the same file.
pub(super) fn lock(out: &Path) -> Result<Option<File>, Error> {
    let place = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    let name = sha256(place.as_os_str().as_encoded_bytes());
    let Some(folder) = edof_cosim::user_cache("running") else { return Ok(None) };
    let Ok(file) = std::fs::create_dir_all(&folder)
        .and_then(|()| File::create(folder.join(name).with_extension("lock")))
    else {
        return Ok(None);
    };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Error::message(format!(
            "--out {}: another training is writing it; wait for it, or name another file",
            out.display()
        ))),
        _ => Ok(Some(file)),
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
