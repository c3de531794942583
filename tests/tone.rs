//! Light and its encoding, and noise, by the real binary.

use crate::support::Place;
use edof::presets::weights;
use edof_core::{ColourFrame, Tone};
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use serde_json::{Value, json};

/// Sensor values of a raw frame of 12 bits.
fn sensor_values(place: &Place, name: &str) -> Vec<u16> {
    let options = RawOptions { depth: Some(12), ..RawOptions::default() };
    raw::load(&place.path(name), &options).unwrap().values().iter().copied().collect()
}

fn read_json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(place.path(name)).unwrap()).unwrap()
}

#[test]
fn a_photograph_is_decoded_to_light_unless_its_numbers_are_taken_for_light() {
    let place = Place::new();
    let mut grey = ColourFrame::zeros(48, 64);
    grey.planes.fill(128.0 / 255.0);
    photo::save(&place.path("grey.png"), &grey, 8).unwrap();
    for (option, light) in [
        ("", Tone::Srgb.decode(128.0 / 255.0)),
        ("--tone srgb", Tone::Srgb.decode(128.0 / 255.0)),
        ("--tone linear", 128.0 / 255.0),
    ] {
        let line = format!("capture grey.png --psi 0 --no-measure --out raw.png --sharp sharp.png {option}");
        place.edof(&line).done();
        let expected = (light * 4096.0).round() as u16;
        assert!(sensor_values(&place, "raw.png").iter().all(|v| v.abs_diff(expected) <= 1), "{option}");
        let sharp = photo::load(&place.path("sharp.png")).unwrap();
        assert!(sharp.planes.iter().all(|v| (v - 128.0 / 255.0).abs() < 1e-4), "{option}");
    }
}

#[test]
fn a_random_scene_is_the_same_light_under_either_tone() {
    let place = Place::new();
    let frames: Vec<Vec<u16>> = ["srgb", "linear"]
        .into_iter()
        .flat_map(|tone| {
            place.edof(&format!("scene chart --size 96x64 --psi 2 --tone {tone} --out {tone}")).done();
            ["chart --size 96x64".to_owned(), format!("{tone}/sharp.png")].map(|scene| {
                let line = format!("capture {scene} --tone {tone} --psi 2 --no-measure --out raw.png");
                place.edof(&line).done();
                sensor_values(&place, "raw.png")
            })
        })
        .collect();
    for frame in &frames {
        assert!(frame.iter().zip(&frames[0]).all(|(a, b)| a.abs_diff(*b) <= 1));
    }
    let dark = |file: &str| photo::load(&place.path(file)).unwrap().planes.mean().unwrap();
    assert!(dark("linear/sharp.png") < dark("srgb/sharp.png") - 0.05, "light is darker than its encoding");
}

#[test]
fn a_study_measures_any_network_under_either_tone() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let study = |options: &str| {
        let line = format!(
            "study kodak --nets net.safetensors --images photos --psi 0,4 --json s.json --markdown s.md --force {options}"
        );
        place.edof(&line).done();
        (read_json(&place, "s.json"), std::fs::read_to_string(place.path("s.md")).unwrap())
    };
    let (linear, page) = study("");
    assert_eq!(linear["measure"], json!({ "tone": "linear", "peak": 1.0, "border": 8 }));
    assert!(
        page.contains("`edof study kodak --force --nets net.safetensors --tone linear --psi 0,4 --stride 8"),
        "{page}"
    );
    assert!(page.contains("σ = 0.01") && page.contains("σ = 0.02"), "{page}");
    let float = |study: &Value| {
        let rows = study["rows"].as_array().unwrap();
        rows.iter().find(|row| row["method"] == "net.float").unwrap().clone()
    };
    let row = float(&linear);
    assert_eq!(row["psnr_db"], row["light"]["psnr_db"]);
    let identity = ["family", "network", "format", "stride", "layers"].map(|field| row[field].clone());
    assert_eq!(json!(identity), json!(["network", "net", "float", 8, 3]));

    let (srgb, page) = study("--tone srgb");
    let noises: Vec<&Value> = srgb["rows"].as_array().unwrap().iter().map(|r| &r["noise"]).collect();
    assert!(noises.contains(&&json!("sensor:gain=8")) && noises.contains(&&json!("none")), "{noises:?}");
    assert!(page.contains("| net.float | clear |") && page.contains("sensor, gain 8"), "{page}");
    let row = float(&srgb);
    assert_ne!(row["psnr_db"], row["light"]["psnr_db"]);
}

#[test]
fn the_demo_measures_the_encoded_picture_and_its_light() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let line = "demo --scene chart --net net.safetensors --clear-net net.safetensors --height 96 --width 128 --out out --json demo.json";
    place.edof(line).done();
    let demo = read_json(&place, "demo.json");
    assert_eq!((&demo["tone"], &demo["noise"]), (&json!("srgb"), &json!("sensor:gain=4")));
    assert_ne!(demo["pictures"][0]["psnr_db"], demo["pictures"][0]["light"]["psnr_db"]);
    let shown = photo::load(&place.path("out/scene.png")).unwrap();

    place.edof(&format!("{line} --tone linear")).done();
    let demo = read_json(&place, "demo.json");
    assert_eq!((&demo["tone"], &demo["noise"]), (&json!("linear"), &json!("0.005")));
    assert_eq!(demo["pictures"][0]["psnr_db"], demo["pictures"][0]["light"]["psnr_db"]);
    assert_eq!(photo::load(&place.path("out/scene.png")).unwrap(), shown, "shown encoded in either case");

    place.edof("scene chart-4 --size 128x96 --seed 1 --out scene").done();
    assert_eq!(photo::load(&place.path("scene/screen.png")).unwrap(), shown);
}

#[test]
fn tones_and_noises_that_there_are_not_are_rejected_as_wrong_usage() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    for (option, words) in [
        ("--noise -0.5", "noise: the standard deviation is -0.5, expected 0 to 1, where full scale is 1"),
        ("--noise loud", "noise 'loud': must be none, a standard deviation such as 0.01, or sensor"),
        ("--noise sensor:gain=0.5", "noise: gain is 0.5, expected 1 or more"),
        ("--tone sepia", "tone 'sepia': must be linear or srgb"),
    ] {
        let run = place.edof(&format!("capture photo.png --psi 1 --out r.png {option}"));
        assert_eq!(run.code, Some(2));
        assert!(run.err.contains(words), "{}", run.err);
        assert_eq!(place.files(), ["photo.png"]);
    }
}

#[test]
fn a_frame_is_restored_by_the_network_for_its_tone_and_its_noise() {
    let place = Place::new();
    let method = || read_json(&place, "made.json")["method"].as_str().unwrap().to_owned();
    for (tone, noise) in
        [(Tone::Srgb, "sensor"), (Tone::Linear, "none"), (Tone::Linear, "0.01"), (Tone::Linear, "0.5")]
    {
        let usual = weights::default_for(tone);
        let line = format!(
            "capture leaves-4 --size 96x64 --camera ring-outer --tone {tone} --noise {noise} --no-measure --out raw.png"
        );
        place.edof(&line).done();
        let run = place.edof("reconstruct raw.png --out sharp.png --json made.json").done();
        let expected = weights::for_noise(usual, tone, noise.parse().unwrap());
        assert!(expected.starts_with(usual), "{expected}");
        assert_eq!(method(), format!("{expected}.fixed"), "{tone} {noise}");
        let is_noted = run.err.contains("its noise is 0.5") && run.err.contains("was trained for noise");
        assert_eq!(is_noted, noise == "0.5", "{}", run.err);
        place.edof("reconstruct raw.png --weights edof-t4w12-outer --out sharp.png --json made.json").done();
        assert_eq!(method(), "edof-t4w12-outer.fixed", "{tone}");
    }
}
