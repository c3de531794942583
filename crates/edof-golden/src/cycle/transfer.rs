//! One patch at every boundary: words and cycles, as beats that a circuit's can be compared with.

use super::chain::PatchTimes;
use crate::Trace;
use edof_core::number::{InputWord, bits_of};
use edof_device::design::BEAT;
use edof_device::design::memory::Set;
use edof_network::network::Recurrence;

/// A patch that goes into the chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// Input words of its window (0 or more), row by row, an even number. One that is too short is filled up with zeros, of one that is too
    /// long the rest is thrown away.
    pub window: Vec<InputWord>,
    /// Which set of weights it uses.
    pub set: Set,
}

/// A patch that went through the chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PatchRun {
    /// Place of the patch in the sequence, 0 first.
    pub index: u64,
    /// Which set of weights it used.
    pub set: Set,
    /// What M layers add to.
    pub recurrence: Recurrence,
    /// The received window, if it was too short or too long.
    pub misfit: Option<Vec<InputWord>>,
    /// Words of the patch.
    pub trace: Trace,
    /// Cycles of the patch.
    pub times: PatchTimes,
}

/// One beat at one boundary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transfer {
    /// The cycle in which valid and ready were both high.
    pub cycle: u64,
    /// The set it is for.
    pub set: Set,
    /// The beat is the last of its vector.
    pub last: bool,
    /// The two words that the receiver multiplies, or F's results.
    pub words: [i16; BEAT],
    /// The two words that the receiver adds to: where it is an M.
    pub base: Option<[i16; BEAT]>,
}

impl PatchRun {
    /// Boundaries: T + 1.
    #[must_use]
    pub fn boundaries(&self) -> usize {
        self.times.boundaries.len()
    }

    /// The vector that passes `boundary`: the window, what stages send, the result.
    #[must_use]
    pub fn words(&self, boundary: usize) -> &[i16] {
        match boundary {
            0 => bits_of(self.misfit.as_ref().unwrap_or(&self.trace.input)),
            b => self.trace.layers.get(b - 1).map_or(bits_of(&self.trace.output), |codes| &codes.sent),
        }
    }

    /// The base that passes `boundary` beside it, where an M receives it.
    #[must_use]
    pub fn base(&self, boundary: usize) -> Option<&[i16]> {
        let to_m = boundary > 0 && boundary < self.trace.layers.len();
        let from = match self.recurrence {
            Recurrence::Direct => 0,
            Recurrence::Difference => boundary.saturating_sub(1),
        };
        to_m.then(|| self.trace.layers[from].b.as_slice())
    }

    /// The beats that pass `boundary`, in order.
    pub fn transfers(&self, boundary: usize) -> impl ExactSizeIterator<Item = Transfer> + '_ {
        let (words, base) = (self.words(boundary), self.base(boundary));
        let cycles = &self.times.boundaries[boundary];
        let two = |from: &[i16], beat: usize| [from[BEAT * beat], from[BEAT * beat + 1]];
        cycles.iter().enumerate().map(move |(beat, cycle)| Transfer {
            cycle: *cycle,
            set: self.set,
            last: beat + 1 == cycles.len(),
            words: two(words, beat),
            base: base.map(|base| two(base, beat)),
        })
    }
}
