//! Documents, help and comments are plain technical English: no phrase of a list, no long sentence, no sentence turned round.

mod rules;

use crate::support::Place;
use crate::workspace::root;
use rules::{Offence, offences, phrases};
use std::collections::BTreeMap;
use std::process::Command;

/// Words of the longest sentence of a page. The aim is 25; a sentence with names, units and numbers needs a few more.
const LONGEST: usize = 30;

/// Words of the longest sentence of an option's or a command's help, where one line states meaning, unit, range and default.
const LONGEST_OF_HELP: usize = 45;

/// Pages that may break more rules than none: how many offences they have at most, and why. A number may only fall.
const PAGES: [(&str, usize, &str); 5] = [
    ("docs/decisions/", 95, "records of their day, rewritten when a decision changes"),
    (
        "docs/host.md",
        40,
        "half of it is printed from the register map, whose texts are part of emitted Verilog",
    ),
    ("docs/bring-up.md", 12, "changes with the first board"),
    ("proofs/README.md", 10, "changes with the proofs"),
    ("crates/", 6, "pages for users of the Verilog backend"),
];

/// Phrases in comments of a crate's sources at most; there were 907 when this test was written. A number may only fall. The circuits'
/// comments (`edof-hdl`) are part of emitted Verilog, whose snapshots change with them; in plots (`edof-report`) and scenes (`edof-optics`)
/// lines and shapes are drawn indeed.
const COMMENTS: [(&str, usize); 29] = [
    ("edof-board", 12),
    ("edof-camera", 1),
    ("edof-chips", 2),
    ("edof-cli", 0),
    ("edof-cosim", 150),
    ("edof-deblur", 2),
    ("edof-device", 8),
    ("edof-float", 1),
    ("edof-golden", 10),
    ("edof-gpu", 2),
    ("edof-hdl", 65),
    ("edof-image", 1),
    ("edof-io", 4),
    ("edof-methods", 1),
    ("edof-metrics", 4),
    ("edof-network", 3),
    ("edof-numerics", 2),
    ("edof-optics", 11),
    ("edof-presets", 3),
    ("edof-quantize", 7),
    ("edof-report", 11),
    ("edof-stability", 8),
    ("edof-storage", 2),
    ("edof-study", 15),
    ("edof-train", 7),
    ("edof-verilog", 30),
    ("edof-verilog-derive", 2),
    ("edof-verilog-diff", 5),
    ("tests", 10),
];

/// Text of files that git knows, by path.
fn texts(patterns: &[&str]) -> Vec<(String, String)> {
    let output =
        Command::new("git").arg("ls-files").args(patterns).current_dir(root()).output().unwrap().stdout;
    let files = String::from_utf8(output).unwrap();
    let files = files.lines().filter(|file| root().join(file).exists());
    files.map(|file| (file.to_owned(), std::fs::read_to_string(root().join(file)).unwrap())).collect()
}

/// Offences of a page.
fn of_page(file: &str, text: &str) -> Vec<Offence> {
    // Entries of the changelog are lists of what changed, not sentences.
    offences(text, if file == "CHANGELOG.md" { usize::MAX } else { LONGEST })
}

/// Comments of a source as a page in Markdown, line by line.
fn comments(text: &str) -> String {
    let comment = |line: &str| {
        let line = line.trim_start();
        let text = ["///", "//!", "//"].iter().find_map(|mark| line.strip_prefix(mark))?;
        Some(text.strip_prefix(' ').unwrap_or(text).to_owned() + "\n")
    };
    text.lines().map(|line| comment(line).unwrap_or_else(|| "\n".into())).collect()
}

/// Compares counts with what is allowed: more is a failure, and so is a number that has become too large.
fn check(found: &BTreeMap<String, Vec<String>>, allowed: impl Fn(&str) -> usize) {
    let mut failures = vec![];
    for (name, offences) in found {
        let limit = allowed(name);
        if offences.len() > limit {
            failures.push(format!(
                "{name}: {} offences, {limit} at most:\n{}",
                offences.len(),
                offences.join("\n")
            ));
        }
        if offences.len() + 15 < limit {
            failures.push(format!(
                "{name}: {} offences; lower its limit of {limit} in tests/prose.rs",
                offences.len()
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn pages_are_plain_english() {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in texts(&["*.md"]) {
        // Written by the studies, and compared with what they print.
        if file.starts_with("docs/results/") {
            continue;
        }
        let name = PAGES.iter().find(|(name, ..)| file.starts_with(name)).map_or(&*file, |(name, ..)| name);
        let lines = of_page(&file, &text).into_iter();
        found
            .entry(name.to_owned())
            .or_default()
            .extend(lines.map(|offence| format!("  {file}:{}: {}", offence.line, offence.what)));
    }
    assert!(found.len() > 20, "{} pages", found.len());
    check(&found, |name| PAGES.iter().find(|(page, ..)| *page == name).map_or(0, |(_, limit, _)| *limit));
}

#[test]
fn readme_is_short_and_its_tables_are_narrow() {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(text.lines().count() <= 150, "{} lines", text.lines().count());
    for line in text.lines().filter(|line| line.starts_with('|')) {
        assert!(line.chars().count() <= 100, "{} characters: {line}", line.chars().count());
    }
}

/// Help of a command and of all below it, by the command.
fn help(place: &Place, command: &str, found: &mut Vec<(String, String)>) {
    let text = place.edof(&format!("{command} --help")).done().out;
    let below =
        text.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let is_name = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
    let names: Vec<&str> = below.filter(is_name).filter_map(|line| line.split_whitespace().next()).collect();
    for name in names.into_iter().filter(|name| *name != "help") {
        help(place, format!("{command} {name}").trim(), found);
    }
    found.push((command.to_owned(), text));
}

#[test]
fn help_is_plain_english() {
    let place = Place::new();
    let mut found = vec![];
    help(&place, "", &mut found);
    assert!(found.len() > 50, "{} commands", found.len());
    let mut failures = vec![];
    for (command, text) in found {
        // Lists of commands repeat the help of each; examples are checked by `pages`.
        let commands: Vec<&str> = text.split("\n\n").filter(|part| !part.starts_with("Commands:")).collect();
        let text: String = commands
            .join("\n\n")
            .split("\nExamples:")
            .next()
            .unwrap()
            .lines()
            .map(|line| if line.trim_start().starts_with('-') { "\n" } else { line.trim_start() })
            .map(|line| format!("{line}\n"))
            .collect();
        let lines = offences(&text, LONGEST_OF_HELP).into_iter();
        failures.extend(lines.map(|offence| format!("edof {command}: {}", offence.what)));
    }
    failures.sort();
    failures.dedup();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn comments_have_ever_fewer_phrases_of_our_own() {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (file, text) in texts(&["crates/*.rs", "tests/*.rs", "python/src/*.rs"]) {
        let mut parts = file.split('/');
        let name = match (parts.next().unwrap(), parts.next().unwrap()) {
            // Its list is of these very phrases.
            ("tests", "prose" | "prose.rs") => continue,
            ("crates", name) => name,
            (folder, _) => folder,
        };
        let lines = phrases(&comments(&text)).into_iter();
        found
            .entry(name.to_owned())
            .or_default()
            .extend(lines.map(|offence| format!("  {file}:{}: {}", offence.line, offence.what)));
    }
    check(&found, |name| COMMENTS.iter().find(|(part, _)| *part == name).map_or(0, |(_, limit)| *limit));
}

#[test]
fn planted_offences_are_found_wherever_they_are() {
    let long = "Every word counts ".repeat(12);
    let text = format!(
        "# Head\n\nIt follows. `told` in code is none, a *board that is none* is one.\n\n\
         | a cell | What is left is told. |\n|---|---|\n\n- An item: Whoever reads\n  this goes [on](told.md) reading.\n\n\
         ```\ntold\n```\n\n    told\n\n{long}ends.\n"
    );
    let found = offences(&text, 30);
    let found: Vec<(usize, &str)> =
        found.iter().map(|offence| (offence.line, offence.what.split(':').next().unwrap())).collect();
    assert_eq!(
        found,
        [
            (3, "'that is none'"),
            (3, "'It' after a heading"),
            (5, "'told'"),
            (8, "'goes on'"),
            (8, "'whoever'"),
            (17, "37 words"),
        ]
    );
    assert_eq!(
        offences("# Head\n\nThe unfolded hold-to-date itself, e.g. 1.5 m. A word. `x` is next.\n", 8),
        []
    );
    let source = "/// Says what is told.\nfn told() {}\n    // By lot,\n    // likewise.\n";
    let found: Vec<(usize, String)> =
        phrases(&comments(source)).into_iter().map(|offence| (offence.line, offence.what)).collect();
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(found.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 3, 3]);
}
