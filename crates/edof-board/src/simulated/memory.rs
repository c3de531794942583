//! What a calculator's stages hold: weights, thresholds, shifts, and what reads them back.

use edof_core::colour::OUTPUTS_422;
use edof_core::number::{INPUT_FRACTION, OUTPUT_FRACTION};
use edof_device::design::memory::{CONTROL_SKIP, Shifts, row_bits, threshold_words};
use edof_device::design::reading::{CHECK_FRAME_REGISTER, CHECK_REGISTER, READ_REGISTER, bank_rows, crc};
use edof_device::design::stage::Kind;
use edof_device::design::{BANK_LANES, BEAT, Design, StagePlan};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedMatrix;
use edof_network::network::{Form, Recurrence};

/// One stage.
#[derive(Debug, Clone)]
pub struct Stage {
    plan: StagePlan,
    /// Rows of each bank by their numbers; a number that stands for no row holds 0.
    weights: Vec<Vec<u64>>,
    /// Both sets of thresholds, and of those of the stage before.
    thresholds: [Vec<u32>; 2],
    shifts: [u32; 2],
    skip: u32,
    /// What was read last: CRC, row.
    read: (u32, u64),
    /// What it shows of the check of frames: CRC, number.
    check: [u32; 2],
}

/// Bits of a register of shifts.
const SHIFT_BITS: u32 = (1 << 20) - 1;

impl Stage {
    /// A stage whose sets start with these networks.
    #[must_use]
    pub fn new(design: &Design, plan: StagePlan, sets: [&FixedNetwork; 2]) -> Self {
        let both = |one: &dyn Fn(&FixedNetwork) -> Vec<u32>| sets.iter().flat_map(|n| one(n)).collect();
        let bank = |bank| sets.iter().flat_map(|n| bank_rows(n, &plan, bank)).collect();
        let kept = |there: bool, before: bool| match there {
            true => both(&|network| threshold_words(network, &plan, before)),
            false => vec![],
        };
        let shifts = sets.map(|network| Shifts::of(network, &plan).word());
        let skip = if design.skip_zeros { CONTROL_SKIP } else { 0 };
        Self {
            weights: (0..plan.banks()).map(bank).collect(),
            thresholds: [kept(plan.shrinks(), false), kept(plan.sends_difference, true)],
            shifts,
            skip,
            read: (0, 0),
            check: [0; 2],
            plan,
        }
    }

    /// What a flush or a reset does to what is being read; all that was written stays.
    pub fn forget(&mut self) {
        self.read = (0, 0);
        self.check = [0; 2];
    }

    /// What the registers of the check show from now on: CRC of what it sent of a frame, and that frame's number.
    pub const fn show_check(&mut self, check: [u32; 2]) {
        self.check = check;
    }

    /// Writes a word to {space (2 bits), bank (6), row (12), half (1)}; gives the set that it belongs to, if one, and the rows that a
    /// command reads.
    pub fn write(&mut self, address: u32, word: u32) -> (Option<usize>, usize) {
        let (space, bank) = (address >> 19 & 3, (address >> 13 & 0x3f) as usize);
        let (row, half) = ((address >> 1 & 0xfff) as usize, address & 1);
        match space {
            0 => {
                let rows = self.plan.weight_rows() << row_bits(&self.plan);
                let part = row & ((1 << row_bits(&self.plan)) - 1);
                let found = self.weights.get_mut(bank).and_then(|bank| bank.get_mut(row));
                let Some(found) = found.filter(|_| part < self.plan.row_words()) else { return (None, 0) };
                *found = *found & !(0xffff_ffff << (32 * half)) | u64::from(word) << (32 * half);
                (Some(row / rows), 0)
            }
            3 if row == READ_REGISTER => (None, self.command(word)),
            3 => {
                match row {
                    0 | 1 => self.shifts[row] = word & SHIFT_BITS,
                    2 => self.skip = word & CONTROL_SKIP,
                    _ => {}
                }
                (Some(row).filter(|row| *row < 2), 0)
            }
            _ => {
                let Some(found) = self.thresholds[space as usize - 1].get_mut(row) else { return (None, 0) };
                *found = word;
                (Some(row / self.plan.beats_out()), 0)
            }
        }
    }

    /// Reads rows.
    fn command(&mut self, command: u32) -> usize {
        let (space, bank) = (command >> 30, (command >> 24 & 0x3f) as usize);
        let (first, count) = ((command >> 12 & 0xfff) as usize, (command & 0xfff) as usize + 1);
        let row = |row: usize| match space {
            0 => self.weights.get(bank).and_then(|bank| bank.get(row)).copied().unwrap_or(0),
            3 => match row {
                0 | 1 => self.shifts[row].into(),
                2 => self.skip.into(),
                CHECK_REGISTER => self.check[0].into(),
                CHECK_FRAME_REGISTER => self.check[1].into(),
                _ => 0,
            },
            _ => self.thresholds[space as usize - 1].get(row).copied().unwrap_or(0).into(),
        };
        let rows: Vec<u64> = (first..first + count).map(row).collect();
        self.read = (crc(rows.iter().copied()), rows[count - 1]);
        count
    }

    /// Whether the stage multiplies only non-zero values.
    #[must_use]
    pub const fn skips(&self) -> bool {
        self.skip & CONTROL_SKIP != 0
    }

    /// What it read last: CRC of all rows, and the last one.
    #[must_use]
    pub const fn read(&self) -> (u32, u64) {
        self.read
    }

    fn weight(&self, set: usize, output: usize, input: usize) -> i16 {
        let plan = &self.plan;
        let (pass, lane) = (output / plan.lanes, output % plan.lanes);
        let (part, row) =
            if plan.is_dense() { (input / plan.segment(), input % plan.segment()) } else { (0, input) };
        let number = ((set * plan.weight_rows() + pass * plan.pass_rows() + row) << row_bits(plan)) + part;
        (self.weights[lane / BANK_LANES][number] >> (16 * (lane % BANK_LANES))) as i16
    }

    fn threshold(&self, set: usize, output: usize) -> i16 {
        (self.thresholds[0][set * self.plan.beats_out() + output / BEAT] >> (16 * (output % BEAT))) as i16
    }

    fn shift(&self, set: usize) -> [i64; 4] {
        let field = |low: u32, bits: u32| i64::from(self.shifts[set] >> low & ((1 << bits) - 1));
        [field(0, 6), field(6, 6), field(12, 4), field(16, 4)]
    }
}

/// The network that a set of all stages makes, none where its words are no network that could run. `like` gives what memories do not hold:
/// window of averaging, origin.
#[must_use]
pub fn network(design: &Design, stages: &[Stage], set: usize, like: &FixedNetwork) -> Option<FixedNetwork> {
    let same = |network: &FixedNetwork| {
        stages.iter().all(|stage| Shifts::of(network, &stage.plan).word() == stage.shifts[set])
    };
    // Fraction bits follow from shifts except for those of the first code.
    let candidates = (0..=30).filter_map(|first| with_first(design, stages, set, like, first));
    candidates.into_iter().find(|network| network.check().is_ok() && same(network))
}

fn with_first(
    design: &Design,
    stages: &[Stage],
    set: usize,
    like: &FixedNetwork,
    first: i64,
) -> Option<FixedNetwork> {
    let form = Form { tied: false, ..design.form };
    let whole = |fraction: i64| u32::try_from(fraction).ok().filter(|f| *f <= 48);
    let matrix = |stage: &Stage, (rows, columns): (usize, usize), from: usize, fraction: i64| {
        let weights =
            ndarray::Array2::from_shape_fn((rows, columns), |(o, i)| stage.weight(set, o, from + i));
        Some(FixedMatrix { weights, fraction: whole(fraction)? })
    };
    let (codes, pixels) = (form.codes, form.window.pixels());
    let mut fractions = vec![first];
    let [result, ..] = stages[0].shift(set);
    let input = i64::from(INPUT_FRACTION);
    let mut recurrent = vec![];
    let last = stages.last()?;
    // The formulas of `edof_network::fixed_network`, solved for fraction bits.
    let analysis_fraction = result + first - input;
    let mut recurrent_fractions = vec![];
    for (layer, stage) in stages[1..stages.len() - 1].iter().enumerate() {
        let [result, base, ..] = stage.shift(set);
        let of_base = if form.recurrence == Recurrence::Direct { first } else { fractions[layer] };
        let sum = base + of_base;
        recurrent_fractions.push(sum - fractions[layer]);
        fractions.push(sum - result);
    }
    let [result, _, code, linear] = last.shift(set);
    let sum = i64::from(OUTPUT_FRACTION) + result;
    let dictionary_fraction = sum - code - fractions[fractions.len() - 1];
    let code_fractions = fractions.iter().map(|f| whole(*f)).collect::<Option<Vec<u32>>>()?;
    for (stage, fraction) in stages[1..].iter().zip(&recurrent_fractions) {
        debug_assert_eq!(stage.plan.kind, Kind::M);
        recurrent.push(matrix(stage, (codes, codes), 0, *fraction)?);
    }
    let linear_path = match form.linear_path {
        true => Some(matrix(last, (OUTPUTS_422, pixels), codes, sum - linear - input)?),
        false => None,
    };
    let theta = |stage: &Stage| (0..codes).map(|output| stage.threshold(set, output)).collect();
    Some(FixedNetwork {
        form,
        code_bits: design.code_bits,
        stride: design.frame.stride,
        analysis: matrix(&stages[0], (codes, pixels), 0, analysis_fraction)?,
        thresholds: stages[..stages.len() - 1].iter().map(theta).collect(),
        recurrent,
        dictionary: matrix(last, (OUTPUTS_422, codes), 0, dictionary_fraction)?,
        linear_path,
        code_fractions,
        ..like.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_device::design::memory::{Set, writes};

    #[test]
    fn a_network_comes_back_out_of_the_memories() {
        let tiny = Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
        for seed in 0..20 {
            let mut design = tiny.clone();
            if seed % 2 == 1 {
                design.form.recurrence = Recurrence::Difference;
            }
            let (old, new) = (
                edof_device::random::for_design(&design, 100 + seed),
                edof_device::random::for_design(&design, seed),
            );
            let mut stages: Vec<Stage> =
                design.stages().map(|plan| Stage::new(&design, plan, [&old, &old])).collect();
            for (address, word) in writes(&design, &new, Set::Second) {
                let (set, _) = stages[(address >> 21) as usize].write(address & 0x1f_ffff, word);
                assert_eq!(set, Some(1));
            }
            for (set, expected) in [&old, &new].into_iter().enumerate() {
                let found = network(&design, &stages, set, &old).unwrap();
                assert_eq!(found.analysis.weights, expected.analysis.weights);
                assert_eq!(
                    found.recurrent.iter().map(|m| &m.weights).collect::<Vec<_>>(),
                    expected.recurrent.iter().map(|m| &m.weights).collect::<Vec<_>>()
                );
                assert_eq!(
                    (found.dictionary.weights.clone(), &found.thresholds),
                    (expected.dictionary.weights.clone(), &expected.thresholds)
                );
                for plan in design.stages() {
                    assert_eq!(Shifts::of(&found, &plan), Shifts::of(expected, &plan), "seed {seed}");
                }
            }
        }
    }
}
