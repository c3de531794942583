//! Ctrl-C and termination: work polls a flag and leaves its files whole. What does not come to its next look in time is ended
//! where it is; a second request changes nothing. Either way no unfinished file stays. A file that grows past the system's limit is a failed
//! write like any other.

use crate::error::Error;
use crate::{threads, ui};
use edof_core::storage::atomic;
use edof_cosim::tool;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

static STOP: AtomicBool = AtomicBool::new(false);
static KEPT: Mutex<Option<String>> = Mutex::new(None);

/// How long work may take to come to its next look, for instance to write a checkpoint.
const GRACE: Duration = Duration::from_millis(500);

/// Starts to listen for Ctrl-C and SIGTERM, and has a write past the limit for files fail where the system would end the program.
///
/// # Errors
/// When the system has no signal handler to give.
pub fn install() -> Result<(), Error> {
    // The handler waits on a thread. Where none can be started, the first signal sets the flag and a second one ends the program.
    match threads::is_one_left() {
        true => ctrlc::set_handler(stop)?,
        false => without_threads()?,
    }
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    Ok(())
}

/// Asks the work to stop, and ends the program if it does not in time. `timeout` and terminals send one request twice, to the program and to its
/// group: the second must not take the time to write a checkpoint away.
fn stop() {
    if STOP.swap(true, Ordering::SeqCst) {
        return;
    }
    let late = || {
        std::thread::sleep(GRACE);
        end();
    };
    if std::thread::Builder::new().spawn(late).is_err() {
        late();
    }
}

#[cfg(unix)]
fn without_threads() -> Result<(), Error> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    for signal in [SIGINT, SIGTERM] {
        let status = Error::Interrupted.exit_code().into();
        signal_hook::flag::register_conditional_shutdown(signal, status, &STOP)?;
        signal_hook::flag::register(signal, &STOP)?;
    }
    Ok(())
}

#[cfg(not(unix))]
fn without_threads() -> Result<(), Error> {
    Ok(ctrlc::set_handler(stop)?)
}

/// What is kept of the work, and how to continue: said when the work is stopped, in time or not.
pub fn keeps(words: Option<String>) {
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = words;
}

/// Says it.
pub fn tell_kept() {
    if let Some(words) = KEPT.lock().unwrap_or_else(PoisonError::into_inner).take() {
        ui::note(&words);
    }
}

fn end() {
    tool::stop_all();
    atomic::abandon();
    tell_kept();
    ui::failure(&Error::Interrupted);
    std::process::exit(Error::Interrupted.exit_code().into());
}

/// The flag itself, for work in other crates that polls an `AtomicBool`.
pub fn flag() -> &'static AtomicBool {
    &STOP
}

/// Answer to work in other crates after each step: end if the user asked to stop.
pub fn flow() -> ControlFlow<()> {
    if STOP.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// To be called between the steps of long work.
///
/// # Errors
/// [`Error::Interrupted`] once the user asked to stop.
pub fn check() -> Result<(), Error> {
    if STOP.load(Ordering::SeqCst) { Err(Error::Interrupted) } else { Ok(()) }
}
