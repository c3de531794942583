//! What a board's memories hold, by the circuit's CRCs: each is read once, with progress.

use super::{known, of};
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::contents::{Part, checksum, display_of, network_of, parts, table_parts};
use edof_board::{Board, Serial};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::identity::weights_hash;
use edof_golden::Display;
use edof_network::FixedNetwork;

/// CRCs of what a board holds.
pub struct Memories {
    /// Of the parts of each bank that was read.
    banks: Vec<(Set, Vec<u32>)>,
    /// Of the display's tables; none where they were not read.
    tables: Vec<u32>,
}

/// Which memories are read.
pub struct Wanted<'a> {
    /// Banks of a board with this design.
    pub banks: &'a [Set],
    /// The display's tables besides.
    pub tables: bool,
}

impl Memories {
    /// Has the circuit make the CRCs; without a design of the tables alone.
    ///
    /// # Errors
    /// A line that fails, or Ctrl-C.
    pub fn read(
        board: &mut Board<Serial>,
        design: Option<&Design>,
        wanted: &Wanted<'_>,
        ui: &Ui,
    ) -> Result<Self, Error> {
        // Any network of the design says which parts there are.
        let any = design.map(|design| (design, edof_device::random::for_design(design, 1)));
        let of_bank = |bank: &Set| {
            let parts = any.as_ref().map(|(design, any)| parts(design, any, *bank));
            (*bank, parts.unwrap_or_default())
        };
        let banks: Vec<(Set, Vec<Part>)> = wanted.banks.iter().map(of_bank).collect();
        let tables = if wanted.tables { table_parts(&Display::default()) } else { vec![] };
        let all: Vec<&Part> = banks.iter().flat_map(|(_, parts)| parts).chain(&tables).collect();
        let bar = ui.progress(0, "rows of the board's memories");
        let mut progress = |done, total| {
            bar.of(done, total);
            interrupt::flow()
        };
        let mut crcs = board.crcs(&all, &mut progress).map_err(of)?.into_iter();
        let banks = banks.iter().map(|(bank, parts)| (*bank, crcs.by_ref().take(parts.len()).collect()));
        Ok(Self { banks: banks.collect(), tables: crcs.collect() })
    }

    fn bank(&self, bank: Set) -> &[u32] {
        self.banks.iter().find(|(read, _)| *read == bank).map_or(&[], |(_, crcs)| crcs)
    }

    /// Which of some networks is in a bank.
    pub fn network(&self, design: &Design, known: &[FixedNetwork], bank: Set) -> Option<usize> {
        network_of(design, known, bank, self.bank(bank))
    }

    /// The checksum of a bank's words.
    pub fn checksum(&self, bank: Set) -> u32 {
        checksum(self.bank(bank))
    }

    /// Which of some displays has the tables.
    pub fn tables(&self, known: &[Display]) -> Option<usize> {
        display_of(known, &self.tables)
    }

    /// Name and hash of the network in a bank; 0 where nobody can tell. The board has one hash, that of the bank that was in use `before`, and of the
    /// other one where that holds the same words.
    pub fn held(
        &self,
        board: &Board<Serial>,
        design: &Design,
        [bank, before]: [Set; 2],
        named: &[FixedNetwork],
    ) -> (Option<String>, u32) {
        let known = known(design, named);
        if let Some(index) = self.network(design, &known, bank) {
            return (Some(known[index].origin.name.clone()), weights_hash(design, &known[index]));
        }
        let is_known = bank == before || self.bank(bank) == self.bank(before);
        (None, if is_known { board.identity.weights_hash } else { 0 })
    }
}
