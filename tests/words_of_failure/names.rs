//! Names of cameras and designs, text behind the end of JSON, options that contradict each other, and words in place of numbers.

use super::rows::Row;

const CAPTURE: &str = "capture photo.png --no-measure --out o.png";
const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all";
const KODAK: &str = "study kodak --images photos --photos all --psi 0";
const TITLE: &str = "expected 1 to 64 characters on one line";
const PLAIN: &str = "must be 1 to 64 letters a-z or A-Z, digits, '-', '_' and '.', a letter or digit first";

/// Names that files give to what they describe.
pub const NAMES: &[Row] = &[
    ("optics", "n-empty.json", &["n-empty.json: name is empty", TITLE]),
    ("optics", "n-blank.json", &["n-blank.json: name is '   '", TITLE]),
    ("optics", "n-lines.json", &["n-lines.json: name is 'two\u{fffd}lines'", TITLE]),
    ("optics", "n-bell.json", &["n-bell.json: name is 'ding\u{fffd}'", TITLE]),
    ("optics", "n-long.json", &["n-long.json: name is 'xxx", "…' (5000 characters)", TITLE]),
    (CAPTURE, "--psi 1 --camera n-empty.json", &["n-empty.json: name is empty", TITLE]),
    ("scene chart --out o", "--camera n-empty.json", &["n-empty.json: name is empty", TITLE]),
    ("optics design --out o.json", "--camera n-lines.json", &["n-lines.json: name is 'two", TITLE]),
    (
        "train --form two-sided,w8,t2,c8 --images photos --photos all --out o",
        "--camera n-empty.json",
        &["n-empty.json: name is empty", TITLE],
    ),
    ("study aperture", "--camera n-empty.json", &["n-empty.json: name is empty", TITLE]),
    (TRAIN, "--out o --name=", &["--name: is empty", TITLE]),
    (
        "optics",
        "n-bank.json",
        &["n-bank.json: camera clear: psf_bank.file is empty, expected the name of a file"],
    ),
    ("design check", "dn-empty.json", &["dn-empty.json: name empty: ", PLAIN]),
    ("design check", "dn-slash.json", &["dn-slash.json: name 'a/b': ", PLAIN]),
    ("design check", "dn-up.json", &["dn-up.json: name '..': ", PLAIN]),
    ("design check", "dn-hidden.json", &["dn-hidden.json: name '.tiny': ", PLAIN]),
    ("design check", "dn-dash.json", &["dn-dash.json: name '-tiny': ", PLAIN]),
    ("design check", "dn-blank.json", &["dn-blank.json: name 'my design': ", PLAIN]),
    ("design check", "dn-quote.json", &["dn-quote.json: name 'a\"b': ", PLAIN]),
    ("design check", "dn-lines.json", &["dn-lines.json: name 'a\u{fffd}b': ", PLAIN]),
    ("design check", "dn-far.json", &["dn-far.json: name '设计': ", PLAIN]),
    ("design check", "dn-long.json", &["dn-long.json: name 'xxx", "…' (65 characters): ", PLAIN]),
    ("design new --form edof-t4w12 --out o.json", "--name a/b", &["--name 'a/b': ", PLAIN]),
    ("design new --form edof-t4w12 --out new,design.json", "", &["--name 'new,design': ", PLAIN]),
    ("estimate", "--design dn-slash.json", &["dn-slash.json: name 'a/b': ", PLAIN]),
    (
        "generate --weights paper-t4 --out o",
        "--design dn-slash.json",
        &["dn-slash.json: name 'a/b': ", PLAIN],
    ),
    ("board sim", "--design dn-slash.json", &["dn-slash.json: name 'a/b': ", PLAIN]),
    ("demo --out o", "--design dn-empty.json", &["dn-empty.json: name empty: ", PLAIN]),
    ("random-network --out o", "--design dn-up.json", &["dn-up.json: name '..': ", PLAIN]),
    ("cosim", "--design dn-empty.json", &["dn-empty.json: name empty: ", PLAIN]),
    ("timing", "--design dn-empty.json", &["dn-empty.json: name empty: ", PLAIN]),
    ("explore --weights paper-t4", "--design dn-blank.json", &["dn-blank.json: name 'my design': ", PLAIN]),
    (
        "study design --weights paper-t4",
        "--design dn-blank.json",
        &["dn-blank.json: name 'my design': ", PLAIN],
    ),
    (
        "demo --out o",
        "--design mine.json",
        &[
            "--design mine.json: network edof-t4w12-outer-light does not fit",
            "edof random-network --design mine.json",
        ],
    ),
];

const MORE: &str = "extra text after the end of the JSON";

/// JSON with text after its end, and files that are not JSON.
pub const BEHIND: &[Row] = &[
    ("optics", "n-more.json", &["n-more.json: not a camera: ", MORE, "at line "]),
    ("design check", "d-more.json", &["d-more.json: not a design: ", MORE, "at line "]),
    ("estimate", "--design d-more.json", &["d-more.json: not a design: ", MORE]),
    (
        "capture scene-more.json --out o.png",
        "",
        &["scene-more.json: no scene of layers: ", MORE, "at line 1"],
    ),
    (CAPTURE, "--psi 1 --psf-bank more.safetensors", &["more.safetensors: ", "its header: ", MORE]),
    (
        "reconstruct raw.png --out o.png",
        "--weights more.safetensors",
        &["more.safetensors: not a whole safetensors file: its header: ", MORE],
    ),
    ("study stability", "--cases cases", &["a.json", "at line 1"]),
    (
        "design check",
        "d-nan.json",
        &["d-nan.json: not a design: no JSON value", "NaN and Infinity are not JSON"],
    ),
    ("design check", "d-slow.json", &["d-slow.json: clock_mhz 1e-300: must be a clock that an MMCM makes"]),
    (
        "study knobs --images photos --photos all",
        "--rows rows.jsonl",
        &["rows.jsonl: line 1: not a row of a study: missing field `study`", "name another file"],
    ),
    ("study merge --out o", "noise.jsonl", &["noise.jsonl: line 1: not a row of a study: no JSON value"]),
    ("study merge --out o", "rows.jsonl", &["rows.jsonl: line 1: not a row of a study"]),
];

/// Options that contradict each other, and outputs that cannot be files.
pub const CONTRADICTIONS: &[Row] = &[
    ("study design --weights paper-t4", "--fps 0", &["--fps 0: must be more than 0"]),
    ("study design --weights paper-t4", "--fps nan", &["--fps NaN: must be more than 0"]),
    ("study design --weights paper-t4", "--fps=-1", &["--fps -1: must be more than 0"]),
    ("explore --weights paper-t4,paper-t4", "", &["--weights: paper-t4 is given twice"]),
    ("study design --weights paper-t4,paper-t4", "", &["--weights: paper-t4 is given twice"]),
    (CAPTURE, "--psi 1 --map-unit mm", &["--map-unit mm: is of a depth map; add --depth-map, or omit"]),
    (CAPTURE, "--psi 1 --range 8:0", &["--range 8:0: is of a depth map; add --depth-map, or omit --range"]),
    (TRAIN, "--out o --patience 0", &["--patience 0: must be 1 or more"]),
    (TRAIN, "--out o --saturation -1:1", &["--saturation -1: must be 0 to 10"]),
    (TRAIN, "--out o --exposure -1:1", &["--exposure -1:1: must be two factors in order, above 0"]),
    (TRAIN, "--out o/", &["--out o/: is the name of a folder, expected a file's"]),
    ("quantize paper-t4 --images photos --photos all", "--out o/", &["--out o/: is the name of a folder"]),
    ("random-network", "--out o/", &["--out o/: is the name of a folder"]),
    (KODAK, "--nets paper-t4,", &["weights '': the name is empty"]),
    (KODAK, "--nets paper-t4 --report o/", &["--report o/: is the name of a folder"]),
    (
        "cosim --design tiny --system",
        "--frames 99999999",
        &["must be at least", "frames of 64x48", "fewer --frames"],
    ),
];

const WHOLE: &str = "expected a whole number of 0 or more";

/// Words in place of numbers, and numbers beyond their limits.
pub const NUMBERS: &[Row] = &[
    (CAPTURE, "--psi 1 --seed=-1", &["'-1' for '--seed <N>'", WHOLE]),
    (CAPTURE, "--psi 1 --seed 1.5", &["'1.5' for '--seed <N>'", WHOLE]),
    (CAPTURE, "--psi 1 --seed 99999999999999999999", &["for '--seed <N>'", "the number is too large"]),
    (CAPTURE, "--psi 1 --bit-depth ten", &["'ten' for '--bit-depth <BITS>'", WHOLE]),
    (CAPTURE, "--psi 1 --energy much", &["'much' for '--energy <SHARE>'", "expected a number"]),
    (TRAIN, "--out o --steps 1e5", &["'1e5' for '--steps <N>'", WHOLE]),
    (
        TRAIN,
        "--out o --exposure 2:1",
        &["'2:1' for '--exposure <LOW:HIGH>'", "as in 0.5:2, the smaller number first"],
    ),
    (
        TRAIN,
        "--out o --psi 0,8",
        &["'0,8' for '--psi <LOW:HIGH>'", "must be two depths with a colon between"],
    ),
    (
        KODAK,
        "--nets paper-t4 --external-seconds 0",
        &["'0' for '--external-seconds <SECONDS>'", "must be 1 or more"],
    ),
    ("study blind", "--side 0", &["'0' for '--side <PIXELS>'", "must be 3 to 99"]),
    ("board info", "--baud 0", &["'0' for '--baud <BITS>'", "must be 1 to 4294967295"]),
    (
        "random-network --out o",
        "--form two-sided,w8,t2,c8,c16",
        &["keywords 'c8' and 'c16' set the same thing"],
    ),
    (
        "random-network --out o",
        "--form one-sided,two-sided",
        &["keywords 'one-sided' and 'two-sided' set the same"],
    ),
    ("random-network --out o", "--form t3,paper-t4", &["keyword 'paper-t4': must be the first one"]),
];
