//! What a failure says: the file that the user named, the option as it was given, the limit that was passed, and what to do; nothing of
//! Rust. One row is a command and what its one line must hold.

use crate::support::{Place, forge};
use std::io::Write;

/// A camera file of the name `clear`, changed.
fn camera(from: &str, to: &str) -> String {
    let text = include_str!("../cameras/clear.json");
    let changed = text.replacen(from, to, 1);
    assert_ne!(text, changed, "{from}");
    changed
}

/// The smallest design, changed.
fn design(from: &str, to: &str) -> String {
    let text = include_str!("../designs/tiny.json");
    let changed = text.replacen(from, to, 1);
    assert_ne!(text, changed, "{from}");
    changed
}

/// An array as NumPy writes it.
fn npy(descriptor: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descriptor}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A PNG that says of itself that it is so large, of no data.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        let step = |crc: u32, byte: &u8| {
            (0..8).fold(
                crc ^ u32::from(*byte),
                |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
            )
        };
        !bytes.iter().fold(!0, step)
    };
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [&kind[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 2, 0, 0, 0]].concat();
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunk(b"IHDR", &header), chunk(b"IDAT", &[0x78, 0x9c, 3, 0, 0, 0, 0, 1])]
        .concat()
}

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.raw("small-raw.png", 8, 8);
    place.photo("photo.png", 288, 256);
    place.photo("small.png", 8, 8);
    place.photo("dot.png", 1, 1);
    place.photo("frame.png", 48, 32);
    for folder in ["photos", "one", "unnumbered", "tiny-photos", "gt", "broken"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("photos/p03.png", 288, 256);
    place.photo("unnumbered/holiday.png", 288, 256);
    place.photo("tiny-photos/p01.png", 288, 256);
    place.photo("tiny-photos/p02.png", 40, 40);
    place.write("broken/a.png", "no picture");
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    cameras(&place);
    designs(&place);
    banks(&place);
    place.write("bomb.png", png_of(60_000, 60_000));
    place.write("scene-depth.json", r#"{"layers": [{"picture": "photo.png", "depth": [1]}]}"#);
    place.write("scene-size.json", r#"{"layers": [{"picture": "photo.png", "depth": 1, "size": 3}]}"#);
    place.write("scene-none.json", r#"{"layers": []}"#);
    place.write("long.json", " ".repeat((1 << 20) + 1) + "{}");
    place.write("latin.json", b"{\"name\": \"caf\xe9\"}");
    place.write("said.png", std::fs::read(place.path("raw.png")).unwrap());
    place.write("said.png.json", r#"{"phase": "rgbg"}"#);
    std::fs::copy(place.path("net.fixed.safetensors"), place.path("kinds.fixed.safetensors")).unwrap();
    forge(&place.path("kinds.fixed.safetensors"), |text, _| {
        *text = text.replace("\"code_bits\":16", "\"code_bits\":{}");
    });
    place
}

fn cameras(place: &Place) {
    place.write("f01.json", camera("\"focal_length_mm\": 16.0", "\"focal_length_mm\": -16.0"));
    place.write("line.json", camera("610.0,", "0.0,"));
    place.write("pairs.json", camera("610.0,", "[[610, 1], [600, 1]],"));
    place.write("spectrum.json", camera("610.0,", "\"red\","));
    place.write("ring.json", camera("\"rings\": []", RINGS));
    place.write("pitch.json", camera("\"pixel_pitch_um\": 3.0", "\"pixel_pitch_um\": 1e300"));
    place.write("kind.json", camera("\"psi_range\": [\n    0.0,\n    8.0\n  ]", "\"psi_range\": {}"));
    place.write("bank.json", camera("\"rings\"", "\"psf_bank\": { \"file\": \"nothere.npz\" }, \"rings\""));
    place.write("mask.json", camera("\"rings\"", MASK));
    place.write("far.json", camera("8.0\n", "1e308\n"));
    place.write("field.json", camera("\"focus_psi\"", "\"focus\""));
    place.write("text.json", camera("\"focal_length_mm\": 16.0", "\"focal_length_mm\": \"16\""));
}

/// The picture of a mask that is not there.
const MASK: &str =
    r#""height_map": { "file": "nothere.png", "white_um": 1.2, "cauchy": [1.4, 0.003] }, "rings""#;

/// A ring of a wavelength that is none.
const RINGS: &str =
    r#""rings": [{ "inner": 0.2, "outer": 0.5, "delay": { "phase": { "rad": 6.8, "at_nm": 0 } } }]"#;

fn designs(place: &Place) {
    place.write("mine.json", include_str!("../designs/tiny.json"));
    place.write(
        "d-video.json",
        design("\"width\": 64", "\"width\": 1366").replacen("\"height\": 48", "\"height\": 768", 1),
    );
    place.write("d-clock.json", design("\"clock_mhz\": 100.0", "\"clock_mhz\": 1e99"));
    place.write("d-codes.json", design("\"codes\": 16", "\"codes\": 17"));
    place.write("d-stages.json", design("\"layers\": 4", "\"layers\": 5"));
    place.write("d-kind.json", design("\"codes\": 16", "\"codes\": \"16\""));
    place.write("d-frame.json", design("\"width\": 64", "\"width\": 63"));
    place.write("d-unknown.json", design("\"name\"", "\"title\": 1, \"name\""));
}

fn banks(place: &Place) {
    let psi = npy("<f8", "(2,)", &doubles(&[0.0, 4.0]));
    let flat = npy("<f8", "(2, 3, 3)", &doubles(&[1.0; 18]));
    let store = |name: &str, entries: &[(&str, &[u8])]| {
        let mut bytes = std::io::Cursor::new(vec![]);
        let mut archive = zip::ZipWriter::new(&mut bytes);
        for (name, content) in entries {
            let options =
                zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            archive.start_file(*name, options).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap();
        place.write(name, bytes.into_inner());
    };
    store("flat.npz", &[("psi.npy", &psi), ("psf.npy", &flat)]);
    store("twice.npz", &[("psi.npy", &psi), ("psi", &psi), ("psf.npy", &flat)]);
    store("bell.npz", &[("psi\u{7}.npy", &psi)]);
    store(
        "falling.npz",
        &[
            ("psi.npy", &npy("<f8", "(2,)", &doubles(&[4.0, 0.0]))),
            ("psf.npy", &npy("<f8", "(2, 3, 3, 3)", &doubles(&[1.0; 54]))),
        ],
    );
    store("cut.npz", &[("psi.npy", &npy("<f8", "(3,)", &doubles(&[4.0, 0.0])))]);
    place.write("lens.npy", &psi);
    place.write("my-psf.npy", &flat);
    let header = br#"{"psi":{"dtype":"F64","shape":[1],"data_offsets":[0,8]},"psi":{"dtype":"F64","shape":[1],"data_offsets":[0,8]}}"#;
    place.write("twice.safetensors", [&(header.len() as u64).to_le_bytes()[..], header, &[0; 8]].concat());
    let header = br#"{"psi":{"dtype":"F64","shape":[{}],"data_offsets":[0,8]}}"#;
    place.write("kind.safetensors", [&(header.len() as u64).to_le_bytes()[..], header, &[0; 8]].concat());
}

const CAPTURE: &str = "capture photo.png --no-measure --out o.png";
const RECONSTRUCT: &str = "reconstruct raw.png --weights net.fixed.safetensors --out o.png";
const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all --out o";
const DESIGN: &str = "optics design --out o.json --generations 1 --population 4 --window 8";

/// A command, options after it, and what its line must hold.
type Row = (&'static str, &'static str, &'static [&'static str]);

/// Files: the one that was named, not what it calls itself.
const FILES: &[Row] = &[
    ("optics", "f01.json", &["f01.json: camera clear", "focal_length_mm is -16", "a positive number"]),
    (
        "optics",
        "line.json",
        &["line.json: camera clear: spectra is 0, expected a wavelength in nm, or ascending"],
    ),
    (
        "optics",
        "pairs.json",
        &["pairs.json: camera clear: spectra is [[610, 1], [600, 1]], expected a wavelength"],
    ),
    (
        "optics",
        "spectrum.json",
        &["spectrum.json: not a camera: a spectrum is a wavelength in nm, or a list of [nm, weight] pairs"],
    ),
    (
        "optics",
        "ring.json",
        &["ring.json: camera clear: rings is a phase of 6.8 rad at 0 nm, expected finite numbers"],
    ),
    ("optics", "pitch.json", &["pitch.json: camera clear: pixel_pitch_um is 1e300, expected"]),
    ("optics", "kind.json", &["kind.json: not a camera: an object, expected a list of 2, at line "]),
    ("optics", "field.json", &["field.json: not a camera: unknown field `focus`", "`focus_psi`"]),
    ("optics", "text.json", &["text.json: not a camera: the text \"16\", expected a number"]),
    ("optics", "long.json", &["long.json: cannot read: larger than 1 MiB"]),
    ("optics", "/dev/zero", &["/dev/zero: cannot read: larger than 1 MiB"]),
    ("optics", "latin.json", &["latin.json: cannot read: not text: byte 13"]),
    (CAPTURE, "--psi 1 --camera f01.json", &["f01.json: camera clear: focal_length_mm"]),
    (
        "capture scene-depth.json --out o.png",
        "",
        &["scene-depth.json: no scene of layers: a depth is a psi as a number"],
    ),
    (
        "capture scene-size.json --out o.png",
        "",
        &["scene-size.json: no scene of layers: unknown field `size`"],
    ),
    ("capture scene-none.json --out o.png", "", &["scene-none.json: 0 layers, expected 1 to 64"]),
    ("capture long.json --out o.png", "", &["long.json: cannot read: larger than 1 MiB"]),
    (
        "capture bomb.png --psi 1 --out o.png",
        "",
        &["bomb.png: damaged or unsupported: 60000x60000 pixels, more than the 512 MiB"],
    ),
    ("compare bomb.png photo.png", "", &["bomb.png", "60000x60000"]),
    ("compare small.png small.png", "", &["small.png, small.png: frame of 8x8 pixels", "smaller --border"]),
    ("compare photo.png raw.png", "", &["photo.png, raw.png: frames of 288x256 and 48x32 pixels"]),
    ("estimate", "--design d-clock.json", &["d-clock.json: clock_mhz 1e99: must be above 0, at most 400"]),
    ("estimate", "--design d-codes.json", &["d-codes.json: form.codes 17: must be even and at most 256"]),
    ("estimate", "--design d-stages.json", &["d-stages.json: stages 4: must be 5 stages, one a layer"]),
    (
        "estimate",
        "--design d-kind.json",
        &["d-kind.json: not a design: the text \"16\", expected a whole number of 0 or more"],
    ),
    ("estimate", "--design d-frame.json", &["d-frame.json: frame: frame 63x", "both sides must be even"]),
    ("estimate", "--design d-unknown.json", &["d-unknown.json: not a design: unknown field `title`"]),
    ("estimate", "--design long.json", &["long.json: cannot read: larger than 1 MiB"]),
    ("timing", "--design d-codes.json", &["d-codes.json: form.codes 17"]),
    ("generate", "--design d-codes.json --weights paper-t4 --out o", &["d-codes.json: form.codes 17"]),
    ("board sim", "--design d-codes.json", &["d-codes.json: form.codes 17"]),
    (
        "cosim",
        "--design tiny --weights net.fixed.safetensors",
        &["network small does not fit design tiny", "edof random-network"],
    ),
    ("cosim", "--design tiny --photo small.png", &["small.png: frame 8x8: both sides must be at least"]),
    ("estimate", "--design paper --weights paper-t4 --photo small.png", &["small.png: frame 8x8"]),
    (
        "reconstruct small-raw.png --weights net.fixed.safetensors --out o.png",
        "",
        &["small-raw.png: frame 8x8: both sides"],
    ),
    (
        "reconstruct said.png --weights net.fixed.safetensors --out o.png",
        "",
        &[
            "said.png.json: no record of a raw frame: unknown value `rgbg`, expected one of `rggb`",
            "mend or delete it",
        ],
    ),
    (
        "reconstruct raw.png --weights kinds.fixed.safetensors --out o.png",
        "",
        &[
            "kinds.fixed.safetensors: not an edof weight file: its metadata is wrong: an object, expected a whole number",
        ],
    ),
    (
        TRAIN,
        "--images tiny-photos",
        &["tiny-photos/p02.png: 40x40, both sides should be at least", "leave it out"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images broken --out o",
        "",
        &["broken: 1 photograph, none of which can be read; the first: broken/a.png"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos 99 --out o",
        "",
        &["photos: 1 photograph, none to be trained on", "--photos all"],
    ),
    (DESIGN, "--images tiny-photos --camera f01.json", &["f01.json: camera clear"]),
    ("study stability", "--cases photos", &["photos: no case files (*.json) there"]),
    ("study stability", "--cases one", &["one: no case files"]),
    ("optics", "bank.json", &["bank.json: nothere.npz: cannot read"]),
    ("optics", "mask.json", &["mask.json: nothere.png: cannot read"]),
    (
        "optics",
        "far.json",
        &["far.json: camera clear: psi_range is [0, 1e308], expected two numbers of at most 10000"],
    ),
    ("capture dot.png --psi 1 --out o.png", "", &["dot.png: frame 1x1: both sides must be even"]),
    ("cosim --design tiny", "--photo dot.png", &["dot.png: frame 1x1"]),
    (
        "cosim --system --design tiny --size 64x48",
        "--photo small.png",
        &["small.png: 8x8, must be at least", "a larger --photo, or --size"],
    ),
    ("explore --weights paper-t4", "--photo small.png", &["small.png: frame 8x8"]),
    (
        "generate --weights paper-t4 --out o",
        "--design mine.json",
        &["--design mine.json: network paper-t4", "edof random-network --design mine.json"],
    ),
    ("generate --weights paper-t4 --out o", "--design d-frame.json", &["d-frame.json: frame: frame 63x48"]),
    (
        "board sim",
        "--design d-video.json",
        &["d-video.json: frame 1366x768: must be the size of a video mode"],
    ),
    ("design check", "d-video.json", &["d-video.json: frame 1366x768: must be the size of a video mode"]),
    ("design check", "d-codes.json", &["d-codes.json: form.codes 17"]),
];

/// Arrays of other programs.
const ARRAYS: &[Row] = &[
    (CAPTURE, "--psi 1 --psf-bank flat.npz", &["flat.npz: no PSF bank: array 'psf' is 2 x 3 x 3, expected"]),
    (CAPTURE, "--psi 1 --psf-bank twice.npz", &["twice.npz", "two of its arrays have the name psi"]),
    (
        CAPTURE,
        "--psi 1 --psf-bank twice.safetensors",
        &["twice.safetensors", "two of its arrays have the name psi"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank kind.safetensors",
        &["kind.safetensors", "its header: an object, expected a whole number"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank bell.npz",
        &["bell.npz", "the name of its array 1 holds a control character"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank falling.npz",
        &["falling.npz: no PSF bank: psi: must be finite and ascending, is 4, 0"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank cut.npz",
        &["cut.npz", "psi: 16 bytes of data do not make 3 numbers of 8 bytes"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank lens.npy",
        &["lens.npy", "it holds one array: name it …psf.npy and put …psi.npy beside it"],
    ),
    (CAPTURE, "--psi 1 --psf-bank my-psf.npy", &["my-psi.npy: cannot read"]),
    (CAPTURE, "--psi 1 --psf-bank /dev/zero", &["/dev/zero: is no file"]),
];

/// Options as they were given, with their limits.
const OPTIONS: &[Row] = &[
    (TRAIN, "--validate-every 0", &["--validate-every 0: must be 1 or more"]),
    (TRAIN, "--steps 0", &["--steps 0: must be 1 or more"]),
    (TRAIN, "--batch 7", &["--batch 7: must be a positive multiple of 8"]),
    (TRAIN, "--output-rate 0", &["--output-rate 0: must be a positive number"]),
    (TRAIN, "--threshold-rate=-1", &["--threshold-rate -1: must be"]),
    (TRAIN, "--noiseless 0", &["--noiseless 0: must be 1 or more"]),
    (TRAIN, "--non-zeros 1,2,3", &["--non-zeros with 3 values: must be one for each of 1 shrinkage"]),
    (TRAIN, "--hue 200", &["--hue 200: must be 0 to 180 degrees"]),
    (TRAIN, "--scale 2", &["--scale 2: must be more than 0, 1 at most"]),
    (TRAIN, "--variants 0", &["--variants 0: must be 1 or more"]),
    (TRAIN, "--threads 0", &["--threads 0: must be 1 to 256"]),
    (
        TRAIN,
        "--from net.safetensors",
        &["--from net.safetensors: its form is one-sided,w8,t3,c4,r, that of --form two-sided,w8,t2,c8"],
    ),
    (DESIGN, "--rings 3", &["--rings: rings is 3, expected 0, 1 or 2"]),
    (DESIGN, "--most-phase 0", &["--most-phase: largest phase is 0, expected a positive number"]),
    (DESIGN, "--worst-weight 2", &["--worst-weight: "]),
    ("optics design --out o.json", "--window 9", &["--window 9: must be 8, 12 or 16"]),
    (DESIGN, "--psi-range=0,1e308", &["--psi-range 0,1e308: camera ring-outer: psi_range is [0, 1e308]"]),
    (
        DESIGN,
        "--psi-range=8,0",
        &[
            "--psi-range 8,0: camera ring-outer: psi_range is [8, 0], expected two numbers of at most 10000 either way",
        ],
    ),
    (
        DESIGN,
        "--psi-range 1m,2m",
        &["--psi-range 1m: camera ring-outer does not know the distance at which psi is 0", "nominal_m"],
    ),
    (CAPTURE, "--psi 1e308", &["--psi 1e308: must lie within"]),
    (CAPTURE, "--psi=-1e308", &["--psi -1e308: must lie within"]),
    (CAPTURE, "--psi 0.001m --nominal 1", &["--psi 0.001m: psi ", "m and farther"]),
    (
        "capture frame.png --depth-map raw.png --out o.png",
        "--range 0:1e300",
        &["--range 0:1e300: psi 1e300: must lie within"],
    ),
    (CAPTURE, "--psi 1 --depth 99", &["--depth 99: must be 8 to 16"]),
    (CAPTURE, "--psi 1 --black-level 4096", &["--black-level 4096: must be less than 4096", "--depth 12"]),
    (CAPTURE, "--psi 1 --nominal=-1e308", &["--nominal -1e308: must be a distance of more than 0 m"]),
    (
        "capture chart --out o.png",
        "--size 62x62",
        &["--size 62x62: scene 62x62: both sides must be even and at least 64"],
    ),
    ("capture chart --out o.png", "--psi 1e308", &["--psi 1e308: "]),
    ("scene chart --out o", "--size 65x65", &["--size 65x65: "]),
    ("optics --out o", "--psi 1e308", &["--psi 1e308: must lie within"]),
    ("optics --out o", "--energy 1e308", &["--energy 1e308: must be more than 0 and at most 1"]),
    ("optics --out o", "--nominal=-1e308", &["--nominal -1e308: "]),
    (RECONSTRUCT, "--depth 7", &["--depth 7: raw.png: bit depth 7: must be 8 to 16"]),
    (RECONSTRUCT, "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    (RECONSTRUCT, "--white-level 1e308", &["raw.png: --white-level 1e308: must be more than 0 and at most"]),
    (
        RECONSTRUCT,
        "--black-level 60000 --white-level 10",
        &["raw.png: --black-level 60000: must be less than the white level, 10"],
    ),
    (
        "reconstruct f01.json --weights net.fixed.safetensors --out o.png",
        "",
        &["f01.json: not a PNG, TIFF or PGM file", "--size 1920x1080"],
    ),
    ("quantize net.safetensors --out o", "--headroom 0", &["--headroom 0: must be 1 or more"]),
    ("quantize net.safetensors --out o", "--bits 7", &["--bits 7: "]),
    ("quantize net.safetensors --out o", "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    (
        "quantize net.safetensors --out o",
        "--finetune-rate=-1e30",
        &["--finetune-rate -1e30: must be a positive number"],
    ),
    ("random-network --out o", "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    ("compare photo.png photo.png", "--map-gain=-1e30", &["--map-gain -1e30: must be a positive number"]),
    ("cosim --design tiny --system", "--size 63x64", &["--size 63x64: ", "both sides must be even"]),
    ("cosim --design tiny --system", "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    ("cosim --design tiny --system", "--window 9", &["--window 9: must be 8, 12 or 16"]),
    (
        "cosim --design tiny",
        "--rtl gt",
        &["--rtl gt: has no ", "expected the folder rtl of what 'edof generate' wrote"],
    ),
    ("cosim --design tiny", "--rtl nowhere", &["--rtl nowhere: is no folder; expected the folder rtl"]),
    ("board info", "--port photo.png", &["photo.png: is a file; expected a serial port"]),
    ("board status", "--seconds 1e308", &["--seconds 1e308: must be above 0, at most 3600"]),
    ("board info", "--patience 1e308", &["--patience 1e308: must be above 0, at most 3600"]),
    (
        "capture frame.png --depth-map raw.png --range 8:0 --out o.png",
        "--layers 0",
        &["--layers 0: must be 1 to 64"],
    ),
    (
        "capture photo.png --out o.png",
        "--psi 2m",
        &["--psi 2m: camera ring-outer does not know the distance"],
    ),
    (
        CAPTURE,
        "--psi 1 --wavelength-tolerance 1e308",
        &["--wavelength-tolerance 1e308: a share, must be 0 to 1"],
    ),
    (CAPTURE, "--psi 1 --depth-tolerance=-1e308", &["--depth-tolerance -1e308: must be 0 or more"]),
    (TRAIN, "--psi 0:900", &["--psi 0:900: psi 900: must lie within 200"]),
    (TRAIN, "--psi 0:1e308", &["--psi 0:1e308: psi 1e308"]),
    (TRAIN, "--psi 1m:2m", &["--psi 1m: camera clear does not know", "nominal_m"]),
    (TRAIN, "--exposure 1e30:1e38", &["--exposure 1e30:1e38: must be two factors"]),
    (TRAIN, "--lambda 1,2,3", &["--lambda with 3 values: must be one for each of 1 shrinkage"]),
    (DESIGN, "--focus 1e308", &["--psi-range and --focus: psi is 0 to 8, focus 1e308"]),
    ("cosim --design tiny", "--stalls 1e308", &["--stalls 1e308: must be 0 to 0.99"]),
    ("explore --weights paper-t4", "--fps=-1e308", &["--fps -1e308: must be more than 0"]),
    ("demo --out o", "--height 33", &["--width 720 --height 33: scene 720x33: both sides must be even"]),
    (
        "compare photo.png photo.png",
        "--region 0,0,4x4",
        &["frame of 4x4 pixels: must be at least 11x11", "a larger --region"],
    ),
    ("scene chart-4 --out o", "--psi 1", &["--psi: 1 value for chart-4, expected 4"]),
];

/// What a message has of Rust, or of numbers that nobody reads.
fn of_rust(line: &str) -> Option<&'static str> {
    const WORDS: [&str; 18] = [
        "Some(",
        "None",
        "Ok(",
        "Err(",
        "Line(",
        "Sampled(",
        "Phase {",
        "Etched {",
        "f32",
        "f64",
        "usize",
        "u16",
        "u32",
        "struct ",
        "enum ",
        "unknown variant",
        "NotFound",
        "\\u{",
    ];
    WORDS.into_iter().find(|word| line.contains(word)).or_else(|| {
        let digits = line.split(|c: char| !c.is_ascii_digit()).map(str::len).max().unwrap_or(0);
        (digits > 20).then_some("a number of more than twenty digits")
    })
}

#[track_caller]
fn every_row_says_what_and_what_to_do(rows: &[Row]) {
    let place = ready();
    let before = place.snapshot();
    let mut wrongly = vec![];
    for (command, options, words) in rows {
        let line = format!("{command} {options}");
        let run = place.edof_within_bounds(&line);
        let missing: Vec<&&str> = words.iter().filter(|word| !run.err.contains(**word)).collect();
        let one = run.err.lines().count() == 1 && run.err.starts_with("edof: ") && run.out.is_empty();
        let rust = of_rust(&run.err);
        let left = place.snapshot() != before;
        if run.code != Some(1) || !one || !missing.is_empty() || rust.is_some() || left {
            wrongly.push(format!(
                "{line}: status {:?}, missing {missing:?}, of Rust {rust:?}, files left: {left}\n    {}{}",
                run.code, run.out, run.err
            ));
        }
    }
    assert!(wrongly.is_empty(), "{} of {}:\n{}", wrongly.len(), rows.len(), wrongly.join("\n"));
}

#[test]
fn a_failure_of_a_file_names_the_file_that_was_given() {
    every_row_says_what_and_what_to_do(FILES);
}

#[test]
fn arrays_of_other_programs_are_refused_by_name() {
    every_row_says_what_and_what_to_do(ARRAYS);
}

#[test]
fn a_failure_of_an_option_names_the_option_and_its_limit() {
    every_row_says_what_and_what_to_do(OPTIONS);
}
