//! A floorplan of the calculator on the KC705's part, for users who need one; no step of the build reads the file.
//!
//! Each group of eight banks has a block of rows, in the order in which data pass: stage by stage, the highest banks first. Blocks of
//! neighbours overlap, so that none is full although the part nearly is.

use crate::board::blocks;
use edof_device::Design;
use edof_device::design::stage::GROUP_BANKS;
use std::fmt::Write;

/// Columns of DSP48E1 in the XC7K325T, each of [`DSP_ROWS`].
const DSP_COLUMNS: usize = 6;
/// Rows of DSP48E1; two of them, and one of RAMB36E1, are five rows of slices.
const DSP_ROWS: usize = 140;
/// Columns of RAMB36E1; the last one has gaps and is not counted on.
const RAM_COLUMNS: usize = 7;
/// Largest share of its places that a block takes, in percent.
const MAX_FILL: usize = 80;

/// A group of banks and its rows of DSP48E1; a row of RAMB36E1 is two of these.
struct Block {
    name: String,
    /// Instances of the group, as `get_cells` takes them.
    cells: String,
    dsps: usize,
    rams: usize,
    first: usize,
    rows: usize,
}

impl Block {
    const fn dsp_places(&self) -> usize {
        self.rows * DSP_COLUMNS
    }

    const fn ram_places(&self) -> usize {
        self.rows / 2 * (RAM_COLUMNS - 1)
    }
}

/// The blocks of a design whose calculator is inside of the instance `instance`; none if its multipliers are more than the part's.
fn blocks_of(design: &Design, instance: &str) -> Vec<Block> {
    let mut blocks = vec![];
    for (plan, stage) in design.stages().zip(blocks::stages(design)) {
        // A memory of 64 bits that reads at both ports is two of 36 bits.
        let depth = plan.weight_depth();
        let rams = if plan.reads_both_ports() {
            2 * depth.div_ceil(1024)
        } else {
            plan.row_words() * depth.div_ceil(512)
        };
        for group in (0..plan.groups()).rev() {
            let banks = GROUP_BANKS * group..plan.banks().min(GROUP_BANKS * (group + 1));
            let within = format!("{instance}/{}/multipliers", stage.path);
            let lanes: Vec<String> =
                banks.clone().map(|bank| format!("{within}/banks[{bank}].lanes")).collect();
            let dsps = plan.dsps() / plan.banks() * banks.len();
            let rams = rams * banks.len();
            let rows = (100 * dsps).div_ceil(MAX_FILL * DSP_COLUMNS);
            let of_rams = 2 * (100 * rams).div_ceil(MAX_FILL * (RAM_COLUMNS - 1));
            blocks.push(Block {
                name: format!("stage_{}_group_{group}", plan.index),
                cells: format!("{within}/groups[{group}].* {}", lanes.join(" ")),
                dsps,
                rams,
                first: 0,
                rows: rows.max(of_rams).next_multiple_of(2),
            });
        }
    }
    let all: usize = blocks.iter().map(|block| block.dsps).sum();
    if all > DSP_COLUMNS * DSP_ROWS || blocks.iter().any(|block| block.rows > DSP_ROWS) {
        return vec![];
    }
    // The middle of each block is where its multipliers would be if all stood evenly over the part.
    let mut before = 0;
    for block in &mut blocks {
        let middle = (2 * before + block.dsps) * DSP_ROWS / (2 * all);
        block.first = (middle.saturating_sub(block.rows / 2) & !1).min(DSP_ROWS - block.rows);
        before += block.dsps;
    }
    blocks
}

/// The lines of `floorplan.xdc`, whose calculator is inside of the instance `instance` of the design's top.
#[must_use]
pub fn lines(design: &Design, instance: &str) -> String {
    let mut text = String::from(HEAD);
    let blocks = blocks_of(design, instance);
    if blocks.is_empty() {
        text.push_str("\n# This design has more multipliers than the part.\n");
    }
    for block in blocks {
        let (dsps, rams) = (block.dsp_places(), block.ram_places());
        let (last, column, ram_column) = (block.first + block.rows - 1, DSP_COLUMNS - 1, RAM_COLUMNS - 1);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\n# {0} of {dsps} DSP48E1 ({1} %), {2} of {rams} RAMB36E1 ({3} %).\n\
             create_pblock {name}\nadd_cells_to_pblock {name} [get_cells {{{cells}}}]\n\
             resize_pblock {name} -add {{DSP48_X0Y{4}:DSP48_X{column}Y{last} RAMB36_X0Y{5}:RAMB36_X{ram_column}Y{6}}}",
            block.dsps,
            100 * block.dsps / dsps,
            block.rams,
            100 * block.rams / rams,
            block.first,
            block.first / 2,
            last / 2,
            name = block.name,
            cells = block.cells,
        );
    }
    text
}

const HEAD: &str = "\
# Optional, read by no script: `read_xdc constraints/floorplan.xdc` before place_design where the stages of the calculator miss their clock and their worst paths are\n\
# wires (docs/fabric.md). It keeps the multipliers and memories of eight neighbouring banks together, group by group in the order in which data pass, from the bottom\n\
# up. Blocks of neighbours overlap; slices are left free.\n";

#[cfg(test)]
mod tests {
    use super::*;

    fn committed(name: &str) -> Design {
        let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
        Design::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
    }

    #[test]
    fn no_block_is_fuller_than_its_limit_and_all_multipliers_are_in_one() {
        for name in ["kc705", "kc705-slow"] {
            let design = committed(name);
            let blocks = blocks_of(&design, "core/core");
            for block in &blocks {
                let (dsps, rams) =
                    (100 * block.dsps / block.dsp_places(), 100 * block.rams / block.ram_places());
                assert!(dsps <= MAX_FILL && rams <= MAX_FILL, "{}: {dsps} %, {rams} %", block.name);
                assert!(block.first % 2 == 0 && block.first + block.rows <= DSP_ROWS, "{}", block.name);
            }
            let dsps: usize = blocks.iter().map(|block| block.dsps).sum();
            assert_eq!(dsps, design.stages().map(|plan| plan.dsps()).sum::<usize>());
        }
    }

    /// Hall's condition for intervals: each range of rows has places for all blocks that are inside of it.
    #[test]
    fn blocks_that_share_rows_have_places_together() {
        for name in ["kc705", "kc705-slow"] {
            let blocks = blocks_of(&committed(name), "core/core");
            for first in (0..DSP_ROWS).step_by(2) {
                for end in (first + 2..=DSP_ROWS).step_by(2) {
                    let inside = blocks.iter().filter(|b| b.first >= first && b.first + b.rows <= end);
                    let (dsps, rams) = inside.fold((0, 0), |(d, r), b| (d + b.dsps, r + b.rams));
                    assert!(dsps <= (end - first) * DSP_COLUMNS, "{name} {first}..{end}: {dsps}");
                    assert!(rams <= (end - first) / 2 * (RAM_COLUMNS - 1), "{name} {first}..{end}: {rams}");
                }
            }
        }
    }
}
