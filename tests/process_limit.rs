//! Limits of the shell. Of processes (`ulimit -u`): fewer threads, or an error that names the limit; never a panic. Of the stack (`ulimit -s`): no matter.

use crate::support::{Place, Run};
use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

/// What the remark and the errors name.
const LIMIT: &str = "the limit of processes and threads is reached (ulimit -u, or that of a container)";

/// Users without a name, one for each run: the limit counts all processes of a user.
static NEXT_USER: AtomicU32 = AtomicU32::new(0);

/// Runs `edof` with at most N processes and threads. The limit does not bind root, who becomes another user for it; for all others
/// their own processes count, so that the limit is reached from the start.
fn limited(place: &Place, processes: u32, line: &str) -> Run {
    let is_root = Command::new("id").arg("-u").output().unwrap().stdout == b"0\n";
    let edof = env!("CARGO_BIN_EXE_edof");
    let limit = format!("ulimit -u {processes}; exec \"$0\" \"$@\"");
    let mut command = Command::new(if is_root { "setpriv" } else { "sh" });
    if is_root {
        let user =
            100_000 + std::process::id() % 10_000 * 64 + NEXT_USER.fetch_add(1, Ordering::Relaxed) % 64;
        let [user, group] = [format!("--reuid={user}"), format!("--regid={user}")];
        command.args([&user, &group, "--clear-groups", "prlimit", &format!("--nproc={processes}"), edof]);
    } else {
        command.args(["-c", &limit, edof]);
    }
    command.args(line.split_whitespace()).current_dir(place.path("."));
    command.env("RAYON_NUM_THREADS", "4").env("XDG_CACHE_HOME", place.path("cache"));
    command.env("EDOF_KODAK", "no-kodak-here").env("EDOF_MORE", "").output().unwrap().into()
}

/// A folder in which any user may write.
fn open() -> Place {
    let place = Place::new();
    std::fs::set_permissions(place.path("."), std::fs::Permissions::from_mode(0o777)).unwrap();
    place.photo("photo.png", 96, 80);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.raw("raw.png", 64, 48);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place
}

/// Times differ.
fn without_numbers(text: &str) -> String {
    text.chars().filter(|c| !(c.is_ascii_digit() || *c == '.')).collect()
}

/// What a run wrote, which is then taken away.
fn written(place: &Place) -> BTreeMap<PathBuf, Vec<u8>> {
    let snapshot = |name: &str| std::fs::read(place.path(name)).ok().map(|bytes| (name.into(), bytes));
    let files =
        ["out.png", "out.fixed.safetensors", "out.safetensors"].into_iter().filter_map(snapshot).collect();
    for name in ["out.png", "out.png.json", "out.fixed.safetensors", "out.safetensors"] {
        let _ = std::fs::remove_file(place.path(name));
    }
    let _ = std::fs::remove_dir_all(place.path("out"));
    files
}

#[test]
fn results_are_the_same_with_fewer_threads_and_without_any() {
    let place = open();
    for line in [
        "reconstruct raw.png --weights net.fixed.safetensors --out out.png",
        "reconstruct raw.png --float --weights net.safetensors --out out.png",
        "capture photo.png --psi 3 --noise 0.01 --out out.png",
        "optics ring-outer --psi 4 --out out",
        "quantize net.safetensors --out out.fixed.safetensors",
        "train --camera clear --form two-sided,w8,t2,c8 --images photos --depths 1 --steps 4 --batch 64 --validate-every 2 \
         --threads 2 --out out.safetensors",
        "estimate --design tiny",
        "generate --design paper --weights paper-t4 --out out",
        "compare photo.png photo.png",
    ] {
        let free = place.edof(line).done();
        let all = written(&place);
        for processes in [1, 2, 4] {
            let run = limited(&place, processes, line).done();
            assert_eq!(run.err.matches(LIMIT).count(), 1, "{line}, {processes} processes: {}", run.err);
            assert_eq!(without_numbers(&run.out), without_numbers(&free.out), "{line}");
            assert!(written(&place) == all, "{line}, {processes} processes");
        }
    }
}

#[test]
fn results_are_the_same_with_a_small_stack() {
    let place = open();
    for line in [
        "--help",
        "design check tiny",
        "reconstruct raw.png --weights net.fixed.safetensors --out out.png",
        "capture photo.png --psi 3 --noise 0.01 --out out.png",
    ] {
        let free = place.edof(line).done();
        let all = written(&place);
        let limit = ["-c", "ulimit -s 128; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_edof")];
        let mut command = Command::new("sh");
        command.args(limit).args(line.split_whitespace()).current_dir(place.path("."));
        let run = Run::from(command.output().unwrap()).done();
        assert_eq!(without_numbers(&run.out), without_numbers(&free.out), "{line}");
        assert!(written(&place) == all, "{line}");
    }
}

#[test]
fn programs_that_cannot_be_started_are_named_with_the_limit() {
    let place = open();
    for line in [
        "cosim --design tiny --random 1",
        "timing --design tiny",
        "capture photo.png --psi 3 --out raw-2.png",
        "doctor",
        "explore --weights paper-t4 --photo photo.png --psi 4 --fps 20",
        "study kodak --nets net.safetensors --images photos --psi 0 --noise 0 --json rows.json",
    ] {
        let run = limited(&place, 1, line);
        let first = run.err.lines().next().unwrap_or_default();
        assert!(first.contains(LIMIT) && !run.err.contains("panicked"), "{line}: {:?} {}", run.code, run.err);
        assert!(matches!(run.code, Some(0 | 1)), "{line}: {:?} {}", run.code, run.err);
    }
    let run = limited(&place, 1, "cosim --design tiny --random 1");
    let last = run.err.lines().last().unwrap_or_default();
    assert!(
        run.code == Some(1) && last.contains(": cannot start: ") && last.contains(LIMIT),
        "{:?} {}",
        run.code,
        run.err
    );
}
