//! Icarus and Verilator give the same outputs.

use crate::support::{build, images, machine, ticks, wide};
use edof_cosim::verilator::Start;
use edof_cosim::{Layout, Rows, Source, icarus};
use std::path::Path;
use std::process::Command;

/// Random rows, after two cycles of reset, which is the first input.
fn stimulus(source: &Source, cycles: usize, seed: u64) -> Rows {
    let mut rows = Layout::inputs(source).random(cycles, seed);
    for cycle in 0..cycles {
        rows.row_mut(cycle)[0] = u32::from(cycle < 2);
    }
    rows
}

fn both(source: &Source, rows: &Rows, memory_dir: &Path) -> (Rows, icarus::Observed) {
    let start = Start { seed: 11, memory_dir: Some(memory_dir.into()) };
    let verilator = build(source).start(&start).unwrap().run(rows).unwrap();
    (verilator, icarus::run(source, rows, Some(memory_dir)).unwrap())
}

#[test]
fn a_state_machine_with_a_memory_is_the_same_in_both() {
    let (_guard, dir) = images(0x4000);
    let source = machine();
    for seed in 0..3 {
        let mut rows = stimulus(&source, 2000, seed);
        (0..rows.len()).step_by(9).for_each(|cycle| rows.row_mut(cycle)[2] = 0);
        let (verilator, icarus) = both(&source, &rows, &dir);
        assert_eq!(icarus.first_difference(&source, &verilator), None);
        assert!(icarus.known_from() <= 2, "{}", icarus.known_from());
    }
}

#[test]
fn every_width_is_the_same_in_both() {
    let source = wide();
    let rows = Layout::inputs(&source).random(100, 1);
    let (verilator, icarus) = both(&source, &rows, Path::new("."));
    assert_eq!(icarus.first_difference(&source, &verilator), None);
    assert_eq!(icarus.known_from(), 1);
}

#[test]
fn what_reset_forgot_stays_unknown() {
    let source = ticks();
    let rows = stimulus(&source, 50, 1);
    let (verilator, icarus) = both(&source, &rows, Path::new("."));
    assert_eq!(icarus.first_difference(&source, &verilator), None);
    assert_eq!(icarus.known_from(), 50);
    assert!(icarus.unknown.iter().all(|row| row[2] == u32::MAX));
}

#[test]
fn the_first_difference_is_named() {
    let source = ticks();
    let rows = stimulus(&source, 50, 1);
    let (mut verilator, icarus) = both(&source, &rows, Path::new("."));
    verilator.row_mut(30)[1] ^= 1;
    verilator.row_mut(31)[0] ^= 1;
    let text = icarus.first_difference(&source, &verilator).unwrap().to_string();
    assert_eq!(text, "cycle 30, last_o: expected 00000001, got 00000000");
}

#[test]
fn a_missing_memory_image_stops_it() {
    let (source, dir) = (machine(), tempfile::tempdir().unwrap());
    let error = icarus::run(&source, &stimulus(&source, 5, 1), Some(dir.path())).unwrap_err().to_string();
    assert!(error.starts_with("simulation stopped: ") && error.contains("images/machine.hex"), "{error}");
}

/// As somebody's own bench has it, in which nobody of ours looks for images.
#[test]
fn each_memory_itself_says_that_its_image_is_missing() {
    let place = tempfile::tempdir().unwrap();
    let rtl = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rtl");
    for memory in ["edof_ram", "edof_table", "edof_start"] {
        let bench =
            format!("module bench;\n{memory} #(.INIT(\"no.mem\")) dut (.clock_i(1'b0));\nendmodule\n");
        std::fs::write(place.path().join("bench.v"), bench).unwrap();
        let file = rtl.join(format!("{memory}.v"));
        let mut compile = Command::new("iverilog");
        compile.current_dir(place.path()).args(["-g2005", "-o", "bench.vvp", "bench.v"]).arg(file);
        assert!(compile.status().unwrap().success());
        let run = Command::new("vvp").current_dir(place.path()).args(["-n", "bench.vvp"]).output().unwrap();
        let said = String::from_utf8(run.stdout).unwrap();
        assert!(
            !run.status.success() && said.contains("bench.dut: memory image ./mem/no.mem cannot be read"),
            "{said}"
        );
    }
}

#[test]
fn broken_verilog_is_reported_with_file_and_line() {
    let mut source = ticks();
    source.files[0].1 = "module ticks (input wire a);\n  assign b = ;\nendmodule\n".into();
    let error = icarus::run(&source, &Rows::zeros(2, 1), None).unwrap_err().to_string();
    assert!(error.starts_with("iverilog failed: ticks.v:2: "), "{error}");
}
