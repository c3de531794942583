//! Designs: what they take, what else would fit, and their sources.

use crate::arguments::{name, positive};
use crate::error::{OrRaise, failed, wrong_type};
use crate::reconstruct::fixed;
use crate::shot;
use crate::{job, json};
use edof::presets::designs;
use edof_core::RawFrame;
use edof_cosim::bitstream::Sources;
use edof_cosim::estimate::{Estimated, MeasureError, Measured, Picture};
use edof_cosim::explore::{self, any_folding};
use edof_device::Design;
use edof_golden::cycle::Cycle;
use edof_golden::cycle::explore::front;
use edof_network::FixedNetwork;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A calculator and the board around it. See `edof.Design` in the type stubs.
#[pyclass(frozen, name = "Design", module = "edof")]
pub struct PyDesign(Arc<Design>);

/// A design argument: a `Design`, its name or a file.
pub fn design(value: &Bound<'_, PyAny>) -> PyResult<Design> {
    if let Ok(design) = value.cast::<PyDesign>() {
        return Ok((*design.get().0).clone());
    }
    let name = name(value, "design", "a Design, its name, or the path of a JSON file")?;
    designs::load(&name).or_raise()
}

/// Raw frames of a design's network, as light.
fn frames(
    raw: &Bound<'_, PyAny>,
    bit_depth: Option<&Bound<'_, PyAny>>,
    phase: Option<&str>,
) -> PyResult<Vec<RawFrame>> {
    let all: Vec<Bound<'_, PyAny>> = match shot::is_one(raw) {
        true => vec![raw.clone()],
        false => raw.extract().map_err(|_| wrong_type("raw", raw, "a raw frame, or a list of them"))?,
    };
    if all.is_empty() {
        return Err(failed("raw: no frames, expected one at least"));
    }
    // As the calculator takes them: red first.
    all.iter()
        .map(|raw| Ok(shot::frame(raw, bit_depth, phase, None, None, None)?.to_rggb().0.into_owned()))
        .collect()
}

impl PyDesign {
    /// A design that was checked.
    pub fn of(design: Design) -> Self {
        Self(Arc::new(design))
    }

    fn fits(&self, network: &FixedNetwork) -> PyResult<()> {
        designs::fits(&self.0, network).or_raise()
    }
}

#[pymethods]
impl PyDesign {
    #[new]
    fn new(name_or_path: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self::of(design(name_or_path)?))
    }

    /// Names of the designs that come with edof.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        designs::names()
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        Ok(Self::of(Design::from_json(text).or_raise()?))
    }

    fn json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&*self.0).or_raise()
    }

    #[pyo3(signature = (network = None, raw = None, *, bit_depth = None, phase = None))]
    fn estimate<'py>(
        &self,
        py: Python<'py>,
        network: Option<&Bound<'py, PyAny>>,
        raw: Option<&Bound<'py, PyAny>>,
        bit_depth: Option<&Bound<'py, PyAny>>,
        phase: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.0.clocks().or_raise()?;
        let design = Arc::clone(&self.0);
        let (golden, frames) = match (network, raw) {
            (None, None) => return json::plain(py, &Estimated::new(&design, None).json(None)),
            (Some(network), Some(raw)) => (fixed(network)?, frames(raw, bit_depth, phase)?),
            (Some(_), None) => return Err(failed("raw: expected raw frames to measure the network on")),
            (None, Some(_)) => return Err(failed("network: expected one, to measure raw frames with")),
        };
        self.fits(golden.network())?;
        let told = job::run(py, move |stop| {
            let network = golden.network();
            let pictures = frames.iter().enumerate().map(|(index, raw)| {
                Picture::measure(format!("raw[{index}]"), &design, network, raw, || job::flow(stop))
            });
            let measured = Measured(pictures.collect::<Result<Vec<_>, MeasureError>>()?);
            Ok::<_, MeasureError>(Estimated::new(&design, Some(&measured)).json(Some(&network.origin.name)))
        })?;
        json::plain(py, &told.or_raise()?)
    }

    #[pyo3(signature = (network, raw, *, bit_depth = None, phase = None, fps = 60.0))]
    fn explore<'py>(
        &self,
        py: Python<'py>,
        network: &Bound<'py, PyAny>,
        raw: &Bound<'py, PyAny>,
        bit_depth: Option<&Bound<'py, PyAny>>,
        phase: Option<&str>,
        fps: f64,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let (golden, frames, fps) = (fixed(network)?, frames(raw, bit_depth, phase)?, positive(fps, "fps")?);
        let base = Arc::clone(&self.0);
        let work = move |stop: &AtomicBool| {
            let network = golden.network();
            let design = any_folding(&base, network).or_raise()?;
            let model = Cycle::new(&design, [network, network]).or_raise()?;
            let pairs = |raw| explore::pairs(&model, network, raw, || job::flow(stop)).or_raise();
            let pictures = frames.iter().map(pairs).collect::<PyResult<Vec<_>>>()?;
            explore::found(&base, network, &pictures, || job::flow(stop)).or_raise()
        };
        let mut found = job::run(py, work)??;
        let fast = found.iter().any(|one| one.frames >= fps);
        found.retain(|one| !fast || one.frames >= fps);
        let figures: Vec<[f64; 3]> = found
            .iter()
            .map(|one| [one.cycles, one.used.multipliers as f64, one.used.whole_memories()])
            .collect();
        let kept = found.iter().zip(front(&figures)).filter_map(|(one, keep)| keep.then_some(one));
        kept.map(|one| {
            let row = PyDict::new(py);
            row.set_item("stages", &one.words)?;
            row.set_item("cycles_per_patch", one.cycles)?;
            row.set_item("worst_picture_cycles_per_patch", one.worst_cycles)?;
            row.set_item("frames_per_second", one.frames)?;
            row.set_item("resources", json::plain(py, &one.design.board.part.named(&one.used))?)?;
            row.set_item("design", Py::new(py, Self::of(one.design.clone()))?)?;
            Ok(row)
        })
        .collect()
    }

    #[pyo3(signature = (network, out, *, force = false))]
    fn generate<'py>(
        &self,
        py: Python<'py>,
        network: &Bound<'py, PyAny>,
        out: PathBuf,
        force: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (golden, design) = (fixed(network)?, Arc::clone(&self.0));
        self.fits(golden.network())?;
        let sources = job::run(py, move |_| Sources::of(&design, golden.network()))?.or_raise()?;
        let manifest = py.detach(|| sources.write(&out, force)).or_raise()?;
        json::plain(py, &manifest)
    }

    #[pyo3(signature = (network, windows, *, seed = None, stalled = None))]
    fn cycles<'py>(
        &self,
        py: Python<'py>,
        network: &Bound<'py, PyAny>,
        windows: &Bound<'py, PyAny>,
        seed: Option<&Bound<'py, PyAny>>,
        stalled: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        crate::cycles::cycles(py, &self.0, network, windows, seed, stalled)
    }

    /// A network of random words that fits the design, to try hardware with.
    #[pyo3(signature = (seed = 1))]
    fn random_network(&self, seed: u64) -> PyResult<crate::network::PyFixedNetwork> {
        crate::network::PyFixedNetwork::of(edof_device::random::for_design(&self.0, seed))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Rows and columns of its frames.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.0.frame.height, self.0.frame.width)
    }

    #[getter]
    fn clock_mhz(&self) -> f64 {
        self.0.clock_mhz
    }

    fn __repr__(&self) -> String {
        format!(
            "Design({}, {}x{}, {} MHz)",
            self.0.name, self.0.frame.width, self.0.frame.height, self.0.clock_mhz
        )
    }
}
