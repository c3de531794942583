//! The workspace as `cargo metadata` describes it.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A dependency that a manifest names, of any feature and platform.
pub struct Dependency {
    pub name: String,
    pub is_for_tests: bool,
    pub is_optional: bool,
    pub features: Vec<String>,
}

pub struct Package {
    pub name: String,
    pub dependencies: Vec<Dependency>,
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The crates of this project.
pub fn packages() -> Vec<Package> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"])
        .arg(root().join("Cargo.toml"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let dependency = |value: &Value| Dependency {
        name: text(&value["name"]),
        is_for_tests: value["kind"] == "dev",
        is_optional: value["optional"] == true,
        features: value["features"].as_array().unwrap().iter().map(text).collect(),
    };
    let package = |value: &Value| Package {
        name: text(&value["name"]),
        dependencies: value["dependencies"].as_array().unwrap().iter().map(dependency).collect(),
    };
    let packages: Vec<Package> = metadata["packages"].as_array().unwrap().iter().map(package).collect();
    assert!(packages.len() > 5, "{} crates", packages.len());
    packages
}
