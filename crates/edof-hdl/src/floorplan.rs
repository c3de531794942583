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
pub const MAX_FILL: usize = 80;

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

/// The blocks of a design whose calculator is inside of the instance `instance`; none if its multipliers are more than the part's.
fn blocks_of(design: &Design, columns: Columns, instance: &str) -> Vec<Block> {
    let (dsp_columns, dsp_rows) = columns.multipliers;
    let mut blocks = vec![];
    for (plan, stage) in design.stages().zip(blocks::stages(design)) {
        let rams = bank_memories(&design.board.part, &plan).memories;
        for group in (0..plan.groups()).rev() {
            let banks = GROUP_BANKS * group..plan.banks().min(GROUP_BANKS * (group + 1));
            let within = format!("{instance}/{}/macc", stage.path);
            let lanes: Vec<String> =
                banks.clone().map(|bank| format!("{within}/banks[{bank}].lanes")).collect();
            let dsps = plan.dsps() / plan.banks() * banks.len();
            let rams = rams * banks.len();
            let rows = (100 * dsps).div_ceil(MAX_FILL * dsp_columns);
            let of_rams = 2 * (100 * rams).div_ceil(MAX_FILL * columns.full_memories());
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

/// What a block of the floorplan takes of its places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fill {
    /// Name of the block.
    pub block: String,
    /// DSP48E1 that are used, and places for them.
    pub multipliers: (usize, usize),
    /// RAMB36E1 that are used, and places for them.
    pub memories: (usize, usize),
}

impl Fill {
    /// Returns the shares of multipliers and of memories that are used, in percent.
    #[must_use]
    pub const fn percent(&self) -> [usize; 2] {
        [100 * self.multipliers.0 / self.multipliers.1, 100 * self.memories.0 / self.memories.1]
    }
}

impl Block {
    fn fill(&self, columns: Columns) -> Fill {
        let (dsp_columns, _) = columns.multipliers;
        Fill {
            block: self.name.clone(),
            multipliers: (self.dsps, self.rows * dsp_columns),
            memories: (self.rams, self.rows / 2 * columns.full_memories()),
        }
    }
}

/// Returns how full each block of a design's floorplan is; none where its board's part has no floorplan, or too few multipliers.
#[must_use]
pub fn fills(design: &Design) -> Vec<Fill> {
    let of = |columns| blocks_of(design, columns, "").iter().map(|block| block.fill(columns)).collect();
    design.board.part.columns.map_or(vec![], of)
}

/// Returns the lines of `floorplan.xdc` for a part with these columns, whose calculator is inside of the instance `instance` of the design's
/// top.
#[must_use]
pub fn lines(design: &Design, columns: Columns, instance: &str) -> String {
    let mut text = String::from(HEAD);
    let blocks = blocks_of(design, columns, instance);
    if blocks.is_empty() {
        text.push_str("\n# This design has more multipliers than the part.\n");
    }
    for block in blocks {
        let fill = block.fill(columns);
        let ((dsps, dsp_places), (rams, ram_places)) = (fill.multipliers, fill.memories);
        let [of_dsps, of_rams] = fill.percent();
        let (last, column, ram_column) =
            (block.first + block.rows - 1, columns.multipliers.0 - 1, columns.memories - 1);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\n# {dsps} of {dsp_places} DSP48E1 ({of_dsps} %), {rams} of {ram_places} RAMB36E1 ({of_rams} %).\n\
             create_pblock {name}\nadd_cells_to_pblock {name} [get_cells {{{cells}}}]\n\
             resize_pblock {name} -add {{DSP48_X0Y{first}:DSP48_X{column}Y{last} RAMB36_X0Y{ram_first}:RAMB36_X{ram_column}Y{ram_last}}}",
            first = block.first,
            ram_first = block.first / 2,
            ram_last = last / 2,
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
