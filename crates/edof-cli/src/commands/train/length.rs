//! What a short training is expected to lose, before it has taken its time.

use edof_train::length::{loss, whole};
use edof_train::recipe::Recipe;
use std::time::Duration;

/// What a training of the recipe's steps loses, where it is a short one.
pub(super) fn short(recipe: &Recipe) -> Option<String> {
    let loss = loss(recipe, recipe.steps)?.whole_db;
    Some(format!(
        "--steps {}: expect about {loss:.1} dB less on validation windows than with {} steps (docs/your-own-lens.md)",
        recipe.steps,
        whole(recipe)
    ))
}

/// Where `--minutes` ends a training from random weights, about, if that is before its schedule; with what that loses, and what is better.
pub(super) fn cut(recipe: &Recipe, limit: Duration, end: u64) -> Option<String> {
    let loss = loss(recipe, end).filter(|_| end < recipe.steps)?;
    let better = match loss.cut_db - loss.whole_db {
        0.05.. => format!("; --steps {end} takes as long and loses about {:.1} dB", loss.whole_db),
        _ => String::new(),
    };
    Some(format!(
        "--minutes {}: ends at about step {end} of {}, expect about {:.1} dB less on validation windows than with {} steps{better} \
         (docs/your-own-lens.md)",
        limit.as_secs_f64() / 60.0,
        recipe.steps,
        loss.cut_db,
        whole(recipe)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(steps: u64) -> Recipe {
        Recipe { steps, ..Recipe::new(edof_network::form::parse("edof-t4w12").unwrap()) }
    }

    #[test]
    fn a_short_training_is_told_what_it_loses_and_a_whole_one_nothing() {
        let line = short(&of(8000)).unwrap();
        let expected = "--steps 8000: expect about 0.4 dB less on validation windows than with 40000 steps";
        assert!(line.starts_with(expected), "{line}");
        assert_eq!(short(&of(40_000)), None);
    }

    #[test]
    fn a_limit_that_cuts_the_schedule_is_told_what_it_loses_and_the_steps_that_fit() {
        let minute = Duration::from_secs(60);
        let line = cut(&of(40_000), minute, 2000).unwrap();
        assert!(
            line.starts_with("--minutes 1: ends at about step 2000 of 40000, expect about 1.4 dB less"),
            "{line}"
        );
        assert!(line.contains("; --steps 2000 takes as long and loses about 1.0 dB"), "{line}");
        let early = cut(&of(40_000), minute, 800).unwrap();
        assert!(!early.contains("takes as long"), "until there the rate matters little: {early}");
        assert_eq!(cut(&of(8000), minute, 9000), None, "the schedule ends first");
    }
}
