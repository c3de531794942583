//! From stored values to linear light: linearization, black and white levels, the active area (DNG 1.7, "Mapping Raw Values to Linear
//! Reference Values").

use super::Overrides;
use super::directory::Directory;
use super::pixels::Sample;
use super::rejection::Rejection;
use super::tags;
use crate::levels::{Black, LevelsError};
use ndarray::{Array2, s};

/// Values by the file's table, where it has one. A value beyond the table's end has that of its end.
///
/// # Errors
/// [`Rejection`] for a table that is empty or of a float picture.
pub fn linearize(raw: &Directory<'_>, sample: Sample, values: &mut Array2<f32>) -> Result<(), Rejection> {
    let Some(table) = raw.wholes(tags::LINEARIZATION)? else { return Ok(()) };
    if let Sample::Float(_) = sample {
        return Err(Rejection::value(tags::LINEARIZATION, "there", "none for floating-point numbers"));
    }
    let last = *table.last().ok_or_else(|| Rejection::wrong(tags::LINEARIZATION, &[], "a table"))?;
    values.mapv_inplace(|value| *table.get(value as usize).unwrap_or(&last) as f32);
    Ok(())
}

/// Top, left, bottom and right of what light falls on.
///
/// # Errors
/// [`Rejection`] for an area that is not inside of the picture.
pub fn active_area(raw: &Directory<'_>, (height, width): (usize, usize)) -> Result<[usize; 4], Rejection> {
    let Some(area) = raw.wholes(tags::ACTIVE_AREA)? else { return Ok([0, 0, height, width]) };
    match area[..] {
        [top, left, bottom, right]
            if top < bottom.saturating_sub(1)
                && left < right.saturating_sub(1)
                && bottom <= height
                && right <= width =>
        {
            Ok([top, left, bottom, right])
        }
        _ => {
            let found: Vec<f64> = area.iter().map(|v| *v as f64).collect();
            let expected = format!("top, left, bottom, right inside of {height} rows and {width} columns");
            Err(Rejection::wrong(tags::ACTIVE_AREA, &found, expected))
        }
    }
}

/// The value of no light at each pixel of the active area: a cell that repeats, and a difference for each column and row.
struct BlackLevels {
    size: [usize; 2],
    cell: Vec<f64>,
    of_column: Vec<f64>,
    of_row: Vec<f64>,
}

impl BlackLevels {
    fn stated(black: Black) -> Self {
        Self { size: [2, 2], cell: black.values().to_vec(), of_column: vec![], of_row: vec![] }
    }

    fn of(raw: &Directory<'_>, (height, width): (usize, usize)) -> Result<Self, Rejection> {
        let size = match raw.wholes(tags::BLACK_SIZE)? {
            None => [1, 1],
            Some(size) => match size[..] {
                [rows, columns] if rows > 0 && columns > 0 => [rows, columns],
                _ => {
                    let found: Vec<f64> = size.iter().map(|v| *v as f64).collect();
                    return Err(Rejection::wrong(tags::BLACK_SIZE, &found, "rows and columns"));
                }
            },
        };
        let cells = size[0].saturating_mul(size[1]);
        let cell = match raw.numbers(tags::BLACK_LEVEL)? {
            Some(levels) if levels.len() == cells && levels.iter().all(|v| v.is_finite()) => levels,
            Some(levels) => {
                let expected = format!("{cells} numbers, as BlackLevelRepeatDim states");
                return Err(Rejection::wrong(tags::BLACK_LEVEL, &levels, expected));
            }
            None => vec![0.0; cells.min(1)],
        };
        let size = if cell.len() == cells { size } else { [1, 1] };
        let deltas = |tag, count: usize| match raw.numbers(tag)? {
            None => Ok(vec![]),
            Some(deltas) if deltas.len() == count && deltas.iter().all(|v| v.is_finite()) => Ok(deltas),
            Some(deltas) => {
                Err(Rejection::wrong(tag, &deltas, format!("{count} numbers, the active area's size")))
            }
        };
        let (of_column, of_row) = (deltas(tags::BLACK_DELTA_H, width)?, deltas(tags::BLACK_DELTA_V, height)?);
        Ok(Self { size, cell, of_column, of_row })
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        let [rows, columns] = self.size;
        let delta = |deltas: &[f64], index: usize| deltas.get(index).copied().unwrap_or(0.0);
        self.cell[row % rows * columns + column % columns]
            + delta(&self.of_column, column)
            + delta(&self.of_row, row)
    }
}

/// The value of full light: the file's, else the largest of its bits, or 1 of floating-point numbers.
fn white(raw: &Directory<'_>, sample: Sample) -> Result<f64, Rejection> {
    if let Some(white) = raw.numbers(tags::WHITE_LEVEL)? {
        let is_level = |white: &&f64| white.is_finite();
        let expected = "a number; or state the white level";
        return white
            .first()
            .filter(is_level)
            .copied()
            .ok_or_else(|| Rejection::wrong(tags::WHITE_LEVEL, &white, expected));
    }
    let largest = raw.numbers(tags::LINEARIZATION)?.unwrap_or_default().into_iter().fold(0.0, f64::max);
    match sample {
        Sample::Float(_) => Ok(1.0),
        Sample::Whole(bits) if largest < f64::from(bits).exp2() => Ok(f64::from(bits).exp2() - 1.0),
        Sample::Whole(_) => {
            let what = "and LinearizationTable has values beyond BitsPerSample; state the white level";
            Err(Rejection::Missing { tag: tags::WHITE_LEVEL, what })
        }
    }
}

/// The light of the active area, 0 to 1: (value − black) / (white − the largest black), what is outside cut off.
///
/// # Errors
/// [`Rejection`] for levels that exclude each other.
pub fn light(
    raw: &Directory<'_>,
    values: &Array2<f32>,
    sample: Sample,
    [top, left, bottom, right]: [usize; 4],
    overrides: &Overrides,
) -> Result<Array2<f32>, Rejection> {
    let mut light = values.slice(s![top..bottom, left..right]).to_owned();
    let levels = match overrides.black {
        Some(black) => BlackLevels::stated(black),
        None => BlackLevels::of(raw, light.dim())?,
    };
    let white = overrides.white.map_or_else(|| white(raw, sample), Ok)?;
    let (height, width) = light.dim();
    let all = (0..height).flat_map(|row| (0..width).map(move |column| (row, column)));
    let black = all.map(|(row, column)| levels.at(row, column)).fold(f64::NEG_INFINITY, f64::max);
    if white.is_nan() || black >= white {
        return Err(Rejection::Levels(LevelsError::Black { black, white }));
    }
    for ((row, column), value) in light.indexed_iter_mut() {
        let share = (f64::from(*value) - levels.at(row, column)) / (white - black);
        *value = share.clamp(0.0, 1.0) as f32;
    }
    Ok(light)
}
