//! The choice of the directory whose picture is read, and the tags of it that must have one value.

use super::directory::{Directories, Directory};
use super::rejection::Rejection;
use super::tags::{self, Tag};
use edof_core::words;

/// PhotometricInterpretation of a mosaic.
pub const COLOUR_FILTER_ARRAY: usize = 32803;
/// PhotometricInterpretation of three colours at each pixel.
const LINEAR_RAW: usize = 34892;
/// The latest version of the specification from which this reader is written.
const VERSION: [f64; 4] = [1.0, 7.0, 1.0, 0.0];

/// Tags for which no other value than that of their default is read.
const FIXED: [(Tag, &[f64], &str); 8] = [
    (tags::FILL_ORDER, &[1.0], "1 (the first pixel in the upper bits)"),
    (tags::PREDICTOR, &[1.0], "1 (no prediction)"),
    (tags::CFA_LAYOUT, &[1.0], "1 (rectangular)"),
    (tags::SUB_TILE_BLOCK, &[1.0, 1.0], "1, 1 (pixels in the order of their rows)"),
    (tags::ROW_INTERLEAVE, &[1.0], "1 (rows in their order)"),
    (tags::COLUMN_INTERLEAVE, &[1.0], "1 (columns in their order)"),
    (tags::COLORIMETRIC_REFERENCE, &[0.0], "0 (values proportional to the scene's light)"),
    (tags::SAMPLES, &[1.0], "1 (a mosaic)"),
];

/// The raw frame's directory, the first of the file, and how many raw frames there are.
pub struct Chosen<'a, 'd> {
    pub raw: &'d Directory<'a>,
    pub first: &'d Directory<'a>,
    pub frames: usize,
}

/// Takes the first mosaic in full resolution.
pub fn choose<'a, 'd>(all: &'d Directories<'a>) -> Result<Chosen<'a, 'd>, Rejection> {
    let cut = || Rejection::Cut("its directories do".to_owned());
    let Some(first) = all.found.first() else { return Err(cut()) };
    check_version(first)?;
    let (mut mosaics, mut reduced, mut linear) = (vec![], false, false);
    for directory in &all.found {
        let is_main = is_full_resolution(directory)?;
        match directory.whole(tags::INTERPRETATION)? {
            Some(COLOUR_FILTER_ARRAY) if is_main => mosaics.push(directory),
            Some(COLOUR_FILTER_ARRAY) => reduced = true,
            Some(LINEAR_RAW) if is_main => linear = true,
            _ => (),
        }
    }
    match mosaics[..] {
        [raw, ..] => {
            check_fixed(raw, first)?;
            Ok(Chosen { raw, first, frames: mosaics.len() })
        }
        [] if all.is_cut => Err(cut()),
        [] if linear => Err(Rejection::Mosaic("three colours at every pixel (linear DNG)".to_owned())),
        [] if reduced => {
            let found = "not 0 in each directory with a mosaic (reduced resolution, or a mask)";
            Err(Rejection::value(tags::NEW_SUBFILE_TYPE, found, "0, a frame in full resolution"))
        }
        [] => Err(Rejection::Damaged("no directory of the file has a colour filter array".to_owned())),
    }
}

fn is_full_resolution(directory: &Directory<'_>) -> Result<bool, Rejection> {
    Ok(match directory.whole(tags::NEW_SUBFILE_TYPE)? {
        Some(kind) => kind == 0,
        // The older tag: 1 is full resolution, 2 reduced, 3 a page of several.
        None => directory.whole(tags::SUBFILE_TYPE)?.is_none_or(|kind| kind == 1),
    })
}

fn check_version(first: &Directory<'_>) -> Result<(), Rejection> {
    first.exactly::<4>(tags::VERSION)?;
    match first.exactly::<4>(tags::BACKWARD_VERSION)? {
        Some(version) if version > VERSION => {
            let dotted = |version: [f64; 4]| version.map(words::number).join(".");
            Err(Rejection::value(
                tags::BACKWARD_VERSION,
                dotted(version),
                format!("at most {}", dotted(VERSION)),
            ))
        }
        _ => Ok(()),
    }
}

fn check_fixed(raw: &Directory<'_>, first: &Directory<'_>) -> Result<(), Rejection> {
    for (tag, only, expected) in FIXED {
        // The colour reference is stated once for a file.
        let directories = if tag == tags::COLORIMETRIC_REFERENCE { vec![first, raw] } else { vec![raw] };
        for directory in directories {
            if let Some(found) = directory.numbers(tag)?.filter(|found| found != only) {
                return Err(Rejection::value(tag, words::numbers(&found), expected));
            }
        }
    }
    if raw.has(tags::JPEG_TABLES) {
        return Err(Rejection::value(tags::JPEG_TABLES, "there", "tables within each tile"));
    }
    match raw.exactly::<2>(tags::DEFAULT_SCALE)? {
        Some([horizontal, vertical]) if horizontal != vertical => Err(Rejection::value(
            tags::DEFAULT_SCALE,
            words::numbers(&[horizontal, vertical]),
            "two equal numbers (square pixels)",
        )),
        _ => Ok(()),
    }
}
