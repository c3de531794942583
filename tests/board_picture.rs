//! A whole raw frame onto a simulated board over the line, interrupted and resumed, and the board's picture of it.

#![cfg(target_os = "linux")]

use crate::board::{Sim, drawn};
use crate::support::Place;
use edof_io::photo;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// Runs a command of the board, which succeeds; returns what it prints.
fn board(place: &Place, line: &str) -> String {
    place.edof(&format!("board {line} --port board")).done().out
}

/// A raw frame without the two bits that a cable does not carry.
fn write_raw(place: &Place, width: u32, height: u32) {
    let word = |i: u32| ((i.wrapping_mul(2_654_435_761) >> 16) as u16 & 0xfffc).to_be_bytes();
    let header = format!("P5 {width} {height} 65535\n");
    std::fs::write(
        place.path("raw.pgm"),
        header.bytes().chain((0..width * height).flat_map(word)).collect::<Vec<u8>>(),
    )
    .unwrap();
}

fn json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(place.path(name)).unwrap()).unwrap()
}

#[test]
fn a_whole_frame_is_put_and_its_picture_comes_back() {
    let place = Place::new();
    drawn(&place, "own", 5);
    let _sim = Sim::start(&place, "--weights own.fixed.safetensors --size 96x80");
    write_raw(&place, 96, 80);
    let said = board(&place, "picture put raw.pgm --size 96x80 --json put.json");
    assert!(said.starts_with("96x80 pixels from column 0, row 0 are the board's frame, after "), "{said}");
    let sent = &json(&place, "put.json")["sent"];
    assert_eq!(
        (&sent["blocks"], &sent["words"], &sent["resumed"]),
        (&2.into(), &(96 * 40).into(), &0.into())
    );
    let said = board(&place, "picture put raw.pgm --size 96x80");
    assert!(said.ends_with("; 2 of 2 blocks were there\n"), "{said}");
    let compare = "picture compare raw.pgm --weights own.fixed.safetensors";
    let said = board(&place, &format!("{compare} --size 96x80"));
    assert_eq!(said, "96x80 pixels: every boundary as the golden model's\n");
    // The picture is the one that the same frame gives without a board.
    board(&place, "picture get whole.png --size 96x80");
    place.edof("reconstruct raw.pgm --weights own.fixed.safetensors --board --out expected.png").done();
    let pixels = |name: &str| photo::load(&place.path(name)).unwrap().planes;
    assert!(pixels("whole.png") == pixels("expected.png"), "another picture came back");

    // A part of it in black.
    board(&place, "picture put raw.pgm --size 40x20 --at 8,6");
    board(&place, &format!("{compare} --size 40x20 --put-at 8,6"));
    place
        .edof(&format!("board {compare} --size 40x20 --port board"))
        .refused(&["board: raw frames that come out of the memory differ first: CRC "]);
    for (size, words) in [
        ("98x80", "--size 98x80: must be two even numbers, at most 96x80, the board's frame"),
        ("95x80", "--size 95x80: must be two even numbers, at most 96x80, the board's frame"),
    ] {
        place.edof(&format!("board picture put raw.pgm --size {size} --port board")).refused(&[words]);
    }
    place
        .edof("board picture get out.png --size 64x64 --at 64,0 --port board")
        .refused(&["--size 64x64: reaches out of the board's frame of 96x80"]);
    place.edof("board picture get odd.png --size 63x64 --port board").refused(&["--size 63x64: must be "]);
    write_raw(&place, 94, 80);
    place
        .edof("board picture put raw.pgm --size 96x80 --port board")
        .refused(&["raw.pgm: 94x80 pixels have no 96x80 from column 0, row 0, which must be even"]);
}

#[test]
fn a_put_that_ctrl_c_ends_is_resumed_by_the_same_command() {
    let place = Place::new();
    drawn(&place, "own", 5);
    let _sim = Sim::start(&place, "--weights own.fixed.safetensors --size 320x240");
    write_raw(&place, 320, 240);
    let line = "board picture put raw.pgm --size 320x240 --port board --progress json";
    let mut child = place.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // With the first words.
    let total = format!("\"total\":{}", 320 * 240 / 2);
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("\"progress\":\"words\"") && line.contains(&total)));
    let interrupted = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupted.unwrap().success());
    let said: Vec<String> = lines.collect();
    for words in ["the same command resumes", "interrupted"] {
        assert!(said.iter().any(|line| line.contains(words)), "{said:?}");
    }
    assert!(!child.wait().unwrap().success());
    board(&place, "picture put raw.pgm --size 320x240 --json put.json");
    let sent = &json(&place, "put.json")["sent"];
    let [blocks, resumed] = ["blocks", "resumed"].map(|name| sent[name].as_u64().unwrap());
    assert!(resumed < blocks, "{sent}");
    board(&place, "picture compare raw.pgm --weights own.fixed.safetensors --size 320x240");
}

/// First light of the ULX3S by the commands for a board, all of it between the pins in Verilog.
#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_ulx3s_is_tried_loaded_and_shows_golden_pictures() {
    let place = Place::new();
    for (name, seed) in [("own", 5), ("other", 6)] {
        let line = format!("random-network --design ulx3s --seed {seed} --out {name}.fixed.safetensors");
        place.edof(&line).done();
    }
    let _sim = Sim::start(
        &place,
        "--rtl --design ulx3s --size 32x24 --baud 6250000 --weights own.fixed.safetensors",
    );
    let said = board(&place, "selftest own.fixed.safetensors");
    assert!(said.ends_with("every part that was tried works\n") && !said.contains("receiver"), "{said}");
    board(&place, "load other.fixed.safetensors");
    let said = board(&place, "check other.fixed.safetensors --frames 1");
    assert!(said.ends_with("bit-exact on this board, at speed\n"), "{said}");
    write_raw(&place, 32, 24);
    board(&place, "picture put raw.pgm --size 32x24");
    let said = board(&place, "picture compare raw.pgm --weights other.fixed.safetensors --size 32x24");
    assert_eq!(said, "32x24 pixels: every boundary as the golden model's\n");
    board(&place, "picture get whole.png --size 32x24");
    place.edof("reconstruct raw.pgm --weights other.fixed.safetensors --board --out expected.png").done();
    let pixels = |name: &str| photo::load(&place.path(name)).unwrap().planes;
    assert!(pixels("whole.png") == pixels("expected.png"), "another picture came back");
}

#[test]
fn a_graphics_card_is_calibrated_by_its_chart() {
    let place = Place::new();
    drawn(&place, "own", 5);
    place.edof("board calibrate picture chart.png --size 96x80").done();
    let chart = photo::load(&place.path("chart.png")).unwrap().planes;
    // What arrives of it: luma 16 to 235 above chroma 128, as words of a raw frame.
    let luma = |grey: f32| (16.0 + grey * 219.0).round() as u8;
    let word = |i: usize| [luma(chart[(0, i / 96, i % 96)]), 128];
    let header = b"P5 96 80 65535\n".to_vec();
    let raw = [header, (0..96 * 80).flat_map(word).collect()].concat();
    std::fs::write(place.path("raw.pgm"), raw).unwrap();
    let _sim = Sim::start(&place, "--weights own.fixed.safetensors --size 96x80 --frame raw.pgm");
    let said = board(&place, "calibrate read card.json");
    assert_eq!(
        said,
        "greys 0 to 255 arrive as luma 16 to 235; greys 56 to 204 carry all 128 codes; the board now takes raw frames in grey\n"
    );
    assert_eq!(board(&place, "get video_setup.grey"), "0x00000001 1\n");
    place.edof("capture leaves --size 96x80 --psi 0 --out r.png --video v.rgb --grey card.json").done();
}
