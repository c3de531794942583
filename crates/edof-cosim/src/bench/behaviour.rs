//! How a memory behaves.

use super::Throttle;

/// Which of a burst's address and words a memory waits for before it accepts the other, as AXI4 allows a slave to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coupling {
    /// None: addresses and words are accepted independently.
    Free,
    /// `AWREADY` waits for `WVALID` of the same burst.
    AddressWaits,
    /// `WREADY` waits until the address of the same burst is accepted.
    DataWaits,
}

/// How a [`super::Memory`] behaves from now on.
#[derive(Debug, Clone)]
pub struct Behaviour {
    /// When it accepts addresses and words, and when it sends.
    pub pace: Throttle,
    /// Least and most cycles from a burst's address (or last word) to its answer.
    pub latency: (i64, i64),
    /// Of a thousand bursts that are written, how many are answered by an error and not stored.
    pub errors: i64,
    /// Of a thousand words that are read, how many come inverted and with an error, by id.
    pub read_errors: [i64; 2],
    /// Answers of one id overtake those of another, word by word.
    pub reorders: bool,
    /// What waits for what.
    pub coupling: Coupling,
    /// Least and most cycles of the pauses, one in some two thousand cycles, in which it neither accepts nor sends anything; 0 for none.
    pub starves: (i64, i64),
}

impl Behaviour {
    /// At once, always.
    #[must_use]
    pub const fn ideal() -> Self {
        Self {
            pace: Throttle::steady(),
            latency: (1, 1),
            errors: 0,
            read_errors: [0; 2],
            reorders: false,
            coupling: Coupling::Free,
            starves: (0, 0),
        }
    }

    /// Random latency, stalls and order.
    #[must_use]
    pub const fn hard(seed: u64) -> Self {
        Self { pace: Throttle::drawn(seed), latency: (1, 80), reorders: true, ..Self::ideal() }
    }

    /// As [`Behaviour::hard`], answers and words up to thousands of cycles late, and pauses of thousands of cycles.
    #[must_use]
    pub const fn starving(seed: u64) -> Self {
        Self { latency: (1, 3_000), starves: (1_000, 6_000), ..Self::hard(seed) }
    }
}
