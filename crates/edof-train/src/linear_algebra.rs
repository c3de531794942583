//! The two things that starting values need of linear algebra: Cholesky factors and normal equations, in f64.

/// Row-major lower factor L of a positive definite `matrix` of `n`×`n` numbers, L·Lᵀ = matrix. Pivots that rounding made
/// too small are lifted to 1e-12 of the largest diagonal element.
#[must_use]
pub fn cholesky(matrix: &[f64], n: usize) -> Vec<f64> {
    let floor = 1e-12 * (0..n).map(|i| matrix[i * n + i]).fold(0.0, f64::max);
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let (row_i, row_j) = (&l[i * n..i * n + j], &l[j * n..j * n + j]);
            let rest = matrix[i * n + j] - row_i.iter().zip(row_j).map(|(a, b)| a * b).sum::<f64>();
            l[i * n + j] = if i == j { rest.max(floor).sqrt() } else { rest / l[j * n + j] };
        }
    }
    l
}

/// Solves L·x = b in place.
pub fn solve_lower(l: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let sum: f64 = l[i * n..i * n + i].iter().zip(&*b).map(|(a, x)| a * x).sum();
        b[i] = (b[i] - sum) / l[i * n + i];
    }
}

/// Solves Lᵀ·x = b in place.
pub fn solve_upper(l: &[f64], n: usize, b: &mut [f64]) {
    for i in (0..n).rev() {
        b[i] /= l[i * n + i];
        let x = b[i];
        b[..i].iter_mut().zip(&l[i * n..i * n + i]).for_each(|(b, a)| *b -= a * x);
    }
}

/// The row-major `outputs`×`inputs` matrix M that minimises Σ‖x − M·y‖² + ridge·‖M‖² over samples: rows of `y` (inputs) and
/// `x` (outputs). The ridge is a share of the mean square of an input.
#[must_use]
pub fn least_squares(y: &[f32], inputs: usize, x: &[f32], outputs: usize, ridge: f64) -> Vec<f32> {
    let mut gram = vec![0.0; inputs * inputs];
    let mut cross = vec![0.0; outputs * inputs];
    for (y, x) in y.chunks_exact(inputs).zip(x.chunks_exact(outputs)) {
        for (row, &a) in gram.chunks_exact_mut(inputs).zip(y) {
            row.iter_mut().zip(y).for_each(|(g, &b)| *g += f64::from(a * b));
        }
        for (row, &a) in cross.chunks_exact_mut(inputs).zip(x) {
            row.iter_mut().zip(y).for_each(|(g, &b)| *g += f64::from(a * b));
        }
    }
    let mean = (0..inputs).map(|i| gram[i * inputs + i]).sum::<f64>() / inputs as f64;
    (0..inputs).for_each(|i| gram[i * inputs + i] += ridge * mean + f64::MIN_POSITIVE);
    let l = cholesky(&gram, inputs);
    for row in cross.chunks_exact_mut(inputs) {
        solve_lower(&l, inputs, row);
        solve_upper(&l, inputs, row);
    }
    cross.into_iter().map(|v| v as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn least_squares_finds_the_map_that_made_the_samples(values in prop::collection::vec(-1.0f32..1.0, 3 * 40), map in prop::collection::vec(-1.0f32..1.0, 6)) {
            let x: Vec<f32> = values.chunks(3).flat_map(|y| [0, 3].map(|o| (0..3).map(|i| map[o + i] * y[i]).sum::<f32>())).collect();
            let found = least_squares(&values, 3, &x, 2, 1e-9);
            for (a, b) in found.iter().zip(&map) { prop_assert!((a - b).abs() < 1e-3); }
        }

        #[test]
        fn cholesky_factors_multiply_back(values in prop::collection::vec(-1.0f64..1.0, 16)) {
            let product = |a: &[f64]| -> Vec<f64> { (0..16).map(|i| (0..4).map(|k| a[i / 4 * 4 + k] * a[i % 4 * 4 + k]).sum()).collect() };
            let mut matrix = product(&values);
            (0..4).for_each(|i| matrix[i * 5] += 0.1);
            for (a, b) in product(&cholesky(&matrix, 4)).iter().zip(&matrix) { prop_assert!((a - b).abs() < 1e-9); }
        }
    }
}
