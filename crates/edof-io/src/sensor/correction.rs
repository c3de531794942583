//! A sensor's offsets, gains and defects, and their use in integers.

use super::defects::DefectMap;
use crate::raw::Size;
use edof_core::frame::FrameError;
use edof_core::geometry::GeometryError;
use edof_core::words::sides;
use edof_core::{CfaPhase, RawFrame};
use ndarray::{Array2, Array3, ArrayViewMut2, Zip};

/// Pixels between two nodes of the grid of gains.
pub const NODE_SPACING: usize = 32;
/// Fraction bits of a gain.
pub const GAIN_FRACTION: u32 = 14;
/// Fraction bits of a place between four nodes.
const PLACE_FRACTION: u32 = 2 * NODE_SPACING.trailing_zeros();

/// Holds what a correction consists of. Offsets are in raw pixel words: sensor values at the top of 16 bits.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// Columns and rows of a frame.
    pub size: Size,
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of a sensor value.
    pub depth: u32,
    /// Whether frames hold light by their files' own levels, as DNGs do, and no sensor values; none where no frames were measured.
    pub is_light: Option<bool>,
    /// Words of no light, for the 2×2 pixels from the first on, row by row.
    pub black: [u16; 4],
    /// Added to the black of each column.
    pub columns: Vec<i16>,
    /// Added to the black of each row.
    pub rows: Vec<i16>,
    /// Added to the black of each pixel, rows × columns, where frames support it.
    pub pixels: Option<Array2<i16>>,
    /// Gains of 2 and 14 bits at the nodes of a grid: 4 places of a cell × rows × columns.
    pub gains: Array3<u16>,
    /// Pixels that are repaired.
    pub defects: Defects,
}

/// Defective pixels, columns and rows, counted from 0.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Defects {
    /// Row and column of single pixels.
    pub pixels: Vec<[u32; 2]>,
    /// Whole columns.
    pub columns: Vec<u32>,
    /// Whole rows.
    pub rows: Vec<u32>,
}

/// Tables that make no correction.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum SensorError {
    /// A size or a depth that no frame has.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A table of another shape.
    #[error("{table}: {}, expected {} for frames of {size}", sides(found), sides(expected))]
    Shape { table: &'static str, found: Vec<usize>, expected: Vec<usize>, size: Size },
    /// A defect outside of the frame.
    #[error("defective {defect}: outside of frames of {size}")]
    Outside { defect: String, size: Size },
}

/// A frame of another sensor than a correction is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a frame of {} of phase {} with {} bits, expected one of {} of phase {} with {} bits, as the sensor file was made for",
    found.0, found.1, found.2, expected.0, expected.1, expected.2
)]
pub struct OtherSensor {
    /// Size, phase and bits of the frame.
    pub found: (Size, CfaPhase, u32),
    /// Those of the correction.
    pub expected: (Size, CfaPhase, u32),
}

/// A frame of other values than a correction was made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum OtherValues {
    /// A frame of light, and a correction of sensor values.
    #[error(
        "its values are light by the file's own levels, as in a DNG, the sensor file was made from sensor values; make one from DNGs by 'edof sensor'"
    )]
    Light,
    /// A frame of sensor values, and a correction of light.
    #[error(
        "holds sensor values, the sensor file was made from DNGs, whose values are light; make one from frames as this one by 'edof sensor'"
    )]
    Sensor,
}

/// A correction of frames, ready for use.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    tables: Tables,
    /// Offset of each pixel.
    offsets: Array2<u16>,
    /// Gain of each pixel.
    gains: Array2<u16>,
    defects: DefectMap,
}

impl Tables {
    /// Returns tables that change nothing but `black` and `white`, words of no and of full light (at most 65536).
    #[must_use]
    pub fn plain(size: Size, phase: CfaPhase, depth: u32, black: [f64; 4], white: f64) -> Self {
        let (rows, columns) = grid(size);
        let gain = |place: usize| gain_word(65536.0 / (white - black[place]));
        Self {
            size,
            phase,
            depth,
            is_light: None,
            black: black.map(|level| level.round() as u16),
            columns: vec![0; size.width],
            rows: vec![0; size.height],
            pixels: None,
            gains: Array3::from_shape_fn((4, rows, columns), |(place, ..)| gain(place)),
            defects: Defects::default(),
        }
    }

    /// Returns the offset of each pixel: the sum of its parts, saturated to 16 bits.
    #[must_use]
    pub fn offsets(&self) -> Array2<u16> {
        Array2::from_shape_fn((self.size.height, self.size.width), |(r, c)| {
            let black = i32::from(self.black[place(r, c)]);
            let pixel = self.pixels.as_ref().map_or(0, |pixels| i32::from(pixels[(r, c)]));
            let sum = black + i32::from(self.columns[c]) + i32::from(self.rows[r]) + pixel;
            sum.clamp(0, 65535) as u16
        })
    }

    /// Returns the gain of each pixel, between the four nodes around it.
    fn pixel_gains(&self) -> Array2<u16> {
        Array2::from_shape_fn((self.size.height, self.size.width), |(r, c)| {
            let (i, j) = (r / NODE_SPACING, c / NODE_SPACING);
            let (down, right) = ((r % NODE_SPACING) as u32, (c % NODE_SPACING) as u32);
            let (up, left) = (NODE_SPACING as u32 - down, NODE_SPACING as u32 - right);
            let node = |i, j| u32::from(self.gains[(place(r, c), i, j)]);
            let sum = up * (left * node(i, j) + right * node(i, j + 1))
                + down * (left * node(i + 1, j) + right * node(i + 1, j + 1));
            ((sum + (1 << (PLACE_FRACTION - 1))) >> PLACE_FRACTION) as u16
        })
    }

    fn check(&self) -> Result<(), SensorError> {
        let Size { width, height } = self.size;
        if !(8..=16).contains(&self.depth) {
            return Err(FrameError::Depth(self.depth).into());
        }
        if width == 0 || height == 0 || width % 2 != 0 || height % 2 != 0 {
            return Err(FrameError::from(GeometryError::OddFrame { height, width }).into());
        }
        let (rows, columns) = grid(self.size);
        let tables = [
            ("columns", vec![self.columns.len()], vec![width]),
            ("rows", vec![self.rows.len()], vec![height]),
            ("gains", self.gains.shape().to_vec(), vec![4, rows, columns]),
            (
                "pixels",
                self.pixels.as_ref().map_or(vec![height, width], |pixels| pixels.shape().to_vec()),
                vec![height, width],
            ),
        ];
        match tables.into_iter().find(|(_, found, expected)| found != expected) {
            Some((table, found, expected)) => {
                Err(SensorError::Shape { table, found, expected, size: self.size })
            }
            None => self.defects.check(self.size),
        }
    }
}

impl Defects {
    fn check(&self, size: Size) -> Result<(), SensorError> {
        let outside = |row: u32, column: u32| row as usize >= size.height || column as usize >= size.width;
        let pixel = self.pixels.iter().find(|[row, column]| outside(*row, *column));
        let column = self.columns.iter().find(|column| outside(0, **column));
        let row = self.rows.iter().find(|row| outside(**row, 0));
        let defect = pixel.map(|[row, column]| format!("pixel at row {row}, column {column}"));
        let defect = defect.or(column.map(|column| format!("column {column}")));
        match defect.or(row.map(|row| format!("row {row}"))) {
            Some(defect) => Err(SensorError::Outside { defect, size }),
            None => Ok(()),
        }
    }

    /// Returns a mask of frames of that size, which all defects are inside of: true where a pixel is defective.
    fn mask(&self, Size { width, height }: Size) -> Array2<bool> {
        let mut mask = Array2::from_elem((height, width), false);
        for [row, column] in &self.pixels {
            mask[(*row as usize, *column as usize)] = true;
        }
        self.columns.iter().for_each(|column| mask.column_mut(*column as usize).fill(true));
        self.rows.iter().for_each(|row| mask.row_mut(*row as usize).fill(true));
        mask
    }
}

impl Correction {
    /// Prepares the use of tables.
    ///
    /// # Errors
    /// [`SensorError`] for tables that do not fit their frames.
    pub fn new(tables: Tables) -> Result<Self, SensorError> {
        tables.check()?;
        let (offsets, gains) = (tables.offsets(), tables.pixel_gains());
        let defects = DefectMap::new(tables.defects.mask(tables.size), tables.phase);
        Ok(Self { tables, offsets, gains, defects })
    }

    /// Returns what the correction consists of.
    #[must_use]
    pub const fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Returns all pixels that are repaired.
    #[must_use]
    pub const fn defects(&self) -> &DefectMap {
        &self.defects
    }

    /// Returns the same correction, of frames that hold light or sensor values, if that is known.
    #[must_use]
    pub const fn of_light(mut self, is_light: Option<bool>) -> Self {
        self.tables.is_light = is_light;
        self
    }

    /// Rejects frames of other values.
    ///
    /// # Errors
    /// [`OtherValues`].
    pub const fn check_values(&self, is_light: bool) -> Result<(), OtherValues> {
        match (is_light, self.tables.is_light) {
            (true, Some(false)) => Err(OtherValues::Light),
            (false, Some(true)) => Err(OtherValues::Sensor),
            _ => Ok(()),
        }
    }

    /// Rejects frames of another sensor.
    ///
    /// # Errors
    /// [`OtherSensor`].
    pub fn check(&self, size: Size, phase: CfaPhase, depth: u32) -> Result<(), OtherSensor> {
        let (found, expected) =
            ((size, phase, depth), (self.tables.size, self.tables.phase, self.tables.depth));
        if found == expected { Ok(()) } else { Err(OtherSensor { found, expected }) }
    }

    /// Makes light of raw pixel words in place: offsets, gains, then repairs (docs/sensor.md).
    ///
    /// # Panics
    /// If the words are not as many rows and columns as the correction is for.
    pub fn correct(&self, mut words: ArrayViewMut2<'_, u16>) {
        Zip::from(&mut words).and(&self.offsets).and(&self.gains).for_each(|word, offset, gain| {
            let light = u32::from(word.saturating_sub(*offset)) * u32::from(*gain);
            *word = ((light + (1 << (GAIN_FRACTION - 1))) >> GAIN_FRACTION).min(65535) as u16;
        });
        self.defects.repair(words, |median| (median + 0.5).floor() as u16);
    }

    /// Returns a frame as light of 16 bits.
    ///
    /// # Errors
    /// [`OtherSensor`].
    pub fn light(&self, frame: &RawFrame) -> Result<RawFrame, OtherSensor> {
        self.check(Size::of(frame), frame.phase(), frame.depth())?;
        let mut words = frame.pixels().clone();
        self.correct(words.view_mut());
        let other = |_| OtherSensor {
            found: (Size::of(frame), frame.phase(), frame.depth()),
            expected: (self.tables.size, self.tables.phase, self.tables.depth),
        };
        RawFrame::from_values(words, 16, frame.phase()).map_err(other)
    }
}

/// Place of a pixel in its cell, row by row.
pub const fn place(row: usize, column: usize) -> usize {
    2 * (row % 2) + column % 2
}

/// Rows and columns of the grid of gains.
pub const fn grid(Size { width, height }: Size) -> (usize, usize) {
    ((height - 1) / NODE_SPACING + 2, (width - 1) / NODE_SPACING + 2)
}

/// A gain of 2 and 14 bits, saturated.
pub fn gain_word(gain: f64) -> u16 {
    (gain * f64::from(1 << GAIN_FRACTION)).round().clamp(0.0, 65535.0) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::{Black, Levels};

    const SIZE: Size = Size { width: 70, height: 40 };

    fn frame(depth: u32) -> RawFrame {
        let max = (1usize << depth) - 1;
        let values = Array2::from_shape_fn((40, 70), |(r, c)| ((r * 7919 + c * 104_729) % (max + 1)) as u16);
        RawFrame::from_values(values, depth, CfaPhase::Gbrg).unwrap()
    }

    #[test]
    fn a_plain_correction_takes_levels_off_as_levels_do() {
        for depth in [8, 10, 12, 14] {
            let (shift, full) = (16 - depth, f64::from(1u32 << depth));
            let black = [64.0, 66.0, 60.0, 62.0].map(|level: f64| (level * full / 4096.0).round());
            let white = (0.95 * full).round();
            let words = |level: f64| level * f64::from(1u32 << shift);
            let tables = Tables::plain(SIZE, CfaPhase::Gbrg, depth, black.map(words), words(white));
            let found = Correction::new(tables).unwrap().light(&frame(depth)).unwrap();
            let levels = Levels { black: Black::new(black).unwrap(), white: Some(white) };
            let expected = levels.light(&frame(depth)).unwrap();
            let far = found.pixels().iter().zip(expected.pixels()).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(far <= Some(3) && found.depth() == 16, "{depth}: {far:?}");
        }
        let tables = Tables::plain(SIZE, CfaPhase::Gbrg, 12, [0.0; 4], 65536.0);
        assert_eq!(
            Correction::new(tables).unwrap().light(&frame(12)).unwrap().pixels(),
            frame(12).pixels(),
            "nothing to correct"
        );
    }

    #[test]
    fn offsets_add_up_and_gains_lie_between_their_nodes() {
        let mut tables = Tables::plain(SIZE, CfaPhase::Rggb, 12, [1000.0; 4], 65536.0);
        tables.gains.fill(1 << GAIN_FRACTION);
        tables.columns[3] = -1200;
        tables.rows[5] = 70;
        let mut pixels = Array2::zeros((40, 70));
        pixels[(5, 4)] = -20;
        tables.pixels = Some(pixels);
        let offsets = tables.offsets();
        assert_eq!([offsets[(4, 4)], offsets[(4, 3)], offsets[(5, 3)], offsets[(5, 4)]], [1000, 0, 0, 1050]);
        // Twice as bright at the second column of nodes: half way between them, half as much more.
        tables.gains.slice_mut(ndarray::s![.., .., 1]).fill(2 << GAIN_FRACTION);
        let gains = tables.pixel_gains();
        assert_eq!([gains[(7, 0)], gains[(39, 16)], gains[(0, 32)]], [1 << 14, 3 << 13, 2 << 14]);
    }

    #[test]
    fn frames_of_another_sensor_and_tables_of_another_size_are_rejected_by_name() {
        let tables = Tables::plain(SIZE, CfaPhase::Rggb, 12, [0.0; 4], 65536.0);
        let told = Correction::new(tables.clone()).unwrap().light(&frame(10)).unwrap_err().to_string();
        assert_eq!(
            told,
            "a frame of 70x40 of phase gbrg with 10 bits, expected one of 70x40 of phase rggb with 12 bits, \
             as the sensor file was made for"
        );
        let refused = |change: fn(&mut Tables)| {
            let mut tables = tables.clone();
            change(&mut tables);
            Correction::new(tables).unwrap_err().to_string()
        };
        assert_eq!(refused(|t| t.rows = vec![]), "rows: 0, expected 40 for frames of 70x40");
        assert_eq!(refused(|t| t.depth = 7), "bit depth 7: must be 8 to 16");
        let outside = "defective pixel at row 40, column 2: outside of frames of 70x40";
        assert_eq!(refused(|t| t.defects.pixels = vec![[40, 2]]), outside);
        assert_eq!(
            refused(|t| t.defects.columns = vec![70]),
            "defective column 70: outside of frames of 70x40"
        );
    }
}
