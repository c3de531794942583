//! The cycle model: what passes every boundary of a generated chain, and when.

use crate::arguments::{array, whole};
use crate::error::{OrRaise, failed};
use crate::job;
use crate::reconstruct::fixed;
use edof_core::number::InputWord;
use edof_cosim::chain::check::boundary_names;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_golden::cycle::{Cycle, Patch, PatchRun, Stalls};
use ndarray::{Array1, Array2, ArrayView1, Ix2};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Most cycles of a pattern.
const MAX_CYCLES: u64 = 1 << 32;

/// Stalls of both ends: in `stalled` of 256 cycles, random from a seed.
fn stalls(seed: Option<&Bound<'_, PyAny>>, stalled: Option<&Bound<'_, PyAny>>) -> PyResult<Stalls> {
    let seed = seed.map_or(Ok(0), |value| whole(value, "seed", 0, u64::MAX))?;
    let stalled = stalled.map_or(Ok(0), |value| whole(value, "stalled", 0, 255))?;
    Ok(if stalled == 0 { Stalls::NEVER } else { Stalls::drawn(seed, stalled as u8) })
}

/// Cycles in which the source and the sink of such stalls act.
#[pyfunction]
#[pyo3(signature = (cycles, *, seed = None, stalled = None))]
#[allow(clippy::type_complexity, reason = "two arrays")]
pub fn stall_pattern<'py>(
    py: Python<'py>,
    cycles: &Bound<'py, PyAny>,
    seed: Option<&Bound<'py, PyAny>>,
    stalled: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<bool>>)> {
    let (cycles, stalls) = (whole(cycles, "cycles", 0, MAX_CYCLES)?, self::stalls(seed, stalled)?);
    let [source, sink] = [stalls.source, stalls.sink]
        .map(|end| py.detach(|| (0..cycles).map(|cycle| end.go(cycle)).collect::<Array1<bool>>()));
    Ok((source.into_pyarray(py), sink.into_pyarray(py)))
}

/// What passes every boundary of a design's chain: one dict each.
pub fn cycles<'py>(
    py: Python<'py>,
    design: &Design,
    network: &Bound<'py, PyAny>,
    windows: &Bound<'py, PyAny>,
    seed: Option<&Bound<'py, PyAny>>,
    stalled: Option<&Bound<'py, PyAny>>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let (golden, stalls) = (fixed(network)?, self::stalls(seed, stalled)?);
    let windows = array::<i16, Ix2>(windows, "windows", "windows x pixels")?;
    let (count, pixels) = windows.as_array().dim();
    let expected = design.form.window.pixels();
    if count == 0 || pixels != expected {
        return Err(failed(format!("windows: shape ({count}, {pixels}), expected (1 or more, {expected})")));
    }
    if let Some(word) = windows.as_array().iter().find(|word| **word < 0) {
        return Err(failed(format!("windows: holds {word}, expected 0 to 32767")));
    }
    let window = |row: ArrayView1<'_, i16>| row.iter().map(|word| InputWord::from_bits(*word)).collect();
    let patches: Vec<Patch> =
        windows.as_array().outer_iter().map(|row| Patch { window: window(row), set: Set::First }).collect();
    let model = Cycle::new(design, [golden.network(), golden.network()]).or_raise()?.stalls(stalls);
    let runs: Vec<PatchRun> = job::run(py, move |_| model.run(patches).collect())?;
    let names = boundary_names(design.stages.len());
    names.iter().enumerate().map(|(boundary, name)| passing(py, &runs, boundary, name)).collect()
}

/// All beats of one boundary.
fn passing<'py>(
    py: Python<'py>,
    runs: &[PatchRun],
    boundary: usize,
    (name, stage): &(String, String),
) -> PyResult<Bound<'py, PyDict>> {
    let beats =
        || runs.iter().flat_map(move |run| run.transfers(boundary).map(move |beat| (run.index, beat)));
    let two = |of: &dyn Fn(&edof_golden::cycle::Transfer) -> [i16; 2]| {
        let words: Vec<i16> = beats().flat_map(|(_, beat)| of(&beat)).collect();
        Array2::from_shape_vec((words.len() / 2, 2), words).or_raise()
    };
    let all = PyDict::new(py);
    all.set_item("boundary", name)?;
    all.set_item("stage", stage)?;
    all.set_item("patch", beats().map(|(patch, _)| patch).collect::<Array1<u64>>().into_pyarray(py))?;
    all.set_item("cycle", beats().map(|(_, beat)| beat.cycle).collect::<Array1<u64>>().into_pyarray(py))?;
    all.set_item("last", beats().map(|(_, beat)| beat.last).collect::<Array1<bool>>().into_pyarray(py))?;
    all.set_item("words", two(&|beat| beat.words)?.into_pyarray(py))?;
    if beats().next().is_some_and(|(_, beat)| beat.base.is_some()) {
        all.set_item("base", two(&|beat| beat.base.unwrap_or_default())?.into_pyarray(py))?;
    }
    Ok(all)
}
