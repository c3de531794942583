//! What a design takes of its board's part, and where it is there.

use edof_device::Design;
use edof_device::board::ULX3S;
use edof_hdl::resources;

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
