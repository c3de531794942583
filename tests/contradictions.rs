//! Options that contradict a frame's record: rejected, or accepted with a note under --force.

use crate::support::Place;

#[test]
fn options_that_contradict_a_frames_record_are_rejected_or_told() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place
        .edof("capture photo.png --camera ring-2018 --psi 0 --no-measure --black-level 16 --out raw.png")
        .done();
    let line = "reconstruct raw.png --weights edof-t4w12 --out out.png";
    let before = place.snapshot();
    for (option, says) in [
        ("--camera ring-outer", "ring-2018 (they differ in "),
        ("--phase bggr", "rggb"),
        ("--bit-depth 14", "12"),
        ("--align bottom", "top"),
        ("--tone linear", "srgb"),
        ("--black-level 64", "16"),
        ("--white-level 4000", "4096"),
        ("--gain 8", "none"),
    ] {
        let message = format!("{option}: raw.png.json says {says}");
        let name = option.split_once(' ').unwrap().0;
        place.edof(&format!("{line} {option}")).refused(&[&message, &format!("leave {name} out"), "--force"]);
        assert!(place.snapshot() == before, "{option}");
    }
    let run = place.edof(&format!("{line} --tone linear --phase bggr --force")).done();
    assert!(run.err.contains("--tone linear: taken, though raw.png.json says srgb"), "{}", run.err);
    assert!(run.err.contains("--phase bggr: taken, though raw.png.json says rggb"), "{}", run.err);
    let run = place.edof(&format!("{line} --camera ring-outer --force")).done();
    assert!(run.err.contains("--camera ring-outer: taken, though"), "{}", run.err);
    assert!(
        run.err.contains("trained for the camera ring-2018, but raw.png was taken by ring-outer"),
        "{}",
        run.err
    );
    // What agrees may be stated.
    place.edof(&format!("{line} --camera ring-2018 --phase rggb --tone srgb --bit-depth 12")).done();
}

#[test]
fn a_stated_gain_chooses_the_network_where_no_record_states_the_noise() {
    let place = Place::new();
    place.raw("raw.png", 64, 48);
    let line = "reconstruct raw.png --out out.png";
    for (options, network) in [
        ("", "edof-t4w12-clear-light.fixed"),
        ("--gain 2", "edof-t4w12-clear-light-low.fixed"),
        ("--gain 8", "edof-t4w12-clear-light-high.fixed"),
        ("--gain 8 --weights edof-t4w12-outer-light", "edof-t4w12-outer-light-high.fixed"),
    ] {
        let run = place.edof(&format!("{line} {options}")).done();
        assert!(run.out.contains(&format!("by {network} in ")), "{options}: {}", run.out);
    }
    place.fixed_network("net.fixed.safetensors");
    place.edof(&format!("{line} --gain 8 --weights net.fixed.safetensors")).refused(&[
        "--gain 8: chooses among the networks of the program, and --weights net.fixed.safetensors is a file",
    ]);
    place.edof(&format!("{line} --gain 1001")).refused(&["--gain 1001: must be from 0.001 to 1000"]);
    // A record states the noise: what agrees may be stated, rounded.
    place.photo("photo.png", 64, 48);
    let noise = "sensor:full-well=6000:gain=4";
    place.edof(&format!("capture photo.png --psi 2 --no-measure --noise {noise} --out raw.png")).done();
    place.edof(&format!("{line} --gain 6.67")).done();
    place
        .edof(&format!("{line} --gain 4"))
        .refused(&["--gain 4: raw.png.json says sensor:full-well=6000:gain=4"]);
    let run = place.edof(&format!("{line} --gain 3 --force")).done();
    assert!(
        run.err.contains("--gain 3: taken, though raw.png.json says") && run.out.contains("-low.fixed"),
        "{}",
        run.out
    );
}

#[test]
fn a_frame_through_measured_psfs_asks_for_a_network_of_those() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    place.edof("optics ring-outer --psi 0,4,8 --out shown").done();
    let capture = "capture photo.png --camera ring-outer --psi 4 --no-measure --out raw.png";
    place.edof(&format!("{capture} --psf-bank shown/psf.npz")).done();
    let line = "reconstruct raw.png --weights edof-t4w12-outer --out out.png";
    let taken = "raw.png was taken by ring-outer with the PSFs of psf.npz";
    place.edof(line).refused(&[
        "trained for the camera ring-outer, but",
        taken,
        "they differ in psf_bank",
        "edof train --camera ring-outer --psf-bank psf.npz",
    ]);
    place
        .edof(&format!("{line} --camera ring-outer"))
        .refused(&["--camera ring-outer: raw.png.json says ring-outer with the PSFs of psf.npz (they differ in psf_bank)"]);
    place.edof(&format!("{line} --camera ring-outer --psf-bank shown/psf.npz")).refused(&[taken]);
    place.edof(&format!("{line} --force")).done();
    // And the other way round.
    place.edof(capture).done();
    place
        .edof(&format!("{line} --camera ring-outer --psf-bank shown/psf.npz"))
        .refused(&["--camera ring-outer with the PSFs of psf.npz: raw.png.json says ring-outer (they differ in psf_bank)"]);
}
