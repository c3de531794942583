//! `--gain`: the noise of a sensor, by which a network of the program is chosen.

use crate::error::Error;
use crate::limits::all_within;
use edof_core::words::number;
use std::path::Path;

/// Checks `--gain` beside `--weights`.
///
/// # Errors
/// A gain that cannot be, or weights that are a file, which is one network for one range of noise.
pub fn check(gain: Option<f64>, weights: Option<&str>) -> Result<(), Error> {
    let Some(gain) = gain else { return Ok(()) };
    all_within("--gain", &[gain], 0.001, 1000.0)?;
    match weights.filter(|name| Path::new(name).is_file()) {
        None => Ok(()),
        Some(file) => Err(Error::message(format!(
            "--gain {}: chooses among the networks of the program, and --weights {file} is a file; leave one of them out",
            number(gain)
        ))),
    }
}
