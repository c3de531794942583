//! What is checked on photographs: the crop that circuits are checked with, and the cycles that a frame takes.

use crate::support::Place;
use edof_io::raw::RawOptions;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The folder of photographs.
fn folder() -> PathBuf {
    let folder = std::env::var_os("EDOF_KODAK").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/kodak"),
        PathBuf::from,
    );
    assert!(
        folder.join("kodim24.png").exists(),
        "no photographs: EDOF_KODAK must name a folder with kodim01.png ... kodim24.png"
    );
    folder
}

/// Checks of frames in circuits use this crop (tests `checking`), so it must be what a camera captures of a photograph.
#[test]
#[ignore = "needs photographs: scripts/test-photographs.sh"]
fn the_crop_of_a_photograph_is_what_the_camera_captures() {
    let folder = folder();
    let place = Place::new();
    let text = include_str!("photograph/crop.pgm");
    let comments: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("# ")).collect();
    let line = comments[1].strip_prefix("edof capture kodim05.png ").unwrap();
    place.edof(&format!("capture {} {line}", folder.join("kodim05.png").display())).done();
    let raw = edof_io::raw::load(&place.path("raw.pgm"), &RawOptions::default()).unwrap();
    let numbers: Vec<usize> = comments[0]
        .split(|letter: char| !letter.is_ascii_digit())
        .filter_map(|word| word.parse().ok())
        .collect();
    let [_, width, height, row, column] = numbers[..] else { panic!("{numbers:?}") };
    let words = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
    let crop: Vec<i32> = words.skip(4).map(|word| word.parse().unwrap()).collect();
    assert_eq!(crop.len(), width * height);
    let values = raw.values();
    for (i, word) in crop.into_iter().enumerate() {
        // Sums of another machine may round otherwise.
        let found = i32::from(values[[row + i / width, column + i % width]]);
        assert!((found - word).abs() <= 2, "pixel {i}: {found}, not {word}");
    }
}

/// Share of cycles that is to be left at 60 frames per second.
const SPARE: f64 = 0.05;

/// `kc705` with the network that it is planned with, on photographs as its camera captures them at three depths with a noise of 0.01: none takes
/// more cycles than its clock leaves at 60 frames per second, less those that are to be left.
fn cycles_are_left(photographs: &[&str]) {
    let folder = folder();
    let photos: String =
        photographs.iter().map(|name| format!(" --photo {}", folder.join(name).display())).collect();
    let line =
        format!("estimate --design kc705 --weights edof-t4w12-outer{photos} --psi 0,4,8 --noise 0.01 --json");
    let report: Value = serde_json::from_str(&Place::new().edof(&line).done().out).unwrap();
    let patches = f64::from((1920 / 8) * (1080 / 8));
    let limit = report["clock_mhz"].as_f64().unwrap() * 1e6 / (60.0 * patches);
    let pictures = report["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 3 * photographs.len());
    for picture in pictures {
        let cycles = picture["cycles_per_patch"].as_f64().unwrap();
        assert!(
            cycles > 96.0 && cycles <= (1.0 - SPARE) * limit,
            "{limit:.1} cycles per patch at most: {picture}"
        );
    }
}

#[test]
#[ignore = "needs photographs: scripts/test-photographs.sh"]
fn kc705_has_cycles_to_spare_on_a_busy_photograph() {
    cycles_are_left(&["kodim21.png"]);
}

#[test]
#[ignore = "minutes where nothing is optimised: scripts/soak.sh"]
fn kc705_has_cycles_to_spare_on_every_test_photograph() {
    let names: Vec<String> = (1..=8).map(|i| format!("kodim{:02}.png", 3 * i)).collect();
    cycles_are_left(&names.iter().map(String::as_str).collect::<Vec<_>>());
}
