//! The invariants of ARCHITECTURE.md that the dependency graph can hold.

use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// Our crates and which of ours each depends on (not for tests).
fn graph() -> BTreeMap<String, Vec<String>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"])
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.toml"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let packages = metadata["packages"].as_array().unwrap().iter();
    packages
        .map(|package| {
            let dependencies = package["dependencies"].as_array().unwrap().iter();
            let ours = dependencies
                .filter(|d| d["kind"].is_null())
                .map(|d| text(&d["name"]))
                .filter(|name| name.starts_with("edof-"));
            (text(&package["name"]), ours.collect())
        })
        .collect()
}

/// Everything that `from` can reach, by way of any others.
fn reachable(graph: &BTreeMap<String, Vec<String>>, from: &str) -> Vec<String> {
    let mut seen: Vec<String> = vec![];
    let mut next = vec![from.to_owned()];
    while let Some(name) = next.pop() {
        for child in &graph[&name] {
            if !seen.contains(child) {
                seen.push(child.clone());
                next.push(child.clone());
            }
        }
    }
    seen.sort();
    seen
}

#[test]
fn the_specification_depends_on_none_of_ours() {
    assert_eq!(graph()["edof-spec"], [""; 0]);
}

#[test]
fn the_golden_pipeline_knows_only_the_specification() {
    assert_eq!(reachable(&graph(), "edof-golden"), ["edof-spec"]);
}

#[test]
fn training_knows_neither_the_golden_pipeline_nor_quantization() {
    let known = reachable(&graph(), "edof-train");
    for above in ["edof-golden", "edof-quantize"] {
        assert!(!known.contains(&above.to_owned()), "edof-train reaches {above}");
    }
}

#[test]
fn nothing_depends_on_the_command() {
    for (name, dependencies) in graph() {
        assert!(!dependencies.contains(&"edof-cli".to_owned()), "{name} depends on edof-cli");
    }
}

#[test]
fn optics_io_and_deblurring_know_no_network() {
    for name in ["edof-optics", "edof-io", "edof-deblur"] {
        let known = reachable(&graph(), name);
        for network in ["edof-train", "edof-quantize", "edof-golden"] {
            assert!(!known.contains(&network.to_owned()), "{name} reaches {network}");
        }
    }
}

#[test]
fn nothing_points_back_up() {
    let graph = graph();
    for name in graph.keys() {
        assert!(!reachable(&graph, name).contains(name), "{name} depends on itself");
    }
}
