//! Strips and tiles of a TIFF: their place, their compression, and the samples in their bytes.

use super::directory::Directory;
use super::{TiffError, tag};
use image::codecs::jpeg::JpegDecoder;
use image::{DynamicImage, ImageFormat};
use ndarray::{Array3, s};
use std::borrow::Cow;
use std::io::Cursor;

/// Most bytes of samples.
const MAX_BYTES: usize = 512 << 20;

/// Compressions that `image` unpacks by [`unpacked`]: LZW, Deflate (two numbers), PackBits.
const PACKED: [usize; 4] = [5, 8, 32946, 32773];
const JPEG: usize = 7;

/// Size, samples and chunks of a picture.
#[derive(Debug)]
pub struct Layout {
    pub width: usize,
    pub height: usize,
    pub bits: usize,
    /// Samples per pixel.
    pub samples: usize,
    /// Whether each sample has chunks of its own.
    is_planar: bool,
    compression: usize,
    has_predictor: bool,
    /// Whether the first pixel is in a byte's least significant bits.
    is_reversed: bool,
    /// Columns and rows of a strip or tile.
    chunk: (usize, usize),
    offsets: Vec<usize>,
    lengths: Vec<usize>,
}

impl Layout {
    pub fn of(directory: &Directory) -> Result<Self, TiffError> {
        let or = |tag, default| directory.whole(tag).unwrap_or(default);
        let required = |tag| directory.whole(tag).filter(|n| *n > 0).ok_or("it states no size");
        let (width, height) = (required(tag::WIDTH)?, required(tag::HEIGHT)?);
        let samples = or(tag::SAMPLES, 1);
        let bits = bits(directory)?;
        check_format(directory, bits)?;
        let bytes = if bits > 8 { 2 } else { 1 };
        let needed = width.checked_mul(height).and_then(|n| n.checked_mul(samples.max(1) * bytes));
        if needed.is_none_or(|needed| needed > MAX_BYTES) {
            return Err(TiffError::Large(width, height));
        }
        let is_tiled = directory.has(tag::TILE_OFFSETS);
        let chunk = if is_tiled {
            (required(tag::TILE_WIDTH)?, required(tag::TILE_HEIGHT)?)
        } else {
            (width, or(tag::STRIP_ROWS, height).clamp(1, height))
        };
        let (offsets, lengths) = if is_tiled {
            (tag::TILE_OFFSETS, tag::TILE_BYTES)
        } else {
            (tag::STRIP_OFFSETS, tag::STRIP_BYTES)
        };
        let offsets = directory.wholes(offsets).ok_or("it does not state where its pixels are")?;
        // Some writers of a single strip omit its length.
        let rest = || offsets.iter().map(|at| directory.file().bytes().len().saturating_sub(*at)).collect();
        let layout = Self {
            width,
            height,
            bits,
            samples,
            is_planar: samples > 1 && or(tag::PLANES, 1) == 2,
            compression: or(tag::COMPRESSION, 1),
            has_predictor: or(tag::PREDICTOR, 1) == 2,
            is_reversed: or(tag::FILL_ORDER, 1) == 2,
            chunk,
            lengths: directory.wholes(lengths).unwrap_or_else(rest),
            offsets,
        };
        layout.check()?;
        Ok(layout)
    }

    fn check(&self) -> Result<(), TiffError> {
        let Self { bits, compression, .. } = *self;
        if compression == JPEG && (bits != 8 || self.is_planar) {
            return Err(TiffError::Unread("JPEG compression of other than 8-bit interleaved samples".into()));
        }
        if compression != 1 && compression != JPEG && !PACKED.contains(&compression) {
            return Err(TiffError::Unread(compression_in_words(compression)));
        }
        if self.has_predictor && bits != 8 && bits != 16 {
            return Err(TiffError::Unread(format!("differences (predictor 2) of {bits}-bit samples")));
        }
        // A tile is not much larger than a picture, and at least one sample is in it.
        let (columns, rows) = self.chunk;
        let bytes = columns.checked_mul(rows).and_then(|n| n.checked_mul(2 * self.samples.max(1)));
        if bytes.is_none_or(|bytes| bytes > MAX_BYTES) {
            return Err(TiffError::Large(columns, rows));
        }
        let count = self.across() * self.down() * if self.is_planar { self.samples } else { 1 };
        if self.samples == 0 || self.offsets.len() < count || self.lengths.len() < count {
            return Err("it has fewer strips or tiles than its size needs".into());
        }
        Ok(())
    }

    pub const fn is_jpeg(&self) -> bool {
        self.compression == JPEG
    }

    /// Returns the largest value of a sample.
    pub const fn full_scale(&self) -> u16 {
        u16::MAX >> (16 - self.bits)
    }

    const fn across(&self) -> usize {
        self.width.div_ceil(self.chunk.0)
    }

    const fn down(&self) -> usize {
        self.height.div_ceil(self.chunk.1)
    }

    /// Decodes the first `kept` samples of each pixel.
    pub fn planes(&self, directory: &Directory, kept: usize) -> Result<Array3<u16>, TiffError> {
        let mut planes = Array3::zeros((kept, self.height, self.width));
        let (first_planes, each) = if self.is_planar { (kept, 1) } else { (1, self.samples) };
        for plane in 0..first_planes {
            for down in 0..self.down() {
                for across in 0..self.across() {
                    let index = (plane * self.down() + down) * self.across() + across;
                    let (top, left) = (down * self.chunk.1, across * self.chunk.0);
                    let rows = self.chunk.1.min(self.height - top);
                    let columns = self.chunk.0.min(self.width - left);
                    let chunk = self.chunk_bytes(directory, index, rows, each)?;
                    let row_bytes = self.row_bytes(each);
                    for (row, bytes) in chunk.chunks_exact(row_bytes).take(rows).enumerate() {
                        let values = self.row(bytes, directory.file().is_big_endian(), each);
                        for sample in 0..kept.min(each) {
                            let place = s![plane + sample, top + row, left..left + columns];
                            let pixels = values.chunks_exact(each);
                            planes.slice_mut(place).iter_mut().zip(pixels).for_each(|(v, p)| *v = p[sample]);
                        }
                    }
                }
            }
        }
        Ok(planes)
    }

    const fn row_bytes(&self, samples: usize) -> usize {
        (self.chunk.0 * samples * self.bits).div_ceil(8)
    }

    /// Unpacked bytes of the rows of a chunk that are in the picture.
    fn chunk_bytes<'a>(
        &self,
        directory: &Directory<'a>,
        index: usize,
        rows: usize,
        samples: usize,
    ) -> Result<Cow<'a, [u8]>, TiffError> {
        let cut_off = || TiffError::Damaged(format!("strip or tile {index} is cut off"));
        let (at, row_bytes) = (self.offsets[index], self.row_bytes(samples));
        let packed = directory.file().part(at as u64, self.lengths[index] as u64).ok_or_else(cut_off)?;
        let packed = if self.is_reversed {
            Cow::Owned(packed.iter().map(|byte| byte.reverse_bits()).collect())
        } else {
            Cow::Borrowed(packed)
        };
        let bytes = match self.compression {
            1 => packed,
            JPEG => Cow::Owned(jpeg(
                &packed,
                directory.bytes(tag::JPEG_TABLES).ok().flatten(),
                self.chunk.0,
                samples,
            )?),
            compression => Cow::Owned(unpacked(&packed, compression, row_bytes, rows)?),
        };
        if bytes.len() < row_bytes * rows { Err(cut_off()) } else { Ok(bytes) }
    }

    /// Samples of a row of a chunk.
    fn row(&self, bytes: &[u8], is_big_endian: bool, samples: usize) -> Vec<u16> {
        let mut values: Vec<u16> = match (self.bits, is_big_endian) {
            (8, _) => bytes.iter().map(|byte| u16::from(*byte)).collect(),
            (16, true) => bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect(),
            (16, false) => bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect(),
            (bits, _) => {
                (0..self.chunk.0 * samples).map(|index| bits_at(bytes, index * bits, bits)).collect()
            }
        };
        if self.has_predictor {
            for at in samples..values.len() {
                values[at] = values[at].wrapping_add(values[at - samples]) & self.full_scale();
            }
        }
        values
    }
}

/// Number of at most 16 bits from a bit on, most significant first.
fn bits_at(bytes: &[u8], from: usize, count: usize) -> u16 {
    let byte = |index: usize| u32::from(bytes.get(from / 8 + index).copied().unwrap_or(0));
    let window = byte(0) << 16 | byte(1) << 8 | byte(2);
    (window >> (24 - from % 8 - count) & ((1 << count) - 1)) as u16
}

/// Bits per sample, equal in all samples.
fn bits(directory: &Directory) -> Result<usize, TiffError> {
    let all = directory.wholes(tag::BITS).unwrap_or_else(|| vec![1]);
    match all[..] {
        [bits, ..] if all.iter().all(|other| *other == bits) && bits > 0 => Ok(bits),
        _ => Err(TiffError::Unread(format!("samples of different bits ({all:?})"))),
    }
}

/// Rejects samples that are not unsigned integers of at most 16 bits.
fn check_format(directory: &Directory, bits: usize) -> Result<(), TiffError> {
    let formats = directory.wholes(tag::FORMAT).unwrap_or_default();
    let kind = match formats.iter().find(|format| **format != 1 && **format != 4) {
        None if bits <= 16 => return Ok(()),
        None => "",
        Some(2) => " signed",
        Some(3) => " floating-point",
        Some(_) => " complex",
    };
    Err(TiffError::Samples(format!("{bits}-bit{kind}")))
}

fn compression_in_words(number: usize) -> String {
    let name = match number {
        2..=4 => "fax",
        6 => "old JPEG",
        34712 => "JPEG 2000",
        34887 => "LERC",
        34925 => "LZMA",
        50000 => "Zstandard",
        50001 => "WebP",
        34892 => "lossy JPEG",
        50002 | 52546 => "JPEG XL",
        other => return format!("compression {other}"),
    };
    format!("{name} compression ({number})")
}

/// Bytes of a chunk that was packed. The decoder of `image` reads it as the only strip of a grey picture: this decoder fails on
/// tiles that reach beyond a picture, and knows no 12-bit samples.
fn unpacked(packed: &[u8], compression: usize, row_bytes: usize, rows: usize) -> Result<Vec<u8>, TiffError> {
    let long = |value: usize| u32::try_from(value).map_err(|_| TiffError::Large(row_bytes, rows));
    let entries = [
        (tag::WIDTH, long(row_bytes)?),
        (tag::HEIGHT, long(rows)?),
        (tag::BITS, 8),
        (tag::COMPRESSION, long(compression)?),
        (tag::INTERPRETATION, 1),
        (tag::STRIP_OFFSETS, 8 + 2 + 12 * 9 + 4),
        (tag::SAMPLES, 1),
        (tag::STRIP_ROWS, long(rows)?),
        (tag::STRIP_BYTES, long(packed.len())?),
    ];
    let mut file = b"II*\0\x08\0\0\0\x09\0".to_vec();
    for (tag, value) in entries {
        file.extend(tag.to_le_bytes());
        file.extend(4u16.to_le_bytes());
        file.extend(1u32.to_le_bytes());
        file.extend(value.to_le_bytes());
    }
    file.extend([0; 4]);
    file.extend(packed);
    match image::load_from_memory_with_format(&file, ImageFormat::Tiff) {
        Ok(DynamicImage::ImageLuma8(image)) => Ok(image.into_raw()),
        Ok(_) => Err("a strip or tile is of another kind than the file".into()),
        Err(error) => Err(TiffError::Damaged(error.to_string())),
    }
}

/// Interleaved samples of a chunk that is a JPEG, with the tables that all chunks share.
fn jpeg(packed: &[u8], tables: Option<&[u8]>, columns: usize, samples: usize) -> Result<Vec<u8>, TiffError> {
    let whole = match tables {
        // Without the end of the tables and the start of the picture.
        Some([tables @ .., 0xff, 0xd9]) => [tables, packed.get(2..).unwrap_or_default()].concat(),
        _ => packed.to_vec(),
    };
    let image = JpegDecoder::new(Cursor::new(&whole)).and_then(DynamicImage::from_decoder);
    let image = image.map_err(|error| TiffError::Damaged(error.to_string()))?;
    if image.width() as usize != columns || usize::from(image.color().channel_count()) != samples {
        return Err(TiffError::Unread(
            "JPEG compression of another size or other colours than stated".into(),
        ));
    }
    Ok(image.into_bytes())
}
