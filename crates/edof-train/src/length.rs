//! What a training loses by being short.

use crate::recipe::{BATCH, Recipe, STEPS};

/// Steps of the recipe's batch; dB on validation windows that a training has less than one of [`STEPS`]: with a schedule of these steps, and ended after
/// these steps of a schedule of [`STEPS`] (docs/your-own-lens.md states how it was measured).
const MEASURED: [(u64, [f64; 2]); 6] = [
    (500, [2.39, 2.47]),
    (1000, [1.96, 1.75]),
    (2000, [1.03, 1.44]),
    (4000, [0.70, 1.15]),
    (8000, [0.42, 0.87]),
    (STEPS, [0.0, 0.0]),
];

/// What a training from random weights loses against one as long as the recipe, in dB on validation windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Its schedule has these steps.
    pub whole_db: f64,
    /// It is ended after these steps of a longer schedule.
    pub cut_db: f64,
}

/// Returns the loss of a training of `steps` steps; none where it is as long as the recipe. Fewer steps than were measured lose more than this.
///
/// ```
/// use edof_train::{length, recipe::Recipe};
/// let recipe = Recipe::new(edof_network::form::parse("edof-t4w12")?);
/// let of = |steps| length::loss(&recipe, steps);
/// assert!(of(1000).unwrap().whole_db > of(8000).unwrap().whole_db);
/// assert_eq!(of(40_000), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn loss(recipe: &Recipe, steps: u64) -> Option<Loss> {
    let steps = steps as f64 * recipe.batch as f64 / BATCH as f64;
    let next = MEASURED.iter().position(|(measured, _)| *measured as f64 > steps)?;
    let [(from, more), (to, less)] = [MEASURED[next.saturating_sub(1)], MEASURED[next]];
    let share = ((steps / from as f64).ln() / (to as f64 / from as f64).ln()).max(0.0);
    let [whole_db, cut_db] = [0, 1].map(|kind| more[kind] + share * (less[kind] - more[kind]));
    Some(Loss { whole_db, cut_db })
}

/// Steps of a recipe that see as many windows as the recipe's own.
#[must_use]
pub fn whole(recipe: &Recipe) -> u64 {
    STEPS * BATCH as u64 / recipe.batch as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_network::form;

    #[test]
    fn a_shorter_training_loses_more_and_a_larger_batch_counts_as_more_steps() {
        let recipe = Recipe::new(form::parse("edof-t4w12").unwrap());
        let losses =
            [0, 1, 500, 700, 2000, 5000, 8000, 20_000, 39_999].map(|steps| loss(&recipe, steps).unwrap());
        assert!(losses.is_sorted_by(|a, b| a.whole_db >= b.whole_db && a.cut_db >= b.cut_db), "{losses:?}");
        assert!(losses.iter().all(|loss| loss.whole_db > 0.0));
        let of_8000 = loss(&recipe, 8000);
        assert_eq!(of_8000, Some(Loss { whole_db: 0.42, cut_db: 0.87 }));
        assert_eq!(loss(&Recipe { batch: 1024, ..recipe.clone() }, 4000), of_8000);
        assert_eq!([40_000, 80_000].map(|steps| loss(&recipe, steps)), [None, None]);
        assert_eq!(whole(&Recipe { batch: 1024, ..recipe }), 20_000);
    }
}
