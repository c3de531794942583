//! Indentation, and no line longer than it should be.

/// A line of a module is at most so long, where it can be broken.
pub(crate) const WIDTH: usize = 112;

/// Columns by which the rest of a broken line stands further right.
const HANGING: usize = 4;

/// Between a line of text and the number of the Rust line that it comes from.
pub(crate) const PLACE: char = '\u{1}';

/// The line without its place.
pub(crate) fn code(line: &str) -> &str {
    line.split(PLACE).next().unwrap_or_default()
}

/// The text with two columns an indentation, in place of the four of its parts, and with long lines broken; and the Rust line that each
/// line comes from, where that is known.
pub(crate) fn lay_out(text: &str) -> (String, Vec<Option<usize>>) {
    let (mut all, mut places) = (String::new(), vec![]);
    for line in text.lines() {
        let place = line.split_once(PLACE).and_then(|(_, number)| number.parse().ok());
        for line in lines(code(line)) {
            all += line.trim_end();
            all.push('\n');
            places.push(place);
        }
    }
    (all, places)
}

fn lines(line: &str) -> Vec<String> {
    let inner = line.trim_start();
    let indent = (line.len() - inner.len()) / 2;
    match inner.strip_prefix("//") {
        Some(comment) => commented(comment, indent),
        None => broken(inner, indent),
    }
}

/// A comment, broken between words.
pub(crate) fn commented(comment: &str, indent: usize) -> Vec<String> {
    let space = " ".repeat(indent);
    let text = comment.trim_start();
    let marker = format!("{space}//{}", " ".repeat((comment.len() - text.len()).max(1)));
    let mut lines = vec![];
    let mut line = marker.clone();
    for word in text.split_whitespace() {
        if line.len() + word.len() > WIDTH && line.len() > marker.len() {
            lines.push(std::mem::replace(&mut line, marker.clone()).trim_end().to_string());
        }
        line += word;
        line.push(' ');
    }
    lines.push(line.trim_end().to_string());
    lines
}

/// A line of code, broken before an operator or after a comma that stands in as few brackets as can be.
fn broken(code: &str, indent: usize) -> Vec<String> {
    let mut lines = vec![];
    let (mut rest, mut indent) = (code.to_string(), indent);
    while indent + rest.len() > WIDTH {
        let Some(at) = place(&rest, WIDTH - indent) else { break };
        let (line, after) = rest.split_at(at);
        lines.push(format!("{}{}", " ".repeat(indent), line.trim_end()));
        let after = after.trim_start().to_string();
        indent += if lines.len() == 1 { HANGING } else { 0 };
        rest = after;
    }
    lines.push(" ".repeat(indent) + &rest);
    lines
}

/// Where to break: the last of the outermost places that leave at most `room` columns before them.
fn place(code: &str, room: usize) -> Option<usize> {
    let min = room / 3;
    let (mut depth, mut quoted, mut best) = (0_usize, false, None::<(usize, usize)>);
    for (at, letter) in code.char_indices() {
        if at > room {
            break;
        }
        match letter {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '(' | '{' | '[' => depth += 1,
            ')' | '}' | ']' => depth = depth.saturating_sub(1),
            ' ' => {
                let next = code[at + 1..].split(' ').next().unwrap_or_default();
                let operator = ["&&", "||", "?", ":", "|", "^", "&", "+", "-"].contains(&next);
                let comma = code[..at].ends_with(',');
                let outer = best.is_none_or(|(best, _)| depth <= best);
                if (operator || comma) && outer && at >= min {
                    best = Some((depth, at + 1));
                }
            }
            _ => {}
        }
    }
    best.map(|(_, at)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_breaks_before_an_outer_operator() {
        let term = |n: usize| format!("(signal_number_{n} || another_{n})");
        let long = format!("        assign x = {};", (0..6).map(term).collect::<Vec<_>>().join(" && "));
        let lines = lines(&long);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= WIDTH), "{lines:#?}");
        assert!(lines[1].starts_with("        && ("), "{lines:#?}");
        assert_eq!(lines.concat().replace(' ', ""), long.replace(' ', ""));
    }

    #[test]
    fn a_long_comment_breaks_between_words() {
        let lines = lines(&format!("    // {}", "word ".repeat(40)));
        assert!(lines.iter().all(|line| line.starts_with("  // word") && line.len() <= WIDTH), "{lines:#?}");
    }
}
