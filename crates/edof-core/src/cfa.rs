//! The colour filter array (Bayer mosaic) and its four phases.

use serde::{Deserialize, Serialize};

/// A colour channel, in the order in which all arrays hold them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Plane 0.
    Red,
    /// Plane 1.
    Green,
    /// Plane 2.
    Blue,
}

impl Channel {
    /// All three, in plane order.
    pub const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];

    /// Index of the channel's plane.
    #[must_use]
    pub const fn plane(self) -> usize {
        self as usize
    }
}

/// Which colour the filter at row 0, column 0 has, and so all others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CfaPhase {
    /// Red first; every network is trained for this phase.
    #[default]
    Rggb,
    /// Green first, red beside it.
    Grbg,
    /// Green first, blue beside it.
    Gbrg,
    /// Blue first.
    Bggr,
}

impl CfaPhase {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Rggb, Self::Grbg, Self::Gbrg, Self::Bggr];

    /// Rows and columns (0 or 1 each) from the frame's corner to its first red pixel.
    #[must_use]
    pub const fn red_site(self) -> (usize, usize) {
        match self {
            Self::Rggb => (0, 0),
            Self::Grbg => (0, 1),
            Self::Gbrg => (1, 0),
            Self::Bggr => (1, 1),
        }
    }

    /// The colour that the pixel at `row`, `column` measures.
    ///
    /// ```
    /// use edof_core::{CfaPhase, Channel};
    /// assert_eq!(CfaPhase::Grbg.channel(0, 1), Channel::Red);
    /// ```
    #[must_use]
    pub const fn channel(self, row: usize, column: usize) -> Channel {
        let (r, c) = self.red_site();
        match ((row + r) % 2, (column + c) % 2) {
            (0, 0) => Channel::Red,
            (1, 1) => Channel::Blue,
            _ => Channel::Green,
        }
    }
}

impl std::fmt::Display for CfaPhase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rggb => "rggb",
            Self::Grbg => "grbg",
            Self::Gbrg => "gbrg",
            Self::Bggr => "bggr",
        })
    }
}

/// A word that names no phase.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("CFA phase '{0}': must be rggb, grbg, gbrg or bggr")]
pub struct UnknownPhase(String);

impl std::str::FromStr for CfaPhase {
    type Err = UnknownPhase;

    fn from_str(word: &str) -> Result<Self, UnknownPhase> {
        let lower = word.to_ascii_lowercase();
        Self::ALL.into_iter().find(|p| p.to_string() == lower).ok_or_else(|| UnknownPhase(word.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_phase_reads_as_its_name() {
        for phase in CfaPhase::ALL {
            let letters: String = [(0, 0), (0, 1), (1, 0), (1, 1)]
                .map(|(r, c)| ["r", "g", "b"][phase.channel(r, c).plane()])
                .concat();
            assert_eq!(letters, phase.to_string());
            assert_eq!(letters.parse::<CfaPhase>().unwrap(), phase);
        }
    }

    #[test]
    fn an_unknown_phase_is_rejected_by_name() {
        assert_eq!(
            "rgbg".parse::<CfaPhase>().unwrap_err().to_string(),
            "CFA phase 'rgbg': must be rggb, grbg, gbrg or bggr"
        );
    }
}
