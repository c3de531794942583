//! Photographs that a command is given, with remarks in the program's words.

use crate::error::Error;
use crate::ui::Ui;
use edof::job::PictureNote;
use edof::job::photograph;
pub use edof::job::photograph::{Tones, whole_cells};
use edof_core::words::count;
use edof_core::{ColourFrame, Tone};
use std::path::Path;

/// Reads a photograph, and the tone of its values; of an odd side the last row or column is cut off, with a note.
///
/// # Errors
/// A file that is not a photograph.
pub fn load(path: &Path, tones: Tones, ui: &Ui) -> Result<(ColourFrame, Tone), Error> {
    Ok(photograph::load(path, tones, &|note| ui.note(in_words(&note)))?)
}

/// A remark on a picture, by the option that it is about.
pub fn in_words(note: &PictureNote) -> String {
    match note {
        PictureNote::ToneOverridden { path, given, stated } => {
            format!("--tone {given}: taken, though {} states {stated}", path.display())
        }
        PictureNote::Linear { path, stated } => {
            format!("{}: states {stated}; its values are taken as linear", path.display())
        }
        PictureNote::CurveNotApplied { path, stated, tone } => format!(
            "{}: states {stated}, which is not applied; its values are taken as {tone}",
            path.display()
        ),
        PictureNote::GamutNotApplied { path, stated } => format!(
            "{}: states colours of {stated}, which are not converted; its values are taken as sRGB's",
            path.display()
        ),
        PictureNote::FirstOfSeveral { path } => {
            format!("{}: has several pictures; the first is read", path.display())
        }
        PictureNote::Cropped { path, from, to } => {
            format!("{}: {from} cropped to {to}, whole Bayer cells", path.display())
        }
        PictureNote::Holes { path, pixels } => {
            let pixels = count(*pixels, "pixel");
            format!(
                "{}: {pixels} without a reading (0 or 65535), filled with the nearest one",
                path.display()
            )
        }
        PictureNote::OutsideOfLimits { path, pixels, limits } => {
            let (path, outside) = (path.display(), count(*pixels, "pixel"));
            format!("{path}: {outside} outside of --range {limits}, taken to be at its ends")
        }
    }
}
