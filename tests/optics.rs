//! Optics, scenes and captures by the real binary.

use crate::support::Place;
use edof_core::camera::Camera;
use edof_core::{CfaPhase, ColourFrame};
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use ndarray::{Array3, Array4, s};
use ndarray_npy::{NpzReader, NpzWriter};
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_mask_that_throws_light_beyond_any_grid_is_refused_and_writes_nothing() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let profile = "{\"profile\": {\"at_nm\": 535, \"points\": [[0, 0], [1, 3600]]},";
    place.write("steep.json", include_str!("../cameras/clear.json").replacen('{', profile, 1));
    let before = place.snapshot();
    let said = "psi 3: camera clear throws 100 % of the light more than 512 pixels from the centre, the farthest that is computed; \
                use less defocus or larger pixels, a weaker profile";
    for line in
        ["capture photo.png --camera steep.json --psi 3 --out o.png", "optics steep.json --psi 3 --out o"]
    {
        place.edof(line).refused(&[said]);
    }
    assert!(place.snapshot() == before);
}

#[test]
fn a_camera_is_shown_in_figures_and_numbers() {
    let place = Place::new();
    let run =
        place.edof("optics ring-2018 --psi 1,4.1946m --energy 0.99 --nominal 10 --out figures --json").done();
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
    assert!((shown["depths"][1]["psi"].as_f64().unwrap() - 5.0).abs() < 1e-3, "{shown}");
    assert!(std::fs::read_to_string(place.path("figures/mtf.svg")).unwrap().contains("ψ = 5, 4.19 m"));
    place.edof("optics ring-2018 --psi 3m --out no").refused(&["--psi 3m: camera", "--nominal"]);
}

#[test]
fn a_scene_is_random_with_its_depths() {
    let place = Place::new();
    let run = place.edof("scene chart-4 --size 128x96 --psi 0,2,5,8 --out chart --json").done();
    assert_eq!(json(&run.out)["psi"], serde_json::json!([0.0, 2.0, 5.0, 8.0]));
    for file in ["sharp.png", "screen.png", "depth.png"] {
        assert_eq!(photo::load(&place.path("chart").join(file)).unwrap().size(), (96, 128), "{file}");
    }
}

#[test]
fn a_capture_of_a_random_scene_tells_what_its_approximations_cost() {
    let place = Place::new();
    let line = "--size 64x64 --noise 0.01 --seed 3 --bit-depth 10 --phase bggr --energy 0.99 --out raw.pgm --sharp sharp.png --json";
    let capture = |scene: &str| json(&place.edof(&format!("capture {scene} {line}")).done().out);
    assert_eq!(capture("leaves-4 --no-measure")["depths"].as_array().unwrap().len(), 4);
    assert_eq!(
        capture("leaves")["approximations"],
        serde_json::json!([]),
        "measured only where it is asked for"
    );
    let report = capture("leaves --measure");
    assert_eq!(report["depths"].as_array().unwrap().len(), 1);
    let costs = report["approximations"].as_array().unwrap();
    assert_eq!(
        costs.iter().map(|c| c["approximation"].as_str().unwrap()).collect::<Vec<_>>(),
        ["kernels", "wavelengths", "depths", "all"]
    );
    assert!(costs[0]["rms_error"].as_f64().unwrap() > 0.0);
    let options = RawOptions { phase: CfaPhase::Bggr, ..RawOptions::default() };
    let frame = raw::load(&place.path("raw.pgm"), &options).unwrap();
    assert_eq!((frame.depth(), frame.size()), (10, (64, 64)));
    assert_eq!(photo::load(&place.path("sharp.png")).unwrap().size(), (64, 64));
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
    assert_eq!(
        (camera.name.as_str(), camera.psi_range, camera.mask.rings().count()),
        ("mine", [-2.0, 2.0], 1)
    );
    assert_eq!(report["cameras"][1]["name"], "ring-outer");
    place.photo("photo.png", 64, 48);
    place.edof("capture photo.png --camera mine.json --psi 1 --no-measure --out raw.png").done();
}

#[test]
fn a_lens_is_searched_through_a_network_from_a_camera_or_at_random() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 320, 288);
    place.float_network("net.safetensors");
    let line =
        "optics design --through net.safetensors --images photos --photos all --steps 4 --windows 8 --json";
    for (start, rings) in
        [("--camera ring-2018", 1), ("--camera clear-mid", 0), ("--random --rings 3 --seed 4", 3)]
    {
        let report =
            json(&place.edof(&format!("{line} --rounds 2 {start} --out mine.json --force")).done().out);
        let camera = Camera::resolve(place.path("mine.json").to_str().unwrap()).unwrap();
        assert_eq!((camera.name.as_str(), camera.mask.rings().count()), ("mine", rings));
        assert_eq!(report["history"].as_array().unwrap().len(), 2);
        assert_eq!(report["history"][0]["gradient"].as_array().unwrap().len(), 3 * rings + 1);
        let focus = |camera: &serde_json::Value| camera["focus_psi"].as_f64().unwrap();
        assert_ne!(focus(&report["camera"]), focus(&report["start"]), "{start}: the focus moved");
    }
    for (option, words) in [
        ("--rounds 0", ["--rounds 0", "1 to 10000"]),
        ("--random --rings 4", ["--rings 4", "0 to 3"]),
        ("--noise 2", ["--noise 2", "0 to 1"]),
        ("--leave-out nobody", ["--leave-out nobody", "none of the photographs"]),
    ] {
        place.edof(&format!("{line} {option} --out other.json")).refused(&words);
        assert!(!place.path("other.json").exists());
    }
}

/// A bank of two depths whose kernels lean to the upper right, the more the nearer: something like coma.
fn coma() -> Array4<f64> {
    Array4::from_shape_fn((2, 3, 9, 9), |(depth, channel, r, c)| {
        let (up, right) = (4.0 - r as f64, c as f64 - 4.0);
        let along = (up + right) / (1.0 + depth as f64 + 0.3 * channel as f64);
        if along < 0.0 { 0.0 } else { (-along - (up - right).powi(2)).exp() }
    })
}

fn save_bank(place: &Place, name: &str, psi: &[f64], psf: &Array4<f64>) {
    let mut npz = NpzWriter::new(std::fs::File::create(place.path(name)).unwrap());
    npz.add_array("psi", &ndarray::aview1(psi)).unwrap();
    npz.add_array("psf", psf).unwrap();
    npz.finish().unwrap();
}

#[test]
fn a_bank_that_was_exported_gives_the_same_frame() {
    let place = Place::new();
    place.photo("photo.png", 96, 64);
    place.edof("optics ring-outer --psi 0,4,8 --out shown").done();
    let light = |more: &str, out: &str| {
        let line = format!(
            "capture photo.png --camera ring-outer --no-measure --light {out}.light.png --out {out}.png {more}"
        );
        place.edof(&line).done();
        let raw = raw::load(&place.path(&format!("{out}.png")), &RawOptions::default()).unwrap();
        (raw, photo::load(&place.path(&format!("{out}.light.png"))).unwrap())
    };
    let (computed, own) = (light("--psi 4", "a"), light("--psi 4 --psf-bank shown/psf.npz", "b"));
    assert_eq!(computed.0, own.0);
    assert!(computed.1.planes.iter().zip(&own.1.planes).all(|(a, b)| (a - b).abs() < 1e-6));
    let other = light("--psf-bank shown/psf.npz --psi 2", "c");
    assert_ne!(computed.0, other.0);
    let mut mtf = NpzReader::new(std::fs::File::open(place.path("shown/mtf.npz")).unwrap()).unwrap();
    let contrast: Array3<f64> = mtf.by_name("lens_otf").unwrap();
    let sensor: Array4<f64> = mtf.by_name("sensor_mtf").unwrap();
    assert_eq!((contrast.dim(), sensor.dim()), ((3, 3, 129), (3, 3, 2, 129)));
    assert!(contrast.slice(s![.., .., 0]).iter().all(|v| (v - 1.0).abs() < 1e-9));
    assert!(sensor.slice(s![.., .., .., 0]).iter().all(|v| (v - 1.0).abs() < 1e-5));
}

/// A bank whose kernels are one pixel each, three to the right and two above the middle, with some light on the edge at the second depth.
fn displaced() -> Array4<f64> {
    Array4::from_shape_fn((2, 3, 23, 24), |(depth, _, row, column)| match (row, column) {
        (9, 15) => {
            if depth == 0 {
                1.0
            } else {
                0.75
            }
        }
        (9, 23) if depth == 1 => 0.25,
        _ => 0.0,
    })
}

#[test]
fn a_displaced_bank_is_listed_and_shifted_back() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    save_bank(&place, "lens.npz", &[0.0, 4.0], &displaced());
    let run = place.edof("optics clear --psf-bank lens.npz --psi 0 --out shown").done();
    // Of 23 rows the middle is row 11, of 24 columns column 12.
    assert!(
        run.out.contains(
            "  psi  0.00: red 3.00 right, 2.00 up, 0.00 %; green 3.00 right, 2.00 up, 0.00 %; blue"
        ),
        "{}",
        run.out
    );
    assert!(run.out.contains("  psi  4.00: red 5.00 right, 2.00 up, 25.00 %;"), "{}", run.out);
    for note in [
        "lens.npz: moves the picture by 4.00 right, 2.00 up on average; --centre",
        "up to 25.00 % of a kernel's light",
    ] {
        assert!(run.err.contains(note), "{}", run.err);
    }
    let line = "capture photo.png --camera clear --psi 0 --black-level 0 --phase rggb";
    let raw = |options: &str, out: &str| {
        let run = place.edof(&format!("{line} {options} --out {out}")).done();
        (raw::load(&place.path(out), &RawOptions::default()).unwrap().values(), run)
    };
    let (moved, run) = raw("--psf-bank lens.npz", "moved.png");
    assert!(run.out.contains("from the PSF bank, centroid 3.00 right, 2.00 up"), "{}", run.out);
    // By 4 and 2 pixels back: kernels of depth 0 are one pixel to the left of the middle.
    let (back, run) = raw("--psf-bank lens.npz --centre", "back.png");
    assert!(
        run.out.contains("centroid 1.00 left, 0.00 down") && !run.err.contains("moves the picture"),
        "{}{}",
        run.out,
        run.err
    );
    let same = |a: &u16, b: &u16| a.abs_diff(*b) <= 1;
    let (moved, shifted) = (moved.slice(s![8..40, 8..48]), back.slice(s![10..42, 4..44]));
    assert!(moved.iter().zip(&shifted).all(|(a, b)| same(a, b)), "{moved} {shifted}");
    assert!(moved.iter().max().unwrap() - moved.iter().min().unwrap() > 1000, "a picture");
    let record = json(&std::fs::read_to_string(place.path("back.png.json")).unwrap());
    assert_eq!(record["camera"]["psf_bank"]["centre"], true);
    let reconstruct =
        "reconstruct back.png --weights edof-t4w12-clear-light --force --camera clear --psf-bank lens.npz";
    place.edof(&format!("{reconstruct} --centre --out a.png")).done();
    let camera = include_str!("../cameras/clear.json");
    place.write(
        "mine.json",
        camera.replacen('{', "{\"psf_bank\": {\"file\": \"lens.npz\", \"centre\": true},", 1),
    );
    let line = "capture photo.png --camera mine.json --psi 0 --out own.png";
    place.edof(line).done();
    assert_eq!(raw::load(&place.path("own.png"), &RawOptions::default()).unwrap().values(), back);
    assert_eq!(
        place.edof("capture photo.png --psi 0 --centre --out no.png").code,
        Some(2),
        "a bank to centre"
    );
}

/// NumPy's `save` writes one array a file.
#[test]
fn a_bank_without_depths_says_that_psi_is_missing() {
    let place = Place::new();
    for (file, words) in [
        ("x.npy", "name it x-psf.npy and put the depths into x-psi.npy beside it"),
        ("x-psf.npy", "put the depths into x-psi.npy beside it"),
    ] {
        ndarray_npy::write_npy(place.path(file), &displaced()).unwrap();
        let said = format!("{file}: no PSF bank: psi is missing: an NPY file contains one array; {words}");
        place.edof(&format!("optics --psf-bank {file} --out shown")).refused(&[&said]);
    }
    ndarray_npy::write_npy(place.path("x-psi.npy"), &ndarray::aview1(&[0.0, 4.0])).unwrap();
    place.edof("optics --psf-bank x-psf.npy --out shown").done();
}

#[test]
fn a_lens_with_coma_is_seen_trained_for_and_reconstructed() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    save_bank(&place, "coma.npz", &[0.0, 4.0], &coma());
    let camera =
        include_str!("../cameras/clear.json").replacen('{', "{\"psf_bank\": {\"file\": \"coma.npz\"},", 1);
    place.write("mine.json", camera);
    let shown = json(&place.edof("optics mine.json --out shown --json").done().out);
    assert_eq!(shown["depths"][1]["kernel_side"], serde_json::json!([9, 9, 9]));
    let train = "train --form one-sided,w8,t3,c32,r --camera mine.json --images photos --depths 2 --steps 300 --batch 128 \
                 --validate-every 100 --out net.safetensors";
    place.edof(train).done();
    place
        .edof("capture photos/a.png --camera mine.json --psi 4 --no-measure --sharp sharp.png --out raw.png")
        .done();
    place.edof("reconstruct raw.png --weights net.safetensors --float --out out.png").done();
    // Neither blur nor network moves the picture: the picture lies where the scene does, although the kernels lean.
    let [sharp, out] = ["sharp.png", "out.png"].map(|name| photo::load(&place.path(name)).unwrap());
    let error = |down: usize| {
        let (a, b) = (
            sharp.planes.slice(s![1, 16..200, 16..200]),
            out.planes.slice(s![1, 16 + down..200 + down, 16..200]),
        );
        (&a - &b).mapv(|v| v * v).sum()
    };
    assert!(error(0) < error(1), "{} {}", error(0), error(1));
    // Another lens's network is rejected, and integers cannot be made without the bank.
    place.edof("reconstruct raw.png --float --weights edof-t4w12 --out no.png").refused(&["taken by clear"]);
    std::fs::rename(place.path("coma.npz"), place.path("photos/coma.npz")).unwrap();
    place
        .edof("quantize net.safetensors --images photos --photos all")
        .refused(&["coma.npz", "found neither"]);
    save_bank(&place, "coma.npz", &[0.0, 5.0], &coma());
    place
        .edof("quantize net.safetensors --images photos --photos all")
        .refused(&["coma.npz", "found neither"]);
    place
        .edof("capture photos/a.png --camera mine.json --psi 6 --out no.png")
        .refused(&["psi 6", "reaches from 0 to 5"]);
}

#[test]
fn a_mask_may_be_a_picture_of_its_heights() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let mask = |height: &dyn Fn(usize) -> f32| {
        let planes = Array3::from_shape_fn((3, 64, 64), |(_, _, c)| height(c));
        photo::save(&place.path("mask.png"), &ColourFrame { planes }, 16).unwrap();
    };
    let map = "{\"height_map\": {\"file\": \"mask.png\", \"white_um\": 0.8, \"cauchy\": [1.458, 0.00354]},";
    place.write("mine.json", include_str!("../cameras/clear.json").replacen('{', map, 1));
    let line = "capture photo.png --camera mine.json --psi 2 --no-measure --out";
    place.edof(&format!("{line} no.png")).refused(&["mask.png: cannot read"]);
    // A wedge: the picture moves.
    mask(&|c| c as f32 / 63.0);
    place.edof(&format!("{line} raw.png")).done();
    place.edof("capture photo.png --camera clear --psi 2 --no-measure --out clear.png").done();
    let [light, without] = ["raw.png", "clear.png"].map(|name| photo::load_grey(&place.path(name)).unwrap());
    let moved = (light - without).iter().fold(0.0f32, |max, d| max.max(d.abs()));
    assert!(moved > 0.01, "{moved}");
    // Frames and networks know which mask it was.
    place.edof("reconstruct raw.png --weights edof-t4w12 --out no.png").refused(&["was taken by clear"]);
    let record = json(&std::fs::read_to_string(place.path("raw.png.json")).unwrap());
    let stated = format!("\"sha256\": {}, \"cauchy\"", record["camera"]["height_map"]["sha256"]);
    mask(&|_| 0.5);
    let text = std::fs::read_to_string(place.path("mine.json")).unwrap();
    place.write("mine.json", text.replace("\"cauchy\"", &stated));
    place
        .edof(&format!("{line} no.png"))
        .refused(&["mask.png: its heights have the SHA-256", "camera clear states"]);
    place.write("mine.json", text.replace("0.8", "0"));
    place.edof(&format!("{line} no.png")).refused(&["height_map is 0 um", "more than 0"]);
    place.write("mine.json", &text);
    place.photo("mask.png", 64, 48);
    place.edof(&format!("{line} no.png")).refused(&["mask.png: ", "expected a grey one"]);
    place
        .edof("capture photo.png --camera mine.json --psi 2 --no-measure --out mask.png")
        .refused(&["mask.png"]);
    assert!(!place.path("no.png").exists());
}

#[test]
fn a_photograph_with_a_depth_map_is_captured_and_reconstructed() {
    let place = Place::new();
    place.photo("photo.png", 97, 64);
    place.fixed_network("net.safetensors");
    // The left half near, the right half far.
    let grey = |c: usize| if c < 48 { "255 " } else { "0 " };
    let row: String = (0..97).map(grey).collect();
    place.write("map.pgm", format!("P2 97 64 255 {}", row.repeat(64)));
    let capture = |more: &str| {
        let line = format!(
            "capture photo.png --camera clear --depth-map map.pgm --no-measure --out raw.png --light light.png {more} --json"
        );
        let run = place.edof(&line).done();
        assert!(run.err.contains("photo.png: 97x64 cropped to 96x64"), "{}", run.err);
        (json(&run.out)["psi"].clone(), photo::load(&place.path("light.png")).unwrap())
    };
    let (psi, light) = capture("--range 8:0");
    assert_eq!(psi, serde_json::json!([0.0, 8.0]));
    place
        .edof("capture photo.png --camera clear --psi 0 --no-measure --out flat.png --light flat-light.png")
        .done();
    let flat = photo::load(&place.path("flat-light.png")).unwrap();
    let moved = |light: &ColourFrame, columns: std::ops::Range<usize>| {
        let part = s![.., .., columns];
        (&light.planes.slice(part) - &flat.planes.slice(part)).mapv(f32::abs).mean().unwrap()
    };
    assert!(
        moved(&light, 0..40) > 10.0 * moved(&light, 60..96),
        "near is blurred, far is not: {} {}",
        moved(&light, 0..40),
        moved(&light, 60..96)
    );
    let (metres, _) = capture("--range 3.1109m:10m --nominal 10");
    assert!((metres[1].as_f64().unwrap() - 8.0).abs() < 1e-3 && metres[0].as_f64().unwrap().abs() < 1e-9);
    // The same map as one of distances: white is far.
    let (distances, light) = capture("--range 3.1109m:10m --nominal 10 --map-of distance");
    assert!((distances[1].as_f64().unwrap() - 8.0).abs() < 1e-3, "{distances}");
    assert!(moved(&light, 60..96) > 10.0 * moved(&light, 0..40));
    place.edof("reconstruct raw.png --weights net.safetensors --out out.png").done();
}

#[test]
fn what_cannot_be_captured_or_random_is_rejected_in_one_line() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place.photo("odd.png", 65, 48);
    place.write("small.pgm", "P2 2 2 255 1 2 3 4");
    let before = place.files();
    for (line, words) in [
        ("capture photo.png --out r.png", ["--psi: expected one value", "one depth"]),
        ("capture photo.png --psi 2m --out r.png", ["--psi 2m: camera", "--nominal"]),
        ("capture photo.png --depth-map odd.png --range 8:0 --out r.png", ["odd.png", "expected a grey one"]),
        (
            "capture photo.png --depth-map small.pgm --range 8:0 --out r.png",
            ["small.pgm: 2x2", "expected 64x48"],
        ),
        (
            "capture chart --depth-map small.pgm --range 8:0 --out r.png",
            ["--depth-map small.pgm", "only photographs"],
        ),
        ("capture photo.png --psi 1 --psf-bank photo.png --out r.png", ["photo.png", "not a whole NPZ"]),
        ("optics --psf-bank none.npz", ["none.npz", "cannot read"]),
        ("capture photo.png --psi 900 --out r.png", ["psi 900", "within 200"]),
        (
            "capture photo.png --psi 1 --bit-depth 7 --out r.png",
            ["--bit-depth 7: must be 8 to 16", "8 to 16"],
        ),
        ("capture photo.png --psi 1 --energy 0 --out r.png", ["--energy 0", "at most 1"]),
        ("capture photo.png --psi 1 --camera none --out r.png", ["camera 'none'", "ring-outer"]),
        ("capture none.png --psi 1 --out r.png", ["none.png", "cannot read"]),
        ("capture photo.png --psi 1 --no-measure --out odd.png/r.png", ["odd.png/r.png", "cannot write"]),
        ("capture chart-4 --psi 1,2 --out r.png", ["--psi: 2 values", "expected 4"]),
        ("scene sea", ["scene 'sea'", "leaves-4"]),
        ("scene chart --size 30x30", ["--size 30x30", "at least 64"]),
        ("optics ring-1999", ["camera 'ring-1999'", "presets"]),
        ("optics --psi 1,900", ["--psi 900", "within 200"]),
        ("optics design --rings 5 --out c.json", ["rings is 5", "0, 1 or 2"]),
        ("optics design --focus 1e9 --out c.json", ["psi is", "within 200"]),
        ("optics design --psi-range=0,1e9 --out c.json", ["psi_range is [0, 1000000000]", "at most 10000"]),
        ("optics design --population 18446744073709551615 --out c.json", ["population", "4 to 10000"]),
        ("optics design --window 9 --out c.json", ["window 9", "8, 12 or 16"]),
        ("optics design --psi-range=3 --out c.json", ["--psi-range", "two values of psi"]),
    ] {
        place.edof(line).refused(&words);
        assert_eq!(place.files(), before, "{line}");
    }
}

/// A background, and a card in front of its left half.
fn layers(place: &Place) {
    place.photo("room.png", 64, 48);
    let mut card = ColourFrame::zeros(48, 64);
    card.planes.fill(0.8);
    edof_io::photo::save(&place.path("card.png"), &card, 8).unwrap();
    let mut matte = ColourFrame::zeros(48, 64);
    matte.planes.slice_mut(ndarray::s![.., .., ..32]).fill(1.0);
    edof_io::photo::save(&place.path("matte.png"), &matte, 8).unwrap();
}

const SCENE: &str = r#"{"layers": [{"picture": "room.png", "depth": 0},
    {"picture": "card.png", "matte": "matte.png", "depth": 4.5}]}"#;

#[test]
fn a_scene_of_layers_is_captured_with_its_occlusion() {
    let place = Place::new();
    layers(&place);
    place.write("scene.json", SCENE);
    let capture = "capture scene.json --camera clear --tone linear --no-measure";
    place.edof(&format!("{capture} --out raw.png --sharp sharp.png --light light.png")).done();
    let [room, sharp, light] = ["room.png", "sharp.png", "light.png"]
        .map(|name| edof_io::photo::load(&place.path(name)).unwrap().planes);
    for ((p, r, c), value) in sharp.indexed_iter() {
        let expected = if c < 32 { 0.8 } else { room[(p, r, c)] };
        assert!((value - expected).abs() < 2.0 / 255.0, "row {r}, column {c}: {value}, not {expected}");
    }
    // The lens is focused on the room; the card in front of it is blurred over its edge, and not farther.
    let alone = "capture room.png --psi 0 --camera clear --tone linear --no-measure --out alone.png --light without.png";
    place.edof(alone).done();
    let without = edof_io::photo::load(&place.path("without.png")).unwrap().planes;
    let over_the_edge = |column: usize| light[(1, 24, column)] - without[(1, 24, column)];
    assert!(over_the_edge(33) > 0.015 && over_the_edge(60).abs() < 0.005, "{}", over_the_edge(33));
    let text = std::fs::read_to_string(place.path("raw.png.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(record["psi"], serde_json::json!([0.0, 4.5]));
    let metres = SCENE.replace("4.5", "\"2m\"").replace("\"depth\": 0}", "\"depth\": \"infm\"}");
    place.write("scene.json", metres);
    place.edof(&format!("{capture} --nominal inf --out metres.png")).done();
}

#[test]
fn layers_that_make_no_scene_are_reported_by_file_and_place() {
    let place = Place::new();
    layers(&place);
    place.photo("small.png", 32, 48);
    let refused = |scene: &str, more: &str, words: &[&str]| {
        place.write("scene.json", scene);
        let before = place.snapshot();
        place.edof(&format!("capture scene.json --camera clear --out raw.png {more}")).refused(words);
        assert_eq!(place.snapshot(), before, "{scene}");
    };
    refused("{", "", &["scene.json: no scene of layers: "]);
    refused(r#"{"layers": []}"#, "", &["scene.json: 0 layers, expected 1 to 64"]);
    refused(r#"{"layers": [{"picture": "room.png", "depth": 0, "blur": 1}]}"#, "", &["unknown field `blur`"]);
    refused(&SCENE.replace(r#", "matte": "matte.png""#, ""), "", &["scene.json: layer 1 has no matte"]);
    let matted = r#"{"layers": [{"picture": "room.png", "matte": "matte.png", "depth": 0}]}"#;
    refused(matted, "", &["scene.json: its first layer has a matte"]);
    refused(&SCENE.replace("matte.png", "small.png"), "", &["small.png: "]);
    refused(&SCENE.replace("card.png", "none.png"), "", &["none.png: cannot read"]);
    refused(&SCENE.replace("card.png", "small.png"), "", &["matte.png: 64x48, expected 32x48 as small.png"]);
    refused(&SCENE.replace("4.5", "\"near\""), "", &["scene.json: layer 1: depth 'near': must be a psi"]);
    refused(&SCENE.replace("4.5", "1e9"), "", &["psi"]);
    refused(SCENE, "--psi 3", &["--psi: scene.json says it for each of its layers"]);
    refused(SCENE, "--sharp card.png", &["--sharp card.png: would replace "]);
    refused(SCENE, "--json matte.png", &["--json matte.png: would replace "]);
}

#[test]
fn a_polynomial_mask_is_captured_and_searched_and_rejected_by_its_field() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let mask = r#"{"mask": [{"polynomial": {"at_nm": 460, "cauchy": [1.458, 0.00354], "terms": [{"x": 3, "y": 0, "rad": 6.0}, {"x": 0, "y": 3, "rad": 6.0}]}}],"#;
    let text = include_str!("../cameras/clear-mid.json").replacen('{', mask, 1);
    place.write("cubic.json", &text);
    let line = "capture photo.png --camera cubic.json --psi 6 --no-measure --out";
    place.edof(&format!("{line} raw.png")).done();
    let record = json(&std::fs::read_to_string(place.path("raw.png.json")).unwrap());
    assert_eq!(record["camera"]["mask"][0]["polynomial"]["terms"][1]["rad"], 6.0);
    place.edof("capture photo.png --camera clear-mid --psi 6 --no-measure --out clear.png").done();
    let [light, without] = ["raw.png", "clear.png"].map(|name| photo::load_grey(&place.path(name)).unwrap());
    assert!((light - without).iter().any(|d| d.abs() > 0.01));
    // A lens without rings is not a clear lens.
    place
        .edof("reconstruct raw.png --weights edof-t4w12-clear --out no.png")
        .refused(&["was taken by clear-mid"]);
    for (from, to, words) in [
        (
            "\"x\": 3",
            "\"x\": 9",
            ["cubic.json: camera clear-mid: mask.polynomial.terms is x^9 y^0 of 6 rad", "1 to 5 in sum"],
        ),
        ("\"at_nm\": 460", "\"at_nm\": 0", ["mask.polynomial.at_nm is 0", "100 to 30000 nm"]),
        ("1.458, 0.00354", "1, 0", ["mask.polynomial.cauchy is [1, 0]", "differs from 1"]),
        ("\"polynomial\"", "\"cubic\"", ["cubic.json: not a camera: mask[0]: ", "unknown value `cubic`"]),
        (
            "\"rad\": 6.0}]",
            "\"radians\": 6.0}]",
            ["cubic.json: not a camera: mask[0]", "unknown field `radians`"],
        ),
    ] {
        place.write("cubic.json", text.replacen(from, to, 1));
        place.edof(&format!("{line} no.png")).refused(&words);
    }
    place.write("cubic.json", &text);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 320, 288);
    place.float_network("net.safetensors");
    let line = "optics design --through net.safetensors --camera cubic.json --images photos --photos all --steps 4 --windows 8 --rounds 2";
    let report = json(&place.edof(&format!("{line} --out mine.json --json")).done().out);
    assert_eq!(report["history"][0]["gradient"].as_array().unwrap().len(), 3);
    let coefficient =
        |camera: &serde_json::Value| camera["mask"][0]["polynomial"]["terms"][0]["rad"].as_f64().unwrap();
    assert_ne!(coefficient(&report["camera"]), coefficient(&report["start"]), "the coefficient moved");
    assert!(!place.path("no.png").exists());
}
