//! Which grey a PC's graphics card has to draw for a luma code to come: found by a chart of all greys.

use edof_core::cable::CODES;
use ndarray::Array2;

/// Sides of a square of one grey, and of the chart that repeats over a picture.
const SQUARE: usize = 4;
/// Columns and rows of the chart: 16 × 16 squares.
pub const SIDE: usize = 16 * SQUARE;
/// Codes that carry a word.
const COUNT: usize = 128;

/// The chart over a picture of that size: every grey from 0 to 255 in squares of 4 × 4 pixels, row by row.
#[must_use]
pub fn chart(height: usize, width: usize) -> Array2<u8> {
    Array2::from_shape_fn((height, width), |(row, column)| grey_at(row, column) as u8)
}

const fn grey_at(row: usize, column: usize) -> usize {
    16 * (row % SIDE / SQUARE) + column % SIDE / SQUARE
}

/// Why greys carry no words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum GreyError {
    /// A square of the chart is not of one code.
    #[error(
        "grey {grey} comes as luma {first} and as {other}: the chart is not shown pixel by pixel; show it unscaled, without dithering or colour management"
    )]
    Unsteady { grey: usize, first: u8, other: u8 },
    /// Chroma is not grey.
    #[error(
        "grey {grey} comes with chroma {chroma}, expected 64 to 191 beside luma of 64 to 191: the chart is not shown, or in colour"
    )]
    Coloured { grey: usize, chroma: u8 },
    /// Codes are missing.
    #[error(
        "{found} of 128 luma codes (64 to 191) come through, {first} is the first that does not, luma is {min} to {max}: raw words would be wrong by up to {wrong} of 65535; set the graphics card to RGB of full range"
    )]
    Missing { found: usize, first: usize, min: u8, max: u8, wrong: usize },
}

/// The luma code that each grey becomes on its way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Path(Vec<u8>);

impl Path {
    /// Reads the chart as the board received it: luma in the upper byte of each word, chroma in the lower.
    ///
    /// # Errors
    /// [`GreyError`]: a square that is not of one grey.
    pub fn of_chart(words: &Array2<u16>) -> Result<Self, GreyError> {
        let mut luma: Vec<Option<u8>> = vec![None; 256];
        for ((row, column), word) in words.indexed_iter() {
            let grey = grey_at(row, column);
            let [code, chroma] = word.to_be_bytes();
            if CODES.contains(&code) && !CODES.contains(&chroma) {
                return Err(GreyError::Coloured { grey, chroma });
            }
            let first = *luma[grey].get_or_insert(code);
            if first != code {
                return Err(GreyError::Unsteady { grey, first, other: code });
            }
        }
        Ok(Self(luma.into_iter().map(Option::unwrap_or_default).collect()))
    }

    /// Luma of each grey from 0 to 255.
    #[must_use]
    pub fn luma(&self) -> &[u8] {
        &self.0
    }

    /// The grey for each code that carries a word: of several the middle one, of an even number the darker.
    ///
    /// # Errors
    /// [`GreyError::Missing`]: no grey becomes that code.
    pub fn greys(&self) -> Result<Greys, GreyError> {
        let of_code = |code: u8| {
            let greys: Vec<u8> = (0..=255).filter(|grey| self.0[usize::from(*grey)] == code).collect();
            greys.get(greys.len().saturating_sub(1) / 2).copied()
        };
        let found: Vec<Option<u8>> = CODES.map(of_code).collect();
        let greys: Vec<u8> = found.iter().copied().flatten().collect();
        greys.try_into().map(Greys).map_err(|_| self.missing(&found))
    }

    /// The largest error is that of a word whose upper code is missing, and replaced by the nearest one.
    fn missing(&self, found: &[Option<u8>]) -> GreyError {
        let is_there = |index: &usize| found[*index].is_some();
        let present: Vec<usize> = (0..COUNT).filter(is_there).collect();
        let distance = |index: usize| present.iter().map(|p| p.abs_diff(index)).min().unwrap_or(COUNT - 1);
        let first = (0..COUNT).find(|index| !is_there(index)).unwrap_or(0);
        let wrong = (0..COUNT).map(distance).max().unwrap_or(0) << 9;
        let ends = [self.0.iter().min(), self.0.iter().max()].map(|end| end.copied().unwrap_or(0));
        let [min, max] = ends;
        GreyError::Missing {
            found: present.len(),
            first: usize::from(*CODES.start()) + first,
            min,
            max,
            wrong,
        }
    }
}

/// The grey of each luma code from 64 to 191.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Greys([u8; COUNT]);

impl Greys {
    /// Takes 128 greys, the first for code 64; none if they are not as many, or two are equal.
    #[must_use]
    pub fn new(greys: &[u8]) -> Option<Self> {
        let is_new = |index: usize| !greys[..index].contains(&greys[index]);
        let greys: [u8; COUNT] = greys.try_into().ok()?;
        (0..COUNT).all(is_new).then_some(Self(greys))
    }

    /// The greys, the first for code 64.
    #[must_use]
    pub const fn all(&self) -> &[u8] {
        &self.0
    }

    /// Codes as the greys that become them.
    #[must_use]
    pub fn picture(&self, codes: &Array2<u8>) -> Array2<u8> {
        codes.mapv(|code| self.0[usize::from(code.saturating_sub(*CODES.start())).min(COUNT - 1)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The chart after a card that does this to a grey.
    fn received(luma: impl Fn(u8) -> u8) -> Array2<u16> {
        chart(SIDE, SIDE).mapv(|grey| u16::from_be_bytes([luma(grey), 128]))
    }

    #[test]
    fn a_chart_has_every_grey_and_repeats() {
        let chart = chart(70, 130);
        assert_eq!((chart[(0, 0)], chart[(0, 63)], chart[(4, 0)], chart[(63, 63)]), (0, 15, 16, 255));
        assert_eq!((chart[(64, 64)], chart[(69, 129)]), (0, 16));
    }

    #[test]
    fn each_code_has_the_middle_of_its_greys() {
        // Two greys become one code, and an offset.
        let path = Path::of_chart(&received(|grey| 40 + grey / 3 * 2 + grey % 3 / 2)).unwrap();
        let greys = path.greys().unwrap();
        assert_eq!((path.luma()[0], path.luma()[255]), (40, 210));
        // 64 = 40 + 24 is greys 36 and 37; 65 is grey 38.
        assert_eq!(greys.all()[..2], [36, 38]);
        let codes = Array2::from_shape_fn((2, 64), |(r, c)| (64 + 64 * r + c) as u8);
        let back = greys.picture(&codes).mapv(|grey| path.luma()[usize::from(grey)]);
        assert_eq!(back, codes);
        assert_eq!(Greys::new(greys.all()), Some(greys));
        assert_eq!([Greys::new(&[1; 128]), Greys::new(&[1, 2])], [None, None]);
    }

    #[test]
    fn what_carries_no_words_is_named() {
        // Half of the gain: luma 64 to 191 are codes 64 to 191, and no more.
        let narrow = Path::of_chart(&received(|grey| 70 + grey / 4)).unwrap().greys();
        let expected = GreyError::Missing { found: 64, first: 64, min: 70, max: 133, wrong: 58 << 9 };
        assert_eq!(narrow, Err(expected));
        // More gain than one: codes are left out.
        let wide =
            Path::of_chart(&received(|grey| (u32::from(grey) * 9 / 8).min(255) as u8)).unwrap().greys();
        assert_eq!(wide, Err(GreyError::Missing { found: 114, first: 71, min: 0, max: 255, wrong: 512 }));
        let mut blurred = received(|grey| grey);
        blurred[(8, 4)] += 0x100;
        let unsteady = GreyError::Unsteady { grey: 33, first: 34, other: 33 };
        assert_eq!(Path::of_chart(&blurred), Err(unsteady));
        let coloured = received(|grey| grey).mapv(|word| word & 0xff00 | 240);
        assert_eq!(Path::of_chart(&coloured), Err(GreyError::Coloured { grey: 64, chroma: 240 }));
        // A receiver that takes RGB for luma and chroma sends the grey as both.
        let both = received(|grey| grey).mapv(|word| word >> 8 | word & 0xff00);
        assert_eq!(Path::of_chart(&both).unwrap().greys().unwrap().all()[..2], [64, 65]);
    }
}
