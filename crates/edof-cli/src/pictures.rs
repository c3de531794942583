//! Photographs that a command is given, ready for a sensor: whole Bayer cells.

use crate::error::Error;
use crate::ui::Ui;
use edof_image::ColourFrame;
use edof_io::photo;
use std::path::Path;

/// Reads a photograph; of an odd side the last row or column is cut off, with a word.
///
/// # Errors
/// A file that is not a photograph.
pub fn load(path: &Path, ui: &Ui) -> Result<ColourFrame, Error> {
    let photograph = photo::load(path)?;
    let (height, width) = photograph.size();
    let (even_height, even_width) = whole_cells((height, width));
    if (even_height, even_width) == (height, width) {
        return Ok(photograph);
    }
    ui.note(format!(
        "{}: {width}x{height} cropped to {even_width}x{even_height}, whole Bayer cells",
        path.display()
    ));
    Ok(photograph.crop(0, 0, even_height, even_width))
}

/// Rows and columns of whole Bayer cells. What holds none stays as it is and is rejected as a frame.
pub const fn whole_cells((height, width): (usize, usize)) -> (usize, usize) {
    if height < 2 || width < 2 { (height, width) } else { (height & !1, width & !1) }
}
