//! DNG: the raw frame of a camera, and what its file states of light, defects, colours, crop and orientation.
//!
//! | step | module |
//! |---|---|
//! | directories and their numbers | `directory`, `tags` |
//! | which directory has the raw frame | `frame_directory` |
//! | stored pixels | `pixels`, `lossless_jpeg` |
//! | defects, tables, gains, lens | `opcodes` |
//! | from stored values to light | `light` |
//! | white balance and colour matrix | `colour` |
//! | crop and orientation of the picture | `layout` |
//!
//! `docs/dng.md` has a row for each tag of Adobe's "Digital Negative (DNG) Specification" up to version 1.7.1: what is done, or why nothing
//! is. What would change the picture and is not done is rejected by name.

mod colour;
mod directory;
mod finish;
mod frame_directory;
mod layout;
mod light;
mod lossless_jpeg;
mod opcodes;
mod pixels;
mod rejection;
mod tags;

use crate::camera_raw::CameraRawError;

use crate::levels::Black;
use crate::rendering::{ColourMatrix, Rendering, WhiteBalance};
use crate::tiff::{self, directory::File};
use directory::{Directories, Directory};
use edof_core::words::{self, number};
use edof_core::{CfaPhase, Channel, RawFrame};
pub use finish::{Crop, Finish};
use frame_directory::{COLOUR_FILTER_ARRAY, Chosen, choose};
use ndarray::{Array2, s};
use opcodes::List;
pub use opcodes::Opcodes;
use rejection::Rejection;
use std::path::Path;

/// A frame from a DNG file.
#[derive(Debug, Clone, PartialEq)]
pub struct Dng {
    /// Linear light of the active area, of 16 bits.
    pub frame: RawFrame,
    /// White balance as shot, and the matrix to linear sRGB.
    pub rendering: Rendering,
    /// What is to be done with the picture.
    pub finish: Finish,
    /// What the file asks for and is not done, and what was chosen of it.
    pub notes: Vec<String>,
}

/// What a user states in the file's place; tags whose place is taken are not read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// Colour filter of the active area's first pixel.
    pub phase: Option<CfaPhase>,
    /// Stored value of no light.
    pub black: Option<Black>,
    /// Stored value of full light.
    pub white: Option<f64>,
    /// Factors that make white neutral.
    pub white_balance: Option<WhiteBalance>,
    /// From balanced colours to linear sRGB.
    pub matrix: Option<ColourMatrix>,
}

/// Whether a file begins like a TIFF or BigTIFF, as a DNG does.
#[must_use]
pub fn is_tiff(head: &[u8]) -> bool {
    File::new(head).is_some()
}

/// Whether a file is a DNG: a TIFF or BigTIFF whose first directory has a DNGVersion.
#[must_use]
pub fn is_dng(bytes: &[u8]) -> bool {
    File::new(bytes).and_then(File::first).is_some_and(|first| first.has(tags::VERSION.0))
}

/// Whether a file is a TIFF or BigTIFF with a colour filter array: a DNG, or TIFF/EP, of which DNG is made.
#[must_use]
pub fn has_mosaic(bytes: &[u8]) -> bool {
    let is_mosaic =
        |one: &tiff::directory::Directory<'_>| one.whole(tags::INTERPRETATION.0) == Some(COLOUR_FILTER_ARRAY);
    File::new(bytes).is_some_and(|file| file.directories().found.iter().any(is_mosaic))
}

/// Reads a DNG in memory; `path` names it in errors.
///
/// # Errors
/// [`CameraRawError`]: damaged, no Bayer mosaic, or with a tag that is not supported.
pub fn decode(bytes: &[u8], path: &Path, overrides: &Overrides) -> Result<Dng, CameraRawError> {
    read(bytes, overrides).map_err(|rejection| rejection.of(path))
}

fn read(bytes: &[u8], overrides: &Overrides) -> Result<Dng, Rejection> {
    let file = File::new(bytes)
        .ok_or_else(|| Rejection::Damaged("the file does not begin like a TIFF or a DNG".to_owned()))?;
    let directories = Directories::of(file)?;
    let Chosen { raw, first, frames } = choose(&directories)?;
    let mut notes = vec![];
    if frames > 1 {
        notes.push(format!("{frames} raw frames; the first is read"));
    }
    let phase = phase(raw, overrides, &mut notes)?;
    let (light, finish) = light_and_finish(raw, first, phase, overrides, &mut notes)?;
    let words = light.mapv(|share| (f64::from(share) * 65536.0).round().min(65535.0) as u16);
    let [rows, columns] = [words.nrows() & !1, words.ncols() & !1];
    let frame = RawFrame::from_values(words.slice(s![..rows, ..columns]).to_owned(), 16, phase)
        .map_err(|e| Rejection::Damaged(e.to_string()))?;
    let described = colour::Described([first, raw]);
    let rendering = colour::rendering(&described, overrides)?;
    if (overrides.white_balance, overrides.matrix) == (None, None) {
        notes.extend(colour::other_light(&described)?);
    }
    notes.extend(replaced(raw, first, overrides));
    notes.extend(left_out(raw, first)?);
    Ok(Dng { frame, rendering, finish, notes })
}

/// The light of the active area, and what is to be done with the picture.
fn light_and_finish(
    raw: &Directory<'_>,
    first: &Directory<'_>,
    phase: CfaPhase,
    overrides: &Overrides,
    notes: &mut Vec<String>,
) -> Result<(Array2<f32>, Finish), Rejection> {
    let (mut values, sample) = pixels::stored(raw, first)?;
    let area @ [top, left, bottom, right] = light::active_area(raw, values.dim())?;
    let size = (bottom - top, right - left);
    let mut list = |list: List, size: (usize, usize)| {
        let opcodes = opcodes::read(raw, list, sample, notes)?;
        opcodes.check(list, size)?;
        Ok(opcodes)
    };
    list(List::Stored, values.dim())?.correct_mosaic(&mut values, moved(phase, top, left));
    let (of_mosaic, of_picture) = (list(List::Mosaic, size)?, list(List::Picture, size)?);
    light::linearize(raw, sample, &mut values)?;
    let mut light = light::light(raw, &values, sample, area, overrides)?;
    of_mosaic.correct_mosaic(&mut light, phase);
    let finish = Finish {
        corrections: Some(of_picture).filter(|opcodes| !opcodes.is_empty()),
        crop: layout::crop(raw, size)?,
        orientation: layout::orientation(first, raw)?,
    };
    Ok((light, finish))
}

/// The phase of a mosaic with its corner that many rows and columns away, either way.
fn moved(phase: CfaPhase, rows: usize, columns: usize) -> CfaPhase {
    let (r, c) = phase.red_site();
    let red = ((r + rows) % 2, (c + columns) % 2);
    CfaPhase::ALL.into_iter().find(|phase| phase.red_site() == red).unwrap_or(phase)
}

/// Which colours the first pixels of the active area see.
fn phase(raw: &Directory<'_>, overrides: &Overrides, notes: &mut Vec<String>) -> Result<CfaPhase, Rejection> {
    let size = raw.wholes(tags::CFA_SIZE)?.unwrap_or_else(|| vec![2, 2]);
    if let Some(stated) = overrides.phase.filter(|_| size == [2, 2]) {
        if let Ok(found) = phase_of_file(raw, &size)
            && found != stated
        {
            notes.push(format!("{} states {found}; {stated} is used as stated", tags::CFA));
        }
        return Ok(stated);
    }
    phase_of_file(raw, &size)
}

fn phase_of_file(raw: &Directory<'_>, size: &[usize]) -> Result<CfaPhase, Rejection> {
    let missing =
        || Rejection::Missing { tag: tags::CFA, what: "so the colour filters are unknown; state the phase" };
    let pattern = raw.wholes(tags::CFA)?.ok_or_else(missing)?;
    if let Some(colours) = raw.numbers(tags::CFA_COLOURS)?.filter(|colours| colours != &[0.0, 1.0, 2.0]) {
        let expected = "0, 1, 2 (red, green, blue)";
        return Err(Rejection::value(tags::CFA_COLOURS, words::numbers(&colours), expected));
    }
    let fits = |phase: &CfaPhase| {
        let colour = |channel: Channel| [0, 1, 2][channel.plane()];
        let expected: Vec<usize> = (0..4).map(|cell| colour(phase.channel(cell / 2, cell % 2))).collect();
        size == [2, 2] && pattern == expected
    };
    CfaPhase::ALL.into_iter().find(fits).ok_or_else(|| {
        let [rows, columns] = [0, 1].map(|side| size.get(side).copied().unwrap_or(0));
        Rejection::Mosaic(format!("a {rows}x{columns} mosaic {pattern:?}"))
    })
}

/// What the file states otherwise than the user.
fn replaced(raw: &Directory<'_>, first: &Directory<'_>, overrides: &Overrides) -> Vec<String> {
    let stated = |tag: tags::Tag| {
        let of = if first.has(tag) { first } else { raw };
        of.numbers(tag).ok().flatten()
    };
    let mut notes = vec![];
    let mut note = |tag: tags::Tag, used: String, is_same: &dyn Fn(&[f64]) -> bool| {
        if let Some(found) = stated(tag).filter(|found| !is_same(found)) {
            notes.push(format!("{tag} states {}; {used} is used as stated", words::numbers(&found)));
        }
    };
    if let Some(black) = overrides.black {
        note(tags::BLACK_LEVEL, black.to_string(), &|found| found.iter().all(|v| black.values() == [*v; 4]));
    }
    if let Some(white) = overrides.white {
        note(tags::WHITE_LEVEL, number(white), &|found| found.first() == Some(&white));
    }
    if let Some(balance) = overrides.white_balance.map(<[f64; 3]>::from) {
        let is_same = |found: &[f64]| {
            let products: Vec<f64> = found.iter().zip(balance).map(|(share, gain)| share * gain).collect();
            products.iter().all(|product| (product / products[0] - 1.0).abs() < 1e-3)
        };
        let used = format!("a white balance of {}", words::numbers(&balance));
        note(tags::NEUTRAL, used, &is_same);
    }
    notes
}

/// What the file asks for beyond the sensor's light and its colours.
fn left_out(raw: &Directory<'_>, first: &Directory<'_>) -> Result<Vec<String>, Rejection> {
    let mut notes = vec![];
    let number_of =
        |tag| -> Result<f64, Rejection> { Ok(first.exactly::<1>(tag)?.map_or(0.0, |[stops]| stops)) };
    let exposure = number_of(tags::BASELINE_EXPOSURE)? + number_of(tags::EXPOSURE_OFFSET)?;
    if exposure != 0.0 {
        let tag = tags::BASELINE_EXPOSURE;
        notes.push(format!(
            "{tag} of {} stops is not applied; the picture keeps the sensor's exposure",
            number(exposure)
        ));
    }
    let look = [
        tags::HUE_SAT_DIMS,
        tags::HUE_SAT_1,
        tags::HUE_SAT_2,
        tags::HUE_SAT_3,
        tags::TONE_CURVE,
        tags::LOOK_DIMS,
        tags::LOOK_TABLE,
        tags::GAIN_TABLE_MAP,
        tags::GAIN_TABLE_MAP_2,
        tags::RGB_TABLES,
    ];
    let found: Vec<String> =
        look.iter().filter(|tag| first.has(**tag) || raw.has(**tag)).map(ToString::to_string).collect();
    if !found.is_empty() {
        notes.push(format!("the look of its profile is not applied: {}", found.join(", ")));
    }
    if raw.has(tags::MASKED_AREAS) && !raw.has(tags::BLACK_LEVEL) {
        notes.push(format!(
            "{} is there, but no {}; black is taken for 0",
            tags::MASKED_AREAS,
            tags::BLACK_LEVEL
        ));
    }
    Ok(notes)
}

#[cfg(test)]
mod tests;
