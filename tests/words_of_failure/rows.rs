//! The rows: commands, options after them, and what their one line must hold.

const CAPTURE: &str = "capture photo.png --no-measure --out o.png";
const RECONSTRUCT: &str = "reconstruct raw.png --weights net.fixed.safetensors --out o.png";
const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all --out o";
const DESIGN: &str = "optics design --out o.json --generations 1 --population 4 --window 8";

/// A command, options after it, and what its line must hold.
pub type Row = (&'static str, &'static str, &'static [&'static str]);

/// Files: the one that was named, not what it calls itself.
pub const FILES: &[Row] = &[
    ("optics", "f01.json", &["f01.json: camera clear", "focal_length_mm is -16", "0.01 to 100000 mm"]),
    (
        "optics",
        "line.json",
        &["line.json: camera clear: spectra is 0, expected a wavelength of 100 to 30000 nm, or ascending"],
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
        &["ring.json: camera clear: rings is a phase of 6.8 rad at 0 nm, expected at most 10000 rad"],
    ),
    ("optics", "pitch.json", &["pitch.json: camera clear: pixel_pitch_um is 1e300, expected"]),
    ("optics", "kind.json", &["kind.json: not a camera: an object, expected a list of 2, at line "]),
    ("optics", "field.json", &["field.json: not a camera: unknown field `focus`", "`focus_psi`"]),
    ("optics", "text.json", &["text.json: not a camera: the text \"16\", expected a number"]),
    ("optics", "long.json", &["long.json: cannot read: larger than 1 MiB"]),
    ("optics", "/dev/zero", &["/dev/zero: cannot read: a device", "save its content to a file"]),
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
    (
        "estimate",
        "--design d-codes.json",
        &["d-codes.json: form.codes 17: must be a multiple of 4 and at most 256"],
    ),
    ("estimate", "--design d-stages.json", &["d-stages.json: stages 4: must be 5 stages, one a layer"]),
    (
        "estimate",
        "--design d-kind.json",
        &["d-kind.json: not a design: the text \"16\", expected a whole number of 0 or more"],
    ),
    ("estimate", "--design d-frame.json", &["d-frame.json: frame 63x", "both sides must be even"]),
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
            "said.png.json: invalid raw-frame record: unknown value `rgbg`, expected one of `rggb`",
            "correct the file, or move it elsewhere",
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
    ("generate --weights paper-t4 --out o", "--design d-frame.json", &["d-frame.json: frame 63x48"]),
    (
        "board sim",
        "--design d-video.json",
        &["d-video.json: frame 1366x768: must be the size of a video mode"],
    ),
    ("design check", "d-video.json", &["d-video.json: frame 1366x768: must be the size of a video mode"]),
    ("design check", "d-codes.json", &["d-codes.json: form.codes 17"]),
];

/// Arrays of other programs.
pub const ARRAYS: &[Row] = &[
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
    (CAPTURE, "--psi 1 --psf-bank my-psf.npy", &["my-psi.npy: cannot read: No such file or directory"]),
    (
        CAPTURE,
        "--psi 1 --psf-bank half.npz",
        &["half.npz", "its list of arrays is missing, which is at its end: the file is cut; copy it again"],
    ),
    (
        CAPTURE,
        "--psi 1 --psf-bank bzip2.npz",
        &[
            "bzip2.npz",
            "psi: compressed by method 12 of ZIP; write it by numpy.savez_compressed or numpy.savez",
        ],
    ),
    (CAPTURE, "--psi 1 --psf-bank /dev/zero", &["/dev/zero: cannot read: a device"]),
];

/// Options as they were given, with their limits.
pub const OPTIONS: &[Row] = &[
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
    (DESIGN, "--max-phase 0", &["--max-phase: largest phase is 0, expected a positive number"]),
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
    (CAPTURE, "--psi 1 --bit-depth 99", &["--bit-depth 99: must be 8 to 16"]),
    (
        CAPTURE,
        "--psi 1 --black-level 4096",
        &["--black-level 4096: must be less than 4096", "--bit-depth 12"],
    ),
    (CAPTURE, "--psi 1 --nominal=-1e308", &["--nominal -1e308: must be a distance of more than 0 m"]),
    ("capture chart --out o.png", "--size 62x62", &["--size 62x62: both sides must be even and at least 64"]),
    ("capture chart --out o.png", "--psi 1e308", &["--psi 1e308: "]),
    ("scene chart --out o", "--size 65x65", &["--size 65x65: "]),
    ("optics --out o", "--psi 1e308", &["--psi 1e308: must lie within"]),
    ("optics --out o", "--energy 1e308", &["--energy 1e308: must be more than 0 and at most 1"]),
    ("optics --out o", "--nominal=-1e308", &["--nominal -1e308: "]),
    (RECONSTRUCT, "--bit-depth 7", &["--bit-depth 7: raw.png: bit depth 7: must be 8 to 16"]),
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
        &["f01.json: not a PNG, TIFF, PGM or NPY file", "--size 1920x1080"],
    ),
    ("quantize net.safetensors --out o", "--headroom 0", &["--headroom 0: must be 1 or more"]),
    ("quantize net.safetensors --out o", "--bits 7", &["--bits 7: "]),
    ("quantize net.safetensors --out o", "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    (
        "quantize net.safetensors --out o",
        "--finetune 5 --finetune-rate=-1e30",
        &["--finetune-rate -1e30: must be a positive number"],
    ),
    ("random-network --out o", "--stride 3", &["--stride 3: must be 2, 4 or 8"]),
    (
        "compare photo.png photo.png --map m.png",
        "--map-gain=-1e30",
        &["--map-gain -1e30: must be a positive number"],
    ),
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
    ("board info", "--patience 1e308", &["--timeout 1e308: must be above 0, at most 3600"]),
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
