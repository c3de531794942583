//! A floorplan of the calculator on a Xilinx part, for users who need one; no step of the build reads the file.
//!
//! Each group of eight banks has a block of rows, in the order in which data pass: stage by stage, the highest banks first. Blocks of
//! neighbours overlap, so that none is full although the part nearly is.

use crate::board::blocks;
use crate::resources::bank_memories;
use edof_device::Design;
use edof_device::board::part::Columns;
use edof_device::design::stage::GROUP_BANKS;
use std::fmt::Write;

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
    const fn dsp_places(&self, columns: Columns) -> usize {
        self.rows * columns.multipliers.0
    }

    const fn ram_places(&self, columns: Columns) -> usize {
        self.rows / 2 * whole_columns(columns)
    }
}

/// Columns of block memories without gaps: the last one has some and is not counted on.
const fn whole_columns(columns: Columns) -> usize {
    columns.memories - 1
}

/// The blocks of a design whose calculator is inside of the instance `instance`; none if its multipliers are more than the part's.
fn blocks_of(design: &Design, columns: Columns, instance: &str) -> Vec<Block> {
    let (dsp_columns, dsp_rows) = columns.multipliers;
    let mut blocks = vec![];
    for (plan, stage) in design.stages().zip(blocks::stages(design)) {
        let rams = bank_memories(&design.board.part, &plan).memories;
        for group in (0..plan.groups()).rev() {
            let banks = GROUP_BANKS * group..plan.banks().min(GROUP_BANKS * (group + 1));
            let within = format!("{instance}/{}/multipliers", stage.path);
            let lanes: Vec<String> =
                banks.clone().map(|bank| format!("{within}/banks[{bank}].lanes")).collect();
            let dsps = plan.dsps() / plan.banks() * banks.len();
            let rams = rams * banks.len();
            let rows = (100 * dsps).div_ceil(MAX_FILL * dsp_columns);
            let of_rams = 2 * (100 * rams).div_ceil(MAX_FILL * whole_columns(columns));
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
    if all > dsp_columns * dsp_rows || blocks.iter().any(|block| block.rows > dsp_rows) {
        return vec![];
    }
    // The middle of each block is where its multipliers would be if all stood evenly over the part.
    let mut before = 0;
    for block in &mut blocks {
        let middle = (2 * before + block.dsps) * dsp_rows / (2 * all);
        block.first = (middle.saturating_sub(block.rows / 2) & !1).min(dsp_rows - block.rows);
        before += block.dsps;
    }
    blocks
}

/// Returns the lines of `floorplan.xdc` for a part with these columns, whose calculator is inside of the instance `instance` of the design's
/// top. Two rows of multipliers, and one of block memories, are five rows of slices.
#[must_use]
pub fn lines(design: &Design, columns: Columns, instance: &str) -> String {
    let mut text = String::from(HEAD);
    let blocks = blocks_of(design, columns, instance);
    if blocks.is_empty() {
        text.push_str("\n# This design has more multipliers than the part.\n");
    }
    for block in blocks {
        let (dsps, rams) = (block.dsp_places(columns), block.ram_places(columns));
        let (last, column, ram_column) =
            (block.first + block.rows - 1, columns.multipliers.0 - 1, columns.memories - 1);
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

    /// The blocks of a design on the KC705, and that part's columns.
    fn committed(name: &str) -> (Design, Columns, Vec<Block>) {
        let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let design = Design::from_json(&std::fs::read_to_string(path).unwrap()).unwrap();
        let columns = design.board.part.columns.unwrap();
        let blocks = blocks_of(&design, columns, "core/core");
        (design, columns, blocks)
    }

    #[test]
    fn no_block_is_fuller_than_its_limit_and_all_multipliers_are_in_one() {
        for name in ["kc705", "kc705-slow"] {
            let (design, columns, blocks) = committed(name);
            for block in &blocks {
                let dsps = 100 * block.dsps / block.dsp_places(columns);
                let rams = 100 * block.rams / block.ram_places(columns);
                assert!(dsps <= MAX_FILL && rams <= MAX_FILL, "{}: {dsps} %, {rams} %", block.name);
                let is_inside = block.first + block.rows <= columns.multipliers.1;
                assert!(block.first % 2 == 0 && is_inside, "{}", block.name);
            }
            let dsps: usize = blocks.iter().map(|block| block.dsps).sum();
            assert_eq!(dsps, design.stages().map(|plan| plan.dsps()).sum::<usize>());
        }
    }

    /// Hall's condition for intervals: each range of rows has places for all blocks that are inside of it.
    #[test]
    fn blocks_that_share_rows_have_places_together() {
        for name in ["kc705", "kc705-slow"] {
            let (_, columns, blocks) = committed(name);
            let (dsp_columns, dsp_rows) = columns.multipliers;
            for first in (0..dsp_rows).step_by(2) {
                for end in (first + 2..=dsp_rows).step_by(2) {
                    let inside = blocks.iter().filter(|b| b.first >= first && b.first + b.rows <= end);
                    let (dsps, rams) = inside.fold((0, 0), |(d, r), b| (d + b.dsps, r + b.rams));
                    assert!(dsps <= (end - first) * dsp_columns, "{name} {first}..{end}: {dsps}");
                    assert!(
                        rams <= (end - first) / 2 * whole_columns(columns),
                        "{name} {first}..{end}: {rams}"
                    );
                }
            }
        }
    }
}
