//! Blurred photographs, kept in the user's cache from one training to the next.

use super::photographs::Photograph;
use crate::error::Error;
use crate::ui::Ui;
use crate::{interrupt, said};
use edof_core::ColourFrame;
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_train::dataset::{Dataset, DatasetOptions};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Data sets that are kept at most, the last used ones.
const MAX_KEPT: usize = 3;
/// A larger one is not kept.
const MAX_BYTES: u64 = 4 << 30;

/// What photographs are made into, from the cache where it is there.
pub(super) fn dataset(
    photographs: &[Photograph],
    camera: &Camera,
    options: DatasetOptions,
    photos: &[Input],
    use_cache: bool,
    ui: &Ui,
) -> Result<Dataset, Error> {
    let frames: Vec<ColourFrame> = photographs.iter().map(|p| p.frame.clone()).collect();
    let bytes = blurred_bytes(&frames, &options);
    said::memory("photographs (fewer --variants, --depths or --images take less)", bytes)?;
    let key = key(camera, &options, photos);
    let file = use_cache.then(|| edof_cosim::user_cache("blurs")).flatten().map(|folder| folder.join(&key));
    if let Some(file) = &file
        && let Some(kept) = Dataset::kept(file, &key, &frames, options.clone())
    {
        let _ = std::fs::File::options()
            .append(true)
            .open(file)
            .and_then(|file| file.set_modified(SystemTime::now()));
        ui.note(format!("blurred photographs: as kept by an earlier training in {}", file.display()));
        return Ok(kept);
    }
    let bar = ui.progress(frames.len() as u64, "blur");
    let tell = |done: usize, _| {
        bar.set(done as u64);
        interrupt::flow()
    };
    let name = |index: usize| photographs[index].file.display().to_string();
    let made = Dataset::new(&frames, camera, options, tell).map_err(|error| said::dataset(error, name))?;
    let dataset = made.ok_or(Error::Interrupted)?;
    if let Some(file) = file.filter(|_| dataset.bytes() <= MAX_BYTES) {
        // What cannot be kept is made again.
        let _ = dataset.keep(&file, &key);
        let _ = forget_old(file.parent().unwrap_or(Path::new("")));
    }
    Ok(dataset)
}

/// Memory that photographs take, sharp and blurred.
pub fn blurred_bytes(frames: &[ColourFrame], options: &DatasetOptions) -> f64 {
    let words: usize = frames.iter().map(|f| f.planes.len() * size_of::<u16>()).sum();
    let looks = options.augmentation.variants as f64;
    words as f64 * looks * (options.psis.len() * (1 + options.further_foci.len()) + 1) as f64
}

/// Everything that the blurs depend on.
fn key(camera: &Camera, options: &DatasetOptions, photos: &[Input]) -> String {
    let photos: Vec<String> = photos.iter().map(|photo| photo.sha256.clone()).collect();
    let program = crate::provenance::program();
    let text = format!(
        "{} {} {} {options:?} {} {}",
        env!("CARGO_PKG_VERSION"),
        program.revision,
        program.compiler,
        camera.to_json(),
        photos.join(" ")
    );
    sha256(text.as_bytes())
}

/// Deletes all but the last used files of a folder.
fn forget_old(folder: &Path) -> std::io::Result<()> {
    let mut files: Vec<(SystemTime, PathBuf)> = vec![];
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        // What begins with a dot is being written.
        if !entry.file_name().as_encoded_bytes().starts_with(b".") {
            files.push((entry.metadata()?.modified()?, entry.path()));
        }
    }
    files.sort();
    files.iter().rev().skip(MAX_KEPT).try_for_each(|(_, file)| std::fs::remove_file(file))
}
