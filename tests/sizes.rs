//! No file of Rust is longer than 500 lines and no function longer than 80, except for those that are listed with a reason.

use crate::workspace::{packages, root, sources};

const FILE: usize = 500;
const FUNCTION: usize = 80;

/// Files that may be longer, how long, and why.
const FILES: [(&str, usize, &str); 8] = [
    ("crates/edof-cosim/tests/blocks.rs", 740, TRIALS),
    ("crates/edof-cosim/tests/crossing.rs", 560, TRIALS),
    ("crates/edof-cosim/tests/host.rs", 580, TRIALS),
    ("crates/edof-cosim/tests/i2c.rs", 560, TRIALS),
    ("crates/edof-hdl/src/board/edof_core.rs", 600, BLOCK),
    ("crates/edof-hdl/src/board/registers.rs", 620, BLOCK),
    ("crates/edof-hdl/tests/printing.rs", 640, TRIALS),
    ("crates/edof-hdl/tests/refusals.rs", 540, TRIALS),
];

const BLOCK: &str = "one block, whose kernel must be one function";
const TRIALS: &str = "a list of trials side by side, each read by itself";

/// Functions that may be longer: a name, or a name in one file, and why.
const FUNCTIONS: [(&str, &str); 3] = [
    // rust-hdl translates the body of this one function, and a block is one of them: what is called from it must be another block.
    ("crates/edof-hdl/**/update", "the kernel of a block of rust-hdl is one function"),
    ("crates/edof-verilog/src/print.rs/print", "one walk over a syntax tree, a case for each kind of node"),
    (
        "crates/edof-cosim/tests/edof_core.rs/whatever_happens_no_picture_is_torn_and_the_right_counter_counts",
        "one story, told from the first mishap to the last",
    ),
];

/// Paths and texts of all Rust of the project.
fn files() -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = packages().iter().flat_map(sources).collect();
    let root = root();
    for (path, _) in &mut all {
        let own = std::path::Path::new(&*path).canonicalize().unwrap();
        *path = own.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
    }
    all.sort();
    all.dedup();
    all
}

/// Functions of a file as it is formatted, and the lines of each.
fn functions(text: &str) -> Vec<(&str, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = vec![];
    for (start, line) in lines.iter().enumerate() {
        let indent = line.len() - line.trim_start().len();
        let mut words = line.split_whitespace();
        let qualifiers = ["pub", "pub(crate)", "pub(super)", "const", "unsafe", "async", "extern", "\"C\""];
        if words.find(|word| !qualifiers.contains(word)) != Some("fn") {
            continue;
        }
        let name = words.next().unwrap_or_default();
        let name = &name[..name.find(['(', '<']).unwrap_or(name.len())];
        // Of a body, or of a declaration of several lines.
        let is_end = |line: &str| {
            line.len() - line.trim_start().len() == indent && (line.trim() == "}" || line.ends_with(';'))
        };
        // A declaration, or a body on its own line.
        if line.ends_with(';') || line.ends_with('}') {
            continue;
        }
        let length = lines[start + 1..].iter().position(|line| is_end(line)).map_or(0, |end| end + 2);
        found.push((name, length));
    }
    found
}

#[test]
fn files_and_functions_are_short_but_for_those_that_say_why() {
    let files = files();
    assert!(files.len() > 400, "{} files", files.len());
    let mut long = vec![];
    for (path, text) in &files {
        let lines = text.lines().count();
        let limit = FILES.iter().find(|(file, ..)| file == path).map_or(FILE, |(_, limit, _)| *limit);
        if lines > limit {
            long.push(format!("{path}: {lines} lines, {limit} at most"));
        }
        for (name, lines) in functions(text) {
            let own = format!("{path}/{name}");
            let is_listed = FUNCTIONS.iter().any(|(listed, _)| match listed.split_once("**") {
                Some((folder, end)) => own.starts_with(folder) && own.ends_with(end),
                None => own == *listed,
            });
            if lines > FUNCTION && !is_listed {
                long.push(format!("{own}: {lines} lines, {FUNCTION} at most"));
            }
        }
    }
    assert!(long.is_empty(), "split these, or list them here with the reason:\n{}", long.join("\n"));
}

#[test]
fn every_exception_is_needed() {
    let files = files();
    let idle: Vec<&str> = FILES
        .iter()
        .map(|(file, ..)| *file)
        .filter(|file| !files.iter().any(|(path, text)| path == file && text.lines().count() > FILE))
        .collect();
    assert!(idle.is_empty(), "no longer too long, or gone: {}", idle.join(", "));
}

#[test]
fn a_long_function_is_found_wherever_it_is() {
    let body = "        work();\n".repeat(90);
    let text = format!(
        "impl A {{\n    pub fn short(&self) {{\n        work();\n    }}\n\n    fn long(\n        &self,\n    ) -> u8 {{\n{body}    }}\n}}\n\
         fn plain() {{\n    work();\n}}\ntrait B {{\n    fn declared(&self);\n}}\n"
    );
    assert_eq!(functions(&text), [("short", 3), ("long", 94), ("plain", 3)]);
}
