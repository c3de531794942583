//! Programs that read codes. Neither is ours.

use super::symbology::{Card, Symbology};
use edof_core::storage::atomic::reason;
use ndarray::{Array2, s};
use rayon::prelude::*;
use rxing::helpers::detect_in_luma;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::io::{ErrorKind, Write};
use std::process::Command;

/// A program that reads codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reader {
    /// The crate rxing, a port of ZXing.
    Rxing,
    /// `zbarimg` of the ZBar project, which reads no Data Matrix.
    Zbarimg,
}

impl fmt::Display for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rxing => "rxing",
            Self::Zbarimg => "zbarimg",
        })
    }
}

/// A reader that cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ReaderError {
    /// No such program.
    #[error("zbarimg: no such program on the path; install zbar-tools, or leave --zbarimg out")]
    Missing,
    /// It cannot be run, or its picture cannot be written.
    #[error("zbarimg: {}", reason(.0))]
    Run(std::io::Error),
    /// It failed.
    #[error("zbarimg: {0}")]
    Failed(String),
}

impl Reader {
    /// Returns whether it reads codes of a kind.
    #[must_use]
    pub const fn reads(self, symbology: Symbology) -> bool {
        !matches!((self, symbology), (Self::Zbarimg, Symbology::DataMatrix))
    }

    /// Counts the cards of a picture that are read rightly. `luma` has codes of 0 to 255.
    ///
    /// # Errors
    /// [`ReaderError`].
    pub fn count(
        self,
        luma: &Array2<u8>,
        symbology: Symbology,
        cards: &[Card],
    ) -> Result<usize, ReaderError> {
        let reads = |card: &Card| {
            let ((row, column), (height, width)) = (card.at, card.size);
            let cell = luma.slice(s![row..row + height, column..column + width]).to_owned();
            match self {
                Self::Rxing => Ok(by_rxing(cell, symbology).is_some_and(|text| text == card.text)),
                Self::Zbarimg => Ok(by_zbarimg(&cell)?.lines().any(|text| text == card.text)),
            }
        };
        cards.par_iter().map(|card| reads(card).map(usize::from)).sum()
    }
}

fn by_rxing(cell: Array2<u8>, symbology: Symbology) -> Option<String> {
    let (height, width) = cell.dim();
    let luma = cell.into_raw_vec_and_offset().0;
    let read = detect_in_luma(luma, width as u32, height as u32, Some(symbology.format()));
    read.ok().map(|found| found.getText().to_owned())
}

/// Returns what zbarimg prints: a line for each code.
fn by_zbarimg(cell: &Array2<u8>) -> Result<String, ReaderError> {
    let (height, width) = cell.dim();
    let mut file = tempfile::Builder::new().suffix(".pgm").tempfile().map_err(ReaderError::Run)?;
    let pixels: Vec<u8> = cell.iter().copied().collect();
    write!(file, "P5\n{width} {height}\n255\n")
        .and_then(|()| file.write_all(&pixels))
        .map_err(ReaderError::Run)?;
    let output = Command::new("zbarimg").args(["--quiet", "--raw"]).arg(file.path()).output();
    let output = output.map_err(|e| match e.kind() {
        ErrorKind::NotFound => ReaderError::Missing,
        _ => ReaderError::Run(e),
    })?;
    // 4: no code found.
    match output.status.code() {
        Some(0 | 4) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        _ => Err(ReaderError::Failed(String::from_utf8_lossy(&output.stderr).trim().to_owned())),
    }
}
