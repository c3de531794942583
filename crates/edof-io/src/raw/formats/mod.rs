//! The table of raw formats. A format that is added here is read, written, and named in messages and in the help of the program.

mod cameras;
pub mod headerless;
mod npy;
mod pictures;

use super::format::{RawFormat, Read, Recognised, Write};
use super::options::RawOptions;
use crate::packing::Packing;
use crate::picture::{Format, PictureError};
use cameras::{CAMERA_RAW, DNG};
use edof_core::words::alternatives;
use headerless::HEADERLESS;
use npy::NPY;
use pictures::{PGM, PNG, TIFF};
use std::path::Path;

/// All formats, in the order in which messages name them. Of a container the first has the files whose ending decides nothing.
pub static FORMATS: [&RawFormat; 7] = [&PNG, &TIFF, &PGM, &NPY, &HEADERLESS, &DNG, &CAMERA_RAW];

/// Returns the format of a file by its bytes, as [`RawFormat::recognise`] takes them. In a container that formats share, the ending decides.
/// Content that no format claims is headerless, unless no size is stated and the ending is of a format that states everything.
#[must_use]
pub fn recognised(path: &Path, bytes: &[u8], options: &RawOptions) -> &'static RawFormat {
    let of = |wanted| FORMATS.into_iter().filter(move |format| (format.recognise)(bytes) == wanted);
    let in_container = || of(Recognised::Container).find(|format| format.is_named(path));
    let is_unknown = options.size.is_none() && Format::of(bytes).is_none();
    let by_name = || {
        FORMATS.into_iter().find(|format| is_unknown && format.states_everything() && format.is_named(path))
    };
    let found = of(Recognised::Yes).next().or_else(in_container).or_else(|| of(Recognised::Container).next());
    match found.or_else(by_name) {
        // What begins as a picture does may be pixels.
        Some(RawFormat { read: Read::Values(_), .. }) if options.packing != Packing::Words => &HEADERLESS,
        found => found.unwrap_or(&HEADERLESS),
    }
}

/// Returns the format that the bytes of a file show, whatever its name.
#[must_use]
pub fn of_content(bytes: &[u8]) -> Option<&'static RawFormat> {
    FORMATS.into_iter().find(|format| (format.recognise)(bytes) != Recognised::No)
}

/// Returns the format in which a file of that name would be written.
#[must_use]
pub fn of_ending(path: &Path) -> Option<&'static RawFormat> {
    FORMATS.into_iter().find(|format| format.write.is_some() && format.is_named(path))
}

/// Returns how a file of that name is written.
///
/// # Errors
/// [`PictureError::Ending`] with the known endings.
pub fn writer(path: &Path) -> Result<&'static Write, PictureError> {
    of_ending(path).and_then(|format| format.write.as_ref()).ok_or_else(|| {
        let endings =
            FORMATS.into_iter().filter(|format| format.write.is_some()).flat_map(|format| format.endings);
        let expected = alternatives(endings.map(|ending| format!(".{ending}")));
        PictureError::Ending { path: path.to_owned(), expected }
    })
}

/// Returns the names of the formats whose content shows them and whose values options describe: "PNG, TIFF or PGM".
#[must_use]
pub fn names() -> String {
    let known = |format: &&RawFormat| matches!(format.read, Read::Values(_));
    alternatives(FORMATS.into_iter().filter(known).map(|format| format.name.to_owned()))
}

/// Returns the endings that can be written, with what is written for each: the words of a help.
///
/// ```
/// assert!(edof_io::raw::written().starts_with(".png or .tif (sensor values at the top of 16 bits), .pgm"));
/// ```
#[must_use]
pub fn written() -> String {
    let formats: Vec<(&RawFormat, &str)> =
        FORMATS.into_iter().filter_map(|format| Some((format, format.write.as_ref()?.note))).collect();
    let alike = |formats: &[(&RawFormat, &str)]| {
        let endings = alternatives(formats.iter().map(|(format, _)| format!(".{}", format.endings[0])));
        format!("{endings} {}", formats[0].1).trim_end().to_owned()
    };
    let groups: Vec<String> = formats.chunk_by(|a, b| a.1 == b.1).map(alike).collect();
    let (last, others) = groups.split_last().map_or(("", &[][..]), |(last, others)| (last.as_str(), others));
    format!("{}, or {last}", others.join(", "))
}
