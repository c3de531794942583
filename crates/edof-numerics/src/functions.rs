//! Functions that are short and still stand once.

/// sin(πx)/(πx), 1 at 0.
#[must_use]
pub fn sinc(x: f64) -> f64 {
    let angle = std::f64::consts::PI * x;
    if angle.abs() < 1e-9 { 1.0 } else { angle.sin() / angle }
}

/// The mean, summed in the order given; none of no values.
#[must_use]
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0u64), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sinc_is_one_at_zero_and_zero_at_other_whole_numbers() {
        assert_eq!(sinc(0.0), 1.0);
        assert!((1..5).all(|n| sinc(f64::from(n)).abs() < 1e-16));
        assert!((sinc(0.5) - 2.0 / std::f64::consts::PI).abs() < 1e-16);
        // The function has no step where the series begins.
        assert!((sinc(3e-10) - sinc(4e-10)).abs() < 1e-16);
    }

    #[test]
    fn the_mean_of_nothing_is_none() {
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(mean([]), None);
    }
}
