//! `edof board` and a simulated board behind a pseudo-terminal; and a client of the same protocol in Python.

#![cfg(target_os = "linux")]

use crate::support::{Place, forge};
use edof_core::Tone;
use edof_network::weight_file;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What Ctrl-C sends.
const SIGINT: i32 = 2;

/// A simulated board in a place, at the link `board`.
pub struct Sim {
    pub child: Child,
}

/// Of the circuit: small frames, and 16 cycles a bit.
const IN_VERILOG: &str = "--rtl --size 64x64 --baud 12500000";

impl Sim {
    /// Without waiting for its link.
    fn start_at_once(place: &Place, more: &str) -> Self {
        let design = if more.contains("--design") { "" } else { "--design tiny" };
        let line = format!("board sim {design} --link board --json board.json {more}");
        Self { child: place.command(&line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap() }
    }

    pub fn start(place: &Place, more: &str) -> Self {
        let patience = Duration::from_secs(if more.contains("--rtl") { 600 } else { 60 });
        let mut sim = Self::start_at_once(place, more);
        let start = Instant::now();
        while !place.path("board").exists() {
            assert!(start.elapsed() < patience, "no pseudo-terminal");
            if sim.child.try_wait().unwrap().is_some() {
                let mut said = String::new();
                sim.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
                panic!("{said}");
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        sim
    }

    /// Ends it as Ctrl-C does; what it carried.
    fn end(mut self, place: &Place) -> Value {
        signal(&self.child, "-INT");
        self.child.wait().unwrap();
        serde_json::from_slice(&std::fs::read(place.path("board.json")).unwrap()).unwrap()
    }
}

impl Sim {
    /// Ends it as Ctrl-C does, and takes its link away.
    pub fn end_quietly(mut self) {
        signal(&self.child, "-INT");
        self.child.wait().unwrap();
    }
}

impl Drop for Sim {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn board(place: &Place, line: &str) -> String {
    place.edof(&format!("board {line} --port board")).done().out
}

pub fn drawn(place: &Place, name: &str, seed: u64) {
    let line =
        format!("random-network --form one-sided,w8,t4,c16,r --seed {seed} --out {name}.fixed.safetensors");
    place.edof(&line).done();
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap()
}

#[test]
fn a_link_of_a_running_board_is_its_own() {
    let place = Place::new();
    // What was left behind leads nowhere.
    std::os::unix::fs::symlink("/dev/pts/no-such-terminal", place.path("board")).unwrap();
    let child = Sim::start_at_once(&place, "");
    wait("the link", || std::fs::read_link(place.path("board")).is_ok_and(|to| to.exists()));
    let to = std::fs::read_link(place.path("board")).unwrap();
    let second = place.edof_within_bounds("board sim --design tiny --link board");
    second.refused(&["board: leads to /dev/pts/", "another board", "name another path"]);
    assert_eq!(std::fs::read_link(place.path("board")).unwrap(), to);
    board(&place, "info");
    drop(child);
}

#[test]
fn the_bank_in_use_keeps_the_hash_of_its_network_whatever_is_asked_for() {
    let place = Place::new();
    drawn(&place, "own", 5);
    let _sim = Sim::start(&place, "--weights own.fixed.safetensors");
    let hash = board(&place, "get weights_hash");
    assert_ne!(hash, "0x00000000 0\n");
    // Both banks hold the same words.
    for bank in ["a", "b", "b", "a"] {
        let said = board(&place, &format!("bank {bank}"));
        assert!(
            said.contains(&format!("bank {bank} is in use: a network that the program does not have, hash ")),
            "{said}"
        );
        assert_eq!(board(&place, "get weights_hash"), hash, "{bank}");
    }
    drawn(&place, "other", 6);
    board(&place, "load other.fixed.safetensors");
    let hash = board(&place, "get weights_hash");
    board(&place, "bank b");
    assert_eq!(board(&place, "get weights_hash"), hash);
    // Of the other one nobody can tell.
    board(&place, "bank a");
    assert_eq!(board(&place, "get weights_hash"), "0x00000000 0\n");
}

/// A network that states a range of noise.
fn of_class(place: &Place, name: &str, seed: u64, range: &str) {
    drawn(place, name, seed);
    forge(&place.path(&format!("{name}.fixed.safetensors")), |text, _| {
        let stated = "\"noise\":\"none\"";
        assert!(text.contains(stated), "{text}");
        *text = text.replace(stated, range);
    });
}

#[test]
fn a_bank_is_chosen_by_the_noise_that_its_network_was_trained_for() {
    let place = Place::new();
    of_class(&place, "low", 5, "\"noise\":\"0.005\"");
    of_class(&place, "mid", 6, "\"noise\":\"0.014\",\"least_noise\":\"0.005\"");
    of_class(&place, "high", 7, "\"noise\":\"0.03\",\"least_noise\":\"0.014\"");
    let _sim = Sim::start(&place, "--weights low.fixed.safetensors");
    drawn(&place, "other", 8);
    board(&place, "load high.fixed.safetensors --bank b");
    let all = "--weights low.fixed.safetensors,mid.fixed.safetensors,high.fixed.safetensors";
    let by_noise = |noise: &str| place.edof(&format!("board bank --noise {noise} {all} --port board")).done();
    for (noise, bank) in [("none", "a"), ("0.02", "b"), ("0.02", "b"), ("0.004", "a")] {
        assert!(by_noise(noise).out.contains(&format!("bank {bank} is in use")), "{noise}");
    }
    // Beyond every range: the nearest, and said so.
    let run = by_noise("0.2");
    assert!(
        run.out.contains("bank b is in use") && run.err.contains("no network for this lens"),
        "{}",
        run.err
    );
    // In neither bank: loaded into the idle one.
    by_noise("none");
    let run = by_noise("0.01");
    assert!(run.out.contains("in bank b") && run.out.contains("bank b is in use"), "{}", run.out);
    board(&place, "verify mid.fixed.safetensors");
    board(&place, "load other.fixed.safetensors");
    board(&place, "load other.fixed.safetensors");
    let run = place.edof("board bank --noise 0.01 --port board");
    run.refused(&["both banks contain networks that the program does not have", "--weights"]);
    assert_eq!(place.edof("board bank --port board").code, Some(2), "a bank or a noise");
}

/// Every command, on a simulated board of either kind.
fn weights_go_onto_it_and_its_picture_changes_to_theirs(more: &str) {
    let place = Place::new();
    drawn(&place, "old", 1);
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, &format!("--weights old.fixed.safetensors --picture out.yuyv {more}"));
    let picture = || std::fs::read(place.path("out.yuyv")).unwrap_or_default();
    wait("a picture", || !picture().is_empty());
    let old = picture();
    let info = board(&place, "info");
    assert!(info.contains("MHz, simulated line\n"), "{info}");
    assert!(info.contains("design tiny") && info.contains("display tables: srgb"), "{info}");
    board(&place, "set scratch 0x1f");
    assert_eq!(board(&place, "get scratch"), "0x0000001f 31\n");
    let said = board(&place, "load new.fixed.safetensors");
    assert!(said.contains("in bank b") && said.contains("bank b is in use"), "{said}");
    wait("the new picture", || picture() != old);
    let said = board(&place, "verify new.fixed.safetensors --curve srgb");
    assert!(said.contains("bank b holds") && said.contains("tables are those of srgb"), "{said}");
    place.edof("board verify new.fixed.safetensors --curve bt709 --port board").refused(&[
        "the display's tables are not those of bt709: 4 parts differ, the first is table of luma",
    ]);
    assert!(board(&place, "status --seconds 0.2").contains("pictures leave"));
    assert!(board(&place, "dump").contains("weights_hash"));
    board(&place, "skip off");
    board(&place, "bank a");
    let run = place.edof("board verify new.fixed.safetensors --port board");
    run.refused(&["bank a does not hold"]);
    board(&place, "bank b");
    board(&place, "display luma");
    board(&place, "reset");
    assert_eq!(board(&place, "get control"), "0x00000007 7\n");
    place.edof("board set weights[0x200000] 5 --port board").done();
    place
        .edof("board set weights[0x200100] 5 --port board")
        .refused(&["words for 0x8800400 are rejected: they belong to the bank or the tables in use"]);
    let ended = sim.end(&place);
    assert_eq!(ended["kind"], if more.is_empty() { "rust" } else { "rtl" });
}

#[test]
fn weights_continueto_a_simulated_board_and_its_picture_changes_to_theirs() {
    weights_go_onto_it_and_its_picture_changes_to_theirs("");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn weights_continueto_the_simulated_circuit_and_its_picture_changes_to_theirs() {
    weights_go_onto_it_and_its_picture_changes_to_theirs(IN_VERILOG);
}

#[test]
fn a_simulated_board_says_how_its_chips_are_and_is_aligned() {
    let place = Place::new();
    let sim = Sim::start(&place, "");
    wait("chips are set up", || board(&place, "get status.i2c_done").contains(" 1"));
    let said = board(&place, "status --seconds 1 --json status.json");
    assert!(said.contains("transmitter: screen plugged in, HDMI, RGB"), "{said}");
    assert!(said.contains("receiver: 64x48, Y'CbCr BT.709") && !said.contains("NOT WORKING"), "{said}");
    let json =
        |name: &str| -> Value { serde_json::from_slice(&std::fs::read(place.path(name)).unwrap()).unwrap() };
    assert_eq!(json("status.json")["chips"][0]["is_good"], true);
    let said = board(&place, "align --codes 100 --json align.json");
    assert!(said.contains("as it is at tap 15: the middle of 32 taps that work"), "{said}");
    let aligned = json("align.json");
    assert_eq!((&aligned["inverted"], &aligned["tap"]), (&Value::Bool(false), &Value::from(15)));
    assert_eq!(aligned["trials"].as_array().unwrap().len(), 64);
    assert!(board(&place, "get video_setup").starts_with("0x00a08f00"));
    sim.end(&place);
}

/// A network in both banks, frames that the board makes itself, each part, and a tile over the line.
#[test]
fn a_simulated_board_is_exact_and_says_so() {
    let place = Place::new();
    drawn(&place, "own", 5);
    let _sim = Sim::start(&place, "--weights own.fixed.safetensors --size 96x80");
    let said = board(&place, "check own.fixed.safetensors --frames 2 --json check.json");
    assert!(said.ends_with("bit-exact on this board, at speed\n"), "{said}");
    let told: Value = serde_json::from_slice(&std::fs::read(place.path("check.json")).unwrap()).unwrap();
    assert_eq!((&told["is_exact"], told["patterns"].as_array().unwrap().len()), (&Value::Bool(true), 6));
    wait("the chips", || board(&place, "get status.i2c_done").contains(" 1"));
    let said = board(&place, "selftest own.fixed.safetensors --json self.json");
    assert!(said.ends_with("every part that was tried works\n"), "{said}");
    let pixels = (0..96 * 80_u32).flat_map(|i| ((i.wrapping_mul(2_654_435_761) >> 16) as u16).to_be_bytes());
    let file: Vec<u8> = b"P5 96 80 65535\n".iter().copied().chain(pixels).collect();
    std::fs::write(place.path("raw.pgm"), file).unwrap();
    board(&place, "picture put raw.pgm");
    board(&place, "picture compare raw.pgm --weights own.fixed.safetensors --at 32,16");
    board(&place, "picture get out.png --at 32,16");
    assert!(place.path("out.png").exists());
    board(&place, "picture off");
    // Another network's pictures are rejected by name.
    drawn(&place, "other", 6);
    let other = place.edof("board check other.fixed.safetensors --port board");
    other.refused(&[
        "bank",
        "does not hold other.fixed.safetensors; load it by 'edof board load other.fixed.safetensors'",
    ]);
}

/// A network that nobody named is that of the simulation, and the board says so.
#[test]
fn the_random_network_of_a_simulated_board_is_known() {
    let place = Place::new();
    let _sim = Sim::start(&place, "");
    let said = board(&place, "info");
    assert_eq!(said.matches("random-test-network").count(), 2, "{said}");
    let said = board(&place, "info --quick");
    assert!(
        said.contains(", in use, random-test-network by its hash\nbank b: hash unknown, not read\n"),
        "{said}"
    );
    assert!(!said.contains("display tables") && !said.contains("checksum"), "{said}");
    assert!(board(&place, "check --frames 1").ends_with("bit-exact on this board, at speed\n"));
}

#[test]
fn commands_that_change_the_board_print_what_they_did() {
    let place = Place::new();
    let _sim = Sim::start(&place, "");
    for (line, words) in [
        ("set control.colour 0", "control.colour is 0x0 (0), read back; before it was 0x1 (1)"),
        ("set scratch 0x1f", "scratch is 0x1f (31), read back; before it was 0x0 (0)"),
        ("set tile[3] 7", "tile[3]: 0x7 (7) was written; the board took it, and has no way to read it back"),
        ("skip off", "every stage multiplies all values, zeros too"),
        ("display luma", "pictures are encoded by luma alone"),
        ("flush", "the frame in progress was dropped; the next one runs"),
        ("picture off", "the source's frames are used again"),
    ] {
        assert_eq!(board(&place, line), format!("{words}\n"), "{line}");
    }
    assert!(board(&place, "reset").starts_with("the core was reset: bank a is in use as before"));
    let status = board(&place, "status --seconds 0.2");
    assert!(status.starts_with("memory: ready\ncalculator: runs at 100 MHz with bank a, busy "), "{status}");
    board(&place, "set control.run 0");
    let status = board(&place, "status --seconds 0.2");
    assert!(status.contains("calculator: STOPPED, the last picture is repeated"), "{status}");
    let run = place.edof("board reset --port board --design kc705").done();
    assert_eq!(run.err, "board: the board has the design tiny, not kc705: --design is ignored\n");
}

/// A load of all words that has begun, and what it prints behind its first words.
fn begun(place: &Place) -> (Child, impl Iterator<Item = String>) {
    let line = "board load new.fixed.safetensors --full --read-back --port board --progress json";
    let mut child = place.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("\"progress\":\"words\"") && !line.contains("\"total\":0")));
    (child, lines)
}

#[test]
fn a_load_that_breaks_off_says_what_the_board_does_now() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "");
    let now = "the load is not complete: the weights in use are still used, the other bank is half written";
    let (mut child, lines) = begun(&place);
    signal(&child, "-INT");
    let said: Vec<String> = lines.collect();
    assert!(
        said.iter().any(|line| line.contains(now)) && said.last().unwrap().contains("interrupted"),
        "{said:?}"
    );
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let (mut child, lines) = begun(&place);
    drop(sim);
    let said: Vec<String> = lines.collect();
    assert!(said.iter().any(|line| line.contains(now)), "{said:?}");
    assert!(said.last().unwrap().contains("board: the board went away"), "{said:?}");
    assert_eq!(child.wait().unwrap().code(), Some(1));
    // Its link is left behind, as it was killed.
    place.edof("board info --port board").refused(&["board: leads nowhere: the simulated board"]);
}

#[test]
fn a_port_without_an_answer_is_reported_with_every_speed_that_was_tried() {
    let place = Place::new();
    let sim = Sim::start(&place, "");
    signal(&sim.child, "-STOP");
    let run = place.edof("board find --port board --timeout 0.01");
    assert_eq!((run.code, run.out.as_str()), (Some(1), "board: no board answers\n"));
    assert!(
        run.err.starts_with("edof: board: no answer at 921600 or 2000000 bits per second: "),
        "{}",
        run.err
    );
    let named = place.edof("board info --port board --timeout 0.01 --baud 115200");
    named.refused(&["board: no answer at 115200 bits per second, asked 6 times"]);
}

pub fn wait(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(120), "{what} does not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Loads that are ended by a signal at random moments: what was in use stays, no frame is made of words of two networks, the next load succeeds.
fn hosts_are_killed(seed: u64, times: usize) {
    let place = Place::new();
    let names = ["one", "two"];
    names.iter().zip([3, 4]).for_each(|(name, seed)| drawn(&place, name, seed));
    let sim = Sim::start(&place, "--weights one.fixed.safetensors");
    let load = |name: &str| format!("load {name}.fixed.safetensors --full");
    let start = Instant::now();
    board(&place, &load("two"));
    let whole = start.elapsed();
    let (mut draw, mut in_use, mut ended) = (seed, 1, 0);
    for round in 0..times {
        // A linear congruence: the moment, and the signal.
        draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let (part, kill) = ((draw >> 33) % 1000, draw >> 20 & 1 == 1);
        let other = 1 - in_use;
        let line = format!("board {} --port board", load(names[other]));
        let mut host = place.command(&line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(whole * part as u32 / 1000);
        signal(&host, if kill { "-KILL" } else { "-INT" });
        let mut said = String::new();
        host.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        let status = host.wait().unwrap();
        let told =
            format!("seed {seed}, round {round}: killed {kill} after {part} of 1000: {status}, {said}");
        // Before it listens to signals a host ends as any program.
        let stopped = status.code() == Some(130) || status.signal() == Some(SIGINT);
        assert!(kill || status.success() || stopped, "{told}");
        ended += usize::from(!status.success());
        let holds = |index: usize| {
            let line = format!("board verify {}.fixed.safetensors --port board", names[index]);
            place.edof(&line).code == Some(0)
        };
        // Anybody who is killed after the last word has loaded.
        assert!(holds(in_use) || holds(other), "{told}: the bank in use holds neither");
        board(&place, &load(names[other]));
        assert!(holds(other), "{told}: the next load is not in use");
        in_use = other;
    }
    let carried = sim.end(&place);
    println!("seed {seed}: {times} hosts, {ended} ended by their signal, none lost");
    assert_eq!(carried["mixed_pictures"], 0);
    assert!(ended > 0, "every host was faster than its signal");
}

#[test]
fn hosts_that_are_killed_leave_what_was_in_use() {
    hosts_are_killed(1, 4);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_hundred_hosts_that_are_killed_leave_what_was_in_use() {
    hosts_are_killed(2, 100);
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// Runs a command of a board on a terminal, and presses Ctrl-C there once it has printed some words so often; what it printed.
fn on_a_terminal(place: &Place, (times, words): (usize, &str), line: &str) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/board_terminal.py");
    let mut python = Command::new("python3");
    python.current_dir(place.path("")).arg(script).arg(times.to_string()).arg(words);
    python.arg(env!("CARGO_BIN_EXE_edof")).args(format!("board {line} --port board").split(' '));
    let output = python.env("TERM", "xterm").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn ctrl_c_on_a_terminal_ends_a_watch_and_a_load() {
    let place = Place::new();
    drawn(&place, "old", 1);
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "--weights old.fixed.safetensors");
    // Each look clears the screen.
    let said = on_a_terminal(&place, (3, "\\x1b[2J"), "status --watch --seconds 0.1");
    assert!(said.contains("pictures per second") && said.contains("edof: interrupted"), "{said}");
    assert!(said.ends_with("pressed True, status 130\n"), "{said}");
    let said = on_a_terminal(&place, (2, "words"), "load new.fixed.safetensors --full --read-back");
    assert!(said.contains("edof: interrupted") && said.ends_with("pressed True, status 130\n"), "{said}");
    assert!(board(&place, "verify old.fixed.safetensors").contains("bank a holds"));
    board(&place, "load new.fixed.safetensors");
    drop(sim);
}

#[test]
fn a_simulated_board_has_the_clock_and_the_pace_of_its_design() {
    let place = Place::new();
    let mut design: Value = serde_json::from_str(include_str!("../designs/tiny.json")).unwrap();
    design["clock_mhz"] = 5.into();
    design["frame"] = serde_json::json!({ "width": 320, "height": 240, "stride": 4 });
    place.write("slow.json", design.to_string());
    let _sim = Sim::start(&place, "--design slow.json");
    let board = |line: &str| board(&place, &format!("{line} --design slow.json"));
    assert!(board("info").contains("calculator at 5 MHz"));
    // Some 5000 patches of 50 cycles or more. A board that other programs held up makes up for it in the next second.
    let is_at_pace = |report: &Value| {
        let (made, shown) = (number(report, "frames_per_second"), number(report, "screen_frames_per_second"));
        let busy = number(report, "busy_share");
        made > 0.0 && made < 25.0 && (shown - 60.0).abs() < 10.0 && busy > 0.5 && busy < 1.2
    };
    let mut reports = vec![];
    while reports.len() < 5 && !reports.last().is_some_and(is_at_pace) {
        let json: Value = serde_json::from_str(&board("status --seconds 1 --json")).unwrap();
        reports.push(json["report"].clone());
    }
    assert!(reports.last().is_some_and(is_at_pace), "{reports:?}");
}

#[test]
fn a_network_of_encoded_values_brings_the_tables_that_show_them() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let file = place.path("new.fixed.safetensors");
    let mut network = weight_file::load_fixed(&file).unwrap();
    network.origin.values = Tone::Srgb;
    weight_file::save_fixed(&file, &network).unwrap();
    let _sim = Sim::start(&place, "");
    let plan = |where_to: &str| {
        let text =
            place.edof(&format!("board load new.fixed.safetensors --dry-run --json {where_to}")).done().out;
        serde_json::from_str::<Value>(&text).unwrap()["tables"][0].as_u64()
    };
    assert_eq!((plan("--port board"), plan("--design tiny")), (Some(65_536), None), "words of the tables");
    let load = || place.edof("board load new.fixed.safetensors --port board").done().err;
    let told = "gives srgb values: the display's tables are now those of linear";
    let first = load();
    assert!(first.contains(told), "{first}");
    board(&place, "verify new.fixed.safetensors --curve linear");
    assert!(!load().contains(told), "they are there");
    assert_eq!(plan("--port board"), None);
    // Who names a curve gets it.
    let named = place.edof("board load new.fixed.safetensors --curve srgb --port board").done().err;
    assert!(!named.contains(told), "{named}");
    board(&place, "verify new.fixed.safetensors --curve srgb");
}

#[test]
fn what_a_load_takes_is_reported_ahead() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "");
    let line = "load new.fixed.safetensors --full";
    let text = place.edof(&format!("board {line} --dry-run --design tiny")).done().out;
    assert!(
        text.contains("if the display's tables change, as from linear to encoded values: 65536 words and "),
        "{text}"
    );
    let text = place.edof(&format!("board {line} --dry-run --design tiny --json")).done().out;
    let plan: Value = serde_json::from_str(&text).unwrap();
    board(&place, line);
    let carried = sim.end(&place);
    let (ahead, found) = (number(&plan["plan"], "seconds"), number(&carried, "line_seconds"));
    assert!((ahead / found - 1.0).abs() < 0.1, "{ahead} s were told, {found} s it took");
}

#[test]
fn what_cannot_be_loaded_is_reported_in_one_line() {
    let place = Place::new();
    place
        .edof("board info --port nowhere")
        .refused(&["nowhere: there is no such path; expected a serial port"]);
    place.write("file", "text");
    for (port, problem) in [("file", "is a file"), (".", "is a folder"), ("/dev/null", "is another device")] {
        let told = format!("{port}: {problem}; expected a serial port, as in /dev/ttyUSB0");
        place.edof(&format!("board info --port {port}")).refused(&[&told]);
    }
    place.pipe("pipe");
    place.edof_within_bounds("board info --port pipe").refused(&["pipe: is a pipe, a socket or a disk"]);
    place.edof("board sim --rtl --baud 100").refused(&["100 bits per second: must be 12208 to 25000000"]);
    place
        .edof("board load paper-t4 --design kc705 --port nowhere")
        .refused(&["paper-t4 does not fit design kc705"]);
    place.edof("board get contrl --port nowhere").refused(&["register 'contrl': there is none"]);
    place.edof("board set scratch many --port nowhere").refused(&["value 'many'"]);
    place.edof("board load paper-t4 --dry-run").refused(&["--dry-run: without --port it needs --design"]);
    let sim = Sim::start(&place, "");
    place.edof("board load paper-t4 --port board").refused(&[
        "paper-t4 does not fit design tiny",
        "none that comes with edof does; 'edof random-network --design tiny' makes one for tests",
    ]);
    drop(sim);
}

/// The values of the C header, as a C compiler has them.
fn header(place: &Place) -> String {
    place.write("registers.h", place.edof("board map --format c").done().out);
    let names = [
        "ID",
        "ID_VALUE",
        "SCRATCH",
        "PROTECTION",
        "PROTECTION_BANK_MASK",
        "WRITES_REFUSED",
        "WEIGHTS",
        "STAGE_READS",
    ]
    .map(|name| format!("EDOF_{name}"));
    let lines: Vec<String> =
        names.iter().map(|name| format!("printf(\"\\\"{name}\\\": %lu\", (unsigned long){name});")).collect();
    let body = lines.join("printf(\", \");\n");
    let text = format!(
        "#include <stdio.h>\n#include \"registers.h\"\nint main(void) {{ printf(\"{{\");\n{body}\nprintf(\"}}\"); return 0; }}\n"
    );
    place.write("values.c", text);
    let (source, program) = (place.path("values.c"), place.path("values"));
    let compiled = Command::new("cc").args(["-Wall", "-Werror", "-o"]).arg(&program).arg(&source).status();
    assert!(compiled.unwrap().success());
    String::from_utf8(Command::new(&program).output().unwrap().stdout).unwrap()
}

#[test]
fn a_client_of_another_language_reads_the_id_and_writes_a_row() {
    let place = Place::new();
    let values = header(&place);
    let sim = Sim::start(&place, "");
    let client = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/board_client.py");
    let mut python = Command::new("python3")
        .arg(client)
        .arg(place.path("board"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    python.stdin.take().unwrap().write_all(values.as_bytes()).unwrap();
    let output = python.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("id 45444f46, row 01234567 89abcdef"), "{said}");
    drop(sim);
}
