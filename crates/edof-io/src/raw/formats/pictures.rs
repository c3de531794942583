//! Raw frames in grey pictures: PNG and TIFF, whose full scale is that of 8 or 16 bits, and PGM, which states its own.

use crate::dng;
use crate::picture::{self, Format, PictureError};
use crate::raw::error::RawError;
use crate::raw::format::{RawFormat, Read, Recognised, Values, Write};
use crate::raw::options::{Alignment, RawOptions, Size};
use crate::raw::source::Source;
use crate::samples::Samples;
use ndarray::{Array2, Axis};
use std::path::Path;

/// PNG with values at the top of each word, as PNG's specification has it.
pub const PNG: RawFormat = RawFormat {
    name: "PNG",
    noun: "a PNG picture",
    endings: &["png"],
    recognise: |bytes| recognised(bytes, Format::Png, Recognised::Yes),
    read: Read::Values(values),
    write: Some(Write {
        alignment: Alignment::Top,
        note: FULL_SCALE,
        encode: |frame, path| encoded(frame.pixels(), u16::MAX, path, Format::Png),
    }),
};

/// TIFF with values at the top of each word, or with a packed depth of its own.
pub const TIFF: RawFormat = RawFormat {
    name: "TIFF",
    noun: "a TIFF picture",
    endings: &["tif", "tiff"],
    recognise: |bytes| match dng::has_mosaic(bytes) {
        // What its tags state of the mosaic is read as that of a DNG.
        true => Recognised::No,
        false => recognised(bytes, Format::Tiff, Recognised::Container),
    },
    read: Read::Values(values),
    write: Some(Write {
        alignment: Alignment::Top,
        note: FULL_SCALE,
        encode: |frame, path| encoded(frame.pixels(), u16::MAX, path, Format::Tiff),
    }),
};

/// PGM with values and their maximum.
pub const PGM: RawFormat = RawFormat {
    name: "PGM",
    noun: "a PGM or PPM picture",
    endings: &["pgm"],
    recognise: |bytes| recognised(bytes, Format::Pnm, Recognised::Yes),
    read: Read::Values(values),
    write: Some(Write {
        alignment: Alignment::Bottom,
        note: "",
        encode: |frame, path| encoded(&frame.values(), u16::MAX >> (16 - frame.depth()), path, Format::Pnm),
    }),
};

const FULL_SCALE: &str = "(sensor values at the top of 16 bits)";

fn recognised(bytes: &[u8], format: Format, how: Recognised) -> Recognised {
    if Format::of(bytes) == Some(format) { how } else { Recognised::No }
}

fn encoded(
    words: &Array2<u16>,
    full_scale: u16,
    path: &Path,
    format: Format,
) -> Result<Vec<u8>, PictureError> {
    let samples = Samples { planes: words.clone().insert_axis(Axis(0)), full_scale };
    picture::encode(&samples, format, path)
}

fn values(source: Source<'_>, options: &RawOptions) -> Result<Values, RawError> {
    let path = source.path;
    let bytes = source.all()?;
    let samples = picture::decode(&bytes, path).map_err(of_floats)?;
    let (depth, alignment) = meaning(Format::of(&bytes), &samples, options.depth, path)?;
    let maximum = u32::from(samples.full_scale);
    let words = single_plane(samples, options.size, path)?;
    let several = picture::is_first_of_several(&bytes)
        .then(|| "has several frames; the first is read, save the others one by one".to_owned());
    let other_maximum = (!(maximum + 1).is_power_of_two()).then(|| {
        format!(
            "states a maximum of {maximum}; full light is taken for {}, unless a white level is stated",
            1 << depth
        )
    });
    Ok(Values { words, depth, alignment, notes: several.into_iter().chain(other_maximum).collect() })
}

/// Returns the error of a picture that cannot be read; of one in floating point, what to do with it.
fn of_floats(error: PictureError) -> RawError {
    match error {
        PictureError::Kind { path, found } if found.ends_with("floating-point") => {
            RawError::Float { path, found }
        }
        error => error.into(),
    }
}

/// Returns depth and alignment of a picture's samples.
fn meaning(
    format: Option<Format>,
    samples: &Samples,
    stated: Option<u32>,
    path: &Path,
) -> Result<(u32, Alignment), RawError> {
    let found = 16 - samples.full_scale.leading_zeros();
    let wrong = |expected: String| Err(RawError::Depth { path: path.to_owned(), found, expected });
    match (samples.full_scale, stated) {
        (u16::MAX, depth) => Ok((depth.unwrap_or(16), Alignment::Top)),
        (255, Some(8)) => Ok((8, Alignment::Bottom)),
        // As 8-bit sensors' frames are saved; a PNG of 8 bits is more likely a picture.
        (255, None) if format == Some(Format::Pnm) => Ok((8, Alignment::Bottom)),
        (..=255, None) => wrong("16-bit ones (or a stated depth of 8)".to_owned()),
        (_, Some(depth)) if depth != found => wrong(format!("{depth} bits as stated")),
        _ => Ok((found, Alignment::Bottom)),
    }
}

fn single_plane(samples: Samples, size: Option<Size>, path: &Path) -> Result<Array2<u16>, RawError> {
    let (channels, height, width) = samples.planes.dim();
    if channels != 1 {
        return Err(RawError::Colour { path: path.to_owned() });
    }
    RawError::check_size(Size { width, height }, size, path)?;
    Ok(samples.planes.index_axis_move(Axis(0), 0))
}
