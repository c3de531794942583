//! Pictures in files, and how far one is from another.

use crate::arguments::{picture, size, word};
use crate::error::{OrRaise, failed};
use crate::job;
use crate::reconstruct::curve;
use edof_core::Tone;
use edof_io::photo;
use edof_study::metrics::{BORDER, METRICS, Metric, Quality, Score};
use numpy::{IntoPyArray, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

/// Largest border that is cropped.
const MAX_BORDER: usize = 1 << 16;

/// Reads a photograph.
#[pyfunction]
pub fn load_picture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let picture = job::run(py, move |_| photo::load(&path))?.or_raise()?;
    Ok(picture.planes.into_pyarray(py))
}

/// Writes light as a picture.
#[pyfunction]
#[pyo3(signature = (path, light, *, curve = "srgb", bits = None))]
pub fn save_picture(
    py: Python<'_>,
    path: PathBuf,
    light: &Bound<'_, PyAny>,
    curve: &str,
    bits: Option<&Bound<'_, PyAny>>,
) -> PyResult<()> {
    let bits = bits.map_or(Ok(8), |value| size(value, "bits", 8, 16))? as u32;
    let (light, curve) = (picture(light, "light")?, self::curve(curve)?);
    job::run(py, move |_| photo::save(&path, &curve.encoded(light), bits))?.or_raise()
}

/// Every metric of edof that the pictures are large enough for, by name.
#[pyfunction]
#[pyo3(signature = (truth, estimate, *, border = None, tone = "linear"))]
pub fn quality<'py>(
    py: Python<'py>,
    truth: &Bound<'py, PyAny>,
    estimate: &Bound<'py, PyAny>,
    border: Option<&Bound<'py, PyAny>>,
    tone: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let border = border.map_or(Ok(BORDER), |value| size(value, "border", 0, MAX_BORDER))?;
    let (truth, estimate) = (picture(truth, "truth")?, picture(estimate, "estimate")?);
    let tone = word::<Tone>(tone)?;
    let quality = job::run(py, move |_| Quality::of(&truth, &estimate, border, tone))?.or_raise()?;
    let out = PyDict::new(py);
    for (metric, score) in quality.scores() {
        match score {
            Score::One(number) => out.set_item(metric.name, number)?,
            Score::Colours(numbers) => out.set_item(metric.name, numbers)?,
        }
    }
    Ok(out)
}

/// Every metric: its name, title, unit, the smallest side that it measures, and which of two numbers is better.
#[pyfunction]
pub fn metrics(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let of = |metric: &Metric| {
        let Metric { name, title, unit, better, min_side, .. } = metric;
        json!({ "name": name, "title": title, "unit": unit, "better": better, "min_side": min_side })
    };
    crate::json::plain(py, &METRICS.iter().map(of).collect::<Vec<_>>())
}

/// PSNR in dB over all colours, peak 1.
#[pyfunction]
#[pyo3(signature = (truth, estimate, *, border = None))]
pub fn psnr<'py>(
    py: Python<'py>,
    truth: &Bound<'py, PyAny>,
    estimate: &Bound<'py, PyAny>,
    border: Option<&Bound<'py, PyAny>>,
) -> PyResult<f64> {
    let border = border.map_or(Ok(BORDER), |value| size(value, "border", 0, MAX_BORDER))?;
    let (truth, estimate) = (picture(truth, "truth")?, picture(estimate, "estimate")?);
    let (sizes, (height, width)) = ((truth.size(), estimate.size()), truth.size());
    if sizes.0 != sizes.1 {
        return Err(failed(format!("estimate: {:?} pixels, expected {:?} as truth", sizes.1, sizes.0)));
    }
    if height <= 2 * border || width <= 2 * border {
        return Err(failed(format!("border {border}: leaves nothing of {height} rows x {width} columns")));
    }
    py.detach(|| edof_study::metrics::psnr(&truth, &estimate, border)).or_raise()
}
