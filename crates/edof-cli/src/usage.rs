//! Wrong usage: what the parser of options says of it, in words that are not those of Rust.

use std::error::Error;
use std::io::Write;
use std::num::{IntErrorKind, ParseFloatError, ParseIntError};

/// Prints what is wrong, or the help that was asked for, and ends the program.
pub fn exit(error: &clap::Error) -> ! {
    if !error.use_stderr() {
        std::process::exit(help(error));
    }
    let Some((found, expected)) = error.source().and_then(in_plain_words) else { error.exit() };
    eprint!("{}", error.render().to_string().replacen(&found, &expected, 1));
    std::process::exit(error.exit_code());
}

/// Prints help or the version; gives the exit status.
fn help(text: &clap::Error) -> i32 {
    match text.print().and_then(|()| std::io::stdout().flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            eprintln!("edof: standard output: cannot write: {e}");
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
    fn limits_are_stated_as_people_state_them() {
        assert_eq!(of_range("0 is not in 3..=99").unwrap(), "must be 3 to 99");
        assert_eq!(of_range("9 is not in 1..5").unwrap(), "must be 1 to 4");
        assert_eq!(of_range("0 is not in 1..18446744073709551615").unwrap(), "must be 1 or more");
        assert_eq!(of_range("0 is not in 1..").unwrap(), "must be 1 or more");
        assert_eq!(of_range("must be a or b"), None);
    }
}
