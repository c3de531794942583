//! Whether a job fits this machine, asked before it begins.

use std::fs;

/// A job that needs more memory than is free.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("needs about {}, and {} are free", gigabytes(*needed), gigabytes(*free))]
pub struct MemoryError {
    /// Bytes that the job needs.
    pub needed: f64,
    /// Bytes that are free.
    pub free: f64,
}

/// Rejects a job that needs more memory than is free. Where the system does not state how much is free, every job passes that some machine
/// could run.
///
/// # Errors
/// [`MemoryError`].
pub fn check(needed: f64) -> Result<(), MemoryError> {
    let free = free().unwrap_or(MAX_OF_ANY);
    if needed <= free { Ok(()) } else { Err(MemoryError { needed, free }) }
}

/// More than machines of today have.
const MAX_OF_ANY: f64 = 1e13;

fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB", bytes / 1e9)
}

/// Returns the bytes that are free, or would be if caches were given up; `None` where the system does not state them.
#[must_use]
pub fn free() -> Option<f64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_that_no_machine_can_hold_is_rejected_with_its_size() {
        let error = check(1e15).unwrap_err().to_string();
        assert!(error.starts_with("needs about 1000000.0 GB, and "), "{error}");
        check(1e6).unwrap();
    }
}
