//! Cycles that every stage has in common (docs/calculator.md).

/// From the issue of a pass's last value to the first cycle in which its sums can be copied out of the DSPs.
pub const SUM_LATENCY: u64 = 5;
/// From taking two sums to the first cycle in which their results stand on the output.
pub const DRAIN_LATENCY: u64 = 9;
/// Beats that may be under way in the drain and its FIFO.
pub const DRAIN_CREDITS: usize = 16;
/// Vectors whose base an M stage can hold.
pub const BASE_VECTORS: usize = 4;
