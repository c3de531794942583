//! Networks, float and fixed.

use crate::arguments::{array, name, owned, size};
use crate::camera::camera;
use crate::error::{OrRaise, failed, wrong_type};
use crate::job;
use edof::presets::weights;
use edof_core::overlap::Overlap;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Provenance;
use edof_core::{ColourFrame, Stride};
use edof_golden::Golden;
use edof_network::fixed_network::Quantized;
use edof_network::float::parameters::flatten;
use edof_network::float::pass::Pass;
use edof_network::network::Origin;
use edof_network::{FixedNetwork, Network, form, weight_file};
use edof_quantize::{Calibration, QuantizeOptions, capture};
use ndarray::{Array1, Array2, Array3, Axis, Ix2, Ix3};
use numpy::{IntoPyArray, PyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What a network argument may be.
pub const NETWORK: &str = "a Network or FixedNetwork, the name of a network, or the path of a weight file";

/// A float network. See `edof.Network` in the type stubs.
#[pyclass(frozen, name = "Network", module = "edof")]
pub struct PyNetwork {
    pub network: Arc<Network>,
    /// SHA-256 of its weight file, or of its weights.
    hash: String,
}

/// A network in integers. See `edof.FixedNetwork` in the type stubs.
#[pyclass(frozen, name = "FixedNetwork", module = "edof")]
pub struct PyFixedNetwork(pub Arc<Golden>);

impl PyNetwork {
    /// A network that was made here.
    pub fn of(network: Network) -> PyResult<Self> {
        network.check().or_raise()?;
        let bytes: Vec<u8> = flatten(&network).iter().flat_map(|w| w.to_le_bytes()).collect();
        Ok(Self { network: Arc::new(network), hash: sha256(&bytes) })
    }
}

impl PyFixedNetwork {
    /// A network that is checked.
    pub fn of(network: FixedNetwork) -> PyResult<Self> {
        Ok(Self(Arc::new(Golden::new(network).or_raise()?)))
    }
}

fn matrices<T: numpy::Element + Clone>(all: &[Array2<T>]) -> Option<Array3<T>> {
    let views: Vec<_> = all.iter().map(|a| a.view()).collect();
    ndarray::stack(Axis(0), &views).ok()
}

fn rows<T: numpy::Element + Clone>(all: &[Array1<T>]) -> Option<Array2<T>> {
    let views: Vec<_> = all.iter().map(|a| a.view()).collect();
    ndarray::stack(Axis(0), &views).ok()
}

#[pymethods]
impl PyNetwork {
    #[staticmethod]
    fn load(name_or_path: &Bound<'_, PyAny>) -> PyResult<Self> {
        let name = name(name_or_path, "name_or_path", "the name of a network, or the path of a weight file")?;
        let network = Arc::new(weights::float(&name).or_raise()?);
        Ok(Self { network, hash: weights::float_input(&name).or_raise()?.sha256 })
    }

    /// Names of the networks that come with edof.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        weights::names()
    }

    #[staticmethod]
    #[pyo3(signature = (form, arrays, *, camera = None, name = "array", like = None))]
    fn from_arrays(
        form: &str,
        arrays: &Bound<'_, PyDict>,
        camera: Option<&Bound<'_, PyAny>>,
        name: &str,
        like: Option<&Self>,
    ) -> PyResult<Self> {
        let form = form::parse(form).map_err(failed)?;
        let mut origin = match (camera, like) {
            (Some(camera), None) => Origin::untrained(name, (*self::camera(camera)?).clone()),
            (None, Some(like)) => like.network.origin.clone(),
            _ => return Err(failed("camera: give one, or a network that this one is like")),
        };
        origin.name = name.to_owned();
        let known = ["analysis", "thresholds", "recurrent", "dictionary", "linear_path"];
        for key in arrays.keys() {
            let key: String = key.extract().map_err(|_| wrong_type("arrays", &key, "names as keys"))?;
            if !known.contains(&key.as_str()) {
                return Err(failed(format!("arrays: '{key}' is none of {}", known.join(", "))));
            }
        }
        let given = |name: &str| arrays.get_item(name).ok().flatten().filter(|value| !value.is_none());
        let needed = |name: &str| given(name).ok_or_else(|| failed(format!("arrays: '{name}' is missing")));
        let matrix = |value: &Bound<'_, PyAny>, name: &str| {
            PyResult::Ok(owned(array::<f32, Ix2>(value, name, "rows x columns")?.as_array()))
        };
        let thresholds = matrix(&needed("thresholds")?, "thresholds")?;
        let recurrent = match given("recurrent") {
            Some(value) => {
                let all = array::<f32, Ix3>(&value, "recurrent", "matrices x codes x codes")?;
                all.as_array().outer_iter().map(|m| m.to_owned()).collect()
            }
            None => vec![],
        };
        Self::of(Network {
            form,
            analysis: matrix(&needed("analysis")?, "analysis")?,
            thresholds: thresholds.outer_iter().map(|row| row.to_owned()).collect(),
            recurrent,
            dictionary: matrix(&needed("dictionary")?, "dictionary")?,
            linear_path: given("linear_path").map(|value| matrix(&value, "linear_path")).transpose()?,
            origin,
        })
    }

    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (network, out) = (&self.network, PyDict::new(py));
        out.set_item("analysis", network.analysis.to_pyarray(py))?;
        out.set_item("thresholds", rows(&network.thresholds).map(|a| a.into_pyarray(py)))?;
        if let Some(recurrent) = matrices(&network.recurrent) {
            out.set_item("recurrent", recurrent.into_pyarray(py))?;
        }
        out.set_item("dictionary", network.dictionary.to_pyarray(py))?;
        if let Some(linear_path) = &network.linear_path {
            out.set_item("linear_path", linear_path.to_pyarray(py))?;
        }
        Ok(out)
    }

    fn forward<'py>(
        &self,
        py: Python<'py>,
        windows: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let form = self.network.form;
        let windows = crate::arguments::finite::<Ix2>(windows, "windows", "windows x pixels")?;
        let (count, pixels) = windows.as_array().dim();
        if count == 0 || pixels != form.inputs() {
            let expected = form.inputs();
            return Err(failed(format!(
                "windows: shape ({count}, {pixels}), expected (1 or more, {expected})"
            )));
        }
        let windows: Vec<f32> = windows.as_array().iter().copied().collect();
        let network = Arc::clone(&self.network);
        let outputs = job::run(py, move |_| {
            let weights = flatten(&network);
            Pass::new(form, count).forward(&weights, &windows, count).to_vec()
        })?;
        let columns = outputs.len() / count;
        Ok(Array2::from_shape_vec((count, columns), outputs).or_raise()?.into_pyarray(py))
    }

    fn save(&self, path: PathBuf) -> PyResult<()> {
        weight_file::save_network(&path, &self.network).or_raise()
    }

    #[pyo3(signature = (pictures = None, *, bits = None, stride = None, overlap = "hann", headroom = 2.0))]
    fn quantize(
        &self,
        py: Python<'_>,
        pictures: Option<Vec<Bound<'_, PyAny>>>,
        bits: Option<&Bound<'_, PyAny>>,
        stride: Option<&Bound<'_, PyAny>>,
        overlap: &str,
        headroom: f64,
    ) -> PyResult<PyFixedNetwork> {
        let options = QuantizeOptions {
            bits: bits.map_or(Ok(16), |value| size(value, "bits", 8, 16))? as u32,
            stride: stride.map_or(Ok(Stride::PATCH), self::stride)?,
            overlap: self::overlap(overlap)?,
            headroom,
        };
        options.check().or_raise()?;
        let pictures = match pictures {
            Some(pictures) if pictures.is_empty() => {
                return Err(failed("pictures: none, expected one at least"));
            }
            Some(pictures) => {
                let picture = |(index, value): (usize, &Bound<'_, PyAny>)| {
                    let name = format!("pictures[{index}]");
                    Ok((name.clone(), crate::arguments::picture(value, &name)?))
                };
                pictures.iter().enumerate().map(picture).collect::<PyResult<Vec<_>>>()?
            }
            None => capture::drawn().or_raise()?,
        };
        let (network, hash) = (Arc::clone(&self.network), self.hash.clone());
        let fixed = job::run(py, move |stop| quantized(&network, &hash, &options, &pictures, stop))??;
        PyFixedNetwork::of(fixed)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.network.origin.name
    }

    #[getter]
    fn form(&self) -> String {
        form::words(&self.network.form)
    }

    #[getter]
    fn camera(&self) -> crate::camera::PyCamera {
        crate::camera::PyCamera(Arc::new(self.network.origin.camera.clone()))
    }

    #[getter]
    fn foci(&self) -> Vec<f64> {
        self.network.origin.cameras().iter().map(|camera| camera.focus_psi).collect()
    }

    #[getter]
    fn window(&self) -> usize {
        self.network.form.window.side()
    }

    #[getter]
    fn sha256(&self) -> &str {
        &self.hash
    }

    #[getter]
    fn values(&self) -> String {
        self.network.origin.values.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Network({}, {}, camera {})", self.name(), self.form(), self.network.origin.camera.name)
    }
}

/// The integers of a network, with ranges measured on pictures behind its camera.
fn quantized(
    network: &Network,
    hash: &str,
    options: &QuantizeOptions,
    pictures: &[(String, ColourFrame)],
    stop: &AtomicBool,
) -> PyResult<FixedNetwork> {
    let scenes = capture::capture(pictures, &network.origin, capture::FRAMES, |_| ()).or_raise()?;
    let frames = scenes.iter().map(|scene| &scene.raw);
    let calibration = Calibration::measure_while(network, frames, |_| job::flow(stop)).or_raise()?;
    let (mut fixed, _) = edof_quantize::quantize(network, options, &calibration, hash).or_raise()?;
    fixed.quantized = Some(Quantized {
        headroom: options.headroom,
        calibration: capture::calibrated_on(&network.origin, calibration.windows),
        finetune_steps: 0,
        provenance: Provenance::default(),
    });
    Ok(fixed)
}

/// A stride of 2, 4 or 8 pixels.
pub fn stride(value: &Bound<'_, PyAny>) -> PyResult<Stride> {
    Stride::new(size(value, "stride", 0, 1 << 16)?).or_raise()
}

fn overlap(word: &str) -> PyResult<Overlap> {
    match word {
        "hann" => Ok(Overlap::Hann),
        "flat" => Ok(Overlap::Flat),
        _ => Err(failed(format!("overlap '{word}': must be hann or flat"))),
    }
}

#[pymethods]
impl PyFixedNetwork {
    #[staticmethod]
    fn load(name_or_path: &Bound<'_, PyAny>) -> PyResult<Self> {
        let name = name(name_or_path, "name_or_path", "the name of a network, or the path of a weight file")?;
        Self::of(weights::fixed(&name).or_raise()?)
    }

    /// Names of the networks that come with edof.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        weights::names()
    }

    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (network, out) = (self.0.network(), PyDict::new(py));
        out.set_item("analysis", network.analysis.weights.to_pyarray(py))?;
        out.set_item("thresholds", rows(&network.thresholds).map(|a| a.into_pyarray(py)))?;
        let recurrent: Vec<Array2<i16>> = network.recurrent.iter().map(|m| m.weights.clone()).collect();
        if let Some(recurrent) = matrices(&recurrent) {
            out.set_item("recurrent", recurrent.into_pyarray(py))?;
        }
        out.set_item("dictionary", network.dictionary.weights.to_pyarray(py))?;
        if let Some(linear_path) = &network.linear_path {
            out.set_item("linear_path", linear_path.weights.to_pyarray(py))?;
        }
        Ok(out)
    }

    fn save(&self, path: PathBuf) -> PyResult<()> {
        weight_file::save_fixed(&path, self.0.network()).or_raise()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.network().origin.name
    }

    #[getter]
    fn form(&self) -> String {
        form::words(&self.0.network().form)
    }

    #[getter]
    fn camera(&self) -> crate::camera::PyCamera {
        crate::camera::PyCamera(Arc::new(self.0.network().origin.camera.clone()))
    }

    #[getter]
    fn window(&self) -> usize {
        self.0.network().form.window.side()
    }

    #[getter]
    fn stride(&self) -> usize {
        self.0.network().stride.pixels()
    }

    #[getter]
    fn values(&self) -> String {
        self.0.network().origin.values.to_string()
    }

    #[getter]
    fn code_bits(&self) -> u32 {
        self.0.network().code_bits
    }

    #[getter]
    fn fractions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (network, out) = (self.0.network(), PyDict::new(py));
        out.set_item("analysis", network.analysis.fraction)?;
        out.set_item("recurrent", network.recurrent.iter().map(|m| m.fraction).collect::<Vec<_>>())?;
        out.set_item("dictionary", network.dictionary.fraction)?;
        out.set_item("linear_path", network.linear_path.as_ref().map(|m| m.fraction))?;
        out.set_item("codes", network.code_fractions.clone())?;
        Ok(out)
    }

    fn __repr__(&self) -> String {
        let network = self.0.network();
        let (stride, bits) = (network.stride.pixels(), network.code_bits);
        format!("FixedNetwork({}, {}, {bits} bits, stride {stride})", self.name(), self.form())
    }
}
