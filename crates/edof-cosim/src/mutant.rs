//! A fault in one line of Verilog, which a test should notice (`proofs/mutants.py`).

use crate::Source;
use crate::error::{Error, at};
use serde::Deserialize;
use std::borrow::Cow;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// One changed line of a module.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mutant {
    /// The module, without what its sizes add to its name.
    module: String,
    /// The line as it stands.
    line: String,
    /// Which of several such lines, from 0.
    place: usize,
    /// The line that takes its place.
    mutated: String,
}

/// The design as a simulator shall see it: with the mutant that the file `$EDOF_MUTANT` describes, if it has such a line. The names of its
/// modules go to the file `$EDOF_MODULES`.
///
/// # Errors
/// A file cannot be read or written, or describes no mutant.
pub fn simulated(source: &Source) -> Result<Cow<'_, Source>, Error> {
    if let Some(path) = std::env::var_os("EDOF_MODULES") {
        note_modules(source, Path::new(&path))?;
    }
    match std::env::var_os("EDOF_MUTANT") {
        Some(path) => Ok(Mutant::read(Path::new(&path))?.applied(source)),
        None => Ok(Cow::Borrowed(source)),
    }
}

/// Where models of a mutant are kept: beside its file, with which they go.
#[must_use]
pub fn folder() -> Option<PathBuf> {
    Some(Path::new(&std::env::var_os("EDOF_MUTANT")?).parent()?.to_owned())
}

fn note_modules(source: &Source, path: &Path) -> Result<(), Error> {
    let names: String = source.file_names().map(|name| format!("{}\n", module(name))).collect();
    let file = OpenOptions::new().append(true).create(true).open(path);
    file.and_then(|mut file| file.write_all(names.as_bytes())).map_err(at(path))
}

impl Mutant {
    fn read(path: &Path) -> Result<Self, Error> {
        let text = fs::read(path).map_err(at(path))?;
        serde_json::from_slice(&text).map_err(std::io::Error::from).map_err(at(path))
    }

    fn applied<'a>(&self, source: &'a Source) -> Cow<'a, Source> {
        let files = source.files.iter().enumerate().filter(|(_, (name, _))| module(name) == self.module);
        let mut changed = files.filter_map(|(file, (_, text))| Some((file, self.changed(text)?)));
        let Some((file, text)) = changed.next() else { return Cow::Borrowed(source) };
        let mut mutated = source.clone();
        mutated.files[file].1 = text;
        Cow::Owned(mutated)
    }

    /// A module's text with the mutant, if it has the line, or a constant of that name.
    fn changed(&self, text: &str) -> Option<String> {
        let mut lines: Vec<&str> = text.lines().collect();
        let same = (0..lines.len()).filter(|&line| lines[line] == self.line).nth(self.place);
        let (line, changed) = match same {
            Some(line) => (line, self.mutated.clone()),
            None => (0..lines.len()).find_map(|line| Some((line, self.constant(lines[line])?)))?,
        };
        lines[line] = &changed;
        Some(lines.join("\n") + "\n")
    }

    /// The same constant in a module of another size, off by as much.
    fn constant(&self, line: &str) -> Option<String> {
        let [was, is, other] = [&self.line, &self.mutated, line].map(Constant::of);
        let (was, is, other) = (was?, is?, other?);
        (was.name == is.name && was.name == other.name)
            .then(|| other.with(other.value.wrapping_add(is.value).wrapping_sub(was.value)))
    }
}

/// A line of the form `localparam [12:0] NAME = 13'd50;`.
struct Constant<'a> {
    /// All before the value.
    name: &'a str,
    bits: u32,
    value: u64,
}

impl<'a> Constant<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let (name, value) = line.strip_suffix(';')?.split_once(" = ")?;
        let (bits, digits) = value.split_once('\'')?;
        let radix = if digits.starts_with('h') { 16 } else { 10 };
        let value = u64::from_str_radix(digits.strip_prefix(['d', 'h'])?, radix).ok()?;
        let bits = bits.parse().ok().filter(|bits| (1..=64).contains(bits))?;
        name.trim_start().starts_with("localparam ").then_some(Self { name, bits, value })
    }

    fn with(&self, value: u64) -> String {
        format!("{} = {}'d{};", self.name, self.bits, value & u64::MAX >> (64 - self.bits))
    }
}

/// The name of a file's module without what its sizes add: `write_agent` of `write_agent_w512_s64.v`.
fn module(file: &str) -> &str {
    let mut name = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    while let Some((stem, size)) = name.rsplit_once('_') {
        let is_size =
            size.len() > 1 && size.starts_with(['w', 's']) && size[1..].bytes().all(|b| b.is_ascii_digit());
        if !is_size {
            break;
        }
        name = stem;
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source() -> Source {
        let text = "module m_w8;\n  a <= b;\n  a <= b;\nendmodule\n";
        Source { top: "m_w8".into(), files: vec![("m_w8.v".into(), text.into())], ports: vec![] }
    }

    fn mutant(module: &str, place: usize) -> Mutant {
        let (line, mutated) = ("  a <= b;".into(), "  ;".into());
        Mutant { module: module.into(), line, place, mutated }
    }

    #[test]
    fn the_line_at_that_place_is_changed_whatever_the_sizes() {
        let source = source();
        let mutated = mutant("m", 1).applied(&source).into_owned();
        assert_eq!(mutated.files[0].1, "module m_w8;\n  a <= b;\n  ;\nendmodule\n");
    }

    #[test]
    fn a_design_without_the_module_or_the_line_stays_as_it_is() {
        let source = source();
        for other in [mutant("n", 0), mutant("m", 2)] {
            assert!(matches!(other.applied(&source), Cow::Borrowed(same) if *same == source));
        }
    }

    #[test]
    fn a_constant_of_another_size_is_off_by_as_much() {
        let text = "module m_w16;\n  localparam [3:0] A = 4'd3;\n  localparam [3:0] B = 4'hf;\nendmodule\n";
        let source =
            Source { top: "m_w16".into(), files: vec![("m_w16.v".into(), text.into())], ports: vec![] };
        let changed = |line: &str, mutated: &str| {
            let mutant = Mutant { module: "m".into(), line: line.into(), place: 0, mutated: mutated.into() };
            mutant.applied(&source).into_owned().files[0].1.clone()
        };
        let text = changed("  localparam [3:0] B = 4'h8;", "  localparam [3:0] B = 4'd10;");
        assert_eq!(text, source.files[0].1.replace("4'hf", "4'd1"));
        // Another name, another width, and no constant.
        for (line, mutated) in [
            ("  localparam [3:0] C = 4'd8;", "  localparam [3:0] C = 4'd9;"),
            ("  localparam [4:0] B = 5'd8;", "  localparam [4:0] B = 5'd9;"),
            ("  b <= 4'd8;", "  b <= 4'd9;"),
        ] {
            assert_eq!(changed(line, mutated), source.files[0].1);
        }
    }

    #[test]
    fn sizes_are_no_part_of_a_modules_name() {
        for (file, name) in [
            ("write_agent_w512_s64.v", "write_agent"),
            ("edof_add4.v", "edof_add4"),
            ("a_w.v", "a_w"),
            ("sw_1.sv", "sw_1"),
        ] {
            assert_eq!(module(file), name);
        }
    }
}
