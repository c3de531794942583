//! Arguments, checked: arrays of one type and shape, words for what has few values, whole numbers.

use crate::error::{OrRaise, failed, wrong_type};
use ndarray::{Array, ArrayBase, ArrayView, Data, Dimension};
use numpy::{Element, PyArrayDescrMethods, PyReadonlyArray, PyUntypedArray, PyUntypedArrayMethods, dtype};
use numpy::{PyArray, PyArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::str::FromStr;

/// An array of exactly this type and number of dimensions, read in place whatever its strides; `shape` says in words what it must be.
pub fn array<'py, T: Element, D: Dimension>(
    value: &Bound<'py, PyAny>,
    name: &str,
    shape: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let wanted = dtype::<T>(value.py());
    let Ok(untyped) = value.cast::<PyUntypedArray>() else {
        return Err(wrong_type(name, value, &format!("a NumPy array of {wanted}, {shape}")));
    };
    let found = untyped.dtype();
    if !found.is_equiv_to(&wanted) {
        return Err(PyTypeError::new_err(format!("{name}: array of {found}, expected {wanted}")));
    }
    if let Some(expected) = D::NDIM.filter(|expected| *expected != untyped.ndim()) {
        let count = untyped.ndim();
        return Err(failed(format!("{name}: {count} dimensions, expected {expected}: {shape}")));
    }
    if !untyped.is_aligned() {
        return Err(failed(format!("{name}: not aligned in memory; pass a copy")));
    }
    let array = value.cast::<PyArray<T, D>>().map_err(|e| wrong_type(name, value, &e.to_string()))?;
    array.try_readonly().map_err(|_| failed(format!("{name}: another call is writing to this array")))
}

/// An array without NaN and infinities.
pub fn finite<'py, D: Dimension>(
    value: &Bound<'py, PyAny>,
    name: &str,
    shape: &str,
) -> PyResult<PyReadonlyArray<'py, f32, D>> {
    let array = array::<f32, D>(value, name, shape)?;
    check_finite(&array.as_array(), name)?;
    Ok(array)
}

/// A copy of its own. (ndarray would keep the strides of an empty part of an array, which its own check then rejects.)
pub fn owned<T: Clone + Default, D: Dimension>(view: ArrayView<'_, T, D>) -> Array<T, D> {
    if view.is_empty() { Array::default(view.raw_dim()) } else { view.to_owned() }
}

/// Rejects NaN and infinities.
pub fn check_finite<S: Data<Elem = f32>, D: Dimension>(array: &ArrayBase<S, D>, name: &str) -> PyResult<()> {
    // Without a branch an element; where the first one is matters once.
    if array.iter().fold(true, |all, v| all & v.is_finite()) {
        return Ok(());
    }
    let at = array.iter().position(|v| !v.is_finite()).unwrap_or(0);
    let mut rest = at;
    let mut place: Vec<usize> = array.shape().iter().rev().map(|n| (rest % n, rest /= n).0).collect();
    place.reverse();
    let value = array.iter().nth(at).copied().unwrap_or(f32::NAN);
    Err(failed(format!("{name}: holds {value} at {place:?}, expected finite numbers")))
}

/// A picture: 3 × rows × columns of linear light.
pub const PICTURE: &str = "3 planes (red, green, blue) x rows x columns";
/// A plane of one colour.
pub const PLANE: &str = "rows x columns";

/// A picture as the crates take it, one copy of its own.
pub fn picture(value: &Bound<'_, PyAny>, name: &str) -> PyResult<edof_core::ColourFrame> {
    let array = finite::<ndarray::Ix3>(value, name, PICTURE)?;
    let view = array.as_array();
    check_planes(view.dim(), name)?;
    Ok(edof_core::ColourFrame { planes: view.as_standard_layout().into_owned() })
}

/// Three planes that hold something.
pub fn check_planes((planes, height, width): (usize, usize, usize), name: &str) -> PyResult<()> {
    if planes == 3 && height > 0 && width > 0 {
        return Ok(());
    }
    Err(failed(format!("{name}: shape ({planes}, {height}, {width}), expected {PICTURE}")))
}

/// A word with few values, such as a CFA phase.
pub fn word<T: FromStr<Err: std::fmt::Display>>(value: &str) -> PyResult<T> {
    value.parse().or_raise()
}

/// A whole number within a range.
pub fn whole(value: &Bound<'_, PyAny>, name: &str, min: u64, max: u64) -> PyResult<u64> {
    let is_bool = value.is_instance_of::<pyo3::types::PyBool>();
    // Anything with __index__, as NumPy's integers have; too large ones too.
    let index = value.call_method0("__index__").ok().filter(|_| !is_bool);
    let Some(index) = index else {
        return Err(wrong_type(name, value, &format!("a whole number from {min} to {max}")));
    };
    match index.extract::<u64>() {
        Ok(number) if (min..=max).contains(&number) => Ok(number),
        _ => Err(failed(format!("{name} {index}: must be {min} to {max}"))),
    }
}

/// As [`whole`], for sizes.
pub fn size(value: &Bound<'_, PyAny>, name: &str, min: usize, max: usize) -> PyResult<usize> {
    Ok(whole(value, name, min as u64, max as u64)? as usize)
}

/// A finite number.
pub fn number(value: f64, name: &str) -> PyResult<f64> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(failed(format!("{name} {value}: must be a finite number")))
    }
}

/// A number of more than 0.
pub fn positive(value: f64, name: &str) -> PyResult<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(failed(format!("{name} {value}: must be more than 0")))
    }
}

/// A name or a path, as text.
pub fn name(value: &Bound<'_, PyAny>, what: &str, expected: &str) -> PyResult<String> {
    if let Ok(text) = value.extract::<String>() {
        return Ok(text);
    }
    match value.extract::<PathBuf>() {
        Ok(path) => Ok(path.to_string_lossy().into_owned()),
        Err(_) => Err(wrong_type(what, value, expected)),
    }
}

/// Noise: a word as the program takes it, or the standard deviation of Gaussian noise.
pub fn noise(value: &Bound<'_, PyAny>) -> PyResult<edof_core::Noise> {
    if let Ok(text) = value.extract::<String>() {
        return word(&text);
    }
    match value.extract::<f64>() {
        Ok(sigma) => {
            let noise = if sigma == 0.0 { edof_core::Noise::None } else { edof_core::Noise::gaussian(sigma) };
            noise.check().or_raise()?;
            Ok(noise)
        }
        Err(_) => Err(wrong_type("noise", value, "a number, or a word such as 'sensor:gain=4'")),
    }
}
