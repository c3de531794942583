//! Two exposures of a scene, from the capture to one picture, by the real binary.

use crate::support::Place;
use edof_core::{ColourFrame, RawFrame};
use edof_io::raw::{self, RawOptions};
use edof_io::{photo, record};
use serde_json::{Value, json};

/// Takes chart at two foci.
const CAPTURE: &str = "capture chart --size 96x64 --psi 3 --camera clear-mid --noise sensor";
/// Makes a picture of the light.
const LIGHT: &str = "--gamma linear --bits 16";

/// A place with a network of two exposures, and with the exposures o-1.png and o-2.png.
fn taken() -> Place {
    let place = Place::new();
    place.network_of_two("two.safetensors");
    place.edof(&format!("{CAPTURE} --focus 2,6 --out o.png")).done();
    place
}

fn frame(place: &Place, name: &str) -> RawFrame {
    let record = record::load(&place.path(name)).unwrap().record().unwrap();
    raw::load(&place.path(name), &record.options(RawOptions::default())).unwrap()
}

fn picture(place: &Place, name: &str) -> ColourFrame {
    photo::load(&place.path(name)).unwrap()
}

#[test]
fn two_foci_make_two_frames_whose_records_state_focus_share_and_order() {
    let place = Place::new();
    let line = format!("{CAPTURE} --focus 2,6 --sharp sharp.png --light light.png --out o.png --json");
    let answer: Value = serde_json::from_str(&place.edof(&line).done().out).unwrap();
    let files =
        ["light-1.png", "light-2.png", "o-1.png", "o-1.png.json", "o-2.png", "o-2.png.json", "sharp.png"];
    assert_eq!(place.files(), files);
    for (place_in_scene, focus) in [2.0, 6.0].into_iter().enumerate() {
        let number = place_in_scene + 1;
        let record: Value =
            serde_json::from_slice(&std::fs::read(place.path(&format!("o-{number}.png.json"))).unwrap())
                .unwrap();
        assert_eq!(record["exposure"], json!({ "number": number, "of": 2 }));
        assert_eq!(
            (&record["camera"]["focus_psi"], &record["noise"]),
            (&json!(focus), &json!("sensor:gain=2"))
        );
        assert_eq!(answer["frames"][place_in_scene]["exposure"], record["exposure"]);
        assert_eq!(answer["frames"][place_in_scene]["out"], json!(format!("o-{number}.png")));
    }
    let run = place.edof(&format!("{CAPTURE} --focus 2,6 --out o.png")).done();
    assert!(run.out.contains("o-2.png: exposure 2 of 2, focus at psi 6"), "{}", run.out);
}

#[test]
fn one_focus_takes_the_place_of_the_cameras() {
    let place = Place::new();
    place.edof(&format!("{CAPTURE} --focus 4 --out focused.png")).done();
    place.edof(&format!("{CAPTURE} --out usual.png")).done();
    assert_eq!(frame(&place, "focused.png"), frame(&place, "usual.png"), "clear-mid is focused at 4");
    place.edof(&format!("{CAPTURE} --focus 1 --out focused.png")).done();
    assert_ne!(frame(&place, "focused.png"), frame(&place, "usual.png"));
    let record = record::load(&place.path("focused.png")).unwrap().record().unwrap();
    assert_eq!((record.camera.focus_psi, record.exposure), (1.0, None));
}

#[test]
fn a_pair_becomes_one_picture_of_both() {
    let place = taken();
    place.float_network("one.safetensors");
    let line = format!("reconstruct o-1.png o-2.png --weights two.safetensors {LIGHT} --out both.png --json");
    let answer: Value = serde_json::from_str(&place.edof(&line).done().out).unwrap();
    assert_eq!((&answer["method"], &answer["raw"]), (&json!("two.float"), &json!("o-1.png")));
    assert_eq!(answer["exposures"], json!(["o-2.png"]));
    // The network gives the mean of what another makes of each frame.
    for number in [1, 2] {
        let line = format!("reconstruct o-{number}.png --float --force --weights one.safetensors {LIGHT}");
        place.edof(&format!("{line} --out {number}.png")).done();
    }
    let mean = 0.5 * (picture(&place, "1.png").planes + picture(&place, "2.png").planes);
    let error =
        (picture(&place, "both.png").planes - mean).mapv(f32::abs).fold(0.0, |most: f32, e| most.max(*e));
    assert!(error < 2.0 / 65535.0, "{error}");
}

#[test]
fn pairs_of_many_scenes_go_into_a_folder() {
    let place = taken();
    place.edof(&format!("{CAPTURE} --focus 2,6 --out p.pgm --seed 9")).done();
    place.edof("reconstruct o-1.png o-2.png p-1.pgm p-2.pgm --weights two.safetensors --out sharp/").done();
    place.edof("reconstruct p-1.pgm p-2.pgm --float --weights two.safetensors --out alone.png").done();
    assert!(picture(&place, "sharp/p-1.png") == picture(&place, "alone.png"));
    assert!(picture(&place, "sharp/o-1.png") != picture(&place, "alone.png"));
    assert!(!place.path("sharp/o-2.png").exists());
}

#[test]
fn frames_without_records_are_taken_in_the_order_given() {
    let place = taken();
    let options = format!("--bit-depth 12 --weights two.safetensors {LIGHT}");
    place.edof(&format!("reconstruct o-1.png o-2.png {options} --out recorded.png")).done();
    for number in [1, 2] {
        std::fs::remove_file(place.path(&format!("o-{number}.png.json"))).unwrap();
    }
    for (frames, out) in [("o-1.png o-2.png", "a.png"), ("o-2.png o-1.png", "b.png")] {
        place.edof(&format!("reconstruct {frames} {options} --camera clear-mid --out {out}")).done();
        // The mean of both has no order.
        assert!(picture(&place, out) == picture(&place, "recorded.png"), "{frames}");
    }
    let line = format!("reconstruct o-1.png o-2.png {options} --out c.png");
    place
        .edof(&format!("{line} --camera ring-outer"))
        .refused(&["two.safetensors", "--camera is ring-outer"]);
}

#[test]
fn what_is_of_another_scene_or_camera_is_refused_by_name() {
    let place = taken();
    for (capture, words) in [
        ("--size 64x64", "p-2.png: size 64x64, expected 96x64 as o-1.png"),
        ("--phase bggr", "p-2.png: phase bggr, expected rggb as o-1.png"),
        ("--bit-depth 10", "p-2.png: bit depth 10, expected 12 as o-1.png"),
        ("--tone linear", "p-2.png: tone linear, expected srgb as o-1.png"),
        (
            "--focus 2,5",
            "p-2.png was taken by clear-mid, another lens or mask (they differ in focus_psi); train one by 'edof train --camera clear-mid --focus 5'",
        ),
        ("--focus 2,4,6", "p-2.png: its record states exposure 2 of 3, it is given as exposure 2 of 2"),
        ("--camera ring-outer", "p-2.png was taken by ring-outer"),
    ] {
        let mut words_of: std::collections::BTreeMap<&str, &str> =
            [("--size", "96x64"), ("--focus", "2,6"), ("--camera", "clear-mid")].into();
        let (option, value) = capture.split_once(' ').unwrap();
        words_of.insert(option, value);
        let options: Vec<String> =
            words_of.iter().map(|(option, value)| format!("{option} {value}")).collect();
        place.edof(&format!("capture chart --psi 3 {} --out p.png", options.join(" "))).done();
        let line = "reconstruct o-1.png p-2.png --weights two.safetensors --out s.png";
        place.edof(line).refused(&[words]);
        assert!(!place.path("s.png").exists());
    }
}

#[test]
fn whatever_takes_one_frame_refuses_a_network_of_two_and_says_what_to_do() {
    let place = taken();
    for line in [
        "quantize two.safetensors --out o.safetensors",
        "generate --design tiny --weights two.safetensors --out o",
        "stream - --size 96x64 --weights two.safetensors --out o.y4m",
        "board sim --design tiny --weights two.safetensors",
        "board load two.safetensors --dry-run --design tiny",
        "cosim --design tiny --weights two.safetensors",
        "explore --weights two.safetensors --out o.html",
        "demo --net two.safetensors --out o",
        "estimate --design tiny --weights two.safetensors",
        "reconstruct o-1.png --fixed --weights two.safetensors --out s.png",
    ] {
        let (before, run) = (place.files(), place.edof(line));
        let words = if line.contains("--fixed") {
            "takes 2 raw frames of a scene"
        } else {
            "exposures 2: must be 1 here"
        };
        run.refused(&["two.safetensors", words]);
        assert_eq!(place.files(), before, "{line}");
    }
}

#[test]
fn a_network_is_trained_for_two_exposures_by_a_command() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    for number in [1, 2] {
        place.photo(&format!("photos/p0{number}.png"), 160, 128);
    }
    let train = "train --form two-sided,w8,t2,c8,r,e2 --camera clear-mid --focus 2,6 --gain 2:4 --tone srgb --images photos --photos all \
                 --depths 2 --variants 1 --steps 10 --batch 8 --validate-every 10 --non-zeros none --no-cache --out two.safetensors";
    place.edof(train).done();
    let network = edof_network::weight_file::load_network(&place.path("two.safetensors")).unwrap();
    let foci: Vec<f64> = network.origin.cameras().iter().map(|camera| camera.focus_psi).collect();
    assert_eq!((network.form.exposures, foci), (2, vec![2.0, 6.0]));
    let answer = place.edof("weights two.safetensors").done().out;
    assert!(answer.contains("takes 2 raw frames of a scene, at foci 2, 6"), "{answer}");
    place
        .edof("capture photos/p01.png --psi 3 --camera clear-mid --focus 2,6 --noise sensor --out o.png")
        .done();
    // The noise of each exposure is in the range that --gain states: no remark.
    let run = place.edof("reconstruct o-1.png o-2.png --weights two.safetensors --out s.png").done();
    assert_eq!(run.err, "");
    place.edof(&train.replace("--focus 2,6", "--focus 2")).refused(&["--focus 2: has 1 value, expected 2"]);
}

#[test]
fn the_main_study_measures_a_network_of_two_exposures_beside_others_and_studies_of_one_frame_refuse_it() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.float_network("one.safetensors");
    place.network_of_two("two.safetensors");
    let line = "study kodak --tone srgb --noise none,sensor,0.01 --images photos --photos all --psi 3 --nets one.safetensors,two.safetensors";
    let answer: Value = serde_json::from_str(&place.edof(&format!("{line} --json")).done().out).unwrap();
    let rows = answer["rows"].as_array().unwrap().iter().filter(|row| row["method"] == "two.float");
    let of_two: Vec<(&str, &str)> =
        rows.map(|row| (row["camera"].as_str().unwrap(), row["noise"].as_str().unwrap())).collect();
    let camera = "clear-mid at foci 2, 6";
    assert_eq!(of_two, [(camera, "none"), (camera, "sensor")], "Gaussian noise has no electrons to share");
    let photos = "--images photos --photos all";
    for line in [
        &format!("study single-depth --rows r --camera clear-mid --nets two.safetensors {photos}"),
        &format!("study tolerances --net two.safetensors {photos}"),
        &format!("study knobs --rows r --net two.safetensors {photos}"),
        "study codes --nets two.safetensors",
    ] {
        let words = "net 'two.safetensors': takes 2 raw frames of a scene, this study one; edof study kodak and edof study lens-networks take both";
        place.edof(line).refused(&[words]);
    }
}
