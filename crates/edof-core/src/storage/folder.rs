//! A folder of generated files that may be generated again. A manifest lists every file with its SHA-256, and is sealed by
//! one of its own; so files of the program are distinguished from files that a user added or changed, and only the former are replaced.

use crate::storage::{atomic, digest, input};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

/// File that lists the others.
pub const MANIFEST: &str = "manifest.json";
/// Field of the manifest that holds its own hash.
const SEAL: &str = "manifest_sha256";
/// At most N files are named in an error.
const NAMED: usize = 6;
/// At most N files are looked for.
const COUNTED: usize = 1000;

/// A folder that is not written, or not to its end.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum FolderError {
    /// All of a disk.
    #[error("{folder}: is the root of the file system, expected a folder for the results alone", folder = .0.display())]
    IsRoot(PathBuf),
    /// A file of that name.
    #[error("{folder}: is a file, expected a folder", folder = .0.display())]
    IsFile(PathBuf),
    /// Two programs write there.
    #[error("{folder}: another edof is writing into it; wait until it ends, or name another folder", folder = .0.display())]
    Busy(PathBuf),
    /// Somebody's own files.
    #[error(
        "{folder}: holds what no earlier run wrote, or what was changed since: {files}; --force replaces what is in the way and leaves the rest", folder = folder.display()
    )]
    Foreign { folder: PathBuf, files: String },
    /// A folder where a file should be, or the other way round.
    #[error("{folder}: {file} cannot be written, since a folder, file or link is in its way", folder = folder.display(), file = file.display())]
    InTheWay { folder: PathBuf, file: PathBuf },
    /// The system reported an error.
    #[error("{0}")]
    Write(String),
}

/// Files to write, by their path in the folder.
pub type Contents = BTreeMap<PathBuf, String>;

/// The manifest: `about`, the list of files, and the seal.
#[must_use]
pub fn manifest(about: Value, files: &Contents) -> Value {
    let mut manifest = about;
    manifest["files"] = files
        .iter()
        .map(|(path, text)| json!({ "path": path, "bytes": text.len(), "sha256": digest::sha256(text.as_bytes()) }))
        .collect();
    manifest[SEAL] = seal(&manifest).into();
    manifest
}

/// Whether results may have that folder, for anybody who has work to do first. A few files at paths where results may be written are no
/// matter yet: they may be equal to what will be written.
///
/// # Errors
/// [`FolderError::IsFile`], [`FolderError::IsRoot`], or [`FolderError::Foreign`] for a folder of files elsewhere, or of far more than an
/// output.
pub fn check(out: &Path, force: bool, may_be_result: impl Fn(&Path) -> bool) -> Result<(), FolderError> {
    if out.canonicalize().is_ok_and(|place| place.parent().is_none()) {
        return Err(FolderError::IsRoot(out.to_owned()));
    }
    if !out.exists() {
        return Ok(());
    }
    if !out.is_dir() {
        return Err(FolderError::IsFile(out.to_owned()));
    }
    let ours = untouched(out);
    let foreign =
        if force { BTreeSet::new() } else { foreign(out, |path| ours.contains(path)).unwrap_or_default() };
    let elsewhere: BTreeSet<PathBuf> = foreign.iter().filter(|path| !may_be_result(path)).cloned().collect();
    let rejected = |files| Err(FolderError::Foreign { folder: out.to_owned(), files: named(files) });
    match (foreign.len() == COUNTED || !ours.is_empty(), elsewhere.is_empty()) {
        (false, true) => Ok(()),
        (true, true) if foreign.len() < COUNTED => Ok(()),
        // Without a list of what is ours, what may be a result may be one.
        (false, false) => rejected(&elsewhere),
        (true, _) => rejected(&foreign),
    }
}

/// Writes `files` and their manifest. Whatever stands in the folder and is neither an untouched file of an earlier output
/// nor what would be written anyway is named and rejected; with `force`, such a file is replaced where a new one takes its
/// path and left alone elsewhere. All files are complete on the disk before the first one takes its place.
///
/// # Errors
/// What was rejected, or a folder that cannot be written.
pub fn write(out: &Path, files: Contents, manifest: &Value, force: bool) -> Result<(), FolderError> {
    let mut files = files;
    files.insert(MANIFEST.into(), format!("{manifest:#}\n"));
    check(out, force, |_| true)?;
    let is_new = !out.exists();
    atomic::make_folders(out).map_err(|e| failed(out, &e))?;
    // Anybody who writes here at the same time would take our unfinished files for a stranger's. Ends with the process.
    let folder = fs::File::open(out).map_err(|e| failed(out, &e))?;
    if let Err(fs::TryLockError::WouldBlock) = folder.try_lock() {
        return Err(FolderError::Busy(out.to_owned()));
    }
    let written = replace(out, &files, force);
    if written.is_err() && is_new {
        // Only an empty folder goes.
        let _ = fs::remove_dir(out);
    }
    written
}

fn replace(out: &Path, files: &Contents, force: bool) -> Result<(), FolderError> {
    let ours = untouched(out);
    if !force {
        let same = |path: &Path| {
            files.get(path).is_some_and(|text| holds(&out.join(path), &digest::sha256(text.as_bytes())))
        };
        let foreign = foreign(out, |path| ours.contains(path) || same(path)).map_err(|e| failed(out, &e))?;
        if !foreign.is_empty() {
            return Err(FolderError::Foreign { folder: out.to_owned(), files: named(&foreign) });
        }
    }
    let in_the_way = |path: &PathBuf| {
        let is_folder = fs::symlink_metadata(out.join(path)).is_ok_and(|what| what.is_dir());
        is_folder
            || above(path).any(|above| fs::symlink_metadata(out.join(above)).is_ok_and(|what| !what.is_dir()))
    };
    if let Some(path) = files.keys().find(|path| in_the_way(path)) {
        return Err(FolderError::InTheWay { folder: out.to_owned(), file: path.clone() });
    }
    let work = atomic::work_folder(out).map_err(|e| failed(out, &e))?;
    for (path, text) in files {
        let put_there = |place: &Path| atomic::write_for(&out.join(path), place, text.as_bytes());
        put(&work.path().join(path), put_there).map_err(|e| failed(&out.join(path), &e))?;
    }
    // The manifest last: until then the old one lists our files.
    for path in files.keys().filter(|path| **path != *MANIFEST).chain([&PathBuf::from(MANIFEST)]) {
        let place = out.join(path);
        put(&place, |place| fs::rename(work.path().join(path), place)).map_err(|e| failed(&place, &e))?;
    }
    for path in ours.iter().filter(|path| !files.contains_key(*path)) {
        let place = out.join(path);
        fs::remove_file(&place).map_err(|e| failed(&place, &e))?;
        // Folders that are empty now go, too.
        let _ = place.parent().map(fs::remove_dir);
    }
    let folders: BTreeSet<&Path> = files.keys().chain(&ours).filter_map(|path| path.parent()).collect();
    let mut there = folders.into_iter().map(|folder| out.join(folder)).filter(|folder| folder.is_dir());
    there.try_for_each(|folder| atomic::sync(&folder).map_err(|e| failed(&folder, &e)))
}

/// Makes a file in a folder that need not be there yet.
fn put(place: &Path, make: impl FnOnce(&Path) -> io::Result<()>) -> io::Result<()> {
    place.parent().map_or(Ok(()), atomic::make_folders)?;
    make(place)
}

fn failed(path: &Path, error: &io::Error) -> FolderError {
    FolderError::Write(format!("{}: cannot write: {}", path.display(), crate::storage::atomic::reason(error)))
}

fn named(paths: &BTreeSet<PathBuf>) -> String {
    let names: Vec<String> = paths.iter().take(NAMED).map(|path| path.display().to_string()).collect();
    let more = match paths.len() - names.len() {
        0 => String::new(),
        _ if paths.len() == COUNTED => " and many more".to_owned(),
        rest => format!(" and {rest} more"),
    };
    names.join(", ") + &more
}

/// Files and links of a folder and its folders that are not `ours`, [`COUNTED`] at most: the folder may be a whole disk. Links are not
/// followed.
fn foreign(out: &Path, ours: impl Fn(&Path) -> bool) -> io::Result<BTreeSet<PathBuf>> {
    let mut found = BTreeSet::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(out.join(&folder))? {
            let entry = entry?;
            let path = folder.join(entry.file_name());
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if !ours(&path) {
                found.insert(path);
            }
            if found.len() == COUNTED {
                return Ok(found);
            }
        }
    }
    Ok(found)
}

/// Folders above a file within the folder of results.
fn above(path: &Path) -> impl Iterator<Item = &Path> {
    path.ancestors().skip(1).filter(|above| !above.as_os_str().is_empty())
}

/// Whether a path of a manifest leads to a place within the folder, by no link.
fn is_within(out: &Path, path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
        && above(path).all(|above| fs::symlink_metadata(out.join(above)).is_ok_and(|what| what.is_dir()))
}

/// Files of an earlier output that are as they were written, by its manifest; none where there is no sealed manifest.
fn untouched(out: &Path) -> BTreeSet<PathBuf> {
    let text = input::read(&out.join(MANIFEST)).unwrap_or_default();
    let Ok(manifest) = serde_json::from_slice::<Value>(&text) else { return BTreeSet::new() };
    if manifest[SEAL] != seal(&manifest) {
        return BTreeSet::new();
    }
    let listed = manifest["files"].as_array().into_iter().flatten();
    let kept =
        listed.filter_map(|file| Some((PathBuf::from(file["path"].as_str()?), file["sha256"].as_str()?)));
    let kept = kept
        .filter(|(path, sha256)| is_within(out, path) && holds(&out.join(path), sha256))
        .map(|(path, _)| path);
    kept.chain([MANIFEST.into()]).collect()
}

/// Whether a file, and no link to one, has that SHA-256.
fn holds(file: &Path, sha256: &str) -> bool {
    fs::symlink_metadata(file).is_ok_and(|what| what.is_file())
        && fs::read(file).is_ok_and(|bytes| digest::sha256(&bytes) == sha256)
}

/// Hash of a manifest without its seal.
fn seal(manifest: &Value) -> String {
    let mut open = manifest.clone();
    if let Some(fields) = open.as_object_mut() {
        fields.remove(SEAL);
    }
    digest::sha256(open.to_string().as_bytes())
}
