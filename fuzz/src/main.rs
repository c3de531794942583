//! Fuzzing of every parser that reads a file or the board's line, by libFuzzer: `EDOF_FUZZ` names the target, `EDOF_SEEDS` a folder to which its
//! seeds are written before. `scripts/fuzz.sh` builds and runs it.
//!
//! A finding is a panic, more memory than [`oracle`] allows, or more time than libFuzzer is told. An error is none: that is what parsers give.

#![no_main]

mod dngs;
mod files;
mod oracle;
mod replies;
mod seeds;

use std::path::Path;
use std::sync::OnceLock;

#[global_allocator]
static MEMORY: oracle::Counted = oracle::Counted::new();

/// A parser under test: its name, the most memory that it may use, what it does with bytes, files to begin with.
pub struct Target {
    name: &'static str,
    most_bytes: usize,
    run: fn(&[u8]),
    seeds: fn() -> Vec<Vec<u8>>,
}

/// What deflate can make of 16 KiB, a thousand times as long, as numbers of 64 bits, and as much again.
const OF_FILE: usize = 256 << 20;
/// The 512 MiB of samples that the decoders of pictures are allowed, and each as a word of 16 bits.
const OF_PICTURE: usize = 1600 << 20;

/// All of them.
const TARGETS: &[Target] = &[
    Target { name: "weights", most_bytes: OF_FILE, run: files::weights, seeds: seeds::weights },
    Target { name: "design", most_bytes: OF_FILE, run: files::design, seeds: seeds::designs },
    Target { name: "camera", most_bytes: OF_FILE, run: files::camera, seeds: seeds::cameras },
    Target { name: "arrays", most_bytes: OF_FILE, run: files::arrays, seeds: seeds::arrays },
    Target { name: "bank", most_bytes: OF_FILE, run: files::bank, seeds: seeds::banks },
    Target { name: "dng", most_bytes: OF_FILE, run: files::dng, seeds: seeds::dngs },
    Target { name: "tags", most_bytes: OF_FILE, run: dngs::run, seeds: dngs::seeds },
    Target { name: "picture", most_bytes: OF_PICTURE, run: files::picture, seeds: seeds::pictures },
    Target { name: "raw", most_bytes: OF_PICTURE, run: files::raw, seeds: seeds::raws },
    Target { name: "pnm", most_bytes: OF_FILE, run: files::pnm, seeds: seeds::pnms },
    Target { name: "scene", most_bytes: OF_FILE, run: files::scene, seeds: seeds::scenes },
    Target { name: "record", most_bytes: OF_FILE, run: files::record, seeds: seeds::records },
    Target { name: "sensor", most_bytes: OF_FILE, run: files::sensor, seeds: seeds::sensors },
    Target { name: "defects", most_bytes: OF_FILE, run: files::defects, seeds: seeds::defects },
    Target { name: "dictionary", most_bytes: OF_FILE, run: files::dictionary, seeds: seeds::dictionaries },
    Target { name: "rows", most_bytes: OF_FILE, run: files::rows, seeds: seeds::rows },
    Target { name: "replies", most_bytes: OF_FILE, run: replies::run, seeds: replies::seeds },
];

static CHOSEN: OnceLock<&Target> = OnceLock::new();

fn choose() -> &'static Target {
    let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    let name = std::env::var("EDOF_FUZZ").unwrap_or_default();
    let Some(target) = TARGETS.iter().find(|target| target.name == name) else {
        eprintln!("EDOF_FUZZ is '{name}', expected one of {}", names.join(", "));
        std::process::exit(2);
    };
    if let Some(folder) = std::env::var_os("EDOF_SEEDS") {
        for (index, seed) in (target.seeds)().into_iter().enumerate() {
            std::fs::write(Path::new(&folder).join(format!("seed-{index}")), seed)
                .expect("the folder of seeds can be written");
        }
    }
    MEMORY.allow(target.most_bytes);
    target
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| (CHOSEN.get_or_init(choose).run)(bytes));
