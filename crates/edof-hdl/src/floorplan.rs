//! A floorplan of the calculator's stages on a Xilinx part, for users who need one; no step of the build reads the file.

use crate::board::blocks;
use crate::resources::bank_memories;
use edof_device::Design;
use edof_device::board::part::Columns;
use std::fmt::Write;

/// Returns the lines of `floorplan.xdc` for a part with these columns, whose calculator is inside of the instance `instance` of the design's
/// top: a band of rows for each stage, in the order in which data pass. Two rows of multipliers, and one of block memories, are five rows of
/// slices.
#[must_use]
pub fn lines(design: &Design, columns: Columns, instance: &str) -> String {
    let Columns { multipliers: (dsp_columns, dsp_rows), memories: ram_columns } = columns;
    let mut text = String::from(HEAD);
    let mut row = 0;
    for (plan, block) in design.stages().zip(blocks::stages(design)) {
        // Whole rows of block memories.
        let rams = bank_memories(&design.board.part, &plan).memories;
        let of_dsps = plan.dsps().div_ceil(dsp_columns).next_multiple_of(2);
        let of_rams = 2 * (plan.banks() * rams).div_ceil(ram_columns - 1);
        let rows = of_dsps.max(of_rams);
        let (last, dsp, ram) = (row + rows - 1, dsp_columns - 1, ram_columns - 1);
        // Writing to a String cannot fail.
        if last >= dsp_rows {
            let _ = writeln!(
                text,
                "\n# Stage {} has no room in a band of its own, nor have those after it.",
                plan.index
            );
            break;
        }
        let _ = writeln!(
            text,
            "\ncreate_pblock stage_{0}\nadd_cells_to_pblock stage_{0} [get_cells {{{instance}/{1}}}]\n\
             resize_pblock stage_{0} -add {{DSP48_X0Y{row}:DSP48_X{dsp}Y{last} RAMB36_X0Y{2}:RAMB36_X{ram}Y{3}}}",
            plan.index,
            block.path,
            row / 2,
            last / 2
        );
        row += rows;
    }
    text
}

const HEAD: &str = "\
# Optional, read by no script: `read_xdc constraints/floorplan.xdc` before place_design where the stages of the calculator miss their clock and their worst paths are\n\
# wires (docs/fabric.md). It keeps the multipliers and memories of a stage together, in bands of rows from the bottom up in the order in which data pass;\n\
# slices are left free. Within a stage the banks are `multipliers/banks[N].lanes`, eight neighbours share their registers of control.\n";
