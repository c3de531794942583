//! Raw Bayer frames: files to sensor values and back.
//!
//! | file | full scale | values of fewer than 16 bits |
//! |---|---|---|
//! | PNG, TIFF (16-bit grey) | 65535 | at the top of each word, as PNG has it, unless stated otherwise |
//! | PNG, TIFF (8-bit grey) | 255 | only where a depth of 8 is stated; a PGM needs no such word |
//! | PGM | what the file states | at the bottom, for a maximum of 2^depth − 1; else as in PNG |
//! | headerless 16-bit words | 65535 | at the bottom, unless stated otherwise |
//! | headerless 8-bit or packed 12-bit pixels ([`crate::packing`]) | 255, 4095 | all bits are there |
//! | video for a playout card ([`crate::packing`]) | 65535 | at the top of each word, unless stated otherwise |
//! | DNG ([`crate::dng`]) | light of 16 bits | the file states its phase, too |
//! | other camera raw ([`crate::camera_raw`]) | light of 16 bits | the file states its phase, too |
//!
//! Each format is a value ([`RawFormat`]) in a file of its own; [`FORMATS`] lists them. A format that states its size and shows what it is
//! needs a file and a line of the table.
//!
//! So a frame that [`save`] wrote as PNG, TIFF or PGM is read back without any option but its phase.

mod error;
mod format;
mod formats;
mod options;
mod source;

pub use error::{OF_LIGHT, RawError};
pub use format::{RawFormat, Read, Recognised, Values, Write};
pub use formats::headerless::padded;
pub use formats::{FORMATS, of_content, of_ending, writer, written};
pub use options::{Alignment, RawOptions, Size, WrongSize};
pub use source::Source;

use crate::dng::{Dng, Finish, Overrides};
use crate::packing;
use crate::picture::PictureError;
use crate::rendering::Rendering;
use edof_core::RawFrame;
use edof_core::frame::FrameError;
use edof_core::storage::atomic;
use ndarray::Array2;
use std::path::Path;

/// A raw frame, and what its file states of it.
#[derive(Debug, Clone)]
pub struct Opened {
    /// The sensor's values, or the light of a camera's file.
    pub frame: RawFrame,
    /// The format of its file.
    pub format: &'static RawFormat,
    /// What its camera would do to the colours.
    pub rendering: Rendering,
    /// What its file asks to be done with the picture.
    pub finish: Finish,
    /// What its file asks for and is not done.
    pub notes: Vec<String>,
}

/// Reads a raw frame with what its file states of it. The content decides what the file is; its ending does where the content does not.
/// `overrides` take the place of what a DNG states.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn open(path: &Path, options: &RawOptions, overrides: &Overrides) -> Result<Opened, RawError> {
    let source = Source::open(path)?;
    let format = formats::recognised(path, source.head(), options);
    let values = |values| of_values(values, options, path);
    let Dng { frame, rendering, finish, notes } = match format.read {
        Read::Light(read) => read(source, overrides)?,
        Read::Values(read) => {
            check_depth(options, path)?;
            values(read(source, options)?)?
        }
        Read::Headerless(read) => {
            check_depth(options, path)?;
            let no_size = || RawError::NoSize { path: path.to_owned(), known: formats::names() };
            values(read(source, options.size.ok_or_else(no_size)?, options)?)?
        }
    };
    Ok(Opened { frame, format, rendering, finish, notes })
}

/// Reads a raw frame without what its file states.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn load(path: &Path, options: &RawOptions) -> Result<RawFrame, RawError> {
    Ok(open(path, options, &Overrides::default())?.frame)
}

fn check_depth(options: &RawOptions, path: &Path) -> Result<(), RawError> {
    match options.depth {
        Some(depth) if !(8..=16).contains(&depth) => {
            Err(RawError::Frame { path: path.to_owned(), source: FrameError::Depth(depth) })
        }
        _ => Ok(()),
    }
}

/// Makes a frame of sensor values.
fn of_values(values: Values, options: &RawOptions, path: &Path) -> Result<Dng, RawError> {
    let Values { words, depth, alignment, notes } = values;
    let values = match options.alignment.unwrap_or(alignment) {
        Alignment::Bottom => words,
        Alignment::Top => lower(words, depth, path)?,
    };
    let frame = RawFrame::from_values(values, depth, options.phase)
        .map_err(|source| RawError::Frame { path: path.to_owned(), source })?;
    Ok(Dng { frame, rendering: Rendering::default(), finish: Finish::default(), notes })
}

/// Returns the values of top-aligned words.
fn lower(words: Array2<u16>, depth: u32, path: &Path) -> Result<Array2<u16>, RawError> {
    let shift = 16 - depth;
    let below = ((1u32 << shift) - 1) as u16;
    if let Some(((row, column), &value)) = words.indexed_iter().find(|(_, v)| **v & below != 0) {
        return Err(RawError::Alignment { path: path.to_owned(), row, column, value, depth });
    }
    Ok(words.mapv_into(|v| v >> shift))
}

/// Writes a raw frame in the format that the ending stands for.
///
/// # Errors
/// [`RawError::Picture`] naming the file; none is left half written.
pub fn save(path: &Path, frame: &RawFrame) -> Result<(), RawError> {
    write(path, &(writer(path)?.encode)(frame, path)?)
}

/// Writes a raw frame as a playout card takes it (`2vuy`), for the board's cable.
///
/// # Errors
/// [`RawError::Picture`] naming the file; none is left half written.
pub fn save_video(path: &Path, frame: &RawFrame) -> Result<(), RawError> {
    write(path, &packing::video(frame))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), RawError> {
    Ok(atomic::write(path, bytes).map_err(PictureError::from)?)
}

#[cfg(test)]
mod tests;
