//! Limits of the numbers that options take.

use crate::error::Error;
use edof_core::words::number;

/// Checks that all values of an option are from `min` to `max`.
///
/// # Errors
/// The first value that is not, with the option and the limits.
pub fn all_within(option: &str, values: &[f64], min: f64, max: f64) -> Result<(), Error> {
    match values.iter().find(|value| !(min..=max).contains(*value)) {
        None => Ok(()),
        Some(value) => Err(Error::message(format!(
            "{option} {}: must be from {} to {}",
            number(*value),
            number(min),
            number(max)
        ))),
    }
}
