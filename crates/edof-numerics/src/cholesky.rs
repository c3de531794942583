//! Cholesky factors of symmetric positive definite matrices.

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

/// A matrix that is not a covariance.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("covariance: not positive definite at row {0}")]
pub struct NotPositive(pub usize);

/// The lower factor L of A = L·Lᵀ.
#[derive(Debug, Clone)]
pub struct Cholesky(Array2<f64>);

impl Cholesky {
    /// Factors a symmetric matrix; only its lower half is read.
    ///
    /// # Errors
    /// [`NotPositive`]; also for a matrix that is not finite.
    pub fn new(matrix: ArrayView2<'_, f64>) -> Result<Self, NotPositive> {
        Self::factor(matrix, 0.0)
    }

    /// Factors moments, which are positive except for rounding: pivots below 1e-12 of the largest diagonal element are lifted to it.
    ///
    /// # Panics
    /// If the moments are not finite: a mistake of the caller.
    #[must_use]
    pub fn of_moments(matrix: ArrayView2<'_, f64>) -> Self {
        let min = (1e-12 * matrix.diag().iter().copied().fold(0.0, f64::max)).max(f64::MIN_POSITIVE);
        match Self::factor(matrix, min) {
            Ok(factor) => factor,
            Err(NotPositive(row)) => panic!("moments are not finite at row {row}"),
        }
    }

    /// Row by row (Cholesky and Banachiewicz). Pivots below `min` are lifted to it.
    fn factor(matrix: ArrayView2<'_, f64>, min: f64) -> Result<Self, NotPositive> {
        let n = matrix.nrows();
        let mut l = Array2::<f64>::zeros((n, n));
        for i in 0..n {
            let (above, mut rest) = l.view_mut().split_at(Axis(0), i);
            let mut row = rest.row_mut(0);
            for (j, known) in above.outer_iter().enumerate() {
                let sum = row.slice(s![..j]).dot(&known.slice(s![..j]));
                row[j] = (matrix[(i, j)] - sum) / known[j];
            }
            let left = row.slice(s![..i]);
            let pivot = matrix[(i, i)] - left.dot(&left);
            let pivot = if pivot < min { min } else { pivot };
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(NotPositive(i));
            }
            row[i] = pivot.sqrt();
        }
        Ok(Self(l))
    }

    /// The factor of A's first `n` rows and columns alone.
    #[must_use]
    pub fn leading(&self, n: usize) -> Self {
        Self(self.0.slice(s![..n, ..n]).to_owned())
    }

    /// L, with zeros above its diagonal.
    #[must_use]
    pub const fn lower(&self) -> &Array2<f64> {
        &self.0
    }

    /// L⁻¹: it whitens what has the moments A.
    #[must_use]
    pub fn whitening(&self) -> Array2<f64> {
        let mut inverse = Array2::eye(self.0.nrows());
        self.solve_lower(&mut inverse);
        inverse
    }

    /// X of A·X = B, all columns of B at once.
    #[must_use]
    pub fn solve(&self, b: ArrayView2<'_, f64>) -> Array2<f64> {
        let mut x = b.to_owned();
        self.solve_lower(&mut x);
        self.solve_upper(&mut x);
        x
    }

    /// X of L·X = B, in place.
    fn solve_lower(&self, b: &mut Array2<f64>) {
        for (i, line) in self.0.outer_iter().enumerate() {
            let (above, mut rest) = b.view_mut().split_at(Axis(0), i);
            let known: Array1<f64> = line.slice(s![..i]).dot(&above);
            let mut row = rest.row_mut(0);
            row -= &known;
            row /= line[i];
        }
    }

    /// X of Lᵀ·X = B, in place.
    fn solve_upper(&self, b: &mut Array2<f64>) {
        for i in (0..self.0.nrows()).rev() {
            let column = self.0.column(i);
            let (mut upper, below) = b.view_mut().split_at(Axis(0), i + 1);
            let known: Array1<f64> = column.slice(s![i + 1..]).dot(&below);
            let mut row = upper.row_mut(i);
            row -= &known;
            row /= column[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gram(values: Vec<f64>, n: usize) -> Array2<f64> {
        let root = Array2::from_shape_vec((n, n), values).unwrap();
        root.dot(&root.t())
    }

    fn near(a: &Array2<f64>, b: &Array2<f64>) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    proptest! {
        #[test]
        fn factors_multiply_back_and_solve(values in prop::collection::vec(-1.0f64..1.0, 81)) {
            let matrix = gram(values, 9) + Array2::<f64>::eye(9);
            let factor = Cholesky::new(matrix.view()).unwrap();
            let l = factor.lower();
            prop_assert!(near(&l.dot(&l.t()), &matrix));
            prop_assert!(near(&factor.whitening().dot(l), &Array2::eye(9)));
            let b = Array2::from_shape_fn((9, 4), |(r, c)| (r + 2 * c) as f64);
            prop_assert!(near(&matrix.dot(&factor.solve(b.view())), &b));
            let part = factor.leading(5);
            let part = part.lower();
            prop_assert!(near(&part.dot(&part.t()), &matrix.slice(ndarray::s![..5, ..5]).to_owned()));
        }
    }

    #[test]
    fn a_matrix_that_is_no_covariance_is_rejected() {
        let mut matrix = Array2::eye(3);
        matrix[(2, 2)] = -1.0;
        assert_eq!(Cholesky::new(matrix.view()).unwrap_err(), NotPositive(2));
        matrix[(1, 1)] = f64::NAN;
        assert_eq!(Cholesky::new(matrix.view()).unwrap_err(), NotPositive(1));
    }

    #[test]
    fn moments_of_inputs_that_never_occur_are_lifted_instead() {
        let mut matrix = Array2::eye(3);
        matrix[(2, 2)] = 0.0;
        assert!(Cholesky::new(matrix.view()).is_err());
        assert!(Cholesky::of_moments(Array2::zeros((3, 3)).view()).lower()[(1, 1)] > 0.0);
        assert_eq!(Cholesky::of_moments(matrix.view()).lower()[(2, 2)], 1e-6);
    }
}
