//! What the program is for, done by the real binary on small inputs.

mod support;

use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use std::io::{BufRead, BufReader};
use std::process::Stdio;
use support::Place;

#[test]
fn a_network_that_copies_gives_the_raw_pixels_back() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.float_network("net.safetensors");
    let line = "reconstruct raw.png --weights net.safetensors --float --stride 4 --bits 16 --out out.png";
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
    let run = place.edof("reconstruct raw.pgm --weights net.safetensors --out out.ppm --json").done();
    let report: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(report["method"], "small.fixed");
    assert_eq!((&report["width"], &report["height"]), (&48.into(), &32.into()));
    assert!(report["multiply_accumulates"].as_u64().unwrap() > 0);
    let raw = raw::load(&place.path("raw.pgm"), &RawOptions::default()).unwrap();
    let picture = photo::load(&place.path("out.ppm")).unwrap();
    for ((_, r, c), v) in picture.planes.indexed_iter() {
        assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1.0 / 255.0);
    }
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
fn a_drawn_scene_is_captured_and_reconstructed() {
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
    let brightness = |frame: &edof_spec::ColourFrame| frame.planes.mean().unwrap();
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
fn a_training_stopped_by_ctrl_c_goes_on_to_the_same_bytes() {
    let whole = with_photos();
    whole.edof(TRAIN).done();

    let broken = with_photos();
    let mut child = broken.command(TRAIN).stderr(Stdio::piped()).spawn().unwrap();
    // It ends by itself: 600 steps, then this fails.
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
fn wrong_usage_is_told_from_failure() {
    assert_eq!(Place::new().edof("reconstruct").code, Some(2));
    assert_eq!(Place::new().edof("reconstructt").code, Some(2));
}
