//! The model: words from the fast golden pipeline, cycles from the chain's clock.

use super::chain::Chain;
use super::transfer::{Patch, PatchRun};
use super::{CycleError, Stalls};
use crate::Trace;
use crate::fast::{Batch, Fast};
use edof_core::number::InputWord;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::design::{BEAT, StagePlan};
use edof_network::FixedNetwork;
use std::collections::VecDeque;

/// The cycle-accurate model of a design with two sets of weights.
#[derive(Debug, Clone)]
pub struct Cycle {
    design: Design,
    sets: [Fast; 2],
    skip_zeros: bool,
    stalls: Stalls,
    writes: Vec<(u64, u32, u32)>,
}

impl Cycle {
    /// The design with a network in each of its two sets (the same, where only one is used). Skips zeros if the design does;
    /// nothing stalls.
    ///
    /// # Errors
    /// [`CycleError`] for a design that cannot be built, or a network that cannot run on it exactly.
    pub fn new(design: &Design, networks: [&FixedNetwork; 2]) -> Result<Self, CycleError> {
        design.check()?;
        for network in networks {
            network.check()?;
            design.check_network(network)?;
        }
        let sets = networks.map(|network| Fast::new(network.clone()));
        Ok(Self {
            design: design.clone(),
            sets,
            skip_zeros: design.skip_zeros,
            stalls: Stalls::NEVER,
            writes: vec![],
        })
    }

    /// With zeros skipped or not, whatever the design's initial value.
    #[must_use]
    pub fn skip_zeros(self, skip_zeros: bool) -> Self {
        Self { skip_zeros, ..self }
    }

    /// With stalls at both ends.
    #[must_use]
    pub fn stalls(self, stalls: Stalls) -> Self {
        Self { stalls, ..self }
    }

    /// With words written while it runs: cycle (in order), address, word. They change cycles only; both sets stay what they are.
    #[must_use]
    pub fn writes(self, writes: Vec<(u64, u32, u32)>) -> Self {
        Self { writes, ..self }
    }

    /// The design.
    #[must_use]
    pub const fn design(&self) -> &Design {
        &self.design
    }

    /// Runs patches from reset on; each is given when it is asked for. Up to [`Batch::PATCHES`] are taken ahead.
    ///
    /// # Panics
    /// When a window holds no word, or an odd number of them.
    pub fn run<I: IntoIterator<Item = Patch>>(&self, patches: I) -> Run<'_, I::IntoIter> {
        Run {
            model: self,
            patches: patches.into_iter(),
            ready: VecDeque::new(),
            chain: Chain::with_writes(&self.design, self.stalls, &self.writes),
            index: 0,
        }
    }

    /// Words at all boundaries of a batch of patches.
    fn traces(&self, patches: &[Patch]) -> Vec<Trace> {
        let pixels = self.design.form.window.pixels();
        let of_set = |set: Set| {
            let mut windows = Vec::with_capacity(pixels * patches.len());
            for (index, patch) in patches.iter().filter(|patch| patch.set == set).enumerate() {
                let words = patch.window.len();
                assert!(words > 0 && words.is_multiple_of(BEAT), "{words} words of a window");
                windows.extend_from_slice(&patch.window[..words.min(pixels)]);
                windows.resize(pixels * (index + 1), InputWord::ZERO);
            }
            self.sets[set as usize].traces(&windows).into_iter()
        };
        let mut traces = [of_set(Set::First), of_set(Set::Second)];
        patches.iter().filter_map(|patch| traces[patch.set as usize].next()).collect()
    }
}

/// A run of the model: an iterator over its patches. Holds one batch of them at most.
#[derive(Debug)]
pub struct Run<'a, I> {
    model: &'a Cycle,
    patches: I,
    ready: VecDeque<(Patch, Trace)>,
    chain: Chain,
    index: u64,
}

impl<I: Iterator<Item = Patch>> Iterator for Run<'_, I> {
    type Item = PatchRun;

    fn next(&mut self) -> Option<PatchRun> {
        if self.ready.is_empty() {
            let batch: Vec<Patch> = self.patches.by_ref().take(Batch::PATCHES).collect();
            let traces = self.model.traces(&batch);
            self.ready = batch.into_iter().zip(traces).collect();
        }
        let (Patch { window, set }, trace) = self.ready.pop_front()?;
        let kept = |stage: &StagePlan| kept_pairs(stage, &trace, self.model.skip_zeros);
        let pairs: Vec<usize> = self.chain.plans().iter().map(kept).collect();
        let times = self.chain.next_of(window.len() / BEAT, &pairs);
        let misfit = (window.len() != trace.input.len()).then_some(window);
        let index = self.index;
        self.index += 1;
        Some(PatchRun { index, set, recurrence: self.model.design.form.recurrence, misfit, trace, times })
    }
}

/// How many pairs of the vector that comes to a stage it multiplies: all, or, except for I, those that are not zero.
#[must_use]
pub fn kept_pairs(stage: &StagePlan, trace: &Trace, skip_zeros: bool) -> usize {
    match (skip_zeros, stage.index) {
        (false, _) | (true, 0) => stage.inputs,
        (true, index) => trace.stages[index - 1].nonzeros as usize,
    }
}
