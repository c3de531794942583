//! Workspaces beside this one (fuzzing, a benchmark) have lock files of their own. With `--locked` they build only if these follow the manifests of our crates.

use crate::workspace::{Package, packages, root};
use std::collections::{BTreeMap, BTreeSet};

/// What a lock file says of each package: the names of those that it needs.
fn locked(text: &str) -> BTreeMap<&str, BTreeSet<&str>> {
    fn package(block: &str) -> Option<(&str, BTreeSet<&str>)> {
        let name = block.lines().find_map(|line| line.strip_prefix("name = "))?.trim_matches('"');
        let needs = block.lines().filter_map(|line| line.strip_prefix(" \"")?.split(['"', ' ']).next());
        Some((name, needs.collect()))
    }
    text.split("[[package]]").filter_map(package).collect()
}

/// Crates of ours that a lock file has and that need one of ours of which it says nothing.
fn stale(text: &str, packages: &[Package]) -> Vec<String> {
    let locked = locked(text);
    let of_package = |package: &Package| -> Vec<String> {
        let Some(needs) = locked.get(&*package.name) else { return vec![] };
        let ours = package.dependencies.iter().filter(|d| !d.is_for_tests && !d.is_optional);
        let missing = ours.filter(|dependency| !needs.contains(&*dependency.name));
        missing.map(|dependency| format!("{} needs {}", package.name, dependency.name)).collect()
    };
    packages.iter().flat_map(of_package).collect()
}

#[test]
fn lock_files_of_other_workspaces_follow_our_manifests() {
    let packages = packages();
    for folder in ["fuzz", "benches/gemm"] {
        let text = std::fs::read_to_string(root().join(folder).join("Cargo.lock")).unwrap();
        assert_eq!(stale(&text, &packages), [""; 0], "{folder}: run cargo metadata there");
    }
    let text = std::fs::read_to_string(root().join("fuzz/Cargo.lock")).unwrap();
    let older = text.replacen(" \"edof-core\",\n", "", 1);
    assert_eq!(stale(&older, &packages).len(), 1, "a lock file that lacks one is found");
}
