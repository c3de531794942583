//! What `edof train` says at its end.

use super::options::Args;
use super::photographs::{Photograph, folders};
use super::progress::{levels, non_zeros};
use super::seed::Trained;
use crate::error::Error;
use crate::ui::Ui;
use edof_core::noise::SensorNoise;
use edof_core::words::count;
use edof_core::{Noise, Tone};
use edof_network::network::Network;
use edof_train::train::Trainer;
use edof_train::validation::{Measured, Validation};
use serde_json::{Value, json};

/// What training came to: tables for the terminal, and all of it for `--json`.
///
/// # Errors
/// A terminal or file that cannot be written.
pub(super) fn tell(
    network: &Network,
    results: &[Trained<'_>],
    seed: u64,
    photographs: &[Photograph],
    args: &Args,
    ui: &Ui,
) -> Result<(), Error> {
    let Some(chosen) = results.iter().find(|r| r.trainer.recipe().seed == seed) else { return Ok(()) };
    let validation = chosen.trainer.validate_best();
    let windows: u64 = results.iter().map(|r| r.steps * r.trainer.recipe().batch as u64).sum();
    let seconds: f64 = results.iter().map(|r| r.seconds).sum();
    tell_photographs(photographs, ui)?;
    tell_validation(&validation, &chosen.trainer, photographs, ui)?;
    for result in results.iter().filter(|_| results.len() > 1) {
        let best = result.best();
        let kept = if best.within_budget { "" } else { ", over budget" };
        ui.say(format!("seed {}: {:.3} dB{kept}", result.trainer.recipe().seed, best.db))?;
    }
    ui.say(format!(
        "{}: {:.2} dB on validation windows (mean over photographs, ψ, noise) after {} steps \
         ({:.0} windows a second); written to {}",
        network.origin.name,
        network.origin.validation_db,
        chosen.trainer.state.step,
        windows as f64 / seconds,
        args.out.display()
    ))?;
    let seeds: Vec<Value> = results
        .iter()
        .map(|r| {
            let best = r.best();
            let seed = r.trainer.recipe().seed;
            json!({ "seed": seed, "validation_db": best.db, "within_budget": best.within_budget, "history": r.history })
        })
        .collect();
    ui.json(&json!({
        "name": network.origin.name,
        "form": network.form,
        "camera": network.origin.camera.name,
        "photographs": photographs.iter().map(Photograph::name).collect::<Vec<_>>(),
        "steps": chosen.trainer.state.step,
        "windows": network.origin.patches,
        "seed": seed,
        "validation_db": network.origin.validation_db,
        "validation": table(&validation, &chosen.trainer, photographs),
        "lambda": chosen.trainer.state.steering.lambdas,
        "seeds": seeds,
        "seconds": seconds,
        "windows_per_second": windows as f64 / seconds,
        "weights": args.out.display().to_string(),
    }))
}

/// Mean dB by folder and noise, then the worst ψ and noise and the non-zeros.
fn tell_validation(
    validation: &Validation,
    trainer: &Trainer<'_>,
    photographs: &[Photograph],
    ui: &Ui,
) -> Result<(), Error> {
    ui.say("validation  tone    noise               dB")?;
    for row in rows(validation, trainer, photographs) {
        let db = row.db.map_or("-".to_owned(), |db| format!("{db:.2}"));
        ui.say(format!("{:10}  {:6}  {:14}  {db:>6}", row.folder, row.tone, in_words(row.noise)))?;
    }
    if let Some((at, db)) = validation.worst() {
        let (psi, tone) = (trainer.psi(at.place.psi), trainer.recipe().tone);
        ui.say(format!(
            "worst: {db:.2} dB at psi {psi}, noise {}, {tone} (mean over photographs)",
            in_words(at.noise)
        ))?;
    }
    ui.say(format!("non-zeros after each shrinkage: {}", non_zeros(validation, 1)))
}

/// A noise with a gain of few digits.
fn in_words(noise: Noise) -> String {
    match noise {
        Noise::Sensor(sensor) => {
            let gain = (1e3 * sensor.gain).round() / 1e3;
            Noise::Sensor(SensorNoise { gain, ..sensor }).to_string()
        }
        other => other.to_string(),
    }
}

/// One line of the validation's table.
struct Row<'a> {
    folder: &'a str,
    tone: Tone,
    noise: Noise,
    db: Option<f64>,
}

fn rows<'a>(validation: &Validation, trainer: &Trainer<'_>, photographs: &'a [Photograph]) -> Vec<Row<'a>> {
    let (mut rows, tone) = (vec![], trainer.recipe().tone);
    for folder in folders(photographs) {
        for noise in trainer.recipe().conditions.validated(tone) {
            let db = validation.mean(|m| photographs[m.place.photo].folder == folder && m.noise == noise);
            rows.push(Row { folder, tone, noise, db });
        }
    }
    rows
}

fn table(validation: &Validation, trainer: &Trainer<'_>, photographs: &[Photograph]) -> Value {
    let row =
        |r: Row<'_>| json!({ "folder": r.folder, "tone": r.tone, "noise": r.noise.to_string(), "db": r.db });
    let worst = validation.worst().map(|(at, db)| {
        json!({ "psi": trainer.psi(at.place.psi), "tone": trainer.recipe().tone, "noise": at.noise.to_string(), "db": db })
    });
    json!({
        "levels": levels(validation, trainer),
        "means": rows(validation, trainer, photographs).into_iter().map(row).collect::<Vec<_>>(),
        "worst": worst,
        "photographs": by_photograph(validation, trainer, photographs),
        "non_zeros_busy": validation.busy_non_zeros(),
        "non_zeros_noisy": validation.non_zeros(true),
        "non_zeros_clean": validation.non_zeros(false),
    })
}

/// dB of each photograph and noise at each ψ that was validated.
fn by_photograph(validation: &Validation, trainer: &Trainer<'_>, photographs: &[Photograph]) -> Vec<Value> {
    let (mut rows, tone) = (vec![], trainer.recipe().tone);
    for (photo, photograph) in photographs.iter().enumerate() {
        for noise in trainer.recipe().conditions.validated(tone) {
            let own = |m: &&Measured| m.place.photo == photo && m.noise == noise;
            let sets: Vec<&Measured> = validation.0.iter().filter(own).collect();
            let psi: Vec<f64> = sets.iter().map(|m| trainer.psi(m.place.psi)).collect();
            let db: Vec<f64> = sets.iter().map(|m| m.psnr_db).collect();
            rows.push(json!({ "name": photograph.name(), "tone": tone, "noise": noise.to_string(), "psi": psi, "db": db }));
        }
    }
    rows
}

fn tell_photographs(photographs: &[Photograph], ui: &Ui) -> Result<(), Error> {
    for folder in folders(photographs) {
        let stems: Vec<&str> =
            photographs.iter().filter(|p| p.folder == folder).map(|p| p.stem.as_str()).collect();
        ui.say(format!("{} of {folder}: {}", count(stems.len(), "photograph"), stems.join(" ")))?;
    }
    Ok(())
}
