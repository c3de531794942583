//! A format of raw files as a value: how a file is recognised, its endings, how it is read and written.

use super::error::RawError;
use super::options::{Alignment, RawOptions, Size};
use super::source::Source;
use crate::dng::{Dng, Overrides};
use crate::picture::PictureError;
use edof_core::RawFrame;
use ndarray::Array2;
use std::path::Path;

/// A format of raw files.
#[derive(Debug)]
pub struct RawFormat {
    /// Name in lists of formats, as in "not a PNG, TIFF or PGM file".
    pub name: &'static str,
    /// Name of one file, as in "a PNG picture".
    pub noun: &'static str,
    /// Endings of its files in lower case, the usual one first.
    pub endings: &'static [&'static str],
    /// Judges a file by its first bytes; of a TIFF all bytes are given.
    pub recognise: fn(&[u8]) -> Recognised,
    /// How files are read.
    pub read: Read,
    /// How frames are written; `None` for a format that is only read.
    pub write: Option<Write>,
}

/// How surely a file is of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Recognised {
    /// It is not, or its content cannot show it.
    No,
    /// It has the container of several formats; its ending decides.
    Container,
    /// It is.
    Yes,
}

/// How a format is read.
#[derive(Debug)]
pub enum Read {
    /// Sensor values in a file that states its size. Options state phase, depth and levels.
    Values(fn(Source<'_>, &RawOptions) -> Result<Values, RawError>),
    /// Sensor values alone. Options also state size and packing.
    Headerless(fn(Source<'_>, Size, &RawOptions) -> Result<Values, RawError>),
    /// Linear light in a file that states everything.
    Light(fn(Source<'_>, &Overrides) -> Result<Dng, RawError>),
}

/// How a format is written.
#[derive(Debug)]
pub struct Write {
    /// Position of values of fewer than 16 bits.
    pub alignment: Alignment,
    /// What the help of a program states behind the ending.
    pub note: &'static str,
    /// Returns the bytes of a file; the path names it in errors.
    pub encode: fn(&RawFrame, &Path) -> Result<Vec<u8>, PictureError>,
}

/// Words of a file, and their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Rows × columns.
    pub words: Array2<u16>,
    /// Bits of a sensor value.
    pub depth: u32,
    /// Position of the values in the words, unless an option states another one.
    pub alignment: Alignment,
    /// What is to be said of them.
    pub notes: Vec<String>,
}

impl RawFormat {
    /// Returns whether a file has one of the format's endings.
    #[must_use]
    pub fn is_named(&self, path: &Path) -> bool {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        self.endings.iter().any(|own| ending.eq_ignore_ascii_case(own))
    }

    /// Returns whether files do not state their size.
    #[must_use]
    pub const fn is_headerless(&self) -> bool {
        matches!(self.read, Read::Headerless(_))
    }

    /// Returns whether files state phase, depth, levels and size, so that options for them have no effect.
    #[must_use]
    pub const fn states_everything(&self) -> bool {
        matches!(self.read, Read::Light(_))
    }
}
