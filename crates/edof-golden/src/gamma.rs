//! Gamma: 16-bit luma to 8 bits by a look-up table that the host can load.

use edof_spec::Frame422;
use edof_spec::colour::srgb_encode;
use edof_spec::number::OUTPUT_FRACTION;
use ndarray::Array2;

/// Entries of the table: one for each luma word of 0 or more.
pub const ENTRIES: usize = 1 << 15;
/// Luma code of black (BT.709, studio range).
pub const BLACK: u8 = 16;
/// Luma code of white.
pub const WHITE: u8 = 235;

/// The look-up table, 8 bits for each non-negative luma word; negative words read entry 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gamma {
    table: Vec<u8>,
}

/// A table that the board cannot load.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum GammaError {
    /// Wrong length.
    #[error("gamma table: {0} entries, expected {ENTRIES}")]
    Length(usize),
    /// A sync code.
    #[error("gamma table: entry {index} is {code}, expected 1 to 254 (0 and 255 mark syncs)")]
    Sync { index: usize, code: u8 },
}

impl Gamma {
    /// Codes proportional to light.
    #[must_use]
    pub fn linear() -> Self {
        Self::from_curve(|light| light)
    }

    /// sRGB's curve.
    #[must_use]
    pub fn srgb() -> Self {
        Self::from_curve(srgb_encode)
    }

    /// BT.709's camera curve.
    #[must_use]
    pub fn bt709() -> Self {
        Self::from_curve(|l| if l < 0.018 { 4.5 * l } else { 1.099 * l.powf(0.45) - 0.099 })
    }

    /// A table of one's own.
    ///
    /// # Errors
    /// [`GammaError`] for a wrong length or a sync code.
    pub fn from_table(table: Vec<u8>) -> Result<Self, GammaError> {
        if table.len() != ENTRIES {
            return Err(GammaError::Length(table.len()));
        }
        match table.iter().position(|code| matches!(code, 0 | 255)) {
            Some(index) => Err(GammaError::Sync { index, code: table[index] }),
            None => Ok(Self { table }),
        }
    }

    /// The table, entry 0 first.
    #[must_use]
    pub fn table(&self) -> &[u8] {
        &self.table
    }

    /// The code of a luma word; negative words are black.
    #[must_use]
    pub fn code(&self, luma: i16) -> u8 {
        self.table[luma.max(0) as usize]
    }

    /// From black at light 0 to white at light 1 and above, rounded.
    fn from_curve(curve: impl Fn(f64) -> f64) -> Self {
        let span = f64::from(WHITE - BLACK);
        let code = |word: usize| {
            let light = (word as f64 / f64::from(1 << OUTPUT_FRACTION)).min(1.0);
            (f64::from(BLACK) + span * curve(light) + 0.5).floor() as u8
        };
        Self { table: (0..ENTRIES).map(code).collect() }
    }
}

/// The picture on the wire: 8-bit Y′CbCr 4:2:2, studio range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Luma codes, rows × columns.
    pub luma: Array2<u8>,
    /// Cb and Cr codes, rows × columns/2 each.
    pub chroma: [Array2<u8>; 2],
}

/// Sends a frame's luma through the table; chroma is final already.
#[must_use]
pub fn display(frame: &Frame422, gamma: &Gamma) -> Picture {
    Picture { luma: frame.luma.mapv(|word| gamma.code(word)), chroma: frame.chroma.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_white_and_what_lies_beyond() {
        for gamma in [Gamma::linear(), Gamma::srgb(), Gamma::bt709()] {
            assert_eq!([i16::MIN, -1, 0].map(|w| gamma.code(w)), [BLACK; 3]);
            assert_eq!([1 << 14, i16::MAX].map(|w| gamma.code(w)), [WHITE; 2]);
            assert!(gamma.table().is_sorted());
        }
        assert_eq!(Gamma::linear().code(1 << 13), 126);
        assert_eq!(Gamma::srgb().code(3506), 126 - 1);
    }

    #[test]
    fn a_table_comes_back_and_wrong_ones_are_refused() {
        let table = Gamma::srgb().table().to_vec();
        assert_eq!(Gamma::from_table(table.clone()), Ok(Gamma::srgb()));
        assert_eq!(Gamma::from_table(vec![16; 256]), Err(GammaError::Length(256)));
        let mut sync = table;
        sync[7] = 255;
        let error = Gamma::from_table(sync).unwrap_err();
        assert_eq!(
            error.to_string(),
            "gamma table: entry 7 is 255, expected 1 to 254 (0 and 255 mark syncs)"
        );
    }
}
