//! `scripts/soak.sh`: every test that is left to it has a part, and every part has tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What an ignored test says that is left to the soak.
const REASON: &str = "scripts/soak.sh\"]";
/// What the others say.
const OTHER_REASONS: [&str; 3] =
    ["scripts/test-gpu.sh\"]", "in a process of its own\"]", "run by another test, once for each umask\"]"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn soak(arguments: &[&str]) -> String {
    let output = Command::new(root().join("scripts/soak.sh")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Rust sources of a folder and below.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    let below = |path: PathBuf| match path.is_dir() {
        true if path.ends_with("target") => vec![],
        true => sources(&path),
        false => vec![path],
    };
    entries.flat_map(below).filter(|path| path.extension().is_some_and(|end| end == "rs")).collect()
}

/// The test program of a source, and the modules of its tests.
fn program(source: &Path) -> (String, String) {
    let source = source.strip_prefix(root()).unwrap();
    let words: Vec<&str> = source.iter().map(|word| word.to_str().unwrap()).collect();
    let module = |word: &str| format!("{}::", word.trim_end_matches(".rs"));
    match words[..] {
        ["crates", "edof-cosim", "tests", first, ..] => ("circuits".into(), module(first)),
        ["crates", "edof-board", "tests", "it", first] => ("it".into(), module(first)),
        ["crates", _, "tests", alone] => (alone.trim_end_matches(".rs").into(), String::new()),
        ["tests", first] => ("program".into(), module(first)),
        _ => panic!("{}: which test program is it in?", source.display()),
    }
}

/// Name of the function, or of the line of a macro's table, that an attribute belongs to.
fn name<'a>(lines: impl IntoIterator<Item = &'a str>) -> &'a str {
    let line = lines.into_iter().map(str::trim).find(|line| !line.starts_with(['#', '/'])).unwrap();
    let line = line.strip_prefix("fn ").unwrap_or(line);
    line.split(['(', ':']).next().unwrap()
}

/// Test programs with the names of the tests that are left to the soak.
fn left_to_the_soak() -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    for source in ["crates", "tests"].iter().flat_map(|folder| sources(&root().join(folder))) {
        let text = fs::read_to_string(&source).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for (at, line) in lines.iter().enumerate().filter(|(_, line)| line.trim().starts_with("#[ignore")) {
            let is_other = OTHER_REASONS.iter().any(|reason| line.ends_with(reason));
            assert!(line.ends_with(REASON) || is_other, "{}: {line}: who runs it?", source.display());
            if !is_other {
                let (program, module) = program(&source);
                found.insert((program, module + name(lines[at..].iter().copied())));
            }
        }
    }
    found
}

/// Parts that are ignored tests: test programs with words of tests' names.
fn filters() -> Vec<(String, Vec<String>)> {
    let list = soak(&["--list"]);
    let rows = list.lines().map(|line| line.split_whitespace().map(String::from).collect::<Vec<_>>());
    rows.filter_map(|row| match row[1].as_str() {
        "tests" => Some((row[2].clone(), row[3..].to_vec())),
        "released" => Some((row[3].clone(), row[4..].to_vec())),
        _ => None,
    })
    .collect()
}

#[test]
fn every_test_that_is_left_to_the_soak_has_one_part() {
    let (tests, filters) = (left_to_the_soak(), filters());
    assert!(tests.len() > 50, "{tests:?}");
    for (program, test) in &tests {
        let is_in = |(of, words): &&(String, Vec<String>)| {
            of == program && words.iter().any(|word| test.contains(word.as_str()))
        };
        assert_eq!(filters.iter().filter(is_in).count(), 1, "{program} {test}");
    }
    for (of, words) in &filters {
        for word in words {
            let is_one = |(program, test): &(String, String)| program == of && test.contains(word.as_str());
            assert!(tests.iter().any(is_one), "{of} has no test {word} for the soak");
        }
    }
}

#[test]
fn parts_of_the_soak_are_scripts_and_functions_that_exist() {
    let text = fs::read_to_string(root().join("scripts/soak.sh")).unwrap();
    for line in soak(&["--list"]).lines() {
        let command = line.split_whitespace().nth(1).unwrap();
        let exists = root().join(command).is_file() || text.contains(&format!("\n{command}() {{"));
        assert!(exists, "{line}");
    }
    let table = soak(&["--log"]);
    let rows = table.lines().filter(|line| line.starts_with('|')).count();
    assert_eq!(rows, 2 + soak(&["--list"]).lines().count(), "{table}");
    let unknown = Command::new(root().join("scripts/soak.sh")).arg("no-such-part").output().unwrap();
    let said = String::from_utf8(unknown.stderr).unwrap();
    assert!(!unknown.status.success() && said.contains("no part no-such-part; expected one of: "), "{said}");
}

#[test]
fn the_log_adds_up_the_words_of_a_revision() {
    let target = tempfile::tempdir().unwrap();
    let write = |revision: &str, part: &str, result: &str, words: &str| {
        let folder = target.path().join("soak").join(revision);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(format!("{part}.result")), format!("{revision} 60 {result}\n")).unwrap();
        let log = format!("kc705: 2 patches\n{words} words compared in 59 s, none different\n");
        fs::write(folder.join(format!("{part}.log")), log).unwrap();
    };
    write("aaa", "words-1", "passed 10", "999");
    write("bbb", "words-1", "passed 20", "203520000");
    write("bbb", "words-2", "passed 30", "1000");
    write("bbb", "words-3", "FAILED 40", "5");
    let log = Command::new(root().join("scripts/soak.sh"))
        .arg("--log")
        .env("CARGO_TARGET_DIR", target.path())
        .output()
        .unwrap();
    let table = String::from_utf8(log.stdout).unwrap();
    for line in [
        "| `words-1` | bbb | 60 | passed, 203,520,000 words |",
        "| `words-2` | bbb | 60 | passed, 1,000 words |",
        "| `words-4` | – | – | not run |",
        "Words compared between circuit and model on bbb: 203,521,000.",
    ] {
        assert!(table.lines().any(|found| found == line), "{line}\n{table}");
    }
    assert!(!table.contains("on aaa"), "{table}");
}
