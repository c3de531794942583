//! What new users give by mistake: files of something else, records and scenes with a slip in them, options with what they cannot have.

use super::rows::Row;

const CAPTURE: &str = "capture photo.png --psi 1 --out o.png";
const RECONSTRUCT: &str = "reconstruct raw.png --weights net.fixed.safetensors --out o.png";
const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all --out o";
const SINGLE: &str = "study single-depth --images photos --photos all --psi 1";
const REREAD: &str = "--weights net.fixed.safetensors --out o.png";

/// Scenes of layers and records of frames: the file that says it, where in it, and what it says.
pub const SCENES: &[Row] = &[
    (
        "capture s-missing.json --out o.png",
        "",
        &["s-missing.json: layer 0: nothere.png: cannot read: No such file"],
    ),
    (
        "capture s-feet.json --out o.png",
        "",
        &["s-feet.json: layer 0: depth '2 feet': must be a psi such as 4"],
    ),
    (
        "capture s-bare.json --out o.png",
        "",
        &["s-bare.json: layer 1 has no matte, so it hides all behind it"],
    ),
    (
        "capture s-matte.json --out o.png",
        "",
        &["s-matte.json: layer 1: other.png: holds a colour picture, expected a grey one"],
    ),
    ("capture s-far.json --out o.png", "", &["s-far.json: psi 1000000000: must lie within 200"]),
    (
        "capture s-nowhere.json --out o.png",
        "",
        &["s-nowhere.json: no scene of layers: missing field `depth`"],
    ),
    ("capture s-many.json --out o.png", "", &["s-many.json: 65 layers, expected 1 to 64"]),
    (
        "capture s-folder.json --out o.png",
        "",
        &["s-folder.json: layer 0: folder.png: cannot read: a folder, expected a regular file"],
    ),
    (
        "capture s-nameless.json --out o.png",
        "",
        &["s-nameless.json: layer 0: picture: is empty, expected the name of a file"],
    ),
    ("capture s-behind.json --out o.png", "", &["s-behind.json: layer 0: depth '-1m'"]),
    ("capture twice.json --out o.png", "", &["twice.json: no scene of layers: duplicate field `layers`"]),
    (
        "reconstruct r-depth.png",
        REREAD,
        &["r-depth.png.json: bit depth 99: must be 8 to 16; correct the file, or move it elsewhere"],
    ),
    ("reconstruct r-black.png", REREAD, &["r-black.png.json: invalid raw-frame record: black level '70000'"]),
    (
        "reconstruct r-white.png",
        REREAD,
        &[
            "r-white.png.json: white level 0: must be more than 0 and at most 4096",
            "correct the file, or move it elsewhere",
        ],
    ),
    (
        "reconstruct r-white.png --white-level -3",
        REREAD,
        &["--white-level -3: r-white.png.json says 0; leave --white-level out"],
    ),
    (
        "reconstruct r-more.png",
        REREAD,
        &[
            "r-more.png.json: invalid raw-frame record: extra text after the end of the JSON, at line 2",
            "correct the file, or move it elsewhere",
        ],
    ),
    ("reconstruct r-balance.png", REREAD, &["r-balance.png.json", "a list of 2, expected a list of 3"]),
    ("reconstruct r-bright.png", REREAD, &["r-bright.png.json", "white balance '1e30,1,1': must be factors"]),
    ("reconstruct r-dark.png", REREAD, &["r-dark.png.json", "white balance '0,1,1': must be factors"]),
    ("reconstruct r-matrix.png", REREAD, &["r-matrix.png.json", "a list of 1, expected a list of 3"]),
    (
        "reconstruct r-align.png",
        REREAD,
        &["r-align.png.json", "unknown value `left`, expected `top` or `bottom`"],
    ),
    ("reconstruct r-psi.png", REREAD, &["r-psi.png.json", "the text \"x\", expected a number"]),
    (
        "reconstruct r-hash.png",
        REREAD,
        &["r-hash.png.json: describes another frame than r-hash.png; move it elsewhere"],
    ),
    ("reconstruct r-text.png", REREAD, &["r-text.png.json", "the text \"12\", expected a whole number"]),
    ("estimate", "--design g-bits.json", &["g-bits.json: code_bits 17: must be 8 to 16"]),
    ("estimate", "--design g-sum.json", &["g-sum.json: accumulator_bits 64: must be 32 to 48"]),
    ("estimate", "--design g-layers.json", &["g-layers.json: layers 1: must be 2 to 10"]),
    (
        "estimate",
        "--design g-lanes.json",
        &["g-lanes.json: stages[0].lanes 0: must be a multiple of 4 that divides 16"],
    ),
    ("estimate", "--design g-slow.json", &["g-slow.json: clock_mhz -5: must be above 0, at most 400"]),
    ("estimate", "--design g-stride.json", &["g-stride.json: not a design: stride 3: must be 2, 4 or 8"]),
    ("estimate", "--design g-window.json", &["g-window.json: not a design: window 9: must be 8, 12 or 16"]),
    (
        "estimate",
        "--design g-skip.json",
        &["g-skip.json: not a design: the text \"yes\", expected true or false"],
    ),
];

/// Files and folders that are something else.
pub const STRANGE: &[Row] = &[
    ("optics", "empty.json", &["empty.json: not a camera: ends too early"]),
    ("optics", "list.json", &["list.json: not a camera: a list of 0, expected an object"]),
    ("optics", "words.json", &["words.json: not a camera: the text \"x\", expected an object"]),
    ("optics", "deep.json", &["deep.json: not a camera"]),
    ("optics", "wide.json", &["wide.json: cannot read: not text: byte 0"]),
    ("optics", "folder.png", &["folder.png: cannot read: a folder, expected a regular file"]),
    (
        "capture empty.png --psi 1 --out o.png",
        "",
        &["empty.png: not a PNG, JPEG, WebP, TIFF, BMP, PPM or PGM file"],
    ),
    ("capture photo.png --psi 1 --out folder.png", "", &["folder.png: cannot write: is a directory"]),
    ("capture photo.png --psi 1 --out o.jpg", "", &["o.jpg: unknown ending, expected .png, .tif"]),
    (
        CAPTURE,
        "--camera ring-otter",
        &["camera 'ring-otter': no such file, and not one of the presets clear, "],
    ),
    (CAPTURE, "--psf-bank photo.png", &["photo.png: not a whole NPZ, NPY or safetensors file"]),
    (
        CAPTURE,
        "--sharp photo.png",
        &["--sharp photo.png: would replace photo.png, which the same command reads"],
    ),
    (
        "capture photo.png --depth-map small.png --range 0:8 --out o.png",
        "",
        &["small.png: holds a colour picture, expected a grey one"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images empty --out o",
        "",
        &["empty: contains no photographs"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images nothere --out o",
        "",
        &["nothere: cannot list: No such file"],
    ),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images photo.png --out o",
        "",
        &["photo.png: cannot list: is a file, expected a folder of pictures"],
    ),
    (TRAIN, "--leave-out p99", &["--leave-out p99: none of the photographs to learn from has this name"]),
    (TRAIN, "--leave-out p03", &["--leave-out: leaves no photograph to learn from"]),
    (
        "train --from net.fixed.safetensors --camera clear --images photos --photos all --out o",
        "",
        &["net.fixed.safetensors: holds a fixed network, expected a float one"],
    ),
    (
        "quantize nothere --out o",
        "",
        &["weights 'nothere': no such file, no weights/nothere.safetensors, and not"],
    ),
    ("weights folder.png", "", &["weights 'folder.png': is a folder, no weights/folder.png.safetensors"]),
    ("weights empty.safetensors", "", &["empty.safetensors: not a whole safetensors file"]),
    (
        "reconstruct nothere.png --weights net.fixed.safetensors --out o.png",
        "",
        &["nothere.png: cannot read: No such"],
    ),
    (
        "reconstruct photo.png --weights net.fixed.safetensors --out o.png",
        "",
        &["photo.png: holds 8-bit samples, expected"],
    ),
    (
        "reconstruct raw.png taken.png --weights net.fixed.safetensors --out o.png",
        "",
        &["--out o.png: 2 frames need a folder"],
    ),
    (RECONSTRUCT, "--bits 9", &["--bits 9: must be 8 or 16"]),
    (
        "reconstruct raw.png --weights net.fixed.safetensors --float --out o.png",
        "",
        &["holds a fixed network, expected a float one"],
    ),
    ("compare photo.png nothere.png", "", &["nothere.png: cannot read: No such file"]),
    (
        "compare photo.png photo.png",
        "--region 300,0,64x64",
        &["--region 300,0,64x64: reaches out of photo.png, 288x256"],
    ),
    (
        "compare photo.png photo.png",
        "--border 200",
        &["frame of 288x256 pixels: must be at least", "a smaller --border"],
    ),
    ("compare photo.png other.png", "--map photo.png", &["--map photo.png: would replace photo.png"]),
    ("design check", "nothere.json", &["design 'nothere.json': no such file, and not one of the designs"]),
    (
        "generate --design tiny --weights paper-t4",
        "--out photo.png",
        &["--out photo.png: is a file, expected a folder"],
    ),
    ("scene chart", "--out photo.png", &["--out photo.png: is a file, expected a folder"]),
    ("demo", "--out photo.png", &["--out photo.png: is a file, expected a folder"]),
    ("optics --psi 1", "--out photo.png", &["--out photo.png: is a file, expected a folder"]),
    ("scene chart", "--size 64x64 --psi 1,2", &["--psi: 2 values for chart, expected 1"]),
    ("scene spam", "", &["scene 'spam': must be chart, chart-4, leaves or leaves-4"]),
    (
        "random-network --out o",
        "--kind natural --bits 8",
        &["--kind natural: makes", "of --bits 16 only", "of --bits 8"],
    ),
    ("random-network --out o", "--bits 20", &["--bits 20: must be 8 to 16"]),
    (
        "board sim",
        "--design mine.json --weights net.fixed.safetensors",
        &["--design mine.json: network small does not fit", "edof random-network --design mine.json"],
    ),
    (
        "board sim",
        "--design tiny --weights paper-t4",
        &[
            "network paper-t4 does not fit design tiny",
            "make one that does by 'edof random-network --design tiny'",
        ],
    ),
    (RECONSTRUCT, "--device gpu:99", &["--device gpu:99: no "]),
    (
        "capture photo.png --psi 1 --out photo.png/o.png",
        "",
        &["--out photo.png/o.png: cannot write: Not a directory"],
    ),
    (CAPTURE, "--sharp photo.png/s.png", &["--sharp photo.png/s.png: cannot write: Not a directory"]),
    (
        "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all",
        "--out photo.png/net",
        &["--out photo.png/net: cannot write: Not a directory"],
    ),
    (
        "cosim --design tiny",
        "--waveform photo.png/w",
        &["--waveform photo.png/w", "cannot write: Not a directory"],
    ),
    ("cosim --design tiny", "--junit folder.png", &["--junit folder.png: cannot write: is a directory"]),
    ("doctor", "--json folder.png", &["--json folder.png: cannot write: is a directory"]),
    (
        "study bits",
        "--markdown photo.png/m.md",
        &["--markdown photo.png/m.md: cannot write: Not a directory"],
    ),
    ("study bits", "--report folder.png", &["--report folder.png: cannot write: is a directory"]),
    (
        "explore --weights paper-t4",
        "--json photo.png/x",
        &["--json photo.png/x: cannot write: Not a directory"],
    ),
    ("optics design", "--out photo.png/x.json", &["--out photo.png/x.json: cannot write: Not a directory"]),
    (
        "design new --weights paper-t4",
        "--out folder.png",
        &["--out folder.png: cannot write: is a directory"],
    ),
    ("random-network", "--out folder.png", &["--out folder.png: cannot write: is a directory"]),
    (
        "study merge knobs.jsonl",
        "--out o",
        &["knobs.jsonl: line 2: not a row of a study", "delete the line: its row is measured again"],
    ),
    ("board get spam --port nothere", "", &["register 'spam': there is none; edof board dump lists all"]),
    (
        "board info",
        "--port nothere",
        &["nothere: there is no such path; expected a serial port, as in /dev/ttyUSB0"],
    ),
    (
        "board sim",
        "--link photo.png",
        &["photo.png: is there already, and no link of a board; name another path"],
    ),
    ("study merge nothere --out o", "", &["nothere: cannot read: No such file"]),
    (
        "study merge photo.png --out o",
        "",
        &["photo.png: cannot read: line 1 is no text: expected rows of a study"],
    ),
    ("study merge empty.json --out o", "", &["empty.json: contains no rows of a study"]),
    (SINGLE, "--rows photo.png", &["photo.png: cannot read: line 1 is no text: expected rows of a study"]),
    (
        SINGLE,
        "--rows rows.jsonl",
        &["--rows rows.jsonl: holds rows of edof study knobs, not of single-depth; name another file"],
    ),
    (SINGLE, "--rows o --external spam", &["spam", "{raw}"]),
    (SINGLE, "--rows o --methods spam", &["method 'spam': must be one of malvar, directional"]),
    ("study multi-depth", "--height 33", &["--width 480 --height 33: scene 480x33: both sides must be even"]),
    ("study multi-depth", "--scenes spam", &["scene 'spam': must be chart"]),
    (
        "study blind --images photos --photos all",
        "--side 4",
        &["--side 4: must be odd, so that the kernel has a middle"],
    ),
    ("study dictionary --images photos --photos all --out o", "--atoms 0", &["--atoms 0: must be 4 to 4096"]),
    ("study stability", "--only spam", &["--only spam: no case of such a name"]),
    ("optics design --out o.json", "--images nothere", &["nothere: cannot list: No such file"]),
];

/// Values that no option has, rejected before anything is read.
pub const USAGE: &[Row] = &[
    (TRAIN, "--rate 1e39", &["'1e39' for '--rate", "too large: expected a number of at most 3.4e38"]),
    (
        TRAIN,
        "--rate 1e-50",
        &["'1e-50' for '--rate", "too small: expected 0, or a number of at least 1.2e-38"],
    ),
    (TRAIN, "--lambda 1e-4,1e39", &["'1e39' for '--lambda", "too large"]),
    (TRAIN, "--noise -1e300", &["'-1e300' for '--noise", "too large"]),
    (
        TRAIN,
        "--exposure 1:1e39",
        &["'1:1e39' for '--exposure", "too large: expected a number of at most 3.4e38"],
    ),
    (TRAIN, "--saturation 2:1", &["'2:1' for '--saturation", "expected LOW:HIGH, as in 0.5:2"]),
    (TRAIN, "--minutes -1", &["'-1' for '--minutes", "expected a number of minutes above 0"]),
    (TRAIN, "--seed -1", &["'-1' for '--seed"]),
    (TRAIN, "--rate x", &["'x' for '--rate", "expected a number"]),
    ("compare photo.png photo.png --map m.png", "--map-gain 1e39", &["'1e39' for '--map-gain", "too large"]),
    (
        "quantize net.safetensors --out o",
        "--finetune 5 --finetune-rate 1e39",
        &["'1e39' for '--finetune-rate", "too large"],
    ),
    (
        CAPTURE,
        "--noise sensor:gian=2",
        &["'sensor:gian=2'", "must be none, a standard deviation such as 0.01, or sensor"],
    ),
    (CAPTURE, "--noise sensor:full-well=0", &["full well is 0, expected 1 to 1e9 electrons"]),
    (CAPTURE, "--seed -1", &["'-1' for '--seed"]),
    (
        "capture photo.png --out o.png",
        "--psi nan",
        &["'nan' for '--psi", "must be a psi such as 4, or a distance"],
    ),
    (
        "capture chart --psi 1 --out o.png",
        "--size 64",
        &["'64' for '--size", "expected WIDTHxHEIGHT in pixels"],
    ),
    (RECONSTRUCT, "--phase xxxx", &["CFA phase 'xxxx': must be rggb, grbg, gbrg or bggr"]),
    (RECONSTRUCT, "--white-balance 1,2", &["white balance '1,2': must be factors of red, green and blue"]),
    (RECONSTRUCT, "--colour-matrix 1,2,3", &["colour matrix '1,2,3': must be nine numbers"]),
    (RECONSTRUCT, "--device nothere", &["'nothere' for '--device", "must be cpu, gpu, or gpu:N"]),
    (SINGLE, "--rows o --shard 3/2", &["shard '3/2': must be I/N such as 2/8, I from 1 to N"]),
    ("study bits", "--allowed x", &["'x' for '--allowed"]),
    ("random-network --out o", "--form spam", &["unknown keyword 'spam', expected paper-t4 or edof-t4w12"]),
];
