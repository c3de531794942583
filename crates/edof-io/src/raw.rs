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
//! So a frame that [`save`] wrote as PNG, TIFF or PGM is read back without any option but its phase.

use crate::camera_raw::{self, CameraRawError};
use crate::dng::{self, Dng, Finish, Overrides};

use crate::packing::{self, ByteOrder, Packing, Stray};
use crate::picture::{self, Format, PictureError};
use crate::rendering::Rendering;
use crate::samples::Samples;
use edof_core::frame::FrameError;
use edof_core::{CfaPhase, RawFrame};
use ndarray::{Array2, Axis};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What a file cannot say about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RawOptions {
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits that the sensor gave, 8…16; where absent, what the file says (a PGM's maximum), else 16.
    pub depth: Option<u32>,
    /// Size of a headerless file; other files must agree with it.
    pub size: Option<Size>,
    /// Where in a word values of fewer than 16 bits lie; where absent, as in the table above.
    pub alignment: Option<Alignment>,
    /// Order of the two bytes of a headerless file's words.
    pub order: ByteOrder,
    /// How a headerless file's pixels are packed.
    pub packing: Packing,
}

/// Width and height in pixels, written `WIDTHxHEIGHT`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Size {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// Where in a 16-bit word a value of fewer bits lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// At the top, zeros below.
    Top,
    /// At the bottom, zeros above.
    Bottom,
}

impl std::fmt::Display for Alignment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Top => "top",
            Self::Bottom => "bottom",
        })
    }
}

/// A raw frame that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum RawError {
    /// The file itself.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Camera raw that cannot be used.
    #[error(transparent)]
    CameraRaw(#[from] CameraRawError),
    /// No picture, and no size to read it as headerless.
    #[error(
        "{path}: not a PNG, TIFF or PGM file; for a headerless file state its size as WIDTHxHEIGHT",
        path = path.display()
    )]
    NoSize { path: PathBuf },
    /// A colour picture.
    #[error("{path}: holds a colour picture, expected one raw value a pixel", path = path.display())]
    Colour { path: PathBuf },
    /// Fewer bits than stated.
    #[error("{path}: holds {found}-bit samples, expected {expected}", path = path.display())]
    Depth { path: PathBuf, found: u32, expected: String },
    /// Another size than stated.
    #[error("{path}: {found}, expected {expected} for {size}{hint}", path = path.display())]
    Size { path: PathBuf, found: String, expected: String, size: Size, hint: String },
    /// Bits where a top-aligned value has none.
    #[error(
        "{path}: pixel at row {row}, column {column} is {value}, no {depth}-bit code aligned to the top of 16 bits",
        path = path.display()
    )]
    Alignment { path: PathBuf, row: usize, column: usize, value: u16, depth: u32 },
    /// A byte of video that carries nothing.
    #[error(
        "{path}: byte {code} at row {row}, column {column}, expected 64 to 191: no raw frame as video, or a link that changed it",
        path = path.display()
    )]
    Code { path: PathBuf, row: usize, column: usize, code: u8 },
    /// Odd sides, a depth outside 8…16, a value too large.
    #[error("{path}: {source}", path = path.display())]
    Frame { path: PathBuf, source: FrameError },
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl From<Size> for String {
    fn from(size: Size) -> Self {
        size.to_string()
    }
}

impl TryFrom<String> for Size {
    type Error = WrongSize;

    fn try_from(text: String) -> Result<Self, WrongSize> {
        text.parse()
    }
}

impl Size {
    /// Of a frame.
    #[must_use]
    pub fn of(frame: &RawFrame) -> Self {
        let (height, width) = frame.size();
        Self { width, height }
    }

    /// Bytes of a headerless file.
    const fn bytes(self, packing: Packing) -> usize {
        packing.bytes(self.width * self.height)
    }

    /// A file of `found` bytes, where that is known.
    fn wrong_length(self, packing: Packing, found: Option<u64>, path: &Path) -> RawError {
        let fitting = |other: &Packing| *other != packing && Some(self.bytes(*other) as u64) == found;
        let names: Vec<&str> = Packing::ALL.iter().filter(|p| fitting(p)).map(|p| p.name()).collect();
        RawError::Size {
            path: path.to_owned(),
            found: found.map_or("more bytes".to_owned(), |found| format!("{found} bytes")),
            expected: self.bytes(packing).to_string(),
            size: self,
            hint: if names.is_empty() {
                String::new()
            } else {
                format!("; as many as packed as {}", names.join(" or "))
            },
        }
    }
}

/// Text that is not a size.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("size '{0}': expected WIDTHxHEIGHT in pixels, 1 to 65535 each, as in 1920x1080")]
pub struct WrongSize(String);

impl std::str::FromStr for Size {
    type Err = WrongSize;

    fn from_str(text: &str) -> Result<Self, WrongSize> {
        let side = |word: &str| word.parse().ok().filter(|v| (1..=65535).contains(v));
        text.split_once('x')
            .and_then(|(w, h)| Some(Self { width: side(w)?, height: side(h)? }))
            .ok_or_else(|| WrongSize(text.to_owned()))
    }
}

/// A raw frame, and what its file states of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Opened {
    /// The sensor's values, or the light of a camera's file.
    pub frame: RawFrame,
    /// The kind of its file.
    pub kind: Kind,
    /// What its camera would do to the colours.
    pub rendering: Rendering,
    /// What its file asks to be done with the picture.
    pub finish: Finish,
    /// What its file asks for and is not done.
    pub notes: Vec<String>,
}

/// Kinds of raw files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Sensor values in a picture or without a header; options state what they are.
    Values,
    /// A DNG, which states everything.
    Dng,
    /// A camera's own format, which states everything.
    CameraRaw,
}

/// Reads a raw frame with what its file states of it. The content decides what the file is; its ending does where the content does not.
/// `overrides` take the place of what a DNG states.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn open(path: &Path, options: &RawOptions, overrides: &Overrides) -> Result<Opened, RawError> {
    let alone = |frame, kind| Opened {
        frame,
        kind,
        rendering: Rendering::default(),
        finish: Finish::default(),
        notes: vec![],
    };
    // A pipe is read once.
    let (mut file, mut bytes) = picture::open(path)?;
    if dng::is_tiff(&bytes) {
        file.read_to_end(&mut bytes).map_err(cannot_read(path))?;
    }
    match kind_of(path, &bytes, options) {
        Kind::Dng => {
            file.read_to_end(&mut bytes).map_err(cannot_read(path))?;
            let Dng { frame, rendering, finish, notes } = dng::decode(&bytes, path, overrides)?;
            Ok(Opened { frame, kind: Kind::Dng, rendering, finish, notes })
        }
        Kind::CameraRaw => Ok(alone(camera_raw::load(path)?, Kind::CameraRaw)),
        Kind::Values => Ok(alone(picture_or_headerless(file, bytes, path, options)?, Kind::Values)),
    }
}

/// What a file is that begins with these bytes; those of a TIFF are all there.
fn kind_of(path: &Path, bytes: &[u8], options: &RawOptions) -> Kind {
    let is_named_dng = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("dng"));
    let by_name = match (is_named_dng, camera_raw::is_name(path)) {
        (true, _) => Kind::Dng,
        (_, true) => Kind::CameraRaw,
        _ => Kind::Values,
    };
    let is_tiff = dng::is_tiff(bytes);
    let is_values = !is_tiff && (Format::of(bytes).is_some() || options.size.is_some());
    if camera_raw::is_content(bytes) {
        Kind::CameraRaw
    } else if is_tiff && dng::is_dng(bytes) {
        Kind::Dng
    } else if is_values {
        Kind::Values
    } else {
        by_name
    }
}

/// A raw frame alone.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn load(path: &Path, options: &RawOptions) -> Result<RawFrame, RawError> {
    Ok(open(path, options, &Overrides::default())?.frame)
}

/// The frame of a file whose first bytes are read already.
fn picture_or_headerless(
    mut file: File,
    mut bytes: Vec<u8>,
    path: &Path,
    options: &RawOptions,
) -> Result<RawFrame, RawError> {
    if let Some(depth) = options.depth.filter(|d| !(8..=16).contains(d)) {
        return Err(RawError::Frame { path: path.to_owned(), source: FrameError::Depth(depth) });
    }
    let format =
        Format::of(&bytes).filter(|format| format.keeps_values() && options.packing == Packing::Words);
    let (words, depth, alignment) = match (format, options.size) {
        (None, None) => return Err(RawError::NoSize { path: path.to_owned() }),
        (None, Some(size)) => {
            let depth = headerless_depth(options, path)?;
            read_exactly(&mut file, &mut bytes, size, options.packing, path)?;
            let alignment =
                if options.packing == Packing::Video { Alignment::Top } else { Alignment::Bottom };
            (headerless(&bytes, size, options, path)?, depth, alignment)
        }
        (Some(format), size) => {
            file.read_to_end(&mut bytes).map_err(cannot_read(path))?;
            let samples = picture::decode(&bytes, path)?;
            let (depth, alignment) = meaning(format, &samples, options.depth, path)?;
            (single_plane(samples, size, path)?, depth, alignment)
        }
    };
    let values = match options.alignment.unwrap_or(alignment) {
        Alignment::Bottom => words,
        Alignment::Top => lower(words, depth, path)?,
    };
    RawFrame::from_values(values, depth, options.phase)
        .map_err(|source| RawError::Frame { path: path.to_owned(), source })
}

/// Depth and alignment of a picture file's samples.
fn meaning(
    format: Format,
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
        (255, None) if format == Format::Pnm => Ok((8, Alignment::Bottom)),
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
    let found = Size { width, height };
    match size {
        Some(size) if size != found => Err(RawError::Size {
            path: path.to_owned(),
            found: format!("{found} pixels"),
            expected: "as many as stated".to_owned(),
            size,
            hint: String::new(),
        }),
        _ => Ok(samples.planes.index_axis_move(Axis(0), 0)),
    }
}

/// Bits of a headerless file's pixels.
fn headerless_depth(options: &RawOptions, path: &Path) -> Result<u32, RawError> {
    let found = options.packing.bits();
    match options.depth {
        None => Ok(found),
        Some(depth) if options.packing.is_words() || depth == found => Ok(depth),
        Some(depth) => {
            Err(RawError::Depth { path: path.to_owned(), found, expected: format!("{depth} bits as stated") })
        }
    }
}

/// Reads the rest of a headerless file: no more than it must hold, and nothing of one that is known to be of another size.
fn read_exactly(
    file: &mut File,
    bytes: &mut Vec<u8>,
    size: Size,
    packing: Packing,
    path: &Path,
) -> Result<(), RawError> {
    let expected = size.bytes(packing) as u64;
    let found = file.metadata().ok().filter(std::fs::Metadata::is_file).map(|what| what.len());
    if let Some(found) = found.filter(|found| *found != expected) {
        return Err(size.wrong_length(packing, Some(found), path));
    }
    let rest = (expected + 1).saturating_sub(bytes.len() as u64);
    file.take(rest).read_to_end(bytes).map_err(cannot_read(path))?;
    if bytes.len() as u64 > expected {
        return Err(size.wrong_length(packing, None, path));
    }
    Ok(())
}

fn cannot_read(path: &Path) -> impl Fn(std::io::Error) -> PictureError + '_ {
    move |source| PictureError::Read { path: path.to_owned(), source }
}

fn headerless(bytes: &[u8], size: Size, options: &RawOptions, path: &Path) -> Result<Array2<u16>, RawError> {
    let wrong_length = || size.wrong_length(options.packing, Some(bytes.len() as u64), path);
    if bytes.len() != size.bytes(options.packing) {
        return Err(wrong_length());
    }
    let stray = |Stray { pixel, code }| RawError::Code {
        path: path.to_owned(),
        row: pixel / size.width,
        column: pixel % size.width,
        code,
    };
    let values = options.packing.values(bytes, options.order).map_err(stray)?;
    Array2::from_shape_vec((size.height, size.width), values).map_err(|_| wrong_length())
}

/// Values of top-aligned words.
fn lower(words: Array2<u16>, depth: u32, path: &Path) -> Result<Array2<u16>, RawError> {
    let shift = 16 - depth;
    let below = ((1u32 << shift) - 1) as u16;
    if let Some(((row, column), &value)) = words.indexed_iter().find(|(_, v)| **v & below != 0) {
        return Err(RawError::Alignment { path: path.to_owned(), row, column, value, depth });
    }
    Ok(words.mapv_into(|v| v >> shift))
}

/// Kinds of files for raw frames.
enum Written {
    /// Words alone.
    Headerless,
    /// Pictures whose full scale is that of 16 bits.
    FullScale,
    /// Pictures that state their full scale.
    StatedScale,
}

fn kind(path: &Path) -> Result<Written, RawError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    match ending.as_str() {
        "raw" | "bin" => Ok(Written::Headerless),
        "png" | "tif" | "tiff" => Ok(Written::FullScale),
        "pgm" => Ok(Written::StatedScale),
        _ => {
            let expected = ".png, .tif, .tiff, .pgm, .raw or .bin";
            Err(PictureError::Ending { path: path.to_owned(), expected }.into())
        }
    }
}

/// Whether [`save`] knows how to write a file of that name; for anybody who has long work to do first.
///
/// # Errors
/// [`RawError::Picture`] with the endings that it knows.
pub fn check_ending(path: &Path) -> Result<(), RawError> {
    kind(path).map(drop)
}

/// Writes a raw frame: 16-bit PNG or TIFF (values at the top of each word), PGM (values and their maximum), or for `.raw`
/// and `.bin` headerless little-endian words (values at the bottom).
///
/// # Errors
/// [`RawError::Picture`] naming the file; none is left half written.
pub fn save(path: &Path, frame: &RawFrame) -> Result<(), RawError> {
    let (words, full_scale) = match kind(path)? {
        Written::Headerless => {
            let bytes: Vec<u8> = frame.values().iter().flat_map(|v| v.to_le_bytes()).collect();
            edof_core::storage::atomic::write(path, &bytes).map_err(PictureError::from)?;
            return Ok(());
        }
        Written::FullScale => (frame.pixels().clone(), u16::MAX),
        Written::StatedScale => (frame.values(), u16::MAX >> (16 - frame.depth())),
    };
    Ok(picture::save(path, &Samples { planes: words.insert_axis(Axis(0)), full_scale })?)
}

/// Writes a raw frame as a playout card takes it (`2vuy`), for the board's cable.
///
/// # Errors
/// [`RawError::Picture`] naming the file; none is left half written.
pub fn save_video(path: &Path, frame: &RawFrame) -> Result<(), RawError> {
    Ok(edof_core::storage::atomic::write(path, &packing::video(frame)).map_err(PictureError::from)?)
}

#[cfg(test)]
mod tests;
