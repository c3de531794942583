//! Wrong usage: what the parser of options says of it, in words that are not those of Rust.

use crate::ui;
use std::error::Error;
use std::io::Write;
use std::num::{IntErrorKind, ParseFloatError, ParseIntError};

/// Prints what is wrong, or the help that was asked for, and ends the program.
pub fn exit(error: &clap::Error) -> ! {
    if !error.use_stderr() {
        std::process::exit(help(error));
    }
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let plain = error.source().and_then(in_plain_words);
    let (is_object, is_line) = (wants_object(&words), wants_lines(&words));
    if plain.is_none() && !is_object && !is_line {
        error.exit();
    }
    let text = error.render().to_string();
    let text = plain.map_or(text.clone(), |(found, expected)| text.replacen(&found, &expected, 1));
    if is_object {
        let told = serde_json::json!({ "error": in_one_line(&text) });
        let _ = writeln!(std::io::stdout().lock(), "{told:#}");
    }
    if is_line {
        ui::wrong_usage(&in_one_line(&text));
    } else {
        let _ = write!(std::io::stderr().lock(), "{text}");
    }
    std::process::exit(error.exit_code());
}

/// Whether a program reads standard error: `--progress json`.
fn wants_lines(words: &[String]) -> bool {
    words.windows(2).any(|pair| pair == ["--progress", "json"])
        || words.iter().any(|word| word == "--progress=json")
}

/// Whether a program reads the result of a board's command on standard output: `--json` or `--json -`.
fn wants_object(words: &[String]) -> bool {
    let next = |place: usize| words.get(place + 1).is_none_or(|word| word.starts_with('-'));
    let asked =
        words.iter().enumerate().any(|(place, word)| (word == "--json" && next(place)) || word == "--json=-");
    asked && words.get(1).is_some_and(|word| word == "board")
}

/// What is wrong and what is right, without the lines that explain usage.
fn in_one_line(text: &str) -> String {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let own: Vec<&str> =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more")).collect();
    let line = own.join(" ");
    line.strip_prefix("error: ").unwrap_or(&line).to_owned()
}

/// Prints help or the version; gives the exit status.
fn help(text: &clap::Error) -> i32 {
    match text.print().and_then(|()| std::io::stdout().flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            eprintln!("edof: standard output: cannot write: {}", edof_core::storage::atomic::reason(&e));
            1
        }
        _ => 0,
    }
}

/// What the parser says of a text in place of a number, or of a number out of range, and the words to print instead.
fn in_plain_words(source: &(dyn Error + 'static)) -> Option<(String, String)> {
    let text = source.to_string();
    let expected = of_number(source).map(str::to_owned).or_else(|| of_range(&text))?;
    Some((text, expected))
}

/// Words to print instead of `0 is not in 1..=8`.
fn of_range(text: &str) -> Option<String> {
    let (low, high) = text.split_once(" is not in ")?.1.split_once("..")?;
    let largest = high
        .strip_prefix('=')
        .map_or_else(|| high.parse::<u64>().map(|end| end.saturating_sub(1)).ok(), |last| last.parse().ok());
    Some(match largest.filter(|last| *last <= u64::from(u32::MAX)) {
        Some(last) => format!("must be {low} to {last}"),
        None => format!("must be {low} or more"),
    })
}

/// Words to print instead of those of the standard library about a text that it cannot read as a number.
fn of_number(source: &(dyn Error + 'static)) -> Option<&'static str> {
    match source.downcast_ref::<ParseIntError>().map(ParseIntError::kind) {
        Some(IntErrorKind::PosOverflow | IntErrorKind::NegOverflow) => Some("the number is too large"),
        Some(_) => Some("expected a whole number of 0 or more"),
        None => source.downcast_ref::<ParseFloatError>().map(|_| "expected a number"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_expected_in_plain_words() {
        let words = of_number;
        assert_eq!(words(&"x".parse::<u8>().unwrap_err()), Some("expected a whole number of 0 or more"));
        assert_eq!(words(&"256".parse::<u8>().unwrap_err()), Some("the number is too large"));
        assert_eq!(words(&"x".parse::<f64>().unwrap_err()), Some("expected a number"));
        assert_eq!(words(&std::fmt::Error), None);
    }

    #[test]
    fn programs_are_told_in_one_line() {
        let text = "error: unexpected argument '--x' found\n\n  tip: a similar one exists: '--y'\n\nUsage: edof [OPTIONS]\n\nFor more";
        assert_eq!(in_one_line(text), "unexpected argument '--x' found tip: a similar one exists: '--y'");
        let words = |line: &str| -> Vec<String> { line.split(' ').map(str::to_owned).collect() };
        assert!(
            wants_lines(&words("edof train --progress json"))
                && wants_lines(&words("edof train --progress=json"))
        );
        assert!(!wants_lines(&words("edof train --progress text --name json")));
        assert!(
            wants_object(&words("edof board info --json"))
                && wants_object(&words("edof board --json --x info"))
        );
        assert!(
            !wants_object(&words("edof board info --json file"))
                && !wants_object(&words("edof weights x --json"))
        );
    }

    #[test]
    fn limits_are_stated_as_people_state_them() {
        assert_eq!(of_range("0 is not in 3..=99").unwrap(), "must be 3 to 99");
        assert_eq!(of_range("9 is not in 1..5").unwrap(), "must be 1 to 4");
        assert_eq!(of_range("0 is not in 1..18446744073709551615").unwrap(), "must be 1 or more");
        assert_eq!(of_range("0 is not in 1..").unwrap(), "must be 1 or more");
        assert_eq!(of_range("must be a or b"), None);
    }
}
