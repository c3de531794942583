//! Ctrl-C and termination: long work polls a flag and leaves its files whole; a second Ctrl-C ends at once.

use crate::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Starts to listen for Ctrl-C and SIGTERM.
///
/// # Errors
/// When the system has no signal handler to give.
pub fn install() -> Result<(), Error> {
    ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    })?;
    Ok(())
}

/// The flag itself, for work in other crates that polls an `AtomicBool`.
pub fn flag() -> &'static AtomicBool {
    &STOP
}

/// To be called between the steps of long work.
///
/// # Errors
/// [`Error::Interrupted`] once the user asked to stop.
pub fn check() -> Result<(), Error> {
    if STOP.load(Ordering::SeqCst) { Err(Error::Interrupted) } else { Ok(()) }
}
