//! Cycles a second of the cycle model against Verilator's, for the same design and patches in one run.
//!
//! Both run on one thread. Verilator is compiled with `-O3` (Verilog) and `-O2` (C++), without random start-up and without
//! waveforms, and driven by a loop in C++ that records all outputs: nothing is compared, so that it is as fast as it can be. The
//! model gives every word and the cycle of every transfer.
//!
//! `cargo bench -p edof-cosim`. Throughput is in cycles of the clock; the ratio of the two medians is what the model gains.

use divan::{Bencher, counter::ItemsCount};
use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_cosim::Source;
use edof_cosim::chain::device::{Beat, Inputs};
use edof_cosim::chain::second::rows;
use edof_cosim::verilator::{Library, Model, Options, Start, Unknowns};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_golden::cycle::{Cycle, Patch};
use edof_hdl::project;
use edof_network::{FixedNetwork, weight_file};
use std::path::Path;

/// Patches of a round.
const PATCHES: usize = 1000;
/// Cycles of reset.
const RESET: usize = 20;
/// Designs and their networks.
const CASES: [(&str, &str); 3] = [("paper", "paper-t4"), ("kc705", "edof-t4w12-outer"), ("tiny", "drawn")];

type Failure = Box<dyn std::error::Error>;

fn main() {
    divan::main();
}

#[divan::bench(args = CASES.map(|(design, _)| design), sample_count = 5, sample_size = 1)]
fn cycle_model(bencher: Bencher<'_, '_>, design: &str) {
    report(design, || {
        let case = Case::new(design)?;
        let model = Cycle::new(&case.design, [&case.network, &case.network])?;
        let run = || model.run(case.patches.iter().cloned()).last().map_or(0, |patch| patch.times.end());
        bencher.counter(ItemsCount::new(run())).bench(run);
        Ok(())
    });
}

#[divan::bench(args = CASES.map(|(design, _)| design), sample_count = 5, sample_size = 1)]
fn verilator(bencher: Bencher<'_, '_>, design: &str) {
    report(design, || {
        let case = Case::new(design)?;
        let model = Cycle::new(&case.design, [&case.network, &case.network])?;
        let verilated = Verilated::new(&case.design, &case.network, &model, &case.patches)?;
        let cycles = verilated.start()?.run(&verilated.stimulus)?.len();
        let start = || verilated.start().map_err(|error| error.to_string());
        let run = |model: Result<Model, String>| {
            model.and_then(|mut model| model.run(&verilated.stimulus).map_err(|error| error.to_string()))
        };
        bencher.counter(ItemsCount::new(cycles)).with_inputs(start).bench_values(run);
        Ok(())
    });
}

/// A benchmark that could not be run says why.
fn report(design: &str, run: impl FnOnce() -> Result<(), Failure>) {
    if let Err(error) = run() {
        eprintln!("{design}: {error}");
    }
}

/// What both run.
struct Case {
    design: Design,
    network: FixedNetwork,
    patches: Vec<Patch>,
}

impl Case {
    fn new(name: &str) -> Result<Self, Failure> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let design = Design::load(&root.join(format!("designs/{name}.json")))?;
        let network = match CASES.iter().find(|(design, _)| *design == name) {
            Some((_, weights)) if *weights != "drawn" => {
                weight_file::load_fixed(&root.join(format!("weights/{weights}.fixed.safetensors")))?
            }
            _ => edof_device::random::for_design(&design, 1),
        };
        let patches = patches(&design);
        Ok(Self { design, network, patches })
    }
}

/// Smooth windows with some noise: about as many zeros as photographs give.
fn patches(design: &Design) -> Vec<Patch> {
    let draw = &mut Draw::new(1);
    let side = design.form.window.side() as i64;
    let window = |draw: &mut Draw| -> Vec<InputWord> {
        let (level, across, down) = (draw.whole(4000, 20_000), draw.whole(-300, 300), draw.whole(-300, 300));
        let pixel = |i: i64| level + across * (i % side) + down * (i / side);
        let word = |bits: i64| InputWord::from_bits(bits.clamp(0, 32_767) as i16);
        (0..side * side).map(|i| word(pixel(i) + draw.whole(-200, 200))).collect()
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

    fn start(&self) -> Result<Model, edof_cosim::Error> {
        let memory_dir = Some(self.images.path().to_path_buf());
        self.library.start(&Start { seed: 1, memory_dir })
    }
}
