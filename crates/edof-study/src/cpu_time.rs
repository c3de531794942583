//! What a process has cost: the time that its threads were on a processor. Other work on the machine makes a wall clock go on; it does
//! not add to this.

/// Seconds that all threads of this process have run; none where the system does not tell (Linux does). Threads that have ended no longer
/// count: what is timed must run on ones that stay, as rayon's do.
#[must_use]
pub fn seconds() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let mut nanoseconds = 0u64;
    for task in tasks {
        // The first of three numbers: on a processor, waiting for one, and how often. A thread may end meanwhile.
        let Ok(text) = std::fs::read_to_string(task.ok()?.path().join("schedstat")) else { continue };
        nanoseconds += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(nanoseconds as f64 * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_on_with_work() {
        let Some(before) = seconds() else { return };
        let mut sum = 0u64;
        while seconds().unwrap() < before + 0.005 {
            sum = std::hint::black_box((0..100_000u64).fold(sum, |a, b| a ^ b.wrapping_mul(a | 1)));
        }
    }
}
