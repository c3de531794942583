//! Pixels of a directory as they are stored: strips or tiles of integers or floating-point numbers, or lossless JPEG.

use super::directory::Directory;
use super::lossless_jpeg::{self, Kind};
use super::rejection::Rejection;
use super::tags;
use ndarray::{Array2, s};

/// Longest side, as of every frame here.
const LONGEST: usize = 65535;

/// How a pixel is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// An unsigned number of N bits, 8 to 32.
    Whole(u32),
    /// A floating-point number of 16, 24 or 32 bits.
    Float(u32),
}

impl Sample {
    /// What a directory states.
    ///
    /// # Errors
    /// [`Rejection`] for other kinds.
    pub fn of(raw: &Directory<'_>) -> Result<Self, Rejection> {
        let bits = raw.whole(tags::BITS)?.unwrap_or(16) as u32;
        match raw.whole(tags::SAMPLE_FORMAT)?.unwrap_or(1) {
            1 if (8..=32).contains(&bits) => Ok(Self::Whole(bits)),
            1 => Err(Rejection::value(tags::BITS, bits, "8 to 32")),
            3 if [16, 24, 32].contains(&bits) => Ok(Self::Float(bits)),
            3 => Err(Rejection::value(tags::BITS, bits, "16, 24 or 32 for floating-point numbers")),
            other => Err(Rejection::value(
                tags::SAMPLE_FORMAT,
                other,
                "1 (unsigned) or 3 (floating-point numbers)",
            )),
        }
    }

    const fn bits(self) -> u32 {
        match self {
            Self::Whole(bits) | Self::Float(bits) => bits,
        }
    }
}

/// Where the parts of a picture are stored.
struct Parts {
    /// Rows and columns of a part.
    size: (usize, usize),
    is_tiled: bool,
    offsets: Vec<usize>,
    bytes: Vec<usize>,
}

fn parts(raw: &Directory<'_>, (height, width): (usize, usize)) -> Result<Parts, Rejection> {
    let is_tiled = raw.has(tags::TILE_OFFSETS);
    let size = if is_tiled {
        (part_side(raw, tags::TILE_HEIGHT)?, part_side(raw, tags::TILE_WIDTH)?)
    } else if raw.has(tags::STRIP_ROWS) {
        // One strip may state any large number.
        let rows = raw.whole(tags::STRIP_ROWS)?.map_or(0, |rows| rows.min(height));
        if rows == 0 {
            return Err(Rejection::wrong(tags::STRIP_ROWS, &[0.0], "rows of a strip, 1 or more"));
        }
        (rows, width)
    } else {
        (height, width)
    };
    let count = height.div_ceil(size.0) * width.div_ceil(size.1);
    let each = |tag| {
        let all = raw.wholes(tag)?.ok_or(Rejection::Missing { tag, what: NOWHERE })?;
        if all.len() == count {
            return Ok(all);
        }
        let found: Vec<f64> = all.iter().map(|v| *v as f64).collect();
        let parts = if is_tiled { "tiles" } else { "strips" };
        Err(Rejection::wrong(tag, &found, format!("{count} numbers, for a frame of {count} {parts}")))
    };
    let [offsets, bytes] = if is_tiled {
        [tags::TILE_OFFSETS, tags::TILE_BYTES]
    } else {
        [tags::STRIP_OFFSETS, tags::STRIP_BYTES]
    };
    Ok(Parts { size, is_tiled, offsets: each(offsets)?, bytes: each(bytes)? })
}

/// What a file without the tags of its parts lacks.
const NOWHERE: &str = "so the pixels are nowhere";

/// A side of a tile.
fn part_side(raw: &Directory<'_>, tag: tags::Tag) -> Result<usize, Rejection> {
    match raw.whole(tag)? {
        Some(side) if (1..=LONGEST).contains(&side) => Ok(side),
        Some(side) => Err(Rejection::wrong(tag, &[side as f64], format!("1 to {LONGEST} pixels"))),
        None => Err(Rejection::Missing { tag, what: NOWHERE }),
    }
}

fn side(raw: &Directory<'_>, tag: tags::Tag) -> Result<usize, Rejection> {
    match raw.whole(tag)? {
        Some(side) if (2..=LONGEST).contains(&side) => Ok(side),
        Some(side) => Err(Rejection::wrong(tag, &[side as f64], format!("2 to {LONGEST} pixels"))),
        None => Err(Rejection::Missing { tag, what: "so the frame has no size" }),
    }
}

/// The whole picture of a directory, rows × columns; the first directory states the version of the file.
///
/// # Errors
/// [`Rejection`] for another compression, and where pixels are missing or damaged.
pub fn stored(raw: &Directory<'_>, first: &Directory<'_>) -> Result<(Array2<f32>, Sample), Rejection> {
    let size @ (height, width) = (side(raw, tags::HEIGHT)?, side(raw, tags::WIDTH)?);
    let sample = Sample::of(raw)?;
    let is_lossless = match (raw.whole(tags::COMPRESSION)?.unwrap_or(1), sample) {
        (1, _) => false,
        (7, Sample::Whole(..=16)) => true,
        (7, _) => return Err(Rejection::value(tags::BITS, sample.bits(), "at most 16 for lossless JPEG")),
        (other, _) => {
            return Err(Rejection::value(tags::COMPRESSION, named(other), "1 (none) or 7 (lossless JPEG)"));
        }
    };
    let kind = match first.exactly::<4>(tags::VERSION)? {
        Some(version) if version < [1.0, 1.0, 0.0, 0.0] => Kind::BeforeDng1_1,
        _ => Kind::Standard,
    };
    let parts = parts(raw, size)?;
    let (rows, columns) = parts.size;
    let across = width.div_ceil(columns);
    // Before memory is reserved: a pixel takes a bit at least, of the parts and of the file, in which parts may overlap.
    let held = parts.bytes.iter().fold(0usize, |sum, bytes| sum.saturating_add(*bytes));
    if held.min(raw.file().bytes().len()) < height * width / 8 {
        return Err(no_pixels());
    }
    let mut all = Array2::zeros(size);
    for (index, (&at, &length)) in parts.offsets.iter().zip(&parts.bytes).enumerate() {
        let (top, left) = (index / across * rows, index % across * columns);
        // The last strip is as long as there are rows; all tiles have one size.
        let part = (if parts.is_tiled { rows } else { rows.min(height - top) }, columns);
        let bytes = raw.file().part(at as u64, length as u64).ok_or_else(no_pixels)?;
        let values = if is_lossless {
            lossless(bytes, part, kind)?
        } else {
            plain(bytes, part, sample, raw.file().is_big_endian())?
        };
        let (kept_rows, kept_columns) = (part.0.min(height - top), columns.min(width - left));
        all.slice_mut(s![top..top + kept_rows, left..left + kept_columns])
            .assign(&values.slice(s![..kept_rows, ..kept_columns]));
    }
    Ok((all, sample))
}

fn no_pixels() -> Rejection {
    Rejection::Cut("its pixels do".to_owned())
}

/// A compression by its number and, where cameras and converters use it, its name.
fn named(compression: usize) -> String {
    let name = match compression {
        5 => "LZW",
        6 => "JPEG of TIFF 6",
        8 | 32946 => "deflate",
        34892 => "lossy JPEG",
        52546 => "JPEG XL",
        _ => return compression.to_string(),
    };
    format!("{compression} ({name})")
}

fn lossless(bytes: &[u8], (rows, columns): (usize, usize), kind: Kind) -> Result<Array2<f32>, Rejection> {
    if rows * columns / 8 > bytes.len() {
        return Err(no_pixels());
    }
    let samples =
        lossless_jpeg::decode(bytes, rows * columns, kind).map_err(|e| Rejection::Damaged(e.to_owned()))?;
    let samples = samples.into_iter().map(f32::from).collect();
    Array2::from_shape_vec((rows, columns), samples).map_err(|e| Rejection::Damaged(e.to_string()))
}

/// Values without compression. Floating-point numbers and integers of 8, 16 and 32 bits are whole bytes in the file's order. Other integers
/// are packed, the first pixel in the upper bits, each row in whole bytes.
fn plain(
    bytes: &[u8],
    (rows, columns): (usize, usize),
    sample: Sample,
    is_big_endian: bool,
) -> Result<Array2<f32>, Rejection> {
    let bits = sample.bits() as usize;
    let pitch = (columns * bits).div_ceil(8);
    let bytes = bytes.get(..rows * pitch).ok_or_else(no_pixels)?;
    let join = |all: u32, byte: &u8| all << 8 | u32::from(*byte);
    let number = |row: usize, column: usize| {
        let line = &bytes[row * pitch..(row + 1) * pitch];
        if matches!(sample, Sample::Whole(bits) if ![8, 16, 32].contains(&bits)) {
            return packed(line, column * bits, bits);
        }
        let number = &line[column * bits / 8..(column + 1) * bits / 8];
        if is_big_endian { number.iter().fold(0, join) } else { number.iter().rev().fold(0, join) }
    };
    let value = |number: u32| match sample {
        Sample::Whole(_) => number as f32,
        Sample::Float(bits) => float(number, bits),
    };
    let values = Array2::from_shape_fn((rows, columns), |(row, column)| value(number(row, column)));
    match values.indexed_iter().find(|(_, v)| v.is_nan()) {
        Some(((row, column), _)) => Err(Rejection::Damaged(format!(
            "a pixel of a tile or strip is NaN, at its row {row}, column {column}"
        ))),
        None => Ok(values),
    }
}

/// The number of `bits` bits (at most 32) that begins at a bit of a line.
fn packed(line: &[u8], first: usize, bits: usize) -> u32 {
    let byte = |offset: usize| u64::from(line.get(first / 8 + offset).copied().unwrap_or(0));
    let five = (0..5).fold(0, |all, offset| all << 8 | byte(offset));
    (five >> (40 - first % 8 - bits) & ((1 << bits) - 1)) as u32
}

/// A floating-point number of 16 bits (IEEE 754, 5 of exponent), 24 (DNG: 7 of exponent) or 32.
fn float(number: u32, bits: u32) -> f32 {
    let (exponent_bits, fraction_bits) = match bits {
        16 => (5, 10),
        24 => (7, 16),
        _ => return f32::from_bits(number),
    };
    let sign = if number >> (bits - 1) == 1 { -1.0 } else { 1.0 };
    let fraction = number & ((1 << fraction_bits) - 1);
    let exponent = (number >> fraction_bits & ((1 << exponent_bits) - 1)) as i32;
    let bias = (1 << (exponent_bits - 1)) - 1;
    let share = f64::from(fraction) / f64::from(1u32 << fraction_bits);
    let value = match exponent {
        0 => share * f64::from(1 - bias).exp2(),
        e if e == (1 << exponent_bits) - 1 => {
            if fraction == 0 {
                f64::INFINITY
            } else {
                f64::NAN
            }
        }
        e => (1.0 + share) * f64::from(e - bias).exp2(),
    };
    (sign * value) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floating_point_numbers_are_those_of_ieee_754() {
        // Of 16 bits: 1, the largest, the least normal and the least of all, −2, infinity.
        for (word, value) in [
            (0x3c00, 1.0),
            (0x7bff, 65504.0),
            (0x0400, 6.103_515_6e-5),
            (0x0001, 5.960_464_5e-8),
            (0xc000, -2.0),
            (0x7c00, f32::INFINITY),
            (0x34cd, 0.300_048_83),
        ] {
            assert_eq!(float(word, 16), value, "{word:04x}");
        }
        assert!(float(0x7c01, 16).is_nan());
        // Of 24 bits: 1, 0.5, −3.
        for (word, value) in [(0x3f_0000, 1.0), (0x3e_0000, 0.5), (0xc0_8000, -3.0)] {
            assert_eq!(float(word, 24), value, "{word:06x}");
        }
        assert_eq!(float(0x3f80_0000, 32), 1.0);
    }

    #[test]
    fn packed_numbers_begin_in_the_upper_bits() {
        assert_eq!([packed(&[0xab, 0xcd, 0xef], 0, 12), packed(&[0xab, 0xcd, 0xef], 12, 12)], [0xabc, 0xdef]);
        assert_eq!(packed(&[0x7f, 0xff, 0xff, 0xff, 0x80], 1, 32), u32::MAX);
    }
}
