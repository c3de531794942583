//! What the program is for, done by the real binary on small inputs.

use crate::support::Place;
use edof_core::Tone;
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use serde_json::json;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn a_network_that_copies_gives_the_raw_pixels_back() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.float_network("net.safetensors");
    let line = "reconstruct raw.png --weights net.safetensors --float --stride 4 --bits 16 --tone linear --out out.png";
    let run = place.edof(line).done();
    assert!(run.out.starts_with("out.png: 48x32 by small.float in "), "{}", run.out);
    let raw = raw::load(&place.path("raw.png"), &RawOptions::default()).unwrap();
    let picture = photo::load(&place.path("out.png")).unwrap();
    for ((_, r, c), v) in picture.planes.indexed_iter() {
        assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1e-4);
    }
}

#[test]
fn the_fixed_network_is_the_default_and_reports_as_json() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let run =
        place.edof("reconstruct raw.pgm --weights net.safetensors --tone linear --out out.ppm --json").done();
    let report: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(report["method"], "small.fixed");
    assert_eq!((&report["width"], &report["height"]), (&48.into(), &32.into()));
    // 4×6 patches of (I 4·64) + (M 4·4) + (F 128·4) + (R 128·64); all sparse codes are zero, so I and R alone are carried out.
    assert_eq!(report["multiplications"], json!({ "dense": 24 * 8976, "executed": 24 * 8448 }));
    let raw = raw::load(&place.path("raw.pgm"), &RawOptions::default()).unwrap();
    let picture = photo::load(&place.path("out.ppm")).unwrap();
    for ((_, r, c), v) in picture.planes.indexed_iter() {
        assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1.0 / 255.0);
    }
}

#[test]
fn a_picture_is_encoded_for_looking_at_unless_told_otherwise() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let picture = |more: &str| {
        place.edof(&format!("reconstruct raw.pgm --weights net.safetensors --out out.png {more}")).done();
        photo::load(&place.path("out.png")).unwrap().planes[(1, 5, 7)]
    };
    let light = picture("--tone linear");
    for encoded in [picture(""), picture("--tone srgb"), picture("--tone linear --gamma srgb")] {
        assert!((encoded - Tone::Srgb.encode(light)).abs() < 2.0 / 255.0, "{light} shows as {encoded}");
    }
    assert!((picture("--gamma linear") - light).abs() < 1e-6);
}

#[test]
fn a_frame_that_was_taken_of_codes_gives_codes_back_unless_told_otherwise() {
    let place = Place::new();
    place.photo("photo.png", 128, 96);
    place.fixed_network("net.safetensors");
    place.edof("capture photo.png --camera clear --psi 0 --tone linear --no-measure --out raw.png").done();
    let tone = |more: &str| {
        let line = format!("reconstruct raw.png --weights net.safetensors --out out.png {more} --json");
        let report: serde_json::Value = serde_json::from_str(&place.edof(&line).done().out).unwrap();
        report["tone"].clone()
    };
    assert_eq!((tone(""), tone("--tone srgb --force")), (json!("linear"), json!("srgb")));
}

#[test]
fn the_boards_own_codes_come_with_what_a_screen_shows() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let line = "reconstruct raw.pgm --weights net.safetensors --board --words words --out board.png --json board.json";
    for mode in ["colour", "luma"] {
        place.edof(&format!("{line} --display {mode}")).done();
        let codes = std::fs::read(place.path("board.yuyv")).unwrap();
        let shown = photo::load(&place.path("board.png")).unwrap();
        assert_eq!((codes.len(), shown.size()), (2 * 48 * 32, (32, 48)));
        for (index, pair) in codes.chunks(4).enumerate() {
            // Grey, for this network has no colour: BT.709 studio range.
            assert_eq!((pair[1], pair[3]), (128, 128));
            let grey = (f32::from(pair[2]) - 16.0) * 255.0 / 219.0;
            let pixel = shown.planes[(0, 2 * index / 48, 2 * index % 48 + 1)] * 255.0;
            assert!((pixel - grey).abs() <= 0.51, "{pixel}, expected {grey}");
        }
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(place.path("board.json")).unwrap()).unwrap();
        assert_eq!(report["display"], json!({ "mode": mode, "clamped_chroma": 0, "out_of_gamut": 0 }));
        assert_eq!(report["counters"]["saturated_sums"], 0);
        assert_eq!(report["counters"]["stages"].as_array().unwrap().len(), 3);
    }
    assert_eq!(
        place.files(),
        ["board.json", "board.png", "board.yuyv", "net.safetensors", "raw.pgm", "words"]
    );
}

#[test]
fn a_random_network_reconstructs_and_is_the_same_for_the_same_seed() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    let draw = |name: &str, seed: u32| {
        let form = "two-sided,w8,t3,c12,difference";
        place
            .edof(&format!("random-network --form {form} --bits 10 --stride 4 --seed {seed} --out {name}"))
            .done();
        std::fs::read(place.path(name)).unwrap()
    };
    assert_eq!(draw("a.fixed.safetensors", 7), draw("b.fixed.safetensors", 7));
    assert_ne!(draw("a.fixed.safetensors", 7), draw("c.fixed.safetensors", 8));
    place.edof("reconstruct raw.pgm --weights a.fixed.safetensors --out out.png").done();
}

#[test]
fn a_network_by_name_is_found_under_weights() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    std::fs::create_dir(place.path("weights")).unwrap();
    place.float_network("weights/mine.safetensors");
    place.fixed_network("weights/mine.fixed.safetensors");
    place.edof("reconstruct raw.png --weights mine --out fixed.png").done();
    place.edof("reconstruct raw.png --weights mine --float --out float.png").done();
}

#[test]
fn a_random_scene_is_captured_and_reconstructed() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    place.edof("scene chart --size 128x96 --out scene").done();
    place
        .edof(
            "capture chart --size 128x96 --camera clear --psi 0 --no-measure --out raw.png --sharp sharp.png",
        )
        .done();
    place.edof("reconstruct raw.png --weights net.safetensors --camera clear --out out.png").done();
    let (sharp, out) =
        (photo::load(&place.path("sharp.png")).unwrap(), photo::load(&place.path("out.png")).unwrap());
    assert_eq!((sharp.size(), out.size()), ((96, 128), (96, 128)));
    let brightness = |frame: &edof_core::ColourFrame| frame.planes.mean().unwrap();
    assert!((brightness(&sharp) - brightness(&out)).abs() < 0.02);
}

#[test]
fn the_demo_leaves_a_report_with_its_pictures() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let line = "demo --net net.safetensors --clear-net net.safetensors --height 96 --width 128 --out out --json demo.json";
    let run = place.edof(line).done();
    assert!(run.out.contains("dB"), "{}", run.out);
    let report = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(report.contains("<img") && report.trim_end().ends_with("</html>"));
    let data: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("demo.json")).unwrap()).unwrap();
    assert!(data["pictures"].as_array().is_some_and(|pictures| !pictures.is_empty()), "{data}");
}

const TRAIN: &str = "train --form one-sided,w8,t3,c32,r --camera ring-2018 --images photos --depths 2 --steps 600 \
                     --batch 128 --validate-every 200 --out net.safetensors";

fn with_photos() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.photo("photos/kodim03.png", 288, 256);
    place
}

#[cfg(unix)]
#[test]
fn a_training_stopped_by_ctrl_c_continues_to_the_same_bytes() {
    let whole = with_photos();
    whole.edof(TRAIN).done();

    let broken = with_photos();
    let mut child = broken.command(TRAIN).stderr(Stdio::piped()).spawn().unwrap();
    // Training ends by itself: 600 steps, then this fails.
    while !broken.path("net.safetensors.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let interrupt =
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let last = BufReader::new(child.stderr.take().unwrap()).lines().last().unwrap().unwrap();
    assert_eq!((child.wait().unwrap().code(), last.as_str()), (Some(130), "edof: interrupted"));
    assert_eq!(broken.files(), ["net.safetensors.checkpoint", "photos"]);

    broken.edof(&format!("{TRAIN} --resume")).done();
    assert_eq!(broken.files(), ["net.safetensors", "photos"]);
    let bytes = |place: &Place| std::fs::read(place.path("net.safetensors")).unwrap();
    assert!(bytes(&whole) == bytes(&broken), "the resumed run gave other bytes");
}

#[test]
fn a_training_that_minutes_end_is_validated_there_and_names_the_steps_that_fit() {
    let place = with_photos();
    let line = TRAIN.replace("--steps 600", "--steps 100000000").replace("every 200", "every 100000000");
    let run = place.edof(&format!("{line} --minutes 0.02 --json made.json")).done();
    assert!(run.err.contains("--minutes 0.02: ends at about step "), "{}", run.err);
    assert!(run.err.contains(" of 100000000, expect about "), "{}", run.err);
    let made: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("made.json")).unwrap()).unwrap();
    assert!(made["validation_db"].as_f64().unwrap() > 10.0, "{made}");
    let about = place.edof("weights net.safetensors --json").done().out;
    assert!(about.contains(" --minutes 0.02 "), "{about}");
}

#[test]
fn help_has_examples_and_a_closed_pipe_is_no_error() {
    let place = Place::new();
    let run = place.edof("--help").done();
    assert!(run.out.contains("Examples:") && run.out.contains("edof reconstruct raw.png"));
    let mut child = place.command("--help").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn wrong_usage_is_distinguished_from_failure() {
    assert_eq!(Place::new().edof("reconstruct").code, Some(2));
    assert_eq!(Place::new().edof("reconstructt").code, Some(2));
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_a_name() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.fixed_network("net.safetensors");
    let name = std::ffi::OsStr::from_bytes(b"r\xffw.png");
    std::fs::rename(place.path("raw.png"), place.path("").join(name)).unwrap();
    let mut command = place.command("reconstruct --weights net.safetensors --out out.png --json");
    let run: crate::support::Run = command.arg("-").arg("--").arg(name).output().unwrap().into();
    assert!(run.done().out.contains("\"width\": 48"));
    assert!(place.path("out.png").is_file());
}
