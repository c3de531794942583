//! From raw frames to pictures: float, fixed, the board's codes, every boundary.

use crate::arguments::word;
use crate::error::{OrRaise, failed, wrong_type};
use crate::network::{NETWORK, PyFixedNetwork, PyNetwork, stride};
use crate::shot::{check_lens, exposures, frame};
use crate::{job, json};
use edof::presets::weights;
use edof_core::overlap::Overlap;
use edof_core::{DisplayMode, RawFrame, ReconstructError, Reconstructor, Stride, cable};
use edof_golden::{Curve, Display, Golden, GoldenFrame, Picture};
use edof_network::FixedNetwork;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::Origin;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// A network argument.
enum Net {
    Float(Arc<edof_network::Network>),
    Fixed(Arc<Golden>),
}

impl Net {
    fn origin(&self) -> &Origin {
        match self {
            Self::Float(network) => &network.origin,
            Self::Fixed(golden) => &golden.network().origin,
        }
    }
}

fn net(value: &Bound<'_, PyAny>) -> PyResult<Net> {
    if let Ok(network) = value.cast::<PyNetwork>() {
        return Ok(Net::Float(Arc::clone(&network.get().network)));
    }
    fixed(value).map(Net::Fixed)
}

/// A network in integers.
pub fn fixed(value: &Bound<'_, PyAny>) -> PyResult<Arc<Golden>> {
    if let Ok(network) = value.cast::<PyFixedNetwork>() {
        return Ok(Arc::clone(&network.get().0));
    }
    if value.cast::<PyNetwork>().is_ok() {
        return Err(wrong_type("network", value, "a FixedNetwork; make one by quantize()"));
    }
    let name = crate::arguments::name(value, "network", NETWORK)?;
    let network: FixedNetwork = weights::fixed(&name).or_raise()?;
    Ok(Arc::new(Golden::new(network).or_raise()?))
}

/// A curve from light to a picture's numbers.
pub fn curve(name: &str) -> PyResult<Curve> {
    match name {
        "linear" => Ok(Curve::Linear),
        "srgb" => Ok(Curve::Srgb),
        "bt709" => Ok(Curve::Bt709),
        _ => Err(failed(format!("curve '{name}': must be linear, srgb or bt709"))),
    }
}

/// Linear light of a frame, or of the exposures of a scene.
#[pyfunction]
#[pyo3(signature = (raw, network, *, bit_depth = None, phase = None, black_level = None, white_level = None, camera = None, sensor = None, stride = None))]
#[allow(clippy::too_many_arguments, reason = "what a frame is")]
pub fn reconstruct<'py>(
    py: Python<'py>,
    raw: &Bound<'py, PyAny>,
    network: &Bound<'py, PyAny>,
    bit_depth: Option<&Bound<'py, PyAny>>,
    phase: Option<&str>,
    black_level: Option<&Bound<'py, PyAny>>,
    white_level: Option<f64>,
    camera: Option<&Bound<'py, PyAny>>,
    sensor: Option<&Bound<'py, PyAny>>,
    stride: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let (net, asked) = (net(network)?, stride.map(self::stride).transpose()?);
    let (given, origin) = (exposures(raw)?, net.origin());
    let cameras = origin.cameras();
    if given.len() != cameras.len() {
        return Err(failed(ReconstructError::exposures(&origin.name, given.len(), cameras.len())));
    }
    let frames = given.iter().zip(&cameras).map(|(raw, trained)| {
        check_lens(raw, camera, trained, origin)?;
        frame(raw, bit_depth, phase, black_level, white_level, sensor)
    });
    let raws = frames.collect::<PyResult<Vec<RawFrame>>>()?;
    let light = match net {
        Net::Float(network) => {
            let stride = asked.unwrap_or(Stride::PATCH);
            let method =
                FloatReconstructor::new((*network).clone(), stride, Overlap::Hann, Output::Rgb).or_raise()?;
            job::run(py, move |_| method.reconstruct_exposures(&raws.iter().collect::<Vec<_>>()))?
                .or_raise()?
                .frame
        }
        Net::Fixed(golden) => {
            let own = golden.network().stride;
            if let Some(asked) = asked.filter(|asked| *asked != own) {
                let (asked, own) = (asked.pixels(), own.pixels());
                return Err(failed(format!(
                    "stride {asked}: the network is quantized for a stride of {own}"
                )));
            }
            job::run(py, move |_| golden.frame_of_light(&raws[0]).map(|(_, light)| light))?.or_raise()?
        }
    };
    Ok(light.planes.into_pyarray(py))
}

/// What the board makes of a frame.
#[pyclass(frozen, name = "BoardPicture", module = "edof")]
pub struct PyBoardPicture {
    #[pyo3(get)]
    y_code: Py<PyArray2<u8>>,
    #[pyo3(get)]
    cb_code: Py<PyArray2<u8>>,
    #[pyo3(get)]
    cr_code: Py<PyArray2<u8>>,
    picture: Picture,
    counters: serde_json::Value,
}

#[pymethods]
impl PyBoardPicture {
    fn yuyv<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        self.picture.yuyv().into_pyarray(py)
    }

    fn shown<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f32>> {
        self.picture.shown_frame().planes.into_pyarray(py)
    }

    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::plain(py, &self.counters)
    }
}

/// The codes that leave the board's HDMI port.
#[pyfunction]
#[pyo3(signature = (raw, network, *, bit_depth = None, phase = None, black_level = None, white_level = None, camera = None, sensor = None, display = "colour", curve = "srgb"))]
#[allow(clippy::too_many_arguments, reason = "what a frame is")]
pub fn board_picture(
    py: Python<'_>,
    raw: &Bound<'_, PyAny>,
    network: &Bound<'_, PyAny>,
    bit_depth: Option<&Bound<'_, PyAny>>,
    phase: Option<&str>,
    black_level: Option<&Bound<'_, PyAny>>,
    white_level: Option<f64>,
    camera: Option<&Bound<'_, PyAny>>,
    sensor: Option<&Bound<'_, PyAny>>,
    display: &str,
    curve: &str,
) -> PyResult<PyBoardPicture> {
    let golden = fixed(network)?;
    let origin = &golden.network().origin;
    check_lens(raw, camera, &origin.camera, origin)?;
    let values = origin.values;
    let display = Display::of_values(values, word::<DisplayMode>(display)?, self::curve(curve)?);
    // To the board leads a cable.
    let raw =
        cable::carried(&frame(raw, bit_depth, phase, black_level, white_level, sensor)?.encoded(values));
    let (out, (picture, shown)) = job::run(py, move |_| {
        let out = golden.frame(&raw)?;
        let picture = out.picture(&display);
        Ok::<_, edof_core::geometry::GeometryError>((out, picture))
    })?
    .or_raise()?;
    let counters = serde_json::json!({
        "patches": out.counts.patches,
        "saturations": out.counts.saturations(),
        "nonzeros": out.counts.counters().nonzeros,
        "clamped_chroma": shown.clamped_chroma,
        "out_of_gamut": shown.out_of_gamut,
    });
    let [cb, cr] = picture.chroma.clone().map(|plane| plane.into_pyarray(py).unbind());
    Ok(PyBoardPicture {
        y_code: picture.luma.clone().into_pyarray(py).unbind(),
        cb_code: cb,
        cr_code: cr,
        picture,
        counters,
    })
}

/// A frame as pixels on the video cable: the luma code low, the chroma code high.
#[pyfunction]
#[pyo3(signature = (raw, *, bit_depth = None, phase = None))]
pub fn cable_pixels<'py>(
    py: Python<'py>,
    raw: &Bound<'py, PyAny>,
    bit_depth: Option<&Bound<'py, PyAny>>,
    phase: Option<&str>,
) -> PyResult<Bound<'py, PyArray2<u16>>> {
    let raw = frame(raw, bit_depth, phase, None, None, None)?;
    Ok(raw.pixels().mapv(|word| u16::from_le_bytes(cable::codes(word))).into_pyarray(py))
}

/// Every word at every boundary, under the names of docs/contract.md, section 8.
#[pyfunction]
#[pyo3(signature = (raw, network, *, bit_depth = None, phase = None, black_level = None, white_level = None, camera = None, sensor = None, display = "colour", curve = "srgb"))]
#[allow(clippy::too_many_arguments, reason = "what a frame is")]
pub fn words<'py>(
    py: Python<'py>,
    raw: &Bound<'py, PyAny>,
    network: &Bound<'py, PyAny>,
    bit_depth: Option<&Bound<'py, PyAny>>,
    phase: Option<&str>,
    black_level: Option<&Bound<'py, PyAny>>,
    white_level: Option<f64>,
    camera: Option<&Bound<'py, PyAny>>,
    sensor: Option<&Bound<'py, PyAny>>,
    display: &str,
    curve: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let golden = fixed(network)?;
    let origin = &golden.network().origin;
    check_lens(raw, camera, &origin.camera, origin)?;
    let values = origin.values;
    let display = Display::of_values(values, word::<DisplayMode>(display)?, self::curve(curve)?);
    let raw = frame(raw, bit_depth, phase, black_level, white_level, sensor)?.encoded(values).into_owned();
    let (boundaries, out, picture) = job::run(py, move |_| {
        let out: GoldenFrame = golden.frame(&raw)?;
        let (picture, _) = out.picture(&display);
        Ok::<_, edof_core::geometry::GeometryError>((golden.words(&raw)?, out, picture))
    })?
    .or_raise()?;
    let all = PyDict::new(py);
    for boundary in boundaries {
        all.set_item(boundary.name, boundary.words.into_pyarray(py))?;
    }
    for (name, plane) in ["luma", "cb", "cr"].into_iter().zip(out.frame.bits()) {
        all.set_item(name, plane.into_pyarray(py))?;
    }
    let [cb, cr] = picture.chroma;
    for (name, plane) in [("y_code", picture.luma), ("cb_code", cb), ("cr_code", cr)] {
        all.set_item(name, plane.into_pyarray(py))?;
    }
    Ok(all)
}
