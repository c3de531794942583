//! The chain of stages: the cycle of every transfer of one patch after the other.
//!
//! All that a patch meets was decided by patches before it: a stage's room for vector k by vector k − `SLOTS`, F's room for window k
//! by window k − `kept_windows`; a window's place, like a slot, is free from the cycle after its vector's last pass finished. Nor
//! can room be lost while a vector comes in: its first beat waits, the others follow as they are sent. So one patch goes through all stages at once, with one maximum or two for a beat.

use super::stage::{Receiver, StageClock, StageUse};
use super::{StallPattern, Stalls};
use edof_device::Design;
use edof_device::design::StagePlan;
use edof_device::design::reading::stolen;

/// When the beats of one patch are transferred.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PatchTimes {
    /// The cycle of each beat at each boundary: 0 the window as it comes, 1…T−1 between stages, T the result out of F.
    pub boundaries: Vec<Vec<u64>>,
    /// What I, each M, F did for it.
    pub stages: Vec<StageUse>,
}

impl PatchTimes {
    /// The cycle of the window's first beat.
    #[must_use]
    pub fn begin(&self) -> u64 {
        self.boundaries.first().and_then(|beats| beats.first()).copied().unwrap_or(0)
    }

    /// The cycle of the result's last beat.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.boundaries.last().and_then(|beats| beats.last()).copied().unwrap_or(0)
    }

    /// Cycles from the window's first beat to the result's last.
    #[must_use]
    pub fn latency(&self) -> u64 {
        self.end() - self.begin()
    }
}

/// The chain between two patches.
#[derive(Debug, Clone)]
pub struct Chain {
    stages: Vec<StageClock>,
    plans: Vec<StagePlan>,
    stalls: Stalls,
    /// First cycle in which the source may present the next beat.
    source: u64,
    /// First cycle in which the chain may take the next window's first beat: what was missing of the one before is filled up.
    filled: u64,
    /// First cycle in which each place of F's window ring is free; patch k takes place k mod `kept_windows`.
    windows: Vec<u64>,
    patches: usize,
}

impl Chain {
    /// The chain of a checked design after reset: cycle 0 is the first in which a beat can be transferred.
    #[must_use]
    pub fn new(design: &Design, stalls: Stalls) -> Self {
        Self::with_writes(design, stalls, &[])
    }

    /// [`Chain::new`], and in each cycle of `writes` (in order) a word is written: cycle, address, word.
    #[must_use]
    pub fn with_writes(design: &Design, stalls: Stalls, writes: &[(u64, u32, u32)]) -> Self {
        let plans: Vec<StagePlan> = design.stages().collect();
        let clock = |plan: &StagePlan| StageClock::new(*plan, stolen(design, plan.index, writes));
        Self {
            stages: plans.iter().map(clock).collect(),
            windows: vec![0; plans.last().map_or(0, |f| f.kept_windows)],
            plans,
            stalls,
            source: 0,
            filled: 0,
            patches: 0,
        }
    }

    /// The sizes of its stages.
    #[must_use]
    pub fn plans(&self) -> &[StagePlan] {
        &self.plans
    }

    /// The next patch, of which stage s keeps `pairs[s]` pairs.
    pub fn next(&mut self, pairs: &[usize]) -> PatchTimes {
        self.next_of(self.plans[0].beats_in(), pairs)
    }

    /// [`Chain::next`], whose window comes in `beats` beats, too few or too many.
    pub fn next_of(&mut self, beats: usize, pairs: &[usize]) -> PatchTimes {
        let mut boundaries = Vec::with_capacity(self.stages.len() + 1);
        let mut used = Vec::with_capacity(self.stages.len());
        let (window, window_whole) = self.window_in(beats);
        boundaries.push(window);
        for (s, pairs) in pairs.iter().enumerate().take(self.stages.len()) {
            let receiver = match self.stages.get(s + 1) {
                Some(next) => Receiver { from: next.ready_from(), stalls: StallPattern::NEVER },
                None => Receiver { from: 0, stalls: self.stalls.sink },
            };
            let last_in = if s == 0 { window_whole } else { boundaries[s].last().copied().unwrap_or(0) };
            let mut out = Vec::with_capacity(self.plans[s].beats_out());
            used.push(self.stages[s].take(last_in, *pairs, receiver, &mut out));
            boundaries.push(out);
        }
        self.window_done();
        PatchTimes { boundaries, stages: used }
    }

    /// The window's beats: taken when the source presents them and both I and F's ring have room. Missing items is filled up after
    /// them, what is too much is taken whatever room there is. With them the cycle of the beat that makes the window whole.
    fn window_in(&mut self, beats: usize) -> (Vec<u64>, u64) {
        let whole = self.plans[0].beats_in();
        let ring = self.place().map_or(0, |place| self.windows[place]);
        let room = self.stages[0].ready_from().max(ring).max(self.filled);
        let beat = |beat| {
            let from = if beat < whole { room } else { 0 };
            let taken = self.stalls.source.next_go(self.source).max(from);
            self.source = taken + 1;
            taken
        };
        let taken: Vec<u64> = (0..beats).map(beat).collect();
        let last = taken[beats.min(whole) - 1] + whole.saturating_sub(beats) as u64;
        self.filled = last + 1;
        (taken, last)
    }

    fn window_done(&mut self) {
        if let (Some(place), Some(last)) = (self.place(), self.stages.last()) {
            self.windows[place] = last.finished();
        }
        self.patches += 1;
    }

    fn place(&self) -> Option<usize> {
        self.patches.checked_rem(self.windows.len())
    }
}
