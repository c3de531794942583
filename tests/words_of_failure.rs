//! What a failure says: the file that the user named, the option as it was given, the limit that was passed, and what to do; nothing of
//! Rust. One row is a command and what its one line must hold.

mod names;
mod rows;
mod strange;

use crate::support::{Place, forge};
use names::{BEHIND, CONTRADICTIONS, NAMES, NUMBERS};
use rows::{ARRAYS, FILES, OPTIONS, Row};
use std::io::Write;
use strange::{SCENES, STRANGE, USAGE};

/// A camera file of the name `clear`, changed.
fn camera(from: &str, to: &str) -> String {
    let text = include_str!("../cameras/clear.json");
    let changed = text.replacen(from, to, 1);
    assert_ne!(text, changed, "{from}");
    changed
}

/// The smallest design, changed.
fn design(from: &str, to: &str) -> String {
    let text = include_str!("../designs/tiny.json");
    let changed = text.replacen(from, to, 1);
    assert_ne!(text, changed, "{from}");
    changed
}

/// An array as NumPy writes it.
fn npy(descriptor: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descriptor}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A PNG that says of itself that it is so large, of no data.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        let step = |crc: u32, byte: &u8| {
            (0..8).fold(
                crc ^ u32::from(*byte),
                |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
            )
        };
        !bytes.iter().fold(!0, step)
    };
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [&kind[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 2, 0, 0, 0]].concat();
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunk(b"IHDR", &header), chunk(b"IDAT", &[0x78, 0x9c, 3, 0, 0, 0, 0, 1])]
        .concat()
}

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.raw("small-raw.png", 8, 8);
    place.photo("photo.png", 288, 256);
    place.photo("small.png", 8, 8);
    place.photo("dot.png", 1, 1);
    place.photo("frame.png", 48, 32);
    for folder in ["photos", "one", "unnumbered", "tiny-photos", "gt", "broken"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("photos/p03.png", 288, 256);
    place.photo("unnumbered/holiday.png", 288, 256);
    place.photo("tiny-photos/p01.png", 288, 256);
    place.photo("tiny-photos/p02.png", 40, 40);
    place.write("broken/a.png", "no picture");
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    cameras(&place);
    designs(&place);
    banks(&place);
    names(&place);
    place.write("bomb.png", png_of(60_000, 60_000));
    place.write("scene-depth.json", r#"{"layers": [{"picture": "photo.png", "depth": [1]}]}"#);
    place.write("scene-size.json", r#"{"layers": [{"picture": "photo.png", "depth": 1, "size": 3}]}"#);
    place.write("scene-none.json", r#"{"layers": []}"#);
    place.write("long.json", " ".repeat((1 << 20) + 1) + "{}");
    place.write("latin.json", b"{\"name\": \"caf\xe9\"}");
    place.write("said.png", std::fs::read(place.path("raw.png")).unwrap());
    place.write("said.png.json", r#"{"phase": "rgbg", "sha256": "0"}"#);
    std::fs::copy(place.path("net.fixed.safetensors"), place.path("kinds.fixed.safetensors")).unwrap();
    forge(&place.path("kinds.fixed.safetensors"), |text, _| {
        *text = text.replace("\"code_bits\":16", "\"code_bits\":{}");
    });
    place
}

fn cameras(place: &Place) {
    place.write("f01.json", camera("\"focal_length_mm\": 16.0", "\"focal_length_mm\": -16.0"));
    place.write("line.json", camera("610.0,", "0.0,"));
    place.write("pairs.json", camera("610.0,", "[[610, 1], [600, 1]],"));
    place.write("spectrum.json", camera("610.0,", "\"red\","));
    place.write("ring.json", camera("\"rings\": []", RINGS));
    place.write("pitch.json", camera("\"pixel_pitch_um\": 3.0", "\"pixel_pitch_um\": 1e300"));
    place.write("kind.json", camera("\"psi_range\": [\n    0.0,\n    8.0\n  ]", "\"psi_range\": {}"));
    place.write("bank.json", camera("\"rings\"", "\"psf_bank\": { \"file\": \"nothere.npz\" }, \"rings\""));
    place.write("mask.json", camera("\"rings\"", MASK));
    place.write("far.json", camera("8.0\n", "1e308\n"));
    place.write("field.json", camera("\"focus_psi\"", "\"focus\""));
    place.write("text.json", camera("\"focal_length_mm\": 16.0", "\"focal_length_mm\": \"16\""));
}

/// The picture of a mask that is not there.
const MASK: &str =
    r#""height_map": { "file": "nothere.png", "white_um": 1.2, "cauchy": [1.4, 0.003] }, "rings""#;

/// A ring of a NaN wavelength.
const RINGS: &str =
    r#""rings": [{ "inner": 0.2, "outer": 0.5, "delay": { "phase": { "rad": 6.8, "at_nm": 0 } } }]"#;

/// Names that no message can show, and that can be no part of a path; JSON with something behind its end.
fn names(place: &Place) {
    let (own, small) = ("\"name\": \"clear\"", "\"name\": \"tiny\"");
    place.write("n-empty.json", camera(own, "\"name\": \"\""));
    place.write("n-blank.json", camera(own, "\"name\": \"   \""));
    place.write("n-lines.json", camera(own, "\"name\": \"two\\nlines\""));
    place.write("n-bell.json", camera(own, "\"name\": \"ding\\u0007\""));
    place.write("n-long.json", camera(own, &format!("\"name\": \"{}\"", "x".repeat(5000))));
    place.write("n-bank.json", camera("\"rings\"", "\"psf_bank\": { \"file\": \"\" }, \"rings\""));
    place.write("n-more.json", include_str!("../cameras/clear.json").to_owned() + "}\n");
    for (name, text) in [
        ("empty", ""),
        ("slash", "a/b"),
        ("up", ".."),
        ("hidden", ".tiny"),
        ("dash", "-tiny"),
        ("blank", "my design"),
        ("quote", "a\\\"b"),
        ("lines", "a\\nb"),
        ("far", "设计"),
        ("long", &"x".repeat(65)),
    ] {
        place.write(&format!("dn-{name}.json"), design(small, &format!("\"name\": \"{text}\"")));
    }
    place.write("d-more.json", include_str!("../designs/tiny.json").to_owned() + "\n\n{}");
    place.write("d-nan.json", design("\"clock_mhz\": 100.0", "\"clock_mhz\": NaN"));
    place.write("d-slow.json", design("\"clock_mhz\": 100.0", "\"clock_mhz\": 1e-300"));
    place.write("scene-more.json", r#"{"layers": []} []"#);
    let header = br#"{"psi":{"dtype":"F64","shape":[1],"data_offsets":[0,8]}} x"#;
    place.write("more.safetensors", [&(header.len() as u64).to_le_bytes()[..], header, &[0; 8]].concat());
    place.write("rows.jsonl", "{}\n");
    place.write("noise.jsonl", "no rows\n");
    std::fs::create_dir(place.path("cases")).unwrap();
    place.write("cases/a.json", "{} x");
}

fn designs(place: &Place) {
    place.write("mine.json", include_str!("../designs/tiny.json"));
    place.write(
        "d-video.json",
        design("\"width\": 64", "\"width\": 1366").replacen("\"height\": 48", "\"height\": 768", 1),
    );
    place.write("d-clock.json", design("\"clock_mhz\": 100.0", "\"clock_mhz\": 1e99"));
    place.write("d-codes.json", design("\"codes\": 16", "\"codes\": 17"));
    place.write("d-stages.json", design("\"layers\": 4", "\"layers\": 5"));
    place.write("d-kind.json", design("\"codes\": 16", "\"codes\": \"16\""));
    place.write("d-frame.json", design("\"width\": 64", "\"width\": 63"));
    place.write("d-unknown.json", design("\"name\"", "\"title\": 1, \"name\""));
}

fn banks(place: &Place) {
    let psi = npy("<f8", "(2,)", &doubles(&[0.0, 4.0]));
    let flat = npy("<f8", "(2, 3, 3)", &doubles(&[1.0; 18]));
    let store = |name: &str, entries: &[(&str, &[u8])]| {
        let mut bytes = std::io::Cursor::new(vec![]);
        let mut archive = zip::ZipWriter::new(&mut bytes);
        for (name, content) in entries {
            let options =
                zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            archive.start_file(*name, options).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap();
        place.write(name, bytes.into_inner());
    };
    store("flat.npz", &[("psi.npy", &psi), ("psf.npy", &flat)]);
    store("twice.npz", &[("psi.npy", &psi), ("psi", &psi), ("psf.npy", &flat)]);
    store("bell.npz", &[("psi\u{7}.npy", &psi)]);
    store(
        "falling.npz",
        &[
            ("psi.npy", &npy("<f8", "(2,)", &doubles(&[4.0, 0.0]))),
            ("psf.npy", &npy("<f8", "(2, 3, 3, 3)", &doubles(&[1.0; 54]))),
        ],
    );
    store("cut.npz", &[("psi.npy", &npy("<f8", "(3,)", &doubles(&[4.0, 0.0])))]);
    // Both arrays are whole, the list of them behind them is not there.
    let whole = std::fs::read(place.path("flat.npz")).unwrap();
    place.write("half.npz", &whole[..whole.len() - 100]);
    // The method of compression is bzip2's.
    let mut packed = whole;
    for (mark, offset) in [(&b"PK\x03\x04"[..], 8), (b"PK\x01\x02", 10)] {
        let at = packed.windows(4).position(|word| word == mark).unwrap();
        packed[at + offset] = 12;
    }
    place.write("bzip2.npz", packed);
    place.write("lens.npy", &psi);
    place.write("my-psf.npy", &flat);
    let header = br#"{"psi":{"dtype":"F64","shape":[1],"data_offsets":[0,8]},"psi":{"dtype":"F64","shape":[1],"data_offsets":[0,8]}}"#;
    place.write("twice.safetensors", [&(header.len() as u64).to_le_bytes()[..], header, &[0; 8]].concat());
    let header = br#"{"psi":{"dtype":"F64","shape":[{}],"data_offsets":[0,8]}}"#;
    place.write("kind.safetensors", [&(header.len() as u64).to_le_bytes()[..], header, &[0; 8]].concat());
}

/// What a message has of Rust, or of numbers that nobody reads.
fn of_rust(line: &str) -> Option<&'static str> {
    const WORDS: [&str; 20] = [
        "os error",
        "Unsupported(",
        "Some(",
        "None",
        "Ok(",
        "Err(",
        "Line(",
        "Sampled(",
        "Phase {",
        "Etched {",
        "f32",
        "f64",
        "usize",
        "u16",
        "u32",
        "struct ",
        "enum ",
        "unknown variant",
        "NotFound",
        "\\u{",
    ];
    WORDS.into_iter().find(|word| line.contains(word)).or_else(|| {
        let digits = line.split(|c: char| !c.is_ascii_digit()).map(str::len).max().unwrap_or(0);
        (digits > 20).then_some("a number of more than twenty digits")
    })
}

/// Files that are none of what they are given for, and records and scenes that say what cannot be.
fn strange() -> Place {
    let place = ready();
    for folder in ["empty", "folder.png"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("other.png", 64, 32);
    for name in ["empty.json", "empty.png", "empty.safetensors"] {
        place.write(name, "");
    }
    place.write("list.json", "[]");
    place.write("words.json", "\"x\"");
    place.write("deep.json", "[".repeat(5000));
    place.write(
        "wide.json",
        "\u{feff}{\"name\":\"x\"}".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
    );
    place.write("rows.jsonl", "{\"study\":\"knobs\",\"layout\":1,\"exact\":false,\"machine\":\"m\"}\n");
    place.write(
        "knobs.jsonl",
        "{\"study\":\"knobs\",\"layout\":1,\"exact\":false,\"machine\":\"m\"}\n{\"knob\": 3\n{}\n",
    );
    place.write("twice.json", r#"{"layers": [], "layers": []}"#);
    let layers = |name: &str, layers: &str| place.write(name, format!("{{\"layers\": [{layers}]}}"));
    layers("s-missing.json", r#"{"picture": "nothere.png", "depth": 1}"#);
    layers("s-feet.json", r#"{"picture": "photo.png", "depth": "2 feet"}"#);
    layers("s-bare.json", r#"{"picture": "photo.png", "depth": 1}, {"picture": "other.png", "depth": 2}"#);
    let matte =
        r#"{"picture": "photo.png", "depth": 1}, {"picture": "photo.png", "matte": "other.png", "depth": 2}"#;
    layers("s-matte.json", matte);
    layers("s-far.json", r#"{"picture": "photo.png", "depth": 1e9}"#);
    layers("s-nowhere.json", r#"{"picture": "photo.png"}"#);
    layers("s-many.json", &[r#"{"picture": "photo.png", "depth": 1}"#; 65].join(","));
    layers("s-folder.json", r#"{"picture": "folder.png", "depth": 1}"#);
    layers("s-nameless.json", r#"{"picture": "", "depth": 1}"#);
    layers("s-behind.json", r#"{"picture": "photo.png", "depth": "-1m"}"#);
    place.edof("capture photo.png --psi 1 --out taken.png").done();
    let taken: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("taken.png.json")).unwrap()).unwrap();
    let record = |name: &str, field: &str, value: serde_json::Value| {
        std::fs::copy(place.path("taken.png"), place.path(name)).unwrap();
        let mut record = taken.clone();
        record[field] = value;
        place.write(&format!("{name}.json"), record.to_string());
    };
    record("r-depth.png", "depth", 99.into());
    record("r-black.png", "black_level", 70000.into());
    record("r-white.png", "white_level", 0.into());
    record("r-balance.png", "white_balance", serde_json::json!([1, 2]));
    record("r-bright.png", "white_balance", serde_json::json!([1e30, 1, 1]));
    record("r-dark.png", "white_balance", serde_json::json!([0, 1, 1]));
    record("r-matrix.png", "colour_matrix", serde_json::json!([[1, 0, 0]]));
    record("r-align.png", "alignment", "left".into());
    record("r-psi.png", "psi", serde_json::json!(["x"]));
    record("r-hash.png", "sha256", "abc".into());
    record("r-text.png", "depth", "12".into());
    std::fs::copy(place.path("taken.png"), place.path("r-more.png")).unwrap();
    place.write("r-more.png.json", format!("{taken}\n{{}}"));
    for (name, from, to) in [
        ("g-bits.json", "\"code_bits\": 16", "\"code_bits\": 17"),
        ("g-sum.json", "\"accumulator_bits\": 48", "\"accumulator_bits\": 64"),
        ("g-layers.json", "\"layers\": 4", "\"layers\": 1"),
        ("g-lanes.json", "\"lanes\": 16", "\"lanes\": 0"),
        ("g-slow.json", "\"clock_mhz\": 100.0", "\"clock_mhz\": -5.0"),
        ("g-stride.json", "\"stride\": 8", "\"stride\": 3"),
        ("g-window.json", "\"window\": 8", "\"window\": 9"),
        ("g-skip.json", "\"skip_zeros\": true", "\"skip_zeros\": \"yes\""),
    ] {
        place.write(name, design(from, to));
    }
    place
}

#[track_caller]
fn every_row_says_what_and_what_to_do(rows: &[Row]) {
    every_row_ends_with(&ready(), rows, (1, "edof: "));
}

/// Each ends with a status and one line that begins so, and leaves nothing.
#[track_caller]
fn every_row_ends_with(place: &Place, rows: &[Row], (code, beginning): (i32, &str)) {
    let before = place.snapshot();
    let mut wrongly = vec![];
    for (command, options, words) in rows {
        // On a slow machine progress would be a line of its own.
        let line = format!("{command} {options} --quiet");
        let run = place.edof_within_bounds(&line);
        let missing: Vec<&&str> = words.iter().filter(|word| !run.err.contains(**word)).collect();
        // Wrong usage comes with a hint at the right one.
        let one = (code == 2 || run.err.lines().count() == 1)
            && run.err.starts_with(beginning)
            && run.out.is_empty();
        let rust = of_rust(&run.err);
        let left = place.snapshot() != before;
        if run.code != Some(code) || !one || !missing.is_empty() || rust.is_some() || left {
            wrongly.push(format!(
                "{line}: status {:?}, missing {missing:?}, of Rust {rust:?}, files left: {left}\n    {}{}",
                run.code, run.out, run.err
            ));
        }
    }
    assert!(wrongly.is_empty(), "{} of {}:\n{}", wrongly.len(), rows.len(), wrongly.join("\n"));
}

#[test]
fn a_failure_of_a_file_names_the_file_that_was_given() {
    every_row_says_what_and_what_to_do(FILES);
}

#[test]
fn arrays_of_other_programs_are_rejected_by_name() {
    every_row_says_what_and_what_to_do(ARRAYS);
}

#[test]
fn illegal_names_are_rejected_with_the_legal_characters() {
    every_row_says_what_and_what_to_do(NAMES);
}

#[test]
fn text_after_the_end_of_json_is_reported_with_its_line() {
    every_row_says_what_and_what_to_do(BEHIND);
}

#[test]
fn options_that_contradict_each_other_are_rejected() {
    every_row_says_what_and_what_to_do(CONTRADICTIONS);
}

#[test]
fn words_in_place_of_numbers_are_rejected_in_plain_words() {
    every_row_ends_with(&ready(), NUMBERS, (2, "error: "));
}

#[test]
fn a_failure_of_an_option_names_the_option_and_its_limit() {
    every_row_says_what_and_what_to_do(OPTIONS);
}

#[test]
fn scenes_and_records_that_say_what_cannot_be_are_named_with_the_place_in_them() {
    every_row_ends_with(&strange(), SCENES, (1, "edof: "));
}

#[test]
fn files_and_folders_that_are_something_else_are_named() {
    every_row_ends_with(&strange(), STRANGE, (1, "edof: "));
}

#[test]
fn wrong_usage_names_the_option_the_value_and_what_is_expected() {
    every_row_ends_with(&strange(), USAGE, (2, "error: "));
}
