//! Rules of plain technical English: phrases that have a plain form, and sentences that are too long.

/// Phrases that are not written, and what is written instead. Spaces stand for any blanks; words match whole, whatever their case.
/// A star at the end stands for the rest of a word.
pub const PHRASES: &[(&str, &str)] = &[
    // Words of our own where the field has one.
    ("told", "printed, reported, listed"),
    ("tells", "prints, states, lists"),
    ("to tell", "to print, to report"),
    ("refuse", "reject"),
    ("refused", "rejected"),
    ("refuses", "rejects"),
    ("refusal*", "rejection"),
    ("gone on with", "resumed"),
    ("goes on", "continues, resumes"),
    ("go on", "continue, resume"),
    ("by lot", "at random"),
    ("drawn", "random (network, window), synthetic (scene, blur)"),
    ("nothing beats", "Pareto-optimal"),
    ("spoilt", "corrupted"),
    ("mend", "fix, repair"),
    ("mended", "fixed, repaired"),
    ("crumbs", "small disconnected components"),
    ("lamps", "LEDs"),
    ("twin", "reference implementation"),
    ("twins", "reference implementations"),
    ("last bits", "LSB"),
    ("processor time", "CPU time"),
    ("processor seconds", "CPU seconds"),
    ("so many", "N"),
    ("of one's own", "custom, user-supplied"),
    ("on the way", "in flight, in progress"),
    ("under way", "in flight, in progress"),
    ("way between clock domains", "clock-domain crossing"),
    ("ways between clock domains", "clock-domain crossings"),
    ("planted", "injected"),
    ("promise", "acceptance limit"),
    ("promised", "guaranteed, limit"),
    ("promises", "acceptance limits"),
    ("light beside", "light next to"),
    // Number per something.
    ("frames a second", "frames per second"),
    ("bits a second", "bits per second"),
    ("seconds a megapixel", "seconds per megapixel"),
    ("s a megapixel", "s per megapixel"),
    ("cycles a patch", "cycles per patch"),
    ("bits a pixel", "bits per pixel"),
    ("bytes a pixel", "bytes per pixel"),
    ("a cycle apart", "one cycle apart"),
    ("values a beat", "values per beat"),
    ("beat a cycle", "beat per cycle"),
    // Turned round.
    ("of which a", "with a, one of them"),
    ("of which the", "…: split the sentence"),
    ("of these, how many", "number of these that"),
    ("likewise", "also, in the same way"),
    ("alike", "in the same way, equal"),
    ("which who", "…: split the sentence"),
    ("whoever", "anybody who, users who"),
    ("whatever else", "everything else that"),
    ("it is this that", "this"),
    ("but for", "except for"),
    ("for want of", "because there is no"),
    ("is of use", "is useful"),
    ("of use", "useful"),
    ("at hand", "available"),
    ("stands beside", "is next to"),
    ("stand beside", "are next to"),
    ("is held to", "is compared with, must equal"),
    ("held to", "compared with, must equal"),
    ("hold to", "compare with"),
    ("has of its own", "has"),
    ("a thing", "an object"),
    ("what is missing", "missing items"),
    ("where none is", "without"),
    ("where there is none", "without one"),
    ("that there is none of", "that does not exist"),
    ("that is none", "that is not one"),
    ("that is no", "that is not a"),
    ("is no number", "is NaN"),
    ("of nobody", "without an owner"),
    ("nobody knows", "unknown"),
    ("nobody asked", "not requested"),
    ("come of", "result from"),
    ("came to be", "was made"),
    ("what it is of", "its key"),
    ("are of one", "belong to one"),
    ("as it likes", "freely"),
    ("when they like", "at random times"),
    ("less so", "less"),
    ("no more than that", "nothing else"),
    ("and no more", "and nothing else"),
];

/// Words that no sentence begins with right after a heading: their noun would be in the heading.
pub const PRONOUNS: [&str; 4] = ["It", "Its", "They", "Their"];

/// Openings of a comment whose noun would be in the code below it: a port or field states what it carries.
pub const SUBJECTS: [&str; 8] =
    ["It", "Its", "They", "Their", "Whether it", "Whether they", "Of these", "Of one"];

/// Openings that turn a sentence round.
pub const OPENINGS: [&str; 5] = ["Refused is", "Refused are", "Of these", "Of one", "Whoever"];

/// A rule that a text breaks: where, and what is wrong with it.
#[derive(Debug, PartialEq)]
pub struct Offence {
    /// Line from 1.
    pub line: usize,
    pub what: String,
}

/// A paragraph, an item of a list, a cell of a table or a heading, without code, links and emphasis.
#[derive(Debug, Default, PartialEq)]
pub struct Block {
    /// First line, from 1.
    pub line: usize,
    pub text: String,
    pub is_cell: bool,
    pub after_heading: bool,
}

/// Text of a line without what is code; a span becomes one word.
fn without_code(line: &str) -> String {
    let mut text = String::new();
    for (index, part) in line.split('`').enumerate() {
        text += if index % 2 == 0 { part } else { "Code" };
    }
    text
}

/// Text without the targets of links and without stars.
fn without_links(text: &str) -> String {
    let mut found = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("](") {
        found += before;
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    (found + rest).replace(['[', ']', '*'], "")
}

/// Blocks of a page in Markdown; fenced and indented code is left out.
pub fn blocks(text: &str) -> Vec<Block> {
    let (mut found, mut open) = (vec![], Block::default());
    let (mut fenced, mut after_heading) = (false, false);
    let close = |open: &mut Block, found: &mut Vec<Block>| {
        let block = std::mem::take(open);
        if !block.text.trim().is_empty() {
            found.push(Block { text: without_links(&without_code(&block.text)), ..block });
        }
    };
    for (index, line) in text.lines().enumerate() {
        let (number, plain) = (index + 1, line.trim());
        let is_item =
            plain.starts_with("- ") || plain.split_once(". ").is_some_and(|(n, _)| n.parse::<u32>().is_ok());
        let is_code = line.starts_with("    ") && open.text.is_empty();
        if plain.starts_with("```") {
            fenced = !fenced;
        }
        if fenced || plain.starts_with("```") || is_code || plain.is_empty() || plain.starts_with("<!--") {
            close(&mut open, &mut found);
        } else if plain.starts_with('|') {
            close(&mut open, &mut found);
            let cells = plain.split('|').map(str::to_owned);
            cells.for_each(|text| {
                close(&mut Block { line: number, text, is_cell: true, after_heading: false }, &mut found);
            });
            after_heading = false;
        } else if plain.starts_with('#') {
            close(&mut open, &mut found);
            let text = plain.trim_start_matches('#').trim().to_owned();
            close(&mut Block { line: number, text, is_cell: true, after_heading: false }, &mut found);
            after_heading = true;
        } else {
            if is_item {
                close(&mut open, &mut found);
            }
            if open.text.is_empty() {
                open = Block { line: number, after_heading, ..Block::default() };
                after_heading = false;
            }
            open.text += plain.trim_start_matches("- ");
            open.text.push(' ');
        }
    }
    close(&mut open, &mut found);
    found
}

/// Sentences of a block: a mark before a blank ends one, unless it belongs to a short form.
pub fn sentences(text: &str) -> Vec<&str> {
    let (mut found, mut start) = (vec![], 0);
    for (at, mark) in text.match_indices(['.', '!', '?']) {
        let end = at + mark.len();
        let is_short = ["e.g", "i.e", "vs"].iter().any(|short| text[..at].ends_with(short));
        if text[end..].starts_with([' ', ')']) && !is_short {
            found.push(text[start..end].trim());
            start = end;
        }
    }
    found.push(text[start..].trim());
    found.retain(|sentence| !sentence.is_empty());
    found
}

/// Words with a letter or a digit in them.
pub fn length(sentence: &str) -> usize {
    sentence.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// Whether a text has a phrase as whole words.
fn has(text: &str, phrase: &str) -> bool {
    let (phrase, open) = phrase.strip_suffix('*').map_or((phrase, false), |stem| (stem, true));
    text.match_indices(phrase).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + phrase.len()..].chars().next();
        let joins = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        !before.is_some_and(joins) && (open || !after.is_some_and(joins))
    })
}

/// Phrases that a text has, each as often as blocks have it.
pub fn phrases(text: &str) -> Vec<Offence> {
    let mut found = vec![];
    for block in blocks(text) {
        let plain = block.text.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
        for (phrase, instead) in PHRASES {
            if has(&plain, phrase) {
                found.push(Offence { line: block.line, what: format!("'{phrase}': {instead}") });
            }
        }
    }
    found
}

/// Comments that begin with a pronoun.
pub fn pronouns(comments: &str) -> Vec<Offence> {
    let mut found = vec![];
    for block in blocks(comments) {
        let is_opening = |subject: &&&str| {
            let rest = block.text.trim_start().strip_prefix(**subject);
            rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        if let Some(subject) = SUBJECTS.iter().find(is_opening) {
            found.push(Offence { line: block.line, what: format!("'{subject} …': name the noun") });
        }
    }
    found
}

/// Everything that a page breaks, sentences of more than `longest` words included.
pub fn offences(text: &str, longest: usize) -> Vec<Offence> {
    let mut found = phrases(text);
    for block in blocks(text) {
        let words = |what: String| Offence { line: block.line, what };
        let first = block.text.split_whitespace().next().unwrap_or_default();
        if block.after_heading && PRONOUNS.contains(&first) {
            found.push(words(format!("'{first}' after a heading: name the noun")));
        }
        for sentence in sentences(&block.text) {
            if let Some(opening) = OPENINGS.iter().find(|opening| sentence.starts_with(*opening)) {
                found.push(words(format!("'{opening} …': put the subject first")));
            }
            if !block.is_cell && length(sentence) > longest {
                let start: Vec<&str> = sentence.split_whitespace().take(6).collect();
                found.push(words(format!("{} words: '{} …'", length(sentence), start.join(" "))));
            }
        }
    }
    found.sort_by_key(|offence| offence.line);
    found
}
