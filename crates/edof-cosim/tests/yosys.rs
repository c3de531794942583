//! Small designs mapped to a 7-series FPGA.

use crate::support::{images, macc, machine, ticks};
use edof_cosim::yosys::{Options, synthesize};

#[test]
fn a_multiply_accumulate_is_one_dsp_with_its_accumulator_inside() {
    let report = synthesize(&macc(), &Options::default()).unwrap();
    assert_eq!((report.cells.count("DSP48E1"), report.accumulators_inside()), (1, 1), "{report:?}");
    let dsp = &report.dsps[0];
    assert!(dsp.registers_product && !dsp.feeds_carry, "{dsp:?}");
    assert_eq!(report.cells.count("CARRY4"), 0);
}

#[test]
fn an_accumulator_outside_is_seen() {
    let mut source = macc();
    let outside = "sum_q <= (first_qq ? sum_q : 48'd1) + (product_q[0] ? sum_q : 48'd3) - product_q;";
    let start = source.files[0].1.find("        sum_q <=").unwrap();
    let end = start + source.files[0].1[start..].find(';').unwrap() + 1;
    source.files[0].1.replace_range(start..end, outside);
    let report = synthesize(&source, &Options::default()).unwrap();
    assert_eq!((report.cells.count("DSP48E1"), report.accumulators_inside()), (1, 0), "{:?}", report.dsps);
    assert!(report.cells.count("CARRY4") > 0);
}

#[test]
fn parameters_of_the_top_can_be_set() {
    let parameters = vec![("WIDTH".into(), "24".into())];
    let report = synthesize(&macc(), &Options { parameters, ..Options::default() }).unwrap();
    assert!(report.cells.count("DSP48E1") > 1, "{report:?}");
}

#[test]
fn flip_flops_and_luts_are_counted() {
    let report = synthesize(&ticks(), &Options::default()).unwrap();
    assert_eq!(report.cells.flip_flops(), 40);
    assert!((1..20).contains(&report.cells.luts()), "{report:?}");
    assert_eq!(
        (report.cells.count("DSP48E1"), report.cells.count("RAMB36E1"), report.cells.count("RAMB18E1")),
        (0, 0, 0)
    );
}

#[test]
fn a_small_memory_becomes_distributed() {
    let (_guard, dir) = images(1);
    let report = synthesize(&machine(), &Options { memory_dir: Some(dir), ..Options::default() }).unwrap();
    assert!(report.cells.0.keys().any(|cell| cell.starts_with("RAM")), "{report:?}");
}

#[test]
fn a_missing_memory_image_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let memory_dir = Some(dir.path().into());
    let error =
        synthesize(&machine(), &Options { memory_dir, ..Options::default() }).unwrap_err().to_string();
    assert!(error.starts_with("yosys failed: ") && error.contains("images/machine.hex"), "{error}");
}
