//! What people use instead of the network: demosaicing, deconvolution, pursuits.

use crate::arguments::{array, finite, number, owned, positive, size, word};
use crate::error::{OrRaise, failed};
use crate::job;
use crate::shot::frame;
use edof_deblur::blind::{self, Settings};
use edof_deblur::hyper_laplacian::Prior;
use edof_deblur::{Demosaicing, hyper_laplacian, known};
use edof_numerics::sparse::ksvd;
use edof_numerics::sparse::lasso::{Effort, Lasso};
use edof_numerics::sparse::omp::{Omp, Stop};
use ndarray::{Array2, Ix1, Ix2};
use numpy::{IntoPyArray, PyArray2, PyArray3};
use pyo3::prelude::*;

/// Most steps, atoms or rounds that are asked for.
const MAX: usize = 1 << 20;

/// A raw frame as a plain camera would show it.
#[pyfunction]
#[pyo3(signature = (raw, *, method = "malvar", bit_depth = None, phase = None, black_level = None, white_level = None, sensor = None))]
#[allow(clippy::too_many_arguments, reason = "what a frame is")]
pub fn demosaic<'py>(
    py: Python<'py>,
    raw: &Bound<'py, PyAny>,
    method: &str,
    bit_depth: Option<&Bound<'py, PyAny>>,
    phase: Option<&str>,
    black_level: Option<&Bound<'py, PyAny>>,
    white_level: Option<f64>,
    sensor: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let way = word::<Demosaicing>(method)?.reconstructor();
    let raw = frame(raw, bit_depth, phase, black_level, white_level, sensor)?;
    let light = job::run(py, move |_| way.reconstruct(&raw))?.or_raise()?.frame;
    Ok(light.planes.into_pyarray(py))
}

fn plane(value: &Bound<'_, PyAny>) -> PyResult<Array2<f32>> {
    let plane = owned(finite::<Ix2>(value, "plane", "rows x columns of light, 0 to 1")?.as_array());
    if plane.is_empty() {
        return Err(failed(format!("plane: shape {:?}, expected one pixel at least", plane.shape())));
    }
    Ok(plane)
}

/// A kernel of odd sides, nowhere negative, with some light.
fn kernel(value: &Bound<'_, PyAny>) -> PyResult<Array2<f32>> {
    let kernel = owned(finite::<Ix2>(value, "kernel", "rows x columns, of odd sides, sum 1")?.as_array());
    let (height, width) = kernel.dim();
    if height % 2 == 0 || width % 2 == 0 {
        return Err(failed(format!("kernel {height}x{width}: must have odd sides")));
    }
    let sum = kernel.sum();
    if (sum - 1.0).abs() > 1e-3 {
        return Err(failed(format!("kernel: sums to {sum}, must sum to 1")));
    }
    Ok(kernel)
}

/// The linear filter of least mean square error.
#[pyfunction]
#[pyo3(signature = (plane, kernel, *, noise_to_contrast = 0.01))]
pub fn wiener<'py>(
    py: Python<'py>,
    plane: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
    noise_to_contrast: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (plane, kernel) = (self::plane(plane)?, self::kernel(kernel)?);
    let weight = positive(noise_to_contrast, "noise_to_contrast")? as f32;
    let sharp = job::run(py, move |_| known::wiener(plane.view(), kernel.view(), weight))?;
    Ok(sharp.into_pyarray(py))
}

/// The most likely light behind counted photons.
#[pyfunction]
#[pyo3(signature = (plane, kernel, *, steps = None))]
pub fn richardson_lucy<'py>(
    py: Python<'py>,
    plane: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
    steps: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (plane, kernel) = (self::plane(plane)?, self::kernel(kernel)?);
    let steps = steps.map_or(Ok(30), |value| size(value, "steps", 0, MAX))?;
    let sharp = job::run(py, move |_| known::richardson_lucy(plane.view(), kernel.view(), steps))?;
    Ok(sharp.into_pyarray(py))
}

fn prior(weight: f64, alpha: f64) -> PyResult<Prior> {
    let alpha = positive(alpha, "alpha")?;
    if alpha > 1.0 {
        return Err(failed(format!("alpha {alpha}: must be at most 1")));
    }
    Ok(Prior { lambda: positive(weight, "weight")? as f32, alpha: alpha as f32 })
}

/// Deconvolution under a prior of few and large differences.
#[pyfunction]
#[pyo3(name = "hyper_laplacian", signature = (plane, kernel, *, weight = 3000.0, alpha = 0.8))]
pub fn sharpened<'py>(
    py: Python<'py>,
    plane: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
    weight: f64,
    alpha: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (plane, kernel, prior) = (self::plane(plane)?, self::kernel(kernel)?, prior(weight, alpha)?);
    let work = move |_: &_| hyper_laplacian::hyper_laplacian(plane.view(), kernel.view(), prior);
    Ok(job::run(py, work)?.into_pyarray(py))
}

/// Kernel and picture together.
#[pyfunction]
#[pyo3(signature = (plane, *, side = None))]
#[allow(clippy::type_complexity, reason = "two arrays")]
pub fn blind_deconvolution<'py>(
    py: Python<'py>,
    plane: &Bound<'py, PyAny>,
    side: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>)> {
    let plane = self::plane(plane)?;
    let side = side.map_or(Ok(25), |value| size(value, "side", 3, 255))?;
    if side % 2 == 0 {
        return Err(failed(format!("side {side}: must be odd")));
    }
    let settings = Settings { side, ..Settings::default() };
    let found = job::run(py, move |_| blind::deconvolve(plane.view(), &settings))?;
    Ok((found.picture.into_pyarray(py), found.kernel.into_pyarray(py)))
}

/// Signals (rows) and a dictionary (columns) that fit each other.
fn pair(signals: &Bound<'_, PyAny>, dictionary: &Bound<'_, PyAny>) -> PyResult<(Array2<f32>, Array2<f32>)> {
    let signals = owned(finite::<Ix2>(signals, "signals", "signals x length")?.as_array());
    let dictionary = owned(finite::<Ix2>(dictionary, "dictionary", "length x atoms")?.as_array());
    let ((_, length), (rows, atoms)) = (signals.dim(), dictionary.dim());
    if length != rows || rows == 0 || atoms == 0 {
        return Err(failed(format!(
            "dictionary: shape ({rows}, {atoms}), expected ({length}, 1 or more) as signals"
        )));
    }
    Ok((signals, dictionary))
}

/// Orthogonal matching pursuit.
#[pyfunction]
#[pyo3(signature = (signals, dictionary, *, atoms, residual = 0.0))]
pub fn omp<'py>(
    py: Python<'py>,
    signals: &Bound<'py, PyAny>,
    dictionary: &Bound<'py, PyAny>,
    atoms: &Bound<'py, PyAny>,
    residual: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (signals, dictionary) = pair(signals, dictionary)?;
    let atoms = size(atoms, "atoms", 0, MAX)?;
    let residual = number(residual, "residual")? as f32;
    if residual < 0.0 {
        return Err(failed(format!("residual {residual}: must be 0 or more")));
    }
    let codes = job::run(py, move |_| {
        let codes = Omp::new(dictionary.view(), 0).codes(signals.view(), Stop { atoms, residual });
        codes.to_dense(dictionary.ncols())
    })?;
    Ok(codes.into_pyarray(py))
}

/// The minimum of a convex objective by FISTA or ISTA.
#[pyfunction]
#[pyo3(signature = (signals, dictionary, penalty, *, method = "fista", steps = None, tolerance = 1e-4))]
pub fn lasso<'py>(
    py: Python<'py>,
    signals: &Bound<'py, PyAny>,
    dictionary: &Bound<'py, PyAny>,
    penalty: &Bound<'py, PyAny>,
    method: &str,
    steps: Option<&Bound<'py, PyAny>>,
    tolerance: f64,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (signals, dictionary) = pair(signals, dictionary)?;
    let penalties = match penalty.extract::<f64>() {
        Ok(all) => ndarray::Array1::from_elem(dictionary.ncols(), all as f32),
        Err(_) => owned(array::<f32, Ix1>(penalty, "penalty", "one number per atom")?.as_array()),
    };
    let (found, expected) = (penalties.len(), dictionary.ncols());
    if found != expected {
        return Err(failed(format!("penalty: {found} numbers, expected {expected}, one per atom")));
    }
    if let Some(value) = penalties.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        return Err(failed(format!("penalty: holds {value}, expected finite numbers of 0 or more")));
    }
    let tolerance = number(tolerance, "tolerance")? as f32;
    let effort = Effort { steps: steps.map_or(Ok(200), |value| size(value, "steps", 0, MAX))?, tolerance };
    let descend = match method {
        "fista" => Lasso::fista,
        "ista" => Lasso::ista,
        _ => return Err(failed(format!("method '{method}': must be fista or ista"))),
    };
    let work = move |_: &_| {
        let lasso = Lasso::new(dictionary.view(), penalties.view(), 0);
        descend(&lasso, signals.view(), effort).codes
    };
    Ok(job::run(py, work)?.into_pyarray(py))
}

/// A dictionary in which signals have codes of few atoms.
#[pyfunction]
#[pyo3(name = "ksvd", signature = (signals, start, *, atoms, rounds))]
pub fn learned<'py>(
    py: Python<'py>,
    signals: &Bound<'py, PyAny>,
    start: &Bound<'py, PyAny>,
    atoms: &Bound<'py, PyAny>,
    rounds: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let (signals, start) = pair(signals, start)?;
    let (atoms, rounds) = (size(atoms, "atoms", 1, MAX)?, size(rounds, "rounds", 0, MAX)?);
    let settings = ksvd::Settings { atoms, rounds, free: 0 };
    let fitted = job::run(py, move |_| ksvd::ksvd(signals.view(), start, settings))?;
    Ok(fitted.dictionary.into_pyarray(py))
}
