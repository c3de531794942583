//! The invariants of ARCHITECTURE.md that manifests can break: which crate reaches which, and who may name a crate of others.
//! That crates do not depend on each other in a circle is Cargo's own rule; that a library uses what it depends on is rustc's
//! (`unused_crate_dependencies`, in each `lib.rs`).

use crate::workspace::{self, Dependency, Package, packages};
use std::collections::BTreeSet;

/// Crates that must not be reached, not even by way of others. Dependencies of tests alone are not followed.
const UNREACHABLE: &[(&str, &[&str])] = &[
    ("edof-core", &["edof-numerics", "edof-network", "edof-device"]),
    ("edof-numerics", &["edof-core", "edof-hdl"]),
    ("edof-network", &["edof-optics", "edof-train", "edof-numerics", "edof-golden"]),
    ("edof-device", &["edof-optics", "edof-train", "edof-numerics"]),
    ("edof-io", &["edof-optics", "edof-network", "edof-device"]),
    ("edof-optics", NETWORKS),
    ("edof-deblur", NETWORKS),
    ("edof-golden", &["edof-train", "edof-hdl", "edof-io", "edof-optics"]),
    ("edof-verilog-derive", &["edof-core"]),
    ("edof-verilog", &["edof-core", "edof-device"]),
    ("edof-verilog-diff", &["edof-core", "edof-device"]),
    // The circuits and what judges them.
    ("edof-hdl", &["edof-train", "edof-golden", "edof-io", "edof-optics"]),
    ("edof-board", &["edof-train", "edof-hdl", "edof-optics"]),
    ("edof-cosim", &["edof-train", "edof-optics"]),
    ("edof-train", &["edof-golden", "edof-hdl", "edof-device"]),
    ("edof-gpu", &["edof-train", "edof-hdl", "edof-io", "edof-optics"]),
    ("edof-quantize", &["edof-hdl"]),
    ("edof-study", &["edof-hdl"]),
];

/// What computes or builds networks: nothing for optics and restoration.
const NETWORKS: &[&str] =
    &["edof-network", "edof-device", "edof-train", "edof-quantize", "edof-golden", "edof-hdl"];

/// Crates of others that few of ours may name.
const RESERVED: &[(&str, &[&str])] = &[
    ("clap", &["edof-cli"]),
    // Pictures. The golden pipeline's tests read photographs.
    ("image", &["edof-io", "edof-study", "edof-golden"]),
    ("csv", &["edof-study"]),
    ("hyper", &["edof-cli"]),
    ("libloading", &["edof-cosim"]),
    ("maud", &["edof-study"]),
    ("opencl3", &["edof-gpu"]),
    ("rust-hdl", &["edof-verilog", "edof-verilog-diff", "edof-hdl", "edof-cosim"]),
    ("serialport", &["edof-board"]),
    ("syn", &["edof-verilog-derive"]),
    ("tokio", &["edof-cli"]),
];

/// Every way in which the manifests break the tables.
fn violations(packages: &[Package]) -> Vec<String> {
    let mut found = vec![];
    for package in packages {
        let name = package.name.as_str();
        let reached = reachable(packages, name);
        let strangers =
            UNREACHABLE.iter().filter(|(from, _)| *from == name).flat_map(|(_, strangers)| *strangers);
        found.extend(
            strangers
                .filter(|other| reached.contains(**other))
                .map(|other| format!("{name} reaches {other}")),
        );
        for other in package.dependencies.iter().map(|dependency| dependency.name.as_str()) {
            if RESERVED.iter().any(|(reserved, users)| *reserved == other && !users.contains(&name)) {
                found.push(format!("{name} names {other}"));
            }
        }
        // Random networks are for tests, studies and commands.
        let draws = package
            .dependencies
            .iter()
            .any(|one| !one.is_for_tests && one.features.iter().any(|f| f == "random"));
        if draws && !["edof-cli", "edof-cosim", "edof-python", "edof-study"].contains(&name) {
            found.push(format!("{name} depends on random networks"));
        }
    }
    found
}

/// Everything that a crate is built with.
fn reachable<'a>(packages: &'a [Package], from: &str) -> BTreeSet<&'a str> {
    let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
    while let Some(name) = next.pop() {
        let package = packages.iter().find(|package| package.name == name);
        for dependency in
            package.iter().flat_map(|package| &package.dependencies).filter(|one| !one.is_for_tests)
        {
            if seen.insert(dependency.name.as_str()) {
                next.push(&dependency.name);
            }
        }
    }
    seen
}

#[test]
fn crates_reach_and_name_only_what_they_may() {
    let packages = packages();
    assert_eq!(violations(&packages), [""; 0]);
    let names: BTreeSet<&str> = packages.iter().map(|package| package.name.as_str()).collect();
    let listed = UNREACHABLE.iter().chain(RESERVED).flat_map(|(from, others)| others.iter().chain([from]));
    let gone: Vec<_> = listed.filter(|name| name.starts_with("edof") && !names.contains(**name)).collect();
    assert_eq!(gone, [&""; 0], "no such crates");
}

#[test]
fn a_dependency_that_breaks_a_rule_is_found() {
    let with = |from: &str, name: &str, feature: Option<&str>, is_for_tests| {
        let mut packages = packages();
        let features = feature.into_iter().map(str::to_owned).collect();
        let dependency = Dependency { name: name.to_owned(), is_for_tests, is_optional: false, features };
        packages.iter_mut().find(|package| package.name == from).unwrap().dependencies.push(dependency);
        violations(&packages)
    };
    for (from, name, found) in [
        ("edof-golden", "edof-optics", "edof-cosim reaches edof-optics"),
        ("edof-hdl", "edof-golden", "edof-hdl reaches edof-golden"),
        ("edof-hdl", "image", "edof-hdl names image"),
    ] {
        assert!(with(from, name, None, false).contains(&found.to_owned()), "{found}");
    }
    assert_eq!(
        with("edof-golden", "edof-device", Some("random"), false),
        ["edof-golden depends on random networks"]
    );
    assert_eq!(with("edof-golden", "edof-device", Some("random"), true), [""; 0]);
    assert_eq!(with("edof-golden", "edof-optics", None, true), [""; 0]);
    assert_eq!(with("edof-hdl", "image", None, true), ["edof-hdl names image"]);
}

/// A file that no `mod` names is not compiled, and its tests never run.
#[test]
fn every_file_of_tests_is_part_of_its_program() {
    for (folder, program) in [("tests", "program"), ("crates/edof-cosim/tests", "circuits")] {
        let folder = workspace::root().join(folder);
        let text = std::fs::read_to_string(folder.join(program).with_extension("rs")).unwrap();
        for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let part = path.file_stem().unwrap().to_str().unwrap();
            let is_part = part == program || text.lines().any(|line| line == format!("mod {part};"));
            assert!(path.extension().is_none_or(|ending| ending != "rs") || is_part, "{}", path.display());
        }
    }
}
