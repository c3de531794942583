//! `edof sensor` and `--sensor`: faults of a sensor are found, and its frames become those of a sensor without.

use crate::support::{Place, Run};
use edof_core::{CfaPhase, RawFrame, Reconstructor};
use edof_deblur::Directional;
use edof_io::raw;
use ndarray::{Array2, Array3};
use serde_json::Value;

const SIZE: (usize, usize) = (64, 96);
const BLACK: u16 = 200;
const HOT: [(usize, usize); 3] = [(9, 14), (30, 71), (50, 50)];
const DEAD: (usize, usize) = (20, 33);
const COLUMN: usize = 40;
const SCENE: u16 = 2100;
const LINE: &str = "--weights net.fixed.safetensors --phase grbg";

/// Sensor values of even light, of a slope for [`SCENE`], with faults or without.
fn frame(light: u16, has_faults: bool) -> RawFrame {
    let value = |(r, c): (usize, usize)| {
        // The noise of a sensor, always the same.
        let noise = ((r * 131 + c * 37 + r * c + usize::from(light)) % 5) as u16;
        let scene = light + if light == SCENE { (r * 3 + c) as u16 } else { 0 };
        match (r, c) {
            _ if !has_faults => scene + noise,
            (_, COLUMN) => 0,
            at if at == DEAD => BLACK + scene / 3,
            at if HOT.contains(&at) => BLACK + scene + 900,
            (_, c) => BLACK + scene + noise + if c % 9 == 2 { 30 } else { 0 },
        }
    };
    RawFrame::from_values(Array2::from_shape_fn(SIZE, value), 12, CfaPhase::Grbg).unwrap()
}

/// A place with a sensor file, the frames that it was made of, and a frame with and without faults.
fn ready() -> (Place, Run) {
    let place = Place::new();
    place.fixed_network("net.fixed.safetensors");
    for i in 0..4 {
        raw::save(&place.path(&format!("dark{i}.pgm")), &frame(0, true)).unwrap();
        raw::save(&place.path(&format!("flat{i}.pgm")), &frame(1500, true)).unwrap();
    }
    raw::save(&place.path("raw.pgm"), &frame(SCENE, true)).unwrap();
    raw::save(&place.path("other.pgm"), &frame(SCENE, false)).unwrap();
    let frames = |kind: &str| (0..4).map(|i| format!("{kind}{i}.pgm")).collect::<Vec<_>>().join(" ");
    let line = format!("sensor --dark {} --flat {} --phase grbg", frames("dark"), frames("flat"));
    let run = place.edof(&format!("{line} --out sensor.safetensors --json sensor.json")).done();
    (place, run)
}

#[test]
fn faults_are_found_printed_and_gone_from_the_picture() {
    let (place, run) = ready();
    let told: Value = serde_json::from_slice(&std::fs::read(place.path("sensor.json")).unwrap()).unwrap();
    assert_eq!((&told["dark"]["hot"], &told["defective_columns"][0]), (&3.into(), &COLUMN.into()), "{told}");
    assert_eq!(
        (&told["defective_pixels"], told["provenance"]["inputs"].as_array().unwrap().len()),
        (&4.into(), 8)
    );
    for words in
        ["dark: 4 frames, black 202.", "3 hot and 0 cold", "defects: 4 pixels, 1 column (40), 0 rows"]
    {
        assert!(run.out.contains(words), "{words}: {}", run.out);
    }
    // Light without faults, and the same scene through the faulty sensor: what is left is noise.
    let picture = |raw: &str, more: &str| {
        place.edof(&format!("reconstruct {raw} {LINE} {more} --bits 16 --tone linear --out out.png")).done();
        edof_io::photo::load(&place.path("out.png")).unwrap().planes
    };
    let clean = picture("other.pgm", "--white-level 3894");
    let far = |other: &ndarray::Array3<f32>| {
        clean.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    let (corrected, raw) =
        (picture("raw.pgm", "--sensor sensor.safetensors"), picture("raw.pgm", "--black-level 200"));
    assert!(far(&corrected) < 0.1 * far(&raw), "{} of {}", far(&corrected), far(&raw));
}

#[test]
fn a_stream_is_corrected_as_a_frame_is() {
    let (place, _) = ready();
    let bytes: Vec<u8> = frame(SCENE, true).values().iter().flat_map(|v| v.to_le_bytes()).collect();
    place.write("raw.raw", &bytes);
    let sensor = format!("{LINE} --sensor sensor.safetensors");
    place
        .edof(&format!(
            "stream raw.raw --size 96x64 --bit-depth 12 {sensor} --format yuyv422 --out stream.yuyv"
        ))
        .done();
    place.edof(&format!("reconstruct raw.pgm {sensor} --board --out board.png")).done();
    let codes = |name: &str| std::fs::read(place.path(name)).unwrap();
    // The board's cable drops the two lowest bits of light.
    let far = codes("stream.yuyv").iter().zip(codes("board.yuyv")).map(|(a, b)| a.abs_diff(b)).max();
    assert!(far <= Some(1), "{far:?}");
    // A file of many frames is measured as its frames are.
    let all: Vec<u8> = (0..4)
        .flat_map(|_| frame(0, true).values().into_raw_vec_and_offset().0)
        .flat_map(u16::to_le_bytes)
        .collect();
    place.write("dark.raw", all);
    let line = "sensor --dark dark.raw --size 96x64 --bit-depth 12 --phase grbg --out many.safetensors --json many.json";
    place.edof(line).done();
    let told = |file: &str| serde_json::from_slice::<Value>(&codes(file)).unwrap()["dark"].clone();
    assert_eq!(told("many.json"), told("sensor.json"));
}

/// A DNG of a frame's values, without colours: a directory of tags whose numbers fit into it.
fn dng(frame: &RawFrame) -> Vec<u8> {
    let values = frame.values();
    let (rows, columns) = values.dim();
    let [red, green, blue] = [0u8, 1, 2];
    let bayer = u32::from_le_bytes([green, red, blue, green]);
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let tags: [(u16, u16, u32, u32); 14] = [
        (254, 4, 1, 0),
        (256, 4, 1, columns as u32),
        (257, 4, 1, rows as u32),
        (258, 3, 1, 16),
        (259, 3, 1, 1),
        (262, 3, 1, 32803),
        (273, 4, 1, 8 + 2 + 12 * 14 + 4),
        (277, 3, 1, 1),
        (278, 4, 1, rows as u32),
        (279, 4, 1, bytes.len() as u32),
        (33421, 3, 2, 2 << 16 | 2),
        (33422, 1, 4, bayer),
        (50706, 1, 4, 0x0401),
        (50717, 4, 1, 4095),
    ];
    let directory = tags.iter().flat_map(|(tag, kind, count, value)| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value.to_le_bytes()].concat()
    });
    let head = b"II*\0\x08\0\0\0".iter().copied().chain((tags.len() as u16).to_le_bytes());
    head.chain(directory).chain([0; 4]).chain(bytes).collect()
}

#[test]
fn a_sensor_file_of_dngs_is_for_dngs_and_one_of_other_frames_is_not() {
    let (place, _) = ready();
    place.write("raw.dng", dng(&frame(SCENE, true)));
    place.write("dark.dng", dng(&frame(0, true)));
    place.write("flat.dng", dng(&frame(1500, true)));
    let sensor = "sensor --phase grbg --out s.safetensors";
    place.edof("sensor --dark dark.dng --flat flat.dng --out dng.safetensors").done();
    place
        .edof(&format!("{sensor} --dark dark.dng --flat flat0.pgm"))
        .refused(&["flat0.pgm: DNGs hold light, other frames hold sensor values; name frames of one kind"]);
    let line = "reconstruct --weights net.fixed.safetensors --out o.png";
    place.edof(&format!("{line} raw.dng --sensor dng.safetensors")).done();
    place.edof(&format!("{line} raw.dng --sensor sensor.safetensors")).refused(&[
        "raw.dng: its values are light by the file's own levels",
        "the sensor file was made from sensor values; make one from DNGs by 'edof sensor'",
    ]);
    place
        .edof(&format!("{line} raw.pgm --phase grbg --sensor dng.safetensors"))
        .refused(&["raw.pgm: holds sensor values, the sensor file was made from DNGs"]);
    place.write("words.raw", vec![0; 2 * 96 * 64]);
    let stream = "stream words.raw --size 96x64 --phase grbg --weights net.fixed.safetensors --out o.y4m";
    place
        .edof(&format!("{stream} --sensor dng.safetensors"))
        .refused(&["--sensor dng.safetensors: holds sensor values, the sensor file was made from DNGs"]);
    // A list of defects is of any frames.
    place.write("list.txt", "1,2\n");
    place.edof("sensor --list list.txt --size 96x64 --phase grbg --out list.safetensors").done();
    place.edof(&format!("{line} raw.dng --sensor list.safetensors")).done();
}

#[test]
fn a_sensor_file_without_black_and_flat_frames_of_another_phase_are_named() {
    let (place, _) = ready();
    place.write("list.txt", "1,2\n");
    let size = "--size 96x64 --bit-depth 12 --phase grbg";
    place.edof(&format!("sensor --list list.txt {size} --out list.safetensors")).done();
    let bright: Vec<u8> = [0xff, 0x03].repeat(96 * 64);
    place.write("bright.raw", bright);
    let line = format!("stream bright.raw {size} --weights net.fixed.safetensors --out o.y4m --sensor");
    let pale =
        "the least value of the first frame is 1023 of 4095, and black of --sensor list.safetensors is 0";
    let run = place.edof(&format!("{line} list.safetensors")).done();
    assert!(run.err.contains(pale), "{}", run.err);
    let run = place.edof(&format!("{line} sensor.safetensors")).done();
    assert!(!run.err.contains("the least value"), "{}", run.err);
    // Even white light behind grbg.
    let value = |(r, c): (usize, usize)| [900, 1800, 1200][CfaPhase::Grbg.channel(r, c).plane()];
    let flat = RawFrame::from_values(Array2::from_shape_fn(SIZE, value), 12, CfaPhase::Grbg).unwrap();
    raw::save(&place.path("white.pgm"), &flat).unwrap();
    let told = |phase: &str| {
        place.edof(&format!("sensor --flat white.pgm --phase {phase} --out s.{phase}")).done().err
    };
    let doubt = "flat frames: what --phase rggb takes for green differs as red and blue do";
    assert!(told("rggb").contains(doubt));
    assert!(!told("grbg").contains("takes for green"));
}

#[test]
fn a_plain_picture_is_of_the_corrected_frame() {
    let (place, _) = ready();
    let picture = |options: &str| {
        place.edof(&format!("reconstruct {options} --tone linear --bits 16 --out plain.png")).done();
        edof_io::photo::load(&place.path("plain.png")).unwrap().planes
    };
    let found = picture("raw.pgm --phase grbg --sensor sensor.safetensors --demosaic directional");
    let correction = edof_io::sensor::file::load(&place.path("sensor.safetensors")).unwrap().0;
    let light = correction.light(&frame(SCENE, true)).unwrap();
    let expected = Directional::default().reconstruct(&light).unwrap().frame.planes;
    let far = |found: &Array3<f32>, expected: &Array3<f32>| {
        found.iter().zip(expected).map(|(a, b)| (a - b.clamp(0.0, 1.0)).abs()).fold(0.0, f32::max)
    };
    assert!(far(&found, &expected) < 2e-5, "{}", far(&found, &expected));
    // A DNG states the same.
    place.write("raw.dng", dng(&frame(SCENE, true)));
    let [stated, own] = ["raw.pgm --phase grbg --white-level 4095", "raw.dng"]
        .map(|raw| picture(&format!("{raw} --demosaic malvar")));
    assert!(far(&own, &stated) < 1e-4, "{}", far(&own, &stated));
}

#[test]
fn frames_and_files_that_do_not_fit_are_rejected_by_name() {
    let (place, _) = ready();
    let line = "reconstruct raw.pgm --weights net.fixed.safetensors --out o.png --sensor";
    place
        .edof(&format!("{line} sensor.safetensors"))
        .refused(&["raw.pgm: a frame of 96x64 of phase rggb with 12 bits", "phase grbg"]);
    place
        .edof(&format!("{line} net.fixed.safetensors"))
        .refused(&["net.fixed.safetensors: not a sensor file of edof"]);
    place.edof(&format!("{line} raw.pgm")).refused(&["raw.pgm: not a whole safetensors file"]);
    place.edof(&format!("{line} none")).refused(&["none: cannot read: No such file"]);
    let stream =
        "stream raw.raw --size 96x66 --bit-depth 12 --phase grbg --weights net.fixed.safetensors --out o.y4m";
    place.write("raw.raw", vec![0; 96 * 66 * 2]);
    place
        .edof(&format!("{stream} --sensor sensor.safetensors"))
        .refused(&["--sensor sensor.safetensors: a frame of 96x66", "expected one of 96x64"]);
    for levels in ["--black-level 3", "--white-level 4000"] {
        let run = place.edof(&format!("{line} sensor.safetensors {levels}"));
        assert!(run.code == Some(2) && run.err.starts_with("error: "), "{}", run.err);
    }
    let sensor = "sensor --out s.safetensors --phase grbg";
    place.write("list.txt", "1,2\n64,0\n");
    place.write("wrong.txt", "1;2\n");
    for (options, words) in [
        ("", "nothing to measure; name frames by --dark or --flat"),
        ("--list list.txt", "no frames and no size"),
        ("--list list.txt --size 96x64", "defective pixel at row 64, column 0: outside of frames of 96x64"),
        ("--list wrong.txt --size 96x64", "wrong.txt: line 1: '1;2', expected ROW,COLUMN"),
        ("--dark dark0.pgm --hot 1", "--hot 1: must be from 3 to 100"),
        ("--flat dark0.pgm", "flat frames: the light of red is"),
        ("--dark dark0.pgm --white-level 100", "white level 100: must be above black"),
    ] {
        place.edof(&format!("{sensor} {options}")).refused(&[words]);
    }
    place
        .edof("sensor --dark dark0.pgm --out net.fixed.safetensors")
        .refused(&["would replace a safetensors file"]);
    assert!(!place.path("s.safetensors").exists() && !place.path("o.png").exists());
}
