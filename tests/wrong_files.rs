//! Every file that a command reads, replaced by each kind of wrong one, and every option with values that it cannot have: exit status
//! 1 or 2, one line that names it, nothing written, in no time and little memory.

use crate::support::Place;

/// Commands with a gap for the file that is wrong.
const COMMANDS: [&str; 53] = [
    "reconstruct {} --weights net.fixed.safetensors --out o.png",
    "reconstruct raw.png --weights {} --out o.png",
    "reconstruct raw.png --float --weights {} --out o.png",
    "reconstruct raw.png --weights net.fixed.safetensors --camera {} --out o.png",
    "capture {} --psi 4 --out o.png",
    "capture photo.png --psi 4 --camera {} --out o.png",
    "scene chart --camera {} --out o",
    "optics {} --out o",
    "optics design --camera {} --out o.json",
    "optics design --images {} --out o.json",
    "train --form edof-t4w12 --images photos --photos all --camera {} --out o",
    "train --form edof-t4w12 --images {} --camera clear --out o",
    "quantize {} --out o",
    "quantize net.safetensors --images {} --out o",
    "study kodak --images photos --nets {}",
    "study kodak --images {} --nets net.safetensors",
    "study single-depth --rows o --camera clear --images photos --nets {}",
    "study single-depth --rows o --camera clear --images {} --nets net.safetensors",
    "study single-depth --rows o --camera clear --images photos --nets net.safetensors --dictionary {}",
    "study dictionary --images {} --out o",
    "study multi-depth --nets {}",
    "study multi-depth --clear-net {}",
    "study multi-depth --dictionary {}",
    "study merge {} --out o",
    "study knobs --rows o --images photos --net {}",
    "study knobs --rows o --images {} --net net.safetensors",
    "study blind --images {}",
    "study design --weights {}",
    "study bits --nets {}",
    "study stability --only gamma-index --cases {}",
    "study stability --only gamma-index --nets {}",
    "demo --net {} --out o",
    "demo --clear-net {} --out o",
    "estimate --design {}",
    "estimate --design paper --weights {}",
    "estimate --design paper --weights paper-t4 --photo {}",
    "timing --design {}",
    "timing --design paper --weights {}",
    "cosim --design {}",
    "cosim --design paper --weights {}",
    "cosim --design tiny --photo {}",
    "generate --design {} --weights paper-t4 --out o",
    "generate --design paper --weights {} --out o",
    "capture photo.png --depth-map {} --range 8:0 --out o.png",
    "capture photo.png --psi 4 --psf-bank {} --out o.png",
    "train --form edof-t4w12 --images photos --photos all --camera clear --psf-bank {} --out o",
    "train --from {} --images photos --photos all --camera clear --out o",
    "optics --psf-bank {} --out o",
    "compare {} photo.png",
    "compare photo.png {}",
    "weights {}",
    "explore --weights {}",
    "demo --design {} --out o",
];

/// Files that none of these commands can use, whatever it wants.
const WRONG: [&str; 12] = [
    "no-such-file",
    "nothing",
    "text",
    "garbage",
    "folder",
    "half.png",
    "half.safetensors",
    "half.json",
    "other.json",
    "list.json",
    "/dev/null",
    "/dev/zero",
];

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 288, 256);
    for folder in ["photos", "folder"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    place.photo("photos/kodim03.png", 288, 256);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place.write("nothing", "");
    place.write("text", "two lines\nof words\n");
    place.write("garbage", (0..5000u32).map(|i| ((i * 197 + 31) % 251) as u8).collect::<Vec<u8>>());
    let begin = |file: &str| {
        let bytes = std::fs::read(place.path(file)).unwrap();
        bytes[..bytes.len() / 2].to_vec()
    };
    place.write("half.png", begin("photo.png"));
    place.write("half.safetensors", begin("net.safetensors"));
    place.write("half.json", &include_str!("../cameras/clear.json")[..100]);
    place.write("other.json", "{\"a\": 1}");
    place.write("list.json", "[1, 2]");
    place
}

#[test]
fn every_wrong_file_is_refused_by_every_command_that_reads_it() {
    let place = ready();
    let before = place.snapshot();
    let mut wrongly = vec![];
    for command in COMMANDS {
        for wrong in WRONG {
            let line = command.replace("{}", wrong);
            let run = place.edof_within_bounds(&line);
            let one_line =
                run.err.lines().count() == 1 && run.err.starts_with("edof: ") && run.err.contains(wrong);
            let left = place.snapshot() != before;
            if run.code != Some(1) || !one_line || !run.out.is_empty() || left {
                wrongly.push(format!(
                    "{line}: status {:?}, files left: {left}, {}{}",
                    run.code, run.out, run.err
                ));
            }
        }
    }
    assert!(wrongly.is_empty(), "{}", wrongly.join("\n"));
}

const RECONSTRUCT: &str = "reconstruct raw.png --weights net.fixed.safetensors --out o.png";
const CAPTURE: &str = "capture photo.png --no-measure --out o.png";
const TRAIN: &str = "train --form two-sided,w8,t2,c8 --camera clear --images photos --photos all --out o";

/// Commands and, for each of their options, values that it cannot have. What is rejected as usage has exit status 2.
const OPTIONS: [(&str, &[&str]); 23] = [
    (
        RECONSTRUCT,
        &[
            "--depth 7",
            "--depth 17",
            "--depth -1",
            "--depth x",
            "--stride 0",
            "--stride 3",
            "--stride 9999999999",
            "--phase rgb",
            "--align left",
            "--order middle",
            "--size 48",
            "--size 0x32",
            "--size 48x33",
            "--size 99999x99999",
            "--packing mipi12",
            "--packing raw10 --size 48x32",
            "--tone loud",
            "--gamma 2.2",
            "--bits 12",
            "--bits 0",
            "--display grey",
            "--words",
            "--camera none",
            "--camera ring-2018",
            "--json o.png",
            "--json raw.png",
            "--board --float",
            "--fixed --float",
            "--black-level 70000",
            "--black-level -1",
            "--black-level 1,2",
            "--white-level 0",
            "--white-level 70000",
            "--white-level nan",
            "--white-balance 1,0,1",
            "--white-balance 1,1",
            "--white-balance 1,1,1 --board",
            "--colour-matrix 1,0,0",
            "--colour-matrix 1,0,0,0,1,0,0,0,9",
            "raw.png",
            "photo.png",
            "--out folder",
            "--no-such",
        ],
    ),
    (
        CAPTURE,
        &[
            "",
            "--psi 1,2",
            "--psi nan",
            "--psi inf",
            "--psi 1e9",
            "--psi x",
            "--psi 0m --nominal 1",
            "--psi 2m",
            "--psi 1 --nominal 0",
            "--psi 1 --nominal nan",
            "--psi 1 --depth 7",
            "--psi 1 --depth 99",
            "--psi 1 --black-level 4096",
            "--psi 1 --black-level -1",
            "--psi 1 --noise -1",
            "--psi 1 --noise 2",
            "--psi 1 --noise sensor:gain=0",
            "--psi 1 --noise sensor:iso=100",
            "--psi 1 --noise nan",
            "--psi 1 --energy 0",
            "--psi 1 --energy 1.1",
            "--psi 1 --energy nan",
            "--psi 1 --wavelength-tolerance 2",
            "--psi 1 --wavelength-tolerance -1",
            "--psi 1 --depth-tolerance nan",
            "--psi 1 --depth-tolerance -1",
            "--psi 1 --size 32x32",
            "--psi 1 --phase xyzw",
            "--psi 1 --seed -1",
            "--psi 1 --tone dark",
            "--psi 1 --camera none",
            "--psi 1 --sharp o.gif",
            "--psi 1 --light o.png",
            "--psi 1 --sharp photo.png",
            "--range 8:0",
            "--depth-map photo.png",
            "--depth-map raw.png --range 8",
            "--depth-map raw.png --range a:b",
            "--depth-map raw.png --range 8:0",
            "--psi 1 --layers x",
            "--psi 1 --json o.png",
        ],
    ),
    (
        "capture chart --out o.png",
        &[
            "--size 62x64",
            "--size 65x64",
            "--size 64",
            "--psi 1,2",
            "--size 60000x60000",
            "--depth-map raw.png --range 8:0",
        ],
    ),
    (
        "capture photo.png --psi 1",
        &[
            "",
            "--out o.dng",
            "--out o",
            "--out o.jpg",
            "--out photo.png",
            "--out text/o.png",
            "--out /proc/o.png",
            "--out folder",
        ],
    ),
    (
        "scene chart --out o",
        &[
            "--size 32x32",
            "--size 65x65",
            "--psi 1,2",
            "--psi x",
            "--tone x",
            "--camera none",
            "--seed x",
            "--size 60000x60000",
        ],
    ),
    ("scene", &["", "sea", "chart-5", "chart --out text", "chart --out photo.png/x"]),
    (
        "optics --out o",
        &[
            "--psi 900",
            "--psi nan",
            "--psi x",
            "--energy 0",
            "--energy 2",
            "--nominal 0",
            "--nominal nan",
            "none",
            "--json o/psf.png",
            "--json o/psf.npz",
        ],
    ),
    (
        "optics design --out o.json",
        &[
            "--rings 3",
            "--focus 1e9",
            "--focus nan",
            "--psi-range 1",
            "--psi-range=8,0",
            "--psi-range=0,1e9",
            "--noise -1",
            "--noise nan",
            "--worst-weight 2",
            "--window 9",
            "--max-phase 0",
            "--max-phase inf",
            "--population 1",
            "--population 99999999",
            "--generations 0",
            "--generations 99999999",
            "--camera none",
            "--images nothing",
        ],
    ),
    (
        TRAIN,
        &[
            "--depths 0",
            "--depths 1001",
            "--psi 8:0",
            "--psi 1m:2m",
            "--psi 8",
            "--tone x",
            "--noise -1",
            "--noise nan",
            "--gain 0",
            "--noiseless 0",
            "--exposure 2:1",
            "--exposure x",
            "--variants 0",
            "--saturation 2:1",
            "--hue 200",
            "--scale 0",
            "--scale 2",
            "--weighting x",
            "--steps 0",
            "--minutes 0",
            "--minutes nan",
            "--batch 0",
            "--batch 7",
            "--batch 1000000000",
            "--rate 0",
            "--rate nan",
            "--lambda x",
            "--lambda 1,2,3",
            "--non-zeros x",
            "--non-zeros 1,2,3",
            "--budget-rate -1",
            "--start x",
            "--seed x",
            "--seed 1,1",
            "--threads 0",
            "--validate-every 0",
            "--photos 99",
            "--photos x",
            "--from none",
            "--psi 0:900",
        ],
    ),
    (
        "train --camera clear --images photos --out o --form",
        &["", "x", "w8", "two-sided,w9,t2,c8", "two-sided,w8,t0,c8", "two-sided,w8,t2,c0"],
    ),
    (
        "quantize net.safetensors --images photos --photos all --out o.fixed.safetensors",
        &[
            "--bits 7",
            "--bits 17",
            "--bits x",
            "--stride 3",
            "--overlap x",
            "--headroom 0",
            "--headroom nan",
            "--finetune x",
            "--finetune 5 --finetune-rate nan",
            "--finetune 5 --finetune-rate 0",
            "--photos 99",
        ],
    ),
    (
        "study kodak --images photos --nets paper-t4",
        &[
            "--psi 900",
            "--psi nan",
            "--psi x",
            "--noise -1",
            "--noise loud",
            "--stride 3",
            "--photos x",
            "--photos 99",
            "--tone x",
            "--nets none",
        ],
    ),
    (
        "study single-depth --rows o --images photos --nets paper-t4",
        &[
            "--shard 0/2",
            "--shard 3/2",
            "--shard x",
            "--tone x",
            "--methods none",
            "--noise loud",
            "--stride 3",
        ],
    ),
    (
        "study knobs --rows o --images photos --net net.safetensors --knobs stride",
        &[
            "--knobs magic",
            "--psi 900",
            "--psi nan",
            "--noise loud",
            "--shard 2/1",
            "--photos 99",
            "--net none",
        ],
    ),
    ("study bits", &["--allowed -1", "--allowed nan", "--allowed x", "--nets none"]),
    (
        "study stability",
        &["--only none", "--windows 0", "--windows x", "--nets none", "--cases none", "--quick x"],
    ),
    (
        "study multi-depth",
        &[
            "--scenes sea",
            "--height 33",
            "--height 60000 --width 60000",
            "--noise -1",
            "--tone x",
            "--stride 3",
            "--seed x",
            "--nets none",
            "--nets paper-t4,edof-t4w12-outer",
            "--clear-net none",
        ],
    ),
    (
        "demo --out o --net net.fixed.safetensors --clear-net net.fixed.safetensors",
        &[
            "--scene sea",
            "--height 33",
            "--width 2",
            "--height 60000 --width 60000",
            "--noise -1",
            "--tone x",
            "--design none.json",
            "--net none",
        ],
    ),
    (
        "estimate --design",
        &[
            "",
            "none",
            "tiny --weights paper-t4",
            "paper --weights none",
            "tiny --weights net.fixed.safetensors",
        ],
    ),
    (
        "cosim --design tiny",
        &[
            "--random 0",
            "--patches 0",
            "--random x",
            "--stalls 1",
            "--stalls nan",
            "--stalls -1",
            "--skip x",
            "--seed x",
            "--rtl none",
            "--weights paper-t4",
            "--random 1000000000000000",
            "--photo none.png",
            "--random 5 --photo photo.png",
        ],
    ),
    (
        "generate --out o --design",
        &["", "none --weights paper-t4", "tiny --weights paper-t4", "paper --weights none", "paper"],
    ),
    (
        "random-network --out o.fixed.safetensors --form",
        &[
            "x",
            "edof-t4w12 --bits 7",
            "edof-t4w12 --bits 99",
            "edof-t4w12 --stride 3",
            "edof-t4w12 --kind x",
            "edof-t4w12 --seed x",
        ],
    ),
    (
        "compare photo.png photo.png",
        &[
            "--region 1",
            "--region 0,0,9999x9999",
            "--region 0,0,0x0",
            "--region 9999999999999999999,0,1x1",
            "--border 9999",
            "--border x",
            "--map o.gif",
            "--map photo.png",
            "--map-gain 0",
            "--map-gain nan",
            "--tone x",
            "--region 0,0,4x4",
        ],
    ),
];

#[test]
fn every_option_refuses_what_it_cannot_have() {
    let place = ready();
    let before = place.snapshot();
    let mut wrongly = vec![];
    for (command, options) in OPTIONS {
        for option in options {
            let line = format!("{command} {option}");
            let run = place.edof_within_bounds(&line);
            let told = |line: &&str| line.starts_with("edof: ") || line.starts_with("error: ");
            let one = run.err.lines().filter(told).count() == 1;
            // Wrong usage comes with a hint at the right one.
            let short = run.code == Some(2) || (run.code == Some(1) && run.err.lines().count() == 1);
            let left = place.snapshot() != before;
            if !one || !short || !run.out.is_empty() || left {
                wrongly.push(format!(
                    "{line}: status {:?}, files left: {left}, {}{}",
                    run.code, run.out, run.err
                ));
            }
        }
    }
    assert!(wrongly.is_empty(), "{}", wrongly.join("\n"));
}
