//! JSON that a person wrote: read up to a limit, with or without a byte-order mark, and what is wrong with it in plain words.

use crate::storage::input;
use serde::de::DeserializeOwned;
use std::fmt;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

/// What some editors write before a file's text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of a file of at most `max` bytes, without a byte-order mark.
///
/// # Errors
/// What the system says, no UTF-8, the limit that the file exceeds, or that it is no regular file.
pub fn text(path: &Path, max: u64) -> Result<String, Error> {
    let mut bytes = vec![];
    input::open(path)?.take(max + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        return Err(Error::new(
            ErrorKind::InvalidData,
            format!("larger than {}, which no such file is", size(max)),
        ));
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        Error::new(ErrorKind::InvalidData, format!("not text: byte {at} is no UTF-8"))
    })
}

/// JSON text without the value that is expected: the field, what is wrong with it, and its place.
#[derive(Debug, thiserror::Error)]
pub struct JsonError {
    /// Names from the outside to the inside, as in `stages[0].lanes`; empty for the whole text.
    field: String,
    source: serde_json::Error,
}

impl fmt::Display for JsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gap = if self.field.is_empty() { "" } else { ": " };
        write!(f, "{}{gap}{}", self.field, words(&self.source))
    }
}

impl JsonError {
    fn new(path: &serde_path_to_error::Path, source: serde_json::Error) -> Self {
        // A value without a place, as at the end of the text, is a question mark.
        let path = path.to_string();
        let path = path.trim_end_matches('?').trim_end_matches('.');
        let (outside, inside) = path.rsplit_once('.').unwrap_or(("", path));
        // The reason names a field that is unknown or there twice.
        let field = if reason(&source).contains(&format!(" field `{inside}`")) { outside } else { path };
        Self { field: field.trim_start_matches('.').to_owned(), source }
    }
}

/// Reads a value from JSON text, with or without a byte-order mark.
///
/// # Errors
/// The first field whose value is not the expected one.
pub fn parse<T: DeserializeOwned>(text: &str) -> Result<T, JsonError> {
    let mut reader = serde_json::Deserializer::from_str(text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text));
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|e| {
        let path = e.path().clone();
        JsonError::new(&path, e.into_inner())
    })?;
    reader.end().map_err(|source| JsonError { field: String::new(), source })?;
    Ok(value)
}

/// A limit of bytes as people write it.
#[must_use]
pub fn size(bytes: u64) -> String {
    match bytes {
        b if b >= 1 << 30 && b.is_multiple_of(1 << 30) => format!("{} GiB", b >> 30),
        b if b >= 1 << 20 && b.is_multiple_of(1 << 20) => format!("{} MiB", b >> 20),
        b if b >= 1 << 10 && b.is_multiple_of(1 << 10) => format!("{} KiB", b >> 10),
        1 => "1 byte".to_owned(),
        b => format!("{b} bytes"),
    }
}

/// What is wrong with JSON, without the names that Rust has for its types.
///
/// ```
/// let error = serde_json::from_str::<Vec<f64>>("[1, {}]").unwrap_err();
/// assert_eq!(edof_core::storage::json::words(&error), "an object, expected a number, at line 1 column 4");
/// ```
#[must_use]
pub fn words(error: &serde_json::Error) -> String {
    let (reason, place) = (reason(error), place(error));
    if reason == EMPTY || !error.to_string().ends_with(&place) { reason } else { format!("{reason},{place}") }
}

/// What is wrong with JSON that has one line, without the place.
#[must_use]
pub fn reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.strip_suffix(&place(error)).unwrap_or(&text) {
        "trailing characters" => "extra text after the end of the JSON".to_owned(),
        "expected value" | "expected ident" => {
            "no JSON value (texts need quotes; NaN and Infinity are not JSON)".to_owned()
        }
        told if told.starts_with("EOF while parsing") && error.column() == 0 && error.line() == 1 => {
            EMPTY.to_owned()
        }
        told if told.starts_with("EOF while parsing") => "ends too early".to_owned(),
        told => match told.strip_prefix("invalid type: ").or_else(|| told.strip_prefix("invalid value: ")) {
            Some(rest) => found_and_expected(rest),
            None => match told.strip_prefix("invalid length ") {
                Some(rest) => format!("a list of {}", found_and_expected(rest)),
                None => told.replace("variant", "value"),
            },
        },
    }
}

/// Said of a file of no bytes, which has no place.
const EMPTY: &str = "ends too early: the file is empty";

/// The end of an error's text that states its place.
fn place(error: &serde_json::Error) -> String {
    format!(" at line {} column {}", error.line(), error.column())
}

/// `map, expected f64` in words.
fn found_and_expected(text: &str) -> String {
    let (found, expected) = text.split_once(", expected ").unwrap_or((text, ""));
    let quoted = || found.split_once('`').and_then(|(_, rest)| rest.strip_suffix('`')).map(str::to_owned);
    let found = match found {
        "map" => "an object".to_owned(),
        "sequence" => "a list".to_owned(),
        "unit value" | "null" => "null".to_owned(),
        found if found.starts_with("string ") => format!("the text {}", &found["string ".len()..]),
        found => quoted().unwrap_or_else(|| found.to_owned()),
    };
    if expected.is_empty() { found } else { format!("{found}, expected {}", kind(expected)) }
}

/// What is expected, by what Rust calls it.
fn kind(expected: &str) -> String {
    let number_in = |text: &str| text.split(' ').find_map(|word| word.parse::<usize>().ok());
    match expected {
        "f32" | "f64" => "a number".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of 0 or more".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "a sequence" => "a list".into(),
        "a map" | "map" => "an object".into(),
        "a boolean" => "true or false".into(),
        "a string" | "a borrowed string" | "path string" => "a text".into(),
        "unit variant" | "variant identifier" | "string or map" => {
            "one of the names that the field can have".into()
        }
        text if text.starts_with("struct ") || text.starts_with("internally tagged") => "an object".into(),
        text if text.starts_with("enum ") => "one of the names that the field can have".into(),
        text if text.starts_with("struct variant") => "an object".into(),
        text if text.starts_with("an array of")
            || text.starts_with("a tuple of")
            || text.starts_with("tuple ") =>
        {
            number_in(text).map_or_else(|| "a list".into(), |n| format!("a list of {n}"))
        }
        text => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code, reason = "only read from text")]
    struct Thing {
        size: usize,
        pair: [f64; 2],
        kind: Kind,
        names: Vec<String>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Kind {
        Big,
    }

    const NO_VALUE: &str =
        "size: no JSON value (texts need quotes; NaN and Infinity are not JSON), at line 1 column 10";
    /// A whole value, and text that an editor left after it.
    const WHOLE_AND_MORE: &str = "{\"size\": 1, \"pair\": [1, 2], \"kind\": \"big\", \"names\": []}\n }";

    fn refused(text: &str) -> String {
        parse::<Thing>(text).unwrap_err().to_string()
    }

    #[test]
    fn words_of_an_error_name_no_type_of_rust() {
        for (text, told) in [
            ("{\"names\": [\"a\", 2]}", "names[1]: 2, expected a text, at line 1 column 17"),
            ("[]", "a list of 0, expected an object, at line 1 column 2"),
            ("3", "3, expected an object, at line 1 column 1"),
            ("{\"size\": -1}", "size: -1, expected a whole number of 0 or more, at line 1 column 11"),
            ("{\"size\": 1.5}", "size: 1.5, expected a whole number of 0 or more, at line 1 column 12"),
            ("{\"pair\": [1]}", "pair: a list of 1, expected a list of 2, at line 1 column 12"),
            ("{\"pair\": {}}", "pair: an object, expected a list of 2, at line 1 column 9"),
            ("{\"kind\": \"small\"}", "kind: unknown value `small`, expected `big`, at line 1 column 16"),
            ("{\"names\": \"x\"}", "names: the text \"x\", expected a list, at line 1 column 13"),
            ("", "ends too early: the file is empty"),
            ("{\"size\": NaN", NO_VALUE),
            (WHOLE_AND_MORE, "extra text after the end of the JSON, at line 2 column 2"),
            ("{\"size\": 1", "ends too early, at line 1 column 10"),
            (
                "{\"sizes\": 1}",
                "unknown field `sizes`, expected one of `size`, `pair`, `kind`, `names`, at line 1 column 8",
            ),
        ] {
            assert_eq!(refused(text), told, "{text}");
        }
    }

    #[test]
    fn a_byte_order_mark_is_passed_over() {
        let thing: Vec<u8> = parse("\u{feff}[1, 2]").unwrap();
        assert_eq!(thing, [1, 2]);
    }

    #[test]
    fn a_file_over_the_limit_is_rejected_with_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        std::fs::write(&path, [b'a', 0xff]).unwrap();
        assert_eq!(text(&path, 1 << 20).unwrap_err().to_string(), "not text: byte 1 is no UTF-8");
        assert_eq!(text(&path, 1).unwrap_err().to_string(), "larger than 1 byte, which no such file is");
    }
}
