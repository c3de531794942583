//! A chain driven by hand: beats that come and go as chance has it, and words that the host writes.

use edof_core::draw::Draw;
use edof_cosim::chain::{Beat, Device, Inputs, Outputs};
use edof_device::design::memory::{self, Space};
use edof_golden::cycle::Patch;

/// One cycle.
pub fn cycle(device: &mut impl Device, inputs: &Inputs) -> Outputs {
    let mut outputs = Outputs::default();
    device.cycle(inputs, &mut outputs).unwrap();
    outputs
}

/// A cycle in which a word is written.
pub fn write(device: &mut impl Device, stage: usize, space: Space, word: u32) {
    cycle(device, &Inputs { write: Some((memory::address(stage, space), word)), ..Inputs::default() });
}

/// Reset, until windows are taken.
pub fn reset(device: &mut impl Device) {
    (0..48).for_each(|_| drop(cycle(device, &Inputs { reset: true, ..Inputs::default() })));
    (0..2).for_each(|_| drop(cycle(device, &Inputs::default())));
}

/// Beats of patches' windows, offered and taken as chance has it.
pub struct Traffic {
    beats: Vec<Beat>,
    sent: usize,
    offered: bool,
    stalled: i64,
}

impl Traffic {
    /// Both ends do nothing in `stalled` of ten cycles.
    pub fn new(patches: &[Patch], stalled: i64) -> Self {
        let beats = patches.iter().flat_map(|patch| {
            let count = patch.window.len() / 2;
            patch.window.chunks(2).enumerate().map(move |(k, words)| Beat {
                words: [0, 1].map(|at| words[at].to_bits()),
                base: [0; 2],
                last: k + 1 == count,
                set: patch.set,
            })
        });
        Self { beats: beats.collect(), sent: 0, offered: false, stalled }
    }

    /// None: an input that stands still, and an output that is taken.
    pub fn none() -> Self {
        Self::new(&[], 0)
    }

    /// Whether all beats are sent.
    pub fn is_over(&self) -> bool {
        self.sent == self.beats.len()
    }

    /// From the first window on again.
    pub fn again(&mut self) {
        self.sent = 0;
    }

    /// A cycle with a word to write, and something to show.
    pub fn cycle(
        &mut self,
        device: &mut impl Device,
        draw: &mut Draw,
        write: Option<(u32, u32)>,
        status_address: u32,
    ) -> Outputs {
        self.offered |= draw.whole(0, 9) >= self.stalled;
        let window = self.beats.get(self.sent).filter(|_| self.offered).copied();
        let patch_ready = draw.whole(0, 9) >= self.stalled;
        let outputs =
            cycle(device, &Inputs { window, patch_ready, write, status_address, ..Inputs::default() });
        if window.is_some() && outputs.window_ready {
            (self.sent, self.offered) = (self.sent + 1, false);
        }
        outputs
    }

    /// What is shown at an address.
    pub fn shown(&mut self, device: &mut impl Device, draw: &mut Draw, address: u32) -> u32 {
        self.cycle(device, draw, None, address);
        self.cycle(device, draw, None, address).status
    }
}
