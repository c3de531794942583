//! Files to begin with, most of them as the program writes them, all small.

use edof_core::camera::Camera;
use edof_core::{CfaPhase, ColourFrame, RawFrame};
use edof_io::photo;
use edof_io::samples::Samples;
use edof_io::sensor::{Correction, Defects, Tables};
use edof_network::weight_file::{save_fixed, save_network};
use edof_study::methods::dictionary::{self, Recipe};
use ndarray::{Array1, Array2, Array3};
use std::io::{Cursor, Write};
use std::path::Path;

/// What is written to a file of that name.
fn written(name: &str, write: impl FnOnce(&Path)) -> Vec<u8> {
    let path = crate::files::file(name, b"");
    std::fs::remove_file(&path).expect("the file was just written");
    write(&path);
    std::fs::read(&path).expect("the file was just written")
}

/// A float network of 4 codes, and the same in integers as they are drawn.
pub fn weights() -> Vec<Vec<u8>> {
    let camera = Camera::resolve("ring-outer").expect("a preset");
    let mut float = edof_device::random::silent(camera);
    float.form.codes = 4;
    let (form, codes) = (float.form, float.form.codes);
    float.analysis = Array2::from_elem((codes, form.window.pixels()), 0.25);
    float.thresholds.iter_mut().for_each(|theta| *theta = Array1::from_elem(codes, 0.5));
    float.recurrent.iter_mut().for_each(|weights| *weights = Array2::zeros((codes, codes)));
    float.dictionary = Array2::zeros((float.dictionary.nrows(), codes));
    let fixed = edof_device::random::extreme(form, 16, edof_core::geometry::Stride::FINEST, false, 1);
    vec![
        written("float.safetensors", |path| {
            save_network(path, &float).expect("a small network can be written")
        }),
        written("fixed.safetensors", |path| {
            save_fixed(path, &fixed).expect("a small network can be written")
        }),
    ]
}

/// The repository's files of a folder.
fn repository(folder: &str, names: &[&str]) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    names
        .iter()
        .map(|name| std::fs::read(root.join(folder).join(name)).expect("a file of the repository"))
        .collect()
}

/// A sensor file of a small sensor.
pub fn sensors() -> Vec<Vec<u8>> {
    let size = edof_io::raw::Size { width: 40, height: 36 };
    let mut tables = Tables::plain(size, CfaPhase::Grbg, 12, [1000.0; 4], 65536.0);
    tables.pixels = Some(Array2::zeros((36, 40)));
    tables.defects = Defects { pixels: vec![[3, 4]], columns: vec![7], rows: vec![9] };
    let correction = Correction::new(tables).expect("tables of a small sensor");
    vec![written("sensor.safetensors", |path| {
        edof_io::sensor::file::save(path, &correction, None).expect("a small sensor file can be written")
    })]
}

pub fn defects() -> Vec<Vec<u8>> {
    vec![b"# known\n17,250\n*,9\n4,* # row\n".to_vec()]
}

pub fn designs() -> Vec<Vec<u8>> {
    repository("designs", &["tiny.json", "paper.json", "kc705.json"])
}

pub fn cameras() -> Vec<Vec<u8>> {
    repository("cameras", &["clear.json", "ring-2015.json", "ring-2018.json", "ring-outer.json"])
}

pub fn scenes() -> Vec<Vec<u8>> {
    let background = r#"{"picture": "wall.png", "depth": "infinity"}"#;
    let layer = r#"{"picture": "vase.png", "matte": "vase-matte.png", "depth": 4.5}"#;
    vec![
        format!(r#"{{"layers": [{background}]}}"#).into_bytes(),
        format!(r#"{{"layers": [{background}, {layer}, {layer}]}}"#).into_bytes(),
    ]
}

/// An NPY file of f64 or f32.
fn npy(shape: &[usize], single: bool) -> Vec<u8> {
    let count: usize = shape.iter().product();
    let sides: Vec<String> = shape.iter().map(|side| format!("{side},")).collect();
    let kind = if single { "<f4" } else { "<f8" };
    let mut head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", sides.join(" "));
    while (head.len() + 11) % 64 != 0 {
        head.push(' ');
    }
    head.push('\n');
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    for index in 0..count {
        let value = 1.0 + index as f64;
        if single { bytes.extend((value as f32).to_le_bytes()) } else { bytes.extend(value.to_le_bytes()) }
    }
    bytes
}

fn npz(parts: &[(&str, Vec<u8>)], deflated: bool) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(vec![]));
    let method = if deflated { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, content) in parts {
        zip.start_file(*name, options).expect("an archive in memory");
        zip.write_all(content).expect("an archive in memory");
    }
    zip.finish().expect("an archive in memory").into_inner()
}

pub fn arrays() -> Vec<Vec<u8>> {
    let parts = [("psi.npy", npy(&[2], false)), ("w.npy", npy(&[2, 3], true))];
    let mut all = vec![npy(&[3, 2], false), npy(&[], true), npz(&parts, false), npz(&parts, true)];
    all.extend(weights());
    all
}

pub fn banks() -> Vec<Vec<u8>> {
    let parts = [
        ("psi.npy", npy(&[2], false)),
        ("psf.npy", npy(&[2, 3, 3, 3], true)),
        ("pixel_pitch_um.npy", npy(&[], false)),
    ];
    let zip = |deflated| [vec![0], npz(&parts, deflated)].concat();
    // Halves of one length: ψ is read to its end.
    let [psi, psf] = [npy(&[18], true), npy(&[1, 3, 3, 3], true)];
    vec![zip(false), zip(true), [vec![1], psi, psf].concat()]
}

/// A DNG of one strip of words, and the same with a strip of lossless JPEG that is none.
pub fn dngs() -> Vec<Vec<u8>> {
    let (width, height) = (6u16, 4u16);
    let file = |compression: u16| {
        let short = |tag: u16, value: u16| (tag, 3u16, 1u32, u32::from(value).to_le_bytes());
        let long = |tag: u16, value: u32| (tag, 4u16, 1u32, value.to_le_bytes());
        let words = u32::from(width) * u32::from(height);
        let tags = [
            long(254, 0),
            short(256, width),
            short(257, height),
            short(258, 16),
            short(259, compression),
            short(262, 32803),
            long(273, 8 + 2 + 12 * 14 + 4),
            short(277, 1),
            short(278, height),
            long(279, 2 * words),
            (33421, 3, 2, [2, 0, 2, 0]),
            (33422, 1, 4, [0, 1, 1, 2]),
            short(50714, 64),
            short(50717, 4095),
        ];
        let mut bytes = b"II*\0\x08\0\0\0".to_vec();
        bytes.extend((tags.len() as u16).to_le_bytes());
        for (tag, kind, count, value) in tags {
            bytes.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            bytes.extend([count.to_le_bytes(), value].concat());
        }
        bytes.extend([0; 4]);
        bytes.extend((0..words).flat_map(|word| (100 + 37 * word as u16).to_le_bytes()));
        bytes
    };
    vec![file(1), file(7)]
}

fn raw_frame() -> RawFrame {
    RawFrame::from_values(
        Array2::from_shape_fn((4, 6), |(r, c)| (100 * r + 7 * c) as u16),
        12,
        CfaPhase::Rggb,
    )
    .expect("a raw frame")
}

fn raw_files() -> Vec<Vec<u8>> {
    let save = |name: &str| {
        written(name, |path| edof_io::raw::save(path, &raw_frame()).expect("a raw frame can be written"))
    };
    vec![save("raw.png"), save("raw.tif"), save("raw.pgm")]
}

pub fn pictures() -> Vec<Vec<u8>> {
    let colour = ColourFrame::zeros(4, 6);
    let save = |name: &str, bits| {
        written(name, |path| photo::save(path, &colour, bits).expect("a photograph can be written"))
    };
    let mut all = vec![save("p.png", 8), save("p.png", 16), save("p.tif", 16), save("p.ppm", 8)];
    all.extend(raw_files());
    all.extend(repository("crates/edof-io/src/tiff/fixtures", &["lzw-tiles.tif", "jpeg-ycbcr.tif"]));
    all.extend([packed_big_tiff(), stated_png(&save("stated.png", 16))]);
    all
}

/// A BigTIFF of two 12-bit samples.
fn packed_big_tiff() -> Vec<u8> {
    let mut bytes = b"II+\0\x08\0\0\0\x18\0\0\0\0\0\0\0\xab\xc1\x23\0\0\0\0\0".to_vec();
    let entries = [(256u16, 2u64), (257, 1), (258, 12), (262, 1), (273, 16), (274, 6), (279, 3)];
    bytes.extend((entries.len() as u64).to_le_bytes());
    for (tag, value) in entries {
        bytes.extend([&tag.to_le_bytes()[..], &[16, 0], &1u64.to_le_bytes(), &value.to_le_bytes()].concat());
    }
    bytes
}

/// A PNG with chunks that state its curve and orientation; their checksums are not those of their content.
fn stated_png(png: &[u8]) -> Vec<u8> {
    let exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    let chunks: [(&[u8], &[u8]); 4] =
        [(b"cICP", &[1, 8, 0, 1]), (b"sRGB", &[0]), (b"gAMA", &[0, 1, 0x86, 0xa0]), (b"eXIf", exif)];
    let chunk = |(kind, content): (&[u8], &[u8])| {
        [&(content.len() as u32).to_be_bytes()[..], kind, content, &[0; 4]].concat()
    };
    [&png[..33], &chunks.map(chunk).concat(), &png[33..]].concat()
}

/// With options before: as the file says, and headerless of all packings.
pub fn raws() -> Vec<Vec<u8>> {
    let of_file = |file: Vec<u8>| [vec![0, 0, 12, 6, 4], file].concat();
    let headerless = |packing: u8| [vec![12, packing, 12, 6, 4], vec![100; 48]].concat();
    raw_files().into_iter().map(of_file).chain((0..6).map(headerless)).collect()
}

pub fn pnms() -> Vec<Vec<u8>> {
    let samples =
        |channels, full_scale| Samples { planes: Array3::from_elem((channels, 2, 3), 7), full_scale };
    [samples(1, 255), samples(1, 4095), samples(3, 65535)].iter().map(edof_io::pnm::encode).collect()
}

pub fn dictionaries() -> Vec<Vec<u8>> {
    let recipe = Recipe { atoms: 4, sparsity: 1, patches: 10, rounds: 1, seed: 1 };
    let atoms = Array2::from_elem((192, recipe.atoms), 0.25);
    let made = edof_core::storage::provenance::Provenance::default();
    vec![written("dictionary.safetensors", |path| {
        dictionary::save(path, &atoms, recipe, 0.1, made).expect("a small dictionary can be written")
    })]
}

/// The first rows of studies, whole and torn.
pub fn rows() -> Vec<Vec<u8>> {
    let pages = ["kodak.jsonl", "single-depth.jsonl", "tolerances.jsonl", "aperture.jsonl"];
    let first = |(study, rows): (usize, Vec<u8>)| {
        let head: Vec<u8> = rows.split_inclusive(|byte| *byte == b'\n').take(4).flatten().copied().collect();
        [vec![study as u8], head].concat()
    };
    let whole: Vec<Vec<u8>> =
        repository("crates/edof-study/tests/rows", &pages).into_iter().enumerate().map(first).collect();
    let torn = whole.iter().map(|rows| rows[..rows.len() - 9].to_vec());
    torn.chain(whole.clone()).collect()
}

pub fn records() -> Vec<Vec<u8>> {
    let camera =
        String::from_utf8(repository("cameras", &["ring-outer.json"]).remove(0)).expect("a camera is text");
    let text = format!(
        r#"{{"phase": "rggb", "depth": 12, "alignment": "top", "black_level": 64, "white_level": 4000.0, "white_balance": [2, 1, 1.5], "camera": {camera}}}"#
    );
    vec![text.into_bytes(), b"{}".to_vec()]
}
