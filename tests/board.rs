//! `edof board` and a simulated board behind a pseudo-terminal; and a client of the same protocol in Python.

#![cfg(target_os = "linux")]

use crate::support::Place;
use serde_json::Value;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A simulated board in a place, at the link `board`.
struct Sim {
    child: Child,
}

impl Sim {
    fn start(place: &Place, more: &str) -> Self {
        let line = format!("board sim --design tiny --link board --json board.json {more}");
        let child = place.command(&line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut sim = Self { child };
        let start = Instant::now();
        while !place.path("board").exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "no pseudo-terminal");
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
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        self.child.wait().unwrap();
        serde_json::from_slice(&std::fs::read(place.path("board.json")).unwrap()).unwrap()
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

fn drawn(place: &Place, name: &str, seed: u64) {
    let line =
        format!("random-network --form one-sided,w8,t4,c16,r --seed {seed} --out {name}.fixed.safetensors");
    place.edof(&line).done();
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap()
}

#[test]
fn weights_go_onto_a_simulated_board_and_its_picture_changes_to_theirs() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "--picture out.yuyv");
    assert!(board(&place, "info").contains("design tiny"));
    board(&place, "set scratch 0x1f");
    assert_eq!(board(&place, "get scratch"), "0x0000001f 31\n");
    let said = board(&place, "load new.fixed.safetensors");
    assert!(said.contains("in bank b") && said.contains("bank b is in use"), "{said}");
    assert!(board(&place, "verify new.fixed.safetensors").contains("every CRC right"));
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
    drop(sim);
}

#[test]
fn what_a_load_takes_is_told_ahead() {
    let place = Place::new();
    drawn(&place, "new", 9);
    let sim = Sim::start(&place, "");
    let line = "load new.fixed.safetensors --full";
    let text = place.edof(&format!("board {line} --dry-run --design tiny --json")).done().out;
    let plan: Value = serde_json::from_str(&text).unwrap();
    board(&place, line);
    let carried = sim.end(&place);
    let (ahead, found) = (number(&plan["plan"], "seconds"), number(&carried, "line_seconds"));
    assert!((ahead / found - 1.0).abs() < 0.1, "{ahead} s were told, {found} s it took");
}

#[test]
fn what_cannot_be_loaded_is_told_in_one_line() {
    let place = Place::new();
    place.edof("board info --port nowhere").refused(&["nowhere", "No such file"]);
    place
        .edof("board load paper-t4 --design kc705 --port nowhere")
        .refused(&["paper-t4 does not fit design kc705"]);
    place.edof("board get contrl --port nowhere").refused(&["register 'contrl': there is none"]);
    place.edof("board set scratch many --port nowhere").refused(&["value 'many'"]);
    place.edof("board load paper-t4 --dry-run").refused(&["--dry-run: without --port it needs --design"]);
    let sim = Sim::start(&place, "");
    place.edof("board load paper-t4 --port board").refused(&["paper-t4 does not fit design tiny"]);
    drop(sim);
}

/// The values of the C header, as a C compiler has them.
fn header(place: &Place) -> String {
    place.write("registers.h", place.edof("board map --format c").done().out);
    let names = ["ID", "ID_VALUE", "SCRATCH", "WEIGHTS", "STAGE_READS"].map(|name| format!("EDOF_{name}"));
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
