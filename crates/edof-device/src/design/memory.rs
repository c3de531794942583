//! What lies where in a stage's memories, and the addresses at which the host writes them.
//!
//! Weights lie in banks of [`BANK_LANES`] lanes, one 64-bit word a row: lane 0 in the lowest 16 bits. Row `set·weight_rows +
//! pass·pass_rows + input` holds the weights of that input for outputs `pass·lanes + bank·4 …`. F's linear path follows the
//! codes as inputs `codes … codes + pixels`. In I, whose vectors are dense, a row holds `rows` such words, of inputs that lie
//! `inputs / rows` apart, and rows are numbered so that the lowest bits say which word ([`row_bits`]). Thresholds lie two a word, at `set·outputs/2 + output/2`.

use super::{BANK_LANES, BEAT, Design, Kind, StagePlan};
use edof_network::fixed_network::FixedNetwork;

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
    /// A register: 0 and 1 are the shifts of each set, 2 is control, 3 takes commands to read back.
    Register {
        /// Which.
        row: usize,
    },
}

/// Register 2, bit 0: skip zeros.
pub const CONTROL_SKIP: u32 = 1;

/// Stage number that no stage has: the chain as a whole. Its counters are of windows that were too short (0) and too long (1).
pub const WHOLE_CHAIN: usize = 15;

/// Stage number that no stage has: the tables of the display, which are read back as a stage's weights are ([`super::reading::table_rows`]).
pub const TABLES: usize = 14;

/// A write of anything to this address copies all counters of all stages to where they are shown, and starts them anew.
pub const SNAPSHOT: u32 = address(WHOLE_CHAIN, Space::Register { row: 0 });

/// Stage and space of [`SNAPSHOT`]: a write of anything to any of these registers does the same.
pub const SNAPSHOT_REGISTERS: usize = WHOLE_CHAIN << 2 | 3;

/// Bits of [`address`]: stage, space, bank, row, half.
pub const ADDRESS_BITS: [u32; 5] = [4, 2, 6, 12, 1];

/// Most words of a bank, all sets: [`ADDRESS_BITS`] and a command to read ([`super::reading::read_command`]) number them in 12 bits.
pub const MAX_BANK_WORDS: usize = 1 << ADDRESS_BITS[3];

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

/// Rows of a set in each space of a stage: those of set 0 come first, then those of set 1.
#[must_use]
pub fn rows_of_a_set(stage: &StagePlan) -> [usize; 4] {
    [stage.bank_words() / stage.sets, stage.beats_out(), stage.beats_out(), 1]
}

/// The set that a word belongs to, by the address at which the host writes it; none where it belongs to no set or lies in no stage.
#[must_use]
pub fn set_of(design: &Design, address: u32) -> Option<Set> {
    let (stage, space) = ((address >> 21) as usize, (address >> 19 & 3) as usize);
    let row = (address >> 1 & 0xfff) as usize;
    if stage >= design.stages.len() || (space == 3 && row > 1) {
        return None;
    }
    Some(if row < rows_of_a_set(&design.stage(stage))[space] { Set::First } else { Set::Second })
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

/// All words of one of the design's sets and the addresses at which the host writes them: weights, thresholds, shifts, stage by stage.
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

/// Folder of all memory images, relative to the generated directory. Verilog names the files alone.
pub const IMAGES: &str = "mem/";

/// The name of a memory image, or the beginning of several, as Verilog has it.
#[must_use]
pub fn image_name(path: &str) -> &str {
    path.strip_prefix(IMAGES).unwrap_or(path)
}

/// Path of the memory image of word `part` of a bank, relative to the generated directory: [`weight_images`], two digits of the bank,
/// one of the part.
#[must_use]
pub fn weight_image(stage: &StagePlan, bank: usize, part: usize) -> String {
    format!("{}{bank:02}_{part}.mem", weight_images(stage))
}

/// What the paths of all of a stage's memory images start with.
#[must_use]
pub fn weight_images(stage: &StagePlan) -> String {
    format!("{IMAGES}stage{}_bank", stage.index)
}

/// Path of the image of the shifts that a stage begins with: [`Shifts::word`] of set 0, then of set 1.
#[must_use]
pub fn shift_image(stage: &StagePlan) -> String {
    format!("{IMAGES}stage{}_shifts.mem", stage.index)
}

/// Path of a threshold memory's image.
#[must_use]
pub fn threshold_image(stage: &StagePlan, before: bool) -> String {
    format!("{IMAGES}stage{}_{}.mem", stage.index, if before { "previous_thresholds" } else { "thresholds" })
}

#[cfg(test)]
mod tests {
    use super::super::StageSize;
    use super::*;

    /// A design whose I has the given window, codes, lanes and rows.
    fn dense(window: usize, codes: usize, lanes: usize, rows: usize) -> Design {
        let mut design = Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
        design.form.window = edof_core::Window::new(window).unwrap();
        (design.form.codes, design.form.layers) = (codes, 2);
        design.stages = [(lanes, rows), (64, 2)].map(|(lanes, rows)| StageSize { lanes, rows }).into();
        design
    }

    #[test]
    fn a_bank_has_at_most_as_many_words_as_addresses() {
        // Outputs / lanes x inputs x 2 sets; with three rows each fourth number has no word.
        for (window, codes, lanes, rows, words) in [
            (8, 256, 8, 4, 4096),
            (8, 256, 4, 4, 8192),
            (12, 192, 12, 4, 4608),
            (12, 192, 16, 4, 3456),
            (12, 192, 16, 3, 4608),
            (12, 192, 24, 3, 3072),
            (16, 256, 32, 1, 4096),
            (16, 256, 16, 1, 8192),
        ] {
            let design = dense(window, codes, lanes, rows);
            let stage = design.stage(0);
            assert_eq!(stage.bank_words(), words);
            assert_eq!(design.check().is_ok(), words <= 4096, "{words} words");
            if words > 4096 {
                let expected = format!(
                    "stages[0].lanes {lanes}: must be more: four lanes have two sets of weights in {words} words with {rows} rows, \
                     and addresses for 4096"
                );
                assert_eq!(design.check().unwrap_err().to_string(), expected);
            } else {
                let last = Space::Weights { bank: stage.banks() - 1, row: words - 1, half: 1 };
                assert_eq!(set_of(&design, address(0, last)), Some(Set::Second));
            }
        }
    }

    #[test]
    fn one_set_has_half_the_words_on_boards_that_take_one() {
        let mut design = dense(12, 192, 16, 3);
        assert!(design.check().is_err());
        design.board = &crate::board::ULX3S;
        design.sets = 1;
        design.check().unwrap();
        let stage = design.stage(0);
        assert_eq!((stage.bank_words(), stage.weight_depth(), design.sets()), (2304, 576, &[Set::First][..]));
        let last = Space::Weights { bank: 3, row: 2303, half: 1 };
        assert_eq!(set_of(&design, address(0, last)), Some(Set::First));
        let text = serde_json::to_string(&design).unwrap();
        assert_eq!(Design::from_json(&text).unwrap(), design);
        let of = |board: &str| text.replace("\"ulx3s\"", &format!("\"{board}\""));
        let error = Design::from_json(&of("kc705")).unwrap_err().to_string();
        assert_eq!(error, "design: sets 1: must be 2 on board kc705");
        let none = text.replace("\"sets\":1", "\"sets\":0");
        assert!(Design::from_json(&none).unwrap_err().to_string().contains("must be 1 or 2 on board ulx3s"));
    }

    #[test]
    fn every_word_of_a_set_is_known_as_one_of_it() {
        for name in ["tiny", "kc705", "paper"] {
            let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
            let design = Design::load(std::path::Path::new(&path)).unwrap();
            for set in [Set::First, Set::Second] {
                for stage in design.stages() {
                    let of_set = |space: usize| {
                        let rows = rows_of_a_set(&stage)[space];
                        (set as usize * rows..(set as usize + 1) * rows).map(move |row| (space, row))
                    };
                    for (space, row) in (0..4).flat_map(of_set) {
                        let at = match space {
                            0 => Space::Weights { bank: 1, row, half: 1 },
                            1 => Space::Thresholds { row },
                            2 => Space::PreviousThresholds { row },
                            _ => Space::Register { row },
                        };
                        assert_eq!(set_of(&design, address(stage.index, at)), Some(set));
                    }
                }
            }
            for (stage, row) in [(0, 2), (0, 3), (design.stages.len(), 0), (WHOLE_CHAIN, 0), (TABLES, 3)] {
                assert_eq!(set_of(&design, address(stage, Space::Register { row })), None);
            }
        }
    }
}
