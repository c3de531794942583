//! Photographs that a command is given, ready for a sensor: whole Bayer cells.

use crate::error::Error;
use crate::ui::Ui;
use edof_core::{ColourFrame, Tone};
use edof_io::photo::{self, Photograph};
use edof_io::transfer::Transfer;
use std::path::Path;

/// Tone of a photograph: the user's, else the one that its file states, else the usual one.
#[derive(Debug, Clone, Copy)]
pub struct Tones {
    pub given: Option<Tone>,
    pub usual: Tone,
}

impl Tones {
    /// The tone of a file's values. A note states what decided where the file states other than what is taken.
    pub fn of(self, path: &Path, stated: Option<&Transfer>, ui: &Ui) -> Tone {
        let Some(stated) = stated else { return self.given.unwrap_or(self.usual) };
        let shown = path.display();
        match (self.given, stated.tone()) {
            (Some(given), Some(tone)) if given != tone => {
                ui.note(format!("--tone {given}: taken, though {shown} states {stated}"));
                given
            }
            (Some(given), Some(_)) => given,
            // In the paper's convention even sRGB codes are taken for light.
            (None, Some(Tone::Linear)) if self.usual != Tone::Linear => {
                ui.note(format!("{shown}: states {stated}; its values are taken as linear"));
                Tone::Linear
            }
            (None, Some(_)) => self.usual,
            (given, None) => {
                let tone = given.unwrap_or(self.usual);
                ui.note(format!(
                    "{shown}: states {stated}, which is not applied; its values are taken as {tone}"
                ));
                tone
            }
        }
    }
}

/// Reads a photograph, and the tone of its values; of an odd side the last row or column is cut off, with a note.
///
/// # Errors
/// A file that is not a photograph.
pub fn load(path: &Path, tones: Tones, ui: &Ui) -> Result<(ColourFrame, Tone), Error> {
    let Photograph { frame, transfer } = photo::open(path)?;
    let tone = tones.of(path, transfer.as_ref(), ui);
    let (height, width) = frame.size();
    let (even_height, even_width) = whole_cells((height, width));
    if (even_height, even_width) == (height, width) {
        return Ok((frame, tone));
    }
    ui.note(format!(
        "{}: {width}x{height} cropped to {even_width}x{even_height}, whole Bayer cells",
        path.display()
    ));
    Ok((frame.crop(0, 0, even_height, even_width), tone))
}

/// Rows and columns of whole Bayer cells. What holds none stays as it is and is rejected as a frame.
pub const fn whole_cells((height, width): (usize, usize)) -> (usize, usize) {
    if height < 2 || width < 2 { (height, width) } else { (height & !1, width & !1) }
}
