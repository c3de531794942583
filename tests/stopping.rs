//! Ctrl-C: every command ends with status 130 long before its work is done, and leaves no unfinished file.

#![cfg(target_os = "linux")]

use crate::support::Place;
use std::process::{Child, Command, Stdio};

fn ready() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/kodim03.png", 2048, 2048);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place
}

/// Waits until the program listens to signals, which it does first of all.
fn listens(child: &mut Child) {
    loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap().trim();
        if u64::from_str_radix(caught, 16).unwrap() & (1 << 1) != 0 {
            return;
        }
        assert!(child.try_wait().unwrap().is_none(), "ended before it was asked to");
    }
}

fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

/// Jobs of many minutes.
const JOBS: [&str; 11] = [
    "capture leaves-4 --size 3000x3000 --exact --out raw.png",
    "capture photos/kodim03.png --psi 8 --exact --out raw.png",
    "scene leaves-4 --size 6000x6000 --out drawn",
    "optics design --generations 100000 --out camera.json",
    "optics design --through net.safetensors --images photos --photos all --steps 100000000 --out camera.json",
    "quantize net.safetensors --images photos --photos all --finetune 100000000 --out out.fixed.safetensors",
    "train --form edof-t4w12 --camera clear --images photos --photos all --depths 2 --steps 100000000 --out x.safetensors",
    "study kodak --nets net.safetensors --images photos --psi 0,1,2,3,4,5,6,7,8 --exact --json study.json",
    "study multi-depth --height 3000 --width 3000 --csv rows.csv",
    "demo --height 3000 --width 3000 --out shown",
    "cosim --design tiny --random 100000 --json cosim.json",
];

#[test]
fn every_command_stops_when_asked() {
    let place = ready();
    for job in JOBS {
        let before = place.files();
        let mut child = place.command(job).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        listens(&mut child);
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{job}: {said}");
        assert!(said.ends_with("edof: interrupted\n"), "{job}: {said}");
        let left: Vec<String> = place.files().into_iter().filter(|name| !before.contains(name)).collect();
        // Training must leave a checkpoint.
        assert!(left.iter().all(|name| name == "x.safetensors.checkpoint"), "{job}: {left:?}");
        assert_eq!(left.is_empty(), !said.contains("continue with --resume"), "{job}: {said}");
    }
}

#[test]
fn a_stopped_search_of_lens_and_network_resumes_and_ends_with_the_same_lens() {
    let place = ready();
    for folder in ["small", "whole"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("small/a.png", 320, 288);
    let line = "optics design --through net.safetensors --camera ring-2018 --images small --photos all --psi-range 0,1 --rounds 3 --steps 10 --windows 8";
    place.edof(&format!("{line} --out whole/lens.json")).done();
    let search = format!("{line} --out lens.json");
    let mut child = place.command(&search).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("lens.json.search").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended without a checkpoint");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(130) && said.contains("continue with --resume"), "{said}");
    place.edof(&search).refused(&["lens.json.search", "--resume"]);
    place.edof(&format!("{search} --seed 7 --resume")).refused(&["lens.json.search", "another search"]);
    place.edof(&format!("{search} --resume")).done();
    assert!(!place.path("lens.json.search").exists());
    let [whole, resumed] =
        ["whole/lens.json", "lens.json"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert_eq!(whole, resumed);
    place.edof(&format!("{search} --force --resume")).refused(&["there is no checkpoint"]);
}

#[test]
fn a_stopped_study_says_that_its_rows_are_kept() {
    let place = ready();
    std::fs::create_dir(place.path("small")).unwrap();
    for number in 1..=9 {
        place.photo(&format!("small/kodim0{number}.png"), 320, 288);
    }
    let line =
        "study kodak --images small --photos all --nets net.safetensors --psi 0,2,4,6,8 --rows rows.jsonl";
    let mut child = place.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let rows = || std::fs::read_to_string(place.path("rows.jsonl")).unwrap_or_default().lines().count();
    while rows() < 2 {
        assert!(child.try_wait().unwrap().is_none(), "ended without a row");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    interrupt(&child);
    let said = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
    assert!(
        said.contains("rows.jsonl: ") && said.contains("rows are kept; the same command continues"),
        "{said}"
    );
}

#[test]
fn a_stopped_training_says_how_to_continue() {
    let place = ready();
    std::fs::create_dir(place.path("small")).unwrap();
    place.photo("small/a.png", 320, 288);
    let line = "train --form edof-t4w12 --camera clear --images small --photos all --depths 2 --steps 100000000 --out x.safetensors";
    let mut child = place.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("x.safetensors.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended without a checkpoint");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    std::thread::sleep(std::time::Duration::from_millis(100));
    interrupt(&child);
    let said = String::from_utf8(child.wait_with_output().unwrap().stderr).unwrap();
    assert!(said.contains("x.safetensors.checkpoint: checkpoint at step "), "{said}");
    assert!(said.contains("continue with --resume"), "{said}");
}

#[test]
fn a_training_that_is_told_twice_at_once_keeps_its_steps() {
    let place = ready();
    std::fs::create_dir(place.path("small")).unwrap();
    place.photo("small/a.png", 320, 288);
    let line = "train --form edof-t4w12 --camera clear --images small --photos all --depths 2 --batch 8 --steps 100000000 --out x.safetensors";
    let mut child = place.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("x.safetensors.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended without a checkpoint");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    std::thread::sleep(std::time::Duration::from_millis(100));
    // As timeout does: to the program, and to its group.
    let id = child.id();
    let twice = format!("kill -TERM {id}; kill -TERM {id}; kill -CONT {id}");
    assert!(Command::new("sh").args(["-c", &twice]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("checkpoint at step ") && !said.contains("checkpoint at step 0;"), "{said}");
}

#[test]
fn a_program_that_is_told_twice_ends() {
    let place = ready();
    let mut child = place.command(JOBS[1]).stderr(Stdio::null()).spawn().unwrap();
    listens(&mut child);
    interrupt(&child);
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
