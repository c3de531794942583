//! The one repair of defective pixels: each becomes the median of the nearest good pixels of its colour (docs/sensor.md).

use edof_core::{CfaPhase, Channel};
use ndarray::{Array2, ArrayViewMut2};
use std::collections::BTreeMap;

/// Farthest row and column of a pixel that a repair reads: a circuit keeps so many lines above and below.
pub const REACH: usize = 4;

/// Which pixels of a mosaic are defective.
#[derive(Debug, Clone, PartialEq)]
pub struct DefectMap {
    mask: Array2<bool>,
    phase: CfaPhase,
    defects: Vec<(usize, usize)>,
}

/// Offsets of pixels of the same colour, those at one distance together, the nearest first.
type Rings = Vec<Vec<(isize, isize)>>;

impl DefectMap {
    /// Returns the map of a mask, true where a pixel is defective, for a mosaic of that phase.
    #[must_use]
    pub fn new(mask: Array2<bool>, phase: CfaPhase) -> Self {
        let defects = mask.indexed_iter().filter(|(_, is_bad)| **is_bad).map(|(at, _)| at).collect();
        Self { mask, phase, defects }
    }

    /// Returns the mask, true where a pixel is defective.
    #[must_use]
    pub const fn mask(&self) -> &Array2<bool> {
        &self.mask
    }

    /// Returns row and column of each defective pixel without a good pixel of its colour in reach, which no repair changes.
    #[must_use]
    pub fn lost(&self) -> Vec<(usize, usize)> {
        let rings = [true, false].map(rings);
        self.defects.iter().copied().filter(|at| self.nearest(*at, &rings).next().is_none()).collect()
    }

    /// Repairs a mosaic in place; `kept` makes a pixel of a median. Only good pixels are read, so the order does not matter.
    ///
    /// # Panics
    /// If the mosaic has another size than the map.
    pub fn repair<T: Copy + Into<f64>>(&self, mut mosaic: ArrayViewMut2<'_, T>, kept: impl Fn(f64) -> T) {
        assert_eq!(mosaic.dim(), self.mask.dim(), "the mosaic has another size than its map of defects");
        let (rings, mut values) = ([true, false].map(rings), vec![]);
        for at in &self.defects {
            values.clear();
            values.extend(self.nearest(*at, &rings).map(|source| mosaic[source].into()));
            if !values.is_empty() {
                mosaic[*at] = kept(median(&mut values));
            }
        }
    }

    /// Returns the good pixels of the same colour at the least distance at which there is one.
    fn nearest<'a>(
        &'a self,
        (row, column): (usize, usize),
        [green, other]: &'a [Rings; 2],
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let rings = if self.phase.channel(row, column) == Channel::Green { green } else { other };
        let good = move |&(dr, dc): &(isize, isize)| {
            let at = (row.checked_add_signed(dr)?, column.checked_add_signed(dc)?);
            self.mask.get(at).filter(|is_bad| !**is_bad).map(|_| at)
        };
        let ring = rings.iter().find(|ring| ring.iter().any(|offset| good(offset).is_some()));
        ring.into_iter().flatten().filter_map(good)
    }
}

/// Returns the median, of an even number the mean of the middle two. Exact for integers of 32 bits.
fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2])
}

/// Returns the rings within reach of a pixel that is green, or is not.
fn rings(is_green: bool) -> Rings {
    let reach = REACH as isize;
    let same = |dr: isize, dc: isize| if is_green { (dr + dc) % 2 == 0 } else { dr % 2 == 0 && dc % 2 == 0 };
    let mut rings = BTreeMap::<isize, Vec<(isize, isize)>>::new();
    for dr in -reach..=reach {
        for dc in (-reach..=reach).filter(|dc| same(dr, *dc) && (dr, *dc) != (0, 0)) {
            rings.entry(dr * dr + dc * dc).or_default().push((dr, dc));
        }
    }
    rings.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red 100, greens 200, blue 300, and a slope down the rows.
    fn mosaic() -> Array2<u16> {
        Array2::from_shape_fn((12, 10), |(r, c)| [100, 200, 200, 300][2 * (r % 2) + c % 2] + r as u16)
    }

    fn repaired(mut mosaic: Array2<u16>, bad: impl Fn(usize, usize) -> bool) -> Array2<u16> {
        let mask = Array2::from_shape_fn(mosaic.dim(), |(r, c)| bad(r, c));
        ndarray::Zip::from(&mut mosaic).and(&mask).for_each(|value, is_bad| {
            if *is_bad {
                *value = 60_000;
            }
        });
        DefectMap::new(mask, CfaPhase::Rggb).repair(mosaic.view_mut(), |v| (v + 0.5).floor() as u16);
        mosaic
    }

    #[test]
    fn a_defect_becomes_the_median_of_its_colour_on_all_sides() {
        for at in [(4, 4), (4, 5), (5, 4), (5, 5)] {
            assert_eq!(repaired(mosaic(), |r, c| (r, c) == at), mosaic(), "{at:?}");
        }
        // One bright neighbour does not move a median: of 0, 7, 9 and 5000 it is 8.
        let mut values = Array2::zeros((5, 5));
        (values[(0, 2)], values[(2, 0)], values[(2, 4)], values[(4, 2)]) = (5000, 7, 9, 0);
        assert_eq!(repaired(values, |r, c| (r, c) == (2, 2))[(2, 2)], 8);
    }

    #[test]
    fn a_dead_column_is_repaired_from_both_sides() {
        let found = repaired(mosaic(), |_, c| c == 6);
        for (row, value) in found.column(6).iter().enumerate() {
            // Green has neighbours in the rows above and below, at the border on one side.
            assert!(value.abs_diff(mosaic()[(row, 6)]) <= 1, "{row}");
        }
    }

    #[test]
    fn where_nothing_good_is_in_reach_a_defect_stays_and_is_named() {
        // A block of 9 columns and 9 rows: only the middle has no good pixel within 4 rows and columns.
        let block = |r: usize, c: usize| (2..11).contains(&r) && (2..11).contains(&c);
        let mask = Array2::from_shape_fn((14, 14), |(r, c)| block(r, c));
        let map = DefectMap::new(mask.clone(), CfaPhase::Rggb);
        assert_eq!(map.lost(), [(6, 6)]);
        let mut mosaic = mask.mapv(|is_bad| if is_bad { 60_000_u16 } else { 7 });
        map.repair(mosaic.view_mut(), |v| v as u16);
        let left = mosaic.indexed_iter().filter(|(_, v)| **v != 7).map(|(at, _)| at);
        assert_eq!(left.collect::<Vec<_>>(), [(6, 6)]);
    }
}
