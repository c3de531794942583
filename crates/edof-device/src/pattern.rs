//! Raw frames that the board makes itself: settings of the generator, and its constants (docs/contract.md, 1.3).

use std::fmt;
use std::str::FromStr;

/// A frame that the board makes in place of the source's; every frame of a pattern is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pattern {
    /// Words that grow by 32 per column and 64 per row, modulo 2^16.
    Ramp,
    /// Squares of 16 × 16 pixels of 16 levels, blue pixels of the opposite level.
    Chart,
    /// Words of a linear-feedback shift register.
    Noise,
    /// All bits 0.
    Zeros,
    /// All bits 1.
    Ones,
    /// 0x5555 and 0xaaaa by turns.
    Alternating,
}

/// Growth of [`Pattern::Ramp`] from column to column.
pub const RAMP_COLUMN: u16 = 32;
/// Growth of [`Pattern::Ramp`] from row to row.
pub const RAMP_ROW: u16 = 64;
/// In the register `pattern`: the tile that the host wrote, again and again.
pub const TILE: u32 = 7;
/// Rows and columns of the tile, and of the part of a picture that the host reads.
pub const TILE_SIDE: usize = 64;
/// Pixels of the tile.
pub const TILE_PIXELS: usize = TILE_SIDE * TILE_SIDE;
/// Bits of a picture's words: as of a word on the cable, the lowest two are 0.
pub const WORD_MASK: u16 = 0xfffc;
/// What the shift register of [`Pattern::Noise`] holds before a frame's first pixel.
pub const NOISE_SEED: u32 = 0x2545_f491;

impl Pattern {
    /// Every pattern. The first three are pictures; all bits of the memory are 0 and 1 with the others.
    pub const ALL: [Self; 6] =
        [Self::Ramp, Self::Chart, Self::Noise, Self::Zeros, Self::Ones, Self::Alternating];

    /// Number of the pattern in the register `pattern`, where 0 is none.
    #[must_use]
    pub const fn code(self) -> u32 {
        match self {
            Self::Ramp => 1,
            Self::Chart => 2,
            Self::Noise => 3,
            Self::Zeros => 4,
            Self::Ones => 5,
            Self::Alternating => 6,
        }
    }

    /// Name of the pattern, as an option.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ramp => "ramp",
            Self::Chart => "chart",
            Self::Noise => "noise",
            Self::Zeros => "zeros",
            Self::Ones => "ones",
            Self::Alternating => "alternating",
        }
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Pattern {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|pattern| pattern.name() == word).ok_or_else(|| {
            format!("unknown pattern '{word}', expected ramp, chart, noise, zeros, ones or alternating")
        })
    }
}
