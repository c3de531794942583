//! CPU time of a process: the time that its threads were on a processor. Other work on the machine adds to wall-clock time, but not to CPU time.

/// Seconds that all threads of this process have run, the ended ones included; `None` where the system has no such clock.
#[must_use]
pub fn seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// Runs until this thread alone has been on a processor for N seconds.
    fn work(seconds: f64) {
        let own = || {
            let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
            time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
        };
        let end = own() + seconds;
        while own() < end {
            std::hint::black_box((0..10_000u64).fold(0, |sum, value| sum ^ value.wrapping_mul(sum | 1)));
        }
    }

    // Other tests run beside these and count too: only lower bounds hold.
    #[test]
    fn the_work_of_every_thread_counts_and_stays_counted_when_it_ends() {
        let before = seconds().unwrap();
        work(0.02);
        let alone = seconds().unwrap();
        assert!(alone - before >= 0.02, "{} s of 0.02", alone - before);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| work(0.02));
            }
        });
        let all = seconds().unwrap();
        assert!(all - alone >= 0.04, "{} s of 0.04", all - alone);
    }

    #[test]
    fn a_sleep_costs_next_to_nothing() {
        // In a process of its own: in this one other tests work meanwhile.
        let alone = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "metrics::cpu_time::tests::sleep_alone", "--ignored"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&alone.stdout);
        assert!(alone.status.success() && said.contains("1 passed"), "{said}");
    }

    #[test]
    #[ignore = "run by `a_sleep_costs_next_to_nothing`, in a process of its own"]
    fn sleep_alone() {
        let before = seconds().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(200));
        let spent = seconds().unwrap() - before;
        assert!(spent < 0.1, "{spent} s of a sleep of 0.2 s");
    }
}
