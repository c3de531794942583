//! Numbers that no machine or lens can serve are rejected in one line, before any work.

use crate::support;
use crate::support::Place;

#[test]
fn jobs_that_no_machine_can_hold() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    let before = place.files();
    let train = "train --form edof-t4w12 --camera clear --images photos --out x.safetensors";
    for (line, words) in [
        ("scene leaves --size 60000x60000".to_owned(), ["scene 60000x60000: needs about", "are free"]),
        ("capture chart --size 60000x60000 --out r.png".to_owned(), ["scene 60000x60000", "are free"]),
        ("demo --height 60000 --width 60000".to_owned(), ["scene 60000x60000", "are free"]),
        (
            "cosim --design tiny --random 1000000000000000".to_owned(),
            ["--random 1000000000000000", "are free"],
        ),
        (format!("{train} --batch 1000000000"), ["--batch 1000000000", "are free"]),
        (format!("{train} --depths 18446744073709551615"), ["--depths 18446744073709551615", "1 to 1000"]),
    ] {
        place.edof(&line).refused(&words);
        assert_eq!(place.files(), before, "{line}");
    }
}

#[test]
fn minutes_that_are_no_time() {
    let place = Place::new();
    for minutes in ["nan", "inf", "-1", "0"] {
        let line =
            format!("train --form edof-t4w12 --camera clear --images photos --out x --minutes={minutes}");
        let run = place.edof(&line);
        assert_eq!(run.code, Some(2), "{minutes}: {}", run.err);
        assert!(run.err.contains("expected a number of minutes above 0"), "{}", run.err);
    }
}

#[test]
fn lenses_that_no_grid_can_hold() {
    let place = Place::new();
    for (field, value) in [("aperture_radius_mm", "2.3"), ("pixel_pitch_um", "3.0")] {
        let good = include_str!("../cameras/ring-outer.json");
        let bad = good.replace(&format!("\"{field}\": {value}"), &format!("\"{field}\": 1e9"));
        assert_ne!(good, bad);
        place.write("bad.json", bad);
        place.edof("optics bad.json").refused(&["camera ring-outer", field, "1000000000"]);
        place.edof("capture chart --camera bad.json --out r.png").refused(&[field]);
        assert_eq!(place.files(), ["bad.json"]);
    }
}

#[test]
fn files_without_an_end() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let net = "--weights net.safetensors --out out.png";
    place.edof(&format!("reconstruct /dev/zero {net}")).refused(&["/dev/zero: cannot read: a device"]);
    place
        .edof(&format!("reconstruct /dev/zero --size 64x32 {net}"))
        .refused(&["/dev/zero: cannot read: a device"]);
    place.edof("capture /dev/zero --psi 1 --out raw.png").refused(&["/dev/zero: cannot read: a device"]);
    place.edof("optics /dev/zero").refused(&["/dev/zero"]);
    assert_eq!(place.files(), ["net.safetensors"]);
}

#[test]
fn a_size_for_a_photograph() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let line = "capture photo.png --psi 1 --size 32x32 --out raw.png";
    place.edof(line).refused(&["--size 32x32", "a photograph has its own"]);
    assert_eq!(place.files(), ["photo.png"]);
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_a_name() {
    use std::os::unix::ffi::OsStrExt;
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.fixed_network("net.safetensors");
    let name = std::ffi::OsStr::from_bytes(b"r\xffw.png");
    std::fs::rename(place.path("raw.png"), place.path("").join(name)).unwrap();
    let mut command = place.command("reconstruct --weights net.safetensors --out out.png --json");
    let run: support::Run = command.arg("-").arg("--").arg(name).output().unwrap().into();
    assert!(run.done().out.contains("\"width\": 48"));
    assert!(place.path("out.png").is_file());
}
