//! What took minutes is kept: a finished result is replaced where the user says so, and nowhere else.

use crate::support::Place;
use serde_json::Value;

const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --depths 1 --steps 4 --batch 64 \
                     --validate-every 2 --out net.safetensors";

fn ready() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 288, 256);
    place
}

#[test]
fn a_finished_network_is_replaced_by_force_alone() {
    let place = ready();
    let line = format!("{TRAIN} --photos all");
    place.edof(&line).done();
    let before = place.snapshot();
    let there = ["net.safetensors: is there already", "the network net (", "dB on validation", "--force"];
    place.edof(&format!("{line} --seed 2")).refused(&there);
    place.edof(&format!("{line} --resume")).refused(&[
        "--resume: there is no checkpoint net.safetensors.checkpoint",
        "net.safetensors is finished, the network net (",
        "--force",
    ]);
    place.edof(&format!("{line} --resume --force")).refused(&["--resume: there is no checkpoint"]);
    assert!(place.snapshot() == before);
    place.edof(&format!("{line} --seed 2 --force")).done();
    assert!(place.snapshot() != before);
}

#[test]
fn of_two_trainings_of_one_network_the_second_is_rejected() {
    let place = ready();
    let long =
        TRAIN.replace("--steps 4", "--steps 100000").replace("--validate-every 2", "--validate-every 20");
    let mut first = place.command(&format!("{long} --photos all --quiet")).spawn().unwrap();
    let checkpoint = place.path("net.safetensors.checkpoint");
    for _ in 0..600 {
        if checkpoint.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let run = place.edof(&format!("{TRAIN} --photos all --seed 2"));
    first.kill().unwrap();
    first.wait().unwrap();
    run.refused(&[
        "--out net.safetensors: another training is writing it; wait for it, or name another file",
    ]);
    // Nobody writes it now; what the first one left can be resumed, with its own options alone.
    place
        .edof(&format!("{TRAIN} --photos all --seed 1"))
        .refused(&["net.safetensors.checkpoint: checkpoint of an unfinished run"]);
    let run = place.edof(&format!(
        "{} --photos all --resume --no-cache --quiet",
        long.replace("--batch 64", "--batch 32")
    ));
    run.refused(&[
        "net.safetensors.checkpoint: made with batch 64, cannot be resumed with 32; give the options",
    ]);
}

#[test]
fn what_is_resumed_must_be_there() {
    let place = ready();
    place.edof(&format!("{TRAIN} --resume")).refused(&["there is no checkpoint", "leave --resume out"]);
    place.write("net.safetensors.2.checkpoint", "of seed 2");
    place.edof(&format!("{TRAIN} --resume")).refused(&[
        "there is no checkpoint",
        "net.safetensors.2.checkpoint",
        "--seed",
    ]);
    assert_eq!(place.files(), ["net.safetensors.2.checkpoint", "photos"]);
}

#[test]
fn an_empty_file_is_no_result() {
    let place = ready();
    place.float_network("net.safetensors");
    place.write("new", "");
    place.edof("quantize net.safetensors --out new --json report.json --quiet").done();
    let report: Value = serde_json::from_slice(&std::fs::read(place.path("report.json")).unwrap()).unwrap();
    assert_eq!(report["out"], "new");
    place.edof("quantize net.safetensors --out new --json report.json --quiet --force").done();
}
