//! Solving with a symmetric positive definite matrix.

use ndarray::{Array1, Array2, ArrayView1, Axis, s};

/// L of A = L·Lᵀ.
pub struct Cholesky(Array2<f64>);

/// A matrix that is no covariance.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("covariance: not positive definite at row {0}")]
pub struct NotPositive(pub usize);

impl Cholesky {
    /// Factors a symmetric matrix; only its lower half is read.
    ///
    /// # Errors
    /// [`NotPositive`].
    pub fn new(mut a: Array2<f64>) -> Result<Self, NotPositive> {
        for j in 0..a.nrows() {
            let (_, mut rest) = a.view_mut().split_at(Axis(0), j);
            let row: Array1<f64> = rest.slice(s![0, ..j]).to_owned();
            let pivot = rest[(0, j)] - row.dot(&row);
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(NotPositive(j));
            }
            let root = pivot.sqrt();
            for i in 1..rest.nrows() {
                let other: ArrayView1<f64> = rest.slice(s![i, ..j]);
                let dot = other.dot(&row);
                rest[(i, j)] = (rest[(i, j)] - dot) / root;
            }
            rest[(0, j)] = root;
        }
        Ok(Self(a))
    }

    /// X of A·X = B, columns of B at once.
    #[must_use]
    pub fn solve(&self, mut b: Array2<f64>) -> Array2<f64> {
        let n = self.0.nrows();
        for i in 0..n {
            let (above, mut rest) = b.view_mut().split_at(Axis(0), i);
            let mut row = rest.row_mut(0);
            above.outer_iter().enumerate().for_each(|(k, known)| row.scaled_add(-self.0[(i, k)], &known));
            row /= self.0[(i, i)];
        }
        for i in (0..n).rev() {
            let (mut upper, below) = b.view_mut().split_at(Axis(0), i + 1);
            let mut row = upper.row_mut(i);
            below
                .outer_iter()
                .enumerate()
                .for_each(|(k, known)| row.scaled_add(-self.0[(i + 1 + k, i)], &known));
            row /= self.0[(i, i)];
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_solves() {
        let root = Array2::from_shape_fn((9, 9), |(r, c)| ((r * 5 + c * 3) % 7) as f64 - 2.0);
        let a = root.dot(&root.t()) + Array2::<f64>::eye(9);
        let b = Array2::from_shape_fn((9, 4), |(r, c)| (r + 2 * c) as f64);
        let x = Cholesky::new(a.clone()).unwrap().solve(b.clone());
        assert!((a.dot(&x) - b).iter().all(|v| v.abs() < 1e-9));
    }

    #[test]
    fn a_matrix_that_is_no_covariance_is_refused() {
        let mut a = Array2::eye(3);
        a[(2, 2)] = -1.0;
        assert_eq!(Cholesky::new(a).map(|_| ()).unwrap_err(), NotPositive(2));
    }
}
