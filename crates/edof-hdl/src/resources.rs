//! What a design takes of an FPGA, before any tool runs.
//!
//! Counts follow from the stages' sizes and from what Yosys 0.23 makes of each block for 7-series (`synth_xilinx -family xc7`).
//! Multipliers and block RAM are exact; LUTs and flip-flops lie within 15 % (a test holds all committed designs to that).

use edof_spec::Design;
use edof_spec::design::{BANK_LANES, BEAT, StagePlan, timing};
use serde::Serialize;
use std::iter::Sum;
use std::ops::{Add, Mul};

/// Cells of a 7-series FPGA.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Resources {
    /// Multipliers with their accumulators.
    pub dsp48e1: usize,
    /// Block RAMs of 36 kbit.
    pub ramb36e1: usize,
    /// Block RAMs of 18 kbit.
    pub ramb18e1: usize,
    /// LUTs, as logic, memory or shift registers.
    pub lut: usize,
    /// Flip-flops.
    pub ff: usize,
}

/// What an XC7K325T has.
pub const XC7K325T: Resources =
    Resources { dsp48e1: 840, ramb36e1: 445, ramb18e1: 890, lut: 203_800, ff: 407_600 };

impl Resources {
    const fn logic(lut: usize, ff: usize) -> Self {
        Self { dsp48e1: 0, ramb36e1: 0, ramb18e1: 0, lut, ff }
    }

    /// Share of a device that the scarcest kind takes, and which kind that is.
    #[must_use]
    pub fn fullest(&self, device: &Self) -> (&'static str, f64) {
        let share = |used: usize, there: usize| used as f64 / there as f64;
        let blocks = 2 * self.ramb36e1 + self.ramb18e1;
        let kinds = [
            ("dsp48e1", share(self.dsp48e1, device.dsp48e1)),
            ("ramb36e1", share(blocks, 2 * device.ramb36e1)),
            ("lut", share(self.lut, device.lut)),
            ("ff", share(self.ff, device.ff)),
        ];
        kinds.into_iter().fold(kinds[0], |most, kind| if kind.1 > most.1 { kind } else { most })
    }
}

impl Add for Resources {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            dsp48e1: self.dsp48e1 + other.dsp48e1,
            ramb36e1: self.ramb36e1 + other.ramb36e1,
            ramb18e1: self.ramb18e1 + other.ramb18e1,
            lut: self.lut + other.lut,
            ff: self.ff + other.ff,
        }
    }
}

impl Mul<usize> for Resources {
    type Output = Self;

    fn mul(self, times: usize) -> Self {
        Self {
            dsp48e1: self.dsp48e1 * times,
            ramb36e1: self.ramb36e1 * times,
            ramb18e1: self.ramb18e1 * times,
            lut: self.lut * times,
            ff: self.ff * times,
        }
    }
}

impl Sum for Resources {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Add::add)
    }
}

/// What each stage of a design takes.
///
/// ```
/// use edof_hdl::resources::{XC7K325T, stages};
/// let design = edof_spec::Design::from_json(include_str!("../../../designs/kc705.json"))?;
/// let all: edof_hdl::resources::Resources = stages(&design).into_iter().sum();
/// assert_eq!(all.dsp48e1, 800);
/// assert_eq!(all.fullest(&XC7K325T).0, "dsp48e1");
/// # Ok::<(), edof_spec::design::DesignError>(())
/// ```
#[must_use]
pub fn stages(design: &Design) -> Vec<Resources> {
    design.stages().map(|plan| stage(&plan, design.accumulator_bits as usize)).collect()
}

/// One stage, its sums `sum_bits` wide.
fn stage(plan: &StagePlan, sum_bits: usize) -> Resources {
    let mut parts = vec![
        bank(plan, sum_bits) * plan.banks(),
        pair_buffer(plan),
        sequencer(plan),
        drain(),
        results(plan),
        fifo(plan.feeds_m),
        registers_and_counters(),
    ];
    if plan.linear > 0 {
        parts.push(Resources::logic(42, 28) + block_ram(plan.linear / BEAT * plan.kept_windows));
    }
    parts.into_iter().sum()
}

/// Four lanes: their holding registers take their sum, or the one from the next bank, at one LUT a bit.
fn bank(plan: &StagePlan, sum_bits: usize) -> Resources {
    let hold = BANK_LANES * sum_bits;
    let depth = plan.weight_depth();
    if plan.rows == 2 {
        // Both ports read: 32 bits a block. The two sums of a lane are added, one LUT a bit.
        let ramb36e1 = 2 * depth.div_ceil(1024);
        Resources { dsp48e1: 2 * BANK_LANES, ramb36e1, ramb18e1: 0, lut: 2 * hold + 15, ff: hold + 52 }
    } else {
        let ramb36e1 = depth.div_ceil(512);
        Resources { dsp48e1: BANK_LANES, ramb36e1, ramb18e1: 0, lut: hold + 6, ff: hold + 27 }
    }
}

/// Two slots of pairs, 25 bits each.
fn pair_buffer(plan: &StagePlan) -> Resources {
    Resources::logic(90, 41) + lut_ram(25, plan.inputs) * 2
}

const fn sequencer(plan: &StagePlan) -> Resources {
    if plan.rows == 2 { Resources::logic(285, 126) } else { Resources::logic(195, 97) }
}

const fn drain() -> Resources {
    Resources::logic(27, 27)
}

/// Two elements a cycle through rounding, threshold and difference, with their memories and delays.
fn results(plan: &StagePlan) -> Resources {
    let mut parts = vec![Resources::logic(36, 106)];
    let requantize = if plan.has_base() { Resources::logic(519, 221) } else { Resources::logic(352, 220) };
    parts.push(requantize * 2);
    let shrink = Resources::logic(56, 17) * 2;
    if plan.has_base() {
        parts.push(Resources::logic(29, 24) + lut_ram(32, plan.beats_in() * timing::BASE_VECTORS));
    }
    if plan.shrinks() {
        parts.push(shrink + Resources::logic(3, 2) + lut_ram(32, plan.outputs));
    }
    if plan.sends_difference {
        // The z before, made again, and its difference to this one.
        parts.push(shrink + Resources::logic(32, 0) + lut_ram(32, plan.outputs));
        parts.push(Resources::logic(52, 17) * 2);
    } else if plan.shrinks() {
        parts.push(Resources::logic(0, 32));
    }
    let result_goes_on = !plan.shrinks() || plan.feeds_m && (plan.sends_difference || !plan.has_base());
    if result_goes_on {
        parts.push(Resources::logic(0, 64));
    } else if plan.feeds_m {
        parts.push(Resources::logic(32, 0));
    }
    parts.into_iter().sum()
}

fn fifo(base: bool) -> Resources {
    let width = if base { 66 } else { 34 };
    Resources::logic(10 + 4 * ram_blocks(width, 16).0, 14)
}

const fn registers_and_counters() -> Resources {
    Resources::logic(6 + 36 + 50, 41 + 128)
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

/// A block RAM 32 bits wide.
const fn block_ram(depth: usize) -> Resources {
    let none = Resources::logic(0, 0);
    if depth <= 512 {
        Resources { ramb18e1: 1, ..none }
    } else {
        Resources { ramb36e1: depth.div_ceil(1024), ..none }
    }
}
