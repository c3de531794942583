//! What an output may replace: a file of its own kind, known by its content. A result must not take the place of a photograph whose name
//! was given by mistake.

use edof_core::storage::input;
use edof_io::picture::Format;
use edof_io::raw::{self, RawFormat};
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};
use std::io::{BufReader, Read};
use std::path::Path;

/// Kind of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// What `--json` writes.
    Result,
    /// JSON beside a raw frame.
    Record,
    /// A design.
    Design,
    /// An HTML report.
    Report,
    /// Comma-separated values.
    Table,
    /// Tables in Markdown.
    Markdown,
    /// A plot.
    Svg,
    /// What continuous integration reads.
    Junit,
    /// A picture of any format.
    Picture,
    /// A network or a dictionary.
    Weights,
    /// A correction of a sensor.
    Sensor,
    /// Pixels without a header.
    Pixels,
    /// A raw frame of another format, by the name of its files.
    Raw(&'static str),
    /// Kept by other means, or of no kind that can be known.
    Any,
}

/// Bytes that are read to know a file.
const HEAD: u64 = 1 << 16;

impl Kind {
    /// The kind of what an option writes; where the option has no kind of its own, by the name of the file.
    pub fn of(option: &str, file: &Path) -> Self {
        match option {
            "--json" => Self::Result,
            "--report" => Self::Report,
            "--csv" => Self::Table,
            "--markdown" => Self::Markdown,
            "--plot" => Self::Svg,
            "--junit" => Self::Junit,
            "--video" | "--board" => Self::Pixels,
            _ if option.starts_with("the record beside") => Self::Record,
            _ => Self::of_ending(file),
        }
    }

    fn of_ending(file: &Path) -> Self {
        if Format::of_ending(file).is_some() {
            return Self::Picture;
        }
        match (file.extension().and_then(|ending| ending.to_str()), raw::of_ending(file)) {
            (_, Some(RawFormat { read: raw::Read::Headerless(_), .. })) | (Some("yuyv"), _) => Self::Pixels,
            (_, Some(format)) => Self::Raw(format.noun),
            (Some("html"), _) => Self::Report,
            (Some("svg"), _) => Self::Svg,
            _ => Self::Any,
        }
    }

    /// What a file holds in place of this kind; none where it may be replaced.
    pub fn refusal(self, file: &Path) -> Option<&'static str> {
        if self == Self::Any || !std::fs::metadata(file).is_ok_and(|what| what.is_file() && what.len() > 0) {
            return None;
        }
        let mut head = vec![];
        let read = input::open(file).and_then(|file| file.take(HEAD).read_to_end(&mut head));
        let is_alike = read.is_ok() && self.is_alike(&head, file);
        (!is_alike).then(|| content(&head))
    }

    fn is_alike(self, head: &[u8], file: &Path) -> bool {
        let begins = |with: &[&str]| with.iter().any(|with| begins_with(head, with));
        match self {
            Self::Result => has_field(file, &["provenance", "time", "error"]),
            Self::Record => edof_io::record::is_record_file(file),
            Self::Design => has_field(file, &["stages"]),
            Self::Report => begins(&["<!doctype html"]),
            Self::Table => content(head) == TEXT && is_header(&first_line(head)),
            Self::Markdown => content(head) == TEXT && String::from_utf8_lossy(head).contains("`edof "),
            Self::Svg => begins(&["<svg", "<?xml"]),
            Self::Junit => begins(&["<testsuites", "<?xml"]),
            Self::Picture => Format::of(head).is_some(),
            Self::Weights => content(head) == WEIGHTS,
            Self::Sensor => content(head) == WEIGHTS && is_sensor(head),
            // The bytes of a black frame are letters, too, but no words.
            Self::Pixels => {
                content(head) == OTHER || (content(head) == TEXT && !head.iter().any(u8::is_ascii_whitespace))
            }
            Self::Raw(noun) => content(head) == noun,
            Self::Any => true,
        }
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Result => "a JSON result of edof",
            Self::Record => "the record of a raw frame",
            Self::Design => "a design",
            Self::Report => "an HTML report",
            Self::Table => "comma-separated values",
            Self::Markdown => "a page of edof in Markdown",
            Self::Svg => "an SVG plot",
            Self::Junit => "a JUnit report",
            Self::Picture => "a picture",
            Self::Weights => WEIGHTS,
            Self::Sensor => "a sensor file",
            Self::Pixels => "pixels without a header",
            Self::Raw(noun) => noun,
            Self::Any => "a file",
        })
    }
}

const TEXT: &str = "text";
const WEIGHTS: &str = "a safetensors file";
const OTHER: &str = "other data";

/// What a file holds, by how it begins.
fn content(head: &[u8]) -> &'static str {
    let is_text = std::str::from_utf8(head).map_or_else(|e| e.error_len().is_none(), |_| true);
    if let Some(format) = raw::of_content(head) {
        return format.noun;
    }
    match Format::of(head) {
        Some(Format::Jpeg) => "a JPEG picture",
        Some(Format::WebP) => "a WebP picture",
        Some(_) => "a BMP picture",
        None if head.starts_with(b"PK\x03\x04") => "an NPZ or ZIP archive",
        None if head.starts_with(b"%PDF") => "a PDF document",
        None if head.get(8) == Some(&b'{') && head[4..8] == [0; 4] => WEIGHTS,
        None if begins_with(head, "{") || begins_with(head, "[") => "other JSON",
        None if begins_with(head, "<!doctype html") || begins_with(head, "<html") => "an HTML page",
        None if begins_with(head, "<") => "other XML",
        None if is_text && !head.contains(&0) => TEXT,
        None => OTHER,
    }
}

/// Whether the metadata of a safetensors file are those of a sensor file.
fn is_sensor(head: &[u8]) -> bool {
    let key = edof_io::sensor::file::METADATA_KEY.as_bytes();
    head.windows(key.len()).any(|part| part == key)
}

/// Whether a text begins so, in small letters or large, after a byte-order mark and spaces.
fn begins_with(head: &[u8], with: &str) -> bool {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    text.get(..with.len()).is_some_and(|text| text.eq_ignore_ascii_case(with.as_bytes()))
}

/// Whether a line is one of names and commas: `psi,psnr_db`.
fn is_header(line: &str) -> bool {
    let is_name = |name: &str| !name.is_empty() && !name.contains(char::is_whitespace);
    line.contains(',') && line.split(',').all(is_name)
}

fn first_line(head: &[u8]) -> String {
    String::from_utf8_lossy(head).lines().next().unwrap_or("").to_owned()
}

/// Whether a file begins with a JSON object that has one of the fields.
fn has_field(file: &Path, fields: &[&str]) -> bool {
    let Ok(file) = input::open(file) else { return false };
    let objects = serde_json::Deserializer::from_reader(BufReader::new(file));
    let first = objects.into_iter::<BTreeMap<String, IgnoredAny>>().next();
    first
        .is_some_and(|first| first.is_ok_and(|object| fields.iter().any(|field| object.contains_key(*field))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_replaces_a_file_of_its_own_kind_alone() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("x");
        for (kind, of_its_kind) in [
            (Kind::Result, "{\"a\": 1, \"provenance\": {}}"),
            (Kind::Result, "{\"time\": 1}\n{\"time\": 2}\n"),
            (Kind::Record, "{\"phase\": \"rggb\", \"provenance\": {}}"),
            (Kind::Design, "{\"name\": \"tiny\", \"stages\": []}"),
            (Kind::Report, "<!DOCTYPE html><html>"),
            (Kind::Table, "a,b\n1,2\n"),
            (Kind::Markdown, "# Title\n\nMade by `edof study bits`.\n"),
            (Kind::Svg, "<svg xmlns"),
            (Kind::Junit, "<?xml version=\"1.0\"?>"),
            (Kind::Picture, "P5 1 1 255 x"),
            (Kind::Weights, "\u{8}\0\0\0\0\0\0\0{}      "),
            (Kind::Sensor, "\u{1e}\0\0\0\0\0\0\0{\"__metadata__\":{\"edof_sensor\":"),
            (Kind::Pixels, "\u{1}\0\u{2}\0"),
        ] {
            std::fs::write(&file, of_its_kind).unwrap();
            assert_eq!(kind.refusal(&file), None, "{kind}");
            for (other, content) in [
                ("\u{1}\0\u{2}\u{3}", OTHER),
                ("{\"focal_length_mm\": 8}", "other JSON"),
                ("{\"rating\": 4}", "other JSON"),
                ("%PDF-1.4", "a PDF document"),
            ] {
                std::fs::write(&file, other).unwrap();
                if kind != Kind::Pixels || content != OTHER {
                    assert_eq!(kind.refusal(&file), Some(content), "{kind}");
                }
            }
        }
    }

    #[test]
    fn nothing_is_lost_with_an_empty_file_or_none() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("x");
        assert_eq!(Kind::Result.refusal(&file), None);
        std::fs::write(&file, "").unwrap();
        assert_eq!(Kind::Result.refusal(&file), None);
    }
}
