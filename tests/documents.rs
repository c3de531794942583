//! Documents name only what exists: files, folders, modules, pages cited by sources.

use crate::workspace::root;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders of the repository whose paths documents name.
const FOLDERS: &[&str] = &[
    "crates",
    "docs",
    "scripts",
    "rtl",
    "sim",
    "tests",
    "project",
    "constraints",
    "designs",
    "cameras",
    "weights",
    "benches",
    "python",
    ".ci",
    ".github",
];

/// Paths of a generated directory, where `edof generate` writes them.
const GENERATED: &[&str] = &[
    "rtl/edof_core.v",
    "rtl/kc705_core.v",
    "rtl/ulx3s_core.v",
    "constraints/crossings.xdc",
    "constraints/floorplan.xdc",
    "sim/bench.sv",
    "sim/core_bench.sv",
    "sim/rtl",
];

/// Files of the repository as git knows them, new ones included.
fn files(ends: &[&str]) -> Vec<PathBuf> {
    let output = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let found: Vec<PathBuf> =
        text.lines().filter(|line| ends.iter().any(|end| line.ends_with(end))).map(PathBuf::from).collect();
    assert!(found.len() > 10, "{} files end in {ends:?}", found.len());
    found.into_iter().filter(|file| root().join(file).exists()).collect()
}

/// What is between pairs of single back quotes, line by line; fenced blocks are left out.
fn quoted(text: &str) -> Vec<&str> {
    let mut fenced = false;
    let mut found = vec![];
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            found.extend(line.split('`').skip(1).step_by(2));
        }
    }
    found
}

/// Relative targets of Markdown's links.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets
        .map(|target| target.split('#').next().unwrap_or_default())
        .filter(|target| !target.is_empty() && !target.contains("://") && !target.contains(' '))
        .collect()
}

/// A path that a reader could open: below one of the repository's folders, without a placeholder.
fn is_path(word: &str) -> bool {
    let in_folder =
        FOLDERS.iter().any(|folder| word.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/')));
    let exact = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    let placeholder = word
        .split(['/', '.', '-', '_'])
        .any(|part| part.len() > 1 && part.chars().all(|c| c.is_ascii_uppercase()))
        && !["README", "LICENSE"].iter().any(|name| word.contains(name));
    in_folder && word.chars().all(exact) && !placeholder
}

/// `edof_crate::module…`: the module's file or folder, where the second part is a module's name.
fn module_file(word: &str) -> Option<(PathBuf, PathBuf)> {
    let mut parts = word.split("::");
    let name = parts.next().filter(|name| name.starts_with("edof_"))?;
    let module = parts.next().filter(|m| m.starts_with(|c: char| c.is_ascii_lowercase()))?;
    let source = Path::new("crates").join(name.replace('_', "-")).join("src");
    module.chars().all(|c| c.is_ascii_lowercase() || c == '_').then(|| (source, module.into()))
}

fn module_exists(source: &Path, module: &Path) -> bool {
    let source = root().join(source);
    let name = module.to_str().unwrap();
    let inside = |file: &str| {
        let text = std::fs::read_to_string(source.join(file)).unwrap_or_default();
        text.contains(&format!("fn {name}(")) || text.contains(&format!("mod {name}"))
    };
    source.join(format!("{name}.rs")).exists()
        || source.join(name).join("mod.rs").exists()
        || inside("lib.rs")
}

/// What a document names and nobody finds.
fn missing(file: &Path, text: &str) -> Vec<String> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let here = root().join(folder);
    let mut found = vec![];
    for target in links(text) {
        if !here.join(target).exists() {
            found.push(format!("{}: link to {target}", file.display()));
        }
    }
    for word in quoted(text) {
        let path = word.trim_end_matches('/');
        if is_path(path)
            && !GENERATED.contains(&path)
            && !root().join(path).exists()
            && !here.join(path).exists()
        {
            found.push(format!("{}: {word}", file.display()));
        }
        if let Some((source, module)) = module_file(word)
            && !module_exists(&source, &module)
        {
            found.push(format!("{}: {word}", file.display()));
        }
    }
    found
}

#[test]
fn every_path_module_and_link_of_a_document_exists() {
    // What the changelog says of the past need not be there any more.
    let documents = files(&[".md"]).into_iter().filter(|file| !file.ends_with("CHANGELOG.md"));
    let found: Vec<String> = documents
        .flat_map(|file| missing(&file, &std::fs::read_to_string(root().join(&file)).unwrap()))
        .collect();
    assert_eq!(found, [""; 0]);
}

#[test]
fn every_page_that_a_source_cites_exists() {
    let pages = files(&[".md"]);
    let mut found = vec![];
    for file in files(&[".rs", ".v", ".sv", ".py", ".toml"]) {
        let text = std::fs::read_to_string(root().join(&file)).unwrap();
        for line in
            text.lines().map(str::trim_start).filter(|line| line.starts_with("//") || line.starts_with('#'))
        {
            for word in line.split(|c: char| !(c.is_ascii_alphanumeric() || "/._-".contains(c))) {
                let cited = word.trim_end_matches('.').trim_start_matches("./");
                let names_a_page =
                    cited.ends_with(".md") && cited.len() > 3 && !cited.starts_with("../../..");
                let plain = cited.trim_start_matches("../");
                if names_a_page && !pages.iter().any(|page| page.ends_with(plain)) {
                    found.push(format!("{}: {cited}", file.display()));
                }
            }
        }
    }
    assert_eq!(found, [""; 0]);
}

#[test]
fn a_document_that_names_what_is_not_there_is_found() {
    let text = "See `docs/nowhere.md`, `edof_core::nothing`, [this](gone.md) and `docs/results/kodak-TONE.md`.\n```\n`docs/x.md`\n```";
    let found = missing(Path::new("README.md"), text);
    assert_eq!(
        found,
        ["README.md: link to gone.md", "README.md: docs/nowhere.md", "README.md: edof_core::nothing"]
    );
}
