//! Pipes and devices: what a shell opens for the program is read and written, what nobody holds the other end of is rejected at once, and
//! a result that cannot be printed is a failure.

use crate::support::{Place, Run};
use std::process::Command;

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 96, 64);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place.write("camera.json", include_str!("../cameras/clear.json"));
    place.write("design.json", include_str!("../designs/tiny.json"));
    place.pipe("waiting");
    place.pipe("waiting.png");
    place
}

/// A line of bash with `edof` in place of the program, ended after a minute.
fn bash(place: &Place, line: &str) -> Run {
    let line = line.replace("edof ", &format!("timeout 60 {} ", env!("CARGO_BIN_EXE_edof")));
    let mut shell = Command::new("bash");
    shell.args(["-c", &line]).current_dir(place.path("")).env("EDOF_KODAK", "no-kodak-here");
    shell.output().unwrap().into()
}

#[test]
fn what_a_shell_pipes_in_is_read_as_a_file_is() {
    let place = ready();
    let network = "--weights net.fixed.safetensors";
    place.edof(&format!("reconstruct raw.png {network} --out usual.png")).done();
    let usual = std::fs::read(place.path("usual.png")).unwrap();
    for line in [
        format!("edof reconstruct <(cat raw.png) {network} --out o.png"),
        format!("cat raw.png | edof reconstruct /dev/stdin {network} --out o.png"),
        format!("edof reconstruct /dev/stdin {network} --out o.png < raw.png"),
        format!("cat raw.png | edof reconstruct /proc/self/fd/0 {network} --out o.png"),
        "edof reconstruct raw.png --weights <(cat net.fixed.safetensors) --out o.png".to_owned(),
        format!("edof reconstruct raw.png {network} --camera <(cat camera.json) --out o.png"),
    ] {
        bash(&place, &line).done();
        assert!(std::fs::read(place.path("o.png")).unwrap() == usual, "{line}");
    }
    for line in [
        "edof compare <(cat photo.png) <(cat photo.png)",
        "edof capture <(cat photo.png) --camera <(cat camera.json) --psi 1 --out frame.png",
        "edof estimate --design <(cat design.json)",
        "cat design.json | edof design check /dev/stdin",
        "edof weights <(cat net.safetensors)",
        "edof quantize <(cat net.safetensors) --out new.fixed.safetensors",
        "edof optics <(cat camera.json) --psi 0 --out figures",
    ] {
        bash(&place, line).done();
    }
    // Nothing at the other end is an empty file, and no end is too large.
    bash(&place, "edof compare photo.png <(true)").refused(&["/dev/fd/63"]);
    bash(&place, "edof weights <(cat photo.png)").refused(&["/dev/fd/63"]);
}

#[test]
fn results_go_through_pipes_that_a_shell_opened_and_through_no_other() {
    let place = ready();
    let run = bash(&place, "edof estimate --design tiny --json /dev/stdout --quiet | tail -1").done();
    assert!(run.out.ends_with("}\n"), "{}", run.out);
    bash(&place, "edof estimate --design tiny --json >(cat > told.json); sleep 0.5").done();
    assert!(std::fs::read_to_string(place.path("told.json")).unwrap().contains("provenance"));
    place.edof("estimate --design tiny --json /dev/null").done();
    // A file that a shell opened is continued, and what is printed besides stays.
    bash(&place, "echo before > all; edof estimate --design tiny --json /dev/stdout >> all; edof estimate --design tiny --json /dev/fd/1 > one").done();
    for (file, before) in [("all", "before\n"), ("one", "")] {
        let text = std::fs::read_to_string(place.path(file)).unwrap();
        let (printed, json) = text.split_once("\n{\n").unwrap_or_else(|| panic!("{file}: {text}"));
        assert!(
            printed.starts_with(before) && printed.contains("cycles") && json.ends_with("}\n"),
            "{file}: {text}"
        );
        std::fs::remove_file(place.path(file)).unwrap();
    }
    std::fs::remove_file(place.path("told.json")).unwrap();
    let before = place.snapshot();
    for (line, file) in [
        ("estimate --design tiny --json waiting", "waiting"),
        ("doctor --json waiting", "waiting"),
        ("compare photo.png photo.png --map waiting.png", "waiting.png"),
        ("capture photo.png --psi 1 --out waiting.png", "waiting.png"),
        ("capture photo.png --psi 1 --out o.png --sharp waiting.png", "waiting.png"),
        ("capture photo.png --psi 1 --out o.png --video waiting", "waiting"),
        ("reconstruct raw.png --weights net.fixed.safetensors --out waiting.png", "waiting.png"),
        ("quantize net.safetensors --out waiting", "waiting"),
        ("design new --weights paper-t4 --out waiting", "waiting"),
        ("random-network --out waiting", "waiting"),
        ("cosim --design tiny --random 1 --junit waiting", "waiting"),
        ("study multi-depth --report waiting", "waiting"),
        ("board map --json waiting", "waiting"),
    ] {
        let run = place.edof_within_bounds(line);
        assert!(place.snapshot() == before, "{line}");
        run.refused(&[&format!("{file}: cannot write: a named pipe, expected a regular file")]);
    }
}

#[test]
fn text_that_cannot_be_printed_is_a_failure() {
    let place = ready();
    for line in [
        "--help",
        "-h",
        "--version",
        "capture --help",
        "help board",
        "weights paper-t4",
        "board map",
        "doctor",
    ] {
        let run = bash(&place, &format!("edof {line} > /dev/full"));
        assert_eq!(run.code, Some(1), "{line}: {}", run.err);
        assert_eq!(run.err.lines().count(), 1, "{line}: {}", run.err);
        assert!(run.err.contains("standard output: cannot write: No space left"), "{line}: {}", run.err);
        // A reader that goes away is none.
        bash(&place, &format!("set -o pipefail; edof {line} | head -c 1 > /dev/null")).done();
    }
}

#[test]
fn a_folder_of_somebodys_files_is_rejected_before_sources_are_made() {
    let place = Place::new();
    let generate = "generate --design paper --weights paper-t4 --out out";
    std::fs::create_dir(place.path("out")).unwrap();
    place.write("out/notes.txt", "mine");
    // The network is not looked for yet.
    let foreign = ["--out out: holds what no earlier run wrote", "notes.txt", "--force"];
    place.edof_within_bounds(&generate.replace("paper-t4", "nothere")).refused(&foreign);
    place.edof_within_bounds(generate).refused(&foreign);
    assert_eq!(std::fs::read_dir(place.path("out")).unwrap().count(), 1);
    std::fs::remove_file(place.path("out/notes.txt")).unwrap();
    for shell in ["mig", "litex"] {
        // Files that are as they would be written, without their list, as an interrupted run leaves them.
        let line = format!("{generate}-{shell} --shell {shell}");
        place.edof(&line).done();
        std::fs::remove_file(place.path(&format!("out-{shell}/manifest.json"))).unwrap();
        place.edof(&line).done();
    }
}
