//! Which part of a photograph is kept for validation: the block of a quarter of each side in one corner.
//!
//! The blur carries light as far as the PSF's kernel reaches. So a training window keeps at least the largest kernel radius of
//! the run away from the block: a band of that many rows and columns lies between them, which neither is cut from. Hence no
//! pixel that a training window's blur saw lies in a validation window (nor in its patch), and no pixel that a validation
//! window's blur saw lies in a training window. Mirrored borders change nothing: what is mirrored lies no farther away than
//! what it stands for.

use edof_numerics::random::Random;

/// Share of each side that the validation block takes.
const SHARE: usize = 4;

/// The validation block of one photograph, or of a smaller copy of it, and what training keeps away from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Holdout {
    height: usize,
    width: usize,
    /// Rows and columns of the block.
    block: (usize, usize),
    /// Whether the block lies at the last rows, at the last columns.
    at_end: (bool, bool),
    /// Rows and columns around the block from which nothing is cut.
    guard: usize,
}

impl Holdout {
    /// The block of the photograph with this place in the list, of these sides; blurs reach `guard` pixels.
    #[must_use]
    pub const fn new(height: usize, width: usize, index: usize, guard: usize) -> Self {
        let block = (height / SHARE, width / SHARE);
        Self { height, width, block, at_end: (index & 1 != 0, index & 2 != 0), guard }
    }

    /// The same part of a copy reduced to these sides. What the pixels at the block's edge were averaged from counts as the block's.
    #[must_use]
    pub const fn reduced(&self, height: usize, width: usize) -> Self {
        let rows = (self.block.0 * height).div_ceil(self.height) + 1;
        let columns = (self.block.1 * width).div_ceil(self.width) + 1;
        Self { height, width, block: (rows, columns), ..*self }
    }

    /// A side with which a photograph is always large enough for windows of `side` pixels.
    #[must_use]
    pub const fn min_side(side: usize, guard: usize) -> usize {
        let beside = (SHARE * (guard + side)).div_ceil(SHARE - 1);
        if beside > SHARE * side { beside } else { SHARE * side }
    }

    /// Whether windows of `side` pixels fit both into the block and beside it.
    #[must_use]
    pub const fn fits(&self, side: usize) -> bool {
        let block_fits = self.block.0 >= side && self.block.1 >= side;
        let free = (self.height - self.block.0, self.width - self.block.1);
        block_fits && (free.0 >= self.guard + side || free.1 >= self.guard + side)
    }

    /// Corner of a random window of `side` pixels for training. Windows must fit.
    pub fn training(&self, random: &mut Random, side: usize) -> (usize, usize) {
        loop {
            let corner = (random.below(self.height - side + 1), random.below(self.width - side + 1));
            if self.distance(corner, side) >= self.guard {
                return corner;
            }
        }
    }

    /// Corner of a random window of `side` pixels for validation. Windows must fit.
    pub fn validation(&self, random: &mut Random, side: usize) -> (usize, usize) {
        let [rows, columns] = self.starts();
        let (free_rows, free_columns) = (self.block.0 - side + 1, self.block.1 - side + 1);
        (rows + random.below(free_rows), columns + random.below(free_columns))
    }

    /// First row and column of the block.
    const fn starts(&self) -> [usize; 2] {
        [
            if self.at_end.0 { self.height - self.block.0 } else { 0 },
            if self.at_end.1 { self.width - self.block.1 } else { 0 },
        ]
    }

    /// Rows, or columns if those are more, that lie between the block and a window.
    fn distance(&self, (row, column): (usize, usize), side: usize) -> usize {
        let [rows, columns] = self.starts();
        let between = |window: usize, block: usize, length: usize| {
            window.saturating_sub(block + length).max(block.saturating_sub(window + side))
        };
        between(row, rows, self.block.0).max(between(column, columns, self.block.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::Camera;
    use edof_optics::psf::{Settings, channel_psfs};
    use ndarray::Array2;
    use proptest::prelude::*;

    /// Marks what a window's blur saw: its pixels and all that lie as far as the kernel reaches, mirrored at the borders.
    fn seen(size: (usize, usize), (row, column): (usize, usize), side: usize, reach: usize) -> Array2<bool> {
        let mut seen = Array2::from_elem(size, false);
        let around = |start: usize, n: usize| {
            let (first, last) = (start as isize - reach as isize, (start + side + reach) as isize);
            (first..last).map(move |i| edof_core::geometry::mirror(i, n))
        };
        for r in around(row, size.0) {
            around(column, size.1).for_each(|c| seen[(r, c)] = true);
        }
        seen
    }

    fn touches(seen: &Array2<bool>, (row, column): (usize, usize), side: usize) -> bool {
        (row..row + side).any(|r| (column..column + side).any(|c| seen[(r, c)]))
    }

    #[test]
    fn blur_does_not_leak_between_training_and_validation() {
        for (index, name) in ["clear", "ring-2018", "ring-outer", "clear-mid"].iter().enumerate() {
            let camera = Camera::resolve(name).unwrap();
            let psfs = [camera.psi_range[0], camera.psi_range[1]]
                .map(|psi| channel_psfs(&camera, psi, &Settings::default()).unwrap());
            let reach = psfs.iter().flatten().map(|psf| psf.side() / 2).max().unwrap();
            let (size, side) = ((512, 768), 12);
            let holdout = Holdout::new(size.0, size.1, index, reach);
            assert!(reach > 0 && holdout.fits(side), "{name}: a blur of {reach} pixels");
            let mut random = Random::new(3, index as u64, 0);
            for _ in 0..40 {
                let (training, validation) =
                    (holdout.training(&mut random, side), holdout.validation(&mut random, side));
                assert!(!touches(&seen(size, training, side, reach), validation, side));
                assert!(!touches(&seen(size, validation, side, reach), training, side));
            }
        }
    }

    proptest! {
        #[test]
        fn windows_keep_the_distance_and_come_as_close_as_they_may(
            height in 100usize..200, width in 100usize..200, index in 0usize..8, guard in 0usize..40, percent in 40usize..=100
        ) {
            let side = 8;
            let whole = Holdout::new(height, width, index, guard);
            let copy = whole.reduced(height * percent / 100, width * percent / 100);
            for part in [whole, copy] {
                prop_assume!(part.fits(side));
                let mut random = Random::new(1, 0, 0);
                let mut closest = usize::MAX;
                for _ in 0..2000 {
                    let corner = part.training(&mut random, side);
                    prop_assert!(corner.0 + side <= part.height && corner.1 + side <= part.width);
                    closest = closest.min(part.distance(corner, side));
                    let corner = part.validation(&mut random, side);
                    prop_assert_eq!(part.distance(corner, side), 0);
                    let [top, left] = part.starts();
                    prop_assert!(corner.0 >= top && corner.0 + side <= top + part.block.0);
                    prop_assert!(corner.1 >= left && corner.1 + side <= left + part.block.1);
                }
                prop_assert!(closest >= guard && closest <= guard + 3, "{closest} for {guard}");
            }
        }

        #[test]
        fn the_least_side_is_large_enough_and_not_by_much(side in 8usize..16, guard in 0usize..200) {
            let min = Holdout::min_side(side, guard);
            prop_assert!(Holdout::new(min, min, 0, guard).fits(side));
            prop_assert!(!Holdout::new(min - 4, min - 4, 0, guard).fits(side));
        }

        #[test]
        fn a_reduced_copy_keeps_at_least_the_same_part(
            height in 60usize..300, width in 60usize..300, index in 0usize..4, percent in 20usize..=100
        ) {
            let whole = Holdout::new(height, width, index, 0);
            let (h, w) = (height * percent / 100, width * percent / 100);
            let copy = whole.reduced(h, w);
            let [[top, left], [small_top, small_left]] = [whole.starts(), copy.starts()];
            // In units of 1/(h·height), so that nothing is rounded.
            let covers = |start: usize, length: usize, small_start: usize, small: usize, n: usize, m: usize| {
                small_start * n <= start * m && (small_start + small) * n >= (start + length) * m
            };
            prop_assert!(covers(top, whole.block.0, small_top, copy.block.0, height, h));
            prop_assert!(covers(left, whole.block.1, small_left, copy.block.1, width, w));
        }
    }
}
