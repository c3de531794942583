//! Work without the GIL, on a thread of its own, while the caller's looks for Ctrl-C.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How long Ctrl-C waits at most.
const TICK: Duration = Duration::from_millis(50);

/// Answer to work that reports progress: end if its flag is set.
pub fn flow(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Runs `work` and returns its result. Ctrl-C raises `KeyboardInterrupt` at once; work that looks at its flag then stops, other work ends
/// unseen. It owns what it reads, so nobody's array is used after that.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut receiver) = channel();
    let seen = Arc::clone(&stop);
    // A receiver that has gone away has no use for the result.
    let job = move || drop(sender.send(catch_unwind(AssertUnwindSafe(|| work(&seen)))));
    std::thread::Builder::new().spawn(job).map_err(|error| {
        PyRuntimeError::new_err(format!(
            "cannot start a thread: {}",
            edof_core::storage::atomic::reason(&error)
        ))
    })?;
    loop {
        let receiver = &mut receiver;
        match py.detach(move || receiver.recv_timeout(TICK)) {
            Ok(Ok(result)) => return Ok(result),
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the computation ended by a panic: please report it"));
            }
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals().inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            }
        }
    }
}
