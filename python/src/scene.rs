//! Scenes, and what a camera makes of them.

use crate::arguments::{PLANE, finite, noise, number, owned, picture, size, whole, word};
use crate::camera::{PyCamera, camera};
use crate::error::{OrRaise, failed, wrong_type};
use crate::{job, json, optics};
use edof_core::ColourFrame;
use edof_core::camera::Camera;
use edof_optics::Sensor;
use edof_optics::capture::{self, Approximation};
use edof_optics::draw::{four_depths, parse_name};
use edof_optics::layers::{MAX_LAYERS, from_depths};
use edof_optics::{Layer, Scene};
use ndarray::{Array2, Axis, Ix2, Zip};
use numpy::{IntoPyArray, PyArray2, PyArray3};
use pyo3::prelude::*;
use std::sync::Arc;

/// Largest side of a synthetic scene in pixels.
const MAX_SIDE: usize = 1 << 16;

/// Layers of light at depths. See `edof.Scene` in the type stubs.
#[pyclass(frozen, name = "Scene", module = "edof")]
pub struct PyScene(Arc<Scene>);

impl PyScene {
    fn checked(scene: Scene) -> PyResult<Self> {
        scene.check().or_raise()?;
        Ok(Self(Arc::new(scene)))
    }
}

#[pymethods]
impl PyScene {
    #[staticmethod]
    fn flat(light: &Bound<'_, PyAny>, psi: f64) -> PyResult<Self> {
        Self::checked(Scene::flat("array", picture(light, "light")?, psi))
    }

    #[staticmethod]
    #[pyo3(signature = (light, psi, *, layers = None))]
    fn from_depths(
        py: Python<'_>,
        light: &Bound<'_, PyAny>,
        psi: &Bound<'_, PyAny>,
        layers: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let layers = layers.map_or(Ok(16), |value| size(value, "layers", 1, MAX_LAYERS))?;
        let light = picture(light, "light")?;
        let psi = owned(finite::<Ix2>(psi, "psi", PLANE)?.as_array());
        let scene = job::run(py, move |_| from_depths("array", &light, &psi, layers))?.or_raise()?;
        Ok(Self(Arc::new(scene)))
    }

    #[staticmethod]
    fn from_layers(layers: &Bound<'_, PyAny>) -> PyResult<Self> {
        let expected = "a list of (light, matte or None, psi), the background first";
        let items: Vec<Bound<'_, PyAny>> =
            layers.extract().map_err(|_| wrong_type("layers", layers, expected))?;
        let layer = |(index, item): (usize, &Bound<'_, PyAny>)| {
            let name = format!("layers[{index}]");
            let parts: (Bound<'_, PyAny>, Option<Bound<'_, PyAny>>, f64) =
                item.extract().map_err(|_| wrong_type(&name, item, "(light, matte or None, psi)"))?;
            let (light, matte, psi) = parts;
            let light = picture(&light, &format!("{name}.light"))?;
            let matte = matte.map(|matte| self::matte(&matte, &format!("{name}.matte"))).transpose()?;
            Ok(Layer {
                light: covered(light, matte.as_ref()),
                matte,
                psi: number(psi, &format!("{name}.psi"))?,
            })
        };
        let layers = items.iter().enumerate().map(layer).collect::<PyResult<Vec<_>>>()?;
        Self::checked(Scene { name: "layers".to_owned(), layers })
    }

    #[staticmethod]
    #[pyo3(signature = (kind, rows, columns, *, psi = None, camera = None, seed = None))]
    fn draw(
        py: Python<'_>,
        kind: &str,
        rows: &Bound<'_, PyAny>,
        columns: &Bound<'_, PyAny>,
        psi: Option<Vec<f64>>,
        camera: Option<&Bound<'_, PyAny>>,
        seed: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (builtin, depths) = parse_name(kind).or_raise()?;
        let [rows, columns] =
            [(rows, "rows"), (columns, "columns")].map(|(v, name)| size(v, name, 1, MAX_SIDE));
        let (rows, columns) = (rows?, columns?);
        let seed = seed.map_or(Ok(0), |value| whole(value, "seed", 0, u64::MAX))?;
        let psi = match (psi, camera) {
            (Some(psi), _) => psi,
            (None, Some(camera)) => {
                let range = self::camera(camera)?.psi_range;
                if depths == 1 { vec![range[1]] } else { four_depths(range).to_vec() }
            }
            (None, None) => {
                return Err(failed("psi: give one value per depth, or a camera whose range is used"));
            }
        };
        if psi.len() != depths {
            return Err(failed(format!("psi: {} values, {kind} has {depths} depths", psi.len())));
        }
        let drawn = move || edof_optics::draw::draw(builtin, rows, columns, &psi, seed);
        Ok(Self(Arc::new(job::run(py, move |_| drawn())?.or_raise()?)))
    }

    fn sharp<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f32>> {
        py.detach(|| self.0.sharp()).planes.into_pyarray(py)
    }

    fn psi_map<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f32>> {
        py.detach(|| self.0.psi_map()).into_pyarray(py)
    }

    #[getter]
    fn psi(&self) -> Vec<f64> {
        self.0.layers.iter().map(|layer| layer.psi).collect()
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        self.0.size()
    }

    fn __repr__(&self) -> String {
        let ((rows, columns), layers) = (self.0.size(), self.0.layers.len());
        format!("Scene({}, {rows} rows x {columns} columns, {layers} layers)", self.0.name)
    }
}

fn matte(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Array2<f32>> {
    let matte = owned(finite::<Ix2>(value, name, PLANE)?.as_array());
    match matte.iter().find(|v| !(0.0..=1.0).contains(*v)) {
        Some(value) => Err(failed(format!("{name}: holds {value}, expected 0 to 1"))),
        None => Ok(matte),
    }
}

/// Light as a layer sends it, through its matte.
fn covered(mut light: ColourFrame, matte: Option<&Array2<f32>>) -> ColourFrame {
    if let Some(matte) = matte.filter(|matte| matte.dim() == light.size()) {
        for mut plane in light.planes.axis_iter_mut(Axis(0)) {
            Zip::from(&mut plane).and(matte).for_each(|light, share| *light *= share);
        }
    }
    light
}

/// A raw frame, and how it was taken.
#[pyclass(frozen, name = "Capture", module = "edof")]
pub struct PyCapture {
    /// Sensor values, rows × columns.
    #[pyo3(get)]
    pub raw: Py<PyArray2<u16>>,
    /// Light on the sensor.
    #[pyo3(get)]
    light: Py<PyArray3<f32>>,
    pub sensor: Sensor,
    pub camera: Arc<Camera>,
    depths: Vec<capture::Depth>,
    #[pyo3(get)]
    seconds: f64,
}

#[pymethods]
impl PyCapture {
    #[getter]
    fn bit_depth(&self) -> u32 {
        self.sensor.depth
    }

    #[getter]
    fn phase(&self) -> String {
        self.sensor.phase.to_string()
    }

    #[getter]
    fn black_level(&self) -> u16 {
        self.sensor.black_level
    }

    #[getter]
    fn camera(&self) -> PyCamera {
        PyCamera(Arc::clone(&self.camera))
    }

    #[getter]
    fn kernels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::plain(py, &self.depths)
    }

    fn __repr__(&self) -> String {
        let (Sensor { depth, phase, .. }, depths) = (&self.sensor, self.depths.len());
        format!("Capture({}, {depth} bits, {phase}, {depths} depths)", self.camera.name)
    }
}

/// Captures a scene, or a picture at one depth.
#[pyfunction]
#[pyo3(name = "capture", signature = (scene, camera, psi = None, *, bit_depth = None, phase = "rggb", noise = None, seed = None, black_level = None,
    energy = 0.999, wavelength_tolerance = 0.01, depth_tolerance = 0.0, exact = false))]
#[allow(clippy::too_many_arguments, reason = "the options of the command")]
pub fn captured(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    camera: &Bound<'_, PyAny>,
    psi: Option<f64>,
    bit_depth: Option<&Bound<'_, PyAny>>,
    phase: &str,
    noise: Option<&Bound<'_, PyAny>>,
    seed: Option<&Bound<'_, PyAny>>,
    black_level: Option<&Bound<'_, PyAny>>,
    energy: f64,
    wavelength_tolerance: f64,
    depth_tolerance: f64,
    exact: bool,
) -> PyResult<PyCapture> {
    let camera = self::camera(camera)?;
    let psf = optics::settings(energy, wavelength_tolerance, exact)?;
    let approximation = Approximation { psf, depth_tolerance: if exact { 0.0 } else { depth_tolerance } };
    approximation.check().or_raise()?;
    let sensor = Sensor {
        depth: bit_depth.map_or(Ok(12), |v| whole(v, "bit_depth", 8, 16))? as u32,
        phase: word(phase)?,
        noise: noise.map_or(Ok(edof_core::Noise::None), self::noise)?,
        seed: seed.map_or(Ok(0), |v| whole(v, "seed", 0, u64::MAX))?,
        black_level: black_level.map_or(Ok(0), |v| whole(v, "black_level", 0, u16::MAX.into()))? as u16,
    };
    sensor.check().or_raise()?;
    let scene = match (scene.cast::<PyScene>(), psi) {
        (Ok(scene), None) => Arc::clone(&scene.get().0),
        (Ok(_), Some(psi)) => {
            return Err(failed(format!("psi {psi}: the scene states its depths; leave it out")));
        }
        (Err(_), Some(psi)) => Arc::new(Scene::flat("array", picture(scene, "scene")?, psi)),
        (Err(_), None) => {
            picture(scene, "scene")?;
            return Err(failed("psi: expected a number, the depth of the picture; or pass a Scene"));
        }
    };
    let (lens, taken) = (Arc::clone(&camera), sensor.clone());
    let work = move |_: &_| capture::capture(&scene, &lens, &taken, &approximation);
    let shot = job::run(py, work)?.or_raise()?;
    Ok(PyCapture {
        raw: shot.raw.values().into_pyarray(py).unbind(),
        light: shot.light.planes.into_pyarray(py).unbind(),
        sensor,
        camera,
        depths: shot.depths,
        seconds: shot.seconds,
    })
}
