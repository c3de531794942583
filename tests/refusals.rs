//! Everything that a user can get wrong is rejected: exit status 1 (or 2 for wrong usage), one line that names file, field, value and
//! remedy, nothing written, in little time and memory. The tables in `refusals/` have a row for each case.
//!
//! A line without indentation begins a command. Each indented line continues it: `OPTIONS => PATTERN`, where the parts of a pattern stand
//! in the message in this order, with ` .. ` for any text between them; a pattern that begins with `error:` is wrong usage. Options
//! without a pattern stand in one line with ` | ` between them, `-` for none: any single line will do. After `edit FILE: COMMAND` a
//! row is `FIELD = JSON => PATTERN`, and the command reads `edited.json`, which is the file with that value in that field (none removes it).

mod fixture;

use crate::support::{Place, Run};
use fixture::{edited, ready};

/// A command that is rejected.
struct Row {
    line: String,
    /// Parts of the message in order; none where any message will do.
    pattern: Option<String>,
    /// Text of `edited.json`.
    edited: Option<String>,
}

fn rows(table: &str) -> Vec<Row> {
    let (mut rows, mut head) = (vec![], "");
    for line in table.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if !line.starts_with(' ') {
            head = line;
            continue;
        }
        let line = line.trim();
        let row = |options: &str, pattern: Option<&str>| {
            let line = format!("{head} {options}");
            Row { line, pattern: pattern.map(str::to_owned), edited: None }
        };
        if let Some((file, command)) = head.strip_prefix("edit ").and_then(|head| head.split_once(": ")) {
            let (field, rest) = line.split_once(" = ").unwrap_or_else(|| panic!("{line}: no ' = '"));
            let (value, pattern) = rest.split_once("=> ").unwrap_or_else(|| panic!("{line}: no '=> '"));
            let pattern = Some(format!("edited.json .. {pattern}"));
            rows.push(Row {
                line: command.to_owned(),
                pattern,
                edited: Some(edited(file, field, value.trim())),
            });
        } else if let Some((options, pattern)) = line.split_once("=> ") {
            rows.push(row(options, Some(pattern)));
        } else {
            rows.extend(
                line.split(" | ").map(|options| row(if options == "-" { "" } else { options }, None)),
            );
        }
    }
    assert!(rows.len() > 10, "{} rows", rows.len());
    rows
}

/// The first part of a pattern that the message does not contain after the parts before it.
fn missing<'a>(pattern: &'a str, message: &str) -> Option<&'a str> {
    pattern
        .split(" .. ")
        .try_fold(message, |rest, part| rest.split_once(part).map(|(_, rest)| rest).ok_or(part))
        .err()
}

/// What a message has of Rust, or of numbers that nobody reads.
fn of_rust(message: &str) -> Option<&'static str> {
    const WORDS: [&str; 18] = [
        "os error",
        "Unsupported(",
        "Some(",
        "None",
        "Ok(",
        "Err(",
        "Line(",
        "Sampled(",
        "Phase {",
        "f32",
        "f64",
        "usize",
        "u32",
        " struct ",
        " enum ",
        "unknown variant",
        "panicked",
        "\\u{",
    ];
    let digits = message.split(|c: char| !c.is_ascii_digit()).map(str::len).max().unwrap_or(0);
    WORDS
        .into_iter()
        .find(|word| message.contains(word))
        .or((digits > 20).then_some("a number of more than twenty digits"))
}

/// What is wrong with a rejection.
fn fault(run: &Run, pattern: Option<&str>) -> Option<String> {
    let is_usage = pattern.map_or(run.code == Some(2), |pattern| pattern.starts_with("error:"));
    let (code, beginning) = if is_usage { (2, "error: ") } else { (1, "edof: ") };
    let has_beginning = |line: &&str| line.starts_with("edof: ") || line.starts_with("error: ");
    let pattern = pattern.map(|pattern| pattern.trim_start_matches("error:").trim_start());
    if run.code != Some(code) {
        Some(format!("status {:?}, expected {code}", run.code))
    } else if !run.err.starts_with(beginning) || run.err.lines().filter(has_beginning).count() != 1 {
        Some(format!("expected one line that begins with {beginning:?}"))
    } else if !is_usage && run.err.lines().count() != 1 {
        // Wrong usage comes with a hint at the right one.
        Some("more than one line".to_owned())
    } else if !run.out.is_empty() {
        Some("something on standard output".to_owned())
    } else if let Some(part) = pattern.and_then(|pattern| missing(pattern, &run.err)) {
        Some(format!("without {part:?} there"))
    } else {
        of_rust(&run.err).map(|word| format!("with {word:?}"))
    }
}

/// Runs each row in a place; none may change a file there.
#[track_caller]
pub fn check(place: &Place, table: &str) {
    let mut faults = vec![];
    for Row { line, pattern, edited } in rows(table) {
        if let Some(text) = &edited {
            place.write("edited.json", text);
        }
        let before = place.snapshot();
        // On a slow machine progress would be a line of its own.
        let run = place.edof_within_bounds(&format!("{line} --quiet"));
        let changed = (place.snapshot() != before).then(|| "files changed".to_owned());
        if let Some(fault) = fault(&run, pattern.as_deref()).or(changed) {
            let edited = edited.unwrap_or_default();
            faults.push(format!("edof {line} {edited}\n    {fault}: {}{}", run.out, run.err));
        }
    }
    assert!(faults.is_empty(), "{} rows:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn messages_name_file_field_value_and_remedy() {
    check(&ready(), include_str!("refusals/messages.txt"));
}

#[test]
fn fields_of_cameras_and_designs_have_limits() {
    check(&ready(), include_str!("refusals/fields.txt"));
}

#[test]
fn options_reject_what_they_cannot_have() {
    check(&ready(), include_str!("refusals/values.txt"));
}

#[test]
fn no_output_replaces_an_input_or_another_output() {
    check(&ready(), include_str!("refusals/outputs.txt"));
}

/// Each command of `files.txt` with each of these in the place of the file that it reads.
#[test]
fn no_command_takes_a_file_of_another_kind() {
    const WRONG: [&str; 13] = [
        "no-such-file",
        "nothing",
        "text",
        "garbage",
        "folder",
        "half.png",
        "half.safetensors",
        "half.json",
        "other.json",
        "list.json",
        "/dev/null",
        "/dev/zero",
        "waiting",
    ];
    let commands = include_str!("refusals/files.txt").lines();
    let rows = commands
        .flat_map(|command| WRONG.map(|wrong| format!("{}\n    => {wrong}\n", command.replace("{}", wrong))));
    check(&ready(), &rows.collect::<String>());
}

#[test]
fn a_rejection_with_a_fault_is_found() {
    let run = |code, err: &str| Run { code: Some(code), out: String::new(), err: err.to_owned() };
    let pattern = Some("a.json .. size .. 3 .. 1 to 2");
    assert_eq!(fault(&run(1, "edof: a.json: size 3: must be 1 to 2\n"), pattern), None);
    for (code, err, found) in [
        (0, "edof: a.json: size 3: must be 1 to 2\n", "status Some(0), expected 1"),
        (1, "edof: size 3 in a.json: must be 1 to 2\n", "without \"size\" there"),
        (
            1,
            "edof: a.json: size 3: must be 1 to 2\nedof: more\n",
            "expected one line that begins with \"edof: \"",
        ),
        (1, "edof: a.json: size Some(3): must be 1 to 2\n", "with \"Some(\""),
    ] {
        assert_eq!(fault(&run(code, err), pattern).as_deref(), Some(found));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.fixed_network("net.safetensors");
    let binary = env!("CARGO_BIN_EXE_edof");
    let before = place.files();
    // No file may grow at all. The signal that comes with it, if nobody ignores it, ends a program that does not expect it.
    for ignored in ["trap '' XFSZ;", ""] {
        let script = format!(
            "{ignored} ulimit -f 0; exec {binary} reconstruct raw.png --weights net.safetensors --out out.png"
        );
        let mut shell = std::process::Command::new("sh");
        let run: Run = shell.args(["-c", &script]).current_dir(place.path("")).output().unwrap().into();
        assert!(!run.err.contains(".partial"), "{}", run.err);
        run.refused(&["out.png: cannot write: File too large; the shell (ulimit -f)"]);
        assert_eq!(place.files(), before, "{ignored}");
    }
    let run = place.edof("reconstruct raw.png --weights net.safetensors --out out.png --json /dev/full");
    let expected =
        "edof: /dev/full: cannot write: No space left on device; make room there, or name another place\n";
    assert_eq!((run.code, run.err.as_str()), (Some(1), expected));
}

#[test]
fn unreadable_photographs_among_good_ones_are_named_skipped_and_counted() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.write("photos/b.png", "no picture");
    place.write("photos/c.ppm", "P6 40 40 255\nhalf");
    let run = place.edof(
        "train --form two-sided,w8,t2,c8 --camera clear --images photos --depths 1 --steps 4 --batch 64 --validate-every 2 --out net.safetensors",
    ).done();
    assert!(run.err.contains("skipped photos/b.png: not a PNG"), "{}", run.err);
    assert!(run.err.contains("skipped photos/c.ppm: damaged"), "{}", run.err);
    assert!(run.err.contains("2 of 3 photographs skipped"), "{}", run.err);
    assert_eq!(place.files(), ["net.safetensors", "photos"]);
}
