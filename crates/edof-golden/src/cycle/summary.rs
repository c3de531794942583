//! Figures of a run: cycles per patch, latency, counters, which stage limits.

use super::estimate::{StageCycles, busiest};
use super::transfer::PatchRun;
use crate::Counts;
use edof_device::Design;
use edof_device::design::StagePlan;

/// What a run took so far.
#[derive(Debug, Clone)]
pub struct Summary {
    /// Patches, and the counters of every stage.
    pub counts: Counts,
    /// Windows that were too short.
    pub too_short: u64,
    /// Windows that were too long.
    pub too_long: u64,
    /// I, each M, F.
    pub stages: Vec<StageSummary>,
    /// Most cycles from one result's last beat to the next's; 0 before the second patch.
    pub max_cycles: u64,
    /// Fewest; `u64::MAX` before the second patch.
    pub min_cycles: u64,
    /// Most cycles from a window's first beat to its result's last.
    pub max_latency: u64,
    latencies: u64,
    first_end: u64,
    last_end: u64,
}

/// What one stage did.
#[derive(Debug, Clone, Copy)]
pub struct StageSummary {
    plan: StagePlan,
    /// Pairs that it multiplied.
    pub pairs: u64,
    /// Cycles in which it multiplied.
    pub steps: u64,
    /// Cycles in which it did not because no vector was there.
    pub waited_for_input: u64,
    /// Cycles in which it did not because sums before had not left.
    pub waited_for_drain: u64,
    /// For all patches, cycles that the stage would have needed alone, with a source and a sink that never stall.
    pub alone: f64,
}

impl Summary {
    /// Of no patches yet.
    #[must_use]
    pub fn new(design: &Design) -> Self {
        let empty = |plan| StageSummary {
            plan,
            pairs: 0,
            steps: 0,
            waited_for_input: 0,
            waited_for_drain: 0,
            alone: 0.0,
        };
        Self {
            counts: Counts::new(design.form.layers),
            too_short: 0,
            too_long: 0,
            stages: design.stages().map(empty).collect(),
            max_cycles: 0,
            min_cycles: u64::MAX,
            max_latency: 0,
            latencies: 0,
            first_end: 0,
            last_end: 0,
        }
    }

    /// One patch more.
    pub fn add(&mut self, patch: &PatchRun) {
        let end = patch.times.end();
        if self.counts.patches == 0 {
            self.first_end = end;
        } else {
            self.max_cycles = self.max_cycles.max(end - self.last_end);
            self.min_cycles = self.min_cycles.min(end - self.last_end);
        }
        self.last_end = end;
        self.latencies += patch.times.latency();
        self.max_latency = self.max_latency.max(patch.times.latency());
        self.counts.add(&patch.trace.stages);
        let (came, whole) = (patch.words(0).len(), patch.trace.input.len());
        self.too_short += u64::from(came < whole);
        self.too_long += u64::from(came > whole);
        for (stage, used) in self.stages.iter_mut().zip(&patch.times.stages) {
            stage.pairs += used.pairs;
            stage.steps += used.steps;
            stage.waited_for_input += used.waited_for_input;
            stage.waited_for_drain += used.waited_for_drain;
            let steps = used.steps as f64 / stage.plan.passes() as f64;
            stage.alone += StageCycles::new(&stage.plan, steps).largest();
        }
    }

    /// Mean cycles from one result's last beat to the next's; 0 before the second patch.
    #[must_use]
    pub fn cycles_per_patch(&self) -> f64 {
        let between = self.counts.patches.saturating_sub(1).max(1);
        (self.last_end - self.first_end) as f64 / between as f64
    }

    /// Mean cycles from a window's first beat to its result's last.
    #[must_use]
    pub fn mean_latency(&self) -> f64 {
        self.latencies as f64 / self.counts.patches.max(1) as f64
    }

    /// Mean number of pairs that I, each M, F multiplied of a patch: what [`super::estimate()`] takes.
    #[must_use]
    pub fn mean_pairs(&self) -> Vec<f64> {
        self.stages.iter().map(|stage| stage.pairs as f64 / self.counts.patches.max(1) as f64).collect()
    }

    /// Cycles that the whole run took.
    #[must_use]
    pub const fn cycles(&self) -> u64 {
        if self.counts.patches == 0 { 0 } else { self.last_end + 1 }
    }

    /// The stage that limits: the one that would have needed the most cycles alone.
    #[must_use]
    pub fn limiting_stage(&self) -> usize {
        busiest(self.stages.iter().map(|stage| stage.alone))
    }
}
