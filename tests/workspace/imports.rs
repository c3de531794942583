//! Which file of a crate imports which. A file and those in its folder of the same name may know each other; others may not, even
//! by way of a third.

use super::{Package, rust_files, split};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module by its path from the crate's root; the root is empty.
type Module = Vec<String>;

/// Every circle of files, once, as `crate: a, b`.
pub fn circles(package: &Package) -> Vec<String> {
    let source = package.folder.join("src");
    let mut texts = BTreeMap::new();
    for file in rust_files(&source) {
        let text = std::fs::read_to_string(&file).unwrap();
        texts.insert(module(file.strip_prefix(&source).unwrap()), split(&text).0);
    }
    let shown = shown_at_root(texts.get(&vec![]).map_or("", String::as_str));
    let graph: BTreeMap<&Module, BTreeSet<Module>> =
        texts.iter().map(|(module, text)| (module, imported(module, text, &texts, &shown))).collect();
    let mut found = BTreeSet::new();
    for start in graph.keys() {
        let mut seen: BTreeSet<&Module> = BTreeSet::new();
        let mut next: Vec<&Module> = graph[*start].iter().collect();
        while let Some(module) = next.pop() {
            if seen.insert(module) {
                next.extend(&graph[module]);
            }
        }
        if seen.contains(*start) {
            // All files of one circle reach the same files, and each other.
            let circle: Vec<String> = seen
                .iter()
                .filter(|other| reaches(&graph, other, start))
                .map(|other| other.join("::"))
                .collect();
            found.insert(format!("{}: {}", package.name, circle.join(", ")));
        }
    }
    found.into_iter().collect()
}

fn reaches(graph: &BTreeMap<&Module, BTreeSet<Module>>, from: &Module, to: &Module) -> bool {
    let mut seen = BTreeSet::new();
    let mut next: Vec<&Module> = graph[from].iter().collect();
    while let Some(module) = next.pop() {
        if seen.insert(module) {
            next.extend(&graph[module]);
        }
    }
    seen.contains(to)
}

fn module(file: &Path) -> Module {
    let mut parts: Module =
        file.with_extension("").iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if parts.last().is_some_and(|last| matches!(last.as_str(), "lib" | "main" | "mod")) {
        parts.pop();
    }
    parts
}

/// Files that a file's paths lead to, without those above and below it.
fn imported(
    from: &Module,
    text: &str,
    all: &BTreeMap<Module, String>,
    shown: &BTreeMap<String, Module>,
) -> BTreeSet<Module> {
    let mut found = BTreeSet::new();
    for (root, start) in [("crate::", vec![]), ("super::", from[..from.len().saturating_sub(1)].to_vec())] {
        for (at, _) in text.match_indices(root) {
            if text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            for path in paths(&text[at + root.len()..]) {
                let mut target = start.clone();
                for part in path {
                    match part.as_str() {
                        "super" => drop(target.pop()),
                        _ => target.push(part),
                    }
                }
                if let Some(home) = target.first().and_then(|first| shown.get(first)) {
                    target.clone_from(home);
                }
                // What remains when items are taken off is the file that holds them.
                while !all.contains_key(&target) && target.pop().is_some() {}
                found.insert(target);
            }
        }
    }
    found.retain(|target| !target.starts_with(from) && !from.starts_with(target));
    found
}

/// Items that the root shows under a short name, and where they are at home.
fn shown_at_root(text: &str) -> BTreeMap<String, Module> {
    let statements = text.match_indices("pub use ").map(|(at, use_)| &text[at + use_.len()..]);
    statements.flat_map(paths).filter_map(|path| Some((path.last()?.clone(), path))).collect()
}

/// The paths that begin here: `a::b`, or with braces any number of them.
fn paths(text: &str) -> Vec<Module> {
    let mut path = vec![];
    let mut rest = text;
    loop {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        if end > 0 {
            path.push(rest[..end].to_owned());
            rest = &rest[end..];
        } else if let Some(inside) = rest.strip_prefix('{') {
            let tails = parts(inside).into_iter().flat_map(paths);
            return tails.map(|tail| path.iter().cloned().chain(tail).collect()).collect();
        }
        match rest.strip_prefix("::") {
            Some(more) => rest = more,
            None => return vec![path],
        }
    }
}

/// What stands between the commas of braces, up to where they close.
fn parts(inside: &str) -> Vec<&str> {
    let (mut depth, mut from, mut found) = (0, 0, vec![]);
    for (at, c) in inside.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                found.push(inside[from..at].trim());
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(inside[from..at].trim());
                from = at + 1;
            }
            _ => (),
        }
    }
    found.retain(|part| !part.is_empty());
    found
}

#[test]
fn paths_with_braces_are_read() {
    let joined = |text| paths(text).into_iter().map(|p| p.join("::")).collect::<Vec<_>>();
    assert_eq!(joined("a::{self, b::{C, D}, e};"), ["a::self", "a::b::C", "a::b::D", "a::e"]);
    assert_eq!(joined("a::b::C(1)"), ["a::b::C"]);
}

#[test]
fn a_circle_of_three_is_found_and_a_child_that_knows_its_parent_is_none() {
    let all: BTreeMap<Module, String> = [
        ("a", "use crate::b::X;"),
        ("b", "use super::Y;"),
        ("c", "fn f() { crate::a::g() }"),
        ("c::inner", "use super::Y;"),
    ]
    .map(|(name, text)| (name.split("::").map(str::to_owned).collect(), text.to_owned()))
    .into();
    let shown = shown_at_root("pub use c::Y;");
    let of = |name: &str| -> Vec<String> {
        let module: Module = name.split("::").map(str::to_owned).collect();
        imported(&module, &all[&module], &all, &shown).into_iter().map(|m| m.join("::")).collect()
    };
    assert_eq!((of("a"), of("b"), of("c")), (vec!["b".into()], vec!["c".into()], vec!["a".into()]));
    assert_eq!(of("c::inner"), [""; 0]);
}
