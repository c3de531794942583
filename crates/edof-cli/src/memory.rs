//! Whether a job fits this machine, asked before it begins.

use crate::error::Error;
use std::fs;

/// Rejects a job that needs more memory than is free; `job` names it and the option that would make it smaller. Where the system
/// does not tell how much is free, every job passes that some machine could run.
///
/// # Errors
/// One line with both sizes.
pub fn check(job: &str, bytes: f64) -> Result<(), Error> {
    let free = free().unwrap_or(MAX_OF_ANY);
    if bytes <= free {
        return Ok(());
    }
    Err(Error::message(format!("{job}: needs about {}, and {} are free", gigabytes(bytes), gigabytes(free))))
}

/// More than machines of today have.
const MAX_OF_ANY: f64 = 1e13;

fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB", bytes / 1e9)
}

/// Bytes that are free, or would be if caches were given up.
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
        let error = check("scene 60000x60000 (--size)", 1e15).unwrap_err().to_string();
        assert!(error.starts_with("scene 60000x60000 (--size): needs about 1000000.0 GB, and "), "{error}");
        check("a small one", 1e6).unwrap();
    }
}
