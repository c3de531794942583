//! The invariants of ARCHITECTURE.md that manifests can hold: which crate may name which, and that what is named is used.

use crate::workspace;
use crate::workspace::{Kind, Package, packages, sources};
use std::collections::BTreeSet;

/// What a crate may name of ours.
struct Row {
    name: &'static str,
    /// In `[dependencies]` and `[build-dependencies]`.
    uses: &'static [&'static str],
    /// In `[dev-dependencies]`, besides.
    tests_use: &'static [&'static str],
    /// What it must not reach by way of any others either.
    knows_nothing_of: &'static [&'static str],
}

/// From the bottom up: a crate stands below all that name it, in tests too. A new crate gets a row.
const CRATES: &[Row] = &[
    // An oracle for set-ups: it must not reach what it judges.
    Row {
        name: "edof-chips",
        uses: &[],
        tests_use: &[],
        knows_nothing_of: &["edof-image", "edof-device", "edof-golden", "edof-hdl", "edof-board"],
    },
    Row { name: "edof-image", uses: &[], tests_use: &[], knows_nothing_of: &[] },
    Row { name: "edof-numerics", uses: &[], tests_use: &[], knows_nothing_of: &["edof-image"] },
    Row { name: "edof-storage", uses: &["edof-image"], tests_use: &[], knows_nothing_of: &[] },
    Row {
        name: "edof-camera",
        uses: &["edof-image", "edof-storage"],
        tests_use: &[],
        knows_nothing_of: &["edof-numerics"],
    },
    Row {
        name: "edof-network",
        uses: &["edof-image", "edof-storage", "edof-camera"],
        tests_use: &[],
        knows_nothing_of: &["edof-optics", "edof-train", "edof-numerics"],
    },
    Row {
        name: "edof-float",
        uses: &["edof-image", "edof-network"],
        tests_use: &["edof-camera"],
        knows_nothing_of: &["edof-optics", "edof-train", "edof-golden"],
    },
    Row {
        name: "edof-device",
        uses: &["edof-image", "edof-storage", "edof-network"],
        tests_use: &["edof-chips"],
        knows_nothing_of: &["edof-optics", "edof-train", "edof-numerics"],
    },
    Row {
        name: "edof-sparse",
        uses: &["edof-numerics"],
        tests_use: &[],
        knows_nothing_of: &["edof-image", "edof-hdl"],
    },
    Row {
        name: "edof-random",
        uses: &["edof-image", "edof-camera", "edof-network", "edof-device"],
        tests_use: &[],
        knows_nothing_of: &[],
    },
    Row {
        name: "edof-io",
        uses: &["edof-image", "edof-storage", "edof-camera"],
        tests_use: &[],
        knows_nothing_of: &["edof-optics", "edof-network", "edof-device"],
    },
    Row {
        name: "edof-optics",
        uses: &["edof-image", "edof-storage", "edof-camera", "edof-numerics"],
        tests_use: &[],
        knows_nothing_of: NETWORKS,
    },
    Row {
        name: "edof-presets",
        uses: &[
            "edof-image",
            "edof-storage",
            "edof-camera",
            "edof-network",
            "edof-device",
            "edof-io",
            "edof-optics",
        ],
        tests_use: &[],
        knows_nothing_of: &["edof-train", "edof-golden", "edof-hdl"],
    },
    Row {
        name: "edof-deblur",
        uses: &["edof-image", "edof-numerics"],
        tests_use: &[],
        knows_nothing_of: NETWORKS,
    },
    Row {
        name: "edof-golden",
        uses: &["edof-image", "edof-network", "edof-device"],
        tests_use: &["edof-storage", "edof-random"],
        knows_nothing_of: &["edof-train", "edof-hdl", "edof-io", "edof-optics", "edof-random"],
    },
    Row { name: "edof-verilog-derive", uses: &[], tests_use: &[], knows_nothing_of: &["edof-image"] },
    Row {
        name: "edof-verilog",
        uses: &["edof-verilog-derive"],
        tests_use: &[],
        knows_nothing_of: &["edof-image", "edof-device"],
    },
    Row {
        name: "edof-verilog-diff",
        uses: &["edof-verilog"],
        tests_use: &[],
        knows_nothing_of: &["edof-image", "edof-device"],
    },
    Row {
        name: "edof-hdl",
        uses: &["edof-image", "edof-network", "edof-device", "edof-verilog"],
        tests_use: &[],
        knows_nothing_of: &["edof-train", "edof-golden", "edof-io", "edof-optics"],
    },
    Row {
        name: "edof-board",
        uses: &["edof-chips", "edof-image", "edof-network", "edof-device", "edof-golden"],
        tests_use: &["edof-random"],
        knows_nothing_of: &["edof-train", "edof-hdl", "edof-optics", "edof-random"],
    },
    Row {
        name: "edof-cosim",
        uses: &[
            "edof-chips",
            "edof-image",
            "edof-storage",
            "edof-network",
            "edof-device",
            "edof-golden",
            "edof-hdl",
            "edof-board",
            "edof-random",
        ],
        tests_use: &["edof-verilog", "edof-verilog-diff"],
        knows_nothing_of: &["edof-train", "edof-optics"],
    },
    Row {
        name: "edof-train",
        uses: &[
            "edof-image",
            "edof-storage",
            "edof-camera",
            "edof-network",
            "edof-float",
            "edof-numerics",
            "edof-sparse",
            "edof-optics",
        ],
        tests_use: &["edof-random"],
        knows_nothing_of: &["edof-golden", "edof-hdl", "edof-device"],
    },
    Row {
        name: "edof-gpu",
        uses: &["edof-image", "edof-network", "edof-golden"],
        tests_use: &["edof-camera", "edof-random", "edof-float"],
        knows_nothing_of: &["edof-train", "edof-hdl", "edof-io", "edof-optics", "edof-random"],
    },
    Row {
        name: "edof-quantize",
        uses: &[
            "edof-image",
            "edof-network",
            "edof-float",
            "edof-numerics",
            "edof-optics",
            "edof-golden",
            "edof-train",
        ],
        tests_use: &["edof-storage", "edof-camera", "edof-random"],
        knows_nothing_of: &["edof-hdl"],
    },
    Row {
        name: "edof-metrics",
        uses: &["edof-image", "edof-numerics"],
        tests_use: &[],
        knows_nothing_of: &["edof-storage", "edof-optics"],
    },
    Row {
        name: "edof-report",
        uses: &["edof-image", "edof-storage"],
        tests_use: &[],
        knows_nothing_of: &["edof-metrics", "edof-optics", "edof-network"],
    },
    Row {
        name: "edof-methods",
        uses: &[
            "edof-image",
            "edof-storage",
            "edof-camera",
            "edof-network",
            "edof-float",
            "edof-device",
            "edof-sparse",
            "edof-io",
            "edof-optics",
            "edof-deblur",
            "edof-golden",
            "edof-gpu",
            "edof-numerics",
        ],
        tests_use: &["edof-random"],
        knows_nothing_of: &["edof-hdl", "edof-train", "edof-metrics", "edof-report"],
    },
    Row {
        name: "edof-study",
        uses: &[
            "edof-image",
            "edof-numerics",
            "edof-storage",
            "edof-camera",
            "edof-network",
            "edof-io",
            "edof-optics",
            "edof-deblur",
            "edof-metrics",
            "edof-report",
            "edof-methods",
        ],
        tests_use: &["edof-random"],
        knows_nothing_of: &["edof-hdl", "edof-train"],
    },
    Row {
        name: "edof-stability",
        uses: &[
            "edof-image",
            "edof-storage",
            "edof-camera",
            "edof-network",
            "edof-float",
            "edof-numerics",
            "edof-sparse",
            "edof-io",
            "edof-optics",
            "edof-deblur",
            "edof-golden",
            "edof-random",
            "edof-train",
            "edof-quantize",
            "edof-metrics",
            "edof-report",
            "edof-methods",
            "edof-study",
        ],
        tests_use: &[],
        knows_nothing_of: &["edof-hdl"],
    },
    Row {
        name: "edof-cli",
        uses: &[
            "edof-image",
            "edof-storage",
            "edof-camera",
            "edof-presets",
            "edof-network",
            "edof-float",
            "edof-device",
            "edof-random",
            "edof-io",
            "edof-optics",
            "edof-deblur",
            "edof-golden",
            "edof-gpu",
            "edof-hdl",
            "edof-cosim",
            "edof-board",
            "edof-train",
            "edof-quantize",
            "edof-metrics",
            "edof-report",
            "edof-methods",
            "edof-study",
            "edof-stability",
        ],
        tests_use: &[],
        knows_nothing_of: &[],
    },
];

/// What computes or builds networks: nothing for optics and restoration.
const NETWORKS: &[&str] =
    &["edof-network", "edof-device", "edof-train", "edof-quantize", "edof-golden", "edof-hdl"];

/// Crates of others that are the business of few of ours.
const RESERVED: &[(&str, &[&str])] = &[
    ("clap", &["edof-cli"]),
    // Pictures. The golden pipeline's tests read photographs.
    ("image", &["edof-io", "edof-report", "edof-study", "edof-golden"]),
    ("csv", &["edof-report"]),
    ("libloading", &["edof-cosim"]),
    ("maud", &["edof-report"]),
    ("opencl3", &["edof-gpu"]),
    ("rust-hdl", &["edof-verilog", "edof-verilog-diff", "edof-hdl", "edof-cosim"]),
    ("serialport", &["edof-board"]),
    ("syn", &["edof-verilog-derive"]),
];

/// Every way in which the manifests break the table.
fn violations(packages: &[Package]) -> Vec<String> {
    let mut found = vec![];
    for package in packages {
        let name = package.name.as_str();
        let Some(row) = CRATES.iter().find(|row| row.name == name) else {
            found.push(format!("{name} has no row"));
            continue;
        };
        for dependency in &package.dependencies {
            let other = dependency.name.as_str();
            let in_tests = dependency.kind == Kind::Development && row.tests_use.contains(&other);
            if other.starts_with("edof-") && !in_tests && !row.uses.contains(&other) {
                found.push(format!("{name} names {other}"));
            }
            let users = RESERVED.iter().find(|(reserved, _)| *reserved == other);
            if users.is_some_and(|(_, users)| !users.contains(&name)) {
                found.push(format!("{name} names {other}, which is not its business"));
            }
        }
        let known = reachable(packages, name);
        let strangers = row.knows_nothing_of.iter().filter(|stranger| known.contains(**stranger));
        found.extend(strangers.map(|stranger| format!("{name} reaches {stranger}")));
    }
    found
}

/// Everything that a crate is built with, by way of any others; what tests alone use is not in it.
fn reachable<'a>(packages: &'a [Package], from: &str) -> BTreeSet<&'a str> {
    let mut seen = BTreeSet::new();
    let mut next = vec![from];
    while let Some(name) = next.pop() {
        let package = packages.iter().find(|package| package.name == name);
        let dependencies = package.into_iter().flat_map(|package| &package.dependencies);
        for dependency in dependencies.filter(|dependency| dependency.kind != Kind::Development) {
            if seen.insert(dependency.name.as_str()) {
                next.push(&dependency.name);
            }
        }
    }
    seen
}

#[test]
fn crates_name_only_what_lies_below_them() {
    assert_eq!(violations(&packages()), [""; 0]);
}

#[test]
fn the_table_has_a_row_for_each_crate_and_points_down() {
    let names: Vec<&str> = CRATES.iter().map(|row| row.name).collect();
    let there: BTreeSet<String> = packages().into_iter().map(|package| package.name).collect();
    assert_eq!(names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>(), there);
    for (index, row) in CRATES.iter().enumerate() {
        for other in row.uses.iter().chain(row.tests_use) {
            assert!(names[..index].contains(other), "{} may name {other}, which stands above it", row.name);
        }
    }
}

#[test]
fn a_dependency_that_breaks_a_rule_is_found_whatever_its_kind() {
    for (from, to) in [
        ("edof-image", "edof-golden"),
        ("edof-optics", "edof-device"),
        ("edof-golden", "edof-hdl"),
        ("edof-golden", "edof-train"),
        ("edof-golden", "edof-optics"),
        ("edof-hdl", "edof-golden"),
        ("edof-hdl", "edof-train"),
        ("edof-hdl", "edof-optics"),
        ("edof-io", "edof-cli"),
        ("edof-train", "edof-golden"),
    ] {
        for kind in [Kind::Normal, Kind::Development, Kind::Build] {
            assert!(
                violations(&with(from, to, kind)).contains(&format!("{from} names {to}")),
                "{from} {to} {kind:?}"
            );
        }
    }
    for kind in [Kind::Normal, Kind::Development, Kind::Build] {
        let said = "edof-hdl names image, which is not its business".to_owned();
        assert_eq!(violations(&with("edof-hdl", "image", kind)), [said]);
    }
    // What tests may use, and by way of others.
    assert_eq!(violations(&with("edof-golden", "edof-random", Kind::Development)), [""; 0]);
    let golden = violations(&with("edof-golden", "edof-optics", Kind::Normal));
    assert!(golden.contains(&"edof-golden reaches edof-optics".to_owned()), "{golden:?}");
    assert!(golden.contains(&"edof-cosim reaches edof-optics".to_owned()), "{golden:?}");
    let mut unknown = packages();
    unknown[0].name = "edof-new".to_owned();
    assert!(violations(&unknown).contains(&"edof-new has no row".to_owned()));
}

/// The workspace with one dependency more.
fn with(from: &str, to: &str, kind: Kind) -> Vec<Package> {
    let mut packages = packages();
    packages.iter_mut().find(|package| package.name == from).unwrap().add(to, kind);
    packages
}

/// Dependencies that no source of their crate mentions, where their kind would have it. `once_cell` is there for its features (decision 0044).
fn unused(packages: &[Package]) -> Vec<String> {
    let mut found = vec![];
    for package in packages {
        for dependency in package.dependencies.iter().filter(|one| one.name != "once_cell") {
            let mentions = |path: &str, text: &str| {
                let is_build = path.ends_with("/build.rs");
                // A module of tests may have a file of its own.
                let (code, tests) = match path.ends_with("/tests.rs") {
                    true => (String::new(), text.to_owned()),
                    false => workspace::split(text),
                };
                let own = path.contains("/src/");
                match dependency.kind {
                    Kind::Build => is_build && workspace::mentions(text, &dependency.ident),
                    Kind::Normal => own && workspace::mentions(&code, &dependency.ident),
                    Kind::Development => {
                        workspace::mentions(if own { &tests } else { text }, &dependency.ident)
                    }
                }
            };
            if !sources(package).iter().any(|(path, text)| mentions(path, text)) {
                found.push(format!("{}: {} ({:?})", package.name, dependency.name, dependency.kind));
            }
        }
    }
    found
}

/// A PSF needs no register map, and the golden model neither optics nor training: these crates of ours stand behind each, and no others.
#[test]
fn few_crates_stand_behind_optics_and_the_golden_model() {
    let packages = packages();
    let ours = |name| {
        let all = reachable(&packages, name);
        all.into_iter().filter(|other| other.starts_with("edof-")).collect::<Vec<_>>()
    };
    assert_eq!(ours("edof-optics"), ["edof-camera", "edof-image", "edof-numerics", "edof-storage"]);
    assert_eq!(
        ours("edof-golden"),
        ["edof-camera", "edof-device", "edof-image", "edof-network", "edof-storage"]
    );
}

#[test]
fn every_dependency_is_used_by_the_crate_that_names_it() {
    assert_eq!(unused(&packages()), [""; 0]);
}

#[test]
fn a_dependency_that_nothing_uses_is_found() {
    let mut packages = packages();
    for kind in [Kind::Normal, Kind::Development, Kind::Build] {
        packages[0].add("left-pad", kind);
    }
    // Used by the program, not by its tests alone.
    let image = packages.iter_mut().find(|package| package.name == "edof-image").unwrap();
    image.add("proptest", Kind::Normal);
    assert_eq!(unused(&packages).len(), 4, "{:?}", unused(&packages));
}

#[test]
fn every_dependency_of_the_workspace_is_named_by_a_crate() {
    let named: BTreeSet<String> =
        packages().into_iter().flat_map(|package| package.dependencies).map(|d| d.name).collect();
    let idle: Vec<String> =
        workspace::shared_dependencies().into_iter().filter(|n| !named.contains(n)).collect();
    assert_eq!(idle, [""; 0]);
}

#[test]
fn every_file_of_tests_is_part_of_its_program() {
    for (folder, program) in [("tests", "program"), ("crates/edof-cosim/tests", "circuits")] {
        let folder = workspace::root().join(folder);
        let text = std::fs::read_to_string(folder.join(program).with_extension("rs")).unwrap();
        let known: BTreeSet<&str> = text.lines().filter_map(|line| line.strip_prefix("mod ")).collect();
        for entry in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let part = entry.file_stem().unwrap().to_str().unwrap();
            let is_rust = entry.extension().is_some_and(|e| e == "rs") && part != program;
            assert!(
                !is_rust || known.contains(&*format!("{part};")),
                "{} is no part of {program}",
                entry.display()
            );
        }
    }
}

#[test]
fn no_two_files_of_a_crate_import_each_other() {
    let found: Vec<String> = packages().iter().flat_map(workspace::imports::circles).collect();
    assert_eq!(found, [""; 0]);
}
