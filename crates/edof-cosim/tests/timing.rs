//! The longest path of logic of every stage of the committed designs, flat, as Yosys times it. `tiny` here; the others take half an
//! hour, and are for `scripts/test-timing.sh`.

mod common;
mod support;

use common::committed;
use edof_cosim::yosys::timing::{self, StageTiming};
use edof_hdl::project;
use std::path::Path;

/// What no stage of a design may exceed.
struct Limits {
    /// Worst path of logic.
    delay_ps: u64,
    /// Loads of a net of control.
    control_loads: usize,
}

fn stages(name: &str) -> Vec<StageTiming> {
    let design = committed(name);
    let network = edof_random::for_design(&design, 1);
    let project = project::calculator(&design, [&network, &network]).unwrap();
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("timing");
    timing::stages(&project, design.stages.len(), Some(&cache), &|_, _| ()).unwrap()
}

fn keeps(name: &str, limits: &Limits) {
    let design = committed(name);
    for (plan, stage) in design.stages().zip(stages(name)) {
        let told = format!("{name} stage {}: {stage:#?}", plan.index);
        assert!(stage.delay_ps <= limits.delay_ps, "{told}");
        assert!(stage.control_loads <= limits.control_loads, "{told}");
        assert_eq!((stage.dsps, stage.registered_dsps), (plan.dsps(), plan.dsps()), "{told}");
        assert!(stage.path.len() > stage.levels, "{told}");
        // The path is the source's own, and no clock is taken for a net of control.
        assert!(stage.path.iter().any(|step| !step.net.is_empty()), "{told}");
        assert!(stage.nets.iter().all(|net| !net.net.contains("clock")), "{told}");
    }
}

#[test]
fn tiny_keeps_its_limits() {
    keeps("tiny", &Limits { delay_ps: 2800, control_loads: 96 });
}

#[test]
#[ignore = "minutes: scripts/test-timing.sh"]
fn paper_keeps_its_limits() {
    keeps("paper", &Limits { delay_ps: 5300, control_loads: 20000 });
}

#[test]
#[ignore = "minutes: scripts/test-timing.sh"]
fn kc705_keeps_its_limits() {
    keeps("kc705", &Limits { delay_ps: 5300, control_loads: 20000 });
}
