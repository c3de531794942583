//! JSON of the board commands: one object per command, failures too, one line per snapshot, and progress of a load.

#![cfg(target_os = "linux")]

use crate::board::{Sim, drawn, wait};
use crate::support::{Place, Run};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

fn board(place: &Place, line: &str) -> Run {
    place.edof(&format!("board {line} --port board --json"))
}

/// The one object on standard output.
#[track_caller]
fn object(run: &Run) -> Value {
    let value: Value =
        serde_json::from_str(&run.out).unwrap_or_else(|e| panic!("{e}: {} {}", run.out, run.err));
    assert!(value.is_object(), "{value}");
    value
}

#[test]
fn every_command_of_a_board_prints_one_object() {
    let place = Place::new();
    drawn(&place, "own", 5);
    drawn(&place, "other", 6);
    let sim = Sim::start(&place, "--weights own.fixed.safetensors");
    wait("chips are set up", || object(&board(&place, "get status.i2c_done"))["value"] == 1);
    for line in [
        "find",
        "info",
        "load other.fixed.safetensors",
        "verify other.fixed.safetensors",
        "status --seconds 0.1",
        "align --codes 100",
        "get scratch",
        "set scratch 3",
        "dump",
        "skip on",
        "display luma",
        "bank a",
        "flush",
        "reset",
        "map",
    ] {
        // The map is that of the program: no port is opened.
        let run = if line == "map" { place.edof("board map --json") } else { board(&place, line) }.done();
        let found = object(&run);
        assert!(found.get("error").is_none() && found.get("provenance").is_some(), "{line}: {found}");
    }
    assert_eq!(object(&board(&place, "set scratch 7"))["value"], 7);
    let run = board(&place, "map");
    assert_eq!(run.code, Some(1));
    assert!(
        object(&run)["error"].as_str().unwrap().starts_with("--port board: has no effect on edof board map")
    );
    sim.end_quietly();
}

#[test]
fn a_failure_is_an_object_too_and_tells_what_differed() {
    let place = Place::new();
    drawn(&place, "own", 5);
    drawn(&place, "other", 6);
    let sim = Sim::start(&place, "--weights own.fixed.safetensors");
    let run = board(&place, "verify other.fixed.safetensors");
    assert_eq!(run.code, Some(1));
    let told = object(&run);
    assert_eq!(
        (&told["bank"], &told["weights"]),
        (&Value::from("a"), &Value::from("other.fixed.safetensors"))
    );
    let differ = told["differ"].as_array().unwrap();
    assert!(!differ.is_empty() && differ.len() <= told["parts"].as_u64().unwrap() as usize, "{told}");
    assert!(told["error"].as_str().unwrap().contains("bank a does not hold"), "{told}");
    let run = board(&place, "verify own.fixed.safetensors --curve bt709");
    let told = object(&run);
    assert_eq!((run.code, told["tables_differ"].as_array().unwrap().len()), (Some(1), 4), "{told}");
    for line in ["get contrl", "set scratch many", "load paper-t4", "set id 3", "get weights[99999999]"] {
        let run = board(&place, line);
        let told = object(&run);
        let error = told["error"].as_str().unwrap_or_else(|| panic!("{line}: {told}"));
        assert!(run.code == Some(1) && run.err.contains(error), "{line}: {} {told}", run.err);
    }
    sim.end_quietly();
    let run = place.edof("board find --port board --json");
    let told = object(&run);
    assert_eq!((run.code, &told["boards"]), (Some(1), &Value::from(0)), "{told}");
    assert!(run.err.contains("board: there is no such path"), "{}", run.err);
}

#[test]
fn a_watch_is_one_object_a_line_with_a_time() {
    let place = Place::new();
    let sim = Sim::start(&place, "");
    let line = "board status --watch --seconds 0.1 --port board --json";
    let mut child = place.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut looks = vec![];
    for _ in 0..3 {
        looks.push(serde_json::from_str::<Value>(&lines.next().unwrap().unwrap()).unwrap());
    }
    for pair in looks.windows(2) {
        let [before, after] = [&pair[0], &pair[1]].map(|look| look["time"].as_str().unwrap());
        assert!(before < after && before.len() == "2026-11-22T07:05:09.250Z".len(), "{before}, {after}");
        assert!(pair[0]["report"]["frames_per_second"].is_number(), "{}", pair[0]);
    }
    // Meanwhile nobody else talks on the line.
    place.edof("board info --port board").refused(&["board: another program has the port", "--port"]);
    // A command at the end of the board prints a sentence.
    drop(sim);
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("board: the board went away") && told.contains("'edof board info'"), "{told}");
}

#[test]
fn networks_of_ones_own_have_names_and_both_banks_have_hashes() {
    let place = Place::new();
    drawn(&place, "own", 5);
    drawn(&place, "other", 6);
    let sim = Sim::start(&place, "--weights own.fixed.safetensors");
    board(&place, "load other.fixed.safetensors").done();
    let banks = |line: &str| object(&board(&place, line).done())["banks"].clone();
    let unknown = banks("info");
    assert!(unknown[0]["weights"].is_null() && unknown[0]["hash"].is_null(), "{unknown}");
    assert!(unknown[1]["weights"].is_null() && unknown[1]["hash"].is_string(), "{unknown}");
    let named = banks("info --weights own.fixed.safetensors,other.fixed.safetensors");
    let name = |bank: usize| named[bank]["weights"].as_str().unwrap_or_else(|| panic!("{named}")).to_owned();
    assert_ne!(name(0), "");
    assert_eq!(named[1]["hash"], unknown[1]["hash"], "the register holds the hash of the bank in use");
    assert!(named[0]["hash"].is_string() && named[0]["hash"] != named[1]["hash"], "{named}");
    // Without a name the idle bank is known by a checksum of its words, which is the same when its name is known.
    let sums = |told: &Value| [0, 1].map(|bank| told[bank]["checksum"].as_str().unwrap().to_owned());
    assert_eq!(sums(&unknown), sums(&named));
    assert_ne!(sums(&named)[0], sums(&named)[1]);
    let said = place.edof("board info --port board").done().out;
    let idle = format!(
        "bank a: checksum {}, a network that the program does not have; name its file by --weights",
        sums(&named)[0]
    );
    assert!(said.contains(&idle), "{said}");
    // Switched to by name, the bank has its hash again.
    let told = object(&board(&place, "bank a --weights own.fixed.safetensors").done());
    assert_eq!((&told["weights"], &told["hash"]), (&named[0]["weights"], &named[0]["hash"]));
    // In the other bank it is the same network.
    board(&place, "load own.fixed.safetensors").done();
    let alike = sums(&banks("info"));
    assert_eq!(alike, [sums(&named)[0].clone(), sums(&named)[0].clone()]);
    sim.end_quietly();
}

#[test]
fn how_far_a_load_is_can_be_read_by_a_program() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "");
    let run = place.edof("board load new.fixed.safetensors --full --port board --progress json").done();
    let lines = progress(&run.err);
    assert!(lines.len() >= 2, "{}", run.err);
    assert!(lines.iter().all(|line| line["progress"] == "words" && line["time"].is_string()), "{}", run.err);
    let last = lines.last().unwrap();
    assert_eq!(last["done"], last["total"]);
    sim.end_quietly();
}

/// Lines of JSON on standard error.
fn progress(err: &str) -> Vec<Value> {
    err.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

#[test]
fn captures_and_generated_sources_tell_how_far_they_are() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    drawn(&place, "net", 5);
    for (command, what) in [
        ("capture photo.png --psi 4 --out raw.png --measure", "capture"),
        ("generate --design tiny --weights net.fixed.safetensors --out out", "sources"),
    ] {
        let lines = progress(&place.edof(&format!("{command} --progress json")).done().err);
        let own: Vec<&Value> = lines.iter().filter(|line| line["progress"] == what).collect();
        let done: Vec<u64> = own.iter().map(|line| line["done"].as_u64().unwrap()).collect();
        assert!(done.len() >= 3 && done.is_sorted(), "{command}: {lines:?}");
        assert_eq!(own.last().unwrap()["done"], own.last().unwrap()["total"], "{command}: {lines:?}");
        assert!(own.iter().any(|line| line["message"].as_str().is_some_and(|m| !m.is_empty())), "{lines:?}");
    }
}

/// Seconds of a day in a line's time.
fn seconds(line: &Value) -> f64 {
    let time = line["time"].as_str().unwrap().split_once('T').unwrap().1.trim_end_matches('Z');
    time.split(':').fold(0.0, |sum, part| 60.0 * sum + part.parse::<f64>().unwrap())
}

#[test]
fn progress_states_the_seconds_since_the_work_began() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    for name in ["a", "b"] {
        place.photo(&format!("photos/{name}.png"), 288, 256);
    }
    let dictionary =
        "study dictionary --images photos --photos all --out d --atoms 8 --patches 2000 --rounds 4";
    for (command, what, steps) in
        [("optics clear --psi 0,4,8 --out oo", "depths", 36), (dictionary, "rounds", 4)]
    {
        let lines = progress(&place.edof(&format!("{command} --progress json")).done().err);
        let own: Vec<&Value> = lines.iter().filter(|line| line["progress"] == what).collect();
        let last = own.last().unwrap();
        assert_eq!((&last["done"], &last["total"]), (&steps.into(), &steps.into()), "{command}: {lines:?}");
        // A run over midnight is a day long.
        let passed = (seconds(last) - seconds(own[0])).rem_euclid(86_400.0);
        let told = last["seconds"].as_f64().unwrap();
        assert!((told - passed).abs() < 0.1, "{command}: {told} s, {passed} s passed: {lines:?}");
    }
}

#[test]
fn wrong_usage_is_data_for_programs_too() {
    let place = Place::new();
    let run = place.edof("capture photo.png --spam --progress json");
    let lines = progress(&run.err);
    assert_eq!((run.code, lines.len()), (Some(2), 1), "{}", run.err);
    assert!(
        lines[0]["error"].as_str().unwrap().starts_with("unexpected argument '--spam' found"),
        "{lines:?}"
    );
    for line in
        ["board get --json", "board bank c --json", "board --json - info --timeout x", "board spam --json=-"]
    {
        let run = place.edof(line);
        let told = object(&run);
        assert_eq!(run.code, Some(2), "{line}");
        assert!(
            !told["error"].as_str().unwrap().contains('\n') && run.err.starts_with("error: "),
            "{line}: {told}"
        );
    }
    // Others print data where there are results alone.
    assert_eq!(place.edof("capture photo.png --spam --json").out, "");
}

#[test]
fn long_work_writes_its_progress_remarks_and_failure_as_lines_of_data() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.write("photos/b.png", "no picture");
    let train = "train --form two-sided,w8,t2,c8 --camera clear --images photos --depths 1 --batch 64 --steps 4 \
                 --validate-every 2 --no-cache --out net.safetensors --progress json";
    let lines = progress(&place.edof(train).done().err);
    let of = |key: &str, value: &str| {
        lines.iter().filter(|line| line[key].as_str().is_some_and(|v| v.contains(value))).count()
    };
    assert!(of("progress", "blur") >= 1 && of("progress", "train, seed") >= 1, "{lines:?}");
    assert_eq!(of("note", "skipped photos/b.png"), 1, "{lines:?}");
    let last =
        lines.iter().rfind(|line| line["progress"].as_str().is_some_and(|v| v.starts_with("train"))).unwrap();
    assert_eq!((&last["done"], &last["total"]), (&Value::from(4), &Value::from(4)));
    let run = place.edof(train);
    assert_eq!(run.code, Some(1));
    let lines = progress(&run.err);
    assert!(lines.last().unwrap()["error"].as_str().unwrap().contains("is there already"), "{lines:?}");
    let quantize =
        "quantize net.safetensors --images photos --photos all --out net.fixed.safetensors --progress json";
    let lines = progress(&place.edof(quantize).done().err);
    assert!(lines.iter().any(|line| line["progress"] == "pictures captured"), "{lines:?}");
    let expected = lines.iter().find(|line| line["of"].is_number()).unwrap();
    assert!(expected["frames"].as_u64() <= expected["of"].as_u64(), "{expected}");
    assert!(expected["seconds"].as_f64().unwrap() > 0.0, "{expected}");
}
