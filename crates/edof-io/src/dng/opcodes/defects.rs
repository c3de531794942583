//! Defective pixels, by a list or by the value that marks them: each becomes the mean of the nearest good pixels of its colour.

use super::Units;
use super::parameters::Parameters;
use ndarray::Array2;

/// Farthest row and column of a good pixel; beyond, the defect stays.
const REACH: isize = 8;

/// Which pixels are defective.
#[derive(Debug, Clone, PartialEq)]
pub struct Defects {
    marks: Marks,
    /// Colour of the first pixel: 0 red, 1 green in a row with red, 2 green in a row with blue, 3 blue.
    phase: u32,
}

#[derive(Debug, Clone, PartialEq)]
enum Marks {
    /// Pixels of this stored number.
    Constant(u32),
    Listed {
        /// Row and column.
        points: Vec<[u32; 2]>,
        /// Top, left, bottom, right.
        rectangles: Vec<[u32; 4]>,
    },
}

impl Defects {
    /// FixBadPixelsConstant; none for wrong parameters.
    pub fn constant(parameters: Parameters<'_>) -> Option<Self> {
        let [constant, phase] = parameters.wholes()?;
        (phase < 4).then_some(Self { marks: Marks::Constant(constant), phase })
    }

    /// FixBadPixelsList; none for wrong parameters.
    pub fn list(mut parameters: Parameters<'_>) -> Option<Self> {
        let phase = parameters.whole()?;
        let counts = [parameters.whole()?, parameters.whole()?];
        let mut next = || parameters.whole();
        let mut points = vec![];
        for _ in 0..counts[0] {
            points.push([next()?, next()?]);
        }
        let mut rectangles = vec![];
        for _ in 0..counts[1] {
            rectangles.push([next()?, next()?, next()?, next()?]);
        }
        let is_possible = phase < 4 && parameters.is_empty();
        is_possible.then_some(Self { marks: Marks::Listed { points, rectangles }, phase })
    }

    /// Where a mosaic is defective.
    fn mask(&self, mosaic: &Array2<f32>, units: Units) -> Array2<bool> {
        match &self.marks {
            Marks::Constant(constant) => {
                let of_full = if units.is_whole { 1.0 } else { 65535.0 / units.full };
                mosaic.mapv(|v| (f64::from(v) * of_full).round() == f64::from(*constant))
            }
            Marks::Listed { points, rectangles } => {
                let (height, width) = mosaic.dim();
                let mut mask = Array2::from_elem((height, width), false);
                let side = |v: u32, end: usize| (v as usize).min(end);
                for &[row, column] in points {
                    if let Some(is_bad) = mask.get_mut((row as usize, column as usize)) {
                        *is_bad = true;
                    }
                }
                for &[top, left, bottom, right] in rectangles {
                    let (top, bottom) = (side(top, height), side(bottom, height));
                    let (left, right) = (side(left, width), side(right, width));
                    for row in top..bottom {
                        (left..right).for_each(|column| mask[(row, column)] = true);
                    }
                }
                mask
            }
        }
    }

    /// Whether a pixel of the image is green.
    const fn is_green(&self, row: usize, column: usize) -> bool {
        let first_is_green = self.phase == 1 || self.phase == 2;
        (row + column).is_multiple_of(2) == first_is_green
    }

    /// Repairs a mosaic in place, from good pixels alone, whatever the order of the list.
    pub fn repair(&self, mosaic: &mut Array2<f32>, units: Units) {
        let mask = self.mask(mosaic, units);
        let [green, other] = [true, false].map(neighbours);
        let repaired: Vec<_> = mask
            .indexed_iter()
            .filter(|(_, is_bad)| **is_bad)
            .filter_map(|((row, column), _)| {
                let rings = if self.is_green(row, column) { &green } else { &other };
                Some(((row, column), nearest(mosaic, &mask, (row, column), rings)?))
            })
            .collect();
        repaired.into_iter().for_each(|(at, value)| mosaic[at] = units.kept(value));
    }
}

/// Offsets of pixels of the same colour, those at one distance together, the nearest first.
fn neighbours(is_green: bool) -> Vec<Vec<(isize, isize)>> {
    let same = |dr: isize, dc: isize| if is_green { (dr + dc) % 2 == 0 } else { dr % 2 == 0 && dc % 2 == 0 };
    let mut rings = std::collections::BTreeMap::<isize, Vec<(isize, isize)>>::new();
    for dr in -REACH..=REACH {
        for dc in (-REACH..=REACH).filter(|dc| same(dr, *dc) && (dr, *dc) != (0, 0)) {
            rings.entry(dr * dr + dc * dc).or_default().push((dr, dc));
        }
    }
    rings.into_values().collect()
}

/// The mean of the good pixels at the least distance at which there is one.
fn nearest(
    mosaic: &Array2<f32>,
    mask: &Array2<bool>,
    (row, column): (usize, usize),
    rings: &[Vec<(isize, isize)>],
) -> Option<f64> {
    rings.iter().find_map(|ring| {
        let good = ring.iter().filter_map(|&(dr, dc)| {
            let at = (row.checked_add_signed(dr)?, column.checked_add_signed(dc)?);
            (!*mask.get(at)?).then(|| f64::from(mosaic[at]))
        });
        let (count, sum) = good.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
        (count > 0).then(|| sum / f64::from(count))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNITS: Units = Units { full: 65535.0, delta: 1.0, is_whole: true };

    /// Red 100, greens 200, blue 300, and a slope down the rows.
    fn mosaic() -> Array2<f32> {
        Array2::from_shape_fn((12, 10), |(r, c)| [100.0, 200.0, 200.0, 300.0][2 * (r % 2) + c % 2] + r as f32)
    }

    fn listed(points: &[[u32; 2]], rectangles: &[[u32; 4]]) -> Defects {
        let marks = Marks::Listed { points: points.to_vec(), rectangles: rectangles.to_vec() };
        Defects { marks, phase: 0 }
    }

    #[test]
    fn a_defect_becomes_the_mean_of_its_colour_on_all_sides() {
        let whole = mosaic();
        for at in [[4, 4], [4, 5], [5, 4], [5, 5]] {
            let mut damaged = whole.clone();
            damaged[[at[0] as usize, at[1] as usize]] = 60_000.0;
            listed(&[at], &[]).repair(&mut damaged, UNITS);
            assert_eq!(damaged, whole, "{at:?}");
        }
    }

    #[test]
    fn a_dead_column_is_repaired_from_both_sides_and_the_order_of_a_list_does_not_matter() {
        let whole = mosaic();
        let mut damaged = whole.clone();
        damaged.column_mut(6).fill(0.0);
        listed(&[], &[[0, 6, 12, 7]]).repair(&mut damaged, UNITS);
        for (row, value) in damaged.column(6).iter().enumerate() {
            // Green has neighbours in the rows above and below, at the border on one side.
            assert!((value - whole[(row, 6)]).abs() <= 1.0, "{row}");
        }
        let column: Vec<[u32; 2]> = (0..12).rev().map(|row| [row, 6]).collect();
        let mut again = whole;
        again.column_mut(6).fill(0.0);
        listed(&column, &[]).repair(&mut again, UNITS);
        assert_eq!(again, damaged);
    }

    #[test]
    fn marked_pixels_are_repaired_and_points_outside_are_passed_over() {
        let (whole, mut damaged) = (mosaic(), mosaic());
        damaged[(3, 7)] = 0.0;
        Defects { marks: Marks::Constant(0), phase: 0 }.repair(&mut damaged, UNITS);
        assert_eq!(damaged, whole);
        listed(&[[99, 0], [0, u32::MAX]], &[[5, 5, 2, 2], [20, 0, u32::MAX, u32::MAX]])
            .repair(&mut damaged, UNITS);
        assert_eq!(damaged, whole);
    }

    #[test]
    fn where_nothing_good_is_near_a_defect_stays() {
        let mut dead = Array2::zeros((30, 30));
        Defects { marks: Marks::Constant(0), phase: 3 }.repair(&mut dead, UNITS);
        assert!(dead.iter().all(|v| *v == 0.0));
    }
}
