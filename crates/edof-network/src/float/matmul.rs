//! Matrix products on row-major slices: a safe face for the `gemm` crate.

use crate::float::real::Real;

/// A row-major matrix that may be read transposed.
#[derive(Debug, Clone, Copy)]
pub struct Mat<'a, T = f32> {
    values: &'a [T],
    rows: usize,
    columns: usize,
    row_stride: usize,
    column_stride: usize,
}

impl<'a, T> Mat<'a, T> {
    /// Returns a `rows`×`columns` matrix over the first rows·columns numbers of `values`.
    ///
    /// # Panics
    /// If `values` is too short: a mistake of the caller, never of its input.
    #[must_use]
    pub fn new(values: &'a [T], rows: usize, columns: usize) -> Self {
        Self {
            values: &values[..length(rows, columns)],
            rows,
            columns,
            row_stride: columns,
            column_stride: 1,
        }
    }

    /// Rows of the matrix.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The transposed matrix over the same numbers.
    #[must_use]
    pub const fn t(self) -> Self {
        Self {
            values: self.values,
            rows: self.columns,
            columns: self.rows,
            row_stride: self.column_stride,
            column_stride: self.row_stride,
        }
    }
}

/// Numbers of a `rows`×`columns` matrix.
///
/// # Panics
/// If the count overflows: then no slice is as long, and a wrapped count would let a short one pass.
fn length(rows: usize, columns: usize) -> usize {
    let count = rows.checked_mul(columns);
    count.unwrap_or_else(|| panic!("a matrix of {rows} x {columns} numbers is larger than memory"))
}

/// What becomes of the numbers that a product's destination holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destination {
    /// `out = a·b`.
    Replace,
    /// `out += a·b`.
    Accumulate,
}

/// `out` (row-major, a.rows × b.columns) becomes, or grows by, a·b.
///
/// # Panics
/// If the inner sides differ or `out` is too short: a mistake of the caller, never of its input.
pub fn product<T: Real>(out: &mut [T], destination: Destination, a: Mat<'_, T>, b: Mat<'_, T>) {
    assert_eq!(a.columns, b.rows, "inner sides differ");
    let out = &mut out[..length(a.rows, b.columns)];
    let add = destination == Destination::Accumulate;
    // SAFETY: `Mat` holds exactly rows·columns numbers and its strides address each of them once; `out` was just cut to
    // a.rows·b.columns numbers and is not shared.
    unsafe {
        gemm::gemm(
            a.rows,
            b.columns,
            a.columns,
            out.as_mut_ptr(),
            1,
            b.columns as isize,
            add,
            a.values.as_ptr(),
            a.column_stride as isize,
            a.row_stride as isize,
            b.values.as_ptr(),
            b.column_stride as isize,
            b.row_stride as isize,
            T::one(),
            T::one(),
            false,
            false,
            false,
            gemm::Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The product as its definition reads.
    fn plain(a: Mat<'_>, b: Mat<'_>) -> Vec<f32> {
        let at = |m: Mat<'_>, r: usize, c: usize| m.values[r * m.row_stride + c * m.column_stride];
        (0..a.rows)
            .flat_map(|r| {
                (0..b.columns).map(move |c| (0..a.columns).map(|i| at(a, r, i) * at(b, i, c)).sum())
            })
            .collect()
    }

    #[test]
    #[should_panic(expected = "larger than memory")]
    fn a_matrix_whose_size_overflows_is_rejected() {
        let _ = Mat::new(&[0.0f32; 4], usize::MAX / 2 + 1, 2);
    }

    #[test]
    #[should_panic(expected = "out of range")]
    fn a_matrix_of_too_few_numbers_is_rejected() {
        let _ = Mat::new(&[0.0f32; 5], 2, 3);
    }

    #[test]
    #[should_panic(expected = "inner sides differ")]
    fn a_product_of_unequal_inner_sides_is_rejected() {
        let values = [1.0f32; 6];
        product(&mut [0.0; 9], Destination::Replace, Mat::new(&values, 2, 3), Mat::new(&values, 2, 3));
    }

    #[test]
    #[should_panic(expected = "out of range")]
    fn a_product_into_too_few_numbers_is_rejected() {
        let values = [1.0f32; 6];
        product(&mut [0.0; 3], Destination::Replace, Mat::new(&values, 2, 3), Mat::new(&values, 3, 2));
    }

    /// Both factors are matrices without numbers, whose sides multiply to more than memory holds.
    #[test]
    #[should_panic(expected = "larger than memory")]
    fn a_product_whose_size_overflows_is_rejected() {
        let none = [0.0f32; 0];
        let (tall, wide) = (Mat::new(&none, usize::MAX / 2 + 1, 0), Mat::new(&none, 0, 2));
        product(&mut [0.0; 4], Destination::Replace, tall, wide);
    }

    proptest! {
        #[test]
        fn products_equal_their_definition(
            m in 1usize..40, k in 1usize..40, n in 1usize..40, ta: bool, tb: bool, seed in 0u32..1000
        ) {
            let noise = |length: usize, salt: u32| -> Vec<f32> {
                (0..length as u32).map(|i| ((i + salt + seed) * 7919 % 1013) as f32 / 500.0 - 1.0).collect()
            };
            let (va, vb) = (noise(m * k, 0), noise(k * n, 77));
            let a = if ta { Mat::new(&va, k, m).t() } else { Mat::new(&va, m, k) };
            let b = if tb { Mat::new(&vb, n, k).t() } else { Mat::new(&vb, k, n) };
            let expected = plain(a, b);
            let mut out = vec![1.0; m * n];
            product(&mut out, Destination::Accumulate, a, b);
            for (x, y) in out.iter().zip(&expected) { prop_assert!((x - 1.0 - y).abs() < 1e-4); }
            product(&mut out, Destination::Replace, a, b);
            for (x, y) in out.iter().zip(&expected) { prop_assert!((x - y).abs() < 1e-4); }
        }
    }
}
