//! What lies where in a stage's memories, and the addresses at which the host writes them.
//!
//! Weights lie in banks of [`BANK_LANES`] lanes, one 64-bit word a row: lane 0 in the lowest 16 bits. Row `set·weight_rows +
//! pass·pass_rows + input` holds the weights of that input for outputs `pass·lanes + bank·4 …`. F's linear path follows the
//! codes as inputs `codes … codes + pixels`. In I, whose vectors are dense, a row holds `rows` such words, of inputs that lie
//! `inputs / rows` apart, and rows are numbered so that the lowest bits say which word ([`row_bits`]). Thresholds lie two a word, at `set·outputs/2 + output/2`.

use super::timing::{READ_LATENCY, STEAL_LATENCY};
use super::{BANK_LANES, BEAT, Design, Kind, StagePlan};
use crate::fixed_network::FixedNetwork;

/// Which of a stage's two sets of weights, thresholds and shifts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Set {
    /// Set 0.
    First,
    /// Set 1.
    Second,
}

/// What a write goes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// Half a row of one bank of weights: 2 lanes.
    Weights {
        /// Bank of lanes.
        bank: usize,
        /// Row.
        row: usize,
        /// 0: lanes 0 and 1; 1: lanes 2 and 3.
        half: usize,
    },
    /// Two thresholds.
    Thresholds {
        /// Word.
        row: usize,
    },
    /// The two thresholds of the stage before, where the stage sends differences.
    PreviousThresholds {
        /// Word.
        row: usize,
    },
    /// A register: 0 and 1 are the shifts of each set, 2 is control, [`READ_REGISTER`] reads.
    Register {
        /// Which.
        row: usize,
    },
}

/// Register 2, bit 0: skip zeros.
pub const CONTROL_SKIP: u32 = 1;

/// Bits of [`address`]: stage, space, bank, row, half.
pub const ADDRESS_BITS: [u32; 5] = [4, 2, 6, 12, 1];

/// The write address of a word of stage `stage`.
#[must_use]
pub const fn address(stage: usize, space: Space) -> u32 {
    let (code, bank, row, half) = match space {
        Space::Weights { bank, row, half } => (0, bank, row, half),
        Space::Thresholds { row } => (1, 0, row, 0),
        Space::PreviousThresholds { row } => (2, 0, row, 0),
        Space::Register { row } => (3, 0, row, 0),
    };
    ((stage << 21) | (code << 19) | (bank << 13) | (row << 1) | half) as u32
}

/// The shifts of a stage, as one register holds them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Shifts {
    /// Right shift of the sum (6 bits).
    pub result: u32,
    /// Left shift of the base (6 bits).
    pub base: u32,
    /// Left shift of code values before they are multiplied (4 bits).
    pub code: u32,
    /// Left shift of the linear path's values (4 bits).
    pub linear: u32,
}

impl Shifts {
    /// Those of a stage.
    #[must_use]
    pub fn of(network: &FixedNetwork, stage: &StagePlan) -> Self {
        match stage.kind {
            Kind::I => Self { result: network.analysis_shift(), ..Self::default() },
            Kind::M => {
                let shifts = network.middle_shifts(stage.index - 1);
                Self { result: shifts.result, base: shifts.base, ..Self::default() }
            }
            Kind::F => {
                let shifts = network.final_shifts();
                Self { result: shifts.result, base: 0, code: shifts.dictionary, linear: shifts.linear_path }
            }
        }
    }

    /// The register's word.
    #[must_use]
    pub const fn word(self) -> u32 {
        self.result | (self.base << 6) | (self.code << 12) | (self.linear << 16)
    }
}

/// The weight of `output` for input `input` of a stage (F's linear path after the codes).
#[must_use]
pub fn weight(network: &FixedNetwork, stage: &StagePlan, output: usize, input: usize) -> i16 {
    match stage.kind {
        Kind::I => network.analysis.weights[[output, input]],
        Kind::M => network.recurrent_matrix(stage.index - 1).weights[[output, input]],
        Kind::F if input < stage.inputs => network.dictionary.weights[[output, input]],
        Kind::F => network.linear_path.as_ref().map_or(0, |r| r.weights[[output, input - stage.inputs]]),
    }
}

/// One set of weights of word `part` of a bank's rows, a 64-bit word a row.
#[must_use]
pub fn weight_words(network: &FixedNetwork, stage: &StagePlan, bank: usize, part: usize) -> Vec<u64> {
    let word = |pass: usize, row: usize| {
        let first = pass * stage.lanes + bank * BANK_LANES;
        let input = part * stage.segment() + row;
        let lane = |l: usize| u64::from(weight(network, stage, first + l, input) as u16) << (16 * l);
        (0..BANK_LANES).map(lane).sum()
    };
    (0..stage.passes()).flat_map(|pass| (0..stage.pass_rows()).map(move |row| word(pass, row))).collect()
}

/// Bits of a row's number that say which of its words is meant.
#[must_use]
pub fn row_bits(stage: &StagePlan) -> u32 {
    stage.row_words().next_power_of_two().trailing_zeros()
}

/// One set of thresholds, two a word; `before` gives those of the stage before.
#[must_use]
pub fn threshold_words(network: &FixedNetwork, stage: &StagePlan, before: bool) -> Vec<u32> {
    let theta = &network.thresholds[stage.index - usize::from(before)];
    let word = |pair: &[i16]| pair.iter().rev().fold(0, |word, v| (word << 16) | u32::from(*v as u16));
    theta.as_slice().map_or_else(Vec::new, |theta| theta.chunks(BEAT).map(word).collect())
}

/// All words of a set and the addresses at which the host writes them: weights, thresholds, shifts, stage by stage.
#[must_use]
pub fn writes(design: &Design, network: &FixedNetwork, set: Set) -> Vec<(u32, u32)> {
    let second = set as usize;
    let mut all = Vec::new();
    for stage in &design.stages().collect::<Vec<_>>() {
        let at = |space| address(stage.index, space);
        for bank in 0..stage.banks() {
            for part in 0..stage.row_words() {
                for (row, word) in weight_words(network, stage, bank, part).into_iter().enumerate() {
                    let row = ((second * stage.weight_rows() + row) << row_bits(stage)) + part;
                    let half = |half: usize| at(Space::Weights { bank, row, half });
                    all.extend([(half(0), word as u32), (half(1), (word >> 32) as u32)]);
                }
            }
        }
        let first = second * stage.beats_out();
        if stage.shrinks() {
            let words = threshold_words(network, stage, false).into_iter().enumerate();
            all.extend(words.map(|(row, word)| (at(Space::Thresholds { row: first + row }), word)));
        }
        if stage.sends_difference {
            let words = threshold_words(network, stage, true).into_iter().enumerate();
            all.extend(words.map(|(row, word)| (at(Space::PreviousThresholds { row: first + row }), word)));
        }
        all.push((at(Space::Register { row: second }), Shifts::of(network, stage).word()));
    }
    all
}

/// Path of the memory image of word `part` of a bank, relative to the generated directory: [`weight_images`], two digits of the bank,
/// one of the part.
#[must_use]
pub fn weight_image(stage: &StagePlan, bank: usize, part: usize) -> String {
    format!("{}{bank:02}_{part}.hex", weight_images(stage))
}

/// What the paths of all of a stage's memory images start with.
#[must_use]
pub fn weight_images(stage: &StagePlan) -> String {
    format!("mem/stage{}_bank", stage.index)
}

/// Steps that a write takes from its stage: one in cycle `first` after the write, and `every` cycles on again, `count` in all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steals {
    /// The stage.
    pub stage: usize,
    /// Cycles from the write to the first cycle without a step.
    pub first: u64,
    /// From each to the next.
    pub every: u64,
    /// How many.
    pub count: u64,
}

impl Steals {
    /// The cycles without a step, of a write in cycle `written`.
    pub fn cycles(self, written: u64) -> impl Iterator<Item = u64> {
        (0..self.count).map(move |k| written + self.first + k * self.every)
    }
}

/// What a write of `data` to an address takes from the multipliers of a stage: a weight where both ports of the memory read, a command
/// to read weights everywhere.
#[must_use]
pub fn steals(design: &Design, address: u32, data: u32) -> Option<Steals> {
    let (stage, space, row) = ((address >> 21) as usize, (address >> 19) & 3, (address >> 1) & 0xfff);
    if stage >= design.stages.len() {
        return None;
    }
    let (first, every, count) = match space {
        0 if design.stage(stage).reads_both_ports() => (STEAL_LATENCY, 0, 1),
        3 if row as usize == READ_REGISTER && data >> 30 == 0 => {
            (READ_LATENCY, READ_PERIOD, u64::from(data & 0xfff) + 1)
        }
        _ => return None,
    };
    Some(Steals { stage, first, every, count })
}

/// Register that a command to read is written to.
pub const READ_REGISTER: usize = 3;

/// Stage number that no stage has: register 0 there tells all stages to show their counters and to count anew.
pub const ALL_STAGES: usize = 15;

/// Cycles that a reader takes for a row.
pub const READ_PERIOD: u64 = 256;

/// The word that, written to [`READ_REGISTER`] of a stage, has `rows` of its rows read, from that of `from` on. Of weights both halves
/// are read at once. What the last row was and the CRC-32 of all ([`crc`]) can then be looked at.
#[must_use]
pub const fn read_command(from: Space, rows: usize) -> u32 {
    let (code, bank, row) = match from {
        Space::Weights { bank, row, .. } => (0, bank, row),
        Space::Thresholds { row } => (1, 0, row),
        Space::PreviousThresholds { row } => (2, 0, row),
        Space::Register { row } => (3, 0, row),
    };
    ((code << 30) | (bank << 24) | (row << 12) | (rows - 1)) as u32
}

/// CRC-32 (IEEE 802.3) of rows of 64 bits, the lowest bit of the first one first.
///
/// ```
/// use edof_spec::design::memory::crc;
/// // The check value that every description of this CRC gives, of "123456789", with seven bytes of zeros behind it.
/// let rows = [u64::from_le_bytes(*b"12345678"), u64::from(b'9')];
/// assert_eq!(crc(rows), crc32(b"123456789\0\0\0\0\0\0\0"));
/// assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
///
/// fn crc32(bytes: &[u8]) -> u32 {
///     !bytes.iter().fold(!0, |crc, byte| {
///         (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
///     })
/// }
/// ```
pub fn crc(rows: impl IntoIterator<Item = u64>) -> u32 {
    let bits = rows.into_iter().flat_map(|row| (0..64).map(move |bit| (row >> bit) as u32 & 1));
    !bits.fold(!0, |crc: u32, bit| (crc >> 1) ^ if (crc ^ bit) & 1 == 1 { 0xedb8_8320 } else { 0 })
}

/// All rows of a bank that hold one set, as a reader goes through them: numbers that stand for no word count as 0.
#[must_use]
pub fn bank_rows(network: &FixedNetwork, stage: &StagePlan, bank: usize) -> Vec<u64> {
    let parts: Vec<Vec<u64>> =
        (0..stage.row_words()).map(|part| weight_words(network, stage, bank, part)).collect();
    let word = |row: usize, part: usize| parts.get(part).map_or(0, |words| words[row]);
    (0..stage.weight_rows())
        .flat_map(|row| (0..1 << row_bits(stage)).map(move |part| (row, part)))
        .map(|(row, part)| word(row, part))
        .collect()
}

/// Path of a threshold memory's image.
#[must_use]
pub fn threshold_image(stage: &StagePlan, before: bool) -> String {
    format!("mem/stage{}_{}.hex", stage.index, if before { "previous_thresholds" } else { "thresholds" })
}
