//! Wrong inputs that users tried on a second walk: designs, cameras, networks, ports, outputs and options. Each row is a command and what its
//! one line must contain; nothing is written.

use crate::support::Place;

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 288, 256);
    place.photo("odd.png", 65, 49);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/kodim03.png", 288, 256);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place.write("camera.json", include_str!("../cameras/clear.json"));
    place.write("design.json", include_str!("../designs/tiny.json"));
    place.write("broken.json", include_str!("../designs/tiny.json").replace("100.0", "0.0"));
    place
}

type Row = (&'static str, &'static [&'static str]);

/// A value of a design that cannot be: the text in its place, and what the line must contain.
const DESIGNS: &[(&str, &str, &str)] = &[
    ("100.0", "-5", "clock_mhz -5: must be above 0, at most 400"),
    ("100.0", "1e9", "clock_mhz 1000000000: must be above 0"),
    ("100.0", "\"fast\"", "not a design: the text \"fast\", expected a number"),
    ("100.0", "null", "not a design: null, expected a number"),
    ("\"window\": 8", "\"window\": 9", "window 9: must be 8, 12 or 16"),
    ("\"codes\": 16", "\"codes\": 0", "codes 0: must be 1 to 1024"),
    ("\"codes\": 16", "\"codes\": -1", "-1, expected a whole number of 0 or more"),
    ("\"layers\": 4", "\"layers\": 99", "layers 99: must be 2 to 10"),
    ("\"one-sided\"", "\"soft\"", "expected one of `two-sided`, `one-sided`, `firm`"),
    ("\"direct\"", "\"x\"", "expected `direct` or `difference`"),
    ("\"tied\": false", "\"tied\": \"yes\"", "the text \"yes\", expected true or false"),
    ("\"code_bits\": 16", "\"code_bits\": 7", "code_bits 7: must be 8 to 16"),
    ("\"accumulator_bits\": 48", "\"accumulator_bits\": 64", "accumulator_bits 64: must be 32 to 48"),
    ("\"skip_zeros\": true", "\"skip_zeros\": 1", "1, expected true or false"),
    ("\"lanes\": 16", "\"lanes\": 3", "stages[0].lanes 3: must be a multiple of 4 that divides 16"),
    ("\"rows\": 1", "\"rows\": 77", "stages[1].rows 77: must be 1 or 2"),
    ("\"width\": 64", "\"width\": 63", "frame 63x48: both sides must be even"),
    ("\"width\": 64", "\"width\": 0", "frame 0x48: both sides must be at least 10 pixels"),
    (
        "\"width\": 64",
        "\"width\": 1099511627776",
        "frame 1099511627776x48: must be at most 16384 pixels a side",
    ),
    ("\"stride\": 8", "\"stride\": 3", "stride 3: must be 2, 4 or 8"),
    ("\"stride\": 8", "\"stride\": 8.5", "8.5, expected a whole number"),
    ("\"tiny\"", "\"\"", "name empty: must be 1 to 64 letters"),
    ("\"tiny\"", "\"a/b\"", "name 'a/b': must be 1 to 64 letters"),
    ("\"code_bits\": 16,", "\"code_bits\": 16, \"extra\": 1,", "unknown field `extra`"),
    ("\"code_bits\": 16,", "", "missing field `code_bits`"),
];

#[test]
fn a_design_that_cannot_be_is_rejected_with_its_file_and_field() {
    let place = ready();
    for (from, to, says) in DESIGNS {
        let text = include_str!("../designs/tiny.json");
        assert!(text.contains(from), "{from}");
        place.write("design.json", text.replacen(from, to, 1));
        place.edof("design check design.json").refused(&["design.json: ", says]);
    }
}

/// A value of a camera that cannot be: the text in its place, and what the line must contain.
const CAMERAS: &[(&str, &str, &str)] = &[
    ("16.0", "0", "focal_length_mm is 0, expected 0.01 to 100000 mm"),
    ("16.0", "[16]", "a list, expected a number"),
    ("3.0", "-1", "pixel_pitch_um is -1, expected 0.01 to 1000 um"),
    ("[\n    0.0,\n    8.0\n  ]", "[8, 0]", "psi_range is [8, 0], expected two numbers"),
    ("[\n    0.0,\n    8.0\n  ]", "[0]", "a list of 1, expected a list of 2"),
    ("\"clear\"", "\"\"", "name is empty, expected 1 to 64 characters on one line"),
    ("\"clear\"", "5", "5, expected a text"),
    ("\"rings\": []", "\"rings\": {}", "an object, expected a list"),
    ("\"rings\": []", "\"rings\": [{}]", "missing field `inner`"),
    ("\"focus_psi\": 0.0", "\"focus_psi\": 1e99", "focus_psi is 1e99, expected at most 10000 either way"),
    ("\"rings\": []", "\"rings\": [], \"nominal_m\": -1", "nominal_m is -1, expected a distance"),
    ("\"rings\": []", "\"rings\": [], \"nominal_m\": \"far\"", "the text \"far\", expected a number"),
];

#[test]
fn a_camera_that_cannot_be_is_rejected_with_its_file_and_field() {
    let place = ready();
    for (from, to, says) in CAMERAS {
        let text = include_str!("../cameras/clear.json");
        assert!(text.contains(from), "{from}");
        place.write("camera.json", text.replacen(from, to, 1));
        let line = "capture photo.png --psi 1 --camera camera.json --out o.png";
        place.edof(line).refused(&["camera.json: ", says]);
    }
}

const CAPTURE: &str = "capture photo.png --psi 1 --out o.png";

const ROWS: &[Row] = &[
    ("board info --design broken.json", &["broken.json: clock_mhz 0: must be above 0, at most 400"]),
    ("board map --design broken.json", &["broken.json: clock_mhz 0"]),
    ("board load nothere --dry-run --design tiny", &["weights 'nothere': no such file"]),
    ("board info --port /dev/null", &["/dev/null: is another device; expected a serial port"]),
    ("board info --port photos", &["photos: is a folder; expected a serial port"]),
    ("board info --timeout nan", &["--timeout NaN: must be above 0, at most 3600"]),
    ("board set scratch -1 --port nothere", &["value '-1': must be a number of 32 bits"]),
    ("board set scratch 0x1ffffffff --port nothere", &["value '0x1ffffffff': must be a number of 32 bits"]),
    ("board sim --design tiny --size 7x7", &["--size 7x7: both sides must be even"]),
    ("board sim --design tiny --link nothere/x", &["nothere/x: No such file or directory"]),
    ("board sim --design tiny --frame photo.png", &["photo.png: holds 8-bit samples, expected 16-bit ones"]),
    ("board sim --design tiny --weights paper-t4", &["network paper-t4 does not fit design tiny"]),
    ("cosim --design tiny --random 0", &["--random 0: must be 1 or more, or nothing is compared"]),
    ("cosim --design tiny --patches 0", &["--patches 0: must be 1 or more, or nothing is compared"]),
    ("cosim --design tiny --system --size 7x7", &["--size 7x7: both sides must be even"]),
    ("cosim --design tiny --rtl photos", &["--rtl photos: has no chain.v; expected the folder rtl"]),
    ("design new --form edof-t4w12 --clock-mhz -1 --out n.json", &["edof: --clock-mhz -1: must be above 0"]),
    ("design new --form edof-t4w12 --size 1x1 --out n.json", &["edof: --size 1x1: both sides must be even"]),
    ("design check camera.json", &["camera.json: not a design: unknown field `focal_length_mm`"]),
    ("design check photo.png", &["photo.png: cannot read: not text"]),
    ("quantize net.safetensors --bits 3 --out o", &["edof: --bits 3: must be 8 to 16"]),
    ("quantize net.safetensors --photos 1 --out o", &["--photos 1: has an effect only with --images"]),
    ("quantize net.fixed.safetensors --out o", &["holds a fixed network, expected a float one"]),
    ("reconstruct raw.png --bits 12 --out o.png", &["edof: --bits 12: must be 8 or 16"]),
    ("reconstruct raw.png --video --out o.png", &["raw.png: --video has no header; state its size"]),
    ("reconstruct raw.png raw.png --out o.png", &["--out o.png: 2 frames need a folder"]),
    ("reconstruct raw.png --white-level 0 --out o.png", &["--white-level 0: must be more than 0"]),
    (
        "capture photo.png --depth-map raw.png --range 8:0 --layers 100000 --out o.png",
        &["raw.png: 48x32, expected 288x256"],
    ),
    (
        "capture raw.png --depth-map raw.png --range 8:0 --layers 100000 --out o.png",
        &["--layers 100000: must be 1 to 64"],
    ),
    (
        "capture raw.png --depth-map raw.png --range 8:0 --layers 0 --out o.png",
        &["--layers 0: must be 1 to 64"],
    ),
    ("scene chart --size 63x64 --out o", &["edof: --size 63x64: both sides must be even"]),
    (
        "demo --clear-net edof-t4w12-outer --out o",
        &["--clear-net edof-t4w12-outer: trained for the camera ring-outer, which has a mask"],
    ),
    (
        "study multi-depth --clear-net paper-t4",
        &["--clear-net paper-t4: trained for the camera ring-2018, which has a mask"],
    ),
    ("study multi-depth --width 100000 --height 100000", &["needs about", "are free"]),
    ("study bits --allowed nan", &["--allowed NaN: must be 0 or more"]),
    ("study design --weights paper-t4 --fps nan", &["--fps NaN: must be more than 0"]),
    ("study aperture --window 7", &["--window 7: must be 8, 12 or 16"]),
    ("study aperture --electrons 0", &["--electrons 0: must be from 1 to"]),
    ("study aperture --mean-light 2", &["--mean-light 2: must be from 0 to 1"]),
    ("study kodak --nets paper-t4,paper-t4 --images photos", &["net 'paper-t4': given twice"]),
    (
        "study kodak --nets paper-t4 --images photos --psi 500",
        &["--psi 500: must lie within 200 of the focus"],
    ),
    ("explore --weights paper-t4 --fps 0", &["--fps 0: must be more than 0"]),
    (
        "train --form edof-t4w12 --camera clear --images photos --out o --seed 1,1",
        &["--seed: 1 is given twice"],
    ),
    (
        "train --from paper-t4 --form edof-t4w12 --camera clear --images photos --out o",
        &["--from paper-t4: its form is two-sided,w8,t4,c192", "leave --form out"],
    ),
];

#[test]
fn what_cannot_be_is_rejected_in_one_line_that_names_it_once() {
    let place = ready();
    let before = place.snapshot();
    let mut wrongly = vec![];
    for (line, words) in ROWS {
        let run = place.edof_within_bounds(line);
        let is_told = run.err.lines().count() == 1 && words.iter().all(|word| run.err.contains(word));
        if run.code != Some(1) || !is_told || !run.out.is_empty() || place.snapshot() != before {
            wrongly.push(format!("{line}: {:?} {}{}", run.code, run.out, run.err));
        }
    }
    assert!(wrongly.is_empty(), "{}", wrongly.join("\n"));
    // The same with values that are right.
    place.edof(&format!("{CAPTURE} --camera camera.json")).done();
    place.edof("design check design.json").done();
}
