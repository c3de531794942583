//! The workspace as its manifests and sources tell of it.

pub mod imports;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where a dependency may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Normal,
    Development,
    Build,
}

pub struct Dependency {
    pub name: String,
    /// What sources call it.
    pub ident: String,
    pub kind: Kind,
}

pub struct Package {
    pub name: String,
    pub folder: PathBuf,
    pub dependencies: Vec<Dependency>,
    /// Root file of each library, program, test, example and benchmark.
    pub targets: Vec<String>,
}

impl Package {
    pub fn add(&mut self, name: &str, kind: Kind) {
        self.dependencies.push(Dependency { name: name.into(), ident: name.replace('-', "_"), kind });
    }
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Our crates, with the dependencies of all kinds, features and platforms.
pub fn packages() -> Vec<Package> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path"])
        .arg(root().join("Cargo.toml"))
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages: Vec<Package> = metadata["packages"].as_array().unwrap().iter().map(package).collect();
    assert!(packages.len() > 5, "cargo metadata told of {} crates", packages.len());
    packages
}

fn package(value: &Value) -> Package {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let dependency = |d: &Value| Dependency {
        name: text(&d["name"]),
        ident: d["rename"].as_str().unwrap_or_else(|| d["name"].as_str().unwrap()).replace('-', "_"),
        kind: match d["kind"].as_str() {
            None => Kind::Normal,
            Some("dev") => Kind::Development,
            Some("build") => Kind::Build,
            Some(other) => panic!("a dependency of kind {other}"),
        },
    };
    Package {
        name: text(&value["name"]),
        folder: Path::new(value["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned(),
        dependencies: value["dependencies"].as_array().unwrap().iter().map(dependency).collect(),
        targets: value["targets"].as_array().unwrap().iter().map(|t| plain(&text(&t["src_path"]))).collect(),
    }
}

/// A path without `..`, so that it can be compared.
fn plain(path: &str) -> String {
    Path::new(path).canonicalize().unwrap().display().to_string()
}

/// Path and text of every Rust file of a crate, its tests at the top level included.
pub fn sources(package: &Package) -> Vec<(String, String)> {
    let mut files = rust_files(&package.folder);
    if package.targets.iter().any(|target| !Path::new(target).starts_with(&package.folder)) {
        files.extend(rust_files(&root().join("tests")));
    }
    let read = |file: PathBuf| (file.display().to_string(), std::fs::read_to_string(file).unwrap());
    files.into_iter().map(read).collect()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| match path.is_dir() {
            true => rust_files(&path),
            false => vec![path],
        })
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}

/// A file's code without comments, and what is for tests alone: unit tests, and examples in the documentation.
pub fn split(text: &str) -> (String, String) {
    let tests_from = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
    let (code, tests) = text.split_at(tests_from);
    let is_comment = |line: &&str| line.trim_start().starts_with("//");
    let is_example =
        |line: &&str| line.trim_start().starts_with("///") || line.trim_start().starts_with("//!");
    let kept: Vec<&str> = code.lines().filter(|line| !is_comment(line)).collect();
    let examples: Vec<&str> = code.lines().filter(is_example).collect();
    (kept.join("\n"), examples.join("\n") + tests)
}

/// Whether a path in the text begins with this crate's name.
pub fn mentions(text: &str, ident: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(ident).any(|(at, _)| {
        let before = text[..at].trim_end_matches(' ');
        let after = &text[at + ident.len()..];
        let starts = !text[..at].ends_with(is_word) && !before.ends_with("::") && !before.ends_with('.');
        starts && (after.starts_with("::") || after.starts_with(';') && before.ends_with("use"))
    })
}

/// Names under `[workspace.dependencies]`.
pub fn shared_dependencies() -> Vec<String> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let lines = manifest.lines().skip_while(|line| *line != "[workspace.dependencies]").skip(1);
    let entries = lines.take_while(|line| !line.starts_with('['));
    entries.filter_map(|line| Some(line.split_once(" = ")?.0.to_owned())).collect()
}
