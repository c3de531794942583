//! Faults that a test gives to a simulated board, to see whether a host finds them. Without any it is right.

use super::{Simulated, video::Pixels};
use edof_core::RawFrame;
use edof_network::FixedNetwork;

/// What is wrong with a board.
#[derive(Debug, Clone, Copy, Default)]
pub struct Faults {
    /// What its memory makes of raw frames.
    pub raw: Option<fn(RawFrame) -> RawFrame>,
    /// What its calculator makes of the weights that it reads; those that are read back are right.
    pub calculator: Option<fn(FixedNetwork) -> FixedNetwork>,
    /// What its memory makes of a word of codes.
    pub codes: Option<fn(u16) -> u16>,
}

impl Faults {
    pub(super) fn spoil_raw(&self, raw: RawFrame) -> RawFrame {
        match self.raw {
            Some(fault) => fault(raw),
            None => raw,
        }
    }

    pub(super) fn spoil_network(&self, network: FixedNetwork) -> FixedNetwork {
        match self.calculator {
            Some(fault) => fault(network),
            None => network,
        }
    }

    pub(super) fn spoil_codes(&self, pixels: &mut Pixels) {
        if let Some(fault) = self.codes {
            *pixels = pixels.iter().map(|word| fault(*word)).collect::<Vec<u16>>().into();
        }
    }
}

impl Simulated {
    /// Gives the board faults in place of those that it had.
    pub fn plant(&mut self, faults: Faults) {
        self.inside.faults = faults;
        // Pictures that were made are made again.
        self.inside.versions[2] += 1;
    }
}
