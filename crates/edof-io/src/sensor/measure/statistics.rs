//! Robust numbers of frames: medians, spreads, means without outliers, and what is usual around a pixel.

use ndarray::Array2;

/// From the median of absolute deviations to the standard deviation of a Gaussian.
const GAUSSIAN: f64 = 1.4826;
/// Deviations, in robust standard deviations, that belong to a mean.
const CLIP: f64 = 6.0;
/// Nearest pixels of one place either way whose median is usual there.
const AROUND: isize = 2;

/// Returns the median of finite numbers; 0 of none. Of an even number it is the upper one of the middle two.
pub fn median(mut values: Vec<f32>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    f64::from(*values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Returns the standard deviation of most of the numbers, by the median of their distances from `middle`.
pub fn spread(values: impl Iterator<Item = f32>, middle: f64) -> f64 {
    GAUSSIAN * median(values.map(|value| (f64::from(value) - middle).abs() as f32).collect())
}

/// A mean of most of the numbers, and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Centre {
    pub mean: f64,
    pub error: f64,
}

impl Centre {
    /// Returns the mean of the numbers within six robust standard deviations, at least `least`, of their median.
    pub fn of(values: &[f32], least: f64) -> Self {
        let middle = median(values.to_vec());
        let reach = CLIP * spread(values.iter().copied(), middle).max(least);
        let near =
            values.iter().map(|value| f64::from(*value)).filter(|value| (value - middle).abs() <= reach);
        let (count, sum, squares) = near.fold((0.0, 0.0, 0.0), |(count, sum, squares), value| {
            let off = value - middle;
            (count + 1.0, sum + off, squares + off * off)
        });
        let count = f64::max(count, 1.0);
        let variance = (squares / count - (sum / count).powi(2)).max(least * least);
        Self { mean: middle + sum / count, error: (variance / count).sqrt() }
    }
}

/// Returns for each pixel the median of the 25 nearest pixels of its place in the cell, itself among them; fewer at the border.
pub fn usual(frame: &Array2<f32>) -> Array2<f32> {
    let mut around = vec![];
    Array2::from_shape_fn(frame.dim(), |(row, column)| {
        around.clear();
        for dr in -AROUND..=AROUND {
            for dc in -AROUND..=AROUND {
                let at = row.checked_add_signed(2 * dr).zip(column.checked_add_signed(2 * dc));
                around.extend(at.and_then(|at| frame.get(at)));
            }
        }
        let middle = around.len() / 2;
        *around.select_nth_unstable_by(middle, f32::total_cmp).1
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_outliers_move_neither_centre_nor_spread() {
        // Evenly from 0 to 1, and one in a hundred far off.
        let values: Vec<f32> =
            (0..1000).map(|i| if i % 100 == 7 { 9e4 } else { (i % 100) as f32 / 99.0 }).collect();
        let centre = Centre::of(&values, 1e-3);
        assert!(
            (centre.mean - 0.5).abs() < 0.01 && (centre.error - 0.29 / 990f64.sqrt()).abs() < 1e-3,
            "{centre:?}"
        );
        // Half of the deviations of an even spread of width 1 are below a quarter.
        assert!((spread(values.into_iter(), 0.5) - GAUSSIAN / 4.0).abs() < 0.02);
    }

    #[test]
    fn what_is_usual_follows_a_slope_of_one_place_and_no_outlier() {
        let mut frame = Array2::from_shape_fn((20, 24), |(r, c)| (r + 100 * (r % 2) + 1000 * (c % 2)) as f32);
        let slope = frame.clone();
        (frame[(9, 9)], frame[(9, 11)]) = (-5e4, 7e4);
        let found = usual(&frame);
        for at in [(9, 9), (9, 11), (10, 10), (8, 7)] {
            assert_eq!(found[at], slope[at], "{at:?}");
        }
    }
}
