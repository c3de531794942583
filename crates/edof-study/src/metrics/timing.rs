//! A run of a method with its time: the median of several where that costs little.

use crate::metrics::{cpu_time, memory};
use edof_core::{RawFrame, ReconstructError, Reconstruction, Reconstructor};
use serde::{Deserialize, Serialize};

/// Runs of a fast method, after one that warms up; what takes longer than [`FAST`] seconds runs once.
const RUNS: usize = 3;
const FAST: f64 = 0.5;

/// Minimum and maximum of several runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The fastest run.
    #[serde(rename = "least")]
    pub min: f64,
    /// The slowest run.
    #[serde(rename = "most")]
    pub max: f64,
}

impl Range {
    /// The same for one of N.
    pub fn over(self, count: f64) -> Self {
        Self { min: self.min / count, max: self.max / count }
    }

    /// Of sorted numbers; one for all where there is one.
    fn of(sorted: &[f64]) -> Option<Self> {
        Some(Self { min: *sorted.first()?, max: *sorted.last()? })
    }
}

/// A reconstruction, its times the medians of several runs where those cost little.
pub struct Timed {
    /// The first of the runs that count, its seconds the median of all.
    pub result: Reconstruction,
    /// Wall-clock seconds of the fastest and the slowest run.
    pub range: Range,
    /// Of all threads together.
    pub cpu_seconds: Option<f64>,
    /// The least and the most of them.
    pub cpu_range: Option<Range>,
    /// Of the process, in the first run.
    pub peak_memory_bytes: Option<u64>,
    /// Runs that the times are of.
    pub repetitions: usize,
}

impl Timed {
    /// The same of a method that ran in another process, whose CPU time and memory nobody counted here.
    #[must_use]
    pub fn elsewhere(self) -> Self {
        Self { cpu_seconds: None, cpu_range: None, peak_memory_bytes: None, ..self }
    }

    /// A reconstruction whose time is computed, not measured.
    pub const fn not(result: Reconstruction) -> Self {
        let range = Range { min: result.seconds, max: result.seconds };
        Self { result, range, cpu_seconds: None, cpu_range: None, peak_memory_bytes: None, repetitions: 1 }
    }
}

/// Runs a method and times it.
pub fn timed(method: &dyn Reconstructor, raw: &RawFrame) -> Result<Timed, ReconstructError> {
    let run = || -> Result<_, ReconstructError> {
        let before = cpu_time::seconds();
        let result = method.reconstruct(raw)?;
        let spent = cpu_time::seconds().zip(before).map(|(after, before)| after - before);
        Ok((result, spent))
    };
    memory::forget_peak();
    let first = run()?;
    let peak_memory_bytes = memory::peak_bytes();
    let runs = match first.0.seconds {
        slow if slow > FAST => vec![first],
        _ => (0..RUNS).map(|_| run()).collect::<Result<_, _>>()?,
    };
    let repetitions = runs.len();
    let sorted = |mut seconds: Vec<f64>| {
        seconds.sort_by(f64::total_cmp);
        seconds
    };
    let cpu = sorted(runs.iter().filter_map(|(_, spent)| *spent).collect());
    let wall = sorted(runs.iter().map(|(result, _)| result.seconds).collect());
    let (mut result, _) = runs.into_iter().next().unwrap_or_else(|| unreachable!("there is a run"));
    result.seconds = wall[wall.len() / 2];
    Ok(Timed {
        result,
        range: Range { min: wall[0], max: wall[wall.len() - 1] },
        cpu_seconds: cpu.get(cpu.len() / 2).copied(),
        cpu_range: Range::of(&cpu),
        peak_memory_bytes,
        repetitions,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::ColourFrame;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A method that takes the given times, one after the other.
    struct Told(AtomicUsize, &'static [f64]);

    impl Reconstructor for Told {
        fn name(&self) -> &str {
            "told"
        }

        fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
            let (height, width) = raw.size();
            let seconds = self.1[self.0.fetch_add(1, Ordering::Relaxed)];
            let frame = ColourFrame::zeros(height, width);
            Ok(Reconstruction { frame, seconds, multiplications: None, counters: None, iterations: None })
        }
    }

    #[test]
    fn of_three_runs_after_a_first_one_the_least_the_median_and_the_most_are_kept() {
        let values = ndarray::Array2::zeros((16, 16));
        let raw = RawFrame::from_values(values, 12, edof_core::CfaPhase::Rggb).unwrap();
        let fast = timed(&Told(AtomicUsize::new(0), &[0.4, 0.3, 0.1, 0.2]), &raw).unwrap();
        assert_eq!((fast.result.seconds, fast.repetitions), (0.2, 3));
        assert_eq!(fast.range, Range { min: 0.1, max: 0.3 });
        let slow = timed(&Told(AtomicUsize::new(0), &[0.7]), &raw).unwrap();
        assert_eq!((slow.result.seconds, slow.repetitions), (0.7, 1));
        assert_eq!(slow.range, Range { min: 0.7, max: 0.7 });
    }
}
