//! Names that files give to what they describe: cameras have titles, designs have names that folders and files can have, too.

/// Most characters of a name.
const MAX_LENGTH: usize = 64;

/// Expected of a title, in words.
pub const TITLE: &str = "1 to 64 characters on one line";

/// Expected of a name that becomes a part of paths, in words.
pub const PLAIN: &str = "1 to 64 letters a-z or A-Z, digits, '-', '_' and '.', a letter or digit first";

/// Whether messages and tables can show the name: not blank, one line, no control characters, at most 64 characters.
#[must_use]
pub fn is_title(name: &str) -> bool {
    !name.trim().is_empty() && name.chars().count() <= MAX_LENGTH && !name.chars().any(char::is_control)
}

/// Whether the name can be a part of a path on every system and in every tool.
///
/// ```
/// use edof_core::storage::name::is_plain;
/// assert!(is_plain("kc705-fast_2.1"));
/// assert!(!is_plain("a/b") && !is_plain("..") && !is_plain("my design"));
/// ```
#[must_use]
pub fn is_plain(name: &str) -> bool {
    let legal = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    name.starts_with(|c: char| c.is_ascii_alphanumeric())
        && name.len() <= MAX_LENGTH
        && name.chars().all(legal)
}

/// A wrong name as a message shows it: in quotes, cut, with a mark in place of each control character.
#[must_use]
pub fn quoted(name: &str) -> String {
    let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let start: String = name.chars().take(MAX_LENGTH).map(shown).collect();
    match name.chars().count() {
        0 => "empty".to_owned(),
        length if length > MAX_LENGTH => format!("'{start}…' ({length} characters)"),
        _ => format!("'{start}'"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_one_line_of_something() {
        let longest = "x".repeat(MAX_LENGTH);
        for good in ["clear", "my lens F/2", "линза", &longest] {
            assert!(is_title(good), "{good}");
        }
        for bad in ["", "  ", "a\nb", "bell\u{7}", &(longest + "x")] {
            assert!(!is_title(bad), "{bad}");
        }
    }

    #[test]
    fn plain_names_are_parts_of_paths() {
        for good in ["kc705", "A.b-c_d", "7"] {
            assert!(is_plain(good), "{good}");
        }
        for bad in
            ["", ".", "..", ".hidden", "-x", "a/b", "a\\b", "a b", "a\"b", "a\nb", "设计", &"x".repeat(65)]
        {
            assert!(!is_plain(bad), "{bad}");
        }
    }

    #[test]
    fn wrong_names_are_shown_on_one_line() {
        assert_eq!(quoted(""), "empty");
        assert_eq!(quoted("a\nb"), "'a\u{fffd}b'");
        assert_eq!(quoted(&"x".repeat(99)), format!("'{}…' (99 characters)", "x".repeat(64)));
    }
}
