//! Every file that a command reads, replaced by each kind of wrong one: exit status 1, one line that names it, nothing written.

use crate::support::Place;

/// Commands with a gap for the file that is wrong.
const COMMANDS: [&str; 32] = [
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
    for command in COMMANDS {
        for wrong in WRONG {
            let line = command.replace("{}", wrong);
            let run = place.edof(&line);
            assert_eq!(run.code, Some(1), "{line}: {}{}", run.out, run.err);
            assert_eq!(run.err.lines().count(), 1, "{line}: {}", run.err);
            assert!(run.err.starts_with("edof: ") && run.err.contains(wrong), "{line}: {}", run.err);
            assert_eq!(run.out, "", "{line}");
            assert!(place.snapshot() == before, "{line}: files changed");
        }
    }
}
