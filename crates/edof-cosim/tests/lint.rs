//! Verilator's warnings.

use crate::support::{machine, ticks, wide};
use edof_cosim::{Error, lint};

/// `ticks` with an eight-bit sum put into seven bits.
fn planted() -> edof_cosim::Source {
    let mut source = ticks();
    source.files[0].1 =
        source.files[0].1.replace("count_q <= count_q + 8'd1", "count_q[6:0] <= count_q + 8'd1");
    source
}

#[test]
fn clean_designs_are_clean() {
    for source in [ticks(), machine(), wide()] {
        lint::clean(&source, None).unwrap();
    }
}

#[test]
fn a_wrong_width_is_found_at_its_line() {
    let Err(Error::Lint(errors)) = lint::clean(&planted(), None) else { panic!("it was not found") };
    assert_eq!(errors.0.len(), 1, "{errors}");
    assert_eq!(errors.0[0].rule, "WIDTH");
    assert!(errors.to_string().starts_with("WIDTH ticks.v:15:"), "{errors}");
}

#[test]
fn a_waiver_silences_it() {
    let dir = tempfile::tempdir().unwrap();
    let waivers = dir.path().join("waivers.vlt");
    std::fs::write(&waivers, "`verilator_config\nlint_off -rule WIDTH -file \"*ticks.v\"\n").unwrap();
    lint::clean(&planted(), Some(&waivers)).unwrap();
}

#[test]
fn a_syntax_error_is_a_finding() {
    let mut source = ticks();
    source.files[0].1 = "module ticks (input wire a);\n  assign b = ;\nendmodule\n".into();
    let error = lint::clean(&source, None).unwrap_err().to_string();
    assert!(error.starts_with("error ticks.v:2:14: syntax error"), "{error}");
}
