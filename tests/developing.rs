//! What `edof reconstruct` makes of a sensor's levels and colours, and of several frames.

use crate::support::Place;
use edof_core::{CfaPhase, RawFrame};
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use ndarray::Array2;
use serde_json::Value;

const GREY: &str = "--weights net.safetensors --float --tone linear --bits 16";

/// A 12-bit frame of one value.
fn flat(place: &Place, name: &str, value: u16) {
    let frame = RawFrame::from_values(Array2::from_elem((32, 48), value), 12, CfaPhase::Rggb).unwrap();
    raw::save(&place.path(name), &frame).unwrap();
}

/// The middle of a picture: red, green, blue.
fn colour(place: &Place, name: &str) -> [f32; 3] {
    let picture = photo::load(&place.path(name)).unwrap();
    [0, 1, 2].map(|plane| picture.planes[(plane, 16, 24)])
}

#[track_caller]
fn assert_near(found: [f32; 3], expected: [f32; 3]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}, not {expected:?}");
}

#[test]
fn levels_balance_and_matrix_of_the_options_reach_the_picture() {
    let place = Place::new();
    place.float_network("net.safetensors");
    flat(&place, "raw.pgm", 564);
    let made = |more: &str| {
        place.edof(&format!("reconstruct raw.pgm {GREY} --out out.png {more}")).done();
        colour(&place, "out.png")
    };
    let plain = 564.0 / 4096.0;
    assert_near(made(""), [plain; 3]);
    assert_near(made("--black-level 64 --white-level 2064"), [0.25; 3]);
    assert_near(made("--black-level 64,64,64,64 --white-level 2064"), [0.25; 3]);
    assert_near(made("--black-level 64 --white-level 2064 --white-balance 2,1,3"), [0.5, 0.25, 0.75]);
    assert_near(made("--white-balance 1,0.5,2"), [2.0 * plain, plain, 4.0 * plain]);
    let matrix = "--colour-matrix 0.5,0.5,0,0,1,0,-0.5,0,1.5";
    assert_near(
        made(&format!("--black-level 64 --white-level 2064 --white-balance 2,1,3 {matrix}")),
        [0.375, 0.25, 0.875],
    );
}

#[test]
fn a_captured_black_level_is_recorded_and_taken_off() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place.float_network("net.safetensors");
    let capture = "capture photo.png --camera clear --psi 0 --tone linear --no-measure --phase grbg";
    place.edof(&format!("{capture} --out plain.png")).done();
    place.edof(&format!("{capture} --black-level 240 --out lifted.png")).done();
    let raws = ["plain.png", "lifted.png"].map(|name| photo::load_grey(&place.path(name)).unwrap());
    assert!(raws[1].iter().zip(&raws[0]).all(|(lifted, plain)| lifted > plain));
    for name in ["plain", "lifted"] {
        place.edof(&format!("reconstruct {name}.png {GREY} --out {name}-out.png")).done();
    }
    let pictures = ["plain-out.png", "lifted-out.png"].map(|name| photo::load(&place.path(name)).unwrap());
    let worst = (&pictures[0].planes - &pictures[1].planes).iter().fold(0.0f32, |max, d| max.max(d.abs()));
    assert!(worst < 1.5 / 4096.0, "{worst}");
    place
        .edof(&format!("reconstruct lifted.png {GREY} --black-level 64 --out no.png"))
        .refused(&["--black-level 64: lifted.png.json says 240; leave --black-level out"]);
}

#[test]
fn balance_and_matrix_of_a_record_are_used_unless_others_are_given() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place.float_network("net.safetensors");
    place.edof("capture photo.png --camera clear --psi 0 --tone linear --no-measure --out raw.png").done();
    let made = |more: &str| {
        place.edof(&format!("reconstruct raw.png {GREY} --out out.png {more}")).done();
        colour(&place, "out.png")
    };
    let [grey, ..] = made("");
    let text = std::fs::read_to_string(place.path("raw.png.json")).unwrap();
    let mut record: Value = serde_json::from_str(&text).unwrap();
    record["white_balance"] = serde_json::json!([1.5, 1.0, 1.25]);
    record["colour_matrix"] = serde_json::json!([[0, 1, 0], [1, 0, 0], [0, 0, 1]]);
    place.write("raw.png.json", record.to_string());
    assert_near(made(""), [grey, 1.5 * grey, 1.25 * grey]);
    assert_near(made("--white-balance 1,1,1.6"), [grey, grey, 1.6 * grey]);
    record["white_balance"] = serde_json::json!([1.5, 0.0, 1.25]);
    place.write("raw.png.json", record.to_string());
    place
        .edof(&format!("reconstruct raw.png {GREY} --out no.png"))
        .refused(&["raw.png.json", "white balance '1.5,0,1.25'"]);
}

#[test]
fn levels_that_cannot_be_are_rejected_by_the_frames_name() {
    let place = Place::new();
    place.float_network("net.safetensors");
    flat(&place, "raw.pgm", 564);
    let refused = |more: &str, words: &[&str]| {
        place.edof(&format!("reconstruct raw.pgm {GREY} --out out.png {more}")).refused(words);
    };
    refused("--black-level 4096", &["raw.pgm: --black-level 4096: must be less than the white level, 4096"]);
    refused("--white-level 5000", &["raw.pgm: --white-level 5000", "at most 4096, for a sensor of 12 bits"]);
    let wrong = |more: &str| place.edof(&format!("reconstruct raw.pgm {GREY} --out out.png {more}"));
    for (more, words) in [
        ("--black-level 1,2", "black level '1,2': must be one sensor value"),
        ("--white-balance 1,1", "white balance '1,1': must be factors"),
        ("--colour-matrix 1,0,0,0,1,0,0,0,2", "row 3 adds up to 2.000"),
    ] {
        let run = wrong(more);
        assert!(run.code == Some(2) && run.err.contains(words), "{more}: {}", run.err);
    }
    assert_eq!(place.files(), ["net.safetensors", "raw.pgm"]);
}

/// The smallest DNG: one strip of 16-bit values; black level 100, white 2100, white balance 2, 1, 1.25.
fn dng(compression: u16, values: &[u16]) -> Vec<u8> {
    const TAGS: usize = 15;
    let short = |tag: u16, v: u16| (tag, 3u16, 1u32, u32::from(v).to_le_bytes());
    let long = |tag: u16, count: u32, v: usize| (tag, 4u16, count, (v as u32).to_le_bytes());
    let behind = 8 + 2 + 12 * TAGS + 4;
    let tags: [(u16, u16, u32, [u8; 4]); TAGS] = [
        short(256, 48),
        short(257, 32),
        short(258, 16),
        short(259, compression),
        short(262, 32803),
        long(273, 1, behind + 24),
        short(277, 1),
        short(278, 32),
        long(279, 1, 2 * values.len()),
        (33421, 3, 2, [2, 0, 2, 0]),
        (33422, 1, 4, [1, 0, 2, 1]),
        (50706, 1, 4, [1, 4, 0, 0]),
        short(50714, 100),
        short(50717, 2100),
        (50728, 5, 3, (behind as u32).to_le_bytes()),
    ];
    let mut file = b"II*\0\x08\0\0\0".to_vec();
    file.extend((TAGS as u16).to_le_bytes());
    for (tag, kind, count, value) in tags {
        file.extend([&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value].concat());
    }
    file.extend(0u32.to_le_bytes());
    file.extend([1u32, 2, 1, 1, 4, 5].iter().flat_map(|v| v.to_le_bytes()));
    file.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    file
}

#[test]
fn a_dng_is_reconstructed_in_its_own_levels_and_colours() {
    let place = Place::new();
    place.float_network("net.safetensors");
    place.write("shot.dng", dng(1, &[600; 48 * 32]));
    let line = format!("reconstruct shot.dng {GREY} --out out.png");
    place.edof(&line).done();
    assert_near(colour(&place, "out.png"), [0.5, 0.25, 0.3125]);
    place.edof(&format!("{line} --black-level 200 --white-level 2200 --white-balance 1,1,1")).done();
    assert_near(colour(&place, "out.png"), [0.2; 3]);
    let run = place.edof(&format!("{line} --phase rggb")).done();
    assert!(
        run.err.contains("shot.dng: CFAPattern (33422) states grbg; rggb is used as stated"),
        "{}",
        run.err
    );
    place.write("shot.dng", dng(34892, &[600; 48 * 32]));
    place.edof(&line).refused(&[
        "shot.dng: ",
        "Compression (259) is 34892 (lossy JPEG), expected 1 (none) or 7 (lossless JPEG)",
    ]);
    place.write("shot.dng", &dng(1, &[600; 48 * 32])[..900]);
    place.edof(&line).refused(&["shot.dng: ", "the file is cut: it ends before its pixels do"]);
}

#[test]
fn a_linear_picture_states_so_and_is_captured_as_light() {
    let place = Place::new();
    place.float_network("net.safetensors");
    flat(&place, "raw.pgm", 1024);
    let captured_as = |options: &str, name: &str| {
        let line = "reconstruct raw.pgm --weights net.safetensors --float --bits 16";
        let written = place.edof(&format!("{line} {options} --out {name}")).done();
        assert_eq!(written.err.contains("a PPM has no place"), name.ends_with("ppm"), "{}", written.err);
        let run =
            place.edof(&format!("capture {name} --psi 0 --camera clear --no-measure --out b.png")).done();
        (raw::load(&place.path("b.png"), &RawOptions::default()).unwrap().pixels()[(16, 24)], run.err)
    };
    let captured = |options: &str| captured_as(options, "a.png");
    let (light, note) = captured_as("--tone srgb --gamma linear", "a.tif");
    assert!(
        light.abs_diff(16384) < 40 && note.contains("a.tif: states linear light (ICC profile)"),
        "{light} {note}"
    );
    let (_, note) = captured_as("--tone srgb --gamma bt709", "a.tif");
    assert!(note.contains("a.tif: states another curve (ICC profile"), "{note}");
    captured_as("--tone srgb --gamma linear", "a.ppm");
    let (light, note) = captured("--tone srgb --gamma linear");
    assert!(
        light.abs_diff(16384) < 40 && note.contains("a.png: states linear light (gAMA 1)"),
        "{light} {note}"
    );
    let (_, note) = captured("--tone srgb --gamma bt709");
    assert!(note.contains("a.png: states BT.709's curve (cICP 1)"), "{note}");
    // sRGB needs no word, and in the paper's convention light is what a screen shows as it is.
    for options in ["--tone srgb", "--tone linear"] {
        assert!(!captured(options).1.contains("states"), "{options}");
    }
}

#[test]
fn the_board_names_what_it_leaves_out_of_a_dng() {
    let place = Place::new();
    place.fixed_network("net.fixed.safetensors");
    place.write("shot.dng", dng(1, &[600; 48 * 32]));
    let run = place.edof("reconstruct shot.dng --weights net.fixed.safetensors --board --out o.png").done();
    assert!(run.err.contains("shot.dng: not applied, as the board does not: white balance"), "{}", run.err);
}

#[test]
fn a_dark_dng_is_given_no_advice_that_is_an_error_beside_it() {
    let place = Place::new();
    place.float_network("net.safetensors");
    place.write("shot.dng", dng(1, &[101; 48 * 32]));
    let run = place.edof(&format!("reconstruct shot.dng {GREY} --out o.png")).done();
    assert!(
        run.err.contains("brightest pixel is 33 of 65535; a dark picture, or --white-level"),
        "{}",
        run.err
    );
    assert!(!run.err.contains("--bit-depth") && !run.err.contains("--align"), "{}", run.err);
}

#[test]
fn an_order_of_bytes_without_effect_is_an_error() {
    let place = Place::new();
    place.float_network("net.safetensors");
    place.write("frame.raw", [7; 48 * 32]);
    place.raw("raw.png", 48, 32);
    place.write("shot.dng", dng(1, &[600; 48 * 32]));
    for (file, packing, what) in
        [("frame.raw", "--packing bytes", "pixels that are no words"), ("raw.png", "", "a PNG picture")]
    {
        let line = format!("reconstruct {file} {GREY} --size 48x32 {packing} --order big --out o.png");
        place.edof(&line).refused(&[&format!("--order big: has no effect on {file}, {what}")]);
    }
    place
        .edof("sensor --dark frame.raw --size 48x32 --packing bytes --order big --out s")
        .refused(&["--order big: has no effect on bytes, which has no words"]);
    let line = format!("reconstruct frame.raw {GREY} --size 48x16 --order big --out o.png");
    place.edof(&line).done();
}

#[test]
fn options_that_describe_values_have_no_place_beside_a_dng() {
    let place = Place::new();
    place.float_network("net.safetensors");
    place.write("shot.dng", dng(1, &[600; 48 * 32]));
    for option in [
        "--size 48x32",
        "--bit-depth 12",
        "--align bottom",
        "--size 48x32 --packing words",
        "--video --size 48x32",
    ] {
        let run = place.edof(&format!("reconstruct shot.dng {GREY} {option} --out out.png"));
        let name = option.split(' ').next().unwrap();
        assert!(
            run.code == Some(1) && run.err.contains("has no effect on shot.dng, a DNG"),
            "{option}: {}",
            run.err
        );
        assert!(run.err.contains(name) || run.err.contains("--size"), "{option}: {}", run.err);
    }
    assert_eq!(place.files(), ["net.safetensors", "shot.dng"]);
}

#[test]
fn a_dng_is_known_by_its_content() {
    let place = Place::new();
    place.float_network("net.safetensors");
    for name in ["shot.tif", "shot", "shot.png"] {
        place.write(name, dng(1, &[600; 48 * 32]));
        place.edof(&format!("reconstruct {name} {GREY} --out out.png")).done();
        assert_near(colour(&place, "out.png"), [0.5, 0.25, 0.3125]);
        std::fs::remove_file(place.path(name)).unwrap();
    }
    place.raw("frame.png", 48, 32);
    std::fs::rename(place.path("frame.png"), place.path("frame.dng")).unwrap();
    let run = place.edof("reconstruct frame.dng --weights net.safetensors --float --out out.png").done();
    assert!(!run.err.contains("DNG"), "{}", run.err);
}

#[test]
fn several_frames_become_pictures_of_their_names_in_a_folder() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    for (name, value) in [("a.pgm", 500), ("b.pgm", 1000), ("c.pgm", 2000)] {
        flat(&place, name, value);
    }
    let line =
        "reconstruct a.pgm b.pgm c.pgm --weights net.safetensors --tone linear --out shown --json made.json";
    place.edof(line).done();
    for (name, value) in [("a", 500.0), ("b", 1000.0), ("c", 2000.0)] {
        let [_, green, _] = colour(&place, &format!("shown/{name}.png"));
        assert!((green - value / 4096.0f32).abs() < 2.0 / 255.0, "{name}: {green}");
    }
    let made: Value = serde_json::from_slice(&std::fs::read(place.path("made.json")).unwrap()).unwrap();
    let pictures: Vec<&str> =
        made["frames"].as_array().unwrap().iter().map(|f| f["picture"].as_str().unwrap()).collect();
    assert_eq!(pictures, ["shown/a.png", "shown/b.png", "shown/c.png"]);
    place.edof("reconstruct a.pgm --weights net.safetensors --out shown").done();
    place.edof("reconstruct b.pgm --weights net.safetensors --board --out board/").done();
    assert!(place.path("board/b.png").is_file() && place.path("board/b.yuyv").is_file());
}

#[test]
fn a_captured_frame_without_a_header_is_read_by_its_record() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let picture = |raw: &str| {
        let taken = "--psi 2 --phase gbrg --black-level 64 --bit-depth 10 --noise 0.01";
        place.edof(&format!("capture photo.png {taken} --out {raw}")).done();
        place.edof(&format!("reconstruct {raw} --out {raw}.sharp.png")).done();
        std::fs::read(place.path(&format!("{raw}.sharp.png"))).unwrap()
    };
    let [plain, with_header] = ["f.raw", "f.png"].map(picture);
    assert!(plain == with_header);
    let refused = |options: &str, words: &str| {
        place.edof(&format!("reconstruct f.raw {options} --out no.png")).refused(&[words]);
    };
    refused("--size 48x64", "--size 48x64: f.raw.json says 64x48; leave --size out");
    refused("--size 64x48 --packing 12p", "--packing 12p: f.raw.json says words; leave --packing out");
    refused("--bit-depth 12", "--bit-depth 12: f.raw.json says 10; leave --bit-depth out");
}

#[test]
fn out_means_the_same_for_one_frame_as_for_many() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    ["a.pgm", "b.pgm"].iter().for_each(|name| flat(&place, name, 700));
    for (frames, out) in [("a.pgm", "one"), ("a.pgm b.pgm", "two")] {
        place.edof(&format!("reconstruct {frames} --weights net.safetensors --out {out}")).done();
        assert!(place.path(&format!("{out}/a.png")).is_file(), "{out}");
    }
    let same = ["one/a.png", "two/a.png"].map(|file| std::fs::read(place.path(file)).unwrap());
    assert!(same[0] == same[1]);
    // An ending that no picture has is a mistake in both.
    place.edof("reconstruct a.pgm --weights net.safetensors --out x.pgn").refused(&["x.pgn: unknown ending"]);
    place
        .edof("reconstruct a.pgm b.pgm --weights net.safetensors --out x.pgn")
        .refused(&["--out x.pgn: 2 frames need a folder"]);
}

#[test]
fn several_frames_want_a_folder_and_names_of_their_own() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    std::fs::create_dir(place.path("other")).unwrap();
    for name in ["a.pgm", "b.pgm", "other/a.pgm", "a.png"] {
        flat(&place, name, 700);
    }
    let refused = |line: &str, words: &[&str]| {
        let before = place.snapshot();
        place.edof(&format!("reconstruct {line} --weights net.safetensors")).refused(words);
        assert_eq!(place.snapshot(), before, "{line}");
    };
    refused("a.pgm b.pgm --out x.png", &["--out x.png: 2 frames need a folder, not a picture"]);
    refused("a.pgm other/a.pgm --out shown", &["--out shown/a.png: is written by --out too"]);
    refused("a.png b.pgm --out .", &["--out ./a.png: would replace a.png"]);
    refused("a.pgm b.pgm --words w --out shown", &["--words w: of one frame only, not of 2"]);
    refused("a.pgm none.pgm --out shown", &["none.pgm: cannot read"]);
}
