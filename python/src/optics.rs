//! Point spread functions, their transforms, blur and its adjoint.

use crate::arguments::{PICTURE, PLANE, array, finite, owned, word};
use crate::camera::camera;
use crate::error::{OrRaise, failed, wrong_type};
use crate::job;
use edof_core::{Channel, ColourFrame, Tone};
use edof_optics::Footprint;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use ndarray::{Array1, Array2, Array3, Axis, Ix1, Ix2};
use numpy::{Complex64, IntoPyArray, PyArray1, PyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Frequencies and values.
type Curve<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Where kernels end and how many wavelengths are summed.
pub fn settings(energy: f64, wavelength_tolerance: f64, exact: bool) -> PyResult<Settings> {
    if exact {
        return Ok(Settings::exact());
    }
    let settings = Settings { energy, wavelength_tolerance, exact };
    settings.check().or_raise()?;
    Ok(settings)
}

fn channel(name: &str) -> PyResult<Channel> {
    match name {
        "red" => Ok(Channel::Red),
        "green" => Ok(Channel::Green),
        "blue" => Ok(Channel::Blue),
        _ => Err(failed(format!("channel '{name}': must be red, green or blue"))),
    }
}

/// Kernels of red, green and blue.
#[pyfunction]
#[pyo3(signature = (camera, psi, *, energy = 0.999, wavelength_tolerance = 0.01, exact = false))]
pub fn psf<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyAny>,
    psi: f64,
    energy: f64,
    wavelength_tolerance: f64,
    exact: bool,
) -> PyResult<Bound<'py, PyTuple>> {
    let (camera, settings) = (self::camera(camera)?, settings(energy, wavelength_tolerance, exact)?);
    let psfs = job::run(py, move |_| channel_psfs(&camera, psi, &settings))?.or_raise()?;
    PyTuple::new(py, psfs.map(|psf| psf.into_kernel().into_pyarray(py)))
}

/// Contrast along a row at frequencies in cycles per millimetre.
#[pyfunction]
#[pyo3(signature = (camera, psi, channel = "green", *, cycles_per_mm = None, pixel = false))]
pub fn otf<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyAny>,
    psi: f64,
    channel: &str,
    cycles_per_mm: Option<&Bound<'py, PyAny>>,
    pixel: bool,
) -> PyResult<Curve<'py>> {
    let (frequencies, values) = response(py, camera, psi, channel, cycles_per_mm, pixel)?;
    Ok((frequencies.into_pyarray(py), values.into_pyarray(py)))
}

/// The magnitude of [`otf`].
#[pyfunction]
#[pyo3(signature = (camera, psi, channel = "green", *, cycles_per_mm = None, pixel = false))]
pub fn mtf<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyAny>,
    psi: f64,
    channel: &str,
    cycles_per_mm: Option<&Bound<'py, PyAny>>,
    pixel: bool,
) -> PyResult<Curve<'py>> {
    let (frequencies, values) = response(py, camera, psi, channel, cycles_per_mm, pixel)?;
    Ok((frequencies.into_pyarray(py), values.mapv_into(f64::abs).into_pyarray(py)))
}

fn response<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyAny>,
    psi: f64,
    channel: &str,
    cycles_per_mm: Option<&Bound<'py, PyAny>>,
    pixel: bool,
) -> PyResult<(Array1<f64>, Array1<f64>)> {
    let (camera, channel) = (self::camera(camera)?, self::channel(channel)?);
    let footprint = if pixel { Footprint::LensAndPixel } else { Footprint::Lens };
    let given = cycles_per_mm.map(|value| frequencies(value, "cycles_per_mm")).transpose()?;
    let response = job::run(py, move |_| edof_optics::otf(&camera, channel, psi, footprint))?.or_raise()?;
    Ok(match given {
        Some(frequencies) => {
            let values = frequencies.mapv(|f| response.at(f));
            (frequencies, values)
        }
        None => {
            let step = response.step_per_mm;
            ((0..response.values.len()).map(|i| i as f64 * step).collect(), response.values)
        }
    })
}

fn frequencies(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Array1<f64>> {
    let frequencies = owned(array::<f64, Ix1>(value, name, "one number per frequency")?.as_array());
    match frequencies.iter().find(|f| !(f.is_finite() && **f >= 0.0)) {
        Some(f) => Err(failed(format!("{name}: holds {f}, expected finite numbers of 0 or more"))),
        None => Ok(frequencies),
    }
}

/// Fourier transform of a kernel as pixels sample it: along a row and along a column.
#[pyfunction]
pub fn sampled_otf<'py>(
    py: Python<'py>,
    kernel: &Bound<'py, PyAny>,
    cycles_per_pixel: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<Complex64>>> {
    let (psf, frequencies) = (one_kernel(kernel)?, frequencies(cycles_per_pixel, "cycles_per_pixel")?);
    let mut out = Array2::<Complex64>::zeros((2, frequencies.len()));
    for (index, both) in edof_optics::sampled_otf(&psf, &frequencies.to_vec()).into_iter().enumerate() {
        both.into_iter().enumerate().for_each(|(axis, value)| out[(axis, index)] = value);
    }
    Ok(out.into_pyarray(py))
}

fn one_kernel(value: &Bound<'_, PyAny>) -> PyResult<Psf> {
    let kernel = finite::<Ix2>(value, "kernel", "rows x columns, square, of an odd side")?;
    Psf::new(owned(kernel.as_array())).or_raise()
}

fn three_kernels(value: &Bound<'_, PyAny>) -> PyResult<[Psf; 3]> {
    let given: Vec<Bound<'_, PyAny>> = match value.cast::<PyUntypedArray>() {
        Ok(_) => return Err(failed("kernel: one array, expected three for a picture of 3 planes")),
        Err(_) => value.extract().map_err(|_| wrong_type("kernel", value, "three arrays, one per colour"))?,
    };
    let count = given.len();
    let psfs = given.iter().map(one_kernel).collect::<PyResult<Vec<_>>>()?;
    psfs.try_into().map_err(|_| failed(format!("kernel: {count} arrays, expected three, one per colour")))
}

/// Blurs a plane with a kernel, or a picture with three.
#[pyfunction]
#[pyo3(name = "blur")]
pub fn blurred<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    apply(py, picture, kernel, edof_optics::blur, edof_optics::blur_frame)
}

/// The adjoint of [`blurred`].
#[pyfunction]
pub fn blur_adjoint<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    apply(py, picture, kernel, edof_optics::blur_adjoint, |frame, psfs| {
        let mut out = Array3::zeros(frame.planes.raw_dim());
        let channels = frame.planes.axis_iter(Axis(0)).zip(out.axis_iter_mut(Axis(0))).zip(psfs);
        channels.for_each(|((plane, mut out), psf)| out.assign(&edof_optics::blur_adjoint(plane, psf)));
        ColourFrame { planes: out }
    })
}

fn apply<'py>(
    py: Python<'py>,
    picture: &Bound<'py, PyAny>,
    kernel: &Bound<'py, PyAny>,
    plane: fn(ndarray::ArrayView2<'_, f32>, &Psf) -> Array2<f32>,
    frame: impl Fn(&ColourFrame, &[Psf; 3]) -> ColourFrame + Send + 'static,
) -> PyResult<Bound<'py, PyAny>> {
    let dimensions = picture.cast::<PyUntypedArray>().map(PyUntypedArrayMethods::ndim);
    if dimensions.is_ok_and(|n| n == 3) {
        let picture = crate::arguments::picture(picture, "picture")?;
        let psfs = three_kernels(kernel)?;
        let blurred = job::run(py, move |_| frame(&picture, &psfs))?;
        return Ok(blurred.planes.into_pyarray(py).into_any());
    }
    let shape = format!("{PLANE}, or {PICTURE}");
    let array = finite::<Ix2>(picture, "picture", &shape)?;
    let view = array.as_array();
    if view.is_empty() {
        return Err(failed(format!("picture: shape {:?}, expected one pixel at least", view.shape())));
    }
    let psf = one_kernel(kernel)?;
    let blurred = py.detach(|| plane(view, &psf));
    Ok(blurred.into_pyarray(py).into_any())
}

/// Encodes linear light for a screen.
#[pyfunction]
#[pyo3(signature = (picture, tone = "srgb"))]
pub fn encode<'py>(py: Python<'py>, picture: &Bound<'py, PyAny>, tone: &str) -> PyResult<Bound<'py, PyAny>> {
    let (picture, tone) = (crate::arguments::picture(picture, "picture")?, word::<Tone>(tone)?);
    Ok(py.detach(|| tone.encoded(&picture)).planes.into_pyarray(py).into_any())
}

/// Decodes a picture to linear light.
#[pyfunction]
#[pyo3(signature = (picture, tone = "srgb"))]
pub fn decode<'py>(py: Python<'py>, picture: &Bound<'py, PyAny>, tone: &str) -> PyResult<Bound<'py, PyAny>> {
    let (picture, tone) = (crate::arguments::picture(picture, "picture")?, word::<Tone>(tone)?);
    Ok(py.detach(|| tone.into_decoded(picture)).planes.into_pyarray(py).into_any())
}
