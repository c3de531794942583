//! Differences of two methods on the same photographs: how far apart they are on average, and how sure that is.

use edof_numerics::mean;
use serde::Serialize;
use std::collections::BTreeMap;

/// A mean of differences, one for each photograph.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Paired {
    /// Mean of the differences.
    pub mean: f64,
    /// Standard error of the mean: the differences' standard deviation (n − 1) over √n; none of one difference, or of infinite ones.
    pub standard_error: Option<f64>,
    /// How many photographs.
    pub photos: usize,
}

impl Paired {
    /// Of differences; nothing of none.
    #[must_use]
    pub fn of(differences: &[f64]) -> Option<Self> {
        let mean = mean(differences.iter().copied())?;
        let count = differences.len() as f64;
        let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
        let standard_error = Some((squares / (count - 1.0) / count).sqrt()).filter(|error| error.is_finite());
        Some(Self { mean, standard_error, photos: differences.len() })
    }

    /// Of numbers by photograph, the first less the second, where both have one.
    #[must_use]
    pub fn between(first: &BTreeMap<String, f64>, second: &BTreeMap<String, f64>) -> Option<Self> {
        let both = first.iter().filter_map(|(photo, a)| Some(a - second.get(photo)?));
        Self::of(&both.collect::<Vec<_>>())
    }
}

/// Returns a mean of a table with its standard error, as in `34.20 ± 0.62`.
#[must_use]
pub fn with_error(mean: f64, standard_error: Option<f64>) -> String {
    standard_error.map_or_else(|| format!("{mean:.2}"), |error| format!("{mean:.2} ± {error:.2}"))
}

impl std::fmt::Display for Paired {
    /// As in `+1.15 ± 0.17`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.mean.is_sign_negative() { "" } else { "+" };
        write!(f, "{sign}{}", with_error(self.mean, self.standard_error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standard_error_is_that_of_a_text_book() {
        // Student's extra hours of sleep, ten patients ("The probable error of a mean", 1908): 0.75 and 1.70 /√9 by its n.
        let sleep = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let paired = Paired::of(&sleep).unwrap();
        assert_eq!((paired.to_string().as_str(), paired.photos), ("+0.75 ± 0.57", 10));
        assert_eq!(Paired::of(&[-0.25]).unwrap().to_string(), "-0.25");
        assert_eq!(Paired::of(&[]), None);
        let perfect = Paired::of(&[f64::INFINITY, 30.0]).unwrap();
        assert_eq!(with_error(perfect.mean, perfect.standard_error), "inf");
    }

    #[test]
    fn only_photographs_that_both_have_are_compared() {
        let map = |all: &[(&str, f64)]| all.iter().map(|&(name, db)| (name.to_owned(), db)).collect();
        let paired = Paired::between(&map(&[("a", 31.0), ("b", 50.0)]), &map(&[("a", 30.0), ("c", 1.0)]));
        assert_eq!(paired.unwrap().to_string(), "+1.00");
        assert_eq!(Paired::between(&map(&[("a", 1.0)]), &map(&[])), None);
    }
}
