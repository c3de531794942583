//! The longest path of logic and the most loads of every stage of the committed designs, and the longest path of every block of the core
//! around them, flat, as Yosys maps and times it. Two of `tiny`'s stages here; all else takes half an hour, and is for `scripts/soak.sh`.

use crate::common::committed;
use edof_cosim::system;
use edof_cosim::yosys::timing::{self, Kind, PartTiming};
use edof_device::Design;
use edof_device::board::{KC705, Resources};
use edof_device::design::StagePlan;
use edof_device::video::VideoTiming;
use edof_golden::Display;
use edof_hdl::blocks::window_guard::WindowGuard;
use edof_hdl::board::blocks::{self, Domain};
use edof_hdl::board::{BoardRegisters, CalculatorPort, ChipSetup, EmbeddedSyncs, Identity, Pace};
use edof_hdl::project;
use edof_hdl::resources;
use edof_hdl::video::camera_in::CameraIn;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Registers whose paths are not among the longest: the start of a sum on its way to the DSPs, and weights on their way to the host.
const SHORT: [&str; 5] = ["lanes.first_q", "starts_q", "multiplier.first_q", "lanes.back_", "back_q"];
/// Loads that a net of control may lead to.
const CONTROL_LOADS: usize = 64;

fn cache() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("timing")
}

/// Stages of a design's calculator, each by itself: all, but of `tiny` the first M and F, as I is dense as F is and the second M much like the first.
pub fn of_stages(design: &Design) -> Vec<(StagePlan, PartTiming)> {
    let network = edof_device::random::for_design(design, 1);
    let project = project::calculator(design, [&network, &network]).unwrap();
    let plans: Vec<StagePlan> =
        design.stages().filter(|plan| design.name != "tiny" || plan.index % 2 == 1).collect();
    let all = timing::stages(design.stages.len());
    let paths: Vec<String> = plans.iter().map(|plan| all[plan.index].clone()).collect();
    let found = timing::parts(&project, &paths, Some(&cache()), &|_, _| ()).unwrap();
    plans.into_iter().zip(found).collect()
}

fn keeps_its_limits(name: &str) {
    let design = committed(name);
    let limit = blocks::calculator(&design).limit_ps();
    for (plan, stage) in of_stages(&design) {
        let told = format!("{name} stage {}: {stage:#?}", plan.index);
        assert!(stage.delay_ps <= limit, "{limit} ps: {told}");
        assert!(stage.control_loads <= CONTROL_LOADS, "{told}");
        let dsps = [stage.dsps, stage.registered_dsps, stage.free_operations];
        assert_eq!(dsps, [plan.dsps(); 3], "{told}");
        // `sta` and the search agree, except for memories whose output register `sta` has taken in; neither the start of a sum nor what is read back is among the longest kinds of paths, and no net spans the stage.
        assert!(stage.kinds.iter().any(|kind| kind.delay_ps == stage.delay_ps), "{told}");
        let is_free = |kind: &Kind| {
            ![&kind.from, &kind.to].iter().any(|name| SHORT.iter().any(|part| name.contains(part)))
        };
        assert!(stage.kinds.len() == timing::KINDS && stage.kinds.iter().all(is_free), "{told}");
        assert!(stage.strays.is_empty(), "{told}");
        assert!(stage.crossed.0 <= timing::MAX_CROSSED, "{told}");
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

/// The only logic between two boundaries' registers, and all of a calculator except its stages.
#[test]
fn what_makes_windows_whole_is_short_of_path_and_load_and_as_estimated() {
    let design = committed("kc705");
    let project = project::of_circuit(&mut WindowGuard::new(&design.stage(0)), vec![]).unwrap();
    let found = timing::whole(&project, None).unwrap();
    let limit = blocks::calculator(&design).limit_ps();
    assert!(found.delay_ps <= limit && found.control_loads <= CONTROL_LOADS, "{found:#?}");
    let of_stages: Resources = resources::stages(&design).into_iter().sum();
    let whole = resources::whole(&design);
    for (estimated, measured) in [
        (whole.luts - of_stages.luts, found.cells.luts()),
        (whole.registers - of_stages.registers, found.cells.flip_flops()),
    ] {
        assert!(
            estimated.abs_diff(measured) * 100 <= 15 * measured,
            "{estimated} estimated, {measured} measured"
        );
    }
}

/// What boards have beside the core (set-up of the video chips at the core's clock, sync codes and a camera's bus at the pixels'), and the host's registers.
#[test]
fn what_speaks_to_the_video_chips_and_the_host_is_short_of_path() {
    let program = &edof_device::i2c::programs(VideoTiming::P1080_60)[1];
    let mut setup = ChipSetup::new(&Pace::of(&KC705), program, "mem/i2c_imageon.mem", true);
    let image = edof_device::i2c::image(program);
    let setup = project::of_circuit(&mut setup, vec![("mem/i2c_imageon.mem".into(), image)]).unwrap();
    let syncs = project::of_circuit(&mut EmbeddedSyncs::default(), vec![]).unwrap();
    let camera = project::of_circuit(&mut CameraIn::new(16), vec![]).unwrap();
    let identity = Identity { design_hash: 1, weights_hash: 2, frame: (64, 48) };
    let mut registers = BoardRegisters::new(&committed("tiny"), &identity);
    let registers = project::of_circuit(&mut registers, vec![]).unwrap();
    let port = project::of_circuit(&mut CalculatorPort::default(), vec![]).unwrap();
    let calculator = blocks::calculator(&committed("kc705"));
    for (project, domain) in [
        (setup, Domain::Core),
        (syncs, Domain::Pixel),
        (camera, Domain::Pixel),
        (registers, Domain::Core),
        (port, calculator),
    ] {
        let found = timing::whole(&project, None).unwrap();
        assert!(found.delay_ps <= domain.limit_ps(), "{found:#?}");
        println!("{}: {} ps", found.module, found.delay_ps);
    }
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

/// The core of a design with a random network.
fn core(design: &Design) -> project::Project {
    let network = edof_device::random::for_design(design, 1);
    system::project(design, [&network, &network], &Display::default()).unwrap()
}

/// Parts of a design's core, each by itself.
pub fn of_core(design: &Design, paths: &[String]) -> Vec<PartTiming> {
    timing::parts(&core(design), paths, Some(&cache()), &|_, _| ()).unwrap()
}

/// Every block of the core around the calculator.
fn blocks_keep_their_limits(name: &str) {
    let design = committed(name);
    let blocks = blocks::around_the_calculator(&design);
    let paths: Vec<String> = blocks.iter().map(|block| block.path.clone()).collect();
    let found = of_core(&design, &paths);
    let long = blocks.iter().zip(&found).filter(|(block, found)| found.delay_ps > block.domain.limit_ps());
    let told: Vec<String> = long
        .map(|(block, found)| format!("{}: {} ps, {:#?}", block.path, found.delay_ps, found.path))
        .collect();
    assert!(told.is_empty(), "{name}: {}", told.join("\n"));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_blocks_of_tiny_are_short_of_path() {
    blocks_keep_their_limits("tiny");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_blocks_of_kc705_are_short_of_path() {
    blocks_keep_their_limits("kc705");
}

/// Names of the instances in a module, those of what makes resets left out.
fn instances(core: &project::Project, module: &str) -> Vec<String> {
    let (_, text) = core.verilog.iter().find(|(name, _)| *name == format!("{module}.v")).unwrap();
    let of_logic = |module: &str| !["edof_reset_sync", "edof_power_on"].contains(&module);
    let parts = crate::support::instances(text).into_iter().filter(|(_, module)| of_logic(module));
    parts.map(|(name, _)| name).collect()
}

#[test]
fn every_block_of_the_core_is_timed() {
    let core = core(&committed("tiny"));
    let inside = |path: &str, module: &str| -> Vec<String> {
        instances(&core, module).into_iter().map(|name| format!("{path}{name}")).collect()
    };
    let parted = ["core", "core/calculator", "core/lines"];
    let all =
        [inside("", "edof_core"), inside("core/", "stream_core"), inside("core/lines/", "lines")].concat();
    let all: BTreeSet<String> = all.into_iter().filter(|path| !parted.contains(&path.as_str())).collect();
    let timed: BTreeSet<String> =
        blocks::around_the_calculator(&committed("tiny")).into_iter().map(|block| block.path).collect();
    assert_eq!(all, timed);
}
