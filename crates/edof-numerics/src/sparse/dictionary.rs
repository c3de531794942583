//! A dictionary in which signals have sparse codes.

use crate::least_squares;
use crate::sparse::lasso::{self, Lasso};
use ndarray::{Array2, ArrayView1, ArrayView2, Axis};

/// Share of a code's mean square that is added before the dictionary is solved for: atoms that are never used stay small.
const RIDGE: f64 = 1e-4;

/// A dictionary and the codes that it was fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Learned {
    /// Length × atoms.
    pub dictionary: Array2<f32>,
    /// Signals × atoms.
    pub codes: Array2<f32>,
}

/// How long to learn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Turns of codes and dictionary.
    pub rounds: usize,
    /// Steps of the pursuit in each.
    pub steps: usize,
}

/// The method of optimal directions (Engan, Aase, Husøy 1999): from `start` (length × atoms), in turn atoms of norm one, sparse
/// codes by [`Lasso::ista`], and the dictionary by least squares. `penalties` holds μ, one an atom.
///
/// # Panics
/// If signals or atoms are not finite: a mistake of the caller.
#[must_use]
pub fn optimal_directions(
    signals: ArrayView2<'_, f32>,
    start: Array2<f32>,
    penalties: ArrayView1<'_, f32>,
    effort: Effort,
) -> Learned {
    let codes = Array2::zeros((signals.nrows(), start.ncols()));
    let mut learned = Learned { dictionary: start, codes };
    for _ in 0..effort.rounds {
        normalise(&mut learned.dictionary);
        let pursuit = lasso::Effort { steps: effort.steps, tolerance: 0.0 };
        learned.codes = Lasso::new(learned.dictionary.view(), penalties, 0).ista(signals, pursuit).codes;
        learned.dictionary = least_squares(learned.codes.view(), signals, RIDGE);
    }
    learned
}

fn normalise(dictionary: &mut Array2<f32>) {
    for mut atom in dictionary.axis_iter_mut(Axis(1)) {
        let norm = atom.dot(&atom).sqrt().max(1e-6);
        atom /= norm;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    /// Signals of one atom each, of a dictionary that is turned away from the start.
    #[test]
    fn atoms_that_made_the_signals_are_found() {
        let (sine, cosine) = 0.3f32.sin_cos();
        let truth = ndarray::array![[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
        let signals =
            Array2::from_shape_fn((60, 3), |(i, r)| (1.0 + (i / 3) as f32 / 20.0) * truth[(r, i % 3)]);
        let penalties = Array1::from_elem(3, 0.1);
        let effort = Effort { rounds: 30, steps: 200 };
        let learned = optimal_directions(signals.view(), Array2::eye(3), penalties.view(), effort);
        let mut found = learned.dictionary;
        normalise(&mut found);
        assert!((&found - &truth).iter().all(|e| e.abs() < 0.02), "{found}");
        assert!(learned.codes.iter().filter(|z| **z != 0.0).count() <= 70);
    }

    #[test]
    fn more_rounds_explain_the_signals_better() {
        let signals = Array2::from_shape_fn((80, 6), |(i, r)| ((i * 7 + r * r * 3) % 11) as f32 / 11.0);
        let start = Array2::from_shape_fn((6, 4), |(r, c)| ((r * 5 + c * 3) % 7) as f32 - 3.0);
        let penalties = Array1::from_elem(4, 0.02);
        let error = |rounds| {
            let learned = optimal_directions(
                signals.view(),
                start.clone(),
                penalties.view(),
                Effort { rounds, steps: 100 },
            );
            let Learned { dictionary, codes } = learned;
            (&signals - &codes.dot(&dictionary.t())).mapv(|e| e * e).sum()
        };
        assert!(error(10) < 0.9 * error(1), "{} {}", error(10), error(1));
    }
}
