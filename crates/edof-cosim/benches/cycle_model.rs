//! Cycles a second of the cycle model against Verilator's, for the same design and patches in one run.
//!
//! Both run on one thread. Verilator is compiled with `-O3` (Verilog) and `-O2` (C++), without random start-up and without
//! waveforms, and driven by a loop in C++ that records all outputs: nothing is compared, so that it is as fast as it can be. The
//! model gives every word and the cycle of every transfer.
//!
//! `cargo bench -p edof-cosim`; designs by name after `--`.

use edof_cosim::Source;
use edof_cosim::chain::device::{Beat, Inputs};
use edof_cosim::chain::second::rows;
use edof_cosim::verilator::{Library, Options, Start, Unknowns};
use edof_golden::cycle::{Cycle, Patch};
use edof_hdl::project;
use edof_spec::design::memory::Set;
use edof_spec::draw::Draw;
use edof_spec::{Design, FixedNetwork, weight_file};
use std::path::Path;
use std::time::Instant;

/// Patches of a round, and rounds.
const PATCHES: usize = 1000;
const ROUNDS: usize = 5;
/// Cycles of reset.
const RESET: usize = 20;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let named: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!("{:8} {:12} {:>16} {:>16} {:>8}", "design", "network", "model cycles/s", "Verilator's", "ratio");
    for (design, weights) in [("paper", "paper-t4"), ("kc705", "edof-t4w12-outer"), ("tiny", "drawn")] {
        if named.is_empty() || named.iter().any(|name| name == design) {
            report(design, weights)?;
        }
    }
    Ok(())
}

fn report(name: &str, weights: &str) -> Result<(), Failure> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let design = Design::load(&root.join(format!("designs/{name}.json")))?;
    let network = match weights {
        "drawn" => edof_random::for_design(&design, 1),
        _ => weight_file::load_fixed(&root.join(format!("weights/{weights}.fixed.safetensors")))?,
    };
    let patches = patches(&design);
    let model = Cycle::new(&design, [&network, &network])?;
    let mut verilated = Verilated::new(&design, &network, &model, &patches)?;
    let mut ratios = Vec::new();
    let mut best = [0.0f64; 2];
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let cycles = model.run(patches.iter().cloned()).last().map_or(0, |patch| patch.times.end());
        let ours = cycles as f64 / start.elapsed().as_secs_f64();
        let theirs = verilated.round()?;
        ratios.push(ours / theirs);
        best = [best[0].max(ours), best[1].max(theirs)];
    }
    ratios.sort_by(f64::total_cmp);
    println!("{name:8} {weights:12} {:>16.0} {:>16.0} {:>7.0}x", best[0], best[1], ratios[ROUNDS / 2]);
    Ok(())
}

/// Smooth windows with some noise: about as many zeros as photographs give.
fn patches(design: &Design) -> Vec<Patch> {
    let draw = &mut Draw::new(1);
    let side = design.form.window.side() as i64;
    let window = |draw: &mut Draw| -> Vec<i16> {
        let (level, across, down) = (draw.whole(4000, 20_000), draw.whole(-300, 300), draw.whole(-300, 300));
        let pixel = |i: i64| level + across * (i % side) + down * (i / side);
        (0..side * side).map(|i| (pixel(i) + draw.whole(-200, 200)).clamp(0, 32_767) as i16).collect()
    };
    (0..PATCHES).map(|_| Patch { window: window(draw), set: Set::First }).collect()
}

/// The chain in Verilator with a stimulus that fits it: each beat stands there in the cycle in which it is taken.
struct Verilated {
    library: Library,
    stimulus: edof_cosim::Rows,
    images: tempfile::TempDir,
}

impl Verilated {
    fn new(
        design: &Design,
        network: &FixedNetwork,
        model: &Cycle,
        patches: &[Patch],
    ) -> Result<Self, Failure> {
        let project = project::calculator(design, [network, network])?;
        let options = Options {
            optimize: 2,
            unknowns: Unknowns::Fast,
            cache: Options::user_cache(),
            ..Options::default()
        };
        let library = Library::build(&Source::from(&project), &options)?;
        let images = tempfile::tempdir()?;
        edof_cosim::chain::verilated::write_images(&project, images.path())?;
        let mut inputs = vec![Inputs { reset: true, ..Inputs::default() }; RESET];
        for patch in model.run(patches.iter().cloned()) {
            for beat in patch.transfers(0) {
                let cycle = RESET + beat.cycle as usize;
                let end = RESET + patch.times.end() as usize;
                inputs.resize(inputs.len().max(end + 1), Inputs { patch_ready: true, ..Inputs::default() });
                let window = Beat { words: beat.words, base: [0; 2], last: beat.last, set: beat.set };
                inputs[cycle].window = Some(window);
            }
        }
        let stimulus = rows(library.source(), &inputs)?;
        Ok(Self { library, stimulus, images })
    }

    /// Cycles a second of one run.
    fn round(&mut self) -> Result<f64, Failure> {
        let memory_dir = Some(self.images.path().to_path_buf());
        let mut model = self.library.start(&Start { seed: 1, memory_dir })?;
        let start = Instant::now();
        let outputs = model.run(&self.stimulus)?;
        Ok(outputs.len() as f64 / start.elapsed().as_secs_f64())
    }
}
