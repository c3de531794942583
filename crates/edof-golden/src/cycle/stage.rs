//! One stage's clock: when it takes, multiplies, drains and sends a vector (docs/calculator.md, "What happens in a stage").

use super::StallPattern;
use edof_spec::design::StagePlan;
use edof_spec::design::timing::{DRAIN_CREDITS, DRAIN_LATENCY, SUM_LATENCY};

/// Who takes a stage's results.
#[derive(Debug, Clone, Copy)]
pub struct Receiver {
    /// First cycle in which it has room for this vector; from then on it has, to the vector's end.
    pub from: u64,
    /// Cycles in which it takes nothing all the same.
    pub stalls: StallPattern,
}

/// What a stage did for one vector.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageUse {
    /// Pairs of the vector that it multiplied.
    pub pairs: u64,
    /// Cycles in which it multiplied.
    pub steps: u64,
    /// Cycles in which it did not because the vector was not there.
    pub waited_for_input: u64,
    /// Cycles in which it did not, with the vector there, because sums before had not left.
    pub waited_for_drain: u64,
}

/// A stage between two vectors.
///
/// Its base ring never makes it wait: with two slots full, one vector in the DSPs and one in the drain, `BASE_VECTORS` bases are
/// held, and the next vector's first beat comes when the slot, and so the drain, of an older one is free. Every field is the first cycle in which something is free: one more than the cycle that the
/// contract's recurrences name.
#[derive(Debug, Clone)]
pub struct StageClock {
    plan: StagePlan,
    /// Vectors taken.
    vectors: u64,
    /// The slots of the pair buffer: vector k goes to slot k mod 2.
    slots: [u64; 2],
    /// The multipliers: `last[n−1] + 1`.
    multipliers: u64,
    /// The drains of the last pass and the one before: `take_last[n−1] + 1`, `take_last[n−2] + 1`.
    drains: [u64; 2],
    /// The output: `out[j−1] + 1`.
    output: u64,
    /// `out[j − DRAIN_CREDITS] + 1` of the coming takes, from `oldest` on, around.
    credits: [u64; DRAIN_CREDITS],
    oldest: usize,
}

impl StageClock {
    /// A stage after reset.
    #[must_use]
    pub const fn new(plan: StagePlan) -> Self {
        Self {
            plan,
            vectors: 0,
            slots: [0; 2],
            multipliers: 0,
            drains: [0; 2],
            output: 0,
            credits: [0; DRAIN_CREDITS],
            oldest: 0,
        }
    }

    /// First cycle in which there is room for the next vector's beats: the slot of two vectors before is free.
    #[must_use]
    pub const fn ready_from(&self) -> u64 {
        self.slots[(self.vectors % 2) as usize]
    }

    /// First cycle in which the vector taken last has left the pair buffer (and, in F, its window the ring).
    #[must_use]
    pub const fn finished(&self) -> u64 {
        self.slots[((self.vectors + 1) % 2) as usize]
    }

    /// Takes a vector whose last beat came in cycle `last_in` and of which `pairs` pairs are kept; appends the cycles in which
    /// its result's beats are transferred to `out`.
    pub fn take(&mut self, last_in: u64, pairs: usize, receiver: Receiver, out: &mut Vec<u64>) -> StageUse {
        let steps = self.plan.cycles(pairs) as u64 / self.plan.passes() as u64;
        let mut used = StageUse { pairs: pairs as u64, ..StageUse::default() };
        self.output = self.output.max(receiver.from);
        for _ in 0..self.plan.passes() {
            let present = self.multipliers.max(last_in + 1);
            let first = present.max(self.drains[1]);
            used.waited_for_input += present - self.multipliers;
            used.waited_for_drain += first - present;
            used.steps += steps;
            let last = first + steps - 1;
            self.multipliers = last + 1;
            let copy = (last + SUM_LATENCY).max(self.drains[0]);
            let drained = self.drain(copy, receiver.stalls, out);
            self.drains = [drained, self.drains[0]];
        }
        self.slots[(self.vectors % 2) as usize] = self.multipliers;
        self.vectors += 1;
        used
    }

    /// Drains the sums copied in cycle `copy`; gives the first cycle after the last take.
    fn drain(&mut self, copy: u64, stalls: StallPattern, out: &mut Vec<u64>) -> u64 {
        // The cycle after the copy is also the first after the take before: the copy waited for that one.
        let mut take = copy + 1;
        for _ in 0..self.plan.drain_beats() {
            let taken = take.max(self.credits[self.oldest]);
            let sent = stalls.next_go(self.output.max(taken + DRAIN_LATENCY));
            out.push(sent);
            self.output = sent + 1;
            self.credits[self.oldest] = sent + 1;
            self.oldest = (self.oldest + 1) % DRAIN_CREDITS;
            take = taken + 1;
        }
        take
    }
}
