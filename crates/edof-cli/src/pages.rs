//! Commands on pages and in documents, read by the parser that reads those of users.

use crate::Cli;
use clap::Parser;
use clap::error::ErrorKind;
use edof_study::made::OLD;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Markdown files of a folder.
fn pages(folder: &str) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(project().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let markdown = entries.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    markdown.map(|path| (path.display().to_string(), std::fs::read_to_string(path).unwrap())).collect()
}

/// What stands in code: commands in lines of blocks, and spans between backticks, which may name a part of one.
fn code(text: &str) -> (Vec<String>, Vec<String>) {
    let (mut lines, mut paragraphs, mut in_block) = (vec![], String::new(), false);
    let mut begun = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
        } else if in_block {
            // Remarks of the shell, and what is piped on or sent elsewhere.
            let line = [" #", " | ", " > ", " &"]
                .iter()
                .fold(line, |line, end| line.split(end).next().unwrap_or_default());
            begun += line.trim();
            if begun.ends_with('\\') {
                begun.pop();
                continue;
            }
            lines.extend(std::mem::take(&mut begun).split(';').map(|command| command.trim().to_owned()));
        } else {
            paragraphs += line;
            paragraphs.push('\n');
        }
    }
    let spans = paragraphs.split("\n\n").flat_map(|paragraph| paragraph.split('`').skip(1).step_by(2));
    (lines, spans.map(|span| span.split_whitespace().collect::<Vec<_>>().join(" ")).collect())
}

/// Words as a shell parts them; quotes hold blanks together.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![];
    for (index, piece) in line.split('\'').enumerate() {
        if index % 2 == 1 {
            words.push(piece.to_owned());
        } else {
            words.extend(piece.split_whitespace().map(str::to_owned));
        }
    }
    words
}

/// What a command lacks or has too much.
fn wrong(line: &str) -> Option<clap::Error> {
    Cli::try_parse_from(words(line)).err().filter(clap::Error::use_stderr)
}

/// The same of a command that a sentence names: it may leave things out, but what it names must be there.
fn wrong_in_prose(line: &str) -> Option<clap::Error> {
    let left_out = |error: &clap::Error| {
        matches!(error.kind(), ErrorKind::MissingRequiredArgument | ErrorKind::MissingSubcommand)
            || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
            || error.to_string().contains("but none was supplied")
    };
    wrong(line).filter(|error| !left_out(error))
}

/// Sub-commands of `scripts/results.sh`.
fn parts() -> Vec<String> {
    let script = std::fs::read_to_string(project().join("scripts/results.sh")).unwrap();
    let line = script.lines().find_map(|line| line.strip_prefix("parts=\"")).unwrap();
    line.trim_end_matches('"').split(' ').map(str::to_owned).collect()
}

#[test]
fn every_command_that_made_a_page_can_be_run_as_it_stands() {
    let (pages, parts) = (pages("docs/results"), parts());
    assert!(pages.len() > 10);
    for (file, text) in pages {
        for made in text.split("Made by `").skip(1).map(|rest| rest.split('`').next().unwrap()) {
            match made.strip_prefix("scripts/results.sh ") {
                Some(part) => assert!(parts.contains(&part.to_owned()), "{file}: no part {part}"),
                // Pages of old rows state a command without its files.
                None if text.contains(OLD) => assert!(wrong_in_prose(made).is_none(), "{file}: {made}"),
                None => {
                    let error = wrong(made).map(|error| error.to_string());
                    assert!(made.starts_with("edof ") && error.is_none(), "{file}: {made}: {error:?}");
                }
            }
        }
    }
}

#[test]
fn every_command_in_the_documents_is_one() {
    let mut all = pages("docs");
    all.extend(pages("docs/figures").into_iter().chain(pages("docs/results")).chain(pages("docs/decisions")));
    // What the change log names is of its day.
    all.extend(pages(".").into_iter().filter(|(file, _)| !file.ends_with("CHANGELOG.md")));
    let is_ours =
        |line: &&String| line.starts_with("edof ") && !line.contains('…') && !line.contains("COMMAND");
    let (mut count, mut errors) = (0, vec![]);
    for (file, text) in all {
        let (lines, spans) = code(&text);
        let lines = lines.iter().filter(is_ours).map(|line| (line, wrong(line)));
        let spans = spans.iter().filter(is_ours).map(|span| (span, wrong_in_prose(span)));
        for (line, error) in lines.chain(spans) {
            count += 1;
            errors.extend(error.map(|error| format!("{file}: {line}\n{error}")));
        }
    }
    assert!(count > 100 && errors.is_empty(), "{} of {count}:\n{}", errors.len(), errors.join("\n"));
}
