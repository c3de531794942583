//! The invariants of ARCHITECTURE.md that manifests can hold: which crate may name which, and that what is named is used.

mod workspace;

use std::collections::BTreeSet;
use workspace::{Kind, Package, packages, sources};

/// Which of our crates each may name, in any kind of dependency, tests' and build scripts' included. A crate stands below all that
/// it names: nothing points back up. A new crate gets a row.
const MAY_NAME: &[(&str, &[&str])] = &[
    ("edof-spec", &[]),
    ("edof-random", &["edof-spec"]),
    ("edof-io", &["edof-spec"]),
    ("edof-optics", &["edof-spec"]),
    ("edof-deblur", &["edof-spec"]),
    ("edof-golden", &["edof-spec", "edof-random"]),
    ("edof-hdl-derive", &[]),
    ("edof-hdl", &["edof-spec", "edof-hdl-derive"]),
    ("edof-cosim", &["edof-spec", "edof-random", "edof-golden", "edof-hdl"]),
    ("edof-train", &["edof-spec", "edof-optics"]),
    ("edof-quantize", &["edof-spec", "edof-random", "edof-optics", "edof-golden", "edof-train"]),
    (
        "edof-study",
        &["edof-spec", "edof-random", "edof-io", "edof-optics", "edof-deblur", "edof-golden", "edof-train"],
    ),
    (
        "edof-cli",
        &[
            "edof-spec",
            "edof-random",
            "edof-io",
            "edof-optics",
            "edof-deblur",
            "edof-golden",
            "edof-hdl",
            "edof-cosim",
            "edof-train",
            "edof-quantize",
            "edof-study",
        ],
    ),
];

/// What a crate knows nothing of, by way of any others.
const KNOWS_NOTHING_OF: &[(&str, &[&str])] = &[
    ("edof-io", &["edof-train", "edof-golden", "edof-hdl", "edof-optics"]),
    ("edof-optics", &["edof-train", "edof-golden", "edof-hdl", "edof-io"]),
    ("edof-deblur", &["edof-train", "edof-golden", "edof-hdl"]),
    ("edof-golden", &["edof-train", "edof-hdl", "edof-io", "edof-optics"]),
    ("edof-hdl", &["edof-train", "edof-golden", "edof-io", "edof-optics", "edof-study"]),
    ("edof-cosim", &["edof-train", "edof-study"]),
    ("edof-train", &["edof-golden", "edof-quantize", "edof-hdl", "edof-cosim"]),
    ("edof-quantize", &["edof-hdl", "edof-cosim"]),
];

/// Crates of others that are the business of few of ours.
const RESERVED: &[(&str, &[&str])] = &[
    ("clap", &["edof-cli"]),
    // Pictures. The golden pipeline's tests read photographs.
    ("image", &["edof-io", "edof-study", "edof-golden"]),
    ("libloading", &["edof-cosim"]),
    ("rust-hdl", &["edof-hdl", "edof-cosim"]),
    ("syn", &["edof-hdl-derive"]),
];

fn row<'a>(table: &[(&str, &'a [&'a str])], name: &str) -> Option<&'a [&'a str]> {
    table.iter().find(|(of, _)| *of == name).map(|(_, names)| *names)
}

/// Every way in which the manifests break the tables.
fn violations(packages: &[Package]) -> Vec<String> {
    let mut found = vec![];
    for package in packages {
        let name = package.name.as_str();
        let Some(allowed) = row(MAY_NAME, name) else {
            found.push(format!("{name} has no row"));
            continue;
        };
        for dependency in &package.dependencies {
            let other = dependency.name.as_str();
            if other.starts_with("edof-") && !allowed.contains(&other) {
                found.push(format!("{name} names {other}"));
            }
            if row(RESERVED, other).is_some_and(|users| !users.contains(&name)) {
                found.push(format!("{name} names {other}, which is not its business"));
            }
        }
        let known = reachable(packages, name);
        let strangers = row(KNOWS_NOTHING_OF, name).unwrap_or_default();
        found.extend(strangers.iter().filter(|s| known.contains(**s)).map(|s| format!("{name} reaches {s}")));
    }
    found
}

/// Everything that a crate depends on, by way of any others.
fn reachable<'a>(packages: &'a [Package], from: &str) -> BTreeSet<&'a str> {
    let mut seen = BTreeSet::new();
    let mut next = vec![from];
    while let Some(name) = next.pop() {
        let package = packages.iter().find(|package| package.name == name);
        for dependency in package.into_iter().flat_map(|package| &package.dependencies) {
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
    let names: Vec<&str> = MAY_NAME.iter().map(|(name, _)| *name).collect();
    let there: BTreeSet<String> = packages().into_iter().map(|package| package.name).collect();
    assert_eq!(names.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>(), there);
    for (index, (name, below)) in MAY_NAME.iter().enumerate() {
        for other in *below {
            assert!(
                names[..index].contains(other),
                "{name} may name {other}, which does not stand above it in the table"
            );
        }
    }
}

#[test]
fn a_dependency_that_breaks_a_rule_is_found_whatever_its_kind() {
    for (from, to, said) in [
        ("edof-spec", "edof-golden", "edof-spec names edof-golden"),
        ("edof-golden", "edof-hdl", "edof-golden reaches edof-hdl"),
        ("edof-hdl", "edof-train", "edof-hdl reaches edof-train"),
        ("edof-hdl", "image", "edof-hdl names image, which is not its business"),
        ("edof-io", "edof-cli", "edof-io names edof-cli"),
        ("edof-optics", "edof-study", "edof-optics reaches edof-train"),
    ] {
        for kind in [Kind::Normal, Kind::Development, Kind::Build] {
            let mut broken = packages();
            let package = broken.iter_mut().find(|package| package.name == from).unwrap();
            package.add(to, kind);
            assert!(violations(&broken).contains(&said.to_owned()), "{from} to {to}, {kind:?}");
        }
    }
    let mut broken = packages();
    broken[0].name = "edof-new".to_owned();
    assert!(violations(&broken).contains(&"edof-new has no row".to_owned()));
}

/// Dependencies that no source of their crate mentions, where their kind would have it.
fn unused(packages: &[Package]) -> Vec<String> {
    let mut found = vec![];
    for package in packages {
        for dependency in &package.dependencies {
            let mentions = |path: &str, text: &str| {
                let is_build = path.ends_with("/build.rs");
                let (code, tests) = workspace::split(text);
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
    // Of use to the program, not to its tests alone.
    let spec = packages.iter_mut().find(|package| package.name == "edof-spec").unwrap();
    spec.add("proptest", Kind::Normal);
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
fn every_whole_program_test_is_run() {
    let known: BTreeSet<String> = packages().into_iter().flat_map(|package| package.targets).collect();
    let tests =
        std::fs::read_dir(workspace::root().join("tests")).unwrap().map(|entry| entry.unwrap().path());
    for test in tests.filter(|path| path.extension().is_some_and(|e| e == "rs")) {
        let test = test.canonicalize().unwrap().display().to_string();
        assert!(known.contains(&test), "{test} is no [[test]] of crates/edof-cli/Cargo.toml");
    }
}

#[test]
fn no_two_files_of_a_crate_import_each_other() {
    let found: Vec<String> = packages().iter().flat_map(workspace::imports::circles).collect();
    assert_eq!(found, [""; 0]);
}
