//! TIFF and BigTIFF: the samples of a file's first picture.
//!
//! Grey, RGB, palette and CMYK pictures of 1 to 16 unsigned bits per sample are read. They are in strips or tiles, interleaved or in
//! planes, uncompressed or as LZW, Deflate, PackBits or JPEG. Any other kind is named for what it is. Tags are numbered as in
//! "TIFF Revision 6.0" (Adobe, 1992).

mod chunks;
pub mod directory;

use crate::samples::Samples;
use chunks::Layout;
use directory::{Directory, File};
use ndarray::{Array3, Axis, s};

/// Numbers of the tags.
mod tag {
    pub const SUBFILE: u16 = 254;
    pub const WIDTH: u16 = 256;
    pub const HEIGHT: u16 = 257;
    pub const BITS: u16 = 258;
    pub const COMPRESSION: u16 = 259;
    pub const INTERPRETATION: u16 = 262;
    pub const FILL_ORDER: u16 = 266;
    pub const STRIP_OFFSETS: u16 = 273;
    pub const ORIENTATION: u16 = 274;
    pub const SAMPLES: u16 = 277;
    pub const STRIP_ROWS: u16 = 278;
    pub const STRIP_BYTES: u16 = 279;
    pub const PLANES: u16 = 284;
    pub const TRANSFER_FUNCTION: u16 = 301;
    pub const PREDICTOR: u16 = 317;
    pub const COLOUR_MAP: u16 = 320;
    pub const TILE_WIDTH: u16 = 322;
    pub const TILE_HEIGHT: u16 = 323;
    pub const TILE_OFFSETS: u16 = 324;
    pub const TILE_BYTES: u16 = 325;
    pub const INK_SET: u16 = 332;
    pub const EXTRA_SAMPLES: u16 = 338;
    pub const FORMAT: u16 = 339;
    pub const JPEG_TABLES: u16 = 347;
    pub const ICC_PROFILE: u16 = 34675;
    pub const DNG_VERSION: u16 = 50706;
}

/// Photometric interpretations of a camera's mosaic, and of a linear DNG.
const RAW: [usize; 2] = [32803, 34892];

/// Bit of a page among several ones in [`tag::SUBFILE`]; others stand for smaller copies and masks.
const PAGE: usize = 2;

/// Reasons not to read a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TiffError {
    /// The file contradicts itself or ends too early.
    Damaged(String),
    /// More samples than are read.
    Large(usize, usize),
    /// Samples that are not unsigned integers of at most 16 bits.
    Samples(String),
    /// A valid file of another kind.
    Unread(String),
    /// Colours that are multiplied by their alpha, which is not full everywhere.
    Transparent,
    /// Inks other than those of CMYK.
    Inks,
    /// The first picture is a small copy of another one.
    Thumbnail,
}

impl From<&str> for TiffError {
    fn from(reason: &str) -> Self {
        Self::Damaged(reason.to_owned())
    }
}

/// A file in memory, its pixels not decoded yet.
#[derive(Debug)]
pub struct Tiff<'a> {
    directory: Directory<'a>,
}

/// How samples become grey or red, green and blue.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Colour {
    Grey,
    /// Grey of which 0 is white.
    Inverse,
    Rgb,
    /// Red, green and blue of each index, one after another.
    Palette(Vec<u16>),
    Cmyk,
    /// Luma and chroma; JPEG's decoder turns them to RGB.
    YCbCr,
}

impl Colour {
    const fn samples(&self) -> usize {
        match self {
            Self::Grey | Self::Inverse | Self::Palette(_) => 1,
            Self::Rgb | Self::YCbCr => 3,
            Self::Cmyk => 4,
        }
    }
}

impl<'a> Tiff<'a> {
    /// # Errors
    /// [`TiffError::Damaged`] for a file without a directory.
    pub fn open(bytes: &'a [u8]) -> Result<Self, TiffError> {
        let directory =
            File::new(bytes).and_then(File::first).ok_or("its directory is missing or cut off")?;
        Ok(Self { directory })
    }

    /// Returns the orientation of the picture, 1 to 8 as in Exif.
    pub fn orientation(&self) -> u8 {
        let stated = self.directory.whole(tag::ORIENTATION);
        stated.and_then(|n| u8::try_from(n).ok()).unwrap_or(1)
    }

    /// Returns whether the file is a DNG, or its first picture a mosaic.
    pub fn is_camera_raw(&self) -> bool {
        let interpretation = self.directory.whole(tag::INTERPRETATION);
        self.directory.has(tag::DNG_VERSION) || interpretation.is_some_and(|what| RAW.contains(&what))
    }

    /// Returns whether the first picture is grey whose 0 is white.
    pub fn is_inverse(&self) -> bool {
        self.directory.whole(tag::INTERPRETATION) == Some(0)
    }

    /// Returns the first curve from samples to light that the file states, 0 to 65535.
    pub fn transfer_function(&self) -> Option<Vec<usize>> {
        let mut curve = self.directory.wholes(tag::TRANSFER_FUNCTION)?;
        curve.truncate(1 << self.directory.whole(tag::BITS).filter(|bits| *bits <= 16)?);
        Some(curve)
    }

    /// Returns whether the first picture is a small copy of another one.
    pub fn is_thumbnail(&self) -> bool {
        self.directory.whole(tag::SUBFILE).is_some_and(|kind| kind & 1 == 1)
    }

    /// Returns whether the file has further pictures of the first one's size, as a stack of frames has.
    pub fn is_stack(&self) -> bool {
        let size = |one: &Directory| [tag::WIDTH, tag::HEIGHT].map(|side| one.whole(side));
        let is_page = |one: &&Directory| {
            one.whole(tag::SUBFILE).unwrap_or(0) & !PAGE == 0 && size(one) == size(&self.directory)
        };
        self.directory.file().directories().found.iter().filter(is_page).count() > 1
    }

    /// Returns the colour profile.
    pub fn icc_profile(&self) -> Option<&'a [u8]> {
        self.directory.bytes(tag::ICC_PROFILE).ok().flatten()
    }

    /// Decodes the first picture: rows and columns as stored, alpha dropped.
    ///
    /// # Errors
    /// [`TiffError`].
    pub fn samples(&self) -> Result<Samples, TiffError> {
        let layout = Layout::of(&self.directory)?;
        let colour = self.colour(&layout)?;
        if colour == Colour::YCbCr && !layout.is_jpeg() {
            return Err(TiffError::Unread("luma and chroma (YCbCr) without JPEG".to_owned()));
        }
        if colour == Colour::Rgb && layout.is_jpeg() {
            return Err(TiffError::Unread("JPEG compression of red, green and blue".to_owned()));
        }
        if colour.samples() > layout.samples {
            return Err("it has fewer samples per pixel than its colours need".into());
        }
        let mut planes = layout
            .planes(&self.directory, colour.samples() + usize::from(self.is_multiplied(&layout, &colour)))?;
        if planes.dim().0 > colour.samples() {
            let alpha = planes.index_axis(Axis(0), colour.samples());
            if alpha.iter().any(|alpha| *alpha != layout.full_scale()) {
                return Err(TiffError::Transparent);
            }
            planes.slice_collapse(s![..colour.samples(), .., ..]);
        }
        Ok(coloured(planes, &colour, layout.full_scale()))
    }

    /// Returns whether colours are followed by the alpha that they are multiplied by.
    fn is_multiplied(&self, layout: &Layout, colour: &Colour) -> bool {
        let kinds = self.directory.wholes(tag::EXTRA_SAMPLES).unwrap_or_default();
        kinds.first() == Some(&1) && colour.samples() < layout.samples
    }

    fn colour(&self, layout: &Layout) -> Result<Colour, TiffError> {
        let interpretation = self.directory.whole(tag::INTERPRETATION).ok_or("it states no colours")?;
        Ok(match interpretation {
            0 => Colour::Inverse,
            // A mosaic has one value per pixel, as grey.
            1 | 32803 => Colour::Grey,
            2 => Colour::Rgb,
            3 => Colour::Palette(self.palette(layout)?),
            5 if self.directory.whole(tag::INK_SET).unwrap_or(1) == 1 => Colour::Cmyk,
            5 => return Err(TiffError::Inks),
            6 => Colour::YCbCr,
            other => return Err(TiffError::Unread(interpretation_in_words(other))),
        })
    }

    fn palette(&self, layout: &Layout) -> Result<Vec<u16>, TiffError> {
        let map = self.directory.wholes(tag::COLOUR_MAP).ok_or("it has no colour map")?;
        if layout.bits > 8 {
            return Err(TiffError::Unread(format!("palette of {} bits", layout.bits)));
        }
        if map.len() != 3 << layout.bits {
            return Err("its colour map has another size than its samples".into());
        }
        // Some writers state 8-bit colours.
        let scale = if map.iter().all(|v| *v < 256) { 257 } else { 1 };
        Ok(map.into_iter().map(|v| (v * scale).min(usize::from(u16::MAX)) as u16).collect())
    }
}

fn interpretation_in_words(number: usize) -> String {
    match number {
        4 => "a transparency mask".to_owned(),
        8..=10 => "L*a*b* colours".to_owned(),
        32844 | 32845 => "LogLuv colours".to_owned(),
        34892 => "a camera's linear raw frame".to_owned(),
        other => format!("photometric interpretation {other}"),
    }
}

/// Grey, or red, green and blue.
fn coloured(mut planes: Array3<u16>, colour: &Colour, full_scale: u16) -> Samples {
    match colour {
        Colour::Grey | Colour::Rgb | Colour::YCbCr => {}
        Colour::Inverse => planes.mapv_inplace(|v| full_scale - v),
        Colour::Palette(map) => {
            let size = map.len() / 3;
            let indices = planes.index_axis(Axis(0), 0);
            let (height, width) = indices.dim();
            let of = |(c, y, x): (usize, usize, usize)| map[c * size + usize::from(indices[(y, x)])];
            return Samples { planes: Array3::from_shape_fn((3, height, width), of), full_scale: u16::MAX };
        }
        Colour::Cmyk => {
            let full = u32::from(full_scale);
            let black = planes.index_axis(Axis(0), 3).to_owned();
            let mut colours = planes.slice_mut(s![..3, .., ..]);
            for mut plane in colours.outer_iter_mut() {
                plane.zip_mut_with(&black, |ink, black| {
                    *ink = ((full - u32::from(*ink)) * (full - u32::from(*black)) / full) as u16;
                });
            }
            planes.slice_collapse(s![..3, .., ..]);
        }
    }
    Samples { planes, full_scale }
}

#[cfg(test)]
mod tests;
