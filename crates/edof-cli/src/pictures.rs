//! Photographs that a command is given, with remarks in the program's words.

use crate::error::Error;
use crate::ui::Ui;
use edof::job::Note;
use edof::job::photograph;
pub use edof::job::photograph::{Tones, whole_cells};
use edof_core::{ColourFrame, Tone};
use std::path::Path;

/// Reads a photograph, and the tone of its values; of an odd side the last row or column is cut off, with a note.
///
/// # Errors
/// A file that is not a photograph.
pub fn load(path: &Path, tones: Tones, ui: &Ui) -> Result<(ColourFrame, Tone), Error> {
    Ok(photograph::load(path, tones, &|note| ui.note(in_words(&note)))?)
}

/// A remark, by the option that it is about.
pub fn in_words(note: &Note) -> String {
    match note {
        Note::ToneOverridden { path, given, stated } => {
            format!("--tone {given}: taken, though {} states {stated}", path.display())
        }
        note => note.to_string(),
    }
}
