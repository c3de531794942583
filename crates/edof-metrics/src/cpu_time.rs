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
    use std::time::{Duration, Instant};

    /// Seconds that this thread alone has run.
    fn own() -> Option<f64> {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        Some(text.split_whitespace().next()?.parse::<u64>().ok()? as f64 * 1e-9)
    }

    #[test]
    fn work_of_a_thread_counts_and_its_sleep_does_not() {
        let (Some(before), Some(own_before)) = (seconds(), own()) else {
            assert_ne!(std::env::consts::OS, "linux", "Linux tells");
            return;
        };
        let start = Instant::now();
        let mut sum = 0u64;
        while own().unwrap() < own_before + 0.02 {
            sum = std::hint::black_box((0..100_000u64).fold(sum, |a, b| a ^ b.wrapping_mul(a | 1)));
            assert!(start.elapsed() < Duration::from_secs(60), "work takes no time");
        }
        let worked = own().unwrap() - own_before;
        // Other tests may run beside: of the whole process it is at least what this thread did.
        assert!(seconds().unwrap() - before >= worked - 1e-3, "{worked}");
        let (own_before, start) = (own().unwrap(), Instant::now());
        std::thread::sleep(Duration::from_millis(60));
        let slept = own().unwrap() - own_before;
        assert!(slept < 0.5 * start.elapsed().as_secs_f64(), "{slept} s of a sleep");
    }

    #[test]
    fn threads_that_stay_are_counted_together() {
        let Some(before) = seconds() else { return };
        let done = std::sync::Barrier::new(3);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    let start = own().unwrap();
                    while own().unwrap() < start + 0.02 {
                        std::hint::black_box((0..10_000u64).sum::<u64>());
                    }
                    done.wait();
                    done.wait();
                });
            }
            done.wait();
            // Both live on.
            let both = seconds().unwrap() - before;
            done.wait();
            assert!(both >= 0.039, "{both}");
        });
    }
}
