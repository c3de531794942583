//! A run of a method with its time: the median of several where that costs little.

use crate::{cpu_time, memory};
use edof_spec::{RawFrame, ReconstructError, Reconstruction, Reconstructor};

/// Runs of a fast method, after one that warms up; what takes longer than [`FAST`] seconds runs once.
const RUNS: usize = 3;
const FAST: f64 = 0.5;

/// A reconstruction, its times the medians of several runs where those cost little.
pub(crate) struct Timed {
    pub(crate) result: Reconstruction,
    /// Of all threads together.
    pub(crate) cpu_seconds: Option<f64>,
    /// Of the process, in the first run.
    pub(crate) peak_memory_bytes: Option<u64>,
    pub(crate) repetitions: usize,
}

impl Timed {
    /// A reconstruction whose time is computed, not measured.
    pub(crate) const fn not(result: Reconstruction) -> Self {
        Self { result, cpu_seconds: None, peak_memory_bytes: None, repetitions: 1 }
    }
}

/// Runs a method and times it.
pub(crate) fn timed(method: &dyn Reconstructor, raw: &RawFrame) -> Result<Timed, ReconstructError> {
    let run = || -> Result<_, ReconstructError> {
        let before = cpu_time::seconds();
        let result = method.reconstruct(raw)?;
        let spent = cpu_time::seconds().zip(before).map(|(after, before)| after - before);
        Ok((result, spent))
    };
    memory::forget_peak();
    let (mut result, first) = run()?;
    let peak_memory_bytes = memory::peak_bytes();
    if result.seconds > FAST {
        return Ok(Timed { result, cpu_seconds: first, peak_memory_bytes, repetitions: 1 });
    }
    let runs = (0..RUNS).map(|_| run()).collect::<Result<Vec<_>, _>>()?;
    let median = |mut seconds: Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        seconds.get(RUNS / 2).copied()
    };
    result.seconds = median(runs.iter().map(|(r, _)| r.seconds).collect()).unwrap_or(result.seconds);
    let cpu_seconds = median(runs.iter().filter_map(|(_, spent)| *spent).collect());
    Ok(Timed { result, cpu_seconds, peak_memory_bytes, repetitions: RUNS })
}
