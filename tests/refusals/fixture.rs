//! Files for the refusals: good ones, and those that are wrong in one thing.

use crate::support::{Place, forge};
use edof_network::weight_file;
use serde_json::Value;
use std::fs;
use std::io::Write;
use std::os::unix::fs::symlink;

const CAMERA: &str = include_str!("../../cameras/clear.json");
const DESIGN: &str = include_str!("../../designs/tiny.json");

/// A file of the project with JSON text for the value of a field, whose path has slashes; an empty text removes the field.
pub fn edited(file: &str, field: &str, value: &str) -> String {
    let text = match file {
        "cameras/clear.json" => CAMERA,
        "cameras/ring-outer.json" => include_str!("../../cameras/ring-outer.json"),
        "designs/tiny.json" => DESIGN,
        _ => panic!("edit {file}: expected a camera or design of these tests"),
    };
    let mut document: Value = serde_json::from_str(text).unwrap();
    let (parent, key) =
        field.rsplit_once('/').map_or((String::new(), field), |(parent, key)| (format!("/{parent}"), key));
    match document.pointer_mut(&parent).unwrap_or_else(|| panic!("{file} has no {parent}")) {
        Value::Object(fields) if value.is_empty() => drop(fields.remove(key).unwrap()),
        Value::Object(fields) => drop(fields.insert(key.to_owned(), "@".into())),
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = "@".into(),
        other => panic!("{file}: {parent} is {other}"),
    }
    document.to_string().replacen("\"@\"", value, 1)
}

pub fn ready() -> Place {
    let place = Place::new();
    for folder in [
        "photos",
        "one",
        "unnumbered",
        "tiny-photos",
        "gt",
        "broken",
        "empty",
        "folder",
        "folder.png",
        "dots",
        "piped-photos",
        "piped-cases",
        "cases",
        "weights",
    ] {
        fs::create_dir(place.path(folder)).unwrap();
    }
    pictures(&place);
    networks(&place);
    cameras_and_designs(&place);
    banks(&place);
    scenes(&place);
    records(&place);
    for pipe in [
        "waiting",
        "lines.json",
        "waiting.dng",
        "waiting.raw",
        "piped-cases/a.json",
        "piped-photos/p03.png",
        "piped.png.json",
    ] {
        place.pipe(pipe);
    }
    drop(std::os::unix::net::UnixListener::bind(place.path("socket")).unwrap());
    for (name, text) in [
        ("nothing", ""),
        ("kept", "last night's"),
        ("text", "two lines\nof words\n"),
        ("half.json", &CAMERA[..100]),
        ("other.json", "{\"a\": 1}"),
        ("list.json", "[1, 2]"),
        ("none.json", "[]"),
        ("words.json", "\"x\""),
        ("deep.json", &"[".repeat(5000)),
        ("long.json", &(" ".repeat((1 << 20) + 1) + "{}")),
        ("empty.json", ""),
        ("empty.png", ""),
        ("empty.safetensors", ""),
        ("notes.md", "# Notes\n\nBuy milk.\n"),
        ("page.html", "<!DOCTYPE html><title>mine</title>"),
        ("letter.txt", "Dear reader,\nall is well.\n"),
        ("paper.pdf", "%PDF-1.7 and so on"),
        ("rows.jsonl", "{}\n"),
        ("part.jsonl", "{}"),
        ("noise.jsonl", "no rows\n"),
        ("header.jsonl", KNOBS),
        ("knobs.jsonl", &format!("{KNOBS}{{\"knob\": 3\n{{}}\n")),
        ("cases/a.json", "{} x"),
        ("begun.safetensors.checkpoint", "no checkpoint"),
    ] {
        place.write(name, text);
    }
    place.write("garbage", (0..5000u32).map(|i| ((i * 197 + 31) % 251) as u8).collect::<Vec<u8>>());
    place.write("latin.json", b"{\"name\": \"caf\xe9\"}");
    place.write(
        "wide.json",
        "\u{feff}{\"name\":\"x\"}".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
    );
    place
}

/// The first line of rows of a study.
const KNOBS: &str = "{\"study\":\"knobs\",\"layout\":1,\"exact\":false,\"machine\":\"m\"}\n";

fn pictures(place: &Place) {
    for (name, width, height) in
        [("raw.png", 48, 32), ("small-raw.png", 8, 8), ("narrow.png", 8, 32), ("mask.png", 32, 32)]
    {
        place.raw(name, width, height);
    }
    for (name, width, height) in [
        ("photo.png", 288, 256),
        ("frame.png", 48, 32),
        ("other.png", 64, 32),
        ("small.png", 8, 8),
        ("dot.png", 1, 1),
        ("photos/p03.png", 288, 256),
        ("unnumbered/holiday.png", 288, 256),
        ("tiny-photos/p01.png", 288, 256),
        ("tiny-photos/p02.png", 40, 40),
        ("dots/a.png", 16, 16),
    ] {
        place.photo(name, width, height);
    }
    symlink("raw.png", place.path("link.png")).unwrap();
    symlink("new.json", place.path("new-link.json")).unwrap();
    fs::copy(place.path("raw.png"), place.path("piped.png")).unwrap();
    half(place, "photo.png", "half.png");
    place.write("broken/a.png", "no picture");
    place.write("odd.pgm", "P2 3 2 65535 1 2 3 4 5 6");
    place.write("raw.bin", [0; 2 * 48 * 32]);
    place.write("bomb.png", png_of(60_000, 60_000));
}

/// The first half of a file.
fn half(place: &Place, whole: &str, half: &str) {
    let bytes = fs::read(place.path(whole)).unwrap();
    place.write(half, &bytes[..bytes.len() / 2]);
}

/// A PNG that states a size, without data.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        let bit = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        !bytes.iter().fold(!0, |crc: u32, byte| (0..8).fold(crc ^ u32::from(*byte), bit))
    };
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [&kind[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 2, 0, 0, 0]].concat();
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunk(b"IHDR", &header), chunk(b"IDAT", &[0x78, 0x9c, 3, 0, 0, 0, 0, 1])]
        .concat()
}

fn networks(place: &Place) {
    place.float_network("net.safetensors");
    place.network_of_two("two.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place.float_network("weights/net.safetensors");
    place.fixed_network("weights/net.fixed.safetensors");
    half(place, "net.safetensors", "half.safetensors");
    let whole = fs::read(place.path("net.fixed.safetensors")).unwrap();
    for (name, kept) in [("0", 0), ("7", 7), ("300", 300), ("last", whole.len() - 1)] {
        place.write(&format!("cut-{name}.safetensors"), &whole[..kept]);
    }
    let mut changed = whole;
    *changed.last_mut().unwrap() ^= 1;
    place.write("changed.safetensors", changed);
    let none: Vec<(&str, safetensors::tensor::TensorView<'_>)> = vec![];
    place.write("foreign.safetensors", safetensors::serialize(none, None).unwrap());
    for (name, from, to) in [
        ("kinds", "\"code_bits\":16", "\"code_bits\":{}"),
        ("form", "\"window\":8", "\"window\":12"),
        ("window", "\"window\":8", "\"window\":9"),
        ("fraction", "\"analysis\":14", "\"analysis\":4294967290"),
    ] {
        let file = place.path(&format!("{name}.safetensors"));
        weight_file::save_fixed(&file, &crate::support::fixed_network()).unwrap();
        forge(&file, |text, _| *text = text.replace(from, to));
    }
    place.float_network("nan.safetensors");
    forge(&place.path("nan.safetensors"), |_, tensors| {
        let (_, _, bytes) = tensors.iter_mut().find(|(name, ..)| name == "linear_path").unwrap();
        bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
}

fn cameras_and_designs(place: &Place) {
    place.write("camera.json", CAMERA);
    place.write("design.json", DESIGN);
    place.write("mine.json", DESIGN);
    place.write("n-more.json", CAMERA.to_owned() + "}\n");
    place.write("d-more.json", DESIGN.to_owned() + "\n\n{}");
    let map = |file: &str| format!(r#"{{"file": "{file}", "white_um": 0.8, "cauchy": [1.458, 0.00354]}}"#);
    for (name, field, value) in [
        ("f01", "focal_length_mm", "-16.0"),
        ("bank", "psf_bank", r#"{"file": "nothere.npz"}"#),
        ("mask", "height_map", &map("nothere.png")),
        ("masked", "height_map", &map("mask.png")),
        ("n-empty", "name", "\"\""),
        ("n-lines", "name", r#""two\nlines""#),
        ("n-bank", "psf_bank", r#"{"file": ""}"#),
    ] {
        place.write(&format!("{name}.json"), edited("cameras/clear.json", field, value));
    }
    for (name, field) in [("wide-lens", "aperture_radius_mm"), ("coarse-lens", "pixel_pitch_um")] {
        place.write(&format!("{name}.json"), edited("cameras/ring-outer.json", field, "1e9"));
    }
    for (name, field, value) in [
        ("d-video", "frame", r#"{"width": 1366, "height": 768, "stride": 8}"#),
        ("d-codes", "form/codes", "17"),
        ("d-frame", "frame/width", "63"),
        ("dn-empty", "name", "\"\""),
        ("dn-slash", "name", "\"a/b\""),
        ("dn-up", "name", "\"..\""),
        ("dn-blank", "name", "\"my design\""),
        ("broken", "clock_mhz", "0.0"),
    ] {
        place.write(&format!("{name}.json"), edited("designs/tiny.json", field, value));
    }
}

/// An array as NumPy writes it.
fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &data].concat()
}

fn banks(place: &Place) {
    let (psi, flat) = (npy("(2,)", &[0.0, 4.0]), npy("(2, 3, 3)", &[1.0; 18]));
    let falling = [npy("(2,)", &[4.0, 0.0]), npy("(2, 3, 3, 3)", &[1.0; 54])];
    let store = |name: &str, entries: &[(&str, &[u8])]| {
        let mut archive = zip::ZipWriter::new(std::io::Cursor::new(vec![]));
        for (name, content) in entries {
            let options =
                zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            archive.start_file(*name, options).unwrap();
            archive.write_all(content).unwrap();
        }
        place.write(name, archive.finish().unwrap().into_inner());
    };
    store("flat.npz", &[("psi.npy", &psi), ("psf.npy", &flat)]);
    store("twice.npz", &[("psi.npy", &psi), ("psi", &psi), ("psf.npy", &flat)]);
    store("bell.npz", &[("psi\u{7}.npy", &psi)]);
    store("falling.npz", &[("psi.npy", &falling[0]), ("psf.npy", &falling[1])]);
    store("cut.npz", &[("psi.npy", &npy("(3,)", &[4.0, 0.0]))]);
    // Both arrays are whole, the list of them at the end is missing.
    let whole = fs::read(place.path("flat.npz")).unwrap();
    place.write("half.npz", &whole[..whole.len() - 100]);
    // The method of compression is bzip2's.
    let mut packed = whole;
    for (mark, offset) in [(&b"PK\x03\x04"[..], 8), (b"PK\x01\x02", 10)] {
        let at = packed.windows(4).position(|word| word == mark).unwrap();
        packed[at + offset] = 12;
    }
    place.write("bzip2.npz", packed);
    place.write("light.npy", npy("(2, 2)", &[0.0, 0.5, 0.25, 1.0]));
    place.write("lens.npy", &psi);
    place.write("my-psf.npy", &flat);
    let psi = |shape: &str| format!(r#""psi":{{"dtype":"F64","shape":[{shape}],"data_offsets":[0,8]}}"#);
    for (name, header) in [
        ("twice", format!("{{{},{}}}", psi("1"), psi("1"))),
        ("kind", format!("{{{}}}", psi("{}"))),
        ("more", format!("{{{}}} x", psi("1"))),
    ] {
        let bytes = [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &[0; 8]].concat();
        place.write(&format!("{name}.safetensors"), bytes);
    }
}

fn scenes(place: &Place) {
    let layer = r#"{"picture": "photo.png", "depth": 1}"#;
    for (name, layers) in [
        ("s-list", r#"{"picture": "photo.png", "depth": [1]}"#),
        ("s-size", r#"{"picture": "photo.png", "depth": 1, "size": 3}"#),
        ("s-none", ""),
        ("s-missing", r#"{"picture": "nothere.png", "depth": 1}"#),
        ("s-feet", r#"{"picture": "photo.png", "depth": "2 feet"}"#),
        ("s-bare", &format!(r#"{layer}, {{"picture": "other.png", "depth": 2}}"#)),
        ("s-matte", &format!(r#"{layer}, {{"picture": "photo.png", "matte": "other.png", "depth": 2}}"#)),
        ("s-far", r#"{"picture": "photo.png", "depth": 1e9}"#),
        ("s-nowhere", r#"{"picture": "photo.png"}"#),
        ("s-many", &[layer; 65].join(",")),
        ("s-folder", r#"{"picture": "folder.png", "depth": 1}"#),
        ("s-nameless", r#"{"picture": "", "depth": 1}"#),
        ("s-behind", r#"{"picture": "photo.png", "depth": "-1m"}"#),
    ] {
        place.write(&format!("{name}.json"), format!("{{\"layers\": [{layers}]}}"));
    }
    place.write("s-twice.json", r#"{"layers": [], "layers": []}"#);
    place.write("s-more.json", r#"{"layers": []} []"#);
}

/// A frame with a record of each kind that cannot be its own.
fn records(place: &Place) {
    place.edof("capture photo.png --psi 1 --no-measure --out taken.png").done();
    place.edof("capture photo.png --psi 1 --no-measure --camera clear-mid --focus 2,6 --out pair.png").done();
    let taken: Value = serde_json::from_slice(&fs::read(place.path("taken.png.json")).unwrap()).unwrap();
    for (name, field, value) in [
        ("depth", "depth", "99"),
        ("black", "black_level", "70000"),
        ("white", "white_level", "0"),
        ("balance", "white_balance", "[1, 2]"),
        ("bright", "white_balance", "[1e30, 1, 1]"),
        ("dark", "white_balance", "[0, 1, 1]"),
        ("matrix", "colour_matrix", "[[1, 0, 0]]"),
        ("align", "alignment", "\"left\""),
        ("psi", "psi", "[\"x\"]"),
        ("hash", "sha256", "\"abc\""),
        ("text", "depth", "\"12\""),
        ("phase", "phase", "\"rgbg\""),
    ] {
        fs::copy(place.path("taken.png"), place.path(&format!("r-{name}.png"))).unwrap();
        let mut record = taken.clone();
        record[field] = serde_json::from_str(value).unwrap();
        place.write(&format!("r-{name}.png.json"), record.to_string());
    }
    fs::copy(place.path("taken.png"), place.path("r-more.png")).unwrap();
    place.write("r-more.png.json", format!("{taken}\n{{}}"));
}
