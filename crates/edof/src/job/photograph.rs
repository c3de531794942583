//! Photographs ready for a sensor: whole Bayer cells, and the tone of their values.

use super::note::PictureNote;
use edof_core::{ColourFrame, Tone};
use edof_io::photo::{self, PhotoError, Photograph};
use edof_io::raw::Size;
use edof_io::transfer::Transfer;
use std::path::Path;

/// Tone of a photograph: the one asked for, else the one that its file states, else the usual one.
#[derive(Debug, Clone, Copy)]
pub struct Tones {
    /// The one asked for.
    pub given: Option<Tone>,
    /// The usual one.
    pub usual: Tone,
}

impl Tones {
    /// Returns the tone of a file's values. A note states what decided where the file states other than what is taken.
    pub fn of(self, path: &Path, stated: Option<&Transfer>, note: &dyn Fn(PictureNote)) -> Tone {
        let Some(stated) = stated else { return self.given.unwrap_or(self.usual) };
        let (path, stated) = (path.to_owned(), stated.clone());
        match (self.given, stated.tone()) {
            (Some(given), Some(tone)) if given != tone => {
                note(PictureNote::ToneOverridden { path, given, stated });
                given
            }
            (Some(given), Some(_)) => given,
            // In the paper's convention even sRGB codes are taken for light.
            (None, Some(Tone::Linear)) if self.usual != Tone::Linear => {
                note(PictureNote::Linear { path, stated });
                Tone::Linear
            }
            (None, Some(_)) => self.usual,
            (given, None) => {
                let tone = given.unwrap_or(self.usual);
                note(PictureNote::CurveNotApplied { path, stated, tone });
                tone
            }
        }
    }
}

/// Reads a photograph, and the tone of its values; of an odd side the last row or column is cut off, with a note.
///
/// # Errors
/// A file that is not a photograph.
pub fn load(
    path: &Path,
    tones: Tones,
    note: &dyn Fn(PictureNote),
) -> Result<(ColourFrame, Tone), PhotoError> {
    Ok(ready(photo::open(path)?, path, tones, note))
}

/// Makes a photograph ready as [`load`] does; `path` names it in notes.
pub fn ready(
    Photograph { frame, transfer, gamut, is_first_of_several }: Photograph,
    path: &Path,
    tones: Tones,
    note: &dyn Fn(PictureNote),
) -> (ColourFrame, Tone) {
    let tone = tones.of(path, transfer.as_ref(), note);
    if let Some(stated) = gamut {
        note(PictureNote::GamutNotApplied { path: path.to_owned(), stated });
    }
    if is_first_of_several {
        note(PictureNote::FirstOfSeveral { path: path.to_owned() });
    }
    let [from, to] = [frame.size(), whole_cells(frame.size())].map(|(height, width)| Size { width, height });
    if from == to {
        return (frame, tone);
    }
    note(PictureNote::Cropped { path: path.to_owned(), from, to });
    (frame.crop(0, 0, to.height, to.width), tone)
}

/// Returns the rows and columns of whole Bayer cells. What holds none stays as it is and is rejected as a frame.
#[must_use]
pub const fn whole_cells((height, width): (usize, usize)) -> (usize, usize) {
    if height < 2 || width < 2 { (height, width) } else { (height & !1, width & !1) }
}
