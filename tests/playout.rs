//! Raw frames as video that a playout card sends to the board, by the real binary.

use crate::support::{self, Place};
use edof_core::Tone;
use edof_io::raw::{self, RawOptions};
use edof_network::weight_file;
use serde_json::Value;

/// Frame and video of a synthetic scene, with a network beside them.
fn captured(more: &str) -> Place {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let line =
        "capture leaves --size 80x64 --camera clear --psi 0 --no-measure --out raw.png --video frame.2vuy";
    place.edof(&format!("{line} {more}")).done();
    place
}

fn bytes(place: &Place, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap()
}

const RECONSTRUCT: &str = "reconstruct --weights net.safetensors --bits 16";

#[test]
fn video_carries_the_upper_fourteen_bits_chroma_first() {
    for (depth, lost) in [(12, 0), (14, 0), (16, 3)] {
        let place = captured(&format!("--bit-depth {depth} --phase gbrg"));
        let video = bytes(&place, "frame.2vuy");
        let words = raw::load(&place.path("raw.png"), &RawOptions::default()).unwrap().pixels().clone();
        assert_eq!(video.len(), 2 * 80 * 64);
        for (pair, word) in video.chunks_exact(2).zip(&words) {
            let [chroma, luma] = [pair[0], pair[1]].map(|code| u16::from(code) - 64);
            assert_eq!(luma * 512 + chroma * 4, word & !lost);
        }
        assert!(depth < 16 || words.iter().any(|word| word & 3 != 0));
        // The record says all that the file does not; without it the size must be given.
        place.edof(&format!("{RECONSTRUCT} --video frame.2vuy --out video.png")).done();
        place.edof(&format!("{RECONSTRUCT} frame.2vuy --out recorded.png")).done();
        place.write("alone.2vuy", &video);
        let line =
            format!("{RECONSTRUCT} --video alone.2vuy --size 80x64 --phase gbrg --tone srgb --out alone.png");
        place.edof(&line).done();
        place.edof(&format!("{RECONSTRUCT} raw.png --out raw-out.png")).done();
        let pictures = ["recorded.png", "alone.png", "raw-out.png"]
            .map(|name| bytes(&place, name) == bytes(&place, "video.png"));
        assert_eq!(pictures, [true, true, lost == 0], "{depth} bits");
    }
}

#[test]
fn the_board_makes_the_same_of_a_frame_and_of_its_video() {
    let place = captured("--bit-depth 16 --noise 0.01");
    let board = "reconstruct --weights net.safetensors --board";
    place.edof(&format!("{board} raw.png --words of-raw --out raw-out.png")).done();
    place.edof(&format!("{board} --video frame.2vuy --words of-video --out video.png")).done();
    assert_eq!(bytes(&place, "raw-out.yuyv"), bytes(&place, "video.yuyv"));
    assert_eq!(bytes(&place, "of-raw/words.npz"), bytes(&place, "of-video/words.npz"));
}

#[test]
fn video_for_networks_of_encoded_values_is_encoded_and_its_record_says_so() {
    let place = Place::new();
    let mut network = support::fixed_network();
    network.origin.values = Tone::Srgb;
    weight_file::save_fixed(&place.path("net.safetensors"), &network).unwrap();
    let line = "capture leaves --size 80x64 --camera clear --psi 0 --noise sensor --no-measure";
    place.edof(&format!("{line} --out raw.png --video frame.2vuy --values srgb")).done();
    let record: Value = serde_json::from_slice(&bytes(&place, "frame.2vuy.json")).unwrap();
    assert_eq!(record["values"], "srgb");
    let words = raw::load(&place.path("raw.png"), &RawOptions::default()).unwrap().pixels().clone();
    for (pair, word) in bytes(&place, "frame.2vuy").chunks_exact(2).zip(&words) {
        let [chroma, luma] = [pair[0], pair[1]].map(|code| u16::from(code) - 64);
        assert_eq!(luma * 512 + chroma * 4, Tone::Srgb.encode_word(*word) & !3);
    }
    let board = "reconstruct --weights net.safetensors --board";
    place.edof(&format!("{board} raw.png --words of-raw --out raw-out.png")).done();
    place.edof(&format!("{board} --video frame.2vuy --words of-video --out video.png")).done();
    assert_eq!(bytes(&place, "raw-out.yuyv"), bytes(&place, "video.yuyv"));
    assert_eq!(bytes(&place, "of-raw/words.npz"), bytes(&place, "of-video/words.npz"));
    // A network that takes light gets the light of the same video.
    place.fixed_network("light.safetensors");
    for (file, out) in [("raw.png", "a.ppm"), ("frame.2vuy", "b.ppm")] {
        place.edof(&format!("reconstruct --weights light.safetensors {file} --out {out}")).done();
    }
    let [a, b] = ["a.ppm", "b.ppm"].map(|name| bytes(&place, name));
    assert!(a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) <= 1), "the cable's 14 bits cost no code");
}

#[test]
fn a_black_level_is_taken_off_before_the_cable() {
    let place = captured("--bit-depth 10 --black-level 64");
    let record: Value = serde_json::from_slice(&bytes(&place, "frame.2vuy.json")).unwrap();
    assert_eq!(
        (&record["depth"], &record["black_level"], &record["video"]),
        (&16.into(), &0.0.into(), &"80x64".into())
    );
    let board = "reconstruct --weights net.safetensors --board";
    place.edof(&format!("{board} raw.png --out raw-out.png")).done();
    place.edof(&format!("{board} --video frame.2vuy --out video.png")).done();
    assert_eq!(bytes(&place, "raw-out.yuyv"), bytes(&place, "video.yuyv"));
}

#[test]
fn video_that_is_no_raw_frame_is_rejected_with_the_place_that_says_so() {
    let place = captured("");
    let mut video = bytes(&place, "frame.2vuy");
    // Luma of row 1, column 3; then chroma of row 0, column 2.
    for (at, code, row, column) in [(2 * (80 + 3) + 1, 63, 1, 3), (4, 235, 0, 2)] {
        video[at] = code;
        place.write("other.2vuy", &video);
        let run = place.edof(&format!("{RECONSTRUCT} --video other.2vuy --size 80x64 --out out.png"));
        let place_of = format!("row {row}, column {column}");
        run.refused(&["other.2vuy", &format!("byte {code}"), &place_of, "expected 64 to 191"]);
    }
    let refused = |more: &str, words: &[&str]| {
        place.edof(&format!("{RECONSTRUCT} {more} --out out.png")).refused(words);
    };
    refused("--video other.2vuy", &["other.2vuy", "size", "WIDTHxHEIGHT"]);
    refused("--video other.2vuy --size 80x62", &["other.2vuy", "10240 bytes", "expected 9920", "80x62"]);
    refused("--video frame.2vuy --size 64x80", &["--size 64x80", "frame.2vuy.json says 80x64"]);
    refused("--packing bytes --size 80x64 frame.2vuy", &["--packing bytes", "says 2vuy"]);
    refused("--video raw.png", &["raw.png"]);
    // A frame of another depth than is stated.
    place.write("deep.2vuy", vec![65; 2 * 80 * 64]);
    refused("--video deep.2vuy --size 80x64 --bit-depth 8", &["deep.2vuy", "row 0, column 0", "8-bit"]);
    assert!(!place.path("out.png").exists());
}

#[test]
fn video_replaces_no_other_file_of_its_command() {
    let place = Place::new();
    for video in ["raw.png", "raw.png.json", "sharp.png"] {
        let line =
            format!("capture leaves --size 80x64 --psi 0 --out raw.png --sharp sharp.png --video {video}");
        place.edof(&line).refused(&[video]);
        assert_eq!(place.files(), Vec::<String>::new());
    }
}

/// A graphics card that makes luma 30 to 218 of grey 0 to 255, as a file of a calibration has it: docs/bring-up.md.
fn calibration(luma: impl Fn(u8) -> u8) -> Vec<u8> {
    let grey = |code: u8| (0..=255).find(|grey| luma(*grey) == code).unwrap();
    let [greys, luma] = [(64..=191).map(grey).collect(), (0..=255).map(&luma).collect::<Vec<u8>>()];
    let provenance = serde_json::to_value(edof_core::storage::provenance::Provenance::default()).unwrap();
    serde_json::to_vec(&serde_json::json!({ "greys": greys, "luma": luma, "provenance": provenance }))
        .unwrap()
}

#[test]
fn video_in_grey_is_two_frames_that_a_graphics_card_turns_into_the_words() {
    let luma = |grey: u8| (30.0 + f64::from(grey) * 188.0 / 255.0).round() as u8;
    let place = Place::new();
    place.write("card.json", calibration(luma));
    let line =
        "capture leaves --size 80x64 --camera clear --psi 0 --no-measure --out raw.png --video frame.rgb";
    place.edof(&format!("{line} --bit-depth 12 --grey card.json")).done();
    let video = bytes(&place, "frame.rgb");
    let words = raw::load(&place.path("raw.png"), &RawOptions::default()).unwrap().pixels().clone();
    assert_eq!(video.len(), 2 * 3 * 80 * 64);
    // The contract's places, written out.
    let code = |half: usize, line: usize, column: usize| {
        let at = 3 * ((64 * half + line) * 80 + column);
        assert!(video[at] == video[at + 1] && video[at] == video[at + 2], "grey");
        u16::from(luma(video[at])) - 64
    };
    for ((row, column), word) in words.indexed_iter() {
        let (half, line, place) = (row / 32, 2 * (row % 32) + column / 40, column % 40);
        let [upper, lower] = [0, 1].map(|i| code(half, line, 2 * place + i));
        assert_eq!(upper * 512 + lower / 2 * 8, *word, "row {row}, column {column}");
        if place == 0 {
            assert_eq!(usize::from(lower % 2), half, "the first mark of a line");
        }
    }
    let record: Value = serde_json::from_slice(&bytes(&place, "frame.rgb.json")).unwrap();
    assert_eq!((&record["depth"], &record["video"]), (&12.into(), &Value::Null));

    let text = String::from_utf8(bytes(&place, "card.json")).unwrap();
    let first = text.split(['[', ',']).nth(1).unwrap();
    let second = text.split(['[', ',']).nth(2).unwrap();
    place.write("twice.json", text.replacen(first, second, 1).as_bytes());
    place.edof(&format!("{line} --grey twice.json")).refused(&[
        "twice.json",
        "greys: must be 128 different numbers from 0 to 255",
        "calibrate read",
    ]);
    place.edof(&format!("{line} --grey none.json")).refused(&["none.json"]);
}
