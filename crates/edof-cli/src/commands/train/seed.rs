//! One seed of `edof train`: begun or resumed, with a checkpoint every minute.

use super::length;
use super::options::Args;
use super::progress::{moment, summary};
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_network::network::Network;
use edof_train::checkpoint::{self, Run};
use edof_train::dataset::Dataset;
use edof_train::train::{Best, Progress, State, Trainer};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A checkpoint comes this often.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);
/// The speed is known after this.
const SPEED_AFTER: Duration = Duration::from_secs(2);

/// A trained network that has not been written yet.
pub(super) struct Trained<'a> {
    pub(super) trainer: Trainer<'a>,
    pub(super) seconds: f64,
    /// Steps of this run; a resumed one counts its own only.
    pub(super) steps: u64,
    pub(super) history: Vec<Value>,
}

impl Trained<'_> {
    /// The best of its validations.
    pub(super) fn best(&self) -> Best {
        self.trainer.state.best
    }
}

/// Trains one seed, from its checkpoint where there is one.
///
/// # Errors
/// A checkpoint of something else, options that do not fit, a file that cannot be written, or Ctrl-C.
pub(super) fn one_seed<'a>(
    dataset: &'a Dataset,
    run: &Run,
    from: Option<&Network>,
    file: &Path,
    args: &Args,
    ui: &Ui,
) -> Result<Trained<'a>, Error> {
    let threads = args.threads();
    let recipe = run.recipe.clone();
    let mut trainer = match from {
        _ if file.exists() => Trainer::resume(recipe, dataset, threads, checkpoint::load(file, run)?)?,
        Some(from) => Trainer::from_network(recipe, dataset, threads, from)?,
        None => Trainer::new(recipe, dataset, threads)?,
    };
    save(file, run, &trainer.state)?;
    let (begun, first, mut history) = (Instant::now(), trainer.state.step, vec![]);
    train(&mut trainer, args, file, run, &mut history, ui)?;
    // A seed that is done waits for the others; --resume passes over it.
    save(file, run, &trainer.state)?;
    let steps = trainer.state.step - first;
    Ok(Trained { trainer, seconds: begun.elapsed().as_secs_f64(), steps, history })
}

fn train(
    trainer: &mut Trainer<'_>,
    args: &Args,
    file: &Path,
    run: &Run,
    history: &mut Vec<Value>,
    ui: &Ui,
) -> Result<(), Error> {
    let limit = args.minutes;
    let what = format!("train, seed {}", trainer.recipe().seed);
    let bar = ui.progress_within(limit, trainer.recipe().steps, what);
    let (start, first, mut saved) = (Instant::now(), trainer.state.step, Instant::now());
    let mut forecast = limit.filter(|_| run.from.is_none());
    let (mut failed, mut unvalidated) = (None, None);
    trainer.run(|trainer, progress: &Progress| {
        bar.set(progress.step);
        if let Some(validation) = &progress.validation {
            bar.message(summary(validation, progress.best));
            history.push(moment(trainer, validation, progress));
        }
        if let Some(limit) = forecast
            && start.elapsed() >= SPEED_AFTER.min(limit)
        {
            forecast = None;
            let speed = (progress.step - first) as f64 / start.elapsed().as_secs_f64();
            let end = first + (speed * limit.as_secs_f64()) as u64;
            length::cut(trainer.recipe(), limit, end).into_iter().for_each(|line| ui.note(line));
        }
        let stop = interrupt::flag().load(Ordering::SeqCst);
        let out_of_time = limit.is_some_and(|limit| start.elapsed() >= limit);
        unvalidated = (out_of_time && progress.validation.is_none()).then(|| progress.clone());
        if stop || out_of_time || saved.elapsed() >= CHECKPOINT_EVERY {
            saved = Instant::now();
            failed = save(file, run, &trainer.state).err();
        }
        if stop || out_of_time || failed.is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    if let Some(error) = failed {
        return Err(error);
    }
    interrupt::check()?;
    if let Some(progress) = unvalidated {
        let validation = trainer.validate_last();
        history.push(moment(trainer, &validation, &progress));
    }
    Ok(())
}

/// Writes a checkpoint, and has it named if the run is stopped.
fn save(file: &Path, run: &Run, state: &State) -> Result<(), Error> {
    checkpoint::save(file, run, state)?;
    interrupt::keeps(Some(format!(
        "{}: checkpoint at step {}; continue with --resume",
        file.display(),
        state.step
    )));
    Ok(())
}
