//! Training of float networks.

use crate::arguments::size;
use crate::camera::{camera, focused};
use crate::error::{OrRaise, failed, wrong_type};
use crate::job;
use crate::network::PyNetwork;
use edof_core::ColourFrame;
use edof_core::storage::provenance::Provenance;
use edof_network::{Network, form};
use edof_quantize::capture::depths;
use edof_train::dataset::Dataset;
use edof_train::recipe::Recipe;
use edof_train::threads::check_threads;
use edof_train::train::{Best, Trainer};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyModule};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A report of every hundred steps and every validation.
#[derive(Clone, Copy)]
struct Report {
    step: u64,
    loss: f64,
    best_db: f64,
}

/// What a training is of.
struct Task {
    recipe: Recipe,
    camera: edof_core::camera::Camera,
    pictures: Vec<ColourFrame>,
    psis: Vec<f64>,
    threads: usize,
    start: Option<Arc<Network>>,
    name: String,
}

impl Task {
    fn run(&self, stop: &AtomicBool) -> PyResult<(Network, Vec<Report>)> {
        let interrupted = || failed("train: interrupted");
        let dataset = Dataset::new(&self.pictures, &self.camera, self.recipe.dataset(&self.psis), |_, _| {
            job::flow(stop)
        });
        let dataset = dataset.or_raise()?.ok_or_else(interrupted)?;
        let recipe = self.recipe.clone();
        let mut trainer = match &self.start {
            Some(network) => Trainer::from_network(recipe, &dataset, self.threads, network),
            None => Trainer::new(recipe, &dataset, self.threads),
        }
        .or_raise()?;
        let mut reports = vec![];
        let told = trainer.run(|_, progress| {
            let (step, loss, best_db) = (progress.step, progress.loss, progress.best.db);
            if progress.validation.is_some() || step.is_multiple_of(100) {
                reports.push(Report { step, loss, best_db });
            }
            job::flow(stop)
        });
        told.or_raise()?;
        if trainer.state.best == Best::NONE {
            return Err(failed("train: stopped before the first validation; lower validate_every"));
        }
        let made = Provenance { seed: Some(trainer.recipe().seed), ..Provenance::default() };
        Ok((trainer.best(&self.name, &self.camera, made), reports))
    }
}

/// The recipe of a form with further foci, and with some fields of its JSON replaced.
fn recipe(form: &str, further_foci: &[f64], changes: Option<&Bound<'_, PyDict>>) -> PyResult<Recipe> {
    let usual = Recipe::new(form::parse(form).map_err(failed)?);
    let usual = Recipe { further_foci: further_foci.to_vec(), ..usual };
    let Some(changes) = changes else { return Ok(usual) };
    let text: String =
        PyModule::import(changes.py(), "json")?.call_method1("dumps", (changes,))?.extract()?;
    let (mut fields, changes): (Value, Value) =
        (serde_json::to_value(&usual).or_raise()?, serde_json::from_str(&text).or_raise()?);
    let known: Vec<String> = fields.as_object().into_iter().flat_map(|all| all.keys().cloned()).collect();
    for (name, value) in changes.as_object().into_iter().flatten() {
        if !known.contains(name) {
            return Err(failed(format!(
                "recipe: '{name}' is no field of a recipe; they are {}",
                known.join(", ")
            )));
        }
        match (&mut fields[name.as_str()], value) {
            (Value::Object(own), Value::Object(more)) => own.extend(more.clone()),
            (own, value) => *own = value.clone(),
        }
    }
    let recipe: Recipe = serde_json::from_value(fields).map_err(|e| failed(format!("recipe: {e}")))?;
    recipe.check().or_raise()?;
    Ok(recipe)
}

/// Trains a network; gives it and the reports.
#[pyfunction]
#[pyo3(signature = (form, pictures, camera, *, recipe = None, psi = None, focus = None, threads = None, start = None, name = "trained"))]
#[allow(clippy::too_many_arguments, reason = "what a training is")]
pub fn train<'py>(
    py: Python<'py>,
    form: &str,
    pictures: &Bound<'py, PyAny>,
    camera: &Bound<'py, PyAny>,
    recipe: Option<&Bound<'py, PyDict>>,
    psi: Option<Vec<f64>>,
    focus: Option<Vec<f64>>,
    threads: Option<&Bound<'py, PyAny>>,
    start: Option<&Bound<'py, PyNetwork>>,
    name: &str,
) -> PyResult<(PyNetwork, Vec<Bound<'py, PyDict>>)> {
    let given: Vec<Bound<'py, PyAny>> =
        pictures.extract().map_err(|_| wrong_type("pictures", pictures, "a list of pictures"))?;
    let picture = |(index, value): (usize, &Bound<'py, PyAny>)| {
        crate::arguments::picture(value, &format!("pictures[{index}]"))
    };
    let camera = self::camera(camera)?;
    let (camera, further_foci) = match focus.as_deref() {
        Some([first, further @ ..]) => (focused(&camera, *first)?, further.to_vec()),
        _ => ((*camera).clone(), vec![]),
    };
    let task = Task {
        recipe: self::recipe(form, &further_foci, recipe)?,
        pictures: given.iter().enumerate().map(picture).collect::<PyResult<Vec<_>>>()?,
        psis: psi.unwrap_or_else(|| depths(camera.psi_range)),
        threads: threads.map_or(Ok(2), |value| size(value, "threads", 0, 1 << 16))?,
        start: start.map(|network| Arc::clone(&network.get().network)),
        name: name.to_owned(),
        camera,
    };
    check_threads(task.threads).or_raise()?;
    let (network, reports) = job::run(py, move |stop| task.run(stop))??;
    let report = |report: &Report| {
        let row = PyDict::new(py);
        row.set_item("step", report.step)?;
        row.set_item("loss", report.loss)?;
        row.set_item("best_db", report.best_db)?;
        Ok(row)
    };
    Ok((PyNetwork::of(network)?, reports.iter().map(report).collect::<PyResult<_>>()?))
}
