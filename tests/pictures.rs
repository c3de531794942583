//! Pictures of other programs by the real binary: stated curves, orientations, TIFFs of many kinds, sidecars, depth maps in millimetres.

use crate::support::Place;
use edof_core::{ColourFrame, Tone};
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use edof_io::samples::Samples;
use ndarray::Array3;
use serde_json::Value;

/// A PNG of the program with a chunk behind its header.
fn add_chunk(place: &Place, name: &str, kind: &[u8; 4], content: &[u8]) {
    let png = std::fs::read(place.path(name)).unwrap();
    let chunk = [&kind[..], content].concat();
    let bit = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    let crc =
        !chunk.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| bit(crc)));
    let length = (content.len() as u32).to_be_bytes();
    place.write(name, [&png[..33], &length, &chunk, &crc.to_be_bytes(), &png[33..]].concat());
}

/// A 16-bit PNG of one value.
fn flat(place: &Place, name: &str, value: f32) {
    let mut frame = ColourFrame::zeros(32, 48);
    frame.planes.fill(value);
    photo::save(&place.path(name), &frame, 16).unwrap();
}

/// Mean of a raw frame, full scale 1.
fn mean(place: &Place, name: &str) -> f64 {
    let frame = raw::load(&place.path(name), &RawOptions::default()).unwrap();
    frame.pixels().mapv(f64::from).mean().unwrap() / 65536.0
}

fn record(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(place.path(name)).unwrap()).unwrap()
}

const CAPTURE: &str = "--psi 0 --camera clear --no-measure --out raw.png";

#[test]
fn a_png_that_states_linear_light_is_taken_so() {
    let place = Place::new();
    let cicp = |transfer: u8| vec![1, transfer, 0, 1];
    let gamma = |value: u32| value.to_be_bytes().to_vec();
    let (linear, decoded) = (0.5, f64::from(Tone::Srgb.decode(0.5)));
    let bt709 = "a.png: states BT.709's curve (cICP 1), which is not applied; its values are taken as srgb";
    for (chunk, option, light, tone, note) in [
        (None, "", decoded, "srgb", ""),
        (None, "--tone linear", linear, "linear", ""),
        (Some((b"gAMA", gamma(45_455))), "", decoded, "srgb", ""),
        (
            Some((b"gAMA", gamma(100_000))),
            "",
            linear,
            "linear",
            "a.png: states linear light (gAMA 1); its values are taken as linear",
        ),
        (Some((b"gAMA", gamma(100_000))), "--tone linear", linear, "linear", ""),
        (
            Some((b"gAMA", gamma(100_000))),
            "--tone srgb",
            decoded,
            "srgb",
            "--tone srgb: taken, though a.png states linear light (gAMA 1)",
        ),
        (Some((b"cICP", cicp(8))), "", linear, "linear", "a.png: states linear light (cICP 8)"),
        (
            Some((b"cICP", cicp(13))),
            "--tone linear",
            linear,
            "linear",
            "--tone linear: taken, though a.png states sRGB codes (cICP 13)",
        ),
        (Some((b"cICP", cicp(16))), "", decoded, "srgb", "a.png: states PQ (cICP 16), which is not applied"),
        (Some((b"cICP", cicp(1))), "", decoded, "srgb", bt709),
    ] {
        flat(&place, "a.png", 0.5);
        if let Some((kind, content)) = &chunk {
            add_chunk(&place, "a.png", kind, content);
        }
        let run = place.edof(&format!("capture a.png {CAPTURE} {option}")).done();
        let found = mean(&place, "raw.png");
        assert!((found - light).abs() < 4e-4, "{chunk:?} {option}: {found}");
        assert_eq!(record(&place, "raw.png.json")["tone"], tone, "{chunk:?} {option}");
        assert!(run.err.contains(note), "{chunk:?} {option}: {}", run.err);
        assert_eq!(run.err.contains("a.png"), !note.is_empty(), "{chunk:?} {option}: {}", run.err);
    }
}

#[test]
fn each_picture_of_a_scene_has_the_curve_that_it_states() {
    let place = Place::new();
    flat(&place, "back.png", 0.5);
    add_chunk(&place, "back.png", b"gAMA", &100_000u32.to_be_bytes());
    let scene = r#"{"layers": [{"picture": "back.png", "depth": 0}]}"#;
    place.write("scene.json", scene);
    let run = place.edof("capture scene.json --camera clear --no-measure --out raw.png").done();
    assert!(
        (mean(&place, "raw.png") - 0.5).abs() < 4e-4 && run.err.contains("back.png: states linear light")
    );
    assert_eq!(record(&place, "raw.png.json")["tone"], "linear");
}

#[test]
fn a_photograph_and_its_depth_map_are_turned_as_they_are_seen() {
    let place = Place::new();
    // 48 columns and 32 rows as stored, a quarter turn as seen; the map is stored as it is seen.
    flat(&place, "a.png", 0.5);
    let exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    add_chunk(&place, "a.png", b"eXIf", exif);
    let run = place.edof(&format!("capture a.png {CAPTURE} --json")).done();
    let made: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!((&made["width"], &made["height"]), (&Value::from(32), &Value::from(48)));
    place.write("map.pgm", format!("P2 32 48 255 {}", "255 ".repeat(32 * 48)));
    place
        .edof("capture a.png --camera clear --depth-map map.pgm --range 4:0 --no-measure --out raw.png")
        .done();
}

#[test]
fn a_cameras_raw_frame_is_no_photograph() {
    let place = Place::new();
    let mut tiff = b"II*\0\x08\0\0\0\x07\0".to_vec();
    for (tag, value) in [(256u16, 2u32), (257, 2), (258, 8), (262, 1), (273, 98), (279, 4), (50706, 1)] {
        tiff.extend([&tag.to_le_bytes()[..], &[4, 0], &1u32.to_le_bytes(), &value.to_le_bytes()].concat());
    }
    tiff.extend([0, 0, 0, 0, 1, 2, 3, 4]);
    for name in ["shot.dng", "shot.tif"] {
        place.write(name, &tiff);
        let run = place.edof(&format!("capture {name} {CAPTURE}"));
        run.refused(&[&format!("{name}: contains a camera's raw frame (DNG"), "expected a picture"]);
    }
}

#[test]
fn a_sidecar_of_another_program_is_passed_over_and_never_replaced() {
    let place = Place::new();
    place.raw("shot.png", 48, 32);
    place.fixed_network("net.safetensors");
    let foreign = "{\"rating\": 4, \"history\": [\"exposure\"]}";
    place.write("shot.png.json", foreign);
    let line = "reconstruct shot.png --bit-depth 12 --weights net.safetensors --out out.png";
    let run = place.edof(line).done();
    assert!(run.err.contains("shot.png.json: is not a raw-frame record of edof; passed over"), "{}", run.err);
    // What cannot be read is not blamed on it.
    let run = place.edof(&format!("{line} --white-level 0"));
    assert!(run.code == Some(1) && run.err.contains("edof: shot.png: --white-level 0"), "{}", run.err);
    flat(&place, "a.png", 0.5);
    let before = place.snapshot();
    let run = place.edof("capture a.png --psi 0 --camera clear --no-measure --out shot.png");
    run.refused(&[
        "the record beside --out shot.png.json: would replace other JSON",
        "move this one away first",
    ]);
    assert!(place.snapshot() == before);
}

/// A 16-bit grey PNG of 4 rows.
fn map(place: &Place, row: &[u16]) {
    let planes = Array3::from_shape_fn((1, 32, 48), |(_, _, c)| row[c * row.len() / 48]);
    edof_io::picture::save(&place.path("map.png"), &Samples { planes, full_scale: u16::MAX }).unwrap();
}

#[test]
fn a_depth_map_in_millimetres_gives_the_psi_of_its_distances() {
    let place = Place::new();
    place.photo("photo.png", 48, 32);
    let capture = |more: &str| {
        place.edof(&format!(
            "capture photo.png --camera clear --depth-map map.png {more} --no-measure --out raw.png --json"
        ))
    };
    let psi = |run: &crate::support::Run| -> Vec<f64> {
        let made: Value = serde_json::from_str(&run.out).unwrap();
        made["psi"].as_array().unwrap().iter().map(|psi| psi.as_f64().unwrap()).collect()
    };
    let is_near = |found: &[f64], expected: &[f64]| {
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-3)
    };
    // R = 2.3 mm, wavelength 460 nm, so that pi R²/wavelength is 36.128 m; psi 0 at 10 m.
    // 36.128*(1/3.111 - 1/10) = 8.000, 36.128*(1/4 - 1/10) = 5.419.
    map(&place, &[3111, 4000, 10_000]);
    let run = capture("--map-unit mm --nominal 10").done();
    assert!(is_near(&psi(&run), &[0.0, 5.419, 8.000]), "{:?}", psi(&run));
    assert!(!run.err.contains("map.png"), "{}", run.err);
    // The same in another unit, and with what a range finder's users may state besides.
    map(&place, &[6222, 8000, 20_000]);
    let run = capture("--map-unit 0.5mm --nominal 10 --map-of distance --range 3m:12m").done();
    assert!(is_near(&psi(&run), &[0.0, 5.419, 8.000]), "{:?}", psi(&run));
    // Holes are no depth of their own.
    map(&place, &[0, 3111, 4000, 65535, 10_000, 0]);
    let run = capture("--map-unit mm --nominal 10").done();
    assert!(is_near(&psi(&run), &[0.0, 5.419, 8.000]), "{:?}", psi(&run));
    let note = "map.png: 768 pixels without a reading (0 or 65535), filled with the nearest one";
    assert!(run.err.contains(note), "{}", run.err);
    // Limits: 36.128*(1/4 - 1/10), 36.128*(1/5 - 1/10).
    map(&place, &[3111, 4500, 10_000]);
    let run = capture("--map-unit mm --nominal 10 --range 4m:5m").done();
    assert!(is_near(&psi(&run), &[3.613, 4.416, 5.419]), "{:?}", psi(&run));
    assert!(run.err.contains("map.png: 1024 pixels outside of --range 4m:5m"), "{}", run.err);
}

#[test]
fn a_depth_map_in_a_unit_that_gives_no_depth_is_rejected() {
    let place = Place::new();
    place.photo("photo.png", 48, 32);
    let refused = |row: &[u16], more: &str, words: &[&str]| {
        map(&place, row);
        let line = format!("capture photo.png --camera clear --depth-map map.png {more} --out raw.png");
        place.edof(&line).refused(words);
    };
    refused(&[0, 65535], "--map-unit mm --nominal 10", &["map.png: has no reading"]);
    refused(&[0, 3000], "--map-unit mm", &["map.png", "nominal_m"]);
    refused(&[0, 3000], "--map-unit mm --range 1m:4m", &["map.png", "nominal_m"]);
    refused(&[1, 3000], "--map-unit mm --nominal 10", &["map.png: ", "0.001m:3m", "within 200"]);
    for (more, words) in [
        ("--map-unit km", "unit 'km': must be mm, cm or m, or a multiple such as 0.2mm"),
        ("", "--range <NEAR:FAR>|--map-unit <UNIT>"),
    ] {
        let line = format!("capture photo.png --camera clear --depth-map map.png {more} --out raw.png");
        let run = place.edof(&line);
        assert!(run.code == Some(2) && run.err.contains(words), "{}", run.err);
    }
}
