//! What stands in the place of a file and is of another kind: named pipes, folders and devices that are given to be read, files of other
//! programs that are given to be replaced, and cameras that nobody could build.

use crate::support::Place;

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 288, 256);
    for folder in ["photos", "folder", "cases"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("photos/kodim03.png", 288, 256);
    place.fixed_network("net.fixed.safetensors");
    place.float_network("net.safetensors");
    place.write("camera.json", include_str!("../cameras/clear.json"));
    place.write("design.json", include_str!("../designs/tiny.json"));
    place.write("notes.md", "# Notes\n\nBuy milk.\n");
    place.write("page.html", "<!DOCTYPE html><title>mine</title>");
    place.write("letter.txt", "Dear reader,\nall is well.\n");
    place.write("paper.pdf", "%PDF-1.7 and so on");
    place.pipe("waiting");
    place.pipe("lines.json");
    place.pipe("waiting.dng");
    place.pipe("waiting.raw");
    place.pipe("cases/waiting.json");
    let _socket = std::os::unix::net::UnixListener::bind(place.path("socket")).unwrap();
    place
}

/// A command and what its one line must hold.
type Row = (&'static str, &'static [&'static str]);

fn check(place: &Place, rows: &[Row]) {
    let before = place.snapshot();
    let mut wrongly = vec![];
    for (line, words) in rows {
        let run = place.edof_within_bounds(line);
        let is_told = run.err.lines().count() == 1 && words.iter().all(|word| run.err.contains(word));
        let changed = place.snapshot() != before;
        if run.code != Some(1) || !is_told || !run.out.is_empty() || changed {
            let told = run.out + &run.err;
            wrongly.push(format!("{line}: status {:?}, changed: {changed}, {told}", run.code));
        }
    }
    assert!(wrongly.is_empty(), "{}", wrongly.join("\n"));
}

const PIPE: &str = "a named pipe, expected a regular file; save its content to a file";

/// What is given in place of a file that is read.
const READ: &[Row] = &[
    ("compare waiting photo.png", &["waiting: cannot read", PIPE]),
    ("compare photo.png waiting", &["waiting: cannot read", PIPE]),
    ("compare socket photo.png", &["socket: cannot read: a socket, expected a regular file"]),
    (
        "compare folder photo.png",
        &["folder: cannot read: a folder, expected a regular file; name a file in it"],
    ),
    ("compare /dev/zero photo.png", &["/dev/zero: cannot read: a device, expected a regular file"]),
    ("capture waiting --psi 1 --out o.png", &["waiting: cannot read", PIPE]),
    ("capture lines.json --out o.png", &["lines.json: cannot read", PIPE]),
    ("capture photo.png --psi 1 --camera waiting --out o.png", &["waiting: cannot read", PIPE]),
    ("capture photo.png --psi 1 --psf-bank waiting --out o.png", &["waiting: cannot read", PIPE]),
    ("capture photo.png --depth-map waiting --range 8:0 --out o.png", &["waiting: cannot read", PIPE]),
    ("reconstruct waiting --out o.png", &["waiting: cannot read", PIPE]),
    ("reconstruct waiting.raw --size 48x32 --out o.png", &["waiting.raw: cannot read", PIPE]),
    ("reconstruct waiting.dng --out o.png", &["waiting.dng: cannot read", PIPE]),
    ("reconstruct raw.png --weights waiting --out o.png", &["waiting: cannot read", PIPE]),
    ("reconstruct raw.png --weights folder --out o.png", &["weights 'folder': is a folder"]),
    ("reconstruct raw.png --weights /dev/null --out o.png", &["/dev/null: cannot read: a device"]),
    ("optics waiting --out o", &["waiting: cannot read", PIPE]),
    ("optics folder --out o", &["folder: cannot read: a folder"]),
    ("estimate --design waiting", &["waiting: cannot read", PIPE]),
    ("estimate --design folder", &["folder: cannot read: a folder, expected a regular file"]),
    ("estimate --design paper --weights waiting", &["waiting: cannot read", PIPE]),
    ("design check lines.json", &["lines.json: cannot read", PIPE]),
    ("weights waiting", &["waiting: cannot read", PIPE]),
    ("quantize waiting --out o", &["waiting: cannot read", PIPE]),
    (
        "train --from waiting --images photos --photos all --camera clear --out o",
        &["waiting: cannot read", PIPE],
    ),
    ("study multi-depth --dictionary waiting", &["waiting: cannot read", PIPE]),
    ("study merge waiting --out o", &["waiting: cannot read", PIPE]),
    ("study stability --cases cases", &["cases/waiting.json: cannot read", PIPE]),
    (
        "study single-depth --rows waiting --camera clear-mid --images photos --nets edof-t4w12-clear",
        &["waiting: cannot write: a named pipe, expected a regular file"],
    ),
    ("generate --design paper --weights waiting --out o", &["waiting: cannot read", PIPE]),
    ("board load waiting --dry-run --design tiny", &["waiting: cannot read", PIPE]),
    ("board sim --frame waiting", &["waiting: cannot read", PIPE]),
];

#[test]
fn whatever_is_no_file_is_named_before_anybody_waits_for_it() {
    check(&ready(), READ);
}

/// What is given in place of a file that is written.
const WRITTEN: &[Row] = &[
    (
        "doctor --json photo.png",
        &[
            "--json photo.png: would replace a PNG picture, and writes a JSON result of edof; name another file",
        ],
    ),
    ("doctor --json camera.json", &["--json camera.json: would replace other JSON"]),
    ("doctor --json letter.txt", &["--json letter.txt: would replace text"]),
    ("doctor --json net.safetensors", &["--json net.safetensors: would replace a safetensors file"]),
    ("doctor --json paper.pdf", &["--json paper.pdf: would replace a PDF document"]),
    ("estimate --design tiny --json photo.png", &["--json photo.png: would replace a PNG picture"]),
    ("weights paper-t4 --json page.html", &["--json page.html: would replace an HTML page"]),
    ("design check tiny --json design.json", &["--json design.json: would replace other JSON"]),
    ("compare raw.png raw.png --json photo.png", &["--json photo.png: would replace a PNG picture"]),
    ("compare photo.png photo.png --map notes.md", &["notes.md: unknown ending"]),
    (
        "design new --weights paper-t4 --out camera.json",
        &["--out camera.json: would replace other JSON, and writes a design"],
    ),
    ("design new --weights paper-t4 --out photo.png", &["--out photo.png: would replace a PNG picture"]),
    (
        "random-network --out photo.png",
        &["--out photo.png: would replace a PNG picture, and writes a safetensors file"],
    ),
    (
        "random-network --out letter.txt",
        &["--out letter.txt: would replace text, and writes a safetensors file"],
    ),
    (
        "study single-depth --rows o --camera clear-mid --images photos --nets edof-t4w12-clear --report photo.png",
        &["--report photo.png: would replace a PNG picture, and writes an HTML report"],
    ),
    (
        "study single-depth --rows o --camera clear-mid --images photos --nets edof-t4w12-clear --markdown notes.md",
        &["--markdown notes.md: would replace text, and writes a page of edof in Markdown"],
    ),
    (
        "study single-depth --rows o --camera clear-mid --images photos --nets edof-t4w12-clear --csv letter.txt",
        &["--csv letter.txt: would replace text"],
    ),
    (
        "study single-depth --rows o --camera clear-mid --images photos --nets edof-t4w12-clear --plot photo.png",
        &["--plot photo.png: would replace a PNG picture, and writes an SVG plot"],
    ),
    (
        "study single-depth --rows letter.txt --camera clear-mid --images photos --nets edof-t4w12-clear",
        &["letter.txt"],
    ),
    (
        "study kodak --nets net.safetensors --images photos --report photo.png",
        &["--report photo.png: is there already, a PNG picture and not an HTML report", "--force"],
    ),
    ("explore --weights paper-t4,", &["--weights: an empty name"]),
    (
        "study dictionary --images photos --photos all --out photo.png",
        &["--out photo.png: is there already, a PNG picture and not a safetensors file"],
    ),
    (
        "quantize paper-t4 --out photo.png",
        &["--out photo.png: is there already, a PNG picture and not a safetensors file"],
    ),
    ("board info --design tiny --json photo.png", &["--json photo.png: would replace a PNG picture"]),
    ("board map --json letter.txt", &["--json letter.txt: would replace text"]),
    ("capture photo.png --psi 1 --out o.png --video letter.txt", &["letter.txt"]),
    ("generate --design paper --weights paper-t4 --out /", &["--out /: is the root of the file system"]),
    (
        "generate --design paper --weights paper-t4 --out folder/../../../../../../../..",
        &["is the root of the file system"],
    ),
    (
        "generate --design paper --weights paper-t4 --out waiting",
        &["--out waiting: is a file, expected a folder"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all --out o --non-zeros none --budget-rate 0.1",
        &["--budget-rate: has no effect, since --non-zeros none"],
    ),
];

#[test]
fn what_is_of_another_kind_is_not_replaced() {
    check(&ready(), WRITTEN);
}

#[test]
fn a_result_replaces_the_result_of_an_earlier_run() {
    let place = Place::new();
    for line in [
        "doctor --json told.json",
        "estimate --design tiny --json told.json",
        "design new --weights paper-t4 --out mine.json",
        "random-network --design tiny --out net",
        "scene chart --size 64x64 --psi 1 --out drawn",
        "board map --json told.json",
    ] {
        place.edof(line).done();
        place.edof(line).done();
    }
    assert_eq!(place.files(), ["drawn", "mine.json", "net", "told.json"]);
}

/// Fields of a camera, values that nobody could build, and what is legal.
const CAMERAS: &[(&str, &str, &str)] = &[
    (
        "\"focal_length_mm\": 16.0",
        "\"focal_length_mm\": 1e-300",
        "focal_length_mm is 1e-300, expected 0.01 to 100000 mm",
    ),
    (
        "\"focal_length_mm\": 16.0",
        "\"focal_length_mm\": 1e300",
        "focal_length_mm is 1e300, expected 0.01 to 100000 mm",
    ),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": 5e-324", "focal_length_mm is 5e-324, expected 0.01"),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": 0", "focal_length_mm is 0, expected 0.01"),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": NaN", "no JSON value (texts need quotes; NaN"),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": \"NaN\"", "the text \"NaN\", expected a number"),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": 1e400", "number out of range"),
    ("\"focal_length_mm\": 16.0", "\"focal_length_mm\": null", "null, expected a number"),
    (
        "\"focal_length_mm\": 16.0",
        "\"focal_length_mm\": 16, \"focal_length_mm\": 17",
        "duplicate field `focal_length_mm`",
    ),
    (
        "\"aperture_radius_mm\": 2.3",
        "\"aperture_radius_mm\": 1e-300",
        "aperture_radius_mm is 1e-300, expected 0.001 to 50000 mm",
    ),
    (
        "\"aperture_radius_mm\": 2.3",
        "\"aperture_radius_mm\": 1e300",
        "aperture_radius_mm is 1e300, expected 0.001 to 50000 mm",
    ),
    (
        "\"aperture_radius_mm\": 2.3",
        "\"aperture_radius_mm\": 40000",
        "aperture_radius_mm is 40000, expected at most the focal length",
    ),
    (
        "\"pixel_pitch_um\": 3.0",
        "\"pixel_pitch_um\": 1e-300",
        "pixel_pitch_um is 1e-300, expected 0.01 to 1000 um",
    ),
    (
        "\"pixel_pitch_um\": 3.0",
        "\"pixel_pitch_um\": 1e300",
        "pixel_pitch_um is 1e300, expected 0.01 to 1000 um",
    ),
    (
        "\"reference_wavelength_nm\": 460.0",
        "\"reference_wavelength_nm\": 1e-300",
        "reference_wavelength_nm is 1e-300, expected a wavelength of 100 to 30000 nm",
    ),
    (
        "\"reference_wavelength_nm\": 460.0",
        "\"reference_wavelength_nm\": 1e300",
        "reference_wavelength_nm is 1e300",
    ),
    ("610.0,", "1e-300,", "spectra is 1e-300, expected a wavelength of 100 to 30000 nm"),
    ("610.0,", "1e300,", "spectra is 1e300, expected"),
    ("610.0,", "[[600, 1e300], [620, 1]],", "weights 0 to 1e9"),
    ("610.0,", "[[600, 5e-324], [620, 0]],", "one of them 1e-9 or more"),
    (
        "\"rings\": []",
        "\"rings\": [], \"nominal_m\": 1e-300",
        "nominal_m is 1e-300, expected a distance of 0.0001 to 1e9 m",
    ),
    ("\"rings\": []", "\"rings\": [], \"nominal_m\": 1e300", "nominal_m is 1e300, expected a distance of"),
    (
        "\"rings\": []",
        "\"rings\": [{\"inner\": 0, \"outer\": 1, \"delay\": {\"phase\": {\"rad\": 1e300, \"at_nm\": 500}}}]",
        "expected at most 10000 rad either way",
    ),
    (
        "\"rings\": []",
        "\"rings\": [{\"inner\": 0, \"outer\": 1, \"delay\": {\"phase\": {\"rad\": 1, \"at_nm\": 1e-300}}}]",
        "at 100 to 30000 nm",
    ),
    (
        "\"rings\": []",
        "\"rings\": [{\"inner\": 0, \"outer\": 1, \"delay\": {\"etched\": {\"height_um\": 1e300, \"cauchy\": [1.4, 0]}}}]",
        "expected at most 100 um either way",
    ),
    (
        "\"rings\": []",
        "\"rings\": [{\"inner\": 0, \"outer\": 1, \"delay\": {\"etched\": {\"height_um\": 1, \"cauchy\": [1e300, 0]}}}]",
        "in glass of [0.1 to 10",
    ),
    (
        "\"rings\": []",
        "\"rings\": [], \"profile\": {\"at_nm\": 500, \"points\": [[0, 1e300], [1, 0]]}",
        "at most 10000 rad",
    ),
    (
        "\"rings\": []",
        "\"rings\": [], \"profile\": {\"at_nm\": 1e-300, \"points\": [[0, 1], [1, 0]]}",
        "at 100 to 30000 nm",
    ),
    (
        "\"rings\": []",
        "\"rings\": [], \"height_map\": {\"file\": \"raw.png\", \"white_um\": 1e-300, \"cauchy\": [1.4, 0]}",
        "0.0001 to 100 um",
    ),
    (
        "\"rings\": []",
        "\"rings\": [], \"height_map\": {\"file\": \"raw.png\", \"white_um\": 1, \"cauchy\": [-1e300, 0]}",
        "in glass of [0.1 to 10",
    ),
];

#[test]
fn a_camera_that_nobody_could_build_is_rejected_with_the_range_of_its_field() {
    let place = ready();
    let clear = include_str!("../cameras/clear.json");
    for (from, to, told) in CAMERAS {
        let changed = clear.replacen(from, to, 1);
        assert_ne!(changed, clear, "{from}");
        place.write("strange.json", changed);
        let run = place.edof_within_bounds("capture photo.png --psi 1 --camera strange.json --out o.png");
        assert_eq!(run.code, Some(1), "{to}: {}", run.err);
        assert!(run.err.contains("strange.json: ") && run.err.contains(told), "{to}: {}", run.err);
        assert!(run.err.lines().count() == 1 && run.out.is_empty(), "{to}: {}{}", run.out, run.err);
    }
}
