//! Optics, scenes and captures by the real binary.

use crate::support::Place;
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use edof_spec::{Camera, CfaPhase};
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_camera_is_shown_in_figures_and_numbers() {
    let place = Place::new();
    let run = place.edof("optics ring-2018 --psi 1,5 --energy 0.99 --nominal 10 --out figures --json").done();
    let shown = json(&run.out);
    let contrast = |depth: usize, channel: usize| {
        shown["depths"][depth]["contrast_quarter_cutoff"][channel].as_f64().unwrap()
    };
    assert!(
        contrast(0, 0) > contrast(1, 0) && contrast(1, 2) > contrast(0, 2),
        "red is near, blue is far: {shown}"
    );
    assert!(shown["depths"][0]["distance_m"].as_f64().unwrap() < 10.0);
    for file in ["figure1.svg", "mtf.svg"] {
        let svg = std::fs::read_to_string(place.path("figures").join(file)).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("polyline") || svg.contains("<path"), "{file}");
    }
    assert!(photo::load(&place.path("figures/psf.png")).unwrap().size().1 > 200);
}

#[test]
fn a_scene_is_drawn_with_its_depths() {
    let place = Place::new();
    let run = place.edof("scene chart-4 --size 128x96 --psi 0,2,5,8 --out chart --json").done();
    assert_eq!(json(&run.out)["psi"], serde_json::json!([0.0, 2.0, 5.0, 8.0]));
    for file in ["sharp.png", "screen.png", "depth.png"] {
        assert_eq!(photo::load(&place.path("chart").join(file)).unwrap().size(), (96, 128), "{file}");
    }
}

#[test]
fn a_capture_of_a_drawn_scene_tells_what_its_approximations_cost() {
    let place = Place::new();
    let line = "capture leaves-4 --size 96x64 --noise 0.01 --seed 3 --depth 10 --phase bggr --energy 0.99 \
                --out raw.pgm --sharp sharp.png --json";
    let report = json(&place.edof(line).done().out);
    assert_eq!(report["depths"].as_array().unwrap().len(), 4);
    let costs = report["approximations"].as_array().unwrap();
    assert_eq!(
        costs.iter().map(|c| c["approximation"].as_str().unwrap()).collect::<Vec<_>>(),
        ["kernels", "wavelengths", "depths", "all"]
    );
    assert!(costs[0]["rms_error"].as_f64().unwrap() > 0.0);
    let options = RawOptions { phase: CfaPhase::Bggr, ..RawOptions::default() };
    let frame = raw::load(&place.path("raw.pgm"), &options).unwrap();
    assert_eq!((frame.depth(), frame.size()), (10, (64, 96)));
    assert_eq!(photo::load(&place.path("sharp.png")).unwrap().size(), (64, 96));
}

#[test]
fn the_same_seed_gives_the_same_raw_frame() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let shot = |seed: u32, name: &str| {
        let line = format!("capture photo.png --psi 3 --noise 0.02 --seed {seed} --no-measure --out {name}");
        place.edof(&line).done();
        std::fs::read(place.path(name)).unwrap()
    };
    let first = shot(1, "a.png");
    assert_eq!(first, shot(1, "b.png"));
    assert_ne!(first, shot(2, "c.png"));
}

#[test]
fn a_designed_camera_is_a_camera_that_can_be_used() {
    let place = Place::new();
    let line = "optics design --population 5 --generations 2 --window 8 --noise 0 --psi-range=-2,2 --out mine.json --json";
    let report = json(&place.edof(line).done().out);
    let camera = Camera::resolve(place.path("mine.json").to_str().unwrap()).unwrap();
    assert_eq!((camera.name.as_str(), camera.psi_range, camera.rings.len()), ("mine", [-2.0, 2.0], 1));
    assert_eq!(report["cameras"][1]["name"], "ring-outer");
    place.photo("photo.png", 64, 48);
    place.edof("capture photo.png --camera mine.json --psi 1 --no-measure --out raw.png").done();
}

#[test]
fn what_cannot_be_captured_or_drawn_is_refused_in_one_line() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place.photo("odd.png", 65, 48);
    let before = place.files();
    for (line, words) in [
        ("capture photo.png --out r.png", ["--psi: one value", "one depth"]),
        ("capture odd.png --psi 1 --out r.png", ["frame 65x48", "both sides must be even"]),
        ("capture photo.png --psi 900 --out r.png", ["psi 900", "within 200"]),
        ("capture photo.png --psi 1 --depth 7 --out r.png", ["bit depth 7", "8 to 16"]),
        ("capture photo.png --psi 1 --energy 0 --out r.png", ["--energy 0", "at most 1"]),
        ("capture photo.png --psi 1 --camera none --out r.png", ["camera 'none'", "ring-outer"]),
        ("capture none.png --psi 1 --out r.png", ["none.png", "cannot read"]),
        ("capture photo.png --psi 1 --no-measure --out odd.png/r.png", ["odd.png/r.png", "cannot write"]),
        ("capture chart-4 --psi 1,2 --out r.png", ["--psi: 2 values", "expected 4"]),
        ("scene sea", ["scene 'sea'", "leaves-4"]),
        ("scene chart --size 30x30", ["scene 30x30", "at least 64"]),
        ("optics ring-1999", ["camera 'ring-1999'", "presets"]),
        ("optics --psi 1,900", ["--psi 900", "within 200"]),
        ("optics design --rings 5 --out c.json", ["rings is 5", "0, 1 or 2"]),
        ("optics design --focus 1e9 --out c.json", ["psi is", "within 200"]),
        ("optics design --psi-range=0,1e9 --out c.json", ["psi is", "within 200"]),
        ("optics design --population 18446744073709551615 --out c.json", ["population", "4 to 10000"]),
        ("optics design --window 9 --out c.json", ["window 9", "8, 12 or 16"]),
        ("optics design --psi-range=3 --out c.json", ["--psi-range", "two numbers"]),
    ] {
        place.edof(line).refused(&words);
        assert_eq!(place.files(), before, "{line}");
    }
}
