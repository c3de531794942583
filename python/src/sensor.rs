//! Corrections of sensors: from dark and flat frames, from files, and their use.

use crate::arguments::{array, positive, whole, word};
use crate::error::{OrRaise, failed, wrong_type};
use crate::shot::black_level as black;
use crate::{job, json};
use edof_core::{CfaPhase, RawFrame};
use edof_io::raw::Size;
use edof_io::sensor::measure::{Frames, Limits, Sensor};
use edof_io::sensor::{Correction, Defects, file};
use ndarray::{Axis, Ix2, Ix3};
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A correction of a sensor. See `edof.Sensor` in the type stubs.
#[pyclass(frozen, name = "Sensor", module = "edof")]
pub struct PySensor {
    correction: Arc<Correction>,
    report: serde_json::Value,
}

/// Frames of a measurement: rows × columns each.
fn frames(
    value: Option<&Bound<'_, PyAny>>,
    name: &str,
    depth: u32,
    phase: CfaPhase,
) -> PyResult<Option<Frames>> {
    let Some(value) = value else { return Ok(None) };
    let all = array::<u16, Ix3>(value, name, "frames x rows x columns of sensor values")?;
    let mut frames: Option<Frames> = None;
    for frame in all.as_array().axis_iter(Axis(0)) {
        let frame = RawFrame::from_view(frame, depth, phase).or_raise()?;
        match &mut frames {
            None => frames = Some(Frames::new(&frame)),
            Some(frames) => frames.add(&frame).or_raise()?,
        }
    }
    frames.map(Some).ok_or_else(|| failed(format!("{name}: no frames, expected at least one")))
}

#[pymethods]
impl PySensor {
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let (correction, _) = file::load(&path).or_raise()?;
        Ok(Self { correction: Arc::new(correction), report: serde_json::Value::Null })
    }

    #[staticmethod]
    #[pyo3(signature = (dark = None, flat = None, *, bit_depth = None, phase = "rggb", black_level = None, white_level = None, hot = None, dead = None,
        pixels = vec![], columns = vec![], rows = vec![]))]
    #[allow(clippy::too_many_arguments, reason = "what a sensor is measured by")]
    fn measure(
        py: Python<'_>,
        dark: Option<&Bound<'_, PyAny>>,
        flat: Option<&Bound<'_, PyAny>>,
        bit_depth: Option<&Bound<'_, PyAny>>,
        phase: &str,
        black_level: Option<&Bound<'_, PyAny>>,
        white_level: Option<f64>,
        hot: Option<f64>,
        dead: Option<f64>,
        pixels: Vec<[u32; 2]>,
        columns: Vec<u32>,
        rows: Vec<u32>,
    ) -> PyResult<Self> {
        let depth = bit_depth.map_or(Ok(16), |value| whole(value, "bit_depth", 8, 16))? as u32;
        let phase = word(phase)?;
        if dark.is_some() && black_level.is_some() {
            return Err(failed("black_level: dark frames state it; leave it out"));
        }
        let (dark, flat) = (frames(dark, "dark", depth, phase)?, frames(flat, "flat", depth, phase)?);
        let own = dark.as_ref().or(flat.as_ref()).map(Frames::sensor);
        let (size, ..) = own.ok_or_else(|| failed("dark, flat: no frames, expected at least one of both"))?;
        let usual = Limits::default();
        let limits = Limits {
            hot: positive(hot.unwrap_or(usual.hot), "hot")?,
            dead: positive(dead.unwrap_or(usual.dead), "dead")?,
            black: black_level.map(black).transpose()?.unwrap_or_default(),
            white: white_level,
        };
        let known = Defects { pixels, columns, rows };
        let (correction, report) = job::run(py, move |_| {
            Sensor { size, phase, depth, dark: dark.as_ref(), flat: flat.as_ref(), known }.measured(&limits)
        })?
        .or_raise()?;
        Ok(Self { correction: Arc::new(correction), report: serde_json::to_value(report).or_raise()? })
    }

    fn save(&self, path: PathBuf) -> PyResult<()> {
        file::save(&path, &self.correction, None).or_raise()
    }

    fn light<'py>(&self, py: Python<'py>, raw: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let raw = array::<u16, Ix2>(raw, "raw", "rows x columns of sensor values")?;
        let tables = self.correction.tables();
        let frame = RawFrame::from_view(raw.as_array(), tables.depth, tables.phase).or_raise()?;
        Ok(self.correction.light(&frame).or_raise()?.into_pixels().into_pyarray(py))
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        let Size { width, height } = self.correction.tables().size;
        (height, width)
    }

    #[getter]
    fn phase(&self) -> String {
        self.correction.tables().phase.to_string()
    }

    #[getter]
    fn bit_depth(&self) -> u32 {
        self.correction.tables().depth
    }

    #[getter]
    fn defects<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<bool>> {
        self.correction.defects().mask().clone().into_pyarray(py)
    }

    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::plain(py, &self.report)
    }
}

/// A correction, or the path of its file.
pub fn sensor(value: &Bound<'_, PyAny>) -> PyResult<Arc<Correction>> {
    if let Ok(sensor) = value.cast::<PySensor>() {
        return Ok(Arc::clone(&sensor.get().correction));
    }
    match value.extract::<PathBuf>() {
        Ok(path) => Ok(Arc::new(file::load(&path).or_raise()?.0)),
        Err(_) => Err(wrong_type("sensor", value, "a Sensor, or the path of a sensor file")),
    }
}
