//! A short training for the lens that the page shows: `edof train --from` beside the pictures, one at a time. It waits while the page computes.

use super::networks::file_name;
use super::pictures::CAMERA_FILE;
use super::server::Site;
use super::state::State;
use crate::commands::train::photographs::photographs;
use crate::commands::train::{DEPTHS, blurred_bytes, spread, usual_threads};
use crate::error::Error;
use crate::{said, weights};
use edof_core::ColourFrame;
use edof_core::camera::Camera;
use edof_core::storage::provenance::{Input, Provenance};
use edof_core::words::number;
use edof_io::photos::Selection;
use edof_network::Network;
use edof_train::dataset::Dataset;
use edof_train::recipe::Recipe;
use edof_train::train::Trainer;
use serde::Serialize;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// What trainings of the page have in common, and how the last one goes.
pub struct Training {
    images: Vec<PathBuf>,
    photos: Option<Selection>,
    /// Steps of each.
    pub steps: u64,
    provenance: Provenance,
    status: Mutex<Status>,
    is_cancelled: AtomicBool,
}

/// A lens, the network to begin with, and the gains of the sensor.
pub struct Lesson {
    /// Name of the network to be made.
    pub name: String,
    pub camera: Camera,
    pub from: Network,
    pub gains: [f64; 2],
}

/// How a training goes, as the page is told.
#[derive(Clone, Serialize)]
#[serde(tag = "is", rename_all = "lowercase")]
pub enum Status {
    /// There was none yet.
    None,
    Running {
        part: Part,
        done: u64,
        of: u64,
        seconds_left: Option<f64>,
    },
    Done {
        network: String,
        validation_db: f64,
        seconds: f64,
        /// The command that makes the same weights.
        command: String,
    },
    Cancelled,
    Failed {
        error: String,
    },
}

/// What a training is at.
#[derive(Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    Photographs,
    Blur,
    Steps,
}

impl Training {
    /// Trainings on photographs of these folders, as `edof train` takes them.
    pub fn new(images: Vec<PathBuf>, photos: Option<Selection>, steps: u64, provenance: Provenance) -> Self {
        let status = Mutex::new(Status::None);
        Self { images, photos, steps, provenance, status, is_cancelled: AtomicBool::new(false) }
    }

    /// Returns how the last training goes.
    pub fn status(&self) -> Status {
        self.locked().clone()
    }

    /// Ends the training that runs, if one does.
    pub fn cancel(&self) {
        self.is_cancelled.store(true, Ordering::SeqCst);
    }

    fn locked(&self) -> MutexGuard<'_, Status> {
        self.status.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self, part: Part, done: u64, of: u64, begun: Instant) {
        let left = begun.elapsed().as_secs_f64() * (of - done) as f64 / done.max(1) as f64;
        *self.locked() = Status::Running { part, done, of, seconds_left: (done > 0).then_some(left) };
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.is_cancelled.load(Ordering::SeqCst) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Begins a training for the lens and the light of a state.
///
/// # Errors
/// A state that no lens or sensor has, another training that runs, a system without threads.
pub fn train(site: &Arc<Site>, state: &State) -> Result<(), Error> {
    let training = &site.training;
    let mut status = training.locked();
    if matches!(*status, Status::Running { .. }) {
        return Err(Error::message("a training is running; wait for its end, or cancel it"));
    }
    let lesson = site.engine().lesson(state)?;
    training.is_cancelled.store(false, Ordering::SeqCst);
    let own = Arc::clone(site);
    std::thread::Builder::new().name("training".into()).spawn(move || {
        let end = match catch_unwind(AssertUnwindSafe(|| learn(&own, lesson))) {
            Ok(Ok(done)) => done,
            Ok(Err(Error::Interrupted)) => Status::Cancelled,
            Ok(Err(error)) => Status::Failed { error: error.to_string() },
            // A fault of ours, said on the terminal: the page may begin another training.
            Err(_) => Status::Failed { error: "it stopped by a fault of the program".to_owned() },
        };
        *own.training.locked() = end;
    })?;
    *status = Status::Running { part: Part::Photographs, done: 0, of: 1, seconds_left: None };
    Ok(())
}

/// Follows a lesson to its end.
///
/// # Errors
/// Photographs or a recipe that cannot be used; [`Error::Interrupted`] where it is cancelled.
fn learn(site: &Site, lesson: Lesson) -> Result<Status, Error> {
    let (training, begun) = (&site.training, Instant::now());
    let Lesson { name, camera, from, gains } = lesson;
    let mut recipe = Recipe { tone: from.origin.values, steps: training.steps, ..Recipe::new(from.form) };
    recipe.conditions.gain = gains.map(|gain| gain as f32);
    recipe.check().map_err(said::recipe)?;
    let photographs = photographs(&training.images, training.photos.as_ref(), &|_| ())?;
    let frames: Vec<ColourFrame> = photographs.iter().map(|photograph| photograph.frame.clone()).collect();
    let psis = spread(camera.psi_range, DEPTHS)?;
    let options = recipe.dataset(&psis);
    said::memory("photographs (give fewer by --photos)", blurred_bytes(&frames, &options))?;
    // The page comes first: whoever computes for it has the engine.
    let step = |part, done: u64, of: u64, begun| {
        training.tell(part, done, of, begun);
        drop(site.engine());
        training.flow()
    };
    let since = Instant::now();
    let blurred = |done: usize, of: usize| step(Part::Blur, done as u64, of as u64, since);
    let dataset = Dataset::new(&frames, &camera, options, blurred)
        .map_err(|error| said::dataset(error, |index| photographs[index].file.display().to_string()))?;
    let dataset = dataset.ok_or(Error::Interrupted)?;
    let mut trainer = Trainer::from_network(recipe, &dataset, usual_threads(), &from)?;
    let since = Instant::now();
    trainer.run(|_, progress| step(Part::Steps, progress.step, progress.steps, since))?;
    if training.flow().is_break() {
        return Err(Error::Interrupted);
    }
    let [low, high] = gains.map(number);
    let command = format!(
        "edof train --from {} --camera {CAMERA_FILE} --gain {low}:{high} --steps {} --out {}",
        from.origin.name,
        training.steps,
        file_name(&name)
    );
    let photos = photographs.iter().map(|p| Input::photograph(&p.name(), &p.frame));
    let beginning = weights::float_input(&from.origin.name)?;
    let made = Provenance {
        command: command.clone(),
        seed: Some(trainer.recipe().seed),
        inputs: [camera.input(), beginning].into_iter().chain(photos).collect(),
        ..training.provenance.clone().for_file()
    };
    let network = trainer.best(&name, &camera, made);
    let validation_db = network.origin.validation_db;
    site.engine().learned(network);
    Ok(Status::Done { network: name, validation_db, seconds: begun.elapsed().as_secs_f64(), command })
}
