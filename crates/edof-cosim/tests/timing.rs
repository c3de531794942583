//! The longest path of logic and the most loads of every stage of the committed designs, flat, as Yosys maps and times it. `tiny`
//! here; the others take half an hour, and are for `scripts/soak.sh`.

mod common;
mod support;

use common::committed;
use edof_cosim::yosys::timing::{self, StageTiming};
use edof_hdl::blocks::window_guard::WindowGuard;
use edof_hdl::project;
use std::path::Path;

/// Worst path of logic that a stage may have: half of the period at 200 MHz, the other half is for wires.
const DELAY_PS: u64 = 2500;
/// Loads that a net of control may lead to.
const CONTROL_LOADS: usize = 64;

fn stages(name: &str) -> Vec<StageTiming> {
    let design = committed(name);
    let network = edof_random::for_design(&design, 1);
    let project = project::calculator(&design, [&network, &network]).unwrap();
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("timing");
    timing::stages(&project, design.stages.len(), Some(&cache), &|_, _| ()).unwrap()
}

fn keeps_its_limits(name: &str) {
    let design = committed(name);
    for (plan, stage) in design.stages().zip(stages(name)) {
        let told = format!("{name} stage {}: {stage:#?}", plan.index);
        assert!(stage.delay_ps <= DELAY_PS, "{told}");
        assert!(stage.control_loads <= CONTROL_LOADS, "{told}");
        assert_eq!((stage.dsps, stage.registered_dsps), (plan.dsps(), plan.dsps()), "{told}");
        assert!(stage.path.len() > stage.levels, "{told}");
        // The path is the source's own, and no clock is taken for a net of control.
        assert!(stage.path.iter().any(|step| !step.net.is_empty()), "{told}");
        assert!(stage.nets.iter().all(|net| !net.net.contains("clock")), "{told}");
    }
}

#[test]
fn tiny_is_short_of_path_and_load() {
    keeps_its_limits("tiny");
}

/// The only logic between two boundaries' registers.
#[test]
fn what_makes_windows_whole_is_short_of_path_and_load() {
    let design = committed("kc705");
    let project = project::of_circuit(&mut WindowGuard::new(&design.stage(0)), vec![]).unwrap();
    let found = timing::whole(&project, None).unwrap();
    assert!(found.delay_ps <= DELAY_PS && found.control_loads <= CONTROL_LOADS, "{found:#?}");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn paper_is_short_of_path_and_load() {
    keeps_its_limits("paper");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn kc705_is_short_of_path_and_load() {
    keeps_its_limits("kc705");
}
