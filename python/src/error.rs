//! The program's one line as an exception.

use pyo3::create_exception;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Display;

create_exception!(
    edof,
    EdofError,
    PyValueError,
    "Something was rejected or failed; one line says what, where, and what would have been right."
);

/// An error of a crate as an exception.
pub fn failed(error: impl Display) -> PyErr {
    let text = error.to_string();
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    EdofError::new_err(lines.join("; "))
}

/// An argument of another type than expected.
pub fn wrong_type(name: &str, value: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    let found = value.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{name}: {found}, expected {expected}"))
}

/// Results of the crates, for `?`.
pub trait OrRaise<T> {
    /// The value, or the exception of its error.
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Display> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(failed)
    }
}
