//! What `edof train` says while it runs.

use edof_core::Noise;
use edof_train::train::{Best, Progress, Trainer};
use edof_train::validation::{Measured, Validation};
use serde_json::{Value, json};

/// One validation in a line.
pub(super) fn summary(validation: &Validation, best: Best) -> String {
    let worst = validation.worst().map_or(f64::NAN, |w| w.1);
    let kept = if best.within_budget { "" } else { ", over budget" };
    format!(
        "best {:.2} dB{kept}; now {:.2}, worst {worst:.2}, non-zeros {}",
        best.db,
        validation.db(),
        non_zeros(validation, 0)
    )
}

/// Mean non-zeros after each shrinkage, with N digits, of every kind of window that was validated.
pub(super) fn non_zeros(validation: &Validation, digits: usize) -> String {
    let kinds = [
        (validation.busy_non_zeros(), "where scenes are busiest"),
        (validation.non_zeros(true), "with noise"),
        (validation.non_zeros(false), "without noise"),
    ];
    let known = kinds.iter().filter(|(values, _)| !values.is_empty());
    known.map(|(values, which)| format!("{} {which}", numbers(values, digits))).collect::<Vec<_>>().join(", ")
}

/// One validation as data.
pub(super) fn moment(trainer: &Trainer<'_>, validation: &Validation, progress: &Progress) -> Value {
    json!({
        "step": progress.step,
        "loss": progress.loss,
        "validation_db": validation.db(),
        "worst_db": validation.worst().map(|w| w.1),
        "levels": levels(validation, trainer),
        "non_zeros_busy": validation.busy_non_zeros(),
        "non_zeros_noisy": validation.non_zeros(true),
        "non_zeros_clean": validation.non_zeros(false),
        "lambda": trainer.state.steering.lambdas,
    })
}

/// Mean and worst ψ over photographs, of each noise.
pub(super) fn levels(validation: &Validation, trainer: &Trainer<'_>) -> Value {
    let recipe = trainer.recipe();
    let of_noise = |noise: Noise| {
        let of = |m: &Measured| m.noise == noise;
        let at = |psi| validation.mean(|m| of(m) && m.place.psi == psi);
        let worst = (0..trainer.psis()).filter_map(at).reduce(f64::min);
        json!({ "tone": recipe.tone, "noise": noise.to_string(), "db": validation.mean(of), "worst_db": worst })
    };
    recipe.conditions.validated(recipe.tone).into_iter().map(of_noise).collect()
}

/// Numbers with N digits, parted by blanks.
fn numbers(values: &[f64], digits: usize) -> String {
    values.iter().map(|v| format!("{v:.digits$}")).collect::<Vec<_>>().join(" ")
}
