//! Random legal designs end to end, by the real binary: what `design new` and `design check` accept works in every later step.

#![cfg(target_os = "linux")]

use crate::board::Sim;
use crate::support::Place;
use edof_core::draw::Draw;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Designs that are tried at once.
const THREADS: usize = 2;
/// Options that are tried for each design that must be accepted, at most.
const TRIES: usize = 5;
/// Multipliers from which Icarus takes longer than the compilation for Verilator.
const LARGE: u64 = 128;
/// Cycles of a frame from which it does so with the whole core.
const LONG: u64 = 4_000;

/// Options of `edof design new`.
struct Options {
    /// Of `--form`.
    form: String,
    /// Of the network, where the design is made for one and not for a form.
    bits: Option<u64>,
    size: (u64, u64),
    clock_mhz: f64,
    stride: u64,
    multipliers: u64,
}

fn one_of<T: Copy>(draw: &mut Draw, choices: &[T]) -> T {
    choices[draw.whole(0, choices.len() as i64 - 1) as usize]
}

/// Returns true once in N calls, on average.
fn rarely(draw: &mut Draw, of: i64) -> bool {
    draw.whole(1, of) == 1
}

impl Options {
    /// Small designs mostly; a few large ones if `any`. Some of the options are not legal.
    fn random(seed: u64, any: bool) -> Self {
        let draw = &mut Draw::new(seed);
        let window = one_of(draw, &[8, 8, 8, 12, 12, 16]);
        let layers = if rarely(draw, 6) { draw.whole(5, 10) } else { draw.whole(2, 4) };
        let mut codes = one_of(draw, &[4, 4, 8, 8, 12, 16, 20, 24]);
        if any && rarely(draw, 4) {
            codes = 4 * draw.whole(9, 64);
        } else if rarely(draw, 20) {
            codes = one_of(draw, &[6, 17, 260]);
        }
        let sided = one_of(draw, &["one-sided", "two-sided", "firm"]);
        let mut form = format!("{sided},w{window},t{layers},c{codes}");
        for word in ["r", "tied", "difference"] {
            if rarely(draw, 3) {
                form = format!("{form},{word}");
            }
        }
        let small = (8 * draw.whole(2, 8) as u64, 4 * draw.whole(4, 12) as u64);
        let other = [(1280, 720), (1920, 1080), (632, 472), (30, 22), (16, 12), (1366, 768), (2048, 16)];
        let multipliers =
            (4 * layers + 12) as f64 * (draw.whole(0, if any { 500 } else { 200 }) as f64 / 100.0).exp2();
        Self {
            form,
            bits: rarely(draw, 3).then(|| draw.whole(8, 16) as u64),
            size: if rarely(draw, 4) { one_of(draw, &other) } else { small },
            clock_mhz: one_of(draw, &[50.0, 62.5, 100.0, 125.0, 150.0, 200.0, 212.5, 333.0, 400.0, 123.456]),
            stride: one_of(draw, &[2, 4, 8, 8]),
            multipliers: multipliers as u64,
        }
    }
}

/// The command that makes the design.
impl fmt::Display for Options {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { form, bits, size: (width, height), clock_mhz, stride, multipliers } = self;
        match bits {
            Some(_) => write!(f, "design new --weights net.fixed.safetensors")?,
            None => write!(f, "design new --form {form}")?,
        }
        write!(
            f,
            " --size {width}x{height} --clock-mhz {clock_mhz} --stride {stride} --multipliers {multipliers}"
        )?;
        write!(f, " --out new.json")
    }
}

/// Where a design is taken to, besides the folder of its sources, which is linted, read by Yosys and simulated.
struct Steps {
    /// The bench of the whole core, too.
    core: bool,
    /// The calculator's circuit between two models, with loads of both banks.
    cosim: bool,
    /// Banks of fewer words are loaded on the whole circuit, others on the model of a board.
    circuit: u64,
    /// A newer Yosys, too.
    newest_yosys: Option<PathBuf>,
}

/// Runs a program in the folder of sources.
#[track_caller]
fn succeeds(folder: &Path, program: impl AsRef<std::ffi::OsStr>, arguments: &[&str]) {
    let output = Command::new(program.as_ref()).args(arguments).current_dir(folder).output().unwrap();
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(output.status.success(), "{:?} {arguments:?}: {said}", program.as_ref());
}

/// Makes the design; a rejected one must have an error line.
fn is_made(place: &Place, options: &Options) -> bool {
    let Options { form, bits, stride, .. } = options;
    let net = "--out net.fixed.safetensors";
    let network =
        bits.map(|bits| format!("random-network --form {form} --bits {bits} --stride {stride} {net}"));
    let lines = network.into_iter().chain([options.to_string()]);
    for line in lines {
        let run = place.edof(&line);
        if run.code != Some(0) {
            assert!(run.code == Some(1) || run.code == Some(2), "{line}: {:?} {}", run.code, run.err);
            let is_told =
                run.err.lines().any(|line| line.starts_with("edof: ") || line.starts_with("error: "));
            assert!(is_told && !run.err.contains("panicked"), "{line}: {}", run.err);
            assert!(!place.path("new.json").exists());
            return false;
        }
    }
    if bits.is_none() {
        place.edof(&format!("random-network --design new.json {net}")).done();
    }
    true
}

/// Everything that follows `design new`.
fn works(place: &Place, steps: &Steps) {
    place.edof("design check new.json --weights net.fixed.safetensors").done();
    place.edof("estimate --design new.json --weights net.fixed.safetensors").done();
    place.edof("generate --design new.json --weights net.fixed.safetensors --out built").done();
    let folder = place.path("built");
    succeeds(&folder, "make", &["lint"]);
    let files = std::fs::read_dir(folder.join("rtl"))
        .unwrap()
        .map(|file| file.unwrap().file_name().into_string().unwrap());
    let files: String =
        files.filter(|file| file != "kc705_top.v").map(|file| format!(" rtl/{file}")).collect();
    let yosys = format!("read_verilog -defer{files}; hierarchy -check -top kc705_core");
    for program in [Some(PathBuf::from("yosys")), steps.newest_yosys.clone()].into_iter().flatten() {
        succeeds(&folder, program, &["-q", "-p", &yosys]);
    }

    let mut design: Value = serde_json::from_slice(&std::fs::read(place.path("new.json")).unwrap()).unwrap();
    let multipliers = |stage: &Value| stage["lanes"].as_u64().unwrap() * stage["rows"].as_u64().unwrap();
    let is_large = design["stages"].as_array().unwrap().iter().map(multipliers).sum::<u64>() > LARGE;
    let is_long = steps.core && cycles_of_a_frame(&folder) > LONG;
    let simulator = |verilator| if verilator { "SIM=verilator" } else { "SIM=icarus" };
    succeeds(&folder, "make", &["bench", simulator(is_large)]);
    if steps.core {
        succeeds(&folder, "make", &["core_bench", simulator(is_large || is_long)]);
    }
    if steps.cosim {
        place.edof("cosim --design new.json --weights net.fixed.safetensors --random 8 --stalls 0.2").done();
    }

    // A board of the same calculator, whose frames are small.
    (design["frame"]["width"], design["frame"]["height"]) = (json!(32), json!(16));
    place.write("small.json", design.to_string());
    let weights = "--design small.json --weights net.fixed.safetensors";
    let circuit = if words_of_a_bank(&design) < steps.circuit { "--rtl --baud 25000000" } else { "" };
    let sim = Sim::start(place, &format!("{weights} {circuit}"));
    for (bank, seed) in [("b", 2), ("a", 3)] {
        let other = format!("other-{seed}.fixed.safetensors");
        place.edof(&format!("random-network --design small.json --seed {seed} --out {other}")).done();
        let line = format!("board load {other} --bank {bank} --port board --design small.json");
        let out = place.edof(&line).done().out;
        assert!(out.contains(&format!("in bank {bank}: ")), "{out}");
    }
    sim.end_quietly();
}

/// Cycles of a frame in the bench of the whole core.
fn cycles_of_a_frame(folder: &Path) -> u64 {
    let bench = std::fs::read_to_string(folder.join("sim/core_bench.sv")).unwrap();
    let (_, number) = bench.split_once("localparam CYCLES = ").unwrap();
    number.split(';').next().unwrap().parse().unwrap()
}

/// Words of 64 bits of one set of weights, as the circuit reads them back: one in 256 cycles.
fn words_of_a_bank(design: &Value) -> u64 {
    let form = &design["form"];
    let number = |of: &Value| of.as_u64().unwrap();
    let (pixels, codes) = (number(&form["window"]).pow(2), number(&form["codes"]));
    let linear = if form["linear_path"] == true { pixels } else { 0 };
    (codes * (pixels + (number(&form["layers"]) - 2) * codes) + 128 * (codes + linear)) / 4
}

/// Takes random designs of a seed through all steps until N were accepted.
fn random_designs(seed: u64, count: usize, any: bool, steps: impl Fn(usize) -> Steps + Sync) {
    let (next, accepted, refused) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let failed = Mutex::new(vec![]);
    let one = || {
        while accepted.load(Ordering::Relaxed) < count {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= TRIES * count {
                return;
            }
            let options = Options::random(1000 * seed + index as u64, any);
            let place = Place::new();
            let outcome = catch_unwind(AssertUnwindSafe(|| {
                let is_made = is_made(&place, &options);
                let counter = if is_made { &accepted } else { &refused };
                counter.fetch_add(1, Ordering::Relaxed);
                if is_made {
                    works(&place, &steps(index));
                }
                is_made
            }));
            let Options { form, bits, .. } = &options;
            let told = format!("{index}: {options} (form {form}, bits {bits:?})");
            println!("seed {seed}, {told}: {outcome:?}");
            if outcome.is_err() {
                failed.lock().unwrap().push(told);
            }
        }
    };
    std::thread::scope(|scope| (0..THREADS).for_each(|_| drop(scope.spawn(one))));
    let (accepted, refused, failed) =
        (accepted.into_inner(), refused.into_inner(), failed.into_inner().unwrap());
    println!("seed {seed}: {accepted} designs went through, {refused} were refused, {} failed", failed.len());
    assert!(failed.is_empty(), "seed {seed}: {failed:#?}");
    assert!(accepted >= count, "{refused} of {} were refused", accepted + refused);
}

/// Each step, but not each for every design.
fn shared_steps(index: usize) -> Steps {
    let circuit = if index.is_multiple_of(10) { 700 } else { 0 };
    Steps { core: index % 10 == 2, cosim: index % 5 == 1, circuit, newest_yosys: None }
}

/// Ten designs; of other seeds with `EDOF_DESIGN_SEEDS=2,3,…`.
#[test]
fn ten_designs_work_in_every_step() {
    let seeds = std::env::var("EDOF_DESIGN_SEEDS").unwrap_or_else(|_| "1".into());
    for seed in seeds.split(',') {
        random_designs(seed.parse().unwrap(), 10, false, shared_steps);
    }
}

/// The newest Yosys that is a package.
fn newest_yosys() -> PathBuf {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/newest-yosys.sh");
    let output = Command::new(script).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().trim().into()
}

/// Fifty designs of any size, each through all steps.
fn fifty(seed: u64) {
    let newest = newest_yosys();
    let newest_yosys = || Some(newest.clone());
    random_designs(seed, 50, true, |_| Steps {
        core: true,
        cosim: true,
        circuit: 700,
        newest_yosys: newest_yosys(),
    });
}

macro_rules! fifties {
    ($($(#[$soak:meta])* $name:ident: $seed:literal;)*) => {
        $(#[test]
        $(#[$soak])*
        fn $name() {
            fifty($seed);
        })*
    };
}

fifties! {
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_101: 101;
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_102: 102;
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_103: 103;
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_104: 104;
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_105: 105;
    #[ignore = "an hour: scripts/soak.sh"]
    fifty_of_seed_106: 106;
}

#[test]
fn random_options_reach_every_value_of_each_option() {
    let all: Vec<Options> = (0..300).map(|seed| Options::random(seed, true)).collect();
    let words: BTreeSet<&str> = all.iter().flat_map(|options| options.form.split(',')).collect();
    for word in ["one-sided", "two-sided", "firm", "w8", "w12", "w16", "r", "tied", "difference", "c4", "c6"]
    {
        assert!(words.contains(word), "{word}");
    }
    assert!((2..=10).all(|layers| words.contains(format!("t{layers}").as_str())));
    let strides: BTreeSet<u64> = all.iter().map(|options| options.stride).collect();
    assert_eq!(strides, [2, 4, 8].into());
    let bits: BTreeSet<Option<u64>> = all.iter().map(|options| options.bits).collect();
    assert!(bits.contains(&None) && (8..=16).all(|bits| bits_has(&all, bits)));
    let multipliers = all.iter().map(|options| options.multipliers);
    assert!(multipliers.clone().min() < Some(30) && multipliers.max() > Some(500));
}

fn bits_has(all: &[Options], bits: u64) -> bool {
    all.iter().any(|options| options.bits == Some(bits))
}
