//! Depth maps of range finders: distances in steps of a unit of length, with pixels that have no reading.

use ndarray::Array2;
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

/// Length of one step of a depth map's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    metres: f64,
}

/// Text that names no unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unit '{0}': must be mm, cm or m, or a multiple such as 0.2mm")]
pub struct UnitError(String);

impl Unit {
    /// Returns the distance in metres that a value stands for.
    #[must_use]
    pub fn metres(self, value: u16) -> f64 {
        f64::from(value) * self.metres
    }
}

/// Names of units, longest first, and how many of each are a metre.
const NAMES: [(&str, f64); 3] = [("mm", 1000.0), ("cm", 100.0), ("m", 1.0)];

impl FromStr for Unit {
    type Err = UnitError;

    fn from_str(text: &str) -> Result<Self, UnitError> {
        let parse = |(name, per_metre): &(&str, f64)| {
            let factor = text.strip_suffix(name)?;
            let factor = if factor.is_empty() { Some(1.0) } else { factor.parse().ok() };
            factor.filter(|factor: &f64| *factor > 0.0 && factor.is_finite()).map(|f| f / per_metre)
        };
        let metres = NAMES.iter().find_map(parse);
        metres.map(|metres| Self { metres }).ok_or_else(|| UnitError(text.to_owned()))
    }
}

impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let per_metre = NAMES[0].1;
        match self.metres * per_metre {
            1.0 => f.write_str("mm"),
            factor => write!(f, "{factor}mm"),
        }
    }
}

/// Returns whether a value is a distance. Range finders write 0 where they measured nothing, some of them 65535.
#[must_use]
pub const fn is_reading(value: u16) -> bool {
    value != 0 && value != u16::MAX
}

/// A depth map without holes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Filled {
    /// Values of all pixels.
    pub map: Array2<u16>,
    /// Number of pixels that had no reading.
    pub holes: usize,
}

/// Fills the holes of a map: each has the value of the nearest reading, in steps along rows and columns. The largest of several that are
/// equally near is taken, because holes are mostly behind a near object. Returns none for a map without any reading.
///
/// ```
/// use edof_optics::depth_map::fill;
/// let filled = fill(ndarray::array![[500, 0, 0, 900], [500, 0, 800, 900]]).unwrap();
/// assert_eq!(filled.map, ndarray::array![[500, 500, 900, 900], [500, 800, 800, 900]]);
/// assert_eq!(filled.holes, 3);
/// ```
#[must_use]
pub fn fill(mut map: Array2<u16>) -> Option<Filled> {
    let holes = map.iter().filter(|value| !is_reading(**value)).count();
    if holes == map.len() {
        return None;
    }
    // Steps from the nearest reading, where they are known.
    let mut steps = map.mapv(|value| if is_reading(value) { 0 } else { u32::MAX });
    let mut edge: Vec<(usize, usize)> =
        map.indexed_iter().filter(|(_, value)| is_reading(**value)).map(|(at, _)| at).collect();
    for step in 1.. {
        let mut next = vec![];
        for at in edge {
            for neighbour in neighbours(at, map.dim()) {
                if steps[neighbour] == u32::MAX {
                    (steps[neighbour], map[neighbour]) = (step, map[at]);
                    next.push(neighbour);
                } else if steps[neighbour] == step {
                    map[neighbour] = map[neighbour].max(map[at]);
                }
            }
        }
        if next.is_empty() {
            break;
        }
        edge = next;
    }
    Some(Filled { map, holes })
}

/// Pixels above, below, left and right.
fn neighbours(
    (row, column): (usize, usize),
    (height, width): (usize, usize),
) -> impl Iterator<Item = (usize, usize)> {
    let rows = [row.checked_sub(1), (row + 1 < height).then_some(row + 1)];
    let columns = [column.checked_sub(1), (column + 1 < width).then_some(column + 1)];
    let vertical = rows.into_iter().flatten().map(move |row| (row, column));
    vertical.chain(columns.into_iter().flatten().map(move |column| (row, column)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn units_are_lengths() {
        for (text, metres) in [("mm", 2.0), ("cm", 20.0), ("m", 2000.0), ("0.2mm", 0.4), ("0.1cm", 2.0)] {
            let unit: Unit = text.parse().unwrap();
            assert!((unit.metres(2000) - metres).abs() < 1e-9, "{text}");
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
        for text in ["", "1", "km", "-1mm", "0mm", "nanmm", "infm", "m m", "MM"] {
            let error = text.parse::<Unit>().unwrap_err().to_string();
            assert_eq!(error, format!("unit '{text}': must be mm, cm or m, or a multiple such as 0.2mm"));
        }
    }

    #[test]
    fn a_map_of_holes_alone_is_none() {
        assert_eq!(fill(ndarray::array![[0, u16::MAX], [0, 0]]), None);
        let whole = ndarray::array![[1, 2], [3, 65534]];
        assert_eq!(fill(whole.clone()), Some(Filled { map: whole, holes: 0 }));
    }

    proptest! {
        #[test]
        fn each_hole_has_the_farthest_of_its_nearest_readings(
            values in prop::collection::vec(prop_oneof![3 => Just(0u16), 1 => 1u16..5, 1 => Just(u16::MAX)], 48),
        ) {
            let map = Array2::from_shape_vec((6, 8), values).unwrap();
            let readings: Vec<_> = map.indexed_iter().filter(|(_, v)| is_reading(**v)).collect();
            let Some(filled) = fill(map.clone()) else {
                prop_assert!(readings.is_empty());
                return Ok(());
            };
            prop_assert_eq!(filled.holes, 48 - readings.len());
            for ((r, c), value) in filled.map.indexed_iter() {
                let steps = |&((row, column), _): &((usize, usize), &u16)| row.abs_diff(r) + column.abs_diff(c);
                let nearest = readings.iter().map(steps).min().unwrap();
                let expected = readings.iter().filter(|reading| steps(reading) == nearest).map(|(_, v)| **v).max();
                prop_assert_eq!(Some(*value), expected);
            }
        }
    }
}
