//! Where the light of a kernel is, and moving it.

use ndarray::{Array2, ArrayView2};

/// Centroid of a kernel: pixels to the right of the middle pixel, and down from it.
#[must_use]
pub fn centroid(kernel: ArrayView2<f32>) -> [f64; 2] {
    let (middle_row, middle_column) = ((kernel.nrows() / 2) as f64, (kernel.ncols() / 2) as f64);
    let [mut right, mut down, mut sum] = [0.0; 3];
    for ((row, column), value) in kernel.indexed_iter() {
        let value = f64::from(*value);
        right += value * (column as f64 - middle_column);
        down += value * (row as f64 - middle_row);
        sum += value;
    }
    [right / sum, down / sum]
}

/// A square kernel of an odd side, moved by pixels to the right and down: parts of a pixel by linear interpolation, whose centroid is exact
/// and which makes no negative light. The plane grows so that no light is lost.
pub(super) fn shifted(kernel: ArrayView2<f32>, by: [f64; 2]) -> Array2<f64> {
    let margin = by[0].abs().max(by[1].abs()).ceil() as usize;
    let side = kernel.nrows() + 2 * margin;
    let mut out = Array2::zeros((side, side));
    let [columns, rows] = by.map(|pixels| taps(pixels, margin));
    for ((row, column), value) in kernel.indexed_iter() {
        for (down, row_weight) in rows {
            for (right, column_weight) in columns {
                if row_weight * column_weight > 0.0 {
                    out[(row + down, column + right)] += f64::from(*value) * row_weight * column_weight;
                }
            }
        }
    }
    out
}

/// The two pixels that a displacement falls between, counted from `-margin`, and their weights.
fn taps(pixels: f64, margin: usize) -> [(usize, f64); 2] {
    let (whole, part) = (pixels.floor(), pixels - pixels.floor());
    let first = (whole + margin as f64) as usize;
    [(first, 1.0 - part), (first + 1, part)]
}
