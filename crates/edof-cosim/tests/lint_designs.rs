//! All emitted files of the committed designs are clean, except for what `rtl/waivers.vlt` lists.

use crate::common::{committed, root};
use edof_cosim::{Source, lint};
use edof_device::Design;
use edof_hdl::project;
use edof_network::{FixedNetwork, weight_file};

#[track_caller]
fn is_clean(design: &Design, network: &FixedNetwork) {
    let project = project::calculator(design, [network, network]).unwrap();
    lint::clean(&Source::from(&project), Some(&root().join("rtl/waivers.vlt"))).unwrap();
}

fn weights(name: &str) -> FixedNetwork {
    weight_file::load_fixed(&root().join("weights").join(name)).unwrap()
}

#[test]
fn tiny() {
    let design = committed("tiny");
    is_clean(&design, &edof_device::random::for_design(&design, 1));
}

#[test]
fn paper() {
    is_clean(&committed("paper"), &weights("paper-t4.fixed.safetensors"));
}

#[test]
fn kc705() {
    is_clean(&committed("kc705"), &weights("edof-t4w12-outer.fixed.safetensors"));
}
