//! Kinds of codes, and sheets of random ones. Symbols are encoded by rxing, which is not ours.

use edof_core::ColourFrame;
use edof_core::draw::Draw;
use edof_io::photos::Photo;
use rxing::common::BitMatrix;
use rxing::{BarcodeFormat, MultiFormatWriter, Writer};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Light of a white module and of paper, full scale 1.
const WHITE: f32 = 0.8;
/// Light of a dark module.
const DARK: f32 = 0.04;
/// Modules that a bar is high.
const BAR: usize = 24;
/// Modules that a cell is wide and high at most: Code 128 with its quiet zones.
const MAX_WIDTH: usize = 180;
const MAX_HEIGHT: usize = BAR + 2 * 11;
/// Pixels by which places vary, besides parts of a pixel.
const JITTER: i64 = 8;
/// Parts of a pixel in which places are drawn.
const PARTS: i64 = 64;
const LETTERS: &[u8] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// A kind of code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symbology {
    /// QR code (ISO/IEC 18004).
    Qr,
    /// Data Matrix (ISO/IEC 16022).
    DataMatrix,
    /// EAN-13 (ISO/IEC 15420).
    #[serde(rename = "ean-13")]
    Ean13,
    /// Code 128 (ISO/IEC 15417).
    #[serde(rename = "code-128")]
    Code128,
}

/// A code of no known kind.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("code '{0}': must be one of qr, data-matrix, ean-13, code-128")]
pub struct UnknownSymbology(String);

impl Symbology {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Qr, Self::DataMatrix, Self::Ean13, Self::Code128];

    const fn name(self) -> &'static str {
        match self {
            Self::Qr => "qr",
            Self::DataMatrix => "data-matrix",
            Self::Ean13 => "ean-13",
            Self::Code128 => "code-128",
        }
    }

    /// Returns the format as rxing names it.
    #[must_use]
    pub const fn format(self) -> BarcodeFormat {
        match self {
            Self::Qr => BarcodeFormat::QR_CODE,
            Self::DataMatrix => BarcodeFormat::DATA_MATRIX,
            Self::Ean13 => BarcodeFormat::EAN_13,
            Self::Code128 => BarcodeFormat::CODE_128,
        }
    }

    /// Modules of white around a symbol, at least those of its standard.
    pub(crate) const fn quiet_zone(self) -> usize {
        match self {
            Self::Qr => 4,
            Self::DataMatrix => 2,
            Self::Ean13 => 11,
            Self::Code128 => 10,
        }
    }

    /// Returns what a random symbol says.
    pub(crate) fn text(self, draw: &mut Draw) -> String {
        match self {
            Self::Ean13 => with_check_digit((0..12).map(|_| draw.whole(0, 9) as u8).collect()),
            Self::Qr | Self::DataMatrix | Self::Code128 => {
                let letter = |_| LETTERS[draw.whole(0, LETTERS.len() as i64 - 1) as usize] as char;
                (0..10).map(letter).collect()
            }
        }
    }

    /// Returns rows of modules, dark ones true, without a quiet zone.
    pub(crate) fn modules(self, text: &str) -> Result<Vec<Vec<bool>>, rxing::Exceptions> {
        let symbol: BitMatrix = MultiFormatWriter.encode(text, &self.format(), 1, 1)?;
        let [left, top, width, height] = symbol.getEnclosingRectangle().unwrap_or_default();
        let row = |y: u32| (left..left + width).map(|x| symbol.get(x, top + y)).collect::<Vec<bool>>();
        Ok(match self {
            Self::Qr | Self::DataMatrix => (0..height).map(row).collect(),
            Self::Ean13 | Self::Code128 => vec![row(0); BAR],
        })
    }
}

impl fmt::Display for Symbology {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Symbology {
    type Err = UnknownSymbology;

    fn from_str(name: &str) -> Result<Self, UnknownSymbology> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownSymbology(name.to_owned()))
    }
}

/// Appends the check digit of EAN-13: weights 1 and 3 in turn.
fn with_check_digit(digits: Vec<u8>) -> String {
    let sum: u32 =
        digits.iter().zip([1, 3].into_iter().cycle()).map(|(digit, weight)| u32::from(*digit) * weight).sum();
    let check = ((10 - sum % 10) % 10) as u8;
    digits.into_iter().chain([check]).map(|digit| char::from(b'0' + digit)).collect()
}

/// A code on a sheet: what it says, and the pixels of its cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Card {
    /// What it says.
    pub text: String,
    /// First row and column of its cell.
    pub at: (usize, usize),
    /// Rows and columns of its cell.
    pub size: (usize, usize),
}

/// Codes of one kind and size, at random places of a grid.
pub struct Sheet {
    /// Kind of its codes.
    pub symbology: Symbology,
    /// Side of a module in pixels.
    pub module_px: f64,
    /// The sheet as linear light.
    pub photo: Photo,
    /// Its codes.
    pub cards: Vec<Card>,
}

impl Sheet {
    /// Returns columns and rows of pixels that no sheet exceeds, all its codes below each other.
    #[must_use]
    pub fn max_size(module_px: f64, count: usize) -> (usize, usize) {
        let side = |modules: usize| (modules as f64 * module_px).ceil() as usize + 1 + JITTER as usize;
        (side(MAX_WIDTH), count * side(MAX_HEIGHT))
    }

    /// Draws a sheet. Each code has its own text, and its own place to a 64th of a pixel.
    ///
    /// # Errors
    /// A text that rxing does not encode.
    pub fn new(
        symbology: Symbology,
        module_px: f64,
        count: usize,
        seed: u64,
    ) -> Result<Self, rxing::Exceptions> {
        let draw = &mut Draw::new(seed);
        let texts: Vec<String> = (0..count).map(|_| symbology.text(draw)).collect();
        let symbols = texts.iter().map(|text| symbology.modules(text)).collect::<Result<Vec<_>, _>>()?;
        let quiet = symbology.quiet_zone();
        let side =
            |modules: usize| ((modules + 2 * quiet) as f64 * module_px).ceil() as usize + 1 + JITTER as usize;
        let height = symbols.iter().map(|rows| side(rows.len())).max().unwrap_or(0);
        let width = symbols.iter().map(|rows| side(rows[0].len())).max().unwrap_or(0);
        let columns =
            (((count * height) as f64 / width as f64).sqrt().ceil() as usize).clamp(1, count.max(1));
        let rows = count.div_ceil(columns);
        let even = |side: usize| side.next_multiple_of(2);
        let mut frame = ColourFrame::zeros(even(rows * height), even(columns * width));
        frame.planes.fill(WHITE);
        let mut cards = vec![];
        for (index, (text, symbol)) in texts.into_iter().zip(&symbols).enumerate() {
            let at = (height * (index / columns), width * (index % columns));
            let shift = || quiet as f64 * module_px;
            let [row, column] = [at.0, at.1].map(|start| start as f64 + shift() + place(draw));
            paint(&mut frame, symbol, (row, column), module_px);
            cards.push(Card { text, at, size: (height, width) });
        }
        let name = format!("{symbology} of {module_px} px");
        Ok(Self { symbology, module_px, photo: Photo { name, frame }, cards })
    }
}

/// Draws a shift in pixels.
fn place(draw: &mut Draw) -> f64 {
    draw.whole(0, JITTER * PARTS - 1) as f64 / PARTS as f64
}

/// Paints the dark modules of a symbol; each pixel gets its share of each module.
fn paint(frame: &mut ColourFrame, symbol: &[Vec<bool>], at: (f64, f64), module_px: f64) {
    for (y, row) in symbol.iter().enumerate() {
        let rows = shares(at.0 + y as f64 * module_px, module_px);
        for x in (0..row.len()).filter(|&x| row[x]) {
            let columns = shares(at.1 + x as f64 * module_px, module_px);
            for &(r, down) in &rows {
                for &(c, along) in &columns {
                    frame
                        .planes
                        .slice_mut(ndarray::s![.., r, c])
                        .mapv_inplace(|v| v - (WHITE - DARK) * (down * along) as f32);
                }
            }
        }
    }
}

/// Pixels that a module covers along one axis, and how much of each.
fn shares(start: f64, length: f64) -> Vec<(usize, f64)> {
    let end = start + length;
    let covered = |pixel: usize| (end.min(pixel as f64 + 1.0) - start.max(pixel as f64)).max(0.0);
    (start.floor() as usize..end.ceil() as usize).map(|pixel| (pixel, covered(pixel))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_digit_is_that_of_a_published_example() {
        // ISO/IEC 15420's and GS1's example, 4006381333931.
        assert_eq!(with_check_digit(vec![4, 0, 0, 6, 3, 8, 1, 3, 3, 3, 9, 3]), "4006381333931");
    }

    #[test]
    fn a_sheet_has_the_light_of_its_modules_wherever_they_lie() {
        for symbology in Symbology::ALL {
            let sheet = Sheet::new(symbology, 2.5, 3, 7).unwrap();
            let dark: usize = sheet
                .cards
                .iter()
                .map(|card| {
                    symbology.modules(&card.text).unwrap().iter().flatten().filter(|dark| **dark).count()
                })
                .sum();
            let (height, width) = sheet.photo.frame.size();
            let lost = f64::from(WHITE) * (height * width) as f64
                - sheet
                    .photo
                    .frame
                    .planes
                    .index_axis(ndarray::Axis(0), 1)
                    .iter()
                    .map(|v| f64::from(*v))
                    .sum::<f64>();
            let expected = dark as f64 * 2.5 * 2.5 * f64::from(WHITE - DARK);
            assert!((lost - expected).abs() < 1e-3 * expected, "{symbology}: {lost} {expected}");
            assert!((height % 2, width % 2) == (0, 0));
            let (wide, high) = Sheet::max_size(2.5, 3);
            assert!(sheet.cards.iter().all(|card| card.size.0 * 3 <= high && card.size.1 <= wide));
        }
    }

    #[test]
    fn names_are_read_back_and_others_are_rejected() {
        for symbology in Symbology::ALL {
            assert_eq!(symbology.to_string().parse(), Ok(symbology));
            assert_eq!(serde_json::to_string(&symbology).unwrap(), format!("\"{symbology}\""));
        }
        assert!("aztec".parse::<Symbology>().unwrap_err().to_string().contains("must be one of"));
    }
}
