//! Picture files: PNG, TIFF, PGM and PPM to samples and back; JPEG, WebP and BMP to samples.

use crate::orientation::{Orientation, turned};
use crate::png_chunks::chunks;
use crate::samples::Samples;
use crate::tiff::{Tiff, TiffError, directory};
use crate::transfer::Statement;
use crate::{camera_raw, pnm};
use edof_core::storage::input;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngEncoder;
use image::codecs::tiff::{TiffDecoder, TiffEncoder};
use image::codecs::webp::WebPDecoder;
use image::{
    ColorType, DynamicImage, ImageDecoder, ImageEncoder, ImageError, ImageFormat, ImageReader, ImageResult,
    Limits,
};
use ndarray::{Array3, ShapeError};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// A picture that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PictureError {
    /// The file cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// None of the formats.
    #[error("{path}: not a PNG, JPEG, WebP, TIFF, BMP, PPM or PGM file", path = path.display())]
    Format { path: PathBuf },
    /// Truncated or damaged.
    #[error("{path}: damaged or unsupported: {reason}", path = path.display())]
    Decode { path: PathBuf, reason: String },
    /// Floating-point samples and the like.
    #[error("{path}: holds {found} samples, expected 8-bit or 16-bit integers", path = path.display())]
    Kind { path: PathBuf, found: String },
    /// A valid TIFF of a kind that is not read.
    #[error("{path}: valid TIFF of a kind that is not read: {found}; save it uncompressed, with 8 or 16 bits per sample", path = path.display())]
    Unread { path: PathBuf, found: String },
    /// A TIFF with colours that are multiplied by their alpha.
    #[error("{path}: its colours are multiplied by a transparency that is not full everywhere (ExtraSamples 1), expected an opaque picture; save it without transparency", path = path.display())]
    Transparent { path: PathBuf },
    /// A TIFF of other inks than those of a four-colour print.
    #[error("{path}: its colours are inks other than cyan, magenta, yellow and black (InkSet 2), expected grey, RGB or CMYK; save it as RGB", path = path.display())]
    Inks { path: PathBuf },
    /// A camera's raw frame where a picture is expected.
    #[error("{path}: contains a camera's raw frame (DNG or TIFF of a camera), expected a picture; develop it first, as by 'edof reconstruct'", path = path.display())]
    CameraRaw { path: PathBuf },
    /// A TIFF that begins with a preview.
    #[error("{path}: begins with a thumbnail (NewSubfileType 1), expected the picture first; save the picture alone", path = path.display())]
    Thumbnail { path: PathBuf },
    /// A name whose ending stands for no format.
    #[error("{path}: unknown ending, expected {expected}", path = path.display())]
    Ending { path: PathBuf, expected: String },
    /// The encoder failed.
    #[error("{path}: cannot encode {width}x{height} pixels: {reason}", path = path.display())]
    Encode { path: PathBuf, width: usize, height: usize, reason: String },
    /// The disk failed.
    #[error(transparent)]
    Write(#[from] edof_core::storage::atomic::WriteError),
}

/// A picture format, identified by a file's first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Portable network graphics.
    Png,
    /// Tagged image file format.
    Tiff,
    /// PGM or PPM, as text or binary.
    Pnm,
    /// JPEG: read only, for what it keeps are not the values that it was given.
    Jpeg,
    /// WebP: read only.
    WebP,
    /// Windows bitmap: read only.
    Bmp,
}

impl Format {
    /// What the first bytes of a file stand for.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Some(Self::Tiff),
            [b'P', b'2' | b'3' | b'5' | b'6', space, ..] if space.is_ascii_whitespace() => Some(Self::Pnm),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => Some(Self::Bmp),
            _ => None,
        }
    }

    /// What the ending of a name stands for.
    #[must_use]
    pub fn of_ending(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "tif" | "tiff" => Some(Self::Tiff),
            "ppm" | "pgm" | "pnm" => Some(Self::Pnm),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            "webp" => Some(Self::WebP),
            "bmp" => Some(Self::Bmp),
            _ => None,
        }
    }

    /// Whether we write it and it gives back what it was given: the formats of raw frames and results.
    #[must_use]
    pub const fn keeps_values(self) -> bool {
        matches!(self, Self::Png | Self::Tiff | Self::Pnm)
    }
}

/// Bytes that identify a format.
const HEAD: u64 = 12;

/// The bytes of a picture file. What begins like none is not read on.
///
/// # Errors
/// [`PictureError::Read`] or [`PictureError::Format`].
pub fn read(path: &Path) -> Result<Vec<u8>, PictureError> {
    let (mut file, mut bytes) = open(path)?;
    if Format::of(&bytes).is_none() {
        return Err(PictureError::Format { path: path.to_owned() });
    }
    file.read_to_end(&mut bytes).map_err(|source| PictureError::Read { path: path.to_owned(), source })?;
    Ok(bytes)
}

/// A file and its first bytes, which tell its format and are read already.
///
/// # Errors
/// [`PictureError::Read`].
pub fn open(path: &Path) -> Result<(File, Vec<u8>), PictureError> {
    let head = || {
        let mut file = input::open(path)?;
        let mut head = vec![];
        file.by_ref().take(HEAD).read_to_end(&mut head)?;
        Ok((file, head))
    };
    head().map_err(|source| PictureError::Read { path: path.to_owned(), source })
}

/// Pictures of a folder by their endings, in the order of their names.
///
/// # Errors
/// What the system says of a folder that cannot be listed.
pub fn of_folder(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    if folder.is_file() {
        return Err(std::io::Error::other("is a file, expected a folder of pictures"));
    }
    let mut files = std::fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<_>, std::io::Error>>()?;
    files.retain(|file| Format::of_ending(file).is_some());
    files.sort();
    Ok(files)
}

/// Rejects what is no regular file, such as a named pipe in a folder of photographs.
///
/// # Errors
/// [`PictureError::Read`].
pub fn check_found(path: &Path) -> Result<(), PictureError> {
    input::check(path).map_err(|source| PictureError::Read { path: path.to_owned(), source })
}

/// Decodes the samples of a picture file in memory. Those of PNG and TIFF stay in their rows and columns, because a mosaic
/// must; JPEG and WebP are turned as their camera was held. `path` names the file in errors.
///
/// # Errors
/// [`PictureError::Format`], [`PictureError::Decode`], [`PictureError::Kind`] or [`PictureError::Unread`].
pub fn decode(bytes: &[u8], path: &Path) -> Result<Samples, PictureError> {
    let Decoded { planes, full_scale, orientation } = decoded(bytes, path, |sample, _| sample)?;
    let keeps_rows = Format::of(bytes).is_some_and(Format::keeps_values);
    Ok(Samples { planes: if keeps_rows { planes } else { turned(planes, orientation) }, full_scale })
}

/// Decodes a photograph, turned as its camera was held, with `of(sample, full scale)` in place of each sample. Returns the full scale,
/// too.
///
/// # Errors
/// As [`decode`]; also [`PictureError::CameraRaw`] or [`PictureError::Thumbnail`].
pub fn decode_photograph<T: Clone>(
    bytes: &[u8],
    path: &Path,
    of: impl Fn(u16, u16) -> T,
) -> Result<(Array3<T>, u16), PictureError> {
    check_photograph(bytes, path)?;
    let Decoded { planes, full_scale, orientation } = decoded(bytes, path, of)?;
    Ok((turned(planes, orientation), full_scale))
}

/// Decodes the integers of a photograph as they are stored, turned as [`decode_photograph`] does. Decoders spread those of a grey PNG of
/// fewer than 8 bits over 8, and invert those of a TIFF whose 0 is white.
///
/// # Errors
/// As [`decode_photograph`].
pub fn decode_integers(bytes: &[u8], path: &Path) -> Result<Array3<u16>, PictureError> {
    let (planes, full_scale) = decode_photograph(bytes, path, |sample, _| sample)?;
    Ok(match (Format::of(bytes), bytes.get(24..26)) {
        (Some(Format::Png), Some(&[bits @ 1..8, 0])) => {
            let step = 255 / ((1 << bits) - 1);
            planes.mapv_into(|v| v / step)
        }
        (Some(Format::Tiff), _) if Tiff::open(bytes).is_ok_and(|tiff| tiff.is_inverse()) => {
            planes.mapv_into(|v| full_scale - v)
        }
        _ => planes,
    })
}

/// Rejects a TIFF of a camera's raw frame.
fn check_photograph(bytes: &[u8], path: &Path) -> Result<(), PictureError> {
    let Some(Ok(tiff)) = (Format::of(bytes) == Some(Format::Tiff)).then(|| Tiff::open(bytes)) else {
        return Ok(());
    };
    if camera_raw::is_name(path) || tiff.is_camera_raw() {
        return Err(PictureError::CameraRaw { path: path.to_owned() });
    }
    Ok(())
}

/// Returns whether a file has further pictures of the first one's kind, which is the one that is read: pages of a TIFF, a stream of PGM, an
/// animation, or the pictures of a multi-picture JPEG (CIPA DC-007).
#[must_use]
pub fn is_first_of_several(bytes: &[u8]) -> bool {
    match Format::of(bytes) {
        Some(Format::Tiff) => Tiff::open(bytes).is_ok_and(|tiff| tiff.is_stack()),
        Some(Format::Pnm) => pnm::is_first_of_several(bytes),
        Some(Format::Png) => chunks(bytes).any(|(name, content)| {
            name == b"acTL" && content.first_chunk().is_some_and(|count| u32::from_be_bytes(*count) > 1)
        }),
        // A flag of the extended header.
        Some(Format::WebP) => {
            bytes.get(12..16) == Some(b"VP8X") && bytes.get(20).is_some_and(|flags| flags & 2 == 2)
        }
        Some(Format::Jpeg) => pictures_of_jpeg(bytes).is_some_and(|count| count > 1),
        Some(Format::Bmp) | None => false,
    }
}

/// The number of pictures in the index of a multi-picture JPEG, which is a TIFF's directory.
fn pictures_of_jpeg(jpeg: &[u8]) -> Option<usize> {
    const NUMBER_OF_IMAGES: u16 = 0xb001;
    const START_OF_SCAN: u8 = 0xda;
    let mut rest = jpeg.get(2..)?;
    loop {
        let &[0xff, marker, high, low, ..] = rest else { return None };
        if marker == START_OF_SCAN {
            return None;
        }
        let length = usize::from(high) << 8 | usize::from(low);
        let content = rest.get(4..2 + length)?;
        if let Some(index) = content.strip_prefix(b"MPF\0").filter(|_| marker == 0xe2) {
            return directory::File::new(index)?.first()?.whole(NUMBER_OF_IMAGES);
        }
        rest = &rest[2 + length..];
    }
}

/// A picture in the rows and columns of its file.
struct Decoded<T> {
    planes: Array3<T>,
    full_scale: u16,
    orientation: Orientation,
}

fn decoded<T>(bytes: &[u8], path: &Path, of: impl Fn(u16, u16) -> T) -> Result<Decoded<T>, PictureError> {
    let damaged = |reason: String| PictureError::Decode { path: path.to_owned(), reason };
    let of_samples = |Samples { planes, full_scale }: Samples, orientation| Decoded {
        planes: planes.map(|sample| of(*sample, full_scale)),
        full_scale,
        orientation,
    };
    let by_image = |format| image(bytes, format).map_err(|e| damaged(reason(bytes, format, &e)));
    let (image, orientation) = match Format::of(bytes) {
        Some(Format::Pnm) => {
            let samples = pnm::decode(bytes).map_err(|e| damaged(e.to_string()))?;
            return Ok(of_samples(samples, Orientation::NoTransforms));
        }
        Some(Format::Tiff) => match tiff(bytes) {
            Ok((samples, orientation)) => return Ok(of_samples(samples, orientation)),
            // Such as JPEG of red, green and blue.
            Err(error @ TiffError::Unread(_)) => {
                image(bytes, ImageFormat::Tiff).map_err(|_| of_tiff(error, path))?
            }
            Err(error) => return Err(of_tiff(error, path)),
        },
        Some(Format::Png) => by_image(ImageFormat::Png)?,
        Some(Format::Jpeg) => by_image(ImageFormat::Jpeg)?,
        Some(Format::WebP) => by_image(ImageFormat::WebP)?,
        Some(Format::Bmp) => by_image(ImageFormat::Bmp)?,
        None => return Err(PictureError::Format { path: path.to_owned() }),
    };
    let size = (image.height() as usize, image.width() as usize);
    let (narrow, wide) = (|sample| of(sample, 255), |sample| of(sample, u16::MAX));
    let (planes, full_scale) = match &image {
        DynamicImage::ImageLuma8(i) => (planes(i, size, 1, narrow), 255),
        DynamicImage::ImageLumaA8(i) => (planes(i, size, 2, narrow), 255),
        DynamicImage::ImageRgb8(i) => (planes(i, size, 3, narrow), 255),
        DynamicImage::ImageRgba8(i) => (planes(i, size, 4, narrow), 255),
        DynamicImage::ImageLuma16(i) => (planes(i, size, 1, wide), u16::MAX),
        DynamicImage::ImageLumaA16(i) => (planes(i, size, 2, wide), u16::MAX),
        DynamicImage::ImageRgb16(i) => (planes(i, size, 3, wide), u16::MAX),
        DynamicImage::ImageRgba16(i) => (planes(i, size, 4, wide), u16::MAX),
        other => {
            let found = kind(other.color());
            return Err(PictureError::Kind { path: path.to_owned(), found });
        }
    };
    let planes = planes.map_err(|e| damaged(e.to_string()))?;
    Ok(Decoded { planes, full_scale, orientation })
}

/// By the reader that knows padded tiles and packed samples.
fn tiff(bytes: &[u8]) -> Result<(Samples, Orientation), TiffError> {
    let tiff = Tiff::open(bytes)?;
    if tiff.is_thumbnail() {
        return Err(TiffError::Thumbnail);
    }
    let orientation = Orientation::from_exif(tiff.orientation()).unwrap_or(Orientation::NoTransforms);
    Ok((tiff.samples()?, orientation))
}

fn of_tiff(error: TiffError, path: &Path) -> PictureError {
    let path = path.to_owned();
    match error {
        TiffError::Damaged(reason) => PictureError::Decode { path, reason },
        TiffError::Large(width, height) => PictureError::Decode { path, reason: too_large(width, height) },
        TiffError::Samples(found) => PictureError::Kind { path, found },
        TiffError::Unread(found) => PictureError::Unread { path, found },
        TiffError::Inks => PictureError::Inks { path },
        TiffError::Thumbnail => PictureError::Thumbnail { path },
        TiffError::Transparent => PictureError::Transparent { path },
    }
}

/// What samples of other kinds are.
fn kind(colour: ColorType) -> String {
    match colour {
        ColorType::Rgb32F | ColorType::Rgba32F => "32-bit floating-point".to_owned(),
        other => format!("{}-bit", other.bits_per_pixel() / u16::from(other.channel_count().max(1))),
    }
}

/// Grey, or red, green and blue, of pixels of N channels, each sample as `of` has it.
fn planes<S: Copy + Into<u16>, T>(
    pixels: &[S],
    (height, width): (usize, usize),
    channels: usize,
    of: impl Fn(u16) -> T,
) -> Result<Array3<T>, ShapeError> {
    let colours = if channels < 3 { 1 } else { 3 };
    let mut samples = Vec::with_capacity(colours * height * width);
    for colour in 0..colours {
        samples.extend(pixels.chunks_exact(channels).map(|pixel| of(pixel[colour].into())));
    }
    Array3::from_shape_vec((colours, height, width), samples)
}

/// Why a picture could not be decoded; of one that is too large its size.
fn reason(bytes: &[u8], format: ImageFormat, error: &ImageError) -> String {
    let size = ImageReader::with_format(Cursor::new(bytes), format).into_dimensions();
    match (error, size) {
        (ImageError::Limits(_), Ok((width, height))) => too_large(width as usize, height as usize),
        (error, _) => plain(&error.to_string()),
    }
}

fn too_large(width: usize, height: usize) -> String {
    format!("{width}x{height} pixels, more than the 512 MiB of samples that are read; cut or shrink it")
}

/// A decoder's words without the names that Rust has for its values.
fn plain(text: &str) -> String {
    if text.contains("ChunkType {") {
        return "its chunks are not those of a PNG".to_owned();
    }
    text.to_owned()
}

/// By the decoders that are compiled in their own crate, where there are any: generic ones would all be compiled here again.
fn image(bytes: &[u8], format: ImageFormat) -> ImageResult<(DynamicImage, Orientation)> {
    match format {
        ImageFormat::Jpeg => limited(JpegDecoder::new(Cursor::new(bytes))?),
        ImageFormat::WebP => limited(WebPDecoder::new(Cursor::new(bytes))?),
        ImageFormat::Tiff => limited(TiffDecoder::new(Cursor::new(bytes))?),
        _ => {
            let image = image::load_from_memory_with_format(bytes, format)?;
            Ok((image, if format == ImageFormat::Png { of_png(bytes) } else { Orientation::NoTransforms }))
        }
    }
}

/// Orientation in a PNG's Exif, which may be behind its pixels.
fn of_png(bytes: &[u8]) -> Orientation {
    let exif = chunks(bytes).find(|(name, _)| name == b"eXIf");
    exif.and_then(|(_, exif)| Orientation::from_exif_chunk(exif)).unwrap_or(Orientation::NoTransforms)
}

/// A picture of at most the usual size, and how its camera was held.
fn limited(mut decoder: impl ImageDecoder) -> ImageResult<(DynamicImage, Orientation)> {
    let mut limits = Limits::default();
    limits.reserve(decoder.total_bytes())?;
    decoder.set_limits(limits)?;
    let orientation = decoder.orientation()?;
    Ok((DynamicImage::from_decoder(decoder)?, orientation))
}

/// The format in which [`save`] would write a file of that name; for anybody who has long work to do first.
///
/// # Errors
/// [`PictureError::Ending`].
pub fn format_of(path: &Path) -> Result<Format, PictureError> {
    let format = Format::of_ending(path).filter(|format| format.keeps_values());
    let expected = || ".png, .tif, .tiff, .ppm or .pgm".to_owned();
    format.ok_or_else(|| PictureError::Ending { path: path.to_owned(), expected: expected() })
}

/// Writes samples in the format that the ending of `path` stands for. PNG and TIFF hold a full scale of 255 or 65535.
///
/// # Errors
/// [`PictureError::Ending`], [`PictureError::Encode`] or [`PictureError::Write`].
pub fn save(path: &Path, samples: &Samples) -> Result<(), PictureError> {
    Ok(edof_core::storage::atomic::write(path, &encode(samples, format_of(path)?, path)?)?)
}

/// Returns samples as a file of a format; `path` names it in errors.
///
/// # Errors
/// [`PictureError::Encode`].
pub fn encode(samples: &Samples, format: Format, path: &Path) -> Result<Vec<u8>, PictureError> {
    encode_stated(samples, format, None, path)
}

/// Does so, and states a curve where the format can (PNG, TIFF).
pub(crate) fn encode_stated(
    samples: &Samples,
    format: Format,
    curve: Option<Statement>,
    path: &Path,
) -> Result<Vec<u8>, PictureError> {
    if format == Format::Pnm {
        return Ok(pnm::encode(samples));
    }
    let (_, height, width) = samples.planes.dim();
    let failed = |reason: String| PictureError::Encode { path: path.to_owned(), width, height, reason };
    picture(samples).and_then(|image| encoded(&image, format, curve)).map_err(failed)
}

/// As PNG, or else as TIFF.
fn encoded(image: &DynamicImage, format: Format, curve: Option<Statement>) -> Result<Vec<u8>, String> {
    let mut file = Cursor::new(Vec::new());
    let written = match format {
        Format::Png => image.write_with_encoder(PngEncoder::new(&mut file)),
        _ => {
            let mut encoder = TiffEncoder::new(&mut file);
            if let Some(curve) = curve {
                let profile = curve.profile().map_err(|e| e.to_string())?;
                encoder.set_icc_profile(profile).map_err(|e| e.to_string())?;
            }
            image.write_with_encoder(encoder)
        }
    };
    written.map_err(|e| e.to_string())?;
    let mut bytes = file.into_inner();
    if let (Format::Png, Some(curve)) = (format, curve) {
        curve.put(&mut bytes);
    }
    Ok(bytes)
}

fn picture(samples: &Samples) -> Result<DynamicImage, String> {
    let (channels, height, width) = samples.planes.dim();
    let side = |pixels: usize| u32::try_from(pixels).map_err(|e| e.to_string());
    let (columns, rows) = (side(width)?, side(height)?);
    let interleaved: Vec<u16> = samples.planes.view().permuted_axes([1, 2, 0]).iter().copied().collect();
    let narrow = || interleaved.iter().map(|&v| v.min(255) as u8).collect();
    let image = match (channels, samples.full_scale) {
        (1, 255) => image::GrayImage::from_raw(columns, rows, narrow()).map(DynamicImage::from),
        (3, 255) => image::RgbImage::from_raw(columns, rows, narrow()).map(DynamicImage::from),
        (1, u16::MAX) => {
            image::ImageBuffer::from_raw(columns, rows, interleaved).map(DynamicImage::ImageLuma16)
        }
        (3, u16::MAX) => {
            image::ImageBuffer::from_raw(columns, rows, interleaved).map(DynamicImage::ImageRgb16)
        }
        (planes, full_scale) => return Err(format!("{planes} planes of full scale {full_scale}")),
    };
    image.ok_or_else(|| "sizes do not match".to_owned())
}

#[cfg(test)]
mod tests;
