//! Every file that a command reads, replaced by each kind of wrong one, and every option with values that it cannot have: exit status
//! 1 or 2, one line that names it, nothing written, in no time and little memory.

mod options;

use crate::support::Place;
use options::OPTIONS;

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
const WRONG: [&str; 13] = [
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
    // A named pipe, into which nobody writes.
    "waiting",
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
    place.pipe("waiting");
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
fn every_wrong_file_is_rejected_by_every_command_that_reads_it() {
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

#[test]
fn every_option_rejects_what_it_cannot_have() {
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
