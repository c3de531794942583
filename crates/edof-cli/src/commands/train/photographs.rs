//! Which photographs a network learns from.

use crate::error::Error;
use edof_core::ColourFrame;
use edof_core::words::count;
use edof_io::photo;
use edof_io::photos::{self, Selection};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Name that the photographs of the study's test set begin with; they are never trained on unless asked for.
const STUDY_PREFIX: &str = "kodim";

/// A photograph to learn from.
pub struct Photograph {
    /// Name of its folder.
    pub folder: String,
    /// Name of its file, without the ending.
    pub stem: String,
    /// File of the photograph.
    pub file: PathBuf,
    /// Values of the photograph, 0…1; sides even.
    pub frame: ColourFrame,
}

impl Photograph {
    /// Folder and name.
    pub fn name(&self) -> String {
        format!("{}/{}", self.folder, self.stem)
    }
}

/// Takes photographs out of those to learn from.
///
/// # Errors
/// A name that none of them has: a slip of the pen would train on what is to be held back.
pub fn leave_out(photographs: &mut Vec<Photograph>, names: &[String]) -> Result<(), Error> {
    for name in names {
        let before = photographs.len();
        photographs.retain(|photograph| photograph.stem != *name);
        if photographs.len() == before {
            return Err(Error::message(format!(
                "--leave-out {name}: none of the photographs to learn from has this name"
            )));
        }
    }
    if photographs.is_empty() {
        return Err(Error::message("--leave-out: leaves no photograph to learn from"));
    }
    Ok(())
}

/// The photographs to learn from; `note` is given a remark for each that had to be skipped. Without a folder they are the study's and, where
/// they are, those that came besides; without a choice, all but the study's test photos.
///
/// # Errors
/// A folder that cannot be read, or nothing to learn from.
pub fn photographs(
    folders: &[PathBuf],
    choice: Option<&Selection>,
    note: &dyn Fn(String),
) -> Result<Vec<Photograph>, Error> {
    let folders = if folders.is_empty() {
        std::iter::once(photos::default_folder()?).chain(photos::more_folder()).collect()
    } else {
        folders.to_vec()
    };
    let (mut photographs, mut found) = (vec![], 0);
    for folder in &folders {
        let photo::Folder { photographs: named, skipped, remarks } = photo::load_folder(folder)?;
        remarks.into_iter().for_each(note);
        for error in &skipped {
            note(format!("skipped {error}"));
        }
        if !skipped.is_empty() {
            note(format!(
                "{} of {} skipped",
                skipped.len(),
                count(skipped.len() + named.len(), "photograph")
            ));
        }
        found += named.len();
        let files = edof_io::picture::of_folder(folder).unwrap_or_default();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let wanted = named.into_iter().filter(|(stem, _)| match choice {
            Some(selection) => selection.holds(stem),
            None => !(stem.starts_with(STUDY_PREFIX) && Selection::Test.holds(stem)),
        });
        photographs.extend(wanted.map(|(stem, frame)| {
            // Whole Bayer cells.
            let (height, width) = frame.size();
            let frame = frame.crop(0, 0, height & !1, width & !1);
            let file = files.iter().find(|file| file.file_stem().is_some_and(|own| *own == *stem));
            let file = file.cloned().unwrap_or_else(|| folder.join(&stem));
            Photograph { folder: name.clone(), stem, file, frame }
        }));
    }
    if photographs.is_empty() {
        let folders: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
        return Err(Error::message(format!(
            "{}: {}, none to be trained on; choose with --photos, as in --photos all",
            folders.join(", "),
            count(found, "photograph")
        )));
    }
    Ok(photographs)
}

/// Names of the folders, in order, each once.
pub(super) fn folders(photographs: &[Photograph]) -> Vec<&str> {
    let mut seen = BTreeSet::new();
    photographs.iter().map(|p| p.folder.as_str()).filter(|folder| seen.insert(*folder)).collect()
}
