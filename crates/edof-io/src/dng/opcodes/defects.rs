//! Defective pixels, by a list or by the value that marks them; [`crate::sensor::defects`] repairs them.
//!
//! The opcodes have a number for the phase of the mosaic, too. It is not used: the specification numbers the phases otherwise than Adobe's
//! SDK and Android do. The file's pattern states the same.

use super::Units;
use super::parameters::Parameters;
use crate::sensor::defects::DefectMap;
use edof_core::CfaPhase;
use ndarray::Array2;

/// Which pixels are defective.
#[derive(Debug, Clone, PartialEq)]
pub enum Defects {
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
        let [constant, _phase] = parameters.wholes()?;
        Some(Self::Constant(constant))
    }

    /// FixBadPixelsList; none for wrong parameters.
    pub fn list(mut parameters: Parameters<'_>) -> Option<Self> {
        let [_phase, counts @ ..] = [parameters.whole()?, parameters.whole()?, parameters.whole()?];
        let mut next = || parameters.whole();
        let mut points = vec![];
        for _ in 0..counts[0] {
            points.push([next()?, next()?]);
        }
        let mut rectangles = vec![];
        for _ in 0..counts[1] {
            rectangles.push([next()?, next()?, next()?, next()?]);
        }
        parameters.is_empty().then_some(Self::Listed { points, rectangles })
    }

    /// Where a mosaic is defective.
    fn mask(&self, mosaic: &Array2<f32>, units: Units) -> Array2<bool> {
        match self {
            Self::Constant(constant) => {
                let of_full = if units.is_whole { 1.0 } else { 65535.0 / units.full };
                mosaic.mapv(|v| (f64::from(v) * of_full).round() == f64::from(*constant))
            }
            Self::Listed { points, rectangles } => {
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

    /// Repairs a mosaic in place, from good pixels alone, whatever the order of the list.
    pub fn repair(&self, mosaic: &mut Array2<f32>, phase: CfaPhase, units: Units) {
        let map = DefectMap::new(self.mask(mosaic, units), phase);
        map.repair(mosaic.view_mut(), |median| units.kept(median));
    }
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
        Defects::Listed { points: points.to_vec(), rectangles: rectangles.to_vec() }
    }

    #[test]
    fn a_dead_column_is_repaired_from_both_sides_and_the_order_of_a_list_does_not_matter() {
        let whole = mosaic();
        let mut damaged = whole.clone();
        damaged.column_mut(6).fill(0.0);
        listed(&[], &[[0, 6, 12, 7]]).repair(&mut damaged, CfaPhase::Rggb, UNITS);
        for (row, value) in damaged.column(6).iter().enumerate() {
            // Green has neighbours in the rows above and below, at the border on one side.
            assert!((value - whole[(row, 6)]).abs() <= 1.0, "{row}");
        }
        let column: Vec<[u32; 2]> = (0..12).rev().map(|row| [row, 6]).collect();
        let mut again = whole;
        again.column_mut(6).fill(0.0);
        listed(&column, &[]).repair(&mut again, CfaPhase::Rggb, UNITS);
        assert_eq!(again, damaged);
    }

    #[test]
    fn marked_pixels_are_repaired_and_points_outside_are_passed_over() {
        let (whole, mut damaged) = (mosaic(), mosaic());
        damaged[(3, 7)] = 0.0;
        Defects::Constant(0).repair(&mut damaged, CfaPhase::Rggb, UNITS);
        assert_eq!(damaged, whole);
        listed(&[[99, 0], [0, u32::MAX]], &[[5, 5, 2, 2], [20, 0, u32::MAX, u32::MAX]]).repair(
            &mut damaged,
            CfaPhase::Rggb,
            UNITS,
        );
        assert_eq!(damaged, whole);
    }
}
