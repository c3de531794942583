//! A whole chain in Icarus and in Verilator: the same outputs in every cycle.

use crate::common::{Recorded, Setup, committed, expect_clean, misfits, patches};
use crate::support;
use edof_cosim::chain::Drive;
use edof_cosim::chain::second::{rows, with_random_memories};
use edof_cosim::chain::verilated::write_images;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Layout, Source, icarus};
use edof_device::Design;
use edof_golden::cycle::Stalls;
use edof_hdl::project;
use edof_network::network::{Recurrence, Shrinkage};

/// Outputs that must be known whenever `valid` is high, and from reset on.
fn streams(design: &Design) -> Vec<(String, Vec<String>)> {
    let gaps = (0..design.stages.len() - 1).map(|gap| {
        let port = |part: &str| format!("between_{part}_{gap}_o");
        (port("valid"), ["data", "last", "set"].map(port).to_vec())
    });
    let patch = ["data", "last", "set"].map(|part| format!("patch_{part}_o")).to_vec();
    gaps.chain([("patch_valid_o".into(), patch)]).collect()
}

fn agrees(design: Design) {
    let setup = Setup::new(design, 1);
    let drive = Drive { stalls: Some(Stalls::drawn(2, 60)), ..Drive::default() };
    let mut circuit = Recorded::new(setup.start(1));
    let some = |seed| misfits(patches(&setup.design, 8, seed), seed);
    expect_clean(&drive.run(setup.model(), some(1), &mut circuit, &mut |_| ()).unwrap());
    let drive = Drive { flush: true, ..drive };
    expect_clean(&drive.run(setup.model(), some(2), &mut circuit, &mut |_| ()).unwrap());

    let project = project::calculator(&setup.design, [&setup.networks[0], &setup.networks[1]]).unwrap();
    let source = Source::from(&project);
    let stimulus = rows(&source, &circuit.inputs).unwrap();
    let images = tempfile::tempdir().unwrap();
    write_images(&project, images.path()).unwrap();
    let start = Start { seed: 9, memory_dir: Some(images.path().into()) };
    let verilator =
        Library::build(&source, &support::options()).unwrap().start(&start).unwrap().run(&stimulus).unwrap();
    let icarus = icarus::run(&with_random_memories(source.clone()), &stimulus, Some(images.path())).unwrap();

    assert_eq!(icarus.first_difference(&source, &verilator), None);
    let layout = Layout::outputs(&source);
    let reset = circuit.inputs.iter().position(|inputs| !inputs.reset).unwrap();
    for cycle in reset..stimulus.len() {
        let unknown = |port: &str| layout.get(icarus.unknown.row(cycle), source.port(port).unwrap()).unwrap();
        for (valid, rest) in streams(&setup.design) {
            assert_eq!(unknown(&valid), 0, "{valid} in cycle {cycle}");
            if layout.get(verilator.row(cycle), source.port(&valid).unwrap()).unwrap() == 1 {
                rest.iter().for_each(|port| assert_eq!(unknown(port), 0, "{port} in cycle {cycle}"));
            }
        }
    }
}

#[test]
fn differences_agree() {
    let mut design = committed("tiny");
    design.form.recurrence = Recurrence::Difference;
    design.form.shrinkage = Shrinkage::TwoSided;
    agrees(design);
}

#[test]
fn the_direct_form_with_linear_path_agrees() {
    agrees(committed("tiny"));
}
