//! What a design takes of its board's part, and where it is there.

use edof_device::Design;
use edof_device::board::ULX3S;
use edof_hdl::{floorplan, resources};

#[test]
fn every_stage_of_the_board_has_a_band_with_all_its_multipliers() {
    let design = Design::from_json(include_str!("../../../designs/kc705.json")).unwrap();
    let columns = design.board.part.columns.unwrap();
    let (dsp_columns, dsp_rows) = columns.multipliers;
    let text = floorplan::lines(&design, columns, "core/core");
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
        assert!((last - first + 1) * dsp_columns >= plan.dsps(), "{text}");
    }
    let is_after = |pair: &[(usize, usize)]| pair[0].1 < pair[1].0;
    assert!(bands.windows(2).all(is_after) && bands[bands.len() - 1].1 < dsp_rows, "{text}");
}

/// Yosys 0.70 mapped the whole chain of `tiny` to 112 MULT18X18D, 102 DP16KD, 29,668 slots of LUT4 and 32,912 flip-flops.
#[test]
fn tiny_takes_of_an_ecp5_what_yosys_makes_of_it() {
    let tiny = Design::from_json(include_str!("../../../designs/tiny.json")).unwrap();
    let used = resources::whole(&Design { board: &ULX3S, ..tiny });
    assert_eq!((used.multipliers, used.memories, used.half_memories), (112, 102, 0));
    for (estimated, measured) in [(used.luts, 29_668_usize), (used.registers, 32_912)] {
        assert!(estimated.abs_diff(measured) * 100 <= 5 * measured, "{estimated}, measured {measured}");
    }
}
