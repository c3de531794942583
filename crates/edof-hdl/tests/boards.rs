//! What a design takes of its board's part, and where it is there.

use edof_device::Design;
use edof_device::board::ULX3S;
use edof_hdl::{floorplan, resources};

/// A block of the floorplan: multipliers and block memories, first row and the row after the last.
type Block = [usize; 4];

/// The blocks of a design of the program, as the lines state them; columns of multipliers and of full block memories, and rows.
fn floorplan_of(name: &str) -> (Design, Vec<Block>, [usize; 3]) {
    let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let design = Design::load(std::path::Path::new(&path)).unwrap();
    let columns = design.board.part.columns.unwrap();
    let text = floorplan::lines(&design, columns, "core/core");
    let number =
        |text: &str| text.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse::<usize>().unwrap();
    let after = |text: &str, word: &str| number(text.split_once(word).unwrap().1);
    let blocks = text.split("\n\n# ").skip(1).map(|block| {
        let first = after(block, "DSP48_X0Y");
        [number(block), after(block, "%), "), first, after(block, ":DSP48_X5Y") + 1]
    });
    let (dsp_columns, rows) = columns.multipliers;
    let blocks = blocks.collect();
    (design, blocks, [dsp_columns, columns.full_memories(), rows])
}

#[test]
fn no_block_of_a_floorplan_is_fuller_than_its_limit_and_all_multipliers_are_in_one() {
    for name in ["kc705", "kc705-slow"] {
        let (design, blocks, [dsp_columns, ram_columns, all_rows]) = floorplan_of(name);
        for block @ [dsps, rams, first, end] in &blocks {
            let rows = end - first;
            assert!(100 * dsps <= 80 * rows * dsp_columns, "{block:?}");
            assert!(100 * rams <= 80 * (rows / 2) * ram_columns, "{block:?}");
            assert!(first % 2 == 0 && *end <= all_rows, "{block:?}");
        }
        // The figures of `edof timing` are those of the text.
        let fills = floorplan::fills(&design);
        let told: Vec<[usize; 2]> = fills.iter().map(|fill| [fill.multipliers.0, fill.memories.0]).collect();
        assert_eq!(told, blocks.iter().map(|block| [block[0], block[1]]).collect::<Vec<_>>());
        for (fill, [dsps, rams, first, end]) in fills.iter().zip(&blocks) {
            let places = [(end - first) * dsp_columns, (end - first) / 2 * ram_columns];
            assert_eq!(fill.percent(), [100 * dsps / places[0], 100 * rams / places[1]], "{fill:?}");
            assert!(fill.percent().iter().all(|percent| *percent <= floorplan::MAX_FILL), "{fill:?}");
        }
        let dsps: usize = blocks.iter().map(|block| block[0]).sum();
        assert_eq!(dsps, design.stages().map(|plan| plan.dsps()).sum::<usize>());
    }
}

/// Hall's condition for intervals: each range of rows has places for all blocks that are inside of it.
#[test]
fn blocks_that_share_rows_have_places_together() {
    for name in ["kc705", "kc705-slow"] {
        let (_, blocks, [dsp_columns, ram_columns, rows]) = floorplan_of(name);
        for first in (0..rows).step_by(2) {
            for end in (first + 2..=rows).step_by(2) {
                let inside = blocks.iter().filter(|block| block[2] >= first && block[3] <= end);
                let (dsps, rams) = inside.fold((0, 0), |(d, r), block| (d + block[0], r + block[1]));
                assert!(dsps <= (end - first) * dsp_columns, "{name} {first}..{end}: {dsps}");
                assert!(rams <= (end - first) / 2 * ram_columns, "{name} {first}..{end}: {rams}");
            }
        }
    }
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
