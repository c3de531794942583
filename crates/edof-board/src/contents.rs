//! What a bank of a board must hold for a network, and its tables for a display, in the parts that the board can make a CRC of.
//!
//! A host's bank, `a` or `b`, is a set of all stages: weights, thresholds, shifts. A part is what one command reads back: a bank of four
//! lanes' weights, a stage's thresholds, those of the stage before, or its shifts.

use edof_core::display::LUMA_ENTRIES;
use edof_device::design::memory::{self, Set, Shifts, Space, TABLES};
use edof_device::design::reading::{
    TABLE_ENTRIES, TABLE_ROWS, bank_rows, crc, read_command, table_bank, table_rows,
};
use edof_device::design::stage::Kind;
use edof_device::design::{Design, StagePlan};
use edof_device::registers::map::{DISPLAY_TABLES, WEIGHTS};
use edof_golden::Display;
use edof_network::FixedNetwork;

/// One of the two banks, as the host calls them.
#[must_use]
pub const fn letter(set: Set) -> char {
    match set {
        Set::First => 'a',
        Set::Second => 'b',
    }
}

/// The other bank.
#[must_use]
pub const fn other(set: Set) -> Set {
    match set {
        Set::First => Set::Second,
        Set::Second => Set::First,
    }
}

/// What one command reads back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Stage, 0 first.
    pub stage: usize,
    /// Name of the stage: `I`, `M1`, …, `F`.
    stage_name: String,
    /// The first row.
    from: Space,
    /// The rows as they are read; 0 where a number stands for no row.
    pub rows: Vec<u64>,
    /// CRC of the rows.
    pub crc: u32,
}

/// All parts of a set that holds a network, stage by stage.
#[must_use]
pub fn parts(design: &Design, network: &FixedNetwork, set: Set) -> Vec<Part> {
    design.stages().flat_map(|stage| of_stage(network, &stage, set as usize)).collect()
}

fn of_stage(network: &FixedNetwork, stage: &StagePlan, set: usize) -> Vec<Part> {
    let stage_name = match stage.kind {
        Kind::I => "I".to_owned(),
        Kind::M => format!("M{}", stage.index),
        Kind::F => "F".to_owned(),
    };
    let part = |from, rows: Vec<u64>| {
        let crc = crc(rows.iter().copied());
        Part { stage: stage.index, stage_name: stage_name.clone(), from, rows, crc }
    };
    let wide = |words: Vec<u32>| words.into_iter().map(u64::from).collect();
    let (row, first) = ((set * stage.weight_rows()) << memory::row_bits(stage), set * stage.beats_out());
    let weights = |bank| part(Space::Weights { bank, row, half: 0 }, bank_rows(network, stage, bank));
    let mut all: Vec<Part> = (0..stage.banks()).map(weights).collect();
    if stage.shrinks() {
        let words = memory::threshold_words(network, stage, false);
        all.push(part(Space::Thresholds { row: first }, wide(words)));
    }
    if stage.sends_difference {
        let words = memory::threshold_words(network, stage, true);
        all.push(part(Space::PreviousThresholds { row: first }, wide(words)));
    }
    all.push(part(Space::Register { row: set }, vec![Shifts::of(network, stage).word().into()]));
    all
}

/// Which of some networks has parts with these CRCs, those of the parts of a bank in the order of [`parts`].
#[must_use]
pub fn network_of(design: &Design, known: &[FixedNetwork], set: Set, crcs: &[u32]) -> Option<usize> {
    let holds = |network: &FixedNetwork| {
        parts(design, network, set).iter().map(|part| part.crc).eq(crcs.iter().copied())
    };
    known.iter().position(holds)
}

/// Which of some displays has tables with these CRCs, in the order of [`table_parts`].
#[must_use]
pub fn display_of(known: &[Display], crcs: &[u32]) -> Option<usize> {
    let holds = |display: &Display| table_parts(display).iter().map(|part| part.crc).eq(crcs.iter().copied());
    known.iter().position(holds)
}

/// A checksum of the words in a bank, the CRC of its parts' CRCs: equal words have equal ones, in either bank and on every board of the design.
#[must_use]
pub fn checksum(crcs: &[u32]) -> u32 {
    crc(crcs.iter().copied().map(u64::from))
}

/// All parts of the tables of a display.
#[must_use]
pub fn table_parts(display: &Display) -> Vec<Part> {
    let luma = display.luma.entries().iter().map(|code| u16::from(*code)).collect();
    let tables = std::iter::once(luma).chain(display.colours.iter().map(|table| table.entries().to_vec()));
    let of_table = |(table, entries): (usize, Vec<u16>)| {
        let part = move |(bank, rows): (usize, &[u64])| Part {
            stage: TABLES,
            stage_name: TABLE_NAMES[table].to_owned(),
            from: Space::Weights { bank: table_bank(table) + bank, row: 0, half: 0 },
            rows: rows.to_vec(),
            crc: crc(rows.iter().copied()),
        };
        table_rows(&entries).chunks(TABLE_ROWS).enumerate().map(part).collect::<Vec<_>>()
    };
    tables.enumerate().flat_map(of_table).collect()
}

const TABLE_NAMES: [&str; 4] = ["luma", "red", "green", "blue"];

impl Part {
    /// The place of a row, counted from the first.
    #[must_use]
    pub const fn row(&self, index: usize) -> Space {
        match self.from {
            Space::Weights { bank, row, half } => Space::Weights { bank, row: row + index, half },
            Space::Thresholds { row } => Space::Thresholds { row: row + index },
            Space::PreviousThresholds { row } => Space::PreviousThresholds { row: row + index },
            Space::Register { row } => Space::Register { row: row + index },
        }
    }

    /// The command that reads all of it.
    #[must_use]
    pub fn command(&self) -> u32 {
        read_command(self.from, self.rows.len())
    }

    /// The command that reads one row of it.
    #[must_use]
    pub const fn row_command(&self, index: usize) -> u32 {
        read_command(self.row(index), 1)
    }

    /// Whether the part is the shifts of a stage.
    #[must_use]
    pub const fn is_shifts(&self) -> bool {
        matches!(self.from, Space::Register { .. })
    }

    /// Byte addresses and words that make it what it is.
    #[must_use]
    pub fn words(&self) -> Vec<(u32, u32)> {
        let words = |(index, row): (usize, &u64)| match self.row(index) {
            Space::Weights { bank, row: number, .. } if self.stage == TABLES => {
                let first = bank / table_bank(1) * LUMA_ENTRIES
                    + (bank % table_bank(1) * TABLE_ROWS + number) * TABLE_ENTRIES;
                let entry =
                    |i: usize| (DISPLAY_TABLES.word((first + i) as u32), u32::from((row >> (16 * i)) as u16));
                (0..TABLE_ENTRIES).map(entry).collect()
            }
            Space::Weights { bank, row: number, .. } => {
                let at = |half| self.address(Space::Weights { bank, row: number, half });
                vec![(at(0), *row as u32), (at(1), (*row >> 32) as u32)]
            }
            other => vec![(self.address(other), *row as u32)],
        };
        self.rows.iter().enumerate().flat_map(words).collect()
    }

    /// Of [`Part::words`], those that are not the same in another.
    #[must_use]
    pub fn words_unlike(&self, other: &Self) -> Vec<(u32, u32)> {
        let (mine, theirs) = (self.words(), other.words());
        mine.into_iter().zip(theirs).filter(|(mine, theirs)| mine != theirs).map(|(mine, _)| mine).collect()
    }

    /// Whether another holds what lies at the same place.
    #[must_use]
    pub fn is_at(&self, other: &Self) -> bool {
        (self.stage, self.from, self.rows.len()) == (other.stage, other.from, other.rows.len())
    }

    fn address(&self, space: Space) -> u32 {
        WEIGHTS.word(memory::address(self.stage, space))
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let stage = &self.stage_name;
        match self.from {
            Space::Weights { .. } if self.stage == TABLES => write!(f, "table of {stage}"),
            Space::Weights { bank, .. } => {
                write!(f, "weights of {stage}, lanes {} to {}", 4 * bank, 4 * bank + 3)
            }
            Space::Thresholds { .. } => write!(f, "thresholds of {stage}"),
            Space::PreviousThresholds { .. } => write!(f, "thresholds of the stage before {stage}"),
            Space::Register { .. } => write!(f, "shifts of {stage}"),
        }
    }
}

/// Words at addresses one after the other, as frames of at most `max` words: address and words of each.
#[must_use]
pub fn frames(words: &[(u32, u32)], max: usize) -> Vec<(u32, Vec<u32>)> {
    let mut frames: Vec<(u32, Vec<u32>)> = vec![];
    for (address, word) in words {
        match frames.last_mut() {
            Some((first, some)) if some.len() < max && *first + 4 * some.len() as u32 == *address => {
                some.push(*word);
            }
            _ => frames.push((*address, vec![*word])),
        }
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_network::network::Recurrence;
    use std::collections::BTreeMap;

    fn designs() -> [Design; 2] {
        let tiny = Design::from_json(include_str!("../../../designs/tiny.json")).unwrap();
        let mut difference = tiny.clone();
        difference.form.recurrence = Recurrence::Difference;
        difference.stages[0].rows = 1;
        [tiny, difference]
    }

    #[test]
    fn all_parts_together_are_all_words_of_a_set() {
        for design in designs() {
            let network = edof_device::random::for_design(&design, 3);
            for set in [Set::First, Set::Second] {
                let parts = parts(&design, &network, set);
                let words: BTreeMap<u32, u32> = parts.iter().flat_map(Part::words).collect();
                let expected = memory::writes(&design, &network, set);
                let expected: BTreeMap<u32, u32> =
                    expected.into_iter().map(|(address, word)| (WEIGHTS.word(address), word)).collect();
                assert!(expected.iter().all(|(address, word)| words.get(address) == Some(word)));
                // What is there besides stands for no word.
                let more = words.iter().filter(|(address, _)| !expected.contains_key(address));
                assert!(more.into_iter().all(|(_, word)| *word == 0));
            }
        }
    }

    #[test]
    fn the_tables_of_a_display_are_written_entry_by_entry() {
        let display = Display::default();
        let words: BTreeMap<u32, u32> = table_parts(&display).iter().flat_map(Part::words).collect();
        let luma = display.luma.entries().iter().map(|code| u32::from(*code)).enumerate();
        let mut expected: BTreeMap<u32, u32> =
            luma.map(|(entry, word)| (DISPLAY_TABLES.word(entry as u32), word)).collect();
        for (colour, table) in display.colours.iter().enumerate() {
            let at = |entry: usize| DISPLAY_TABLES.word(((colour + 1) * LUMA_ENTRIES + entry) as u32);
            expected
                .extend(table.entries().iter().enumerate().map(|(entry, word)| (at(entry), (*word).into())));
        }
        assert_eq!(words, expected);
    }

    #[test]
    fn words_one_after_the_other_share_a_frame() {
        let words = [(8, 1), (12, 2), (16, 3), (24, 4)];
        assert_eq!(frames(&words, 2), [(8, vec![1, 2]), (16, vec![3]), (24, vec![4])]);
    }

    #[test]
    fn words_that_differ_are_distinguished_from_those_that_do_not() {
        let [design, _] = designs();
        let (one, mut network) =
            (edof_device::random::for_design(&design, 1), edof_device::random::for_design(&design, 1));
        network.thresholds[1][3] ^= 1;
        let (old, new) = (parts(&design, &one, Set::First), parts(&design, &network, Set::First));
        let unlike: Vec<(u32, u32)> =
            new.iter().zip(&old).flat_map(|(new, old)| new.words_unlike(old)).collect();
        assert_eq!(unlike.len(), 1);
        assert_eq!(new.iter().zip(&old).filter(|(new, old)| new.crc != old.crc).count(), 1);
    }
}
