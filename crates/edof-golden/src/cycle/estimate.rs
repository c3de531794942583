//! Cycles per patch before anything runs: from a design alone, or with the mean number of values that each stage multiplies.

use super::Stalls;
use super::chain::Chain;
use edof_core::Geometry;
use edof_device::Design;
use edof_device::design::StagePlan;
use edof_device::design::timing::{
    ARRIVAL_LATENCY, CREDIT_LATENCY, DRAIN_CREDITS, PASS_SPACING, RELEASE_LATENCY, SLOTS, SUM_LATENCY,
    release,
};

/// Patches until the chain has settled.
const SETTLE: usize = 200;
/// Patches over which its period is taken then: periods of one to six patches divide it, and fractions are well spread.
const MEASURE: usize = 1200;

/// Cycles per patch that each part of one stage needs by itself in steady state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageCycles {
    /// Multipliers: one step after the other.
    pub multiply: f64,
    /// Drain: two sums a cycle, each pass.
    pub drain: f64,
    /// Multipliers and drain together: two passes at most are between their first step and their release.
    pub turn: f64,
    /// Vector store: a slot fills and is then multiplied, all of them in turn.
    pub slots: f64,
    /// Wires: two elements a cycle, in and out.
    pub wires: f64,
}

impl StageCycles {
    /// Those of a stage whose passes take `steps` steps each.
    #[must_use]
    pub fn new(stage: &StagePlan, steps: f64) -> Self {
        let to_release = SUM_LATENCY + release(stage.drain_beats()) + RELEASE_LATENCY;
        let (passes, beats) = (stage.passes() as f64, stage.drain_beats() as f64);
        Self {
            multiply: passes * steps.max(PASS_SPACING as f64),
            drain: passes * beats.max(credit_cycles(stage)),
            turn: passes * (steps + to_release as f64) / 2.0,
            slots: (stage.beats_in() as f64 + ARRIVAL_LATENCY as f64 - 1.0 + passes * steps) / SLOTS as f64,
            wires: stage.beats_in().max(stage.beats_out()) as f64,
        }
    }

    /// The part that needs the most.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.multiply.max(self.drain).max(self.turn).max(self.slots).max(self.wires)
    }
}

/// Cycles between two drains of a stage when the last one waits for a credit that an earlier one returns.
fn credit_cycles(stage: &StagePlan) -> f64 {
    let beats = stage.drain_beats();
    let drains = (DRAIN_CREDITS + 1 - beats.min(DRAIN_CREDITS)).div_ceil(beats).max(1);
    let beat = (drains + 1) * beats - 1 - DRAIN_CREDITS.min((drains + 1) * beats - 1);
    (beat as f64 + (stage.drain_latency() + CREDIT_LATENCY) as f64) / drains as f64
}

/// What a design takes for a patch and a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// I, each M, F by themselves.
    pub stages: Vec<StageCycles>,
    /// Cycles per patch of the whole chain in steady state, without stalls, when every patch is like the mean.
    pub cycles_per_patch: f64,
    /// Cycles from a patch's first beat in to its last out, in steady state.
    pub latency: u64,
    /// Patches of the design's frame.
    pub patches_per_frame: usize,
    /// Frames per second at the design's planned clock.
    pub frames_per_second: f64,
}

impl Estimate {
    /// The stage that limits.
    #[must_use]
    pub fn limiting_stage(&self) -> usize {
        busiest(self.stages.iter().map(StageCycles::largest))
    }
}

/// Estimates a checked design. `pairs` holds the mean number of pairs that I, each M, F multiply of a patch; without it, all.
///
/// Patches that differ take longer than their mean: stages buffer `SLOTS` vectors, not more.
#[must_use]
pub fn estimate(design: &Design, pairs: Option<&[f64]>) -> Estimate {
    let plans: Vec<StagePlan> = design.stages().collect();
    let all: Vec<f64> = plans.iter().map(|stage| stage.inputs as f64).collect();
    let pairs = pairs.unwrap_or(&all);
    let stages =
        plans.iter().zip(pairs).map(|(stage, pairs)| StageCycles::new(stage, mean_steps(stage, *pairs)));
    let (cycles_per_patch, latency) = settled(design, pairs);
    let geometry = Geometry::new(design.form.window, design.frame.stride);
    let (rows, columns) = geometry.patches(design.frame.height, design.frame.width);
    let frame = cycles_per_patch * (rows * columns) as f64;
    Estimate {
        stages: stages.collect(),
        cycles_per_patch,
        latency,
        patches_per_frame: rows * columns,
        frames_per_second: design.clock_mhz * 1e6 / frame,
    }
}

/// Steps of a pass for a mean number of pairs: where two are taken at once, half of all vectors have an odd number.
pub(super) fn mean_steps(stage: &StagePlan, pairs: f64) -> f64 {
    let pairs = if stage.is_dense() { stage.inputs as f64 } else { pairs };
    let rows = stage.rows as f64;
    let odd =
        if pairs.fract() == 0.0 { (pairs / rows).ceil() - pairs / rows } else { (rows - 1.0) / (2.0 * rows) };
    (pairs / rows + odd).max(1.0) + stage.linear.div_ceil(stage.rows) as f64
}

/// Period and latency of the chain for patches that all have the mean numbers of pairs.
fn settled(design: &Design, pairs: &[f64]) -> (f64, u64) {
    let mut chain = Chain::new(design, Stalls::NEVER);
    let mut patch = |k: usize| {
        // Whole numbers whose mean is the given one.
        let whole = |mean: &f64| (mean * (k + 1) as f64) as usize - (mean * k as f64) as usize;
        chain.next(&pairs.iter().map(whole).collect::<Vec<_>>())
    };
    let before = (0..SETTLE).map(&mut patch).last().map_or(0, |times| times.end());
    let last = (SETTLE..SETTLE + MEASURE).map(&mut patch).last();
    last.map_or((0.0, 0), |last| ((last.end() - before) as f64 / MEASURE as f64, last.latency()))
}

/// The place of the largest figure, the first of equal ones.
pub(super) fn busiest(cycles: impl Iterator<Item = f64>) -> usize {
    let larger = |max: (usize, f64), next: (usize, f64)| if next.1 > max.1 { next } else { max };
    cycles.enumerate().fold((0, f64::NEG_INFINITY), larger).0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a drain of 32 beats the fifth that follows without a pause ends with beat 159, which waits for the credit of beat 31: it comes
    /// 30 cycles after that, so four drains take 61 cycles. Of 96 beats the second ends with beat 191, which waits for beat 63's, 34 cycles after that.
    #[test]
    fn a_drain_waits_for_credits_as_worked_out_by_hand() {
        let design = Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap();
        for (lanes, cycles) in [(64, 61.0 / 4.0), (192, 97.0)] {
            let stage = StagePlan { lanes, ..design.stage(1) };
            assert_eq!(credit_cycles(&stage), cycles);
        }
    }
}
