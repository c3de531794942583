//! One stage's clock: when it takes, multiplies, drains and sends a vector (docs/calculator.md, "What happens in a stage").

use super::StallPattern;
use edof_device::design::StagePlan;
use edof_device::design::timing::{
    ARRIVAL_LATENCY, CREDIT_LATENCY, DRAIN_CREDITS, PASS_SPACING, RELEASE_LATENCY, SLOTS, SUM_LATENCY,
    release,
};
use std::collections::{BTreeSet, VecDeque};

/// Who takes a stage's results.
#[derive(Debug, Clone, Copy)]
pub struct Receiver {
    /// First cycle in which the receiver has space for the whole vector.
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
/// The base ring never makes a stage wait: with all slots full and three passes in DSPs and drain, fewer than `BASE_VECTORS` bases are
/// held. Every field is the first cycle in which something is free: mostly one more than the cycle that the contract's recurrences name.
#[derive(Debug, Clone)]
pub struct StageClock {
    plan: StagePlan,
    /// Vectors taken.
    vectors: u64,
    /// The slots of the vector store: vector k goes to slot k mod `SLOTS`.
    slots: [u64; SLOTS],
    /// The multipliers: `last[n−1] + 1`.
    multipliers: u64,
    /// `start[n−1] + PASS_SPACING`.
    spacing: u64,
    /// Releases of the last pass and the one before, with `RELEASE_LATENCY`.
    released: [u64; 2],
    /// The holding registers: `take_last[n−1]`, whose take may be the copy's cycle.
    drain: u64,
    /// The output: `out[j−1] + 1`.
    output: u64,
    /// `out[j − DRAIN_CREDITS]` of the coming takes and the latency of their credits, from `oldest` on, around.
    credits: [u64; DRAIN_CREDITS],
    oldest: usize,
    /// Cycles without a step, in order; those before the first coming one are gone.
    stolen: VecDeque<u64>,
}

impl StageClock {
    /// A stage after reset, from which the host takes the cycles `stolen`.
    #[must_use]
    pub fn new(plan: StagePlan, stolen: BTreeSet<u64>) -> Self {
        Self {
            plan,
            vectors: 0,
            slots: [0; SLOTS],
            multipliers: 0,
            spacing: 0,
            released: [0; 2],
            drain: 0,
            output: 0,
            credits: [0; DRAIN_CREDITS],
            oldest: 0,
            stolen: stolen.into_iter().collect(),
        }
    }

    /// First cycle in which there is room for the next vector's beats: its slot is free.
    #[must_use]
    pub const fn ready_from(&self) -> u64 {
        self.slots[self.vectors as usize % SLOTS]
    }

    /// First cycle in which the vector taken last has left its slot (and, in F, its window the ring).
    #[must_use]
    pub const fn finished(&self) -> u64 {
        self.slots[(self.vectors as usize + SLOTS - 1) % SLOTS]
    }

    /// Takes a vector whose last beat came in cycle `last_in` and of which `pairs` pairs are kept; appends the cycles in which
    /// its result's beats are transferred to `out`.
    pub fn take(&mut self, last_in: u64, pairs: usize, receiver: Receiver, out: &mut Vec<u64>) -> StageUse {
        let steps = self.plan.cycles(pairs) as u64 / self.plan.passes() as u64;
        let mut used = StageUse { pairs: pairs as u64, ..StageUse::default() };
        self.output = self.output.max(receiver.from);
        for _ in 0..self.plan.passes() {
            let present = self.multipliers.max(self.spacing).max(last_in + ARRIVAL_LATENCY);
            let start = present.max(self.released[1]);
            used.waited_for_input += present - self.multipliers;
            used.waited_for_drain += start - present;
            used.steps += steps;
            let last = self.last_step(start, steps);
            self.spacing = start + PASS_SPACING;
            self.multipliers = last + 1;
            let copy = (last + SUM_LATENCY).max(self.drain);
            let taken = self.drain(copy, receiver.stalls, out);
            let released = taken + release(self.plan.drain_beats()) + RELEASE_LATENCY;
            self.released = [released, self.released[0]];
            self.drain = taken + self.plan.drain_beats() as u64 - 1;
        }
        self.slots[self.vectors as usize % SLOTS] = self.multipliers;
        self.vectors += 1;
        used
    }

    /// The last of a pass's steps, one in each cycle from `start` on that the host does not take.
    fn last_step(&mut self, start: u64, steps: u64) -> u64 {
        while self.stolen.front().is_some_and(|cycle| *cycle < start) {
            self.stolen.pop_front();
        }
        let mut last = start + steps - 1;
        while self.stolen.front().is_some_and(|cycle| *cycle <= last) {
            self.stolen.pop_front();
            last += 1;
        }
        last
    }

    /// Drains the sums copied in cycle `copy`; gives the first take. The drain begins when all of its beats have a credit, and then
    /// takes one in every cycle.
    fn drain(&mut self, copy: u64, stalls: StallPattern, out: &mut Vec<u64>) -> u64 {
        let beats = self.plan.drain_beats();
        let credit = self.credits[(self.oldest + beats - 1) % DRAIN_CREDITS];
        let first = (copy + 1).max(credit);
        let latency = self.plan.drain_latency();
        for taken in first..first + beats as u64 {
            let sent = stalls.next_go(self.output.max(taken + latency));
            out.push(sent);
            self.output = sent + 1;
            self.credits[self.oldest] = sent + CREDIT_LATENCY;
            self.oldest = (self.oldest + 1) % DRAIN_CREDITS;
        }
        first
    }
}
