//! A raw frame argument: an array and what the call states of it, or a capture, which states it itself.

use crate::arguments::{array, whole, word};
use crate::camera::camera;
use crate::error::{OrRaise, failed, wrong_type};
use crate::scene::PyCapture;
use edof::job::{JobError, OtherLens};
use edof::presets::{lens, weights};
use edof_core::camera::Camera;
use edof_core::{CfaPhase, RawFrame, Tone};
use edof_io::levels::{Black, Levels};
use edof_io::raw::OF_LIGHT;
use edof_network::network::Origin;
use ndarray::Ix2;
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::fmt::Display;

/// The capture that a raw frame argument is, if it is one.
fn capture<'a>(raw: &'a Bound<'_, PyAny>) -> Option<&'a PyCapture> {
    raw.cast::<PyCapture>().ok().map(Bound::get)
}

/// Whether an argument is one raw frame, and not a list of them.
pub fn is_one(raw: &Bound<'_, PyAny>) -> bool {
    capture(raw).is_some() || raw.cast::<PyUntypedArray>().is_ok()
}

/// Returns the raw frames of a scene: those of a list, which differ in focus and noise alone, or one.
pub fn exposures<'py>(raw: &Bound<'py, PyAny>) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let all = match raw.extract::<Vec<Bound<'py, PyAny>>>() {
        Ok(all) if !is_one(raw) && !all.is_empty() && all.iter().all(is_one) => all,
        _ => vec![raw.clone()],
    };
    let bits = |raw: &Bound<'py, PyAny>| capture(raw).map(|capture| capture.sensor.depth);
    for (index, other) in all.iter().enumerate() {
        if let (Some(found), Some(expected)) = (bits(other), bits(&all[0]))
            && found != expected
        {
            return Err(failed(format!("raw[{index}]: bit depth {found}, expected {expected} as raw[0]")));
        }
    }
    Ok(all)
}

/// Returns a raw frame as light, from its sensor values and what darkness and full light are in it, or a correction of its sensor.
pub fn frame(
    raw: &Bound<'_, PyAny>,
    bit_depth: Option<&Bound<'_, PyAny>>,
    phase: Option<&str>,
    black_level: Option<&Bound<'_, PyAny>>,
    white_level: Option<f64>,
    correction: Option<&Bound<'_, PyAny>>,
) -> PyResult<RawFrame> {
    let bit_depth = bit_depth.map(|value| whole(value, "bit_depth", 8, 16)).transpose()?;
    let phase = phase.map(word::<CfaPhase>).transpose()?;
    let states_levels = black_level.is_some() || white_level.is_some();
    let black = black_level.map(self::black_level).transpose()?;
    let capture = capture(raw);
    let sensor = capture.map(|capture| &capture.sensor);
    let bit_depth = agreed("bit_depth", bit_depth, sensor.map(|sensor| sensor.depth.into()))?.unwrap_or(16);
    let phase = agreed("phase", phase, sensor.map(|sensor| sensor.phase))?.unwrap_or_default();
    let black = agreed("black_level", black, sensor.map(|sensor| Black::from(sensor.black_level)))?;
    let values = capture.map_or(raw, |capture| capture.raw.bind(raw.py()).as_any());
    let values = array::<u16, Ix2>(values, "raw", "rows x columns of sensor values, or a Capture")
        .map_err(|error| of_light(values, error))?;
    let frame = RawFrame::from_view(values.as_array(), bit_depth as u32, phase).or_raise()?;
    if let Some(correction) = correction {
        if states_levels {
            return Err(failed("black_level, white_level: the sensor states them; leave them out"));
        }
        return crate::sensor::sensor(correction)?.light(&frame).or_raise();
    }
    let levels = Levels { black: black.unwrap_or_default(), white: white_level };
    if levels == Levels::default() {
        return Ok(frame);
    }
    levels.light(&frame).or_raise()
}

/// Returns the error of a raw frame; of an array in floating point, with what to do with light.
fn of_light(raw: &Bound<'_, PyAny>, error: PyErr) -> PyErr {
    let is_float = |array: &Bound<'_, PyUntypedArray>| array.dtype().kind() == b'f' && array.ndim() == 2;
    match raw.cast::<PyUntypedArray>().is_ok_and(is_float) {
        true => failed(format!("{}; {OF_LIGHT}", error.value(raw.py()))),
        false => error,
    }
}

/// Sensor values of no light.
pub fn black_level(value: &Bound<'_, PyAny>) -> PyResult<Black> {
    match (value.extract::<f64>(), value.extract::<[f64; 4]>()) {
        (Ok(level), _) => Black::new([level; 4]).or_raise(),
        (_, Ok(levels)) => Black::new(levels).or_raise(),
        _ => {
            let expected = "a number, or four for the 2x2 pixels from the first on";
            Err(wrong_type("black_level", value, expected))
        }
    }
}

/// What is given, else what the capture states; rejects a given value that contradicts the capture.
fn agreed<T: PartialEq + Display>(name: &str, given: Option<T>, stated: Option<T>) -> PyResult<Option<T>> {
    match (given, stated) {
        (Some(given), Some(stated)) if given != stated => {
            Err(failed(format!("{name} {given}: the capture states {stated}; leave {name} out")))
        }
        (given, stated) => Ok(given.or(stated)),
    }
}

/// Rejects a network that was trained for another lens than took the frame, as the capture or `stated` says. `trained` is the camera that the
/// network was trained for; of several exposures, that of this one, at whose focus `stated` is.
pub fn check_lens(
    raw: &Bound<'_, PyAny>,
    stated: Option<&Bound<'_, PyAny>>,
    trained: &Camera,
    origin: &Origin,
) -> PyResult<()> {
    let capture = capture(raw);
    let stated = stated.map(camera).transpose()?.map(|stated| match origin.further_foci[..] {
        [] => (*stated).clone(),
        _ => Camera { focus_psi: trained.focus_psi, ..(*stated).clone() },
    });
    let recorded = capture.map(|capture| &*capture.camera);
    if let (Some(stated), Some(recorded)) = (&stated, recorded)
        && !stated.same_lens(recorded)
    {
        let (given, by, fields) =
            (stated.in_words(), recorded.in_words(), stated.differences(recorded).join(", "));
        return Err(failed(format!(
            "camera {given}: the capture states {by} (they differ in {fields}); leave camera out"
        )));
    }
    match recorded.or(stated.as_ref()).filter(|camera| !trained.same_lens(camera)) {
        Some(camera) => Err(other_lens(camera, recorded.is_some(), trained, origin)),
        None => Ok(()),
    }
}

fn other_lens(camera: &Camera, is_recorded: bool, trained: &Camera, origin: &Origin) -> PyErr {
    let tone = origin.conditions.first().map_or(Tone::Srgb, |condition| condition.tone);
    let instead = match weights::trained_for(camera, tone) {
        Some(name) => format!("use network {name}"),
        None => lens::how_to_train(camera),
    };
    let other = OtherLens {
        path: "raw".into(),
        network: origin.name.clone(),
        trained: trained.clone(),
        camera: camera.clone(),
        is_recorded,
        tone,
    };
    failed(format!("{}; {instead}", JobError::OtherLens(Box::new(other))))
}
