//! A floorplan of the calculator's stages on the KC705's part, for users who need one; no step of the build reads the file.

use crate::board::blocks;
use edof_device::Design;
use std::fmt::Write;

/// Columns of DSP48E1 in the XC7K325T, each of [`DSP_ROWS`].
const DSP_COLUMNS: usize = 6;
/// Rows of DSP48E1; two of them, and one of RAMB36E1, are five rows of slices.
const DSP_ROWS: usize = 140;
/// Columns of RAMB36E1, the last of which has gaps.
const RAM_COLUMNS: usize = 7;

/// The lines of `floorplan.xdc`, whose calculator is inside of the instance `instance` of the design's top: a band of rows for each stage, in
/// the order in which data pass.
#[must_use]
pub fn lines(design: &Design, instance: &str) -> String {
    let mut text = String::from(HEAD);
    let mut row = 0;
    for (plan, block) in design.stages().zip(blocks::stages(design)) {
        // Whole rows of RAMB36E1. A memory of 64 bits that reads at both ports is two of 36 bits.
        let depth = plan.weight_depth();
        let rams = if plan.reads_both_ports() {
            2 * depth.div_ceil(1024)
        } else {
            plan.row_words() * depth.div_ceil(512)
        };
        let of_dsps = plan.dsps().div_ceil(DSP_COLUMNS).next_multiple_of(2);
        let of_rams = 2 * (plan.banks() * rams).div_ceil(RAM_COLUMNS - 1);
        let rows = of_dsps.max(of_rams);
        let (last, dsp, ram) = (row + rows - 1, DSP_COLUMNS - 1, RAM_COLUMNS - 1);
        // Writing to a String cannot fail.
        if last >= DSP_ROWS {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_of_the_board_has_a_band_with_all_its_multipliers() {
        let design = Design::from_json(include_str!("../../../designs/kc705.json")).unwrap();
        let text = lines(&design, "core/core");
        let bands: Vec<(usize, usize)> = text
            .lines()
            .filter_map(|line| line.split_once("DSP48_X0Y")?.1.split_once(" RAMB"))
            .map(|(range, _)| {
                let (first, last) = range.split_once(":DSP48_X5Y").unwrap();
                (first.parse().unwrap(), last.parse().unwrap())
            })
            .collect();
        assert_eq!(bands.len(), design.stages.len());
        for ((first, last), plan) in bands.iter().zip(design.stages()) {
            assert!((last - first + 1) * DSP_COLUMNS >= plan.dsps(), "{text}");
        }
        assert!(
            bands.windows(2).all(|pair| pair[0].1 < pair[1].0) && bands[bands.len() - 1].1 < DSP_ROWS,
            "{text}"
        );
    }
}
