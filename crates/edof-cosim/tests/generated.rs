//! The text of generated designs.

use crate::common::{committed, root};
use edof_hdl::project::{self, Project};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn generated(name: &str) -> Project {
    let design = committed(name);
    let network = edof_device::random::for_design(&design, 1);
    project::calculator(&design, [&network, &network]).unwrap()
}

fn snapshot() -> PathBuf {
    root().join("crates/edof-hdl/tests/snapshot/tiny")
}

/// Names of the files in a directory.
fn names(dir: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name());
    entries.map(|name| name.into_string().unwrap()).collect()
}

/// Leaves are files of the project. With `EDOF_BLESS=1` the snapshot becomes what is generated; its changes are then reviewed like any other.
#[test]
fn tiny_is_the_snapshot() {
    let is_leaf =
        |file: &str| edof_hdl::leaves::LEAVES.iter().any(|(leaf, _)| file.strip_suffix(".v") == Some(leaf));
    let verilog: Vec<_> = generated("tiny").verilog.into_iter().filter(|(file, _)| !is_leaf(file)).collect();
    if std::env::var_os("EDOF_BLESS").is_some_and(|bless| bless == "1") {
        let _ = std::fs::remove_dir_all(snapshot());
        std::fs::create_dir_all(snapshot()).unwrap();
        verilog.iter().for_each(|(name, text)| std::fs::write(snapshot().join(name), text).unwrap());
    }
    assert_eq!(names(&snapshot()), verilog.iter().map(|(name, _)| name.clone()).collect());
    for (name, text) in &verilog {
        let kept = std::fs::read_to_string(snapshot().join(name)).unwrap();
        assert!(*text == kept, "{name} is not the snapshot's: if that is meant, run again with EDOF_BLESS=1");
    }
}

#[test]
fn a_design_is_generated_twice_alike() {
    for name in ["tiny", "paper", "kc705"] {
        assert!(generated(name) == generated(name), "{name}");
    }
}

#[test]
fn each_module_says_what_it_is() {
    for name in ["tiny", "paper", "kc705"] {
        for (file, text) in generated(name).verilog {
            let header: Vec<&str> = text.lines().take_while(|line| line.starts_with("//")).collect();
            assert!(header.first().is_some_and(|line| line.len() > 20), "{file}: {header:?}");
            let modules = text.lines().filter(|line| line.starts_with("module ")).count();
            assert_eq!(modules, 1, "{file}");
        }
    }
}
