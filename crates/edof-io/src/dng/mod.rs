//! DNG: the raw frame of a camera, uncompressed or as lossless JPEG, and what the file says of its levels and colours.
//!
//! Of the many kinds of DNG this reads the one that holds a Bayer mosaic of 8 to 16 bits (photometric interpretation 32803), in strips or
//! tiles, from whichever directory holds it. Tags are numbered as in Adobe's "Digital Negative (DNG) Specification", version 1.4;
//! pattern and black levels begin at the corner of the active area, as there.

mod directory;
mod lossless_jpeg;

use crate::camera_raw::CameraRawError;
use crate::levels::{Black, Levels};
use crate::rendering::{ColourMatrix, Rendering, WhiteBalance};
use directory::{Directory, Tiff};
use edof_image::{CfaPhase, Channel, RawFrame};
use ndarray::{Array2, s};
use std::path::Path;

/// A frame from a DNG file.
#[derive(Debug, Clone, PartialEq)]
pub struct Dng {
    /// Sensor values of the active area.
    pub frame: RawFrame,
    /// What darkness and full light are among them.
    pub levels: Levels,
    /// White balance as shot, and the matrix to linear sRGB.
    pub rendering: Rendering,
}

/// Why a file cannot be used.
enum Refusal {
    Decode(String),
    Mosaic(String),
}

impl From<&str> for Refusal {
    fn from(reason: &str) -> Self {
        Self::Decode(reason.to_owned())
    }
}

/// Whether a name's ending stands for DNG.
#[must_use]
pub fn is_dng(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("dng"))
}

/// Reads a DNG in memory; `path` names it in errors.
///
/// # Errors
/// [`CameraRawError`]: damaged, no Bayer mosaic, or compressed in another way.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Dng, CameraRawError> {
    read(bytes).map_err(|refusal| match refusal {
        Refusal::Decode(reason) => CameraRawError::Decode { path: path.to_owned(), reason },
        Refusal::Mosaic(found) => CameraRawError::Mosaic { path: path.to_owned(), found },
    })
}

fn read(bytes: &[u8]) -> Result<Dng, Refusal> {
    let tiff = Tiff::new(bytes).ok_or("it does not begin like a DNG")?;
    let directories = tiff.directories();
    let interpreted = |of: usize| directories.iter().find(|d| d.whole(tag::INTERPRETATION) == Some(of));
    let Some(raw) = interpreted(COLOUR_FILTER_ARRAY) else {
        return Err(match interpreted(LINEAR_RAW) {
            Some(_) => Refusal::Mosaic("three colours at every pixel (linear DNG)".to_owned()),
            None => "no directory of it holds a colour filter array".into(),
        });
    };
    let values = linearized(raw, pixels(raw)?)?;
    let area = active_area(raw, values.dim())?;
    let values = values.slice(s![area[0]..area[2], area[1]..area[3]]).to_owned();
    let bits = raw.whole(tag::BITS).unwrap_or(16) as u32;
    let depth = if raw.numbers(tag::LINEARIZATION).is_some() { 16 } else { bits.clamp(8, 16) };
    let frame =
        RawFrame::from_values(values, depth, phase(raw)?).map_err(|e| Refusal::Decode(e.to_string()))?;
    let white = raw.numbers(tag::WHITE_LEVEL).and_then(|all| all.first().copied());
    let levels = Levels { black: black(raw)?, white: white.or(Some(f64::from((1u32 << depth) - 1))) };
    Ok(Dng { frame, levels, rendering: rendering(&directories)? })
}

/// Numbers of the tags.
mod tag {
    pub const WIDTH: u16 = 256;
    pub const HEIGHT: u16 = 257;
    pub const BITS: u16 = 258;
    pub const COMPRESSION: u16 = 259;
    pub const INTERPRETATION: u16 = 262;
    pub const STRIP_OFFSETS: u16 = 273;
    pub const SAMPLES: u16 = 277;
    pub const STRIP_ROWS: u16 = 278;
    pub const STRIP_BYTES: u16 = 279;
    pub const TILE_WIDTH: u16 = 322;
    pub const TILE_HEIGHT: u16 = 323;
    pub const TILE_OFFSETS: u16 = 324;
    pub const TILE_BYTES: u16 = 325;
    pub const CFA_SIZE: u16 = 33421;
    pub const CFA: u16 = 33422;
    pub const CFA_COLOURS: u16 = 50710;
    pub const LINEARIZATION: u16 = 50712;
    pub const BLACK_SIZE: u16 = 50713;
    pub const BLACK_LEVEL: u16 = 50714;
    pub const WHITE_LEVEL: u16 = 50717;
    pub const COLOUR_MATRICES: [u16; 2] = [50722, 50721];
    pub const NEUTRAL: u16 = 50728;
    pub const ACTIVE_AREA: u16 = 50829;
    pub const FORWARD_MATRICES: [u16; 2] = [50965, 50964];
}

const COLOUR_FILTER_ARRAY: usize = 32803;
const LINEAR_RAW: usize = 34892;
/// Longest side, as of every frame here.
const LONGEST: usize = 65535;

/// Where the parts of a picture lie.
struct Parts {
    /// Rows and columns of a part.
    size: (usize, usize),
    tiled: bool,
    offsets: Vec<usize>,
    bytes: Vec<usize>,
}

fn parts(raw: &Directory<'_>, (height, width): (usize, usize)) -> Option<Parts> {
    if let Some(offsets) = raw.wholes(tag::TILE_OFFSETS) {
        let size = (raw.whole(tag::TILE_HEIGHT)?, raw.whole(tag::TILE_WIDTH)?);
        return Some(Parts { size, tiled: true, offsets, bytes: raw.wholes(tag::TILE_BYTES)? });
    }
    let rows = raw.whole(tag::STRIP_ROWS).unwrap_or(height).min(height);
    Some(Parts {
        size: (rows, width),
        tiled: false,
        offsets: raw.wholes(tag::STRIP_OFFSETS)?,
        bytes: raw.wholes(tag::STRIP_BYTES)?,
    })
}

/// The whole picture of a directory.
fn pixels(raw: &Directory<'_>) -> Result<Array2<u16>, Refusal> {
    let side = |tag| raw.whole(tag).filter(|side| (2..=LONGEST).contains(side));
    let size @ (height, width) =
        side(tag::HEIGHT).zip(side(tag::WIDTH)).ok_or("its size is missing or impossible")?;
    let bits = raw.whole(tag::BITS).unwrap_or(16);
    if raw.whole(tag::SAMPLES).unwrap_or(1) != 1 || !(8..=16).contains(&bits) {
        return Err("its pixels are not one value of 8 to 16 bits each".into());
    }
    let compression = raw.whole(tag::COMPRESSION).unwrap_or(1);
    if ![1, 7].contains(&compression) {
        return Err(Refusal::Decode(format!(
            "compression {compression}, expected 1 (none) or 7 (lossless JPEG); convert it to one of these"
        )));
    }
    let parts = parts(raw, size).ok_or("its pixels are nowhere")?;
    let (rows, columns) = parts.size;
    if !(1..=LONGEST).contains(&rows) || !(1..=LONGEST).contains(&columns) {
        return Err("its tiles have an impossible size".into());
    }
    let (across, down) = (width.div_ceil(columns), height.div_ceil(rows));
    if parts.offsets.len() != across * down || parts.bytes.len() != across * down {
        return Err("it has not as many tiles or strips as its size needs".into());
    }
    // Before memory is asked for: a pixel takes a bit at least, of the parts and of the file, in which parts may lie over each other.
    let held = parts.bytes.iter().fold(0usize, |sum, bytes| sum.saturating_add(*bytes));
    if held.min(raw.tiff().length()) < height * width / 8 {
        return Err("it ends before its pixels do".into());
    }
    let mut all = Array2::zeros(size);
    for (index, (&at, &length)) in parts.offsets.iter().zip(&parts.bytes).enumerate() {
        let (top, left) = (index / across * rows, index % across * columns);
        // The last strip is as long as there are rows; all tiles have one size.
        let stored = (if parts.tiled { rows } else { rows.min(height - top) }, columns);
        let bytes = raw.tiff().part(at, length).ok_or("it ends before its pixels do")?;
        let values = match compression {
            7 => lossless(bytes, stored)?,
            _ => plain(bytes, stored, bits as u32, raw.tiff().is_big_endian())?,
        };
        let (kept_rows, kept_columns) = (stored.0.min(height - top), columns.min(width - left));
        all.slice_mut(s![top..top + kept_rows, left..left + kept_columns])
            .assign(&values.slice(s![..kept_rows, ..kept_columns]));
    }
    Ok(all)
}

fn lossless(bytes: &[u8], (rows, columns): (usize, usize)) -> Result<Array2<u16>, Refusal> {
    if rows * columns / 8 > bytes.len() {
        return Err("it ends before its pixels do".into());
    }
    let samples = lossless_jpeg::decode(bytes, rows * columns)?;
    Array2::from_shape_vec((rows, columns), samples).map_err(|e| Refusal::Decode(e.to_string()))
}

/// Values as they are: words of the file's byte order, bytes, or packed, the first pixel in the upper bits, each row in whole bytes.
fn plain(
    bytes: &[u8],
    (rows, columns): (usize, usize),
    bits: u32,
    big: bool,
) -> Result<Array2<u16>, Refusal> {
    let pitch = (columns * bits as usize).div_ceil(8);
    let bytes = bytes.get(..rows * pitch).ok_or("it ends before its pixels do")?;
    let value = |row: usize, column: usize| {
        let line = &bytes[row * pitch..(row + 1) * pitch];
        let first = column * bits as usize;
        match bits {
            16 if big => u16::from_be_bytes([line[2 * column], line[2 * column + 1]]),
            16 => u16::from_le_bytes([line[2 * column], line[2 * column + 1]]),
            _ => {
                let byte = |offset: usize| u32::from(line.get(first / 8 + offset).copied().unwrap_or(0));
                let three = byte(0) << 16 | byte(1) << 8 | byte(2);
                (three >> (24 - first % 8 - bits as usize) & ((1 << bits) - 1)) as u16
            }
        }
    };
    Ok(Array2::from_shape_fn((rows, columns), |(row, column)| value(row, column)))
}

/// Values by the file's table, where it has one.
fn linearized(raw: &Directory<'_>, values: Array2<u16>) -> Result<Array2<u16>, Refusal> {
    let Some(table) = raw.wholes(tag::LINEARIZATION) else { return Ok(values) };
    let last = table.last().ok_or("its linearization table is empty")?;
    Ok(values.mapv(|value| *table.get(usize::from(value)).unwrap_or(last) as u16))
}

/// Top, left, bottom and right of what light falls on, whole Bayer cells.
fn active_area(raw: &Directory<'_>, (height, width): (usize, usize)) -> Result<[usize; 4], Refusal> {
    let area = raw.wholes(tag::ACTIVE_AREA).unwrap_or_else(|| vec![0, 0, height, width]);
    match area[..] {
        [top, left, bottom, right]
            if top < bottom.saturating_sub(1)
                && left < right.saturating_sub(1)
                && bottom <= height
                && right <= width =>
        {
            Ok([top, left, bottom - (bottom - top) % 2, right - (right - left) % 2])
        }
        _ => Err("its active area is not inside of it".into()),
    }
}

fn phase(raw: &Directory<'_>) -> Result<CfaPhase, Refusal> {
    let size = raw.wholes(tag::CFA_SIZE).unwrap_or_else(|| vec![2, 2]);
    let pattern = raw.wholes(tag::CFA).ok_or("it says nothing of its colour filters")?;
    let colours = raw.wholes(tag::CFA_COLOURS).unwrap_or_else(|| vec![0, 1, 2]);
    let fits = |phase: &CfaPhase| {
        let colour = |channel: Channel| [0, 1, 2][channel.plane()];
        let expected: Vec<usize> = (0..4).map(|cell| colour(phase.channel(cell / 2, cell % 2))).collect();
        size == [2, 2] && colours == [0, 1, 2] && pattern == expected
    };
    CfaPhase::ALL.into_iter().find(fits).ok_or_else(|| {
        let [rows, columns] = [0, 1].map(|side| size.get(side).copied().unwrap_or(0));
        Refusal::Mosaic(format!("a {rows}x{columns} mosaic {pattern:?} of colours {colours:?}"))
    })
}

/// Black levels of a cell, from one for all or one for each of its pixels.
fn black(raw: &Directory<'_>) -> Result<Black, Refusal> {
    let Some(levels) = raw.numbers(tag::BLACK_LEVEL) else { return Ok(Black::default()) };
    let size = raw.wholes(tag::BLACK_SIZE).unwrap_or_else(|| vec![1, 1]);
    let of_cell = match (&size[..], &levels[..]) {
        ([1, 1], &[all]) => [all; 4],
        ([1, 2], &[a, b]) => [a, b, a, b],
        ([2, 1], &[a, b]) => [a, a, b, b],
        ([2, 2], &[a, b, c, d]) => [a, b, c, d],
        _ => return Err("its black levels repeat otherwise than its colour filters".into()),
    };
    Black::new(of_cell).map_err(|e| Refusal::Decode(e.to_string()))
}

/// Linear sRGB from XYZ under D50 (Bradford), the colours of a forward matrix.
const SRGB_FROM_D50: [[f64; 3]; 3] = [
    [3.133_856_1, -1.616_866_7, -0.490_614_6],
    [-0.978_768_4, 1.916_141_5, 0.033_454_0],
    [0.071_945_3, -0.228_991_4, 1.405_242_7],
];
/// XYZ under D65 from linear sRGB.
const D65_FROM_SRGB: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// The white balance is one over what the camera saw of white. The matrix is the file's for daylight (the second of two): forward to XYZ
/// where it has one, else from XYZ, each of its rows scaled so that white is white (as dcraw does), and inverted.
fn rendering(directories: &[Directory<'_>]) -> Result<Rendering, Refusal> {
    let three = |tag| directories.iter().find_map(|d| <[f64; 3]>::try_from(d.numbers(tag)?).ok());
    let nine = |tag: &u16| directories.iter().find_map(|d| <[f64; 9]>::try_from(d.numbers(*tag)?).ok());
    let rows = |all: [f64; 9]| std::array::from_fn(|row| std::array::from_fn(|column| all[3 * row + column]));
    let white_balance = match three(tag::NEUTRAL) {
        Some(neutral) => {
            let balance = WhiteBalance::try_from(neutral.map(|share| 1.0 / share));
            Some(balance.map_err(|e| Refusal::Decode(e.to_string()))?)
        }
        None => None,
    };
    let forward =
        tag::FORWARD_MATRICES.iter().find_map(nine).map(|m| scaled(product(SRGB_FROM_D50, rows(m))));
    let backward = || {
        let matrix: [[f64; 3]; 3] = tag::COLOUR_MATRICES.iter().find_map(nine).map(rows)?;
        inverse(scaled(product(matrix, D65_FROM_SRGB)))
    };
    let matrix = forward.or_else(backward).map(ColourMatrix::try_from).transpose();
    Ok(Rendering { white_balance, matrix: matrix.map_err(|e| Refusal::Decode(e.to_string()))? })
}

fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| std::array::from_fn(|column| (0..3).map(|i| row[i] * b[i][column]).sum()))
}

/// Rows scaled to add up to 1.
fn scaled(matrix: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    matrix.map(|row| row.map(|v| v / row.iter().sum::<f64>()))
}

fn inverse(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * minor(0, column)).sum();
    (determinant.abs() > 1e-9)
        .then(|| std::array::from_fn(|row| std::array::from_fn(|column| minor(column, row) / determinant)))
}

#[cfg(test)]
mod tests;
