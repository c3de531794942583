//! What a design takes of its board's FPGA, before any tool runs.
//!
//! Counts follow from the stages' sizes and from what Yosys 0.23 makes of each block for 7-series (`synth_xilinx -family xc7`).
//! Multipliers and block RAM are exact; LUTs and flip-flops lie within 15 % (a test holds all committed designs to that).

mod stream_core;

use crate::blocks::SLOT_ROWS;
use crate::blocks::shrink::extra_logic;
use edof_device::Design;
use edof_device::board::{Part, Resources};
use edof_device::design::{BANK_LANES, BEAT, Kind, StagePlan, timing};
pub use stream_core::around_the_chain;

/// Returns what each stage of a design takes of its board's part.
///
/// ```
/// use edof_hdl::resources::{stages, whole};
/// let design = edof_device::Design::from_json(include_str!("../../../designs/kc705.json"))?;
/// assert_eq!(stages(&design).iter().map(|stage| stage.multipliers).sum::<usize>(), 800);
/// assert_eq!(design.board.part.fullest(&whole(&design)).0, "dsp48e1");
/// # Ok::<(), edof_device::design::DesignError>(())
/// ```
#[must_use]
pub fn stages(design: &Design) -> Vec<Resources> {
    let part = &design.board.part;
    let (luts, registers) = extra_logic(design.form.shrinkage);
    // Two elements a cycle, and the two before them where a stage sends differences.
    let blocks = |plan: &StagePlan| 2 * (usize::from(plan.shrinks()) + usize::from(plan.sends_difference));
    let extra =
        |plan: &StagePlan| scaled(part, Resources::logic(blocks(plan) * luts, blocks(plan) * registers));
    design.stages().map(|plan| stage(part, &plan, design.accumulator_bits as usize) + extra(&plan)).collect()
}

/// Returns what the whole calculator, the module `chain`, takes: its stages, and what makes windows whole before them.
#[must_use]
pub fn whole(design: &Design) -> Resources {
    stages(design).into_iter().sum::<Resources>() + scaled(&design.board.part, Resources::logic(115, 152))
}

/// Returns what the module `stream_core` takes: the calculator, and all that it needs without a board.
#[must_use]
pub fn stream_core(design: &Design) -> Resources {
    around_the_chain(design).into_iter().map(|(_, used)| used).sum::<Resources>() + whole(design)
}

/// Returns the block memories of one bank of weights.
pub(crate) fn bank_memories(part: &Part, plan: &StagePlan) -> Resources {
    let (bits, depth) = (BANK_LANES * 16, plan.weight_depth());
    if plan.reads_both_ports() {
        part.memory.blocks_read_twice(bits, depth)
    } else {
        part.memory.blocks(bits, depth) * plan.row_words()
    }
}

/// Cells of a part, of those of a 7-series part.
fn scaled(part: &Part, used: Resources) -> Resources {
    let [luts, registers] = part.logic_percent;
    Resources { luts: used.luts * luts / 100, registers: used.registers * registers / 100, ..used }
}

/// One stage, its sums `sum_bits` wide.
fn stage(part: &Part, plan: &StagePlan, sum_bits: usize) -> Resources {
    let blocks = blocks(part, plan, sum_bits);
    let merged = merged(plan.rows);
    let (luts, registers) = (blocks.luts - merged.luts, blocks.registers - merged.registers);
    scaled(part, Resources { luts, registers, ..blocks })
}

/// What the blocks of a stage have by themselves and the stage has not: mapped flat, constants and bits that nobody reads pass their
/// borders.
const fn merged(rows: usize) -> Resources {
    Resources::logic(620 + 135 * (rows - 1), 510 + 110 * (rows - 1))
}

/// The blocks of a stage, each by itself.
fn blocks(part: &Part, plan: &StagePlan, sum_bits: usize) -> Resources {
    let mut parts = vec![
        // The host's words and the reset on their way.
        Resources::logic(10 + 52, 152 + 52),
        multipliers(part, plan, sum_bits),
        store(part, plan),
        operands(plan),
        // Sequencer, drain.
        Resources::logic(75 + 41, 130 + 48),
        results(part, plan),
        // The FIFO.
        Resources::logic(140, 51),
        registers_and_counters(),
        // What is read back, and its CRC.
        Resources::logic(279, 188),
        // The CRC of frames.
        Resources::logic(230, 184),
    ];
    if plan.feeds_m {
        parts.push(Resources::logic(130, 49));
    }
    if plan.linear > 0 {
        let rows = (plan.linear / BEAT).next_power_of_two() * plan.kept_windows;
        parts.push(Resources::logic(26, 90) + part.memory.blocks(32, rows));
    }
    parts.into_iter().sum()
}

/// All banks, what their values come through, and the adders of their rows.
fn multipliers(part: &Part, plan: &StagePlan, sum_bits: usize) -> Resources {
    let (rows, depth) = (plan.rows, plan.weight_depth());
    let address_bits = depth.next_power_of_two().trailing_zeros() as usize;
    // Each multiplier's holding register takes its sum, or the one from the next bank, at one LUT a bit.
    let hold = BANK_LANES * rows * sum_bits;
    // A row, values, and two registers of control for each multiplier.
    let kept = rows * (64 + 25 + 2 * BANK_LANES) + 3 + 2 * address_bits;
    let logic = if plan.reads_both_ports() {
        Resources::logic(hold + 4 + address_bits, hold + kept + 2)
    } else {
        let words = plan.row_words();
        Resources::logic(hold + 3 * words, hold + kept + 2 * words)
    };
    let bank = bank_memories(part, plan) + logic;
    let shared = Resources::logic(289, 727 + rows * (2 * 25 + 2 * sum_bits));
    // The host's writes come to every eight banks in registers of their own, and what it reads goes back: two inputs for each word.
    let group = |banks: usize| {
        let inputs = 2 * banks * plan.row_words();
        let select = 4 * banks * plan.row_words();
        Resources::logic(64 * inputs.div_ceil(5) + select, 20 + 2 * 32 + 1 + 2 * 19 + 64 + select / 2)
    };
    let groups = (0..plan.banks()).step_by(8).map(|first| group((plan.banks() - first).min(8)));
    let address = Resources::logic(if plan.reads_both_ports() { 1 } else { address_bits + 2 }, 0);
    let banks = (bank + address) * plan.banks() + groups.sum::<Resources>();
    Resources { multipliers: plan.dsps(), ..banks + shared }
}

/// Four slots of vectors in block RAM: pairs of 25 bits, or the parts of dense vectors.
fn store(part: &Part, plan: &StagePlan) -> Resources {
    let rows = timing::SLOTS * SLOT_ROWS;
    if plan.is_dense() {
        Resources::logic(23, 51 + 32 * plan.rows) + part.memory.blocks(32, rows) * plan.rows
    } else {
        Resources::logic(121, 216) + part.memory.blocks(32, rows) * 2
    }
}

/// From what a step read to rows and values; F shifts them.
fn operands(plan: &StagePlan) -> Resources {
    match (plan.kind, plan.rows) {
        (Kind::I, _) => Resources::logic(76, 188),
        (Kind::M, 1) => Resources::logic(40, 143),
        (Kind::M, _) => Resources::logic(80, 188),
        (Kind::F, 1) => Resources::logic(85, 155),
        (Kind::F, _) => Resources::logic(166, 208),
    }
}

/// Two elements a cycle through rounding, threshold and difference, with their memories and delays.
fn results(part: &Part, plan: &StagePlan) -> Resources {
    let mut parts = vec![Resources::logic(845, 1080)];
    if plan.has_base() {
        parts.push(Resources::logic(240, 233) + part.memory.blocks(32, timing::BASE_VECTORS * SLOT_ROWS));
    }
    if plan.shrinks() {
        parts.push(Resources::logic(87, 215) + lut_ram(32, plan.outputs));
    }
    if plan.sends_difference {
        // The z before, made again, and its difference to this one.
        parts.push(Resources::logic(196, 144) + lut_ram(32, plan.outputs));
    }
    if !plan.shrinks() || plan.feeds_m && (plan.sends_difference || !plan.has_base()) {
        // The result leaves the stage, as the sent word or next to it.
        parts.push(Resources::logic(32, 32));
    }
    parts.into_iter().sum()
}

const fn registers_and_counters() -> Resources {
    Resources::logic(6 + 48 + 4 * 32, 41 + 4 * 71)
}

/// LUT RAM whose read is registered.
fn lut_ram(width: usize, depth: usize) -> Resources {
    let (blocks, deep) = ram_blocks(width, depth);
    let select = match deep {
        1 => 0,
        2..=4 => width + 3,
        5..=6 => 2 * width + 11,
        _ => width * deep.div_ceil(3) + 11,
    };
    Resources::logic(4 * blocks + select, width)
}

/// Blocks of four LUTs that a memory takes, and how many stand behind one another: 64 rows of 3 bits or 32 of 6 each.
fn ram_blocks(width: usize, depth: usize) -> (usize, usize) {
    let blocks =
        |rows: usize, bits: usize| (depth.div_ceil(rows) * width.div_ceil(bits), depth.div_ceil(rows));
    blocks(64, 3).min(blocks(32, 6))
}
