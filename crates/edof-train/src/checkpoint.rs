//! A training run on disk: the recipe and everything that changes while it runs, so that it resumes bit for bit.

use crate::adam::Adam;
use crate::budget::SparsityController;
use crate::recipe::Recipe;
use crate::train::{Best, State};
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::provenance::Input;
use edof_core::storage::{input, json};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

const METADATA_KEY: &str = "edof-checkpoint";

/// A checkpoint that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CheckpointError {
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Truncated, or not a checkpoint.
    #[error("{path}: not a checkpoint of a training run: {reason}", path = path.display())]
    Foreign { path: PathBuf, reason: String },
    /// Of a run with other settings.
    #[error(
        "{path}: made with {field} {found}, cannot be resumed with {asked}; give the options of that run, or begin anew with another --out",
        path = path.display()
    )]
    OtherRun { path: PathBuf, field: String, found: String, asked: String },
}

/// What identifies a run: a checkpoint resumes only with the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The recipe.
    pub recipe: Recipe,
    /// The camera, as JSON.
    pub camera: String,
    /// The photographs, in order: by name and content.
    pub photos: Vec<Input>,
    /// ψ of each blur.
    pub psis: Vec<f64>,
    /// The network that it began from, where it was one.
    pub from: Option<Input>,
}

#[derive(Serialize, Deserialize)]
struct Metadata {
    run: Run,
    step: u64,
    adam_steps: u64,
    /// Bits of f64: JSON has no −∞.
    best_score_bits: u64,
    best_db_bits: u64,
    best_within_budget: bool,
    stale: u32,
}

/// Writes a checkpoint; the one before is replaced only by a whole one.
///
/// # Errors
/// [`CheckpointError::Write`].
pub fn save(path: &Path, run: &Run, state: &State) -> Result<(), CheckpointError> {
    let foreign = |reason: String| CheckpointError::Foreign { path: path.to_owned(), reason };
    let metadata = Metadata {
        run: run.clone(),
        step: state.step,
        adam_steps: state.adam.steps,
        best_score_bits: state.best.score.to_bits(),
        best_db_bits: state.best.db.to_bits(),
        best_within_budget: state.best.within_budget,
        stale: state.stale,
    };
    let text = serde_json::to_string(&metadata).map_err(|e| foreign(e.to_string()))?;
    let tensors = named(state).map(|(name, values)| (name, bytes(values)));
    let views = tensors
        .iter()
        .map(|(name, bytes)| Ok((*name, TensorView::new(Dtype::F32, vec![bytes.len() / 4], bytes)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
        .map_err(|e| foreign(e.to_string()))?;
    let file = safetensors::serialize(views, Some(HashMap::from([(METADATA_KEY.to_owned(), text)])))
        .map_err(|e| foreign(e.to_string()))?;
    Ok(atomic::write(path, &file)?)
}

/// Reads a checkpoint of this very run.
///
/// # Errors
/// Any [`CheckpointError`] but `Write`; one of a run with another recipe, camera or photos is rejected, naming what differs.
pub fn load(path: &Path, run: &Run) -> Result<State, CheckpointError> {
    let file = input::read(path).map_err(|source| CheckpointError::Read { path: path.to_owned(), source })?;
    let foreign = |reason: String| CheckpointError::Foreign { path: path.to_owned(), reason };
    let (_, header) = SafeTensors::read_metadata(&file).map_err(|e| foreign(e.to_string()))?;
    let text = header
        .metadata()
        .as_ref()
        .and_then(|m| m.get(METADATA_KEY))
        .ok_or_else(|| foreign(format!("its metadata has no entry '{METADATA_KEY}'")))?;
    let metadata: Metadata = json::parse(text).map_err(|e| foreign(e.to_string()))?;
    same_run(path, &metadata.run, run)?;
    let tensors = SafeTensors::deserialize(&file).map_err(|e| foreign(e.to_string()))?;
    let tensor = |name: &str| -> Result<Vec<f32>, CheckpointError> {
        let view = tensors.tensor(name).map_err(|_| foreign(format!("tensor '{name}' is missing")))?;
        if view.dtype() != Dtype::F32 {
            return Err(foreign(format!("tensor '{name}' is {}, expected F32", view.dtype())));
        }
        Ok(view.data().chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
    };
    let state = State {
        step: metadata.step,
        weights: tensor("weights")?,
        average: tensor("average")?,
        adam: Adam { steps: metadata.adam_steps, mean: tensor("adam_mean")?, square: tensor("adam_square")? },
        cell_errors: tensor("cell_errors")?,
        best_weights: tensor("best_weights")?,
        steering: SparsityController {
            lambdas: tensor("lambdas")?,
            counted: tensor("non_zeros_counted")?,
            aims: tensor("non_zeros_aims")?,
        },
        best: Best {
            score: f64::from_bits(metadata.best_score_bits),
            db: f64::from_bits(metadata.best_db_bits),
            within_budget: metadata.best_within_budget,
        },
        stale: metadata.stale,
    };
    let lengths = [&state.average, &state.adam.mean, &state.adam.square, &state.best_weights].map(Vec::len);
    let layers = [&state.steering.counted, &state.steering.aims].map(Vec::len);
    if lengths.iter().any(|l| *l != state.weights.len())
        || layers.iter().any(|l| *l != state.steering.lambdas.len())
    {
        return Err(foreign("its tensors differ in length".to_owned()));
    }
    Ok(state)
}

const fn named(state: &State) -> [(&'static str, &Vec<f32>); 9] {
    [
        ("weights", &state.weights),
        ("average", &state.average),
        ("adam_mean", &state.adam.mean),
        ("adam_square", &state.adam.square),
        ("cell_errors", &state.cell_errors),
        ("lambdas", &state.steering.lambdas),
        ("non_zeros_counted", &state.steering.counted),
        ("non_zeros_aims", &state.steering.aims),
        ("best_weights", &state.best_weights),
    ]
}

fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn same_run(path: &Path, found: &Run, asked: &Run) -> Result<(), CheckpointError> {
    let camera = |text: &String| serde_json::from_str(text).unwrap_or_else(|_| Value::from(text.as_str()));
    let fields: [(&'static str, Value, Value); 5] = [
        // Fields of a recipe are options.
        ("", json(&found.recipe), json(&asked.recipe)),
        ("camera", camera(&found.camera), camera(&asked.camera)),
        ("photos", json(&found.photos), json(&asked.photos)),
        ("psi", json(&found.psis), json(&asked.psis)),
        ("from", json(&found.from), json(&asked.from)),
    ];
    match fields.into_iter().find(|(_, found, asked)| found != asked) {
        Some((field, found, asked)) => {
            let (field, found, asked) = difference(field.to_owned(), &found, &asked);
            Err(CheckpointError::OtherRun { path: path.to_owned(), field, found, asked })
        }
        None => Ok(()),
    }
}

/// The first field in which two values differ, and what it is in each.
fn difference(field: String, found: &Value, asked: &Value) -> (String, String, String) {
    match (found, asked) {
        (Value::Object(own), Value::Object(other)) => {
            let mut keys = own.keys().chain(other.keys());
            let differs = |key: &&String| own.get(*key) != other.get(*key);
            if let Some(key) = keys.find(differs) {
                let dot = if field.is_empty() { "" } else { "." };
                let of = |map: &serde_json::Map<String, Value>| map.get(key).cloned().unwrap_or_default();
                return difference(format!("{field}{dot}{key}"), &of(own), &of(other));
            }
        }
        (Value::Array(own), Value::Array(other)) if own.len() == other.len() => {
            if let Some(place) = (0..own.len()).find(|place| own[*place] != other[*place]) {
                return difference(format!("{field}[{place}]"), &own[place], &other[place]);
            }
        }
        (Value::Array(own), Value::Array(other)) => {
            return (field, format!("({} of them)", own.len()), format!("{} of them", other.len()));
        }
        _ => {}
    }
    let shown = |value: &Value| if value.is_null() { "none".to_owned() } else { value.to_string() };
    (field, shown(found), shown(asked))
}

fn json(value: &impl Serialize) -> Value {
    serde_json::to_value(value).unwrap_or_default()
}
