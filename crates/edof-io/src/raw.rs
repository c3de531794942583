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
//! | DNG ([`crate::dng`]) | what the file states | the file states its phase, too |
//! | other camera raw ([`crate::camera_raw`]) | what the file states | the file states its phase, too |
//!
//! So a frame that [`save`] wrote as PNG, TIFF or PGM is read back without any option but its phase.

use crate::camera_raw::{self, CameraRawError};
use crate::dng::{self, Dng};
use crate::levels::Levels;
use crate::packing::{self, ByteOrder, Packing, Stray};
use crate::picture::{self, Format, PictureError};
use crate::rendering::Rendering;
use crate::samples::Samples;
use edof_image::frame::FrameError;
use edof_image::{CfaPhase, RawFrame};
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

/// Text that is no size.
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

/// A raw frame, and what its file says of its levels and colours, where it says anything.
#[derive(Debug, Clone, PartialEq)]
pub struct Opened {
    /// The sensor's values.
    pub frame: RawFrame,
    /// What darkness and full light are among them.
    pub levels: Option<Levels>,
    /// What its camera would do to the colours.
    pub rendering: Rendering,
}

/// Reads a raw frame with what its file says of it.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn open(path: &Path, options: &RawOptions) -> Result<Opened, RawError> {
    let alone = |frame| Opened { frame, levels: None, rendering: Rendering::default() };
    if dng::is_dng(path) {
        let bytes = std::fs::read(path).map_err(cannot_read(path))?;
        return match dng::decode(&bytes, path) {
            Ok(Dng { frame, levels, rendering }) => Ok(Opened { frame, levels: Some(levels), rendering }),
            // Of a kind that is rarer than it is worth here.
            Err(CameraRawError::Decode { .. }) if cfg!(feature = "camera-raw") => {
                Ok(alone(camera_raw::load(path)?))
            }
            Err(error) => Err(error.into()),
        };
    }
    if camera_raw::is_camera_raw(path) {
        return Ok(alone(camera_raw::load(path)?));
    }
    Ok(alone(picture_or_headerless(path, options)?))
}

/// A raw frame alone.
///
/// # Errors
/// Any [`RawError`], naming the file.
pub fn load(path: &Path, options: &RawOptions) -> Result<RawFrame, RawError> {
    Ok(open(path, options)?.frame)
}

fn picture_or_headerless(path: &Path, options: &RawOptions) -> Result<RawFrame, RawError> {
    let (mut file, mut bytes) = picture::open(path)?;
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
enum Kind {
    /// Words alone.
    Headerless,
    /// Pictures whose full scale is that of 16 bits.
    FullScale,
    /// Pictures that state their full scale.
    StatedScale,
}

fn kind(path: &Path) -> Result<Kind, RawError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    match ending.as_str() {
        "raw" | "bin" => Ok(Kind::Headerless),
        "png" | "tif" | "tiff" => Ok(Kind::FullScale),
        "pgm" => Ok(Kind::StatedScale),
        _ => {
            let expected = ".png, .tif, .tiff, .pgm, .raw or .bin";
            Err(PictureError::Ending { path: path.to_owned(), expected }.into())
        }
    }
}

/// Whether [`save`] knows how to write a file of that name; for whoever has long work to do first.
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
        Kind::Headerless => {
            let bytes: Vec<u8> = frame.values().iter().flat_map(|v| v.to_le_bytes()).collect();
            edof_storage::atomic::write(path, &bytes).map_err(PictureError::from)?;
            return Ok(());
        }
        Kind::FullScale => (frame.pixels().clone(), u16::MAX),
        Kind::StatedScale => (frame.values(), u16::MAX >> (16 - frame.depth())),
    };
    Ok(picture::save(path, &Samples { planes: words.insert_axis(Axis(0)), full_scale })?)
}

/// Writes a raw frame as a playout card takes it (`2vuy`), for the board's cable.
///
/// # Errors
/// [`RawError::Picture`] naming the file; none is left half written.
pub fn save_video(path: &Path, frame: &RawFrame) -> Result<(), RawError> {
    Ok(edof_storage::atomic::write(path, &packing::video(frame)).map_err(PictureError::from)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame(depth: u32, phase: CfaPhase) -> RawFrame {
        let values = Array2::from_shape_fn((4, 6), |(r, c)| ((r * 6 + c) * ((1 << depth) - 1) / 23) as u16);
        RawFrame::from_values(values, depth, phase).unwrap()
    }

    /// A file in a folder of its own, and what loading it gives.
    fn loaded(name: &str, content: &[u8], options: RawOptions) -> Result<RawFrame, String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(name);
        std::fs::write(&path, content).unwrap();
        load(&path, &options).map_err(|e| e.to_string().replace(&format!("{}/", dir.path().display()), ""))
    }

    const GREY: &[u8] = b"P2 2 2 65535 16 32 48 64";

    #[test]
    fn a_saved_frame_needs_no_option_but_its_phase() {
        let dir = tempfile::tempdir().unwrap();
        for (phase, depth) in CfaPhase::ALL.into_iter().zip([8, 10, 12, 16]) {
            for ending in ["png", "tif", "tiff", "pgm"] {
                let path = dir.path().join(format!("frame.{ending}"));
                save(&path, &frame(depth, phase)).unwrap();
                let back = load(&path, &RawOptions { phase, ..RawOptions::default() }).unwrap();
                assert_eq!((back.pixels(), back.phase()), (frame(depth, phase).pixels(), phase), "{ending}");
            }
        }
    }

    #[test]
    fn a_headerless_file_is_read_in_both_byte_orders() {
        let options =
            RawOptions { depth: Some(12), size: Some(Size { width: 2, height: 2 }), ..RawOptions::default() };
        let little = loaded("x.raw", &[1, 2, 3, 4, 5, 6, 7, 8], options).unwrap();
        let big = loaded("x.raw", &[2, 1, 4, 3, 6, 5, 8, 7], RawOptions { order: ByteOrder::Big, ..options })
            .unwrap();
        assert_eq!(little.values()[(0, 1)], 0x0403);
        assert_eq!(little, big);
    }

    #[test]
    fn packed_pixels_have_their_own_bits() {
        let size = Some(Size { width: 2, height: 2 });
        let options = |packing, depth| RawOptions { packing, depth, size, ..RawOptions::default() };
        let packed = loaded("x.raw", &[0xab, 0x12, 0x3c, 0, 1, 0], options(Packing::Mipi12, None)).unwrap();
        assert_eq!((packed.depth(), packed.values()[(0, 0)], packed.values()[(0, 1)]), (12, 0xabc, 0x123));
        let bytes = loaded("x.raw", &[7, 8, 9, 255], options(Packing::Bytes, Some(8))).unwrap();
        assert_eq!((bytes.depth(), bytes.values()[(1, 1)]), (8, 255));
        assert_eq!(
            loaded("x.raw", &[0; 4], options(Packing::Bytes, Some(10))).unwrap_err(),
            "x.raw: holds 8-bit samples, expected 10 bits as stated"
        );
        assert_eq!(
            loaded("x.raw", &[0; 6], options(Packing::Words, Some(12))).unwrap_err(),
            "x.raw: 6 bytes, expected 8 for 2x2; as many as packed as mipi12 or 12p or 12packed"
        );
        // What begins as a picture does may be pixels.
        assert!(loaded("x.raw", b"P5 0", options(Packing::Bytes, None)).is_ok());
    }

    #[test]
    fn values_at_the_bottom_of_a_png_are_read_where_stated() {
        let options = RawOptions { depth: Some(12), ..RawOptions::default() };
        let at_top = loaded("x", GREY, options).unwrap();
        let at_bottom =
            loaded("x", GREY, RawOptions { alignment: Some(Alignment::Bottom), ..options }).unwrap();
        assert_eq!((at_top.values()[(0, 1)], at_bottom.values()[(0, 1)]), (2, 32));
    }

    #[test]
    fn a_colour_picture_is_no_raw_frame() {
        let error = loaded("x.ppm", b"P3 1 1 65535 1 2 3", RawOptions::default()).unwrap_err();
        assert_eq!(error, "x.ppm: holds a colour picture, expected one raw value a pixel");
    }

    #[test]
    fn eight_bit_samples_are_refused_unless_stated() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("x.png");
        let planes = ndarray::Array3::from_elem((1, 2, 2), 7);
        picture::save(&path, &Samples { planes, full_scale: 255 }).unwrap();
        let error = load(&path, &RawOptions::default()).unwrap_err().to_string();
        assert!(
            error.ends_with("x.png: holds 8-bit samples, expected 16-bit ones (or a stated depth of 8)"),
            "{error}"
        );
        assert!(load(&path, &RawOptions { depth: Some(8), ..RawOptions::default() }).is_ok());
    }

    #[test]
    fn a_depth_that_the_file_contradicts_is_refused() {
        let stated = |depth| RawOptions { depth: Some(depth), ..RawOptions::default() };
        assert_eq!(
            loaded("x.pgm", b"P2 2 2 4095 1 2 3 4", stated(10)).unwrap_err(),
            "x.pgm: holds 12-bit samples, expected 10 bits as stated"
        );
        assert_eq!(
            loaded("x.pgm", b"P2 2 2 65535 16 33 0 0", stated(12)).unwrap_err(),
            "x.pgm: pixel at row 0, column 1 is 33, no 12-bit code aligned to the top of 16 bits"
        );
        assert_eq!(
            loaded("x.pgm", GREY, RawOptions { alignment: Some(Alignment::Bottom), ..stated(8) })
                .map(|f| f.depth()),
            Ok(8)
        );
        assert_eq!(loaded("x.pgm", GREY, stated(7)).unwrap_err(), "x.pgm: bit depth 7: must be 8 to 16");
    }

    #[test]
    fn a_value_wider_than_the_depth_is_refused() {
        let size = Some(Size { width: 2, height: 2 });
        let options = RawOptions { depth: Some(10), size, ..RawOptions::default() };
        assert_eq!(
            loaded("x.raw", &[0, 0, 0, 4, 0, 0, 0, 0], options).unwrap_err(),
            "x.raw: pixel at row 0, column 1 is 1024, more than 10 bits can hold"
        );
    }

    #[test]
    fn odd_sides_are_refused() {
        let error = loaded("x.pgm", b"P2 3 2 65535 1 2 3 4 5 6", RawOptions::default()).unwrap_err();
        assert_eq!(
            error,
            "x.pgm: frame 3x2: both sides must be even, so that it holds whole 2x2 Bayer cells"
        );
    }

    #[test]
    fn a_headerless_device_is_read_no_farther_than_its_size() {
        let size = Some("4x2".parse().unwrap());
        let error = load(Path::new("/dev/zero"), &RawOptions { size, ..RawOptions::default() }).unwrap_err();
        assert_eq!(error.to_string(), "/dev/zero: more bytes, expected 16 for 4x2");
        let error = load(Path::new("/dev/zero"), &RawOptions::default()).unwrap_err();
        assert!(error.to_string().contains("state its size"), "{error}");
    }

    #[test]
    fn sizes_are_checked_against_the_file() {
        let size = Some("4x2".parse().unwrap());
        let options = RawOptions { size, ..RawOptions::default() };
        assert_eq!(loaded("x.raw", &[0; 15], options).unwrap_err(), "x.raw: 15 bytes, expected 16 for 4x2");
        assert_eq!(
            loaded("x.pgm", GREY, options).unwrap_err(),
            "x.pgm: 2x2 pixels, expected as many as stated for 4x2"
        );
        assert!(loaded("x.raw", &[0; 16], RawOptions::default()).unwrap_err().contains("state its size"));
    }

    #[test]
    fn text_that_is_no_size_is_refused() {
        for text in ["", "4", "4x", "0x4", "4x-1", "70000x2", "4 x 2"] {
            assert_eq!(text.parse::<Size>(), Err(WrongSize(text.to_owned())));
        }
    }

    #[test]
    fn an_unknown_ending_is_told_the_known_ones() {
        let error = save(Path::new("x.dng"), &frame(12, CfaPhase::Rggb)).unwrap_err().to_string();
        assert_eq!(error, "x.dng: unknown ending, expected .png, .tif, .tiff, .pgm, .raw or .bin");
    }

    proptest! {
        #[test]
        fn a_frame_of_any_depth_comes_back(
            depth in 8u32..=16, ending in prop::sample::select(vec!["png", "tif", "pgm", "raw"])
        ) {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join(format!("frame.{ending}"));
            let original = frame(depth, CfaPhase::Gbrg);
            save(&path, &original).unwrap();
            let size = Some(Size { width: 6, height: 4 });
            let options = RawOptions { phase: CfaPhase::Gbrg, depth: Some(depth), size, ..RawOptions::default() };
            prop_assert_eq!(load(&path, &options).unwrap(), original);
        }
    }
}
