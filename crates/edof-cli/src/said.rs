//! What the user said, in errors of parts that do not know of files and options: a failure names the option or the file that it is about.

use crate::error::Error;
use crate::lens::Depth;
use edof::job::memory;
use edof_core::camera::Camera;
use edof_core::words::number;
use edof_core::{Stride, Window};
use edof_optics::design::DesignError as LensDesignError;
use edof_optics::psf::{self, NoPsf};
use edof_train::dataset::DatasetError;
use edof_train::recipe::RecipeError;
use std::fmt::Display;
use std::path::Path;

/// A failure of a file that was named.
pub fn of_file(file: impl AsRef<Path>, error: impl Display) -> Error {
    Error::message(format!("{}: {error}", file.as_ref().display()))
}

/// Rejects a job that needs more memory than is free; `job` names it and the option that would make it smaller.
///
/// # Errors
/// One line with both sizes.
pub fn memory(job: &str, bytes: f64) -> Result<(), Error> {
    memory::check(bytes).map_err(|e| Error::message(format!("{job}: {e}")))
}

/// A failure that begins with a field and its value, as in `code_bits 3: must be …`: those of the option that says so take their place.
pub fn instead(option: &str, error: &impl Display) -> Error {
    let text = error.to_string();
    let expected = text.split_once(": ").map_or(text.as_str(), |(_, expected)| expected);
    Error::message(format!("{option}: {expected}"))
}

/// A failure of an option's value that begins with the name of what the option sets, as in `stride 3: must be …`.
fn of_option(error: impl Display) -> Error {
    Error::message(format!("--{error}"))
}

/// A number that is computed with in single precision, as an option's value: one that single precision does not have is no other one.
///
/// # Errors
/// No number, or one that would become infinite or 0.
pub fn single(text: &str) -> Result<f32, String> {
    let whole: f64 = text.trim().parse().map_err(|_| "expected a number".to_owned())?;
    let value = whole as f32;
    if whole.is_finite() && value.is_infinite() {
        return Err(format!("too large: expected a number of at most {:.1e}", f32::MAX));
    }
    if whole != 0.0 && value == 0.0 {
        return Err(format!("too small: expected 0, or a number of at least {:.1e}", f32::MIN_POSITIVE));
    }
    Ok(value)
}

/// The stride of `--stride`.
///
/// # Errors
/// One that does not exist.
pub fn stride(pixels: usize) -> Result<Stride, Error> {
    Stride::new(pixels).map_err(of_option)
}

/// The window of `--window`.
///
/// # Errors
/// One that does not exist.
pub fn window(side: usize) -> Result<Window, Error> {
    Window::new(side).map_err(of_option)
}

/// Whether a network of `--clear-net` is for a lens without a mask, as tables and reports call it.
///
/// # Errors
/// A network for a coded lens.
pub fn clear(net: &str, camera: &Camera) -> Result<(), Error> {
    match camera.is_clear() {
        true => Ok(()),
        false => Err(Error::message(format!(
            "--clear-net {net}: trained for the camera {}, which has a mask; expected a network for a clear lens",
            camera.name
        ))),
    }
}

/// ψ of the depths of `--psi` before a camera that has PSFs there.
///
/// # Errors
/// A distance before a camera that does not know where ψ is zero, or a depth where it has no PSFs: the depth as it was given.
pub fn psis(depths: &[Depth], camera: &Camera) -> Result<Vec<f64>, Error> {
    let one = |depth: &Depth| {
        let psi = depth.psi(camera).map_err(|e| Error::message(format!("--psi {e}")))?;
        psf::check(camera, psi).map_err(|e| match (&e, depth) {
            (NoPsf::Missing { .. } | NoPsf::NoMask { .. }, _) => e.into(),
            (_, Depth::Psi(_)) => Error::message(format!("--{e}")),
            (_, Depth::Metres(_)) => Error::message(format!("--psi {}: {e}", depth.in_words())),
        })?;
        Ok(psi)
    };
    depths.iter().map(one).collect()
}

/// A field as `edof train` and `edof optics design` name its option.
fn option(field: &str) -> String {
    match field {
        "largest phase" => "max-phase".to_owned(),
        "weight of the worst depth" => "worst-weight".to_owned(),
        "psi" => "psi-range".to_owned(),
        field => field.replace(' ', "-"),
    }
}

/// A recipe of `edof train` that cannot be followed.
pub fn recipe(error: RecipeError) -> Error {
    match error {
        RecipeError::Value { field, value, expected } => {
            let value = value.parse().map_or(value, number);
            Error::message(format!("--{} {value}: must be {expected}", option(field)))
        }
        error => error.into(),
    }
}

/// Photographs that nothing can be learned from; `photo` names the one at a position of the list.
pub fn dataset(error: DatasetError, photo: impl Fn(usize) -> String) -> Error {
    match error {
        DatasetError::Value { field, value, expected } => {
            Error::message(format!("--{field} {value}: must be {expected}"))
        }
        DatasetError::SmallPhoto { index, width, height, min, reach } => Error::message(format!(
            "{}: {width}x{height}, both sides should be at least {min} pixels: a quarter of each is for validation, and \
             training keeps {reach} pixels away from it, as far as the blur reaches; leave it out, or narrow --psi",
            photo(index)
        )),
        error => error.into(),
    }
}

/// A search of `edof optics design` that cannot be made.
pub fn lens_design(error: LensDesignError) -> Error {
    match error {
        LensDesignError::Value { field, value, expected } => {
            let focus = if field == "psi" && value.contains("focus") { " and --focus" } else { "" };
            Error::message(format!("--{}{focus}: {field} is {value}, expected {expected}", option(field)))
        }
        error => error.into(),
    }
}
