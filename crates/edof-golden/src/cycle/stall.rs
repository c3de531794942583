//! Stalls that a source and a sink make, the same for this model and for anybody who drives a circuit.

use edof_core::draw::Draw;

/// Cycles in which one end of the chain does nothing: a pure function of a seed and the cycle.
///
/// ```
/// use edof_golden::cycle::StallPattern;
/// let half = StallPattern::new(7, 128);
/// assert_eq!(half.go(3), half.go(3));
/// assert!((0..9).all(|cycle| StallPattern::NEVER.go(cycle)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StallPattern {
    seed: u64,
    stalled: u8,
}

impl StallPattern {
    /// No stall in any cycle.
    pub const NEVER: Self = Self { seed: 0, stalled: 0 };

    /// Stalls in `stalled` of 256 cycles on average, random by `seed`.
    #[must_use]
    pub const fn new(seed: u64, stalled: u8) -> Self {
        Self { seed, stalled }
    }

    /// Whether this end acts in `cycle`: the lowest byte of output `cycle` (0 first) of SplitMix64 from the seed is at least the
    /// stalled share.
    #[must_use]
    pub fn go(self, cycle: u64) -> bool {
        self.stalled == 0 || Draw::nth(self.seed, cycle) as u8 >= self.stalled
    }

    /// The first cycle from `cycle` on in which it acts.
    #[must_use]
    pub fn next_go(self, mut cycle: u64) -> u64 {
        while !self.go(cycle) {
            cycle += 1;
        }
        cycle
    }
}

/// Stalls of both ends of the chain.
///
/// - Source: while no beat is pending, the next one is presented (valid rises) in the first cycle, from the one after the last
///   transfer on, in which the source goes; then it stays until it is transferred.
/// - Sink: ready in exactly the cycles in which it goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stalls {
    /// Who sends windows.
    pub source: StallPattern,
    /// Who takes results.
    pub sink: StallPattern,
}

impl Stalls {
    /// Both ends always go.
    pub const NEVER: Self = Self { source: StallPattern::NEVER, sink: StallPattern::NEVER };

    /// Both ends stall in `stalled` of 256 cycles, independently.
    #[must_use]
    pub fn drawn(seed: u64, stalled: u8) -> Self {
        let draw = &mut Draw::new(seed);
        Self {
            source: StallPattern::new(draw.bits(), stalled),
            sink: StallPattern::new(draw.bits(), stalled),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_stalls_in_its_share_of_cycles() {
        for stalled in [1u8, 64, 200, 255] {
            let pattern = StallPattern::new(11, stalled);
            let stalls = (0..256_000).filter(|cycle| !pattern.go(*cycle)).count();
            let expected = 1000 * usize::from(stalled);
            assert!(stalls.abs_diff(expected) < 1500, "{stalled}: {stalls} of 256000");
        }
    }

    #[test]
    fn the_next_cycle_to_go_is_found_from_any_cycle() {
        let pattern = StallPattern::new(5, 240);
        for cycle in 0..500 {
            let next = pattern.next_go(cycle);
            assert!(pattern.go(next) && (cycle..next).all(|c| !pattern.go(c)));
        }
    }
}
