//! What a raw file does not state about itself.

use crate::packing::{ByteOrder, Packing};
use edof_core::{CfaPhase, RawFrame};
use std::fmt;
use std::str::FromStr;

/// What a file cannot state about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RawOptions {
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of the sensor, 8…16; by default what the file states (a PGM's maximum), else 16.
    pub depth: Option<u32>,
    /// Size of a headerless file; other files must agree with it.
    pub size: Option<Size>,
    /// Position of values of fewer than 16 bits in a word; by default that of the format.
    pub alignment: Option<Alignment>,
    /// Order of the two bytes of a headerless file's words.
    pub order: ByteOrder,
    /// Packing of a headerless file's pixels.
    pub packing: Packing,
    /// Bytes from one line of a headerless file to the next, where lines are padded.
    pub line_bytes: Option<usize>,
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

impl Size {
    /// Returns the size of a frame.
    #[must_use]
    pub fn of(frame: &RawFrame) -> Self {
        let (height, width) = frame.size();
        Self { width, height }
    }

    /// Returns the bytes of a headerless file.
    pub(super) const fn bytes(self, packing: Packing) -> usize {
        packing.bytes(self.width * self.height)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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

/// Text that is not a size.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("size '{0}': expected WIDTHxHEIGHT in pixels, 1 to 65535 each, as in 1920x1080")]
pub struct WrongSize(pub(super) String);

impl FromStr for Size {
    type Err = WrongSize;

    fn from_str(text: &str) -> Result<Self, WrongSize> {
        let side = |word: &str| word.parse().ok().filter(|v| (1..=65535).contains(v));
        text.split_once('x')
            .and_then(|(w, h)| Some(Self { width: side(w)?, height: side(h)? }))
            .ok_or_else(|| WrongSize(text.to_owned()))
    }
}

/// Position in a 16-bit word of a value of fewer bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// At the top, zeros below.
    Top,
    /// At the bottom, zeros above.
    Bottom,
}

impl fmt::Display for Alignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Top => "top",
            Self::Bottom => "bottom",
        })
    }
}
