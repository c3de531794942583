//! Planes of another size.

use ndarray::{Array2, ArrayView2};

/// A plane of `size` rows and columns that shows the same, by a triangular filter as wide as the coarser of the two grids: linear
/// interpolation up, an average without aliasing down.
pub(crate) fn resized(plane: ArrayView2<'_, f32>, size: (usize, usize)) -> Array2<f32> {
    let wide = rows_resized(plane.t(), size.1);
    rows_resized(wide.t(), size.0)
}

/// Another number of rows.
fn rows_resized(plane: ArrayView2<'_, f32>, rows: usize) -> Array2<f32> {
    let from = plane.nrows();
    let ratio = from as f32 / rows as f32;
    let reach = ratio.max(1.0);
    let mut out = Array2::zeros((rows, plane.ncols()));
    for (row, mut to) in out.outer_iter_mut().enumerate() {
        let middle = (row as f32 + 0.5) * ratio - 0.5;
        let first = (middle - reach).ceil() as isize;
        let last = (middle + reach).floor() as isize;
        let mut total = 0.0;
        for at in first..=last {
            let weight = 1.0 - (at as f32 - middle).abs() / reach;
            to.scaled_add(weight, &plane.row(at.clamp(0, from as isize - 1) as usize));
            total += weight;
        }
        to /= total;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_stays_a_ramp_up_and_down() {
        let ramp = Array2::from_shape_fn((40, 60), |(r, c)| 0.01 * r as f32 + 0.005 * c as f32);
        for size in [(28, 42), (57, 85), (40, 60)] {
            let out = resized(ramp.view(), size);
            for ((r, c), &v) in out.slice(ndarray::s![4..size.0 - 4, 4..size.1 - 4]).indexed_iter() {
                let at = |i: usize, n: usize, m: usize| (i as f32 + 4.5) * n as f32 / m as f32 - 0.5;
                let exact = 0.01 * at(r, 40, size.0) + 0.005 * at(c, 60, size.1);
                assert!((v - exact).abs() < 1e-3, "{size:?} {r} {c}");
            }
        }
    }
}
