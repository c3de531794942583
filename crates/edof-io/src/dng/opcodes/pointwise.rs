//! Corrections of each pixel by itself: tables, polynomials, gains and offsets.

use super::Units;
use super::parameters::Parameters;
use ndarray::ArrayViewMut2;

/// Most coefficients of a polynomial, by the specification.
const MAX_DEGREE: u32 = 8;

/// A correction and where it is applied.
#[derive(Debug, Clone, PartialEq)]
pub struct Pointwise {
    area: Area,
    change: Change,
}

/// The pixels of an opcode: every `pitch`-th row and column of a rectangle, of some planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Area {
    top: usize,
    left: usize,
    bottom: usize,
    right: usize,
    first_plane: usize,
    planes: usize,
    row_pitch: usize,
    column_pitch: usize,
}

/// What becomes of a value.
#[derive(Debug, Clone, PartialEq)]
enum Change {
    /// The entry of a 65535th.
    Table(Vec<u16>),
    /// Coefficients, the constant first.
    Polynomial(Vec<f64>),
    Gain(GainMap),
    /// Added, for each row or column of the area.
    Delta(Lines),
    /// Multiplied, for each row or column of the area.
    Scale(Lines),
}

/// A number for each row, or each column.
#[derive(Debug, Clone, PartialEq)]
struct Lines {
    is_row: bool,
    values: Vec<f32>,
}

impl Lines {
    fn at(&self, row: usize, column: usize) -> f64 {
        f64::from(self.values.get(if self.is_row { row } else { column }).copied().unwrap_or_default())
    }
}

/// Gains at points of a grid over the image.
#[derive(Debug, Clone, PartialEq)]
struct GainMap {
    points: [usize; 2],
    spacing: [f64; 2],
    origin: [f64; 2],
    planes: usize,
    gains: Vec<f32>,
}

impl Area {
    fn read(parameters: &mut Parameters<'_>) -> Option<Self> {
        let mut next = || parameters.whole().map(|v| v as usize);
        let (top, left, bottom, right) = (next()?, next()?, next()?, next()?);
        let (first_plane, planes, row_pitch, column_pitch) = (next()?, next()?, next()?, next()?);
        let is_possible = top <= bottom && left <= right && row_pitch > 0 && column_pitch > 0;
        is_possible.then_some(Self { top, left, bottom, right, first_plane, planes, row_pitch, column_pitch })
    }

    const fn rows(&self) -> usize {
        (self.bottom - self.top).div_ceil(self.row_pitch)
    }

    const fn columns(&self) -> usize {
        (self.right - self.left).div_ceil(self.column_pitch)
    }

    /// Replaces each pixel by `of` its plane, the index of its row and column there, its row and column, and its value.
    fn map(
        &self,
        planes: &mut [ArrayViewMut2<'_, f32>],
        of: impl Fn(usize, [usize; 2], [usize; 2], f64) -> f32,
    ) {
        let chosen = planes.iter_mut().enumerate().skip(self.first_plane).take(self.planes);
        for (plane, image) in chosen {
            let (height, width) = image.dim();
            for (i, row) in (self.top..self.bottom.min(height)).step_by(self.row_pitch).enumerate() {
                for (j, column) in (self.left..self.right.min(width)).step_by(self.column_pitch).enumerate() {
                    let value = &mut image[(row, column)];
                    *value = of(plane, [i, j], [row, column], f64::from(*value));
                }
            }
        }
    }
}

impl GainMap {
    fn read(parameters: &mut Parameters<'_>) -> Option<Self> {
        let points = [parameters.whole()? as usize, parameters.whole()? as usize];
        let (spacing, origin) = (parameters.doubles()?, parameters.doubles()?);
        let planes = parameters.whole()? as usize;
        let count = points[0].checked_mul(points[1])?.checked_mul(planes)?;
        let is_possible = |axis: usize| points[axis] == 1 || spacing[axis] > 0.0;
        let gains = parameters.floats(count).filter(|_| count > 0 && is_possible(0) && is_possible(1))?;
        Some(Self { points, spacing, origin, planes, gains })
    }

    /// The gain of a plane at a share of the image's height and width, between points in proportion.
    fn at(&self, plane: usize, share: [f64; 2]) -> f64 {
        let place = |axis: usize| {
            let last = (self.points[axis] - 1) as f64;
            let spacing = if last > 0.0 { self.spacing[axis] } else { 1.0 };
            let place = ((share[axis] - self.origin[axis]) / spacing).clamp(0.0, last);
            (place as usize, (place as usize + 1).min(self.points[axis] - 1), place.fract())
        };
        let [(above, below, down), (left, right, across)] = [place(0), place(1)];
        let plane = plane.min(self.planes - 1);
        let gain = |row: usize, column: usize| {
            f64::from(self.gains[(row * self.points[1] + column) * self.planes + plane])
        };
        let line = |row: usize| gain(row, left) * (1.0 - across) + gain(row, right) * across;
        line(above) * (1.0 - down) + line(below) * down
    }
}

impl Pointwise {
    /// Of identifiers 7 to 13; none for wrong parameters.
    pub fn read(id: u32, mut parameters: Parameters<'_>) -> Option<Self> {
        let area = Area::read(&mut parameters)?;
        let mut lines = |is_row: bool| {
            let count = parameters.whole()? as usize;
            let needed = if is_row { area.rows() } else { area.columns() };
            let values = parameters.floats(count).filter(|_| count == needed)?;
            Some(Lines { is_row, values })
        };
        let change = match id {
            7 => {
                let count = parameters.whole()?;
                Change::Table(parameters.words(count as usize).filter(|table| !table.is_empty())?)
            }
            8 => {
                let degree = parameters.whole().filter(|degree| *degree <= MAX_DEGREE)?;
                Change::Polynomial((0..=degree).map(|_| parameters.double()).collect::<Option<_>>()?)
            }
            9 => Change::Gain(GainMap::read(&mut parameters)?),
            10 => Change::Delta(lines(true)?),
            11 => Change::Delta(lines(false)?),
            12 => Change::Scale(lines(true)?),
            _ => Change::Scale(lines(false)?),
        };
        parameters.is_empty().then_some(Self { area, change })
    }

    /// Corrects planes of equal size in place. Values stay between 0 and full.
    pub fn apply(&self, planes: &mut [ArrayViewMut2<'_, f32>], units: Units) {
        let Some((height, width)) = planes.first().map(ArrayViewMut2::dim) else { return };
        let word = units.full / 65535.0;
        let entry = |table: &[u16], value: f64| {
            let index = ((value / word).round() as usize).min(table.len() - 1);
            f64::from(table[index]) * word
        };
        let share = |[row, column]: [usize; 2]| {
            [(row as f64 + 0.5) / height as f64, (column as f64 + 0.5) / width as f64]
        };
        self.area.map(planes, |plane, [i, j], at, value| {
            let changed = match &self.change {
                Change::Table(table) => entry(table, value),
                Change::Polynomial(of) => of.iter().rev().fold(0.0, |sum, c| sum * value + c),
                Change::Gain(map) => value * map.at(plane, share(at)),
                Change::Delta(lines) => value + lines.at(i, j) * units.delta,
                Change::Scale(lines) => value * lines.at(i, j),
            };
            units.kept(changed)
        });
    }
}
