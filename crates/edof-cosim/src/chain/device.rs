//! A chain of stages, seen from outside, one cycle at a time.

use crate::Error;
use edof_device::design::BEAT;
use edof_device::design::memory::Set;

/// A beat of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beat {
    /// The two words that the receiver multiplies, or F's results.
    pub words: [i16; BEAT],
    /// The two words that the receiver adds to; no meaning unless it is an M.
    pub base: [i16; BEAT],
    /// The beat is the last of its vector.
    pub last: bool,
    /// The set it is for.
    pub set: Set,
}

/// What the chain is given in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inputs {
    /// Forget every vector and what was written to registers.
    pub reset: bool,
    /// Forget every vector, and nothing else.
    pub flush: bool,
    /// A beat of a window.
    pub window: Option<Beat>,
    /// Whether a beat of a patch is taken.
    pub patch_ready: bool,
    /// A word to write: address ([`edof_device::design::memory::address`]) and value.
    pub write: Option<(u32, u32)>,
    /// What to show: [`status_address`].
    pub status_address: u32,
}

/// What stands on a stream in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Offer {
    /// The beat that its sender offers.
    pub beat: Option<Beat>,
    /// Whether its receiver takes one.
    pub ready: bool,
}

impl Offer {
    /// The beat that passes.
    #[must_use]
    pub fn passes(&self) -> Option<Beat> {
        self.beat.filter(|_| self.ready)
    }
}

/// What the chain shows in a cycle, before the clock's edge.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Outputs {
    /// Whether a beat of a window is taken.
    pub window_ready: bool,
    /// What stands between each stage and the next.
    pub between: Vec<Offer>,
    /// A beat of a patch.
    pub patch: Option<Beat>,
    /// The counter asked for.
    pub status: u32,
    /// Whether a window was too short or too long since the last reset or snapshot.
    pub window_fault: bool,
}

/// Something that behaves as a chain.
pub trait Device {
    /// Gives the inputs, reads the outputs, lets the clock rise.
    ///
    /// # Errors
    /// The simulation stops.
    fn cycle(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> Result<(), Error>;
}

/// Where a stage, or the whole chain, shows a counter.
#[must_use]
pub const fn status_address(stage: usize, counter: usize) -> u32 {
    ((stage << 2) | counter) as u32
}

/// The low half of a port's word is the even element.
#[must_use]
pub const fn join(words: [i16; BEAT]) -> u32 {
    words[0] as u16 as u32 | ((words[1] as u16 as u32) << 16)
}

/// Both elements of a port's word.
#[must_use]
pub const fn split(word: u32) -> [i16; BEAT] {
    [word as i16, (word >> 16) as i16]
}

/// The set that a bit means.
#[must_use]
pub const fn set(bit: bool) -> Set {
    if bit { Set::Second } else { Set::First }
}
