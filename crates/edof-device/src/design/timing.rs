//! Cycles that every stage has in common (docs/calculator.md).

/// From a vector's last beat in to the first cycle in which its first step can be.
pub const ARRIVAL_LATENCY: u64 = 6;
/// From the start of a pass to the earliest start of the next.
pub const PASS_SPACING: u64 = 2;
/// From a pass's last step to the first cycle in which its sums can be copied out of the DSPs.
pub const SUM_LATENCY: u64 = 7;
/// From the cycle in which a pass is released to the earliest start of the pass after the next.
pub const RELEASE_LATENCY: u64 = 2;
/// From a beat that leaves a stage to the first take that its credit allows.
pub const CREDIT_LATENCY: u64 = 2;
/// From taking two sums to the first cycle in which their results are valid on the output, except for the cycles that sums take from group to
/// group (`StagePlan::drain_latency`).
pub const DRAIN_LATENCY: u64 = 26;
/// Beats that may be in progress in the drain and its FIFO.
pub const DRAIN_CREDITS: usize = 128;
/// Vectors that a stage can hold before they are multiplied.
pub const SLOTS: usize = 4;
/// Vectors whose base an M stage can hold.
pub const BASE_VECTORS: usize = 8;
/// From a write of a weight that both ports read to the cycle without a step that it takes.
pub const STEAL_LATENCY: u64 = 2;
/// From a command to read weights to the first cycle without a step that it takes.
pub const READ_LATENCY: u64 = 68;
/// From a row of weights that is read to the next.
pub const READ_PERIOD: u64 = 256;

/// Cycles from a pass's first take until it is released: the pass after the next may start while its drain ends, because that pass's
/// sums reach the DSPs only later.
#[must_use]
pub const fn release(drain_beats: usize) -> u64 {
    (drain_beats as u64).saturating_sub(2 + SUM_LATENCY)
}
