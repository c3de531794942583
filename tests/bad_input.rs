//! Everything that a user can get wrong: one clear line, a non-zero exit status, no panic, no file left.

use crate::support;
use crate::support::{Place, forge};

const RECONSTRUCT: &str = "reconstruct raw.png --weights net.safetensors --out out.png";

/// A place with a good raw frame and a good fixed network.
fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.fixed_network("net.safetensors");
    place
}

#[track_caller]
fn refused_without_a_trace(place: &Place, line: &str, words: &[&str]) {
    let before = place.files();
    place.edof(line).refused(words);
    assert_eq!(place.files(), before);
}

#[test]
fn an_image_too_small_for_a_window() {
    let place = ready();
    place.raw("raw.png", 8, 32);
    for phase in ["rggb", "grbg", "gbrg", "bggr"] {
        refused_without_a_trace(
            &place,
            &format!("{RECONSTRUCT} --phase {phase}"),
            &["raw.png", "frame 8x32", "at least 10 pixels", "window of 8"],
        );
    }
}

#[test]
fn an_image_of_odd_size() {
    let place = ready();
    place.write("raw.pgm", "P2 3 2 65535 1 2 3 4 5 6");
    let line = "reconstruct raw.pgm --weights net.safetensors --out out.png";
    refused_without_a_trace(&place, line, &["raw.pgm", "frame 3x2", "both sides must be even"]);
}

#[test]
fn a_wrong_bit_depth() {
    let place = ready();
    let line = |more: &str| format!("{RECONSTRUCT} {more}");
    refused_without_a_trace(&place, &line("--bit-depth 7"), &["raw.png", "bit depth 7", "must be 8 to 16"]);
    refused_without_a_trace(
        &place,
        &line("--bit-depth 10"),
        &["raw.png", "no 10-bit code aligned to the top"],
    );
    refused_without_a_trace(
        &place,
        &line("--bit-depth 12 --align bottom"),
        &["raw.png", "more than 12 bits can hold"],
    );
    place.photo("raw.png", 48, 32);
    refused_without_a_trace(&place, RECONSTRUCT, &["raw.png", "holds 8-bit samples, expected 16-bit"]);
}

#[test]
fn a_colour_picture_in_place_of_a_raw_frame() {
    let place = ready();
    place.photo("raw.png", 48, 32);
    refused_without_a_trace(&place, &format!("{RECONSTRUCT} --bit-depth 8"), &["raw.png", "colour picture"]);
}

#[test]
fn a_wrong_colour_filter_phase() {
    let place = ready();
    let run = place.edof(&format!("{RECONSTRUCT} --phase rgbg"));
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("CFA phase 'rgbg': must be rggb, grbg, gbrg or bggr"), "{}", run.err);
    assert_eq!(place.files(), ["net.safetensors", "raw.png"]);
}

#[test]
fn a_headerless_file_without_or_of_another_size() {
    let place = ready();
    place.write("raw.bin", [0; 2 * 48 * 32]);
    let line = |more: &str| format!("reconstruct raw.bin --weights net.safetensors --out out.png {more}");
    refused_without_a_trace(&place, &line(""), &["raw.bin", "state its size as WIDTHxHEIGHT"]);
    refused_without_a_trace(
        &place,
        &line("--size 64x32"),
        &["raw.bin", "3072 bytes, expected 4096 for 64x32"],
    );
}

#[test]
fn a_truncated_weight_file() {
    let place = ready();
    let whole = std::fs::read(place.path("net.safetensors")).unwrap();
    for kept in [0, 7, 300, whole.len() - 1] {
        place.write("net.safetensors", &whole[..kept]);
        refused_without_a_trace(&place, RECONSTRUCT, &["net.safetensors", "not a whole safetensors file"]);
    }
}

#[test]
fn a_foreign_weight_file() {
    let place = ready();
    let none: Vec<(&str, safetensors::tensor::TensorView<'_>)> = vec![];
    place.write("net.safetensors", safetensors::serialize(none, None).unwrap());
    refused_without_a_trace(&place, RECONSTRUCT, &["net.safetensors", "not an edof weight file"]);
    place.photo("net.safetensors.png", 8, 8);
    let line = "reconstruct raw.png --weights net.safetensors.png --out out.png";
    refused_without_a_trace(&place, line, &["net.safetensors.png", "not a whole safetensors file"]);
}

#[test]
fn a_float_network_where_a_fixed_one_belongs_and_the_other_way_round() {
    let place = ready();
    place.float_network("float.safetensors");
    let line = "reconstruct raw.png --weights float.safetensors --out out.png";
    refused_without_a_trace(&place, line, &["holds a float network, expected a fixed one"]);
    refused_without_a_trace(
        &place,
        &format!("{RECONSTRUCT} --float"),
        &["holds a fixed network, expected a float one"],
    );
}

#[test]
fn a_network_of_no_such_name() {
    let place = ready();
    let line = "reconstruct raw.png --weights edof-t99 --out out.png";
    refused_without_a_trace(&place, line, &["weights 'edof-t99'", "no such file"]);
}

#[test]
fn a_network_whose_window_does_not_fit_its_matrices() {
    let place = ready();
    forge(&place.path("net.safetensors"), |text, _| {
        *text = text.replace("\"window\":8", "\"window\":12");
    });
    refused_without_a_trace(
        &place,
        RECONSTRUCT,
        &["net.safetensors", "analysis: 4x64, this form needs 4x144"],
    );
}

#[test]
fn a_network_whose_fraction_bits_no_sum_can_hold() {
    let place = ready();
    forge(&place.path("net.safetensors"), |text, _| {
        *text = text.replace("\"analysis\":14", "\"analysis\":4294967290");
        assert!(text.contains("4294967290"), "{text}");
    });
    refused_without_a_trace(
        &place,
        RECONSTRUCT,
        &["net.safetensors", "4294967290 fraction bits, must be 0 to 48"],
    );
}

#[test]
fn a_network_of_a_window_that_does_not_exist() {
    let place = ready();
    forge(&place.path("net.safetensors"), |text, _| *text = text.replace("\"window\":8", "\"window\":9"));
    refused_without_a_trace(&place, RECONSTRUCT, &["net.safetensors", "window 9: must be 8, 12 or 16"]);
}

#[test]
fn a_network_whose_mask_is_not_the_cameras() {
    let place = ready();
    refused_without_a_trace(
        &place,
        &format!("{RECONSTRUCT} --camera ring-2018"),
        &["net.safetensors", "trained for the camera clear", "lens or mask", "ring-2018"],
    );
    place.edof(&format!("{RECONSTRUCT} --camera clear")).done();
}

#[test]
fn a_stride_that_a_fixed_network_is_not_made_for() {
    let place = ready();
    let line = |stride: u32| format!("{RECONSTRUCT} --stride {stride}");
    refused_without_a_trace(&place, &line(4), &["--stride 4", "quantized for a stride of 8"]);
    refused_without_a_trace(&place, &line(3), &["stride 3: must be 2, 4 or 8"]);
}

#[test]
fn the_boards_picture_of_a_float_network_or_in_16_bits() {
    let place = ready();
    for more in ["--board --float", "--board --bits 16", "--words w --float", "--display luma --float"] {
        let run = place.edof(&format!("{RECONSTRUCT} {more}"));
        assert_eq!(run.code, Some(2), "{more}");
        assert!(run.err.contains("cannot be used with"), "{}", run.err);
    }
    let run = place.edof(&format!("{RECONSTRUCT} --board --display grey"));
    assert!(run.err.contains("display 'grey': must be luma or colour"), "{}", run.err);
    assert_eq!(place.files(), ["net.safetensors", "raw.png"]);
}

#[test]
fn words_where_no_folder_can_be() {
    let place = ready();
    let line = format!("{RECONSTRUCT} --words raw.png");
    refused_without_a_trace(&place, &line, &["raw.png/words.npz: cannot write"]);
}

#[test]
fn random_network_rejects_invalid_options() {
    let place = Place::new();
    let line = |more: &str| format!("random-network --out net.safetensors {more}");
    refused_without_a_trace(&place, &line("--bits 7"), &["--bits 7: must be 8 to 16"]);
    refused_without_a_trace(&place, &line("--stride 3"), &["stride 3: must be 2, 4 or 8"]);
    refused_without_a_trace(
        &place,
        &line("--kind natural --bits 12"),
        &["--kind natural", "of --bits 16 only", "of --bits 12"],
    );
}

#[test]
fn nan_in_weights() {
    let place = ready();
    place.float_network("net.safetensors");
    forge(&place.path("net.safetensors"), |_, tensors| {
        let (_, _, bytes) = tensors.iter_mut().find(|(name, ..)| name == "linear_path").unwrap();
        bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
    refused_without_a_trace(
        &place,
        &format!("{RECONSTRUCT} --float"),
        &["net.safetensors", "linear_path: holds NaN, every weight must be a finite number"],
    );
}

#[test]
fn weights_changed_after_the_file_was_made() {
    let place = ready();
    let mut bytes = std::fs::read(place.path("net.safetensors")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    place.write("net.safetensors", bytes);
    refused_without_a_trace(&place, RECONSTRUCT, &["net.safetensors", "SHA-256"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let place = ready();
    let binary = env!("CARGO_BIN_EXE_edof");
    let before = place.files();
    // No file may grow at all. The signal that comes with it, if nobody ignores it, ends a program that does not expect it.
    for ignored in ["trap '' XFSZ;", ""] {
        let script = format!("{ignored} ulimit -f 0; exec {binary} {RECONSTRUCT}");
        let mut shell = std::process::Command::new("sh");
        let run: support::Run =
            shell.args(["-c", &script]).current_dir(place.path("")).output().unwrap().into();
        assert!(!run.err.contains(".partial"), "{}", run.err);
        run.refused(&["out.png: cannot write: File too large; the shell (ulimit -f)"]);
        assert_eq!(place.files(), before, "{ignored}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device() {
    let place = ready();
    let run = place.edof(&format!("{RECONSTRUCT} --json /dev/full"));
    assert_eq!(run.code, Some(1));
    assert_eq!(
        run.err,
        "edof: /dev/full: cannot write: No space left on device; make room there, or name another place\n"
    );
}

#[test]
fn an_unwritable_folder() {
    let place = ready();
    let line = "reconstruct raw.png --weights net.safetensors --out raw.png/out.png";
    refused_without_a_trace(&place, line, &["raw.png/out.png: cannot write"]);
    let line = "reconstruct raw.png --weights net.safetensors --out /proc/such/folder/out.png";
    refused_without_a_trace(&place, line, &["/proc/such/folder/out.png: cannot write"]);
}

#[test]
fn an_ending_that_stands_for_no_format() {
    let place = ready();
    let line = "reconstruct raw.png --weights net.safetensors --out out.jpeg";
    refused_without_a_trace(&place, line, &["out.jpeg: unknown ending, expected .png"]);
    // Before the work: nothing is read yet.
    for (line, words) in [
        ("reconstruct none.png --out out.jpeg", "out.jpeg: unknown ending, expected .png"),
        ("capture none.png --psi 1 --out raw.jpeg", "raw.jpeg: unknown ending, expected .png"),
        ("capture none.png --psi 1 --out raw.pgm --sharp x.gif", "x.gif: unknown ending, expected .png"),
        ("capture none.png --psi 1 --out raw.pgm --light x", "x: unknown ending, expected .png"),
    ] {
        refused_without_a_trace(&place, line, &[words]);
    }
}

#[test]
fn an_argument_that_slipped_behind_json() {
    let place = ready();
    let line = "reconstruct --weights net.safetensors --out out.png raw.png --json raw.png";
    refused_without_a_trace(&place, line, &["--json raw.png", "would replace raw.png"]);
}

const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --depths 1 --steps 4 --batch 64 \
                     --validate-every 2 --out net.safetensors";

#[test]
fn an_empty_training_folder() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    refused_without_a_trace(&place, TRAIN, &["photos: contains no photographs", ".png"]);
}

#[test]
fn no_training_folder_at_all() {
    refused_without_a_trace(&Place::new(), TRAIN, &["photos: cannot list"]);
}

#[test]
fn a_training_folder_without_a_readable_photograph() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.write("photos/a.png", "no picture");
    refused_without_a_trace(
        &place,
        TRAIN,
        &["photos: 1 photograph, none of which can be read", "a.png: not a PNG"],
    );
}

#[test]
fn a_training_photo_that_is_too_small() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 16, 16);
    refused_without_a_trace(&place, TRAIN, &["16x16", "at least"]);
}

#[test]
fn unreadable_photographs_among_good_ones_are_named_skipped_and_counted() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.write("photos/b.png", "no picture");
    place.write("photos/c.ppm", "P6 40 40 255\nhalf");
    let run = place.edof(TRAIN).done();
    assert!(run.err.contains("skipped photos/b.png: not a PNG"), "{}", run.err);
    assert!(run.err.contains("skipped photos/c.ppm: damaged"), "{}", run.err);
    assert!(run.err.contains("2 of 3 photographs skipped"), "{}", run.err);
    assert_eq!(place.files(), ["net.safetensors", "photos"]);
}

#[test]
fn a_network_that_cannot_be_written_is_not_trained_first() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    let line = TRAIN.replace("--out net", "--out photos/a.png/net").replace("--steps 4", "--steps 100000000");
    refused_without_a_trace(&place, &line, &["photos/a.png/net.safetensors: cannot write"]);
}

#[test]
fn a_pipe_among_photographs_or_beside_a_frame_is_waited_for_by_nobody() {
    let place = ready();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.pipe("photos/p03.png");
    place.edof_within_bounds(&TRAIN.replace("--out net", "--out new")).refused(&[
        "1 photograph, none of which can be read",
        "photos/p03.png: cannot read: a named pipe, expected a regular file",
    ]);
    place
        .edof_within_bounds("study kodak --nets edof-t4w12 --images photos --psi 0")
        .refused(&["photos", "p03.png: cannot read: a named pipe"]);
    place.pipe("raw.png.json");
    place.edof_within_bounds(RECONSTRUCT).refused(&["raw.png.json: cannot read: a named pipe"]);
    std::fs::create_dir(place.path("cases")).unwrap();
    place.pipe("cases/a.json");
    place.edof_within_bounds("study stability --cases cases").refused(&["cases"]);
}

#[test]
fn a_checkpoint_of_another_run() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.write("net.safetensors.checkpoint", "no checkpoint");
    refused_without_a_trace(&place, TRAIN, &["net.safetensors.checkpoint", "--resume"]);
    refused_without_a_trace(&place, &format!("{TRAIN} --resume"), &["net.safetensors.checkpoint"]);
}

#[test]
fn an_unknown_camera() {
    let place = Place::new();
    let line = TRAIN.replace("--camera clear", "--camera ring-1999");
    refused_without_a_trace(&place, &line, &["camera 'ring-1999'", "ring-2018"]);
}

#[test]
fn numbers_that_would_do_nothing_or_anything() {
    let place = ready();
    place.photo("photo.png", 64, 48);
    refused_without_a_trace(
        &place,
        "capture photo.png --psi 4 --out frame.png --wavelength-tolerance 1e99",
        &["--wavelength-tolerance", "must be 0 to 1"],
    );
    refused_without_a_trace(
        &place,
        "optics design --generations 0 --out camera.json",
        &["generations is 0", "expected 1 to 100000"],
    );
    refused_without_a_trace(
        &place,
        "quantize paper-t4 --images . --finetune 5 --finetune-rate nan --out out.safetensors",
        &["--finetune-rate NaN", "must be a positive number"],
    );
}
