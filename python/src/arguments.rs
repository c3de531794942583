//! Arguments, checked: arrays of numbers and a shape, words for what has few values, whole numbers.

use crate::error::{OrRaise, failed, wrong_type};
use ndarray::{Array, ArrayBase, ArrayView, Data, Dimension};
use numpy::{Element, IntoPyArray, PyArray, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray};
use numpy::{PyUntypedArray, PyUntypedArrayMethods, dtype};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::fmt::{Debug, Display};
use std::path::PathBuf;
use std::str::FromStr;

/// A type that arrays are read as, and what it takes of NumPy's others.
pub trait Number: Element + Copy {
    /// Kinds of types that are converted, by NumPy's letters: f floating point, i and u integers.
    const KINDS: &'static [u8];
    /// The types, in words.
    const TYPES: &'static str;
    /// The numbers that fit, in words.
    const FITS: &'static str;
    /// Rounds a floating-point number to this type, if it fits.
    fn of_float(value: f64) -> Option<Self>;
    /// Converts an integer to this type, if it fits.
    fn of_integer(value: i128) -> Option<Self>;
}

impl Number for f32 {
    // No integers: a photograph of 8 bits is not light from 0 to 1.
    const KINDS: &'static [u8] = b"f";
    const TYPES: &'static str = "float32, float64 or float16";
    const FITS: &'static str = "numbers that float32 can hold";

    fn of_float(value: f64) -> Option<Self> {
        let rounded = value as Self;
        (rounded.is_finite() == value.is_finite()).then_some(rounded)
    }

    fn of_integer(_: i128) -> Option<Self> {
        None
    }
}

impl Number for f64 {
    const KINDS: &'static [u8] = b"fiu";
    const TYPES: &'static str = "float64 or other numbers";
    const FITS: &'static str = "numbers";

    fn of_float(value: f64) -> Option<Self> {
        Some(value)
    }

    fn of_integer(value: i128) -> Option<Self> {
        Some(value as Self)
    }
}

macro_rules! integer_type {
    ($name:ident, $types:literal, $fits:literal) => {
        impl Number for $name {
            const KINDS: &'static [u8] = b"fiu";
            const TYPES: &'static str = $types;
            const FITS: &'static str = $fits;

            fn of_float(value: f64) -> Option<Self> {
                if value.fract() == 0.0 { Self::of_integer(value as i128) } else { None }
            }

            fn of_integer(value: i128) -> Option<Self> {
                value.try_into().ok()
            }
        }
    };
}

integer_type!(u16, "uint16 or other numbers", "whole numbers from 0 to 65535");
integer_type!(i16, "int16 or other numbers", "whole numbers from -32768 to 32767");

/// An array of this number of dimensions: one of type `T` is read in place whatever its strides, one of another type or byte order is
/// converted, and every number must fit. `shape` says in words what the array must be.
pub fn array<'py, T: Number, D: Dimension>(
    value: &Bound<'py, PyAny>,
    name: &str,
    shape: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let wanted = dtype::<T>(value.py());
    let Ok(untyped) = value.cast::<PyUntypedArray>() else {
        return Err(wrong_type(name, value, &format!("a NumPy array of {wanted}, {shape}")));
    };
    let found = untyped.dtype();
    if !T::KINDS.contains(&found.kind()) {
        return Err(PyTypeError::new_err(format!("{name}: array of {found}, expected {}", T::TYPES)));
    }
    if let Some(expected) = D::NDIM.filter(|expected| *expected != untyped.ndim()) {
        let count = untyped.ndim();
        return Err(failed(format!("{name}: {count} dimensions, expected {expected}: {shape}")));
    }
    let array = match found.kind() {
        _ if found.is_equiv_to(&wanted) && untyped.is_aligned() => {
            value.cast::<PyArray<T, D>>().map_err(|e| wrong_type(name, value, &e.to_string()))?.clone()
        }
        b'f' => converted::<f64, T, D>(value, name, T::of_float)?,
        b'u' => converted::<u64, T, D>(value, name, |number| T::of_integer(number.into()))?,
        _ => converted::<i64, T, D>(value, name, |number| T::of_integer(number.into()))?,
    };
    array.try_readonly().map_err(|_| failed(format!("{name}: another call is writing to this array")))
}

/// Copies an array to another type, by way of a type that holds every number of its kind.
fn converted<'py, Wide: Element + Copy + Debug, T: Number, D: Dimension>(
    value: &Bound<'py, PyAny>,
    name: &str,
    fitting: impl Fn(Wide) -> Option<T>,
) -> PyResult<Bound<'py, PyArray<T, D>>> {
    let py = value.py();
    let wide = value.call_method1("astype", (dtype::<Wide>(py),))?;
    let wide =
        wide.cast::<PyArray<Wide, D>>().map_err(|e| wrong_type(name, value, &e.to_string()))?.readonly();
    let wide = wide.as_array();
    let misfit = |index, number: &Wide| {
        let place = place(index, wide.shape());
        failed(format!("{name}: holds {number:?} at {place:?}, expected {}", T::FITS))
    };
    let fit = |(index, number): (usize, &Wide)| fitting(*number).ok_or_else(|| misfit(index, number));
    let numbers = wide.iter().enumerate().map(fit).collect::<PyResult<Vec<T>>>()?;
    Ok(Array::from_shape_vec(wide.raw_dim(), numbers).or_raise()?.into_pyarray(py))
}

/// Indices of an element by its number in row-major order.
fn place(index: usize, shape: &[usize]) -> Vec<usize> {
    let mut rest = index;
    let mut place: Vec<usize> = shape.iter().rev().map(|n| (rest % n, rest /= n).0).collect();
    place.reverse();
    place
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
    let place = place(at, array.shape());
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
pub fn word<T: FromStr<Err: Display>>(value: &str) -> PyResult<T> {
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
