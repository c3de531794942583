//! The KC705's top between models of its primitives (sim/board): its clocks, the order of its resets, pixels in the middle of the transmitter's
//! clock, and `id` over the pins of its UART.

use crate::board::{Place, generated, run, said};
use crate::common::{committed, root};
use edof_device::board::KC705;
use std::path::Path;

/// The top of a generated directory in Icarus, which the bench is for; what it says.
fn tried(folder: &Path) -> String {
    let clocks = committed("tiny").clocks().unwrap();
    let picoseconds = |khz: u64| format!("{:.3}", 1e9 / khz as f64);
    let bench = include_str!("../../../sim/board/kc705_top_bench.sv")
        .replace("@core_ps@", &picoseconds(KC705.core_khz.into()))
        .replace("@calculator_ps@", &picoseconds(clocks.calculator.khz))
        .replace("@screen_ps@", &picoseconds(clocks.screen.unwrap().khz))
        .replace("@baud@", &KC705.baud.to_string());
    std::fs::write(folder.join("top_bench.sv"), bench).unwrap();
    let primitives = root().join("sim/board/primitives.v").canonicalize().unwrap();
    let rtl = std::fs::read_dir(folder.join("rtl")).unwrap().map(|file| file.unwrap().path());
    let files = [folder.join("top_bench.sv"), primitives].into_iter().chain(rtl);
    let files: Vec<String> = files.map(|path| path.to_str().unwrap().to_owned()).collect();
    let arguments = ["-g2012", "-s", "kc705_top_bench", "-o", "top.vvp"].into_iter();
    let arguments: Vec<&str> = arguments.chain(files.iter().map(String::as_str)).collect();
    let compiled = run("iverilog", &arguments, folder);
    assert!(compiled.status.success(), "{}", said(&compiled));
    said(&run("vvp", &["-n", "top.vvp"], folder))
}

/// The same after an edit of the top.
fn tried_with(from: &str, to: &str) -> String {
    let place = Place::new();
    let folder = generated(&place);
    let file = folder.join("rtl/kc705_top.v");
    let text = std::fs::read_to_string(&file).unwrap();
    assert_eq!(text.matches(from).count(), 1, "{from}");
    std::fs::write(file, text.replace(from, to)).unwrap();
    tried(&folder)
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_top_has_its_clocks_ends_its_resets_in_order_and_answers_at_its_pins() {
    let place = Place::new();
    let told = tried(&generated(&place));
    assert!(told.contains("PASS: clocks, resets, pixels and id, twice"), "{told}");
}

#[test]
fn a_top_with_a_wrong_reset_clock_or_pad_is_found() {
    let early = tried_with("calculator_reset_q <= !calculator_locked_seen;", "calculator_reset_q <= 1'b0;");
    assert!(early.contains("FAIL: the calculator's reset is over before its clock is locked"), "{early}");
    let pads = tried_with(".D1(1'b0), .D2(1'b1)", ".D1(1'b1), .D2(1'b0)");
    assert!(pads.contains("periods"), "{pads}");
    let clock = tried_with(".CLKOUT0_DIVIDE_F(56.000)", ".CLKOUT0_DIVIDE_F(55.000)");
    assert!(clock.contains("FAIL: the screen's clock has a period"), "{clock}");
}
