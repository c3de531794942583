//! What may go wrong on a bus besides the chips.

use crate::chip_models::lines::{Lines, Pulls};
use std::collections::BTreeSet;

/// For how long a line is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// Until N clocks passed.
    Clocks(u32),
    /// For ever.
    Forever,
}

/// Faults that a test injects into a bus.
#[derive(Debug, Clone)]
pub struct Faults {
    sda: Option<Hold>,
    stretch: u32,
    /// Steps for which the clock is still held down.
    held: u32,
    refused: u32,
    missing: BTreeSet<u8>,
    /// Clocks from the next start to the bit that another master wins.
    stolen_bit: Option<u32>,
    /// Clocks since the last start.
    clocks: u32,
    before: Lines,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            sda: None,
            stretch: 0,
            held: 0,
            refused: 0,
            missing: BTreeSet::new(),
            stolen_bit: None,
            clocks: 0,
            before: Lines::IDLE,
        }
    }
}

impl Faults {
    /// The data line is held low: a chip whose transfer was cut off in the midst of a zero, or a short.
    pub const fn hold_sda(&mut self, hold: Hold) {
        self.sda = Some(hold);
    }

    /// The data line is free again.
    pub const fn free_sda(&mut self) {
        self.sda = None;
    }

    /// After each fall of the clock it is held low for N steps; `u32::MAX` holds it for ever.
    pub const fn stretch(&mut self, steps: u32) {
        self.stretch = steps;
        if steps == 0 {
            self.held = 0;
        }
    }

    /// The next N addresses are not acknowledged.
    pub const fn refuse(&mut self, count: u32) {
        self.refused = count;
    }

    /// This chip is not there.
    pub fn remove(&mut self, address: u8) {
        self.missing.insert(address);
    }

    /// The chip is there again.
    pub fn restore(&mut self, address: u8) {
        self.missing.remove(&address);
    }

    /// Another master pulls the data line low in the bit of that number after the next start, counted from 0.
    pub const fn steal(&mut self, bit: u32) {
        self.stolen_bit = Some(bit);
    }

    /// Whether a chip at this address may acknowledge.
    pub(crate) fn lets_answer(&mut self, address: u8) -> bool {
        let is_refused = self.refused > 0;
        self.refused = self.refused.saturating_sub(1);
        !is_refused && !self.missing.contains(&address)
    }

    /// The lines between a master and what the chips pull.
    pub(crate) fn lines(&mut self, master: Pulls, chips: bool) -> Lines {
        let steals = self.stolen_bit.is_some_and(|bit| self.clocks == bit + 1);
        let sda = !(master.sda_low || chips || self.sda.is_some() || steals);
        let scl = !(master.scl_low || self.held > 0);
        if self.held != u32::MAX {
            self.held = self.held.saturating_sub(1);
        }
        let lines = Lines { scl, sda };
        self.follow(lines);
        lines
    }

    fn follow(&mut self, lines: Lines) {
        let before = std::mem::replace(&mut self.before, lines);
        if before.scl && lines.scl && before.sda && !lines.sda {
            self.clocks = 0;
        }
        if before.scl && !lines.scl {
            self.held = self.stretch;
            self.clocks += 1;
            if self.stolen_bit.is_some_and(|bit| self.clocks > bit + 1) {
                self.stolen_bit = None;
            }
        }
        if !before.scl
            && lines.scl
            && let Some(Hold::Clocks(left)) = &mut self.sda
        {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.sda = None;
            }
        }
    }
}
