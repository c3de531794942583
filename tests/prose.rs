//! Documents, help and comments are plain technical English: no phrase of a list, no long sentence, no sentence turned round.

mod rules;

use crate::support::Place;
use crate::workspace::root;
use rules::{Offence, offences, phrases, pronouns};
use std::process::Command;

/// Words of the longest sentence of a page. The aim is 25; a sentence with names, units and numbers needs a few more.
const LONGEST: usize = 30;

/// Words of the longest sentence of an option's or a command's help, where one line states meaning, unit, range and default.
const LONGEST_OF_HELP: usize = 45;

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
    offences(&without_verdicts(text), if file == "CHANGELOG.md" { usize::MAX } else { LONGEST })
}

/// A page with an empty line for each that is quoted from a page of results.
fn without_verdicts(text: &str) -> String {
    let mut is_quoted = false;
    let line = |line: &str| {
        is_quoted = (is_quoted || line.starts_with("<!-- verdict: ")) && line != "<!-- end -->";
        if is_quoted { "\n".to_owned() } else { format!("{line}\n") }
    };
    text.lines().map(line).collect()
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

/// Offences with the file that each is in, as lines.
fn named(file: &str, offences: Vec<Offence>) -> impl Iterator<Item = String> {
    offences.into_iter().map(move |offence| format!("{file}:{}: {}", offence.line, offence.what))
}

#[test]
fn pages_are_plain_english() {
    // Pages of results are written by the studies, and compared with what they print.
    let pages: Vec<_> =
        texts(&["*.md"]).into_iter().filter(|(file, _)| !file.starts_with("docs/results/")).collect();
    assert!(pages.len() > 50, "{} pages", pages.len());
    let found: Vec<String> = pages.iter().flat_map(|(file, text)| named(file, of_page(file, text))).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn readme_is_short_and_its_tables_are_narrow() {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(text.lines().count() <= 150, "{} lines", text.lines().count());
    for line in text.lines().filter(|line| line.starts_with('|')) {
        // The longest name of a method has 31 characters.
        assert!(line.chars().count() <= 110, "{} characters: {line}", line.chars().count());
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
        let (about, rest) = text.split_once("\nExamples:").unwrap_or((text.as_str(), ""));
        let rest = rest.split_once("\nUsage:").map_or("", |(_, rest)| rest);
        let parts =
            about.split("\n\n").chain(rest.split("\n\n")).filter(|part| !part.starts_with("Commands:"));
        let text: String = parts
            .flat_map(|part| part.lines().chain([""]))
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
fn comments_are_plain_english() {
    let sources = texts(&["crates/*.rs", "tests/*.rs", "python/src/*.rs", "*.v", "*.sv"]);
    assert!(sources.len() > 500, "{} sources", sources.len());
    // The rules' list is of these very phrases.
    let sources = sources.iter().filter(|(file, _)| !file.starts_with("tests/prose"));
    let found: Vec<String> = sources
        .flat_map(|(file, text)| {
            let comments = comments(text);
            named(file, phrases(&comments).into_iter().chain(pronouns(&comments)).collect())
        })
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn injected_offences_are_found_wherever_they_are() {
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
    let fields =
        "/// It.\npub data: u8,\n/// Item.\npub item: u8,\n/// Whether it is the last.\npub last: bool,\n";
    assert_eq!(pronouns(&comments(fields)).iter().map(|offence| offence.line).collect::<Vec<_>>(), [1, 5]);
}
