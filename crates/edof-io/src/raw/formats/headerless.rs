//! Headerless raw files: words, bytes or packed pixels, as [`crate::packing`] has them.

use crate::packing::{Packing, Stray};
use crate::raw::error::RawError;
use crate::raw::format::{RawFormat, Read, Recognised, Values, Write};
use crate::raw::options::{Alignment, RawOptions, Size};
use crate::raw::source::Source;
use ndarray::Array2;
use std::path::Path;

/// Pixels alone. Little-endian words with values at the bottom are written.
pub const HEADERLESS: RawFormat = RawFormat {
    name: "headerless",
    noun: "pixels without a header",
    endings: &["raw", "bin"],
    recognise: |_| Recognised::No,
    read: Read::Headerless(values),
    write: Some(Write {
        alignment: Alignment::Bottom,
        note: "without a header",
        encode: |frame, _| Ok(frame.values().iter().flat_map(|v| v.to_le_bytes()).collect()),
    }),
};

fn values(source: Source<'_>, size: Size, options: &RawOptions) -> Result<Values, RawError> {
    let (path, packing) = (source.path, options.packing);
    let depth = depth(options, path)?;
    let line = options.line_bytes;
    packing
        .check_line(size.width, line)
        .map_err(|source| RawError::Line { path: path.to_owned(), source })?;
    let wrong_length = |found| wrong_length(size, packing, line, found, path);
    let expected = packing.frame_bytes(size.width, size.height, line);
    let bytes = source.exactly(expected as u64, wrong_length)?;
    let mut memory = vec![];
    let bytes = packing.without_padding(size.width, line, &bytes, &mut memory);
    let stray = |Stray { pixel, code }| RawError::Code {
        path: path.to_owned(),
        row: pixel / size.width,
        column: pixel % size.width,
        code,
    };
    let pixels = packing.values(bytes, options.order).map_err(stray)?;
    let words = Array2::from_shape_vec((size.height, size.width), pixels)
        .map_err(|_| wrong_length(Some(bytes.len() as u64)))?;
    let alignment = if packing == Packing::Video { Alignment::Top } else { Alignment::Bottom };
    Ok(Values { words, depth, alignment, notes: vec![] })
}

/// Returns the bits of the pixels.
fn depth(options: &RawOptions, path: &Path) -> Result<u32, RawError> {
    let found = options.packing.bits();
    match options.depth {
        None => Ok(found),
        Some(depth) if options.packing.is_words() || depth == found => Ok(depth),
        Some(depth) => {
            Err(RawError::Depth { path: path.to_owned(), found, expected: format!("{depth} bits as stated") })
        }
    }
}

/// Returns the error for a file of `found` bytes, where that is known.
fn wrong_length(
    size: Size,
    packing: Packing,
    line: Option<usize>,
    found: Option<u64>,
    path: &Path,
) -> RawError {
    let fitting = |other: &Packing| *other != packing && Some(size.bytes(*other) as u64) == found;
    let names: Vec<&str> = Packing::ALL.iter().filter(|p| fitting(p)).map(|p| p.name()).collect();
    RawError::Size {
        path: path.to_owned(),
        found: found.map_or("more bytes".to_owned(), |found| format!("{found} bytes")),
        expected: packing.frame_bytes(size.width, size.height, line).to_string(),
        size,
        hint: if names.is_empty() {
            found.and_then(|found| padded(size, packing, line, found)).unwrap_or_default()
        } else {
            format!("; as many as packed as {}", names.join(" or "))
        },
    }
}

/// Most bytes at the end of a line that somebody would expect, and the multiple that such lines have.
const PADDING: usize = 256;
const ALIGNED: usize = 4;

/// Returns what else would make a headerless file of so many bytes, if anything would: several frames, or lines that are padded otherwise than stated by
/// `line`; or how many whole frames it holds.
#[must_use]
pub fn padded(size: Size, packing: Packing, line: Option<usize>, found: u64) -> Option<String> {
    let (height, pixels) = (size.height as u64, packing.bytes(size.width));
    let count = |frames: u64| edof_core::words::count(frames as usize, "frame");
    let frame = packing.frame_bytes(size.width, size.height, None) as u64;
    if line.is_some() && found >= frame && found.is_multiple_of(frame) {
        return Some(format!(
            "; as many as {} without padding: leave out --line-bytes",
            count(found / frame)
        ));
    }
    if found > frame && found.is_multiple_of(frame) {
        return Some(format!(
            "; as many as {} have, which 'edof stream' and 'edof sensor' read",
            count(found / frame)
        ));
    }
    let fitting = (pixels + 1..=pixels + PADDING)
        .find(|line| line.is_multiple_of(ALIGNED) && found.is_multiple_of(*line as u64 * height));
    if let Some(line) = fitting.filter(|_| found > 0) {
        let of = count(found / (line as u64 * height));
        return Some(format!("; as many as {of} with lines of {line} bytes: --line-bytes {line}"));
    }
    let frame = packing.frame_bytes(size.width, size.height, line) as u64;
    let whole = edof_core::words::count((found / frame) as usize, "whole frame");
    (found > frame).then(|| format!("; {whole} and {} bytes", found % frame))
}
